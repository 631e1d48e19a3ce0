"""Legs of three joints, as a hexapod's: a coxa axis, and femur and tibia axes parallel to each other across it.

With the leg's own angles t_k = ±q_k + offset_k the foot is, in the frame of the coxa (z up along its axis),

    p = Rz(t1) · (c + a sin t2 + b sin(t2 + t3), e, a cos t2 + b cos(t2 + t3))

with coxa c, femur a, tibia b, and a foot that may lie beside the leg's plane by e (0 where nothing is skewed). So the
foot's distance from the coxa axis gives t1, for a leg that points at the foot and for one that reaches over the body,
and what is left is a triangle of femur, tibia and the line from the femur axis to the foot, with its knee up or down:
four solutions, and nothing else exists.

Source: the hexapod article, steps 3 to 5, solves the leg that points at the foot.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, largest, screws
from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.analytic.triangle import FAR, NONE, ONE, ROUNDING, bend
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import wrapped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = [
    "BRANCHES",
    "LABELS",
    "SINGULARITIES",
    "misses_by",
    "misses_by_many",
    "pack",
    "recognise",
    "solve",
    "solve_many",
]

LABELS: Final = tuple(f"coxa {coxa}, knee {knee}" for coxa in ("forward", "reaching over") for knee in ("up", "down"))
"""Coxa: whether the leg points at its foot or reaches over the body to it. Knee: on which side of the line from femur
axis to foot; up is where, at q = 0, the femur axis is seen from the foot."""

_FREE: Final = ("both knee branches in one", "any coxa", "any femur", "both coxa branches in one")
SINGULARITIES: Final = tuple(
    ", ".join(words for bit, words in enumerate(_FREE) if number >> bit & 1) for number in range(1 << len(_FREE))
)
"""What is free at a singularity, by the sum of the kernel's bits."""

_SHORTEST: Final = 1e-6  # a femur or tibia below this [m] is a joint's offset and no segment
_LEVEL: Final = 1e-9  # what is less than this [m] to a side is on neither


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The leg's numbers for the kernel."""
    leg = screws(path, 3)
    if isinstance(leg, Mismatch):
        return leg
    residual = largest(
        {
            "the first two axes depart from a right angle": float(leg.axes[0] @ leg.axes[1]),
            "the last two axes depart from parallel": float(np.linalg.norm(np.cross(leg.axes[1], leg.axes[2]))),
        }
    )
    if isinstance(residual, Mismatch):
        return residual
    T_base_coxa = _coxa_frame(leg)
    # Everything from here on in the coxa's frame, the leg being in its x-z plane at q = 0.
    signs, (coxa, lateral), (femur, tibia) = _measured(leg, T_base_coxa)
    lengths = (coxa, float(np.linalg.norm(femur)), float(np.linalg.norm(tibia)))
    if min(lengths[1:]) < _SHORTEST:
        return Mismatch(f"its femur and tibia are {lengths[1]:.3g} m and {lengths[2]:.3g} m long, too short to be any")
    at_zero = [float(np.arctan2(*segment)) for segment in (femur, tibia)]  # from straight up, outwards
    offsets = np.array([0.0, at_zero[0], at_zero[1] - at_zero[0]])
    return Geometry(pack(T_base_coxa, lengths, lateral, signs, offsets, path), residual)


def _coxa_frame(leg: Screws) -> Floats:
    """The frame of `nao_kin.analytic.hexapod.hexapod_leg.pack` (4, 4), at q = 0 and in the leg's base."""
    axis, foot = leg.axes[0], leg.tip[:3, 3]
    z = -axis if axis @ (foot - leg.points[1]) > _LEVEL else axis
    origin = leg.points[0] + z * (z @ (leg.points[1] - leg.points[0]))
    x = np.cross(leg.axes[1], z)
    x /= np.linalg.norm(x)
    out = x @ (leg.points[1] - origin)
    if (out if abs(out) > _LEVEL else x @ (foot - origin)) < 0.0:
        x = -x
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, np.cross(z, x), z, origin
    return T


def _measured(leg: Screws, T_base_coxa: Floats) -> tuple[Floats, tuple[float, float], tuple[Floats, Floats]]:
    """Signs of the joints, length of the coxa and the foot's place beside the plane, femur and tibia as (x, z) [m]."""
    x, y, z = T_base_coxa[:3, 0], T_base_coxa[:3, 1], T_base_coxa[:3, 2]
    signs = np.sign(np.array([leg.axes[0] @ z, leg.axes[1] @ y, leg.axes[2] @ y]))
    foot, plane = leg.tip[:3, 3], np.array([x, z])
    lateral = float(y @ (foot - T_base_coxa[:3, 3]))
    coxa = float(x @ (leg.points[1] - T_base_coxa[:3, 3]))
    return signs, (coxa, lateral), (plane @ (leg.points[2] - leg.points[1]), plane @ (foot - leg.points[2]))


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
