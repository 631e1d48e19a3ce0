"""Practicum, section 1: from the check matrix to the pseudo-inverse, (1) to (16), as printed and as they should be.

Joints `q` (n,) [rad]; an error `e` is what is wanted minus what is there, position [m] before orientation. A quaternion
is a pair: scalar part η and vector part ε.
"""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from nao_kin.documents.samples import derivative

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats

Quaternion: TypeAlias = "tuple[float, Floats]"
Matrix: TypeAlias = "tuple[tuple[float, ...], ...]"


def check_matrix() -> Matrix:
    """Task 1b: T_base_hand at q = (180, 270, 90, 180, 180, 0)°, positions in metres."""
    return (
        (0.0, 1.0, 0.0, 0.41),
        (-0.5, 0.0, 0.866, 0.2595),
        (0.866, 0.0, 0.5, 0.084),
        (0.0, 0.0, 0.0, 1.0),
    )


def sixth_column() -> tuple[float, float, float]:
    """Task 1d: what the last joint does to the position, at any q [m/rad]."""
    return (0.0, 0.0, 0.0)


def jacobi(T_0_before: Floats, T_0_n: Floats) -> Floats:
    """Task 1d, ``Jacobi(T_0_i-1, T_0_n)``: column (3,) of the positional Jacobian, about z of frame i − 1."""
    return np.cross(T_0_before[:3, 2], T_0_n[:3, 3] - T_0_before[:3, 3])


def columns_from_zero(T: list[Floats]) -> Floats:
    """Task 1d, ``J = [j_0 j_1 j_2 ...]`` with j_i from T_0_{i−1}; T[i] is T_0_i, and before frame 0 there is none."""
    return np.array([jacobi(T[max(i - 1, 0)], T[-1]) for i in range(len(T) - 1)]).T


def columns_from_one(T: list[Floats]) -> Floats:
    """J = [j_1 j_2 … j_n]."""
    return np.array([jacobi(T[i - 1], T[-1]) for i in range(1, len(T))]).T


def eq_1(f: Callable[[Floats], float], x_opt: Floats) -> float:
    """(1): f_min."""
    return f(x_opt)


def eq_2(x_n: float, f: Callable[[float], float], df: Callable[[float], float]) -> float:
    """(2)."""
    return x_n - f(x_n) / df(x_n)


def eq_2_for_minima(x_n: float, df: Callable[[float], float], ddf: Callable[[float], float]) -> float:
    """Newton's step towards a zero of f′."""
    return x_n - df(x_n) / ddf(x_n)


def eq_3(e_P: Floats, e_O: Floats) -> Floats:
    """(3)."""
    return np.concatenate([e_P, e_O])


def eq_4(p_d: Floats, p_a: Floats) -> Floats:
    """(4)."""
    return p_d - p_a


def eq_5(euler_d: Floats, euler_a: Floats) -> Floats:
    """(5)."""
    return euler_d - euler_a


def eq_6(Q_d: Any, Q_a: Any) -> Any:
    """(6), of unit quaternions that know their product and inverse."""
    return Q_d * Q_a.inverse()


def eq_7() -> tuple[float, float, float, float]:
    """(7): ΔQ = (Δη, Δε) for Q_d = Q_a."""
    return (1.0, 0.0, 0.0, 0.0)


def eq_8(Q_d: Quaternion, Q_a: Quaternion) -> Floats:
    """(8): e_O = Δε."""
    (eta_d, eps_d), (eta_a, eps_a) = Q_d, Q_a
    return eta_a * eps_d - eta_d * eps_a - np.cross(eps_d, eps_a)


def eq_8_for_newton(Q_d: Quaternion, Q_a: Quaternion) -> Floats:
    """A rotation vector to first order, the short way round: 2 sgn(Δη) Δε."""
    (eta_d, eps_d), (eta_a, eps_a) = Q_d, Q_a
    return 2.0 * copysign(1.0, eta_d * eta_a + eps_d @ eps_a) * eq_8(Q_d, Q_a)


def eq_9(q_n: Any, e: Any, de_dq: Any) -> Any:
    """(9)."""
    return q_n - e / de_dq


def eq_10(drho_a_dq: Floats) -> Floats:
    """(10): de/dq."""
    return -drho_a_dq


def eq_11(rho_a: Callable[[Floats], Floats], q: Floats) -> Floats:
    """(11)."""
    return derivative(rho_a, q)


def eq_12(q_n: Floats, J: Floats, e: Floats) -> Floats:
    """(12)."""
    return q_n + np.linalg.inv(J) @ e


def eq_13(q_n: Floats, K: float, J: Floats, e: Floats) -> Floats:
    """(13)."""
    return q_n + K * (np.linalg.inv(J) @ e)


def eq_14(q_n: Floats, K: float, J: Floats, e: Floats) -> Floats:
    """(14)."""
    return q_n + K * (J.T @ e)


def eq_15(J: Floats) -> Floats:
    """(15): J⁺."""
    return J.T @ np.linalg.inv(J @ J.T)


def eq_15_any(J: Floats) -> Floats:
    """J⁺ of any matrix, from its singular values that are not zero."""
    U, stretch, Vt = np.linalg.svd(J, full_matrices=False)
    kept = stretch > 1e-10 * stretch[0]
    return np.asarray(Vt[kept].T @ np.diag(1.0 / stretch[kept]) @ U[:, kept].T)


def eq_16(q_n: Floats, K: float, J_pseudo: Floats, e: Floats) -> Floats:
    """(16)."""
    return q_n + K * (J_pseudo @ e)


def combination(transpose: Floats, pseudo: Floats, error: Callable[[Floats], float]) -> Floats:
    """Section 1.8: of the two next iterates the one with the smaller error."""
    return transpose if error(transpose) < error(pseudo) else pseudo


def singularities_taken() -> float:
    """Section 1.7: the share of singular configurations that the robot can take."""
    return 0.0


def singularities_taken_corrected() -> float:
    """All that are within its limits; it only cannot leave them in every direction."""
    return 1.0
