"""Any six turning joints: elimination of all but one joint, as an eigenvalue problem.

The last joint drops out of six quantities of its axis: its direction l, a point p on it, p·p, p·l, p × l and
(p·p) l − 2 (p·l) p, fourteen numbers. Seen from the link between joints 2 and 3, they are products of sines and cosines
of q1, q2 on one side and of q3, q4, q5 on the other (Raghavan and Roth 1990). The eight products of q1, q2 are
eliminated by the left null space; with half angles for q4 and q5, six equations and the same times x4 are a square
matrix polynomial of q3, whose roots are the eigenvalues of a pencil (Manocha and Canny 1994).

The coefficients are never derived: both sides are trigonometric polynomials of degree 1 in each angle, so three samples
an angle tell them. Half angles cannot say π, and are ill-conditioned near it; so the elimination is done for a few
shifts of the angles and the union of the solutions kept, each moved on to the arm by Newton's steps and certified.

Where axes are nearly parallel or nearly meet, the fourteen are nearly dependent and the elimination loses roots. So
Levenberg's method starts from many points beside it, and what it finds is kept too.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, screws
from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.analytic.six_r import shared as layout
from nao_kin.analytic.six_r.shared import CERTIFIED, goal_of, reach, refined, settle, wandered
from nao_kin.analytic.triangle import FAR
from nao_kin.arrays import Floats
from nao_kin.kernels.motion import packed_joints

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.kernels.joint_path import JointPath
    from nao_kin.kernels.rotation import Nine, Three

__all__ = ["BRANCHES", "LABELS", "SINGULARITIES", "recognise", "solve", "solve_many"]

BRANCHES: Final = 16
LABELS: Final = tuple(f"root {k + 1}" for k in range(BRANCHES))
"""An arm without structure has no shoulder and no elbow to speak of; roots are numbered by their first joint."""

SINGULARITIES: Final = ("", "one of a continuum")
_STARTS: Final = 512  # of Levenberg's method
_SHIFTS: Final = ((0.3, 1.1, -0.7, 2.3, -1.9), (-1.4, 0.4, 2.0, -0.6, 1.2), (2.6, -2.2, 0.9, 0.5, -0.2))
_REAL: Final = 1e-2  # imaginary part of a half angle's root, relative, up to which Newton is to decide
_SAME: Final = 1e-6  # [rad]
_SINGULAR: Final = 1e-5  # least singular value [m/rad, 1] below which solutions this near are one:
_CLUSTER: Final = 1e-2  # [rad]
_THIRDS: Final = 2.0 * math.pi / 3.0 * np.arange(3)
# Values at three angles to the coefficients of 1, cosine and sine.
_FIT: Final = np.linalg.inv(np.stack([np.ones(3), np.cos(_THIRDS), np.sin(_THIRDS)], axis=1))
# 1, cosine and sine times (1 + x²), as coefficients of 1, x and x².
_HALF: Final = np.array([[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 2.0, 0.0]])


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The arm's screws for `solve`, of any six turning joints."""
    arm = screws(path, 6)
    if isinstance(arm, Mismatch):
        return arm
    numbers = np.zeros(layout.SIZE)
    numbers[layout.TIP : layout.AXES] = *arm.tip[:3, :3].ravel(), *arm.tip[:3, 3]
    numbers[layout.AXES : layout.POINTS], numbers[layout.POINTS : layout.OWN_AXES] = (
        arm.axes.ravel(),
        arm.points.ravel(),
    )
    numbers[layout.OWN_AXES : layout.ACROSS] = *arm.axes.ravel(), *arm.points.ravel()
    numbers[layout.MIDDLES : layout.UPPER], _ = middles_and_halves(path.lower, path.upper)
    size = float(np.linalg.norm(np.diff(arm.points, axis=0), axis=1).sum())
    numbers[layout.SCALE], numbers[layout.SENSES : layout.FOREARM] = max(size, 1e-3), 1.0
    numbers[layout.JOINTS : layout.SIZE] = packed_joints(path).ravel()
    return Geometry(numbers, 0.0)


def solve_many(
    arm: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4), rows (N, 16, 8) and counts (N,), one after the other."""
    for i in range(len(goals)):
        counts[i] = solve(arm, kind, goals[i], given[0], slack, rows[i])


def solve(arm: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of a pose; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    R, t = goal_of(arm, goal)
    G = np.eye(4)
    G[:3, :3], G[:3, 3] = np.reshape(R, (3, 3)), t
    if not np.abs(G).max() < math.sqrt(FAR) or np.linalg.norm(t) > 1e6 * arm[layout.SCALE]:
        return 0
    found: list[Floats] = []
    for shift in _SHIFTS:
        for q in _roots(_screws(arm), G, np.array(shift)):
            _keep(arm, (R, t), q, found)
    starts = _starts().copy()
    for q in starts[: wandered(arm, (R, t), starts)]:
        _add(q, found)
    isolated, continuum = _told_apart(arm, found)
    isolated.sort(key=lambda q: float(q[0]))
    kept = (isolated + continuum)[:BRANCHES]
    for i, q in enumerate(kept):
        rows[i, :6], rows[i, 6], rows[i, 7] = q, i, float(i >= len(isolated)) + layout.ROUGH
    return refined(arm, np.ascontiguousarray(goal), rows, len(kept))


def _told_apart(arm: Floats, found: list[Floats]) -> tuple[list[Floats], list[Floats]]:
    """Isolated solutions, and one for a continuum if there is one.

    Where the arm is singular, Newton stops anywhere near a double root, or anywhere on a continuum; the former are one.
    """
    isolated, singular, J = list[Floats](), list[Floats](), np.empty((6, 6))
    for q in found:
        reach(arm, q, J)
        if np.linalg.svd(J, compute_uv=False)[-1] > _SINGULAR:
            isolated.append(q)
        elif all(_apart(q, other) > _CLUSTER for other in singular):
            singular.append(q)
    return (isolated, singular[:1]) if len(isolated) + len(singular) > BRANCHES else (isolated + singular, [])


def _apart(q: Floats, other: Floats) -> float:
    return float(np.abs(np.remainder(q - other + math.pi, 2.0 * math.pi) - math.pi).max())


@cache
def _starts() -> Floats:
    """Joints (N, 6) [rad] spread evenly: a Kronecker sequence of the roots of x⁷ = x + 1 (Roberts 2018)."""
    steps = 1.1127756842787055 ** -np.arange(1.0, 7.0)
    return np.ascontiguousarray(
        2.0 * math.pi * ((0.5 + np.arange(1.0, _STARTS + 1.0)[:, None] * steps) % 1.0) - math.pi
    )


def _screws(arm: Floats) -> Screws:
    axes = arm[layout.AXES : layout.POINTS].reshape(6, 3)
    return Screws(axes, arm[layout.POINTS : layout.OWN_AXES].reshape(6, 3), np.eye(4))


def _keep(arm: Floats, G: tuple[Nine, Three], q: Floats, found: list[Floats]) -> None:
    """Adds a root, moved on to the arm, if it is a solution and is not there yet."""
    if not np.isfinite(q).all():
        return
    q = np.ascontiguousarray(q)
    if not settle(arm, G, q, np.empty((3, 6, 6))) < CERTIFIED:
        return
    _add(q, found)


def _add(q: Floats, found: list[Floats]) -> None:
    """Adds a solution that is not there yet."""
    q = np.remainder(q + math.pi, 2.0 * math.pi) - math.pi
    if all(_apart(q, other) > _SAME for other in found):
        found.append(q)


def _roots(arm: Screws, G: Floats, shift: Floats) -> Floats:
    """Candidates (M, 6) [rad] from one elimination, half angles being taken of q − shift."""
    left = _fitted(_seen_through_two(arm, G, shift), 2)  # (3, 3, 14): 1, cos, sin of q1 and of q2
    right = _fitted(_seen_through_three(arm, shift), 3)  # (3, 3, 3, 14)
    moving = left.reshape(9, 14)[1:].T  # all but the constant, (14, 8)
    right[0, 0, 0] -= left[0, 0]
    U, sizes, _ = np.linalg.svd(moving)
    null = U[:, 8:]
    if sizes[-1] < 1e-9 * sizes[0]:  # fewer products matter, so more equations are left than are needed
        null = U[:, -6:]
    six = np.einsum("abce,en->nabc", right, null)  # 1, cos, sin of q3, q4, q5
    six = np.einsum("nabc,ai,bj,ck->nijk", six, _HALF, _HALF, _HALF)  # powers of x3, x4, x5
    square = np.zeros((3, 12, 4, 3))
    square[:, :6, :3], square[:, 6:, 1:] = six.transpose(1, 0, 2, 3), six.transpose(1, 0, 2, 3)
    C, B, A = square.reshape(3, 12, 12)
    values, vectors = _pencil(A, B, C)
    vectors = vectors.reshape(4, 3, len(values))
    with np.errstate(all="ignore"):
        x = np.stack([values, _ratio(vectors[1:], vectors[:-1]), _ratio(vectors[:, 1:], vectors[:, :-1])])
        real = (np.abs(x.imag) < _REAL * (1.0 + np.abs(x))).all(axis=0) & np.isfinite(x).all(axis=0)
    q345 = 2.0 * np.arctan(x.real[:, real].T)
    return _completed(arm, G, shift, left, right, q345)


def _ratio(above: NDArray[np.complex128], below: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The factor between two parts of each vector, in the sense of least squares."""
    above, below = np.moveaxis(above, -1, 0), np.moveaxis(below, -1, 0)
    return np.asarray((above * below.conj()).sum(axis=(1, 2)) / (below * below.conj()).sum(axis=(1, 2)))


def _pencil(A: Floats, B: Floats, C: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Numbers x and vectors v (12, M) with (A x² + B x + C) v = 0.

    A substitution x = (y + s) / (1 − s y), which turns the half angle, makes the leading matrix well conditioned.
    """
    best, turned = math.inf, (A, B, C, 0.0)
    for s in (0.0, 0.6, -1.1, 2.3):
        a = A - s * B + s * s * C
        b = 2.0 * s * (A - C) + (1.0 - s * s) * B
        c = s * s * A + s * B + C
        condition = float(np.linalg.cond(a))
        if condition < best:
            best, turned = condition, (a, b, c, s)
    a, b, c, s = turned
    try:
        companion = np.block([[np.zeros((12, 12)), np.eye(12)], [-np.linalg.solve(a, c), -np.linalg.solve(a, b)]])
        y, vectors = (part.astype(np.complex128) for part in np.linalg.eig(companion))
    except np.linalg.LinAlgError:
        return np.zeros(0, dtype=np.complex128), np.zeros((12, 0), dtype=np.complex128)
    first = np.abs(y) <= 1.0
    with np.errstate(all="ignore"):
        return (y + s) / (1.0 - s * y), np.where(first, vectors[:12], vectors[12:])


def _completed(arm: Screws, G: Floats, shift: Floats, left: Floats, right: Floats, q345: Floats) -> Floats:
    """The other three joints of candidates for q3, q4 and q5 less their shifts (M, 3)."""
    found = np.empty((len(q345), 6))
    for row, angles in zip(found, q345, strict=True):
        c3, c4, c5 = (np.array([1.0, math.cos(a), math.sin(a)]) for a in angles)
        wanted = np.einsum("abce,a,b,c->e", right, c3, c4, c5)
        products, *_ = np.linalg.lstsq(left.reshape(9, 14)[1:].T, wanted, rcond=1e-10)
        table = np.array([1.0, *products]).reshape(3, 3)
        row[0] = math.atan2(table[2, 0], table[1, 0]) + shift[0]
        row[1] = math.atan2(table[0, 2], table[0, 1]) + shift[1]
        row[2:5] = angles + shift[2:5]
        row[5] = _last(arm, G, row)
    return found


def _last(arm: Screws, G: Floats, q: Floats) -> float:
    """The last joint, of the other five."""
    R = np.eye(3)
    for k in range(5):
        R = R @ _turn(arm.axes[k], q[k])
    E, axis = R.T @ G[:3, :3], arm.axes[5]
    sine = 0.5 * float(axis @ [E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    return math.atan2(sine, 0.5 * (float(np.trace(E)) - 1.0))


def _fourteen(p: Floats, l: Floats) -> Floats:  # noqa: E741
    """What stays of an axis through p along l (…, 3) when it turns about itself, (…, 14)."""
    square, along = (p * p).sum(axis=-1, keepdims=True), (p * l).sum(axis=-1, keepdims=True)
    return np.concatenate([l, p, square, along, np.cross(p, l), square * l - 2.0 * along * p], axis=-1)


def _seen_through_two(arm: Screws, G: Floats, shift: Floats) -> Floats:
    """The fourteen of the last axis in its goal, seen from the link behind joint 2, at three angles of q1 and q2."""
    p, l = G[:3, :3] @ arm.points[5] + G[:3, 3], G[:3, :3] @ arm.axes[5]  # noqa: E741
    values = np.empty((3, 3, 14))
    for i, first in enumerate(_THIRDS):
        back = _turn(arm.axes[0], -(first + shift[0]))
        seen, along = back @ (p - arm.points[0]) + arm.points[0], back @ l
        for j, second in enumerate(_THIRDS):
            back2 = _turn(arm.axes[1], -(second + shift[1]))
            values[i, j] = _fourteen(back2 @ (seen - arm.points[1]) + arm.points[1] - arm.points[2], back2 @ along)
    return values


def _seen_through_three(arm: Screws, shift: Floats) -> Floats:
    """The fourteen of the last axis at three angles of q3, q4 and q5, seen from the same link."""
    values = np.empty((3, 3, 3, 14))
    for k, fifth in enumerate(_THIRDS):
        R5 = _turn(arm.axes[4], fifth + shift[4])
        p5, l5 = R5 @ (arm.points[5] - arm.points[4]) + arm.points[4], R5 @ arm.axes[5]
        for j, fourth in enumerate(_THIRDS):
            R4 = _turn(arm.axes[3], fourth + shift[3])
            p4, l4 = R4 @ (p5 - arm.points[3]) + arm.points[3], R4 @ l5
            for i, third in enumerate(_THIRDS):
                R3 = _turn(arm.axes[2], third + shift[2])
                values[i, j, k] = _fourteen(R3 @ (p4 - arm.points[2]), R3 @ l4)
    return values


def _fitted(values: Floats, angles: int) -> Floats:
    """Values at three angles each to coefficients of 1, cosine and sine."""
    for k in range(angles):
        values = np.moveaxis(np.tensordot(_FIT, values, axes=(1, k)), 0, k)
    return values


def _turn(axis: Floats, angle: float) -> Floats:
    """The rotation about a unit axis (3, 3)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K))
