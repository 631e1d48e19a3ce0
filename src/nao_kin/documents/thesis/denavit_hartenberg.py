"""Bischoff 2016, section 2.2.2: Denavit and Hartenberg's description, (2.2.2.1) to (2.2.2.10), as printed."""

from __future__ import annotations

import math
from math import cos, sin
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin
from numpy import dot

from nao_kin.documents.claim import Claim, Measured
from nao_kin.documents.samples import deviation
from nao_kin.se3 import rotation_x, rotation_z, translation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS", "eq_2_2_2_6"]

_COUNT, _SEED = 200, 2220


def eq_2_2_2_1(d: float) -> Floats:
    """(2.2.2.1): T_d, along z."""
    return np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])


def eq_2_2_2_2(t: float) -> Floats:
    """(2.2.2.2): R_z,θ."""
    return np.array([[cos(t), -sin(t), 0, 0], [sin(t), cos(t), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def eq_2_2_2_3(a: float) -> Floats:
    """(2.2.2.3): T_a, along x."""
    return np.array([[1, 0, 0, a], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def eq_2_2_2_4(alpha: float) -> Floats:
    """(2.2.2.4): R_x,α."""
    ca, sa = cos(alpha), sin(alpha)
    return np.array([[1, 0, 0, 0], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])


def eq_2_2_2_5(a: float, alpha: float, d: float, t: float) -> Floats:
    """(2.2.2.5): the four in their order."""
    return eq_2_2_2_1(d) @ eq_2_2_2_2(t) @ eq_2_2_2_3(a) @ eq_2_2_2_4(alpha)


def eq_2_2_2_6(a: float, alpha: float, d: float, t: float) -> Floats:
    """(2.2.2.6): the same multiplied out."""
    c, s, ca, sa = cos(t), sin(t), cos(alpha), sin(alpha)
    return np.array([[c, -ca * s, sa * s, a * c], [s, ca * c, -sa * c, a * s], [0, sa, ca, d], [0, 0, 0, 1]])


def eq_2_2_2_7(a: float, alpha: float, d: float, t: float) -> Floats:
    """(2.2.2.7): its inverse."""
    c, s, ca, sa = cos(t), sin(t), cos(alpha), sin(alpha)
    return np.array([[c, s, 0, -a], [-ca * s, ca * c, sa, -d * sa], [sa * s, -sa * c, ca, -d * ca], [0, 0, 0, 1]])


def eq_2_2_2_8(matrices: Sequence[Floats]) -> Floats:
    """(2.2.2.8): A_0^n."""
    product = matrices[0]
    for matrix in matrices[1:]:
        product = product @ matrix
    return product


def eq_2_2_2_9(A: Floats, o: Floats) -> Floats:
    """(2.2.2.9): the position, of the chain's matrix and the local origin."""
    return A @ o


def eq_2_2_2_10(thetas: Sequence[float], A: Callable[[int, float], Floats], o: Floats) -> Floats:
    """(2.2.2.10): f(θ_0, …, θ_n) = A_0^n(θ_0, …, θ_n) o_n, A_{i−1}^i turning by θ_i."""
    return eq_2_2_2_8([A(i, thetas[i]) for i in range(1, len(thetas))]) @ o


def dh_parameters(T_0: Floats, T_1: Floats) -> tuple[float, float, float, float]:
    """The definitions of a, α, d and θ, read off two frames laid as the rules say."""
    z_0, z_1, x_0, x_1 = T_0[:3, 2], T_1[:3, 2], T_0[:3, 0], T_1[:3, 0]
    between = T_1[:3, 3] - T_0[:3, 3]
    common = np.cross(z_0, z_1)
    a = abs(dot(between, common)) / np.linalg.norm(common)
    alpha = math.atan2(dot(common, x_1), dot(z_0, z_1))
    d = dot(between, z_0)  # x_1 is square to z_0, so going along it changes nothing
    theta = math.atan2(dot(np.cross(x_0, x_1), z_0), dot(x_0, x_1))
    return float(a), alpha, float(d), theta


def _parameters(rng: np.random.Generator) -> tuple[float, float, float, float]:
    """Random a ≥ 0, α, d, θ; lengths within 1, so that every term counts."""
    a, d = rng.uniform(0.05, 1.0), rng.uniform(-1.0, 1.0)
    return a, rng.uniform(0.1, 3.0) * rng.choice([-1.0, 1.0]), d, rng.uniform(-3.0, 3.0)


def _by_pinocchio(a: float, alpha: float, d: float, t: float) -> Floats:
    screws = (translation(0.0, 0.0, d), rotation_z(t), translation(a, 0.0, 0.0), rotation_x(alpha))
    product = pin.SE3.Identity()
    for screw in screws:
        product = product * screw
    return np.asarray(product.homogeneous)


def _against(reference: Callable[[float], pin.SE3], size: float) -> Check:
    def check(form: Form) -> Measured:
        values = np.random.default_rng(_SEED).uniform(-size, size, _COUNT)
        return Measured.worst(deviation(form(x), reference(x).homogeneous) for x in values)

    return check


def _link(wanted: Callable[[Floats], Floats]) -> Check:
    def check(form: Form) -> Measured:
        rng = np.random.default_rng(_SEED)
        rows = [_parameters(rng) for _ in range(_COUNT)]
        return Measured.worst(deviation(form(*row), wanted(_by_pinocchio(*row))) for row in rows)

    return check


def _inverted(T: Floats) -> Floats:
    return np.asarray(np.linalg.inv(T), dtype=np.float64)


def _product(form: Form) -> Measured:
    """Frame by frame from the tip, each frame's origin and axes carried by Pinocchio."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        links = [pin.SE3(_by_pinocchio(*_parameters(rng))) for _ in range(int(rng.integers(2, 7)))]
        T = links[-1]
        for link in links[-2::-1]:
            T = link.act(T)
        errors.append(deviation(form([link.homogeneous for link in links]), T.homogeneous))
    return Measured.worst(errors)


def _origin(o: tuple[float, ...]) -> Check:
    def check(form: Form) -> Measured:
        rng, errors = np.random.default_rng(_SEED), list[float]()
        for _ in range(_COUNT):
            T = pin.SE3(_by_pinocchio(*_parameters(rng)))
            errors.append(deviation(form(T.homogeneous, np.array(o))[:3], T.translation))
        return Measured.worst(errors)

    return check


def _function(o: tuple[float, ...]) -> Check:
    def check(form: Form) -> Measured:
        rng, errors = np.random.default_rng(_SEED), list[float]()
        for _ in range(_COUNT // 4):
            n = int(rng.integers(1, 6))
            rows, thetas = [_parameters(rng) for _ in range(n)], rng.uniform(-3.0, 3.0, n + 1)
            T = pin.SE3.Identity()
            for row, theta in zip(rows, thetas[1:], strict=True):
                T = T * pin.SE3(_by_pinocchio(row[0], row[1], row[2], theta))
            p = form(thetas, _turning(rows), np.array(o))
            errors.append(deviation(p[:3], T.translation))
        return Measured.worst(errors)

    return check


def _turning(rows: Sequence[tuple[float, float, float, float]]) -> Callable[[int, float], Floats]:
    """A_{i−1}^i as a function of i and its angle."""
    return lambda i, theta: _by_pinocchio(*rows[i - 1][:3], theta)


def _definitions(form: Form) -> Measured:
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        row, T_0 = _parameters(rng), pin.SE3(_by_pinocchio(*_parameters(rng)))
        found = form(T_0.homogeneous, (T_0 * pin.SE3(_by_pinocchio(*row))).homogeneous)
        errors.append(deviation(found, row))
    return Measured.worst(errors)


_LENGTHS = "200 lengths within ±1; holds for all"
_TURNS = "200 angles in [−π, π]; holds for all"
_LINKS = "200 links, a in [0.05, 1], d within ±1, any α and θ; holds for all"
_SE3 = "Pinocchio's SE3"
_HOMOGENEOUS: Final = "o_n is the null vector extended to (0, 0, 0, 1)ᵀ, as section 2.2.1 extends every position"

CLAIMS: Final = (
    Claim(
        id="000:2.2.2.1",
        place="equation (2.2.2.1)",
        said="The translation along z by d_n.",
        formula="T_d = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]]",
        latex=r"T_{\vec d_n} = \begin{pmatrix}1&0&0&0\\0&1&0&0\\0&0&1&d_n\\0&0&0&1\end{pmatrix}",
        printed=eq_2_2_2_1,
        check=_against(lambda x: translation(0.0, 0.0, x), 1.0),
        reference=_SE3,
        domain=_LENGTHS,
    ),
    Claim(
        id="000:2.2.2.2",
        place="equation (2.2.2.2)",
        said="The rotation about z by θ_n, homogeneous.",
        formula="R_z,θ = [[c, −s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        latex=r"R_{z,\theta_n} = \begin{pmatrix}\cos\theta_n&-\sin\theta_n&0&0\\"
        r"\sin\theta_n&\cos\theta_n&0&0\\0&0&1&0\\0&0&0&1\end{pmatrix}",
        printed=eq_2_2_2_2,
        check=_against(rotation_z, math.pi),
        reference=_SE3,
        domain=_TURNS,
    ),
    Claim(
        id="000:2.2.2.3",
        place="equation (2.2.2.3)",
        said="The translation along the new x by a_n.",
        formula="T_a = [[1, 0, 0, a], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        latex=r"T_{\vec a_n} = \begin{pmatrix}1&0&0&a_n\\0&1&0&0\\0&0&1&0\\0&0&0&1\end{pmatrix}",
        printed=eq_2_2_2_3,
        check=_against(lambda x: translation(x, 0.0, 0.0), 1.0),
        reference=_SE3,
        domain=_LENGTHS,
    ),
    Claim(
        id="000:2.2.2.4",
        place="equation (2.2.2.4)",
        said="The rotation about the new x by α_n, homogeneous.",
        formula="R_x,α = [[1, 0, 0, 0], [0, cα, −sα, 0], [0, sα, cα, 0], [0, 0, 0, 1]]",
        latex=r"R_{x,\alpha_n} = \begin{pmatrix}1&0&0&0\\0&\cos\alpha_n&-\sin\alpha_n&0\\"
        r"0&\sin\alpha_n&\cos\alpha_n&0\\0&0&0&1\end{pmatrix}",
        printed=eq_2_2_2_4,
        check=_against(rotation_x, math.pi),
        reference=_SE3,
        domain=_TURNS,
    ),
    Claim(
        id="000:2.2.2.5",
        place="equation (2.2.2.5)",
        said="The DH matrix is the product of the four in the standard (distal) order.",
        formula="A_{n−1}^n = T_d R_z,θ T_a R_x,α",
        latex=r"A_{n-1}^n = T_{\vec d_n} R_{z,\theta_n} T_{\vec a_n} R_{x,\alpha_n}",
        printed=eq_2_2_2_5,
        check=_link(lambda T: T),
        reference="the same motions composed by Pinocchio",
        domain=_LINKS,
    ),
    Claim(
        id="000:2.2.2.6",
        place="equation (2.2.2.6)",
        said="The same multiplied out.",
        formula="A_{n−1}^n = [[c, −cα s, sα s, a c], [s, cα c, −sα c, a s],\n"
        "             [0, sα, cα, d], [0, 0, 0, 1]]",
        latex=r"A_{n-1}^n = \begin{pmatrix} c & -c_\alpha s & s_\alpha s & a_n c \\ s & c_\alpha c & -s_\alpha c"
        r" & a_n s \\ 0 & s_\alpha & c_\alpha & d_n \\ 0&0&0&1 \end{pmatrix}",
        printed=eq_2_2_2_6,
        check=_link(lambda T: T),
        reference="the four motions composed by Pinocchio",
        domain=_LINKS,
    ),
    Claim(
        id="000:2.2.2.7",
        place="equation (2.2.2.7)",
        said="The inverse of the DH matrix.",
        formula="(A_{n−1}^n)⁻¹ = [[c, s, 0, −a], [−cα s, cα c, sα, −d sα],\n"
        "                 [sα s, −sα c, cα, −d cα], [0, 0, 0, 1]]",
        latex=r"(A_{n-1}^n)^{-1} = \begin{pmatrix} c & s & 0 & -a_n \\ -c_\alpha s & c_\alpha c & s_\alpha"
        r" & -d_n s_\alpha \\ s_\alpha s & -s_\alpha c & c_\alpha & -d_n c_\alpha \\ 0&0&0&1 \end{pmatrix}",
        printed=eq_2_2_2_7,
        check=_link(_inverted),
        reference="Gauss elimination (LAPACK) of the motions composed by Pinocchio",
        domain=_LINKS,
    ),
    Claim(
        id="000:2.2.2.8",
        place="equation (2.2.2.8)",
        said="A chain is the product of its links in their order.",
        formula="A_0^n = A_0^1 A_1^2 A_2^3 … A_{n−1}^n",
        latex=r"A_0^n = A_0^1 A_1^2 A_2^3 \cdots A_{n-1}^n",
        printed=eq_2_2_2_8,
        check=_product,
        reference="frames carried link by link from the tip (Pinocchio)",
        domain="200 chains of 2 to 6 random links; holds for all",
    ),
    Claim(
        id="000:2.2.2.9",
        place="equation (2.2.2.9)",
        said="The chain's matrix times the local origin, the null vector, is the tip's position.",
        formula="p_0 = A_0^n o_n",
        latex=r"\vec p_0 = A_0^n \vec o_n",
        printed=eq_2_2_2_9,
        check=_origin((0.0, 0.0, 0.0, 0.0)),
        reference="translation of Pinocchio's SE3",
        domain=_LINKS,
        conventions={_HOMOGENEOUS: _origin((0.0, 0.0, 0.0, 1.0))},
    ),
    Claim(
        id="000:2.2.2.10",
        place="equation (2.2.2.10)",
        said="The position is a function of the joint angles alone.",
        formula="p = f(θ_0, θ_1, …, θ_n) = A_0^n(θ_0, θ_1, …, θ_n) o_n",
        latex=r"\vec p = f(\theta_0, \ldots, \theta_n) = A_0^n(\theta_0, \ldots, \theta_n)\, \vec o_n",
        printed=eq_2_2_2_10,
        check=_function((0.0, 0.0, 0.0, 0.0)),
        reference="forward kinematics link by link (Pinocchio)",
        domain="50 chains of 1 to 5 random links",
        conventions={f"{_HOMOGENEOUS}, and θ_0 is idle: n matrices turn by θ_1 … θ_n": _function((0.0, 0.0, 0.0, 1.0))},
    ),
    Claim(
        id="000:2.2.2-dh-rules",
        place="rules 1 to 4 and the definitions of the parameters",
        said="Frames laid by the four rules have the defined a, α, d and θ as parameters of (2.2.2.6).",
        formula="a_n: shortest distance of z_{n−1} and z_n\nα_n: angle from z_{n−1} to z_n about x_n\n"
        "d_n: along z_{n−1} from O_{n−1} to its meeting with x_n\nθ_n: joint angle about z_{n−1}",
        printed=dh_parameters,
        check=_definitions,
        reference="the parameters from which the frames were made by Pinocchio",
        domain="200 links, a in [0.05, 1], d within ±1, α not 0; holds for a ≥ 0, which is what “points away from it”"
        " says of x, and not for tables with a negative a. d is signed; with α = 0 the rules leave it free",
    ),
)
