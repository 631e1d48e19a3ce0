"""The points of a hinge chain that FABRIK and follow-the-leader move.

A group is a run of joints whose axes meet in one point; turning them moves the points of later groups and not their
own. Groups are numbered from the tip: point 0 is the tip, group 1 the joints that move it last, the last group sits at
the base. Joints whose axes run through the tip move no point and stay where they are. Where along its axis a
description puts a joint's origin does not matter.

A chain's groups are two arrays (m + 1,): `first`, the group's joint nearest to the base, whose other joints end before
the first joint of the group before in number; and `slide`, where along the axis of its last joint its point is, from
the joint's own point on it [m].
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["chain_length", "find_groups", "group_point", "is_straight", "want_straight"]

_MEETING: Final = 0.01
"""An axis that passes a point, or another axis, closer than this part of the chain's length goes through it. Turns are
exact all the same, about the true axis; it decides only which joints share a point. A link much shorter than the others
would have its joint turn by a lot to place a point that matters little."""

_SKEW: Final = 0.05
"""Sine of the angle of two axes below which they count as parallel: they would meet too far away to be of use."""

_STRAIGHT: Final = 1e-9
"""Points that are off a line by less than this part of the chain's length lie on it."""


@leaf_jit
def chain_length(joints: Floats) -> float:
    """Sum of the lengths of the links behind the first joint [m]."""
    total = 0.0
    for k in range(1, joints.shape[0]):
        total += math.sqrt(joints[k, 9] ** 2 + joints[k, 10] ** 2 + joints[k, 11] ** 2)
    return total


@leaf_jit
def find_groups(length: float, axes: Floats, tip: Floats, first: Floats, slide: Floats) -> int:
    """How many groups there are; their number does not depend on q, but for rounding.

    A group's point lies on the axis of its joint nearest to the tip: where the axis before meets it, or else nearest to
    the point of the group before it in number.

    Args:
        length: Length of the chain [m].
        axes: Axes (m, 6).
        tip: T_base_tip (12,).
        first: Written (m + 1,).
        slide: Written (m + 1,).
    """
    m, count = axes.shape[0], 0
    x, y, z = tip[9], tip[10], tip[11]
    first[0], slide[0] = m, 0.0
    for k in range(m - 1, -1, -1):
        along = _along(axes[k], x, y, z)
        dx, dy, dz = x - axes[k, 3], y - axes[k, 4], z - axes[k, 5]
        off = math.sqrt(max(dx * dx + dy * dy + dz * dz - along * along, 0.0))
        if off > _MEETING * length:
            count += 1
            if k > 0:
                along = _meeting(axes[k - 1], axes[k], _MEETING * length, along)
            slide[count] = along
            x, y, z = axes[k, 3] + along * axes[k, 0], axes[k, 4] + along * axes[k, 1], axes[k, 5] + along * axes[k, 2]
        first[count] = k
    return count


@leaf_jit
def _along(line: Floats, x: float, y: float, z: float) -> float:
    """Where along a line (6,) the foot of a point is, from the line's own point."""
    along: float = line[0] * (x - line[3]) + line[1] * (y - line[4]) + line[2] * (z - line[5])
    return along


@leaf_jit
def _meeting(a: Floats, b: Floats, near: float, otherwise: float) -> float:
    """Where along line b (6,) line a comes nearest to it, if that is as near as they would have to be to meet."""
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    squared = 1.0 - cosine * cosine
    if squared < _SKEW * _SKEW:
        return otherwise
    on_b, on_a = _along(b, a[3], a[4], a[5]), _along(a, b[3], b[4], b[5])
    t, s = (on_b + cosine * on_a) / squared, (on_a + cosine * on_b) / squared
    gap = 0.0
    for i in range(3):
        gap += (b[3 + i] + t * b[i] - a[3 + i] - s * a[i]) ** 2
    return t if gap <= near * near else otherwise


@leaf_jit
def group_point(
    g: int, first: Floats, slide: Floats, lines: Floats, x: float, y: float, z: float
) -> tuple[float, float, float]:
    """The point of group g > 0 on the axes `lines` (m, 6), or (x, y, z), which is the tip, for g = 0 [m]."""
    if g == 0:
        return x, y, z
    k, along = int(first[g - 1]) - 1, slide[g]
    return (
        lines[k, 3] + along * lines[k, 0],
        lines[k, 4] + along * lines[k, 1],
        lines[k, 5] + along * lines[k, 2],
    )


@leaf_jit
def _link(g: int, first: Floats, slide: Floats, axes: Floats, tip: Floats) -> float:
    """Distance of the points of group g and of the one before in number [m]."""
    ax, ay, az = group_point(g, first, slide, axes, tip[9], tip[10], tip[11])
    bx, by, bz = group_point(g - 1, first, slide, axes, tip[9], tip[10], tip[11])
    return math.sqrt((ax - bx) ** 2 + (ay - by) ** 2 + (az - bz) ** 2)


@leaf_jit
def want_straight(
    goal: Floats, axes: Floats, tip: Floats, count: int, first: Floats, slide: Floats, wanted: Floats
) -> bool:
    """Whether no pose of the points has the tip on the target; then the nearest one, a straight line, is wanted.

    Too far, all links head for the target. Too near, the longest link does, and all others point back.
    """
    x, y, z = group_point(count, first, slide, axes, tip[9], tip[10], tip[11])
    total, longest, which = 0.0, 0.0, 0
    for g in range(1, count + 1):
        link = _link(g, first, slide, axes, tip)
        total += link
        if link > longest:
            longest, which = link, g
    ux, uy, uz = goal[0, 3] - x, goal[1, 3] - y, goal[2, 3] - z
    distance = math.sqrt(ux * ux + uy * uy + uz * uz)
    far = distance > total
    if not far and distance >= 2.0 * longest - total:
        return False
    if distance == 0.0:  # every direction is as good: that of the tip keeps the chain where it is
        ux, uy, uz = tip[9] - x, tip[10] - y, tip[11] - z
        distance = math.sqrt(ux * ux + uy * uy + uz * uz)
        if distance == 0.0:
            ux, distance = 1.0, 1.0
    ux, uy, uz = ux / distance, uy / distance, uz / distance
    wanted[count, 0], wanted[count, 1], wanted[count, 2] = x, y, z
    for g in range(count, 0, -1):
        link = _link(g, first, slide, axes, tip)
        if not far and g != which:
            link = -link
        x, y, z = x + link * ux, y + link * uy, z + link * uz
        wanted[g - 1, 0], wanted[g - 1, 1], wanted[g - 1, 2] = x, y, z
    return True


@leaf_jit
def is_straight(
    length: float, goal: Floats, axes: Floats, tip: Floats, count: int, first: Floats, slide: Floats
) -> bool:
    """Whether all points lie on one line with the target, the tip off it: the passes would never leave the line."""
    tx, ty, tz = goal[0, 3], goal[1, 3], goal[2, 3]
    x, y, z = group_point(count, first, slide, axes, tip[9], tip[10], tip[11])
    near = _STRAIGHT * length
    missing = math.sqrt((tip[9] - tx) ** 2 + (tip[10] - ty) ** 2 + (tip[11] - tz) ** 2)
    if missing <= near:
        return False
    ux, uy, uz = tx - x, ty - y, tz - z
    distance = math.sqrt(ux * ux + uy * uy + uz * uz)
    if distance <= near:  # a target on the base: the line is that of the tip
        ux, uy, uz = tip[9] - x, tip[10] - y, tip[11] - z
        distance = math.sqrt(ux * ux + uy * uy + uz * uz)
        if distance <= near:
            return False
    for g in range(count):
        px, py, pz = group_point(g, first, slide, axes, tip[9], tip[10], tip[11])
        px, py, pz = px - x, py - y, pz - z
        cx, cy, cz = py * uz - pz * uy, pz * ux - px * uz, px * uy - py * ux
        if math.sqrt(cx * cx + cy * cy + cz * cz) > near * distance:
            return False
    return True
