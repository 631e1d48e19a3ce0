"""FABRIK and follow-the-leader on real hinge chains: two passes over the points of `nao_kin.ik.geometric.hinge_groups`.

Sources: A. Aristidou and J. Lasenby, "FABRIK: a fast, iterative solver for the inverse kinematics problem", 2011, as
Bischoff 2016, section 3.4, Algorithm 1 prints it; J. Brown, J.-C. Latombe and K. Montgomery, "Real-time knot tying
simulation", 2004, for the rope that follows its end. Both move free points; here hinges and limits decide in both
passes where a link may point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.ik.geometric.best_turn import best_turn, point_wave, spin
from nao_kin.ik.geometric.hinge_groups import chain_length, find_groups, group_point, is_straight, want_straight
from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.joint_limits import column_range, move_inside
from nao_kin.kernels.motion import COLUMN, MULTIPLIER, place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.motion import Arm, At

__all__ = ["CYCLES", "STILL", "carry", "hinge_memory", "hinge_pass", "leave_line", "outward_pass", "want_points"]

CYCLES: Final = 100
"""Times that the joints of one group take turns at most. Where two of them move the point nearly the same way they are
slow, and a pass may end short of what the group could do; the next pass goes on."""

STILL: Final = 1e-9
"""A cycle of turns that moves no joint by more than this [rad] is the last."""

_BEND: Final = 0.1
"""By how much each joint of a straight line is bent at most [rad]; towards the middle of its range, or forwards."""


def hinge_memory(joints: Floats) -> int:
    """Numbers of scratch memory that `hinge_pass` needs for a chain (m + 1, 16)."""
    m = int(joints.shape[0]) - 1
    return 2 * (m + 1) + 3 * (m + 3) + 7 * m


@leaf_jit
def hinge_pass(follow: bool, arm: Arm, goal: Floats, at: At, memory: Floats) -> bool:
    """One iteration towards a position: a reach pass from the target to the base, an outward pass back to the tip.

    Returns whether the target is within reach of the points; if not, the tip heads for the nearest place that is.

    Args:
        follow: Follow-the-leader instead of FABRIK: the outward pass makes links parallel to those of the reach pass,
            and does not head for the points where they lie.
        arm: The chain; turning joints, one a column.
        goal: The target (4, 4), of which the position counts.
        at: Joints inside the limits, changed in place, their axes and tip with them.
        memory: Scratch (`hinge_memory`,).
    """
    m = arm.joints.shape[0] - 1
    first, slide = memory[: m + 1], memory[m + 1 : 2 * m + 2]
    wanted, rest = memory[2 * m + 2 : 5 * m + 11].reshape(m + 3, 3), memory[5 * m + 11 :]
    count = want_points(arm, goal, at, first, slide, wanted, rest)
    outward_pass(follow, 0, arm, count, first, slide, wanted, at)
    move_inside(at.q, arm.limits, arm.coupled)
    place(arm.joints, at.q, at.axes, at.tip)
    off = 0.0
    for i in range(3):
        off = max(off, abs(wanted[0, i] - goal[i, 3]))
    return count == 0 or off == 0.0


@leaf_jit
def want_points(arm: Arm, goal: Floats, at: At, first: Floats, slide: Floats, wanted: Floats, memory: Floats) -> int:
    """How many groups there are, and where their points are wanted: by a reach pass, or straight if out of reach.

    The arguments are those of `hinge_pass` and `outward_pass`, q among those kept; `memory` is scratch (6 m + n,).
    """
    m, n = arm.joints.shape[0] - 1, at.q.shape[0]
    count = find_groups(chain_length(arm.joints), at.axes, at.tip, first, slide)
    if count > 0 and not want_straight(goal, at.axes, at.tip, count, first, slide, wanted):
        lines, turned = memory[: 6 * m].reshape(m, 6), memory[6 * m : 6 * m + n]
        _reach_pass(arm, goal, count, first, slide, at, wanted, lines, turned)
    return count


@leaf_jit
def leave_line(arm: Arm, goal: Floats, at: At, memory: Floats) -> None:
    """Bends a chain that stands in a straight line with a target within reach, which no pass would have leave the line.

    That may increase the error. The arguments are those of `hinge_pass`.
    """
    m, length = arm.joints.shape[0] - 1, chain_length(arm.joints)
    first, slide = memory[: m + 1], memory[m + 1 : 2 * m + 2]
    count = find_groups(length, at.axes, at.tip, first, slide)
    if count > 1 and is_straight(length, goal, at.axes, at.tip, count, first, slide):
        missing = 0.0
        for i in range(3):
            missing += (goal[i, 3] - at.tip[9 + i]) ** 2
        # A line of length l bent by an angle a is shorter by about l a².
        _bend(min(_BEND, math.sqrt(math.sqrt(missing) / length)), arm, int(first[0]), at.q)
        place(arm.joints, at.q, at.axes, at.tip)


@leaf_jit
def _bend(angle: float, arm: Arm, end: int, q: Floats) -> None:
    """Bends every joint before joint `end` by the same angle, so that the chain leaves a line in a way of its own."""
    for k in range(end):
        i = int(arm.joints[k, COLUMN])
        middle = 0.5 * (arm.limits[0, i] + arm.limits[1, i])
        q[i] += -angle if q[i] > middle else angle
    move_inside(q, arm.limits, arm.coupled)


@leaf_jit
def _reach_pass(
    arm: Arm,
    goal: Floats,
    count: int,
    first: Floats,
    slide: Floats,
    at: At,
    wanted: Floats,
    lines: Floats,
    turned: Floats,
) -> None:
    """Where the points are wanted: the tip on the target, each next one a link away from the one before.

    A link is turned towards the point it is to reach as far as its hinges and limits let it, and then shifted there;
    what it could not turn is so handed on towards the base. Without hinges that makes the points of FABRIK.

    Args:
        arm: The chain.
        goal: The target (4, 4).
        count: Number of groups, > 0.
        first: See `nao_kin.ik.geometric.hinge_groups`.
        slide: See `nao_kin.ik.geometric.hinge_groups`.
        at: Where the chain is.
        wanted: Written (m + 3, 3): where the points of groups 0 … count are wanted [m]; two last rows are scratch.
        lines: Scratch (m, 6).
        turned: Scratch (n,).
    """
    axes, tip, point = at.axes, at.tip, wanted[wanted.shape[0] - 1]
    for i in range(at.q.shape[0]):
        turned[i] = at.q[i]
    wanted[0, 0], wanted[0, 1], wanted[0, 2] = goal[0, 3], goal[1, 3], goal[2, 3]
    for g in range(1, count + 1):
        x, y, z = group_point(g, first, slide, axes, tip[9], tip[10], tip[11])
        point[0], point[1], point[2] = group_point(g - 1, first, slide, axes, tip[9], tip[10], tip[11])
        low, high = int(first[g]), int(first[g - 1])
        for k in range(low, high):
            for i in range(6):
                lines[k, i] = axes[k, i]
        _turn_group(arm, low, high, high, wanted[g - 1], turned, lines, point, point[:0])
        for i in range(3):
            wanted[g, i] = wanted[g - 1, i] - point[i]
        wanted[g, 0], wanted[g, 1], wanted[g, 2] = wanted[g, 0] + x, wanted[g, 1] + y, wanted[g, 2] + z


@leaf_jit
def outward_pass(
    follow: bool, begin: int, arm: Arm, count: int, first: Floats, slide: Floats, wanted: Floats, at: At
) -> None:
    """From the base to the tip, each group turns the next point as near as it can to where it is wanted.

    Args:
        follow: Whether links are to be parallel to the wanted ones, wherever their points come to lie.
        begin: The first joint that may move.
        arm: The chain; its coupled limits are met by the joints of a group one at a time.
        count: Number of groups.
        first: See `nao_kin.ik.geometric.hinge_groups`.
        slide: See `nao_kin.ik.geometric.hinge_groups`.
        wanted: Where the points of groups 0 … count are wanted (m + 3, 3) [m]; two last rows are scratch.
        at: Joints, changed in place; axes and the tip's position are changed with them.
    """
    axes, tip = at.axes, at.tip
    point, aim = wanted[wanted.shape[0] - 1], wanted[wanted.shape[0] - 2]
    for g in range(count, 0, -1):
        aim[0], aim[1], aim[2] = wanted[g - 1, 0], wanted[g - 1, 1], wanted[g - 1, 2]
        if follow:
            x, y, z = group_point(g, first, slide, axes, tip[9], tip[10], tip[11])
            aim[0], aim[1], aim[2] = aim[0] + x - wanted[g, 0], aim[1] + y - wanted[g, 1], aim[2] + z - wanted[g, 2]
        point[0], point[1], point[2] = group_point(g - 1, first, slide, axes, tip[9], tip[10], tip[11])
        low, high = max(int(first[g]), begin), int(first[g - 1])
        _turn_group(arm, low, high, axes.shape[0], aim, at.q, axes, point, tip[9:12])


@leaf_jit
def _turn_group(
    arm: Arm,
    low: int,
    high: int,
    stop: int,
    goal: Floats,
    q: Floats,
    lines: Floats,
    point: Floats,
    end: Floats,
) -> None:
    """Turns joints low ≤ k < high so that a point comes as near as it can to where it is wanted.

    Args:
        arm: The chain.
        low: First joint.
        high: Behind the last joint.
        stop: The axes before this one are carried along.
        goal: Where the point is wanted (3,) [m].
        q: Joints (n,), changed in place.
        lines: Axes (m, 6), changed with it.
        point: The point (3,) [m], carried along.
        end: The tip (3,) [m], carried along; or empty.
    """
    for _ in range(CYCLES):
        largest = 0.0
        for k in range(high - 1, low - 1, -1):
            delta = _turn_joint(arm, k, point, goal, q, lines)
            largest = max(largest, abs(delta))
            if delta != 0.0:
                carry(k, stop, delta, lines, point, end)
        if largest <= STILL or high - low <= 1:
            break


@leaf_jit
def _turn_joint(arm: Arm, k: int, point: Floats, goal: Floats, q: Floats, lines: Floats) -> float:
    """Moves joint k in q to where the point comes nearest to its goal; returns by how much it turns [rad]."""
    i, factor, axis = int(arm.joints[k, COLUMN]), arm.joints[k, MULTIPLIER], lines[k]
    rx, ry, rz = point[0] - axis[3], point[1] - axis[4], point[2] - axis[5]
    sx, sy, sz = goal[0] - axis[3], goal[1] - axis[4], goal[2] - axis[5]
    A, B = point_wave(axis[0], axis[1], axis[2], rx, ry, rz, sx, sy, sz)
    lower, upper = column_range(arm.limits, arm.coupled, q, i)
    ends = factor * (lower - q[i]), factor * (upper - q[i])
    delta = best_turn(A, B, min(ends[0], ends[1], 0.0), max(ends[0], ends[1], 0.0))
    q[i] = min(max(q[i] + delta / factor, lower), upper)
    return delta


@leaf_jit
def carry(k: int, stop: int, delta: float, lines: Floats, point: Floats, end: Floats) -> None:
    """Turns what joint k carries about its axis by delta [rad]: the axes behind it up to `stop`, the point, the tip."""
    ax, ay, az, cx, cy, cz = lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3], lines[k, 4], lines[k, 5]
    s, c = math.sin(delta), math.cos(delta)
    for other in range(k + 1, stop):
        spin(ax, ay, az, s, c, lines[other, 0:3])
        _spin_about(ax, ay, az, cx, cy, cz, s, c, lines[other, 3:6])
    _spin_about(ax, ay, az, cx, cy, cz, s, c, point)
    if end.shape[0] > 0:
        _spin_about(ax, ay, az, cx, cy, cz, s, c, end)


@leaf_jit
def _spin_about(
    ax: float, ay: float, az: float, cx: float, cy: float, cz: float, s: float, c: float, p: Floats
) -> None:
    """Turns a point p (3,) in place about an axis through c."""
    p[0], p[1], p[2] = p[0] - cx, p[1] - cy, p[2] - cz
    spin(ax, ay, az, s, c, p)
    p[0], p[1], p[2] = p[0] + cx, p[1] + cy, p[2] + cz
