"""Legs of six joints, as NAO's: three hip axes through one point, knee and ankle pitch parallel, ankle roll across.

The hip axes are perpendicular one to the next, the hip pitch axis is parallel to knee and ankle pitch, and the ankle's
two axes meet at a right angle. So, with the leg's own angles t_k = ±q_k + offset_k,

    T_base_tip = B · Rz(t1) Rx(t2) Ry(t3) · Tz(−a) · Ry(t4) · Tz(−b) · Ry(t5) · Ty(−e) · Rx(t6) · E

with thigh a, shank b, and an ankle that may lie beside the plane of the thigh by e (0 for NAO). The solution starts at
the foot, where the hip is seen at r = Rᵀ (H − A): its distance gives the knee, its direction in the foot's y-z plane
the ankle roll, its place in the leg's plane the ankle pitch, and the three hip angles are what is left of the
orientation. Two signs each for knee, ankle and hip make eight solutions; nothing else exists.

A path from the foot to the torso is the same leg backwards and recognised as such.

Source: the leg of Kofinas, Orfanoudakis and Lagoudakis 2013, whose chain this is; the solution is derived here.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, largest, screws
from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.analytic.triangle import NONE, ONE, ROUNDING, bend
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import Nine, Three, wrapped
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

    _Angles: TypeAlias = tuple[float, float, float, float, float, float]

__all__ = [
    "ANY_YAW",
    "BRANCHES",
    "LABELS",
    "SINGULARITIES",
    "meeting_point",
    "pack",
    "recognise",
    "runs_backwards",
    "segments",
    "solve",
    "solve_many",
    "solve_with_yaw",
]

LABELS: Final = tuple(
    f"knee {knee}, ankle {ankle}, hip {hip}"
    for hip in ("upright", "over")
    for ankle in ("upright", "over")
    for knee in "+−"
)
"""Knee: the sense in which it is bent, seen from the straight leg. Ankle: whether the hip is on the side of the foot
that it is on at q = 0, or the foot is rolled over by half a turn. Hip: the same for the hip roll's half turn."""

_FREE: Final = (
    "both knee branches in one",
    "any ankle roll",
    "any hip yaw",
    "any ankle pitch",
    "both ankle branches in one",
)
SINGULARITIES: Final = tuple(
    ", ".join(words for bit, words in enumerate(_FREE) if number >> bit & 1) for number in range(1 << len(_FREE))
)
"""What is free at a singularity, by the sum of the kernel's bits."""

_SHORTEST: Final = 1e-6  # a thigh or shank below this [m] is a joint's offset and no segment


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The leg's numbers for the kernel, of a path from torso to foot or from foot to torso."""
    leg = screws(path, 6)
    if isinstance(leg, Mismatch):
        return leg
    forwards = _measured(leg, path, backwards=False)
    if isinstance(forwards, Geometry):
        return forwards
    backwards = _measured(_reversed(leg), path, backwards=True)
    return backwards if isinstance(backwards, Geometry) else forwards


def _measured(leg: Screws, path: JointPath, *, backwards: bool) -> Geometry | Mismatch:
    """The leg's numbers, if these screws are a leg from hip to foot."""
    axes, points = leg.axes, leg.points
    y = axes[2]
    hip, hips_apart = meeting_point(axes[:3], points[:3])
    ankle, ankles_apart = meeting_point(axes[4:], points[4:])
    residual = largest(
        {
            "the first two axes depart from a right angle": float(axes[0] @ axes[1]),
            "the second and third axis depart from a right angle": float(axes[1] @ y),
            "the first three axes miss a common point": hips_apart,
            "the third and fourth axis depart from parallel": float(np.linalg.norm(np.cross(axes[3], y))),
            "the third and fifth axis depart from parallel": float(np.linalg.norm(np.cross(axes[4], y))),
            "the last two axes depart from a right angle": float(axes[4] @ axes[5]),
            "the last two axes miss a common point": ankles_apart,
        }
    )
    if isinstance(residual, Mismatch):
        return residual
    knee = points[3] + y * (y @ (hip - points[3]))
    ankle_in_plane = ankle + y * (y @ (hip - ankle))
    lengths = np.array([np.linalg.norm(hip - knee), np.linalg.norm(knee - ankle_in_plane)])
    if lengths.min() < _SHORTEST:
        return Mismatch(f"its thigh and shank are {lengths[0]:.3g} m and {lengths[1]:.3g} m long, too short to be any")
    thigh, shank = (hip - knee) / lengths[0], (knee - ankle_in_plane) / lengths[1]  # both upward, as the leg's z is
    # Of the two senses of the leg's own z at the hip and x at the foot, those in which q = 0 is an upright branch.
    hip_sign = -1.0 if np.cross(axes[0], axes[1]) @ y < 0.0 else 1.0
    foot_sign = -1.0 if np.cross(axes[5], y) @ (hip - ankle) < 0.0 else 1.0
    z, x, foot_x = hip_sign * axes[0], axes[1], foot_sign * axes[5]
    foot_z = np.cross(foot_x, y)
    offsets = np.array(
        [
            0.0,
            _angle(np.cross(z, x), y, about=x),
            _angle(np.cross(x, y), thigh, about=y),
            _angle(thigh, shank, about=y),
            _angle(shank, foot_z, about=y),
            0.0,
        ]
    )
    signs = np.array([hip_sign, 1.0, 1.0, np.sign(axes[3] @ y), np.sign(axes[4] @ y), foot_sign])
    lateral = float(y @ (hip - ankle))
    T_base_hip = _frame(x, np.cross(z, x), z, hip)
    T_foot_tip = np.linalg.inv(_frame(foot_x, y, foot_z, ankle)) @ leg.tip
    parameters = pack(T_base_hip, T_foot_tip, lengths, lateral, signs, offsets, path, backwards=backwards)
    return Geometry(parameters, residual)


def _reversed(leg: Screws) -> Screws:
    """The same joints met from the tip, in tip axes."""
    R, p = leg.tip[:3, :3], leg.tip[:3, 3]
    T_tip_base = np.asarray(np.linalg.inv(leg.tip), dtype=np.float64)
    return Screws(-leg.axes[::-1] @ R, (leg.points[::-1] - p) @ R, T_tip_base)


def meeting_point(axes: Floats, points: Floats) -> tuple[Floats, float]:
    """The point nearest to some lines (3,), and how far it is from the farthest of them [m]."""
    across = np.eye(3) - np.einsum("ki,kj->kij", axes, axes)
    point, *_ = np.linalg.lstsq(across.sum(axis=0), np.einsum("kij,kj->i", across, points), rcond=None)
    missed = np.einsum("kij,kj->ki", across, point - points)
    return point, float(np.linalg.norm(missed, axis=1).max())


def _angle(start: Floats, end: Floats, about: Floats) -> float:
    """The turn about a unit axis from one direction across it to another [rad]."""
    return float(np.arctan2(about @ np.cross(start, end), start @ end))


def _frame(x: Floats, y: Floats, z: Floats, origin: Floats) -> Floats:
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, y, z, origin
    return T


BRANCHES: Final = 8

# Where the numbers of a leg stand in its parameters; see `pack`. Transforms are rotation row by row, then translation.
_BEFORE, _BEHIND, _BACKWARDS, _THIGH, _SHANK, _LATERAL = 0, 12, 24, 25, 26, 27
_SIGNS, _OFFSETS, _COLUMNS, _MIDDLES, _HALVES, _SIZE = 28, 34, 40, 46, 52, 58

_KNEE, _ROLL, ANY_YAW, _PITCH, _ANKLE = 1, 2, 4, 8, 16  # bits of the singularity
_MERGED: Final = 1e-7  # relative: where an ankle beside the leg's plane has its turning point, both branches are one
_ROLLS: Final = 256  # where any ankle roll will do, rolls tried on each side of the middle of its range


def pack(
    T_base_hip: Floats,
    T_foot_tip: Floats,
    lengths: Floats,
    lateral: float,
    signs: Floats,
    offsets: Floats,
    path: JointPath,
    *,
    backwards: bool,
) -> Floats:
    """The leg's numbers in one array, as `solve` takes them.

    Args:
        T_base_hip: The hip's frame (4, 4) in the leg's base: z along its first axis, x along its second.
        T_foot_tip: The tip (4, 4) in the foot's frame: x along the ankle roll, y along the ankle pitch.
        lengths: Thigh and shank (2,) [m].
        lateral: How far the ankle is beside the plane of the thigh, along −y [m].
        signs: t_k = sign_k · q_k + offset_k (6,).
        offsets: See there [rad].
        path: The chain; where the solution is not unique, its limits choose.
        backwards: Whether the chain runs from foot to hip.
    """
    leg = np.empty(_SIZE)
    # A chain that runs backwards gives the inverse pose, so its product with B and E is inverted as a whole.
    pair = (T_foot_tip, T_base_hip) if backwards else (np.linalg.inv(T_base_hip), np.linalg.inv(T_foot_tip))
    for start, T in zip((_BEFORE, _BEHIND), pair, strict=True):
        leg[start : start + 9], leg[start + 9 : start + 12] = T[:3, :3].ravel(), T[:3, 3]
    scale = float(lengths.sum())
    leg[_BACKWARDS], leg[_THIGH : _SHANK + 1] = float(backwards), lengths
    leg[_LATERAL] = lateral if abs(lateral) > 1e-13 * scale else 0.0
    columns = np.arange(6)[::-1] if backwards else np.arange(6)
    middles, halves = middles_and_halves(path.lower, path.upper)
    leg[_SIGNS:_OFFSETS], leg[_OFFSETS:_COLUMNS], leg[_COLUMNS:_MIDDLES] = signs, offsets, columns
    leg[_MIDDLES:_HALVES], leg[_HALVES:] = middles[columns], halves[columns]
    return leg


def segments(leg: Floats) -> tuple[float, float]:
    """Thigh and shank [m], of the numbers that `pack` packed."""
    return float(leg[_THIGH]), float(leg[_SHANK])


def runs_backwards(leg: Floats) -> bool:
    """Whether `pack` packed a chain that runs from foot to hip."""
    return bool(leg[_BACKWARDS])


@parallel_jit
def solve_many(
    leg: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4), rows (N, 8, 8) and counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve(leg, kind, goals[i], given[0], slack, rows[i])


@leaf_jit
def solve(leg: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of a foot's pose; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    return solve_with_yaw(leg, goal, math.nan, slack, rows)


@leaf_jit
def solve_with_yaw(leg: Floats, goal: Floats, yaw: float, slack: float, rows: Floats) -> int:
    """`solve`, or for a yaw that is a number the solutions whose first hip joint is at that angle [rad].

    With the yaw decided they reach the goal as far as it allows it: there is a condition on poses that go with it, see
    `nao_kin.analytic.nao.leg_yaw`.
    """
    a, b, e = leg[_THIGH], leg[_SHANK], leg[_LATERAL]
    R, (rx, ry, rz) = _seen_from_foot(leg, goal)
    scale = a + b
    slack = max(slack, ROUNDING * scale)
    beside, length = math.hypot(ry, rz), math.sqrt(max(rx * rx + ry * ry + rz * rz - e * e, 0.0))
    bends, t4, s4, c4 = bend(a, b, length, slack)
    if bends == NONE or beside < abs(e) - slack:
        return 0
    free = (_KNEE if bends == ONE else 0) + (_PITCH if length <= ROUNDING * scale else 0)
    folded = math.atan2(b + a * c4, -a * s4)
    wz = math.sqrt(max((beside - abs(e)) * (beside + abs(e)), 0.0))
    pitch = math.atan2(wz, rx)
    if wz <= ROUNDING * scale and e == 0.0:
        return _any_roll(leg, R, yaw, t4, pitch, folded, free | _ROLL, rows)
    upright = math.atan2(ry * wz - rz * e, rz * wz + ry * e)
    over = math.atan2(-ry * wz - rz * e, -rz * wz + ry * e)
    if e != 0.0 and wz <= _MERGED * scale:
        return _at_roll(leg, R, yaw, upright, 0, t4, pitch, folded, free | _ANKLE, rows, 0)
    count = _at_roll(leg, R, yaw, upright, 0, t4, pitch, folded, free, rows, 0)
    return _at_roll(leg, R, yaw, over, 1, t4, -pitch, folded, free, rows, count)


@leaf_jit
def _at_roll(
    leg: Floats,
    R: Nine,
    given_yaw: float,
    t6: float,
    over: int,
    t4: float,
    t45: float,
    folded: float,
    free: int,
    rows: Floats,
    count: int,
) -> int:
    """Writes the branches of one ankle roll: those of the hip, for both signs of the knee.

    Args:
        leg: See `pack`.
        R: Orientation of the foot in the hip's frame.
        given_yaw: The first hip joint [rad] where it is decided, else NaN.
        t6: The ankle roll [rad].
        over: 1 where it turns the foot over.
        t4: The knee, not negative [rad].
        t45: Direction of the hip in the leg's plane, seen from the foot [rad].
        folded: The same direction seen from the shank, with the knee at t4 [rad].
        free: Bits of the singularity so far.
        rows: Written.
        count: Rows written so far.

    Returns:
        Rows written now.
    """
    s6, c6 = sine_cosine(t6)
    # Axes y and z of the foot without its roll; y is the leg's pitch axis.
    yx, yy, yz = c6 * R[1] - s6 * R[2], c6 * R[4] - s6 * R[5], c6 * R[7] - s6 * R[8]
    zx, zy = s6 * R[1] + c6 * R[2], s6 * R[4] + c6 * R[5]
    c2 = math.hypot(yx, yy)
    s1, c1, sense, hips = 0.0, 1.0, 0.0, 1
    if not math.isnan(given_yaw):
        s1, c1 = sine_cosine(leg[_SIGNS] * given_yaw + leg[_OFFSETS])
        c2 = c1 * yy - s1 * yx
    elif c2 > ROUNDING:
        s1, c1, hips = -yx / c2, yy / c2, 2
    else:
        free, sense = free | ANY_YAW, math.copysign(1.0, yz)
    t1, t2 = math.atan2(s1, c1), math.atan2(yz, c2 if sense == 0.0 else 0.0)
    whole_pitch = math.atan2(c1 * zx + s1 * zy, c1 * R[0] + s1 * R[3])  # t3 + t4 + t5
    for knee in range(1 if free & _KNEE else 2):
        bent = t4 if knee == 0 else -t4
        t5 = t45 - (folded if knee == 0 else math.pi - folded)
        t3 = whole_pitch - bent - t5
        code = (knee if leg[_SIGNS + 3] > 0.0 else 1 - knee) + 2 * over + (4 if c2 < 0.0 else 0)
        yaw = t1
        if sense != 0.0:
            yaw, t3 = _shared(leg, t1, t3, sense)
        count = _store(leg, rows, count, (yaw, t2, t3, bent, t5, t6), code, free)
        if hips == 2:
            other = (t1 + math.pi, math.pi - t2, t3 + math.pi, bent, t5, t6)
            count = _store(leg, rows, count, other, code + 4, free)
    return count


@leaf_jit
def _any_roll(leg: Floats, R: Nine, yaw: float, t4: float, t45: float, folded: float, free: int, rows: Floats) -> int:
    """Writes the branches of one ankle roll where any would do, the hip being on the axis of the ankle roll.

    Of the rolls tried, it is the one nearest to the middle of its range that brings a branch into the limits; if there
    is none, the middle.
    """
    for i in range(2 * _ROLLS + 2):
        step = (i + 1) // 2 if i <= 2 * _ROLLS else 0  # 0, then outwards on both sides, then 0 again for want of better
        away = leg[_HALVES + 5] * step / _ROLLS * (1.0 if i % 2 else -1.0)
        t6 = leg[_SIGNS + 5] * (leg[_MIDDLES + 5] + away) + leg[_OFFSETS + 5]
        count = _at_roll(leg, R, yaw, t6, 0, t4, t45, folded, free, rows, 0)
        for row in range(count):
            if _inside(leg, rows, row):
                return count
    return count


@leaf_jit
def _inside(leg: Floats, rows: Floats, row: int) -> bool:
    beyond = -math.inf
    for k in range(6):
        away = wrapped(rows[row, int(leg[_COLUMNS + k])] - leg[_MIDDLES + k])
        beyond = max(beyond, abs(away) - leg[_HALVES + k])
    return beyond <= ROUNDING


@leaf_jit
def _shared(leg: Floats, t1: float, t3: float, sense: float) -> tuple[float, float]:
    """Hip yaw and hip pitch where their axes coincide, so that only t3 ± t1 counts.

    What is to be turned from the middles of both ranges is shared in proportion to the ranges. Both are then within
    theirs, if that is possible at all.
    """
    middle1 = leg[_SIGNS] * leg[_MIDDLES] + leg[_OFFSETS]
    middle3 = leg[_SIGNS + 2] * leg[_MIDDLES + 2] + leg[_OFFSETS + 2]
    turn = wrapped(t3 + sense * t1 - sense * middle1 - middle3)
    share = leg[_HALVES] / (leg[_HALVES] + leg[_HALVES + 2] + 1e-300)
    return middle1 + sense * turn * share, middle3 + turn * (1.0 - share)


@leaf_jit
def _store(leg: Floats, rows: Floats, count: int, angles: _Angles, code: int, free: int) -> int:
    for k in range(6):
        rows[count, int(leg[_COLUMNS + k])] = wrapped(leg[_SIGNS + k] * (angles[k] - leg[_OFFSETS + k]))
    rows[count, 6], rows[count, 7] = code, free
    return count + 1


@leaf_jit
def _seen_from_foot(leg: Floats, goal: Floats) -> tuple[Nine, Three]:
    """Orientation R of the foot in the hip's frame, row by row, and the hip in the foot's frame [m]."""
    xx, xy, xz, px = _row(leg, goal, 0)
    yx, yy, yz, py = _row(leg, goal, 1)
    zx, zy, zz, pz = _row(leg, goal, 2)
    if leg[_BACKWARDS] != 0.0:  # it is the hip in the foot's frame already
        return (xx, yx, zx, xy, yy, zy, xz, yz, zz), (px, py, pz)
    hip = (-(xx * px + yx * py + zx * pz), -(xy * px + yy * py + zy * pz), -(xz * px + yz * py + zz * pz))
    return (xx, xy, xz, yx, yy, yz, zx, zy, zz), hip


@leaf_jit
def _row(leg: Floats, goal: Floats, i: int) -> tuple[float, float, float, float]:
    """Row i of the transform before the goal, times the goal, times the transform behind it."""
    u, v, w = leg[_BEFORE + 3 * i], leg[_BEFORE + 3 * i + 1], leg[_BEFORE + 3 * i + 2]
    x = u * goal[0, 0] + v * goal[1, 0] + w * goal[2, 0]
    y = u * goal[0, 1] + v * goal[1, 1] + w * goal[2, 1]
    z = u * goal[0, 2] + v * goal[1, 2] + w * goal[2, 2]
    p = u * goal[0, 3] + v * goal[1, 3] + w * goal[2, 3] + leg[_BEFORE + 9 + i]
    return (
        x * leg[_BEHIND] + y * leg[_BEHIND + 3] + z * leg[_BEHIND + 6],
        x * leg[_BEHIND + 1] + y * leg[_BEHIND + 4] + z * leg[_BEHIND + 7],
        x * leg[_BEHIND + 2] + y * leg[_BEHIND + 5] + z * leg[_BEHIND + 8],
        x * leg[_BEHIND + 9] + y * leg[_BEHIND + 10] + z * leg[_BEHIND + 11] + p,
    )
