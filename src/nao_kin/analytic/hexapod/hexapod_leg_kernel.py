"""The compiled half of `nao_kin.analytic.hexapod.hexapod_leg`: a foot's position to the three joints of its leg."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.analytic.triangle import FAR, NONE, ONE, ROUNDING, bend
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import wrapped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["BRANCHES", "misses_by", "misses_by_many", "pack", "solve", "solve_many"]

BRANCHES: Final = 4

# Where the numbers of a leg stand in its parameters; see `pack`.
_TURN, _ORIGIN, _COXA, _FEMUR, _TIBIA, _LATERAL = 0, 9, 12, 13, 14, 15
_SIGNS, _OFFSETS, _MIDDLES, _SIZE = 16, 19, 22, 25

_KNEE, _ANY_COXA, _ANY_FEMUR, _BOTH_COXA = 1, 2, 4, 8  # bits of the singularity
_MERGED: Final = 1e-7  # relative: where a foot beside the leg's plane has its turning point, both branches are one


def pack(
    T_base_coxa: Floats,
    lengths: tuple[float, float, float],
    lateral: float,
    signs: Floats,
    offsets: Floats,
    path: JointPath,
) -> Floats:
    """The leg's numbers in one array, as `solve` takes them.

    Args:
        T_base_coxa: The coxa's frame (4, 4) in the leg's base: z along the coxa axis and up, x towards the femur axis,
            in whose height its origin is.
        lengths: Coxa, femur, tibia [m]: between the axes, and from the last one to the foot, in the leg's plane.
        lateral: How far the foot is beside the plane through the coxa axis, along y [m].
        signs: t_k = sign_k · q_k + offset_k (3,).
        offsets: See there [rad].
        path: The chain; the middles of its ranges stand for angles that may be any.
    """
    leg, T_coxa_base = np.empty(_SIZE), np.linalg.inv(T_base_coxa)
    leg[_TURN:_ORIGIN], leg[_ORIGIN:_COXA] = T_coxa_base[:3, :3].ravel(), T_coxa_base[:3, 3]
    leg[_COXA:_LATERAL] = lengths
    leg[_LATERAL] = lateral if abs(lateral) > 1e-13 * sum(lengths) else 0.0
    leg[_SIGNS:_OFFSETS], leg[_OFFSETS:_MIDDLES] = signs, offsets
    leg[_MIDDLES:] = signs * middles_and_halves(path.lower, path.upper)[0] + offsets
    return leg


@leaf_jit
def _seen_from_coxa(leg: Floats, goal: Floats) -> tuple[float, float, float]:
    x, y, z = goal[0, 3], goal[1, 3], goal[2, 3]
    return (
        leg[0] * x + leg[1] * y + leg[2] * z + leg[_ORIGIN],
        leg[3] * x + leg[4] * y + leg[5] * z + leg[_ORIGIN + 1],
        leg[6] * x + leg[7] * y + leg[8] * z + leg[_ORIGIN + 2],
    )


@leaf_jit
def solve(leg: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of a foot's position; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    x, y, z = _seen_from_coxa(leg, goal)
    e, scale = leg[_LATERAL], leg[_COXA] + leg[_FEMUR] + leg[_TIBIA]
    slack = max(slack, ROUNDING * scale)
    out = math.hypot(x, y)
    if not abs(e) - slack <= out < FAR:
        return 0
    # The foot's distance from the coxa axis within the leg's plane; the other sign reaches over the body.
    forward = math.sqrt(max((out - abs(e)) * (out + abs(e)), 0.0))
    if forward <= ROUNDING * scale and e == 0.0:
        return _in_plane(leg, leg[_MIDDLES], forward, z, 0, slack, _ANY_COXA, rows, 0)
    t1 = math.atan2(y * forward - x * e, x * forward + y * e)
    if e != 0.0 and forward <= _MERGED * scale:
        return _in_plane(leg, t1, forward, z, 0, slack, _BOTH_COXA, rows, 0)
    count = _in_plane(leg, t1, forward, z, 0, slack, 0, rows, 0)
    t1 = math.atan2(-y * forward - x * e, -x * forward + y * e)
    return _in_plane(leg, t1, -forward, z, 1, slack, 0, rows, count)


@leaf_jit
def _in_plane(
    leg: Floats, t1: float, x: float, z: float, over: int, slack: float, free: int, rows: Floats, count: int
) -> int:
    """Writes the branches of one coxa angle: two links from the femur axis to the foot at (x, z) in the leg's plane.

    Angles in the plane are counted from straight up, outwards: a point at an angle t is r (cos t + i sin t), up being
    real. Returns the rows written now.
    """
    x -= leg[_COXA]
    a, b = leg[_FEMUR], leg[_TIBIA]
    distance = math.hypot(x, z)
    bends, bent, sine, cosine = bend(a, b, distance, slack)
    if bends == NONE:
        return count
    free |= _KNEE if bends == ONE else 0
    towards, ahead = math.atan2(x, z), math.atan2(b * sine, a + b * cosine)
    if distance <= ROUNDING * (a + b):
        towards, ahead, free = leg[_MIDDLES + 1], 0.0, free | _ANY_FEMUR
    for knee in range(1 if bends == ONE else 2):
        # On the forward side a positive bend lifts the femur above the line to the foot; reaching over, a negative one.
        up = 1.0 if knee == over else -1.0
        angles = (t1, towards - up * ahead, up * bent)
        for k in range(3):
            rows[count, k] = wrapped(leg[_SIGNS + k] * (angles[k] - leg[_OFFSETS + k]))
        rows[count, 3], rows[count, 4] = knee + 2 * over, free
        count += 1
    return count


@parallel_jit
def solve_many(
    leg: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4), rows (N, 4, 5) and counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve(leg, kind, goals[i], given[0], slack, rows[i])


@leaf_jit
def misses_by(leg: Floats, goal: Floats) -> float:
    """How far a foot's position is from all that the leg reaches without limits [m]: above 0 too far, below too near.

    Exact for a foot in the leg's plane; beside it, a bound: never more than it really is.
    """
    x, y, z = _seen_from_coxa(leg, goal)
    coxa, e = leg[_COXA], leg[_LATERAL]
    # The femur axis goes round on a circle; its nearest and its farthest point see the foot at these distances.
    radius, out = (coxa, math.hypot(x, y)) if e == 0.0 else (math.hypot(coxa, e), math.hypot(x, y))
    near, far = math.hypot(out - radius, z), math.hypot(out + radius, z)
    longest, shortest = leg[_FEMUR] + leg[_TIBIA], abs(leg[_FEMUR] - leg[_TIBIA])
    missed: float = 0.0
    if near > longest:
        missed = near - longest
    elif far < shortest:
        missed = far - shortest
    elif e == 0.0 and near < shortest and far > longest:  # between the two: too near pointing at it, too far beyond
        missed = far - longest if far - longest < shortest - near else near - shortest
    return missed


@parallel_jit
def misses_by_many(leg: Floats, goals: Floats, missed: Floats) -> None:
    """`misses_by` for goals (N, 4, 4), written to (N,)."""
    for i in prange(goals.shape[0]):
        missed[i] = misses_by(leg, goals[i])
