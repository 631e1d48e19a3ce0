"""Practicum, section 1: from the check matrix to the pseudo-inverse, (1) to (16), as printed and as they should be.

Joints `q` (n,) [rad]; an error `e` is what is wanted minus what is there, position [m] before orientation. A quaternion
is a pair: scalar part η and vector part ε.
"""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
import pinocchio as pin

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.practicum.practicum_sheet import arm, euler_jacobian, euler_pose, near_poses
from nao_kin.documents.samples import derivative, deviation, relative
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = [
    "CLAIMS",
    "JacobianColumn",
    "added_to_angles",
    "as_rotation_vector",
    "derivative_of_pose",
    "difference",
    "divided",
    "error_derivative",
    "minimum",
    "newton_on",
    "newton_step",
    "no_difference",
    "position_error",
    "quaternion_derivative",
    "stacking",
    "vector_part",
]

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


_COUNT, _SEED = 100, 6


def minimum(form: Form) -> Measured:
    """Convex bowls: does f at the place of the minimum give the least value?"""
    rng, off = np.random.default_rng(_SEED), []
    for _ in range(_COUNT):
        root, centre, least = rng.normal(size=(3, 3)), rng.normal(size=3), rng.normal()

        def f(x: Floats, root: Floats = root, centre: Floats = centre, least: float = least) -> float:
            return least + float(np.sum((root @ (x - centre)) ** 2))

        others = min(f(x) for x in rng.normal(size=(20, 3)))
        off += [float(form(f, centre)) - least, max(0.0, float(form(f, centre)) - others)]
    return Measured.worst(off)


def newton_on(valley: bool, derivatives: slice) -> Callable[[Form], Measured]:
    """Where ten iterations lead: to the zero of a rising function, or to the bottom of a valley above 0.

    Args:
        valley: Which of the two.
        derivatives: Which of f, f′ and f″ the form takes.
    """

    def check(form: Form) -> Measured:
        rng, off = np.random.default_rng(_SEED), []
        for _ in range(_COUNT):
            c, bend, scale = rng.uniform(-2.0, 2.0), rng.uniform(0.1, 0.5), rng.uniform(0.1, 1.0)
            x = c + rng.uniform(0.05, 0.3)
            functions = (_valley if valley else _rising)(c, bend, scale)[derivatives]
            for _ in range(10):
                x = form(x, *functions)
            off.append(x - c)
        return Measured.worst(off)

    return check


def _rising(c: float, bend: float, slope: float) -> tuple[Callable[[float], float], ...]:
    # With a slope of 1 at the zero, dividing by f′ and multiplying with it would lead there equally fast.
    return (
        lambda x: slope * (x - c) + bend * (x - c) ** 3,
        lambda x: slope + 3.0 * bend * (x - c) ** 2,
        lambda x: 6.0 * bend * (x - c),
    )


def _valley(c: float, bend: float, lift: float) -> tuple[Callable[[float], float], ...]:
    return (
        lambda x: lift + (x - c) ** 2 + bend * (x - c) ** 4,
        lambda x: 2.0 * (x - c) + 4.0 * bend * (x - c) ** 3,
        lambda x: 2.0 + 12.0 * bend * (x - c) ** 2,
    )


def stacking(form: Form) -> Measured:
    """The order of the six errors against the order of the Jacobian's rows."""
    off = []
    for q, _, _, _ in near_poses():
        there = arm().pose(q)

        def error(at: Floats, there: pin.SE3 = there) -> Floats:
            T = arm().pose(at)
            W = T.rotation @ there.rotation.T
            turn = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
            return np.asarray(form(T.translation - there.translation, turn))

        off.append(relative(derivative(error, q), arm().jacobian(q)))
    return Measured.worst(off)


def _pairs() -> Iterator[tuple[Floats, Floats]]:
    """Euler angles (3,) of pairs of orientations up to 0.3 rad apart in each angle [rad]."""
    rng = np.random.default_rng(_SEED)
    for _ in range(_COUNT):
        actual = rng.uniform((-2.8, -1.2, -2.8), (2.8, 1.2, 2.8))
        yield actual + rng.uniform(-0.3, 0.3, 3), actual


def _rotation(euler: Floats) -> Floats:
    return np.asarray(from_xyz_rpy(rpy=euler).rotation)


def position_error(form: Form) -> Measured:
    """Moving by the error against the wanted position."""
    rng = np.random.default_rng(_SEED)
    pairs = rng.normal(size=(_COUNT, 2, 3))
    return Measured.worst([deviation(p_a + form(p_d, p_a), p_d) for p_d, p_a in pairs])


def _turned(form: Form, step: float = 1.0) -> list[float]:
    """Share of the way to the wanted orientation that is left after turning by e_O as a rotation vector."""
    left = []
    for euler_d, euler_a in _pairs():
        wanted, start = _rotation(euler_a + step * (euler_d - euler_a)), _rotation(euler_a)
        turned = pin.exp3(form(euler_a + step * (euler_d - euler_a), euler_a)) @ start
        whole = np.linalg.norm(pin.log3(wanted @ start.T))
        left.append(float(np.linalg.norm(pin.log3(wanted @ turned.T)) / whole))
    return left


def as_rotation_vector(form: Form) -> Measured:
    """Turning by the error, as the geometric Jacobian's rows mean it."""
    large, small = _turned(form), _turned(form, 0.01)
    return Measured.worst(
        large,
        found=f"Turning by e_O leaves {100 * np.median(large):.0f} % of the way in the median for angles up to 0.3 rad "
        f"apart, and {100 * np.median(small):.0f} % for 0.003 rad.",
    )


def added_to_angles(form: Form) -> Measured:
    """Adding the error to the actual Euler angles against the wanted orientation."""
    return Measured.worst([deviation(_rotation(a + form(d, a)), _rotation(d)) for d, a in _pairs()])


def _quaternions() -> Iterator[tuple[pin.Quaternion, pin.Quaternion]]:
    rng = np.random.default_rng(_SEED)
    for pair in rng.normal(size=(_COUNT, 2, 4)):
        a, b = (pin.Quaternion(x / np.linalg.norm(x)) for x in pair)
        yield a, b


def _parts(Q: pin.Quaternion) -> tuple[float, Floats]:
    return Q.w, np.array([Q.x, Q.y, Q.z])


def difference(form: Form) -> Measured:
    """Turning by the difference against the wanted orientation."""
    return Measured.worst(
        [deviation(form(d, a).matrix() @ a.matrix(), d.matrix()) for d, a in _quaternions()],
    )


def no_difference(form: Form) -> Measured:
    """The stated quaternion against the product of each with its inverse."""
    stated = np.array(form())
    off = []
    for Q, _ in _quaternions():
        product = Q * Q.inverse()
        off.append(deviation(stated, (product.w, product.x, product.y, product.z)))
    turned = Q * pin.Quaternion(-Q.coeffs()).inverse()
    return Measured.worst(
        off, found=f"For Q_a = −Q_d, the same orientation, it is ({turned.w:.0f}, 0, 0, 0), and (8) is zero as well."
    )


def vector_part(form: Form) -> Measured:
    """Against the vector part of Pinocchio's product."""
    return Measured.worst(
        [deviation(form(_parts(d), _parts(a)), _parts(d * a.inverse())[1]) for d, a in _quaternions()]
    )


def quaternion_derivative(form: Form) -> Measured:
    """Derivative of e_O at the solution against −J of the orientation, which (10) and (11) put in its place."""
    off = []
    for q, _, _, _ in near_poses():
        Q_d = _parts(pin.Quaternion(arm().pose(q).rotation))

        def error(at: Floats, Q_d: tuple[float, Floats] = Q_d) -> Floats:
            return np.asarray(form(Q_d, _parts(pin.Quaternion(arm().pose(at).rotation))))

        off.append(relative(derivative(error, q), -arm().jacobian(q)[3:]))
    return Measured.worst(off, found=f"d e_O/dq is {1 - np.median(off):.2f} times what (10) says.")


class JacobianColumn:
    """A column whose division by a matrix means the matrix' inverse times the column."""

    def __init__(self, values: Floats) -> None:
        self.values = values

    def __truediv__(self, A: Floats) -> Floats:
        return np.asarray(np.linalg.solve(A, self.values))


def divided(of: Callable[[Floats], Any]) -> Callable[[Form], Measured]:
    """The step of (9) against the linear system, with the error as `of` makes it."""

    def check(form: Form) -> Measured:
        return Measured.worst([deviation(-J @ (form(q, of(e), -J) - q), -e) for q, J, e, _ in near_poses()])

    return check


def error_derivative(form: Form) -> Measured:
    """Against five-point differences of the error."""
    off = []
    for q, J, e, _ in near_poses():
        wanted = euler_pose(q) + e
        by_differences = derivative(lambda at, wanted=wanted: wanted - euler_pose(at), q)  # type: ignore[misc]
        off.append(relative(form(J), by_differences))
    return Measured.worst(off)


def derivative_of_pose(jacobian: Callable[[Floats], Floats]) -> Callable[[Form], Measured]:
    """The derivative of position and Euler angles against a Jacobian."""

    def check(form: Form) -> Measured:
        return Measured.worst([relative(form(euler_pose, q), jacobian(q)) for q, _, _, _ in near_poses()])

    return check


def newton_step(form: Form) -> Measured:
    """The step against the linear system that it solves, and what whole runs of it reach."""
    off = [deviation(J @ (form(q, J, e) - q), e) for q, J, e, _ in near_poses()]
    reached, taken = 0, list[int]()
    for q, _, e, _ in near_poses():
        wanted, at, k = euler_pose(q) + e, q, 0
        while k < 20 and deviation(euler_pose(at), wanted) > 1e-9:
            at, k = form(at, euler_jacobian(at), wanted - euler_pose(at)), k + 1
        reached += deviation(euler_pose(at), wanted) <= 1e-9
        taken.append(k)
    return Measured.worst(
        off, found=f"{reached} of {len(off)} poses are reached to 1e-9 m and rad, in {np.median(taken):.0f} steps."
    )


_PINOCCHIO: Final = "Pinocchio on the JACO2's model"
_NEAR: Final = "100 regular configurations of the JACO2, poses 0.05 rad away"
_ROTATIONS: Final = "100 pairs of random orientations"
_FUNCTIONS: Final = "100 functions with known zeros and minima, started 0.05 to 0.3 beside them, ten iterations"
_EULER: Final = "100 pairs of orientations 0.3 rad apart in each angle, pitch away from ±π/2; roll, pitch, yaw"


def _claim(number: str, said: str, formula: str, latex: str, form: Form, check: Check, **more: Any) -> Claim:
    return Claim(
        id=f"001:eq-{number}",
        place=f"equation ({number})",
        said=said,
        formula=formula,
        latex=latex,
        printed=form,
        check=check,
        **more,
    )


CLAIMS: Final = (
    _claim(
        "1",
        "The best arguments are those at which f takes its least value.",
        "f(x_Opt) = f_min",
        r"f(x_{\mathrm{Opt}}) = f_{\min}",
        eq_1,
        minimum,
        reference="convex functions with a known minimum",
        domain="100 quadratic bowls in three variables",
    ),
    _claim(
        "2",
        "Newton's iteration; the text and figure 2 let it search for the least f.",
        "x_{n+1} = x_n − f(x_n)/f′(x_n)",
        r"x_{n+1} = x_n - \frac{f(x_n)}{f'(x_n)}",
        eq_2,
        newton_on(valley=True, derivatives=slice(0, 2)),
        reference="functions with a known zero and a known minimum",
        domain=_FUNCTIONS,
        conventions={
            "f is the error whose zero is sought, as from (9) on": newton_on(valley=False, derivatives=slice(0, 2))
        },
    ),
    Claim(
        id="001:1.2-minimum",
        place="section 1.2, text and figure 2",
        said="The iteration (2) finds the minimum of f, by its derivative.",
        formula="x_{n+1} = x_n − f(x_n)/f′(x_n)  →  x_Opt",
        latex=r"x_{n+1} = x_n - \frac{f(x_n)}{f'(x_n)} \;\to\; x_{\mathrm{Opt}}",
        printed=eq_2,
        check=newton_on(valley=True, derivatives=slice(0, 2)),
        reference="functions with a known minimum above zero",
        domain=_FUNCTIONS,
        correction=Correction(
            eq_2_for_minima,
            "x_{n+1} = x_n − f′(x_n)/f″(x_n)",
            r"x_{n+1} = x_n - \frac{f'(x_n)}{f''(x_n)}",
            "(2) is a search for a zero of f; a minimum is a zero of f′.",
            newton_on(valley=True, derivatives=slice(1, 3)),
        ),
    ),
    _claim(
        "3",
        "The error has the position above and the orientation below.",
        "e = (e_P; e_O)",
        r"e = \begin{pmatrix} e_P \\ e_O \end{pmatrix}",
        eq_3,
        stacking,
        reference="the rows of Pinocchio's frame Jacobian, by five-point differences",
        domain=_NEAR,
    ),
    _claim(
        "4",
        "The position error is what is wanted minus what is there.",
        "e_P = p_d − p_a",
        r"e_P = p_d - p_a",
        eq_4,
        position_error,
        reference="moving by the error leads to the wanted position",
        domain="100 pairs of points",
    ),
    _claim(
        "5",
        "The orientation error as a difference of Euler angles, good for small steps.",
        "e_O = (φ_d, θ_d, ψ_d)ᵀ − (φ_a, θ_a, ψ_a)ᵀ",
        r"e_O = (\phi_d, \theta_d, \psi_d)^T - (\phi_a, \theta_a, \psi_a)^T",
        eq_5,
        as_rotation_vector,
        reference="rotation matrices; as it stands e_O is a rotation vector, as for the geometric Jacobian",
        domain=_EULER,
        conventions={"e_O is added to the Euler angles, so that J holds their derivatives": added_to_angles},
    ),
    _claim(
        "6",
        "The difference of two orientations as a quaternion.",
        "ΔQ = Q_d * Q_a⁻¹",
        r"\Delta Q = Q_d * Q_a^{-1}",
        eq_6,
        difference,
        reference="rotation matrices: R(ΔQ) R(Q_a) = R(Q_d)",
        domain=_ROTATIONS,
    ),
    _claim(
        "7",
        "For equal quaternions the difference is one.",
        "ΔQ = (1, 0, 0, 0)ᵀ",
        r"\Delta Q_d = (1, 0, 0, 0)^T",
        eq_7,
        no_difference,
        reference="the product of a quaternion with its inverse",
        domain="100 random orientations with Q_d = Q_a; equal orientations may also have Q_d = −Q_a",
    ),
    _claim(
        "8",
        "The vector part of the difference, as the error of the orientation.",
        "e_O = Δε = η_a ε_d − η_d ε_a − ε_d × ε_a",
        r"e_O = \Delta\epsilon = \eta_a(q)\,\epsilon_d - \eta_d\,\epsilon_a(q) - \epsilon_d \times \epsilon_a(q)",
        eq_8,
        vector_part,
        reference="the vector part of Q_d * Q_a⁻¹ by Pinocchio",
        domain=_ROTATIONS,
    ),
    Claim(
        id="001:1.3-quaternion-step",
        place="section 1.3, (8) put into (9) to (12)",
        said="With the quaternion error, de/dq is minus the Jacobian as well.",
        formula="d Δε/dq = −J",
        latex=r"\frac{d\,\Delta\epsilon}{dq} = -J",
        printed=eq_8,
        check=quaternion_derivative,
        reference="five-point differences of (8) at the solution, and the angular rows of Pinocchio's frame Jacobian",
        domain="100 configurations at the solution; away from it the derivative changes with the error",
        correction=Correction(
            eq_8_for_newton,
            "e_O = 2 sgn(Δη) Δε",
            r"e_O = 2 \operatorname{sgn}(\Delta\eta) \, \Delta\epsilon",
            "Δε is the sine of half the angle: with it alone every step goes half the way. The sign makes it the short "
            "way round.",
        ),
    ),
    _claim(
        "9",
        "Newton's iteration for the joints; e has six rows and de/dq is a matrix.",
        "q_{n+1} = q_n − e(q)/(de(q)/dq)",
        r"q_{n+1} = q_n - \frac{e(q)}{\frac{de(q)}{dq}}",
        eq_9,
        divided(lambda e: e),
        reference="the linear system (de/dq) Δq = −e by Pinocchio's Jacobian",
        domain=_NEAR,
        conventions={"dividing by a matrix means its inverse from the left": divided(JacobianColumn)},
    ),
    _claim(
        "10",
        "The wanted pose is constant, so only the actual one has a derivative.",
        "de/dq = d(ρ_d − ρ_a(q))/dq = −dρ_a/dq",
        r"\frac{de(q)}{dq} = \frac{d(\rho_d - \rho_a(q))}{dq} = -\frac{d\rho_a(q)}{dq}",
        eq_10,
        error_derivative,
        reference="five-point differences of the error of (4) and (5)",
        domain=_NEAR + "; not for the error of (8), see 001:1.3-quaternion-step",
    ),
    _claim(
        "11",
        "The Jacobian of the arm is the derivative of its pose.",
        "J(q) = dρ_a(q)/dq",
        r"J(q) = \frac{d\rho_a(q)}{dq}",
        eq_11,
        derivative_of_pose(lambda q: arm().jacobian(q)),
        reference=_PINOCCHIO + "; as it stands its geometric frame Jacobian, whose lower rows are angular velocities",
        domain=_NEAR,
        conventions={
            "the orientation is three Euler angles, so that J is the analytic Jacobian": derivative_of_pose(
                euler_jacobian
            )
        },
    ),
    _claim(
        "12",
        "Newton's iteration with (10) and (11) put in.",
        "q_{n+1} = q_n + J⁻¹ e(q)",
        r"q_{n+1} = q_n + J^{-1} e(q)",
        eq_12,
        newton_step,
        reference=_PINOCCHIO + ": J Δq = e",
        domain=_NEAR,
    ),
)
