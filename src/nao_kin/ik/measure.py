"""The judge's own measuring: how far a tip is from its target, written apart from what solvers minimise.

`measure` is compiled for the one result of `solve`; `measure_many` says the same in numpy, for batches.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.ik.target import ORIENTATION, POINTING, POSITION
from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["errors", "measure", "measure_many"]

_SMALL = 1e-6  # twice a sine
_LEAST = 1e-280  # [m²]: a sum of squares below has lost digits


@leaf_jit
def measure(
    kind: int,
    goal: Floats,
    counts: int,
    R: Floats,
    p: Floats,
    q: Floats,
    lower: Floats,
    upper: Floats,
    tolerance: float,
) -> tuple[float, float, bool]:
    """Errors of a pose, and whether the joints that lead to it are within their ranges.

    Returns the position error [m] and the rotation error [rad] over the axes that count, NaN where the target leaves it
    free, and whether every joint is finite and in its range, give or take the tolerance.

    The rotation error is the angle between the two orientations, or between the two axes of a pointing target. Where
    some rotation axes are left free, it is the length of the rest of the rotation vector.

    Args:
        kind: What is wanted, a value of `nao_kin.ik.target.KINDS`.
        goal: The target (4, 4), see `nao_kin.ik.target.Target`.
        counts: Bit i is set where axis i of `nao_kin.ik.target.AXES` counts.
        R: Rotation of the tip (3, 3).
        p: Position of the tip (3,) [m].
        q: Joints (n,) [rad or m].
        lower: Their least values (n,).
        upper: Their greatest values (n,).
        tolerance: How far outside still counts as inside [rad or m].
    """
    position, rotation = errors(kind, goal, counts, R, p)
    for k in range(q.shape[0]):
        if not (lower[k] - tolerance <= q[k] <= upper[k] + tolerance and abs(q[k]) < math.inf):
            return position, rotation, False
    return position, rotation, True


@leaf_jit
def errors(kind: int, goal: Floats, counts: int, R: Floats, p: Floats) -> tuple[float, float]:
    """Position error [m] and rotation error [rad] over the axes that count; see `measure`."""
    position = math.nan if kind == ORIENTATION else _distance(goal, counts, p)
    if kind == POSITION:
        return position, math.nan
    if kind == POINTING:
        cosine, squared = 0.0, 0.0
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            cosine += _now(R, goal, i) * goal[i, 1]
            squared += (_now(R, goal, j) * goal[k, 1] - _now(R, goal, k) * goal[j, 1]) ** 2
        return position, math.atan2(math.sqrt(squared), cosine)
    trace, squared = -1.0, 0.0
    for i in range(3):
        for a in range(3):
            trace += goal[i, a] * R[i, a]
        twice = _twice_sine(goal, R, i)
        squared += twice * twice
    sine = math.sqrt(squared)
    # A small angle is its sine, to thirteen digits.
    angle = 0.5 * sine if sine < _SMALL and trace > 0.0 else math.atan2(sine, trace)
    if counts >> 3 == 7:
        return position, angle
    counted = 0.0
    for i in range(3):
        if counts >> (3 + i) & 1:
            counted += _axis_squared(goal, R, i, sine, trace)
    return position, angle * math.sqrt(counted)


@leaf_jit
def _distance(goal: Floats, counts: int, p: Floats) -> float:
    """Distance over the axes that count [m]."""
    squared = 0.0
    for i in range(3):
        if counts >> i & 1:
            squared += (goal[i, 3] - p[i]) ** 2
    if _LEAST < squared < math.inf or squared == 0.0:
        return math.sqrt(squared)
    distance = 0.0
    for i in range(3):  # hypot, because squares of what is far or near overflow or vanish
        if counts >> i & 1:
            distance = math.hypot(distance, goal[i, 3] - p[i])
    return distance


@leaf_jit
def _turn(goal: Floats, R: Floats, i: int, j: int) -> float:
    """Entry of R_goal Rᵀ, the turn in base axes that is missing."""
    entry: float = goal[i, 0] * R[j, 0] + goal[i, 1] * R[j, 1] + goal[i, 2] * R[j, 2]
    return entry


@leaf_jit
def _twice_sine(goal: Floats, R: Floats, i: int) -> float:
    """Entry i of the missing turn's axis times twice the sine of its angle: the skew part of R_goal Rᵀ."""
    j, k = (i + 1) % 3, (i + 2) % 3
    return _turn(goal, R, k, j) - _turn(goal, R, j, k)


@leaf_jit
def _axis_squared(goal: Floats, R: Floats, i: int, sine: float, trace: float) -> float:
    """Squared entry i of the missing turn's axis; `sine` and `trace` are twice its angle's sine and cosine."""
    if trace > 0.0:
        return (_twice_sine(goal, R, i) / sine) ** 2 if sine > 0.0 else 0.0
    # Beyond a quarter turn the diagonal tells it better: E_ii = cos + (1 − cos) a_i².
    cosine = 0.5 * trace
    return max(0.0, (_turn(goal, R, i, i) - cosine) / (1.0 - cosine))


@leaf_jit
def _now(R: Floats, goal: Floats, i: int) -> float:
    """Entry i of the pointing axis as it is now, in base axes."""
    entry: float = R[i, 0] * goal[0, 0] + R[i, 1] * goal[1, 0] + R[i, 2] * goal[2, 0]
    return entry


def measure_many(kind: int, goals: Floats, counts: int, tips: Floats) -> tuple[Floats, Floats]:
    """`measure` of each goal (N, 4, 4) and tip (N, 4, 4): position errors (N,) [m] and rotation errors (N,) [rad]."""
    counted_axes = np.array([bool(counts >> i & 1) for i in range(6)])
    free = np.full(len(goals), np.nan)
    missing = goals[:, :3, 3] - tips[:, :3, 3]
    position = free if kind == ORIENTATION else np.hypot.reduce(missing[:, counted_axes[:3]], axis=1)
    if kind == POSITION:
        return position, free
    if kind == POINTING:
        axes, wanted = np.einsum("nij,nj->ni", tips[:, :3, :3], goals[:, :3, 0]), goals[:, :3, 1]
        sine = np.linalg.norm(np.cross(axes, wanted), axis=1)
        return position, np.arctan2(sine, np.einsum("ni,ni->n", axes, wanted))
    E = np.einsum("nij,nkj->nik", goals[:, :3, :3], tips[:, :3, :3])
    twice = np.stack([E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]], axis=1)
    sine, trace = np.linalg.norm(twice, axis=1), np.einsum("nii->n", E) - 1.0
    angle = np.arctan2(sine, trace)
    if counted_axes[3:].all():
        return position, angle
    partly = [errors(kind, goal, counts, T[:3, :3], T[:3, 3])[1] for goal, T in zip(goals, tips, strict=True)]
    return position, np.array(partly, dtype=np.float64)
