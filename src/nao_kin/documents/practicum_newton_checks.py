"""Practicum, sections 1.2 and 1.3: how (1) to (12) are held against functions, rotations and the JACO2 by Pinocchio."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from nao_kin.documents.claim import Measured
from nao_kin.documents.practicum_cases import arm, euler_jacobian, euler_pose, near_poses
from nao_kin.documents.samples import derivative, deviation, relative
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Form

__all__ = [
    "Column",
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


class Column:
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
