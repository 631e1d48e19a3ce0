"""Arms whose second and third axes are parallel, compiled: three parallel axes (UR), and a spherical wrist (Pieper).

The arm's plane is across the parallel axes h. A point that later joints do not move keeps its distance to it, which is
one equation in the first joint: h · Rot(h1, −q1) (W − p1) = const. What is left are two links in a plane, and turns
of directions about axes. Three parallel axes need axes 5 and 6 to meet, W being the point where they do; a spherical
wrist's W is its centre.

Source: Pieper 1968 and Hawkins 2013 for the two families; with arbitrary twists as Elias and Wen 2022 state them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from nao_kin.analytic.six_r.shared import (
    ANY_ELBOW,
    ANY_SHOULDER,
    ANY_WRIST,
    LAST,
    LOWER,
    MIDDLES,
    ONE_ELBOW,
    ONE_SHOULDER,
    ONE_WRIST,
    SCALE,
    UPPER,
    axis,
    beside,
    goal_of,
    in_plane,
    minus,
    moved,
    off_axis,
    plus,
    point,
    refined,
    roots,
    settled_rows,
    shoulder,
    store,
    turn_between,
)
from nao_kin.analytic.triangle import FAR, NONE, ROUNDING, TWO, bend
from nao_kin.kernels.compiling import jit, leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import Three, cross, dot, turned, turned_about, turned_back
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nao_kin.analytic.six_r.shared import Placed, Roots
    from nao_kin.arrays import Floats

    Two: TypeAlias = tuple[float, float]

__all__ = ["BRANCHES", "solve_parallel", "solve_parallel_many", "solve_spherical", "solve_spherical_many"]

BRANCHES: Final = 8
_TURNS: Final = 256  # where any first joint will do, turns tried on each side of the middle of its range
_NEARLY_ON_AXIS: Final = 1e-5  # sine: from here on a cosine tells two turns apart
_MERGED: Final = 1e-11  # half the turn between two roots that are one
_ON_AXIS: Final = 1e-10  # sine: a direction this near to an axis says nothing about the turn round it


class Asked(NamedTuple):
    """A goal for an arm, inside compiled code.

    Attributes:
        arm: The arm, see `nao_kin.analytic.six_r.recognising.packed`.
        G: The goal, of `goal_of`.
        slack: How far beyond the border will do [m].
        rows: Written (8, 8).
    """

    arm: Floats
    G: Placed
    slack: float
    rows: Floats


class Branch(NamedTuple):
    """What is settled of a branch so far.

    Attributes:
        first: Cosine and sine of −q1.
        seen: The wrist's point in the arm's plane, from the second joint [m].
        label: Number of the branch so far.
        free: Bits of the singularity so far.
        clear: How far from singular the joints so far are.
    """

    first: Two
    seen: Two
    label: int
    free: int
    clear: float


@parallel_jit
def solve_parallel_many(
    arm: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve_parallel` for goals (N, 4, 4), rows (N, 8, 8) and counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve_parallel(arm, kind, goals[i], given[0], slack, rows[i])


@parallel_jit
def solve_spherical_many(
    arm: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve_spherical` for goals (N, 4, 4), rows (N, 8, 8) and counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve_spherical(arm, kind, goals[i], given[0], slack, rows[i])


@jit
def solve_parallel(arm: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of an arm with three parallel axes; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    return refined(arm, goal, rows, _solve(arm, goal, slack, rows, True))


@jit
def solve_spherical(arm: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of an arm with a spherical wrist; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    return refined(arm, goal, rows, _solve(arm, goal, slack, rows, False))


@jit
def _solve(arm: Floats, goal: Floats, slack: float, rows: Floats, parallel: bool) -> int:
    G = goal_of(arm, goal)
    w = minus(moved(G, point(arm, 5)), point(arm, 0))
    if not dot(w, w) < FAR:
        return 0
    count, c, s, other_c, other_s = shoulder(arm, w, slack)
    task = Asked(arm, G, slack, rows)
    if count < 0:
        return _any_shoulder(task, w, parallel)
    if count == 0:
        return 0
    free = ONE_SHOULDER if count == 1 else 0
    written = _at(task, w, (c, s), 0, free, 0, parallel)
    if count == 1:
        return written
    return _at(task, w, (other_c, other_s), 4, free, written, parallel)


@jit
def _any_shoulder(task: Asked, w: Three, parallel: bool) -> int:
    """The branches of one first joint where every value keeps the plane: of those tried, the nearest to its middle."""
    for i in range(2 * _TURNS):
        turn = math.pi * ((i + 1) // 2) / _TURNS * (1.0 if i % 2 else -1.0)
        s, c = sine_cosine(-task.arm[MIDDLES] - turn)
        count = _at(task, w, (c, s), 0, ANY_SHOULDER, 0, parallel)
        if count:
            return count
    return 0


@jit
def _at(task: Asked, w: Three, first: Two, label: int, free: int, count: int, parallel: bool) -> int:
    """Writes the branches of one first joint, given by cosine and sine of −q1; the number of rows then."""
    arm, G, (c, s) = task.arm, task.G, first
    k1, h = axis(arm, 0), axis(arm, 1)
    w = turned_about(k1, c, s, w)
    # How far from its extreme the distance from the plane is; there, two first joints become one.
    clear = 1.0 if free & ANY_SHOULDER else abs(dot(h, cross(k1, w))) / arm[SCALE]
    seen = in_plane(arm, minus(plus(w, point(arm, 0)), point(arm, 1)))
    if not parallel:
        return _spherical(task, Branch(first, seen, label, free, clear), count)
    k5, k6 = axis(arm, 4), axis(arm, 5)
    end = turned_about(k1, c, s, turned(G[0], k6))
    facing = turned_back(G[0], turned_about(k1, c, -s, h))  # the plane's normal as the last link sees it
    sine = off_axis(k6, facing)
    number, c5, s5, other_c, other_s = wrist_roots(h, k5, k6, dot(h, end), sine, ROUNDING)
    clear *= sine
    if number < 0 or sine <= _ON_AXIS:
        return _any_wrist(task, Branch(first, seen, label, free | ANY_WRIST, 0.0), (c5, s5), count)
    free |= ONE_WRIST if number == 1 else 0
    start, fifth = count, (c5, s5)
    for wrist in range(number):
        if wrist == 1:
            c5, s5 = other_c, other_s
        q6 = turn_between(k6, facing, turned_about(k5, c5, -s5, h))
        count = _plane(task, Branch(first, seen, label + 2 * wrist, free, clear), (c5, s5), q6, count)
    if number > 0 and count == start and sine <= task.slack:
        # The last joint that would be exact has the links not reach; others are as near as the axes are to parallel.
        return _any_wrist(task, Branch(first, seen, label, free | ANY_WRIST, 0.0), fifth, count)
    return count


@jit
def wrist_roots(h: Three, k: Three, v: Three, value: float, sine: float, slack: float) -> Roots:
    """`roots` for directions h and v of which a turn about k brings v near h or −h, where a cosine has lost its digits.

    With most = |k × h| |k × v|, a turn δ away from the nearest one, where the sine of their angle is sine0, gives
    sine² = sine0² + most δ². Sines are known to all their digits.

    Args:
        h: Unit direction.
        k: Unit axis.
        v: Unit direction that is turned.
        value: The wanted h · Rot(k, q) v.
        sine: The sine of the same angle.
        slack: How far beyond its extreme the value may be.
    """
    if sine > _NEARLY_ON_AXIS:
        return roots(h, k, v, value, slack)
    part = dot(h, k) * dot(k, v)
    a, b = dot(h, v) - part, dot(h, cross(k, v))
    most = math.copysign(math.sqrt(a * a + b * b), value)
    if abs(most) <= slack:
        return -1, 1.0, 0.0, 1.0, 0.0
    c, s = a / most, b / most
    least = off_axis(h, turned_about(k, c, s, v))
    square = (sine * sine - least * least) / abs(most)
    if square < 0.0 and least - sine > slack:
        return 0, 1.0, 0.0, 1.0, 0.0
    if square <= _MERGED * _MERGED:
        return 1, c, s, 1.0, 0.0
    s_d, c_d = sine_cosine(math.sqrt(square))
    return 2, c * c_d - s * s_d, s * c_d + c * s_d, c * c_d + s * s_d, s * c_d - c * s_d


@jit
def _plane(task: Asked, branch: Branch, fifth: Two, q6: float, count: int) -> int:
    """Writes the elbow's branches of three parallel axes whose other joints are known: q5 by cosine and sine, and q6.

    Returns how many rows are written then.
    """
    arm, first, (x, y) = task.arm, branch.first, branch.seen
    whole = _whole_turn(arm, task.G, first, fifth, q6)
    s, c = sine_cosine(whole + arm[LAST + 1])
    number, q2, q3, other2, other3, sine, bits = _elbow(arm, x - c * arm[LAST], y - s * arm[LAST], task.slack)
    q1, q5, start = -math.atan2(first[1], first[0]), math.atan2(fifth[1], fifth[0]), count
    for bent in range(number):
        if bent == 1:
            q2, q3 = other2, other3
        q = (q1, q2, q3, whole - q2 - q3, q5, q6)
        count = store(arm, task.rows, count, q, branch.label + bent, branch.free | bits)
    return settled_rows(arm, task.G, task.rows, count, start, branch.clear * sine) if number else count


@jit
def _whole_turn(arm: Floats, G: Placed, first: Two, fifth: Two, q6: float) -> float:
    """The sum of the three parallel joints [rad]."""
    across, (s6, c6) = beside(axis(arm, 1)), sine_cosine(q6)
    v = turned_about(axis(arm, 5), c6, -s6, turned_about(axis(arm, 4), fifth[0], -fifth[1], across))
    v = turned_about(axis(arm, 0), first[0], first[1], turned(G[0], v))
    return turn_between(axis(arm, 1), across, v)


@jit
def _any_wrist(task: Asked, branch: Branch, fifth: Two, count: int) -> int:
    """Writes the elbow's branches of one last joint where its axis is parallel to the three others.

    The sum of the four joints is given. Of the sums of three that let the links reach, whose cosine about the direction
    of W lies between two bounds, it is the middle one; so the links do not stretch unless they must.
    """
    arm, first, (x, y) = task.arm, branch.first, branch.seen
    far, last = math.sqrt(x * x + y * y), arm[LAST]
    whole = _whole_turn(arm, task.G, first, fifth, arm[MIDDLES + 5])
    product = 2.0 * far * last
    if product > ROUNDING * arm[SCALE] * arm[SCALE]:
        square, longest, shortest = far * far + last * last, arm[UPPER] + arm[LOWER], abs(arm[UPPER] - arm[LOWER])
        least = math.acos(max(-1.0, min(1.0, (square - shortest * shortest) / product)))
        most = math.acos(max(-1.0, min(1.0, (square - longest * longest) / product)))
        whole = math.atan2(y, x) - arm[LAST + 1] + 0.5 * (least + most)
    s, c = sine_cosine(whole)
    across = beside(axis(arm, 5))
    # R6 = R5ᵀ · Rot(h, −whole) · R1ᵀ · R
    v = turned_about(axis(arm, 0), first[0], first[1], turned(task.G[0], across))
    v = turned_about(axis(arm, 4), fifth[0], -fifth[1], turned_about(axis(arm, 1), c, -s, v))
    return _plane(task, branch, fifth, turn_between(axis(arm, 5), across, v), count)


@jit
def _spherical(task: Asked, branch: Branch, count: int) -> int:
    """Writes the branches of one first joint of a spherical wrist: elbow, then the wrist; the number of rows then."""
    number, q2, q3, other2, other3, sine, bits = _elbow(task.arm, branch.seen[0], branch.seen[1], task.slack)
    for bent in range(number):
        if bent == 1:
            q2, q3 = other2, other3
        label, free, clear = branch.label + bent, branch.free | bits, branch.clear * sine
        count = _wrist(task, Branch(branch.first, branch.seen, label, free, clear), q2, q3, count)
    return count


@jit
def _wrist(task: Asked, branch: Branch, q2: float, q3: float, count: int) -> int:
    arm, first, start = task.arm, branch.first, count
    k4, k5, k6 = axis(arm, 3), axis(arm, 4), axis(arm, 5)
    s, c = sine_cosine(q2 + q3)
    across = beside(k6)
    end = _seen_from_forearm(arm, task.G, first, c, s, k6)
    turning = _seen_from_forearm(arm, task.G, first, c, s, across)
    sine = off_axis(k4, end)
    number, c5, s5, other_c, other_s = wrist_roots(k4, k5, k6, dot(k4, end), sine, 1e-9)
    if number == 0:
        return count
    aligned = number < 0 or sine <= _ON_AXIS
    free = branch.free | (ANY_WRIST if aligned else ONE_WRIST if number == 1 else 0)
    for wrist in range(1 if aligned else number):
        if wrist == 1:
            c5, s5 = other_c, other_s
        q4 = arm[MIDDLES + 3] if aligned else turn_between(k4, turned_about(k5, c5, s5, k6), end)
        s4, c4 = sine_cosine(q4)
        q6 = turn_between(k6, across, turned_about(k5, c5, -s5, turned_about(k4, c4, -s4, turning)))
        q1, q5 = -math.atan2(first[1], first[0]), math.atan2(s5, c5)
        count = store(arm, task.rows, count, (q1, q2, q3, q4, q5, q6), branch.label + 2 * wrist, free)
    return settled_rows(arm, task.G, task.rows, count, start, branch.clear * sine)


@jit
def _seen_from_forearm(arm: Floats, G: Placed, first: Two, c: float, s: float, v: Three) -> Three:
    """A direction of the last link in the third joint's link."""
    return turned_about(axis(arm, 1), c, -s, turned_about(axis(arm, 0), first[0], first[1], turned(G[0], v)))


@leaf_jit
def _elbow(arm: Floats, x: float, y: float, slack: float) -> tuple[int, float, float, float, float, float, int]:
    """The second and third joint whose links end at a point of the plane.

    Args:
        arm: The arm.
        x: The point from the second joint [m].
        y: The same.
        slack: How far beyond the border will do [m].

    Returns:
        How many solutions there are; second and third joint of the first, and of the other one [rad]; sine of the bend;
        bits of the singularity.
    """
    a, b, distance = arm[UPPER], arm[LOWER], math.sqrt(x * x + y * y)
    number, t, sine, cosine = bend(a, b, distance, max(slack, ROUNDING * arm[SCALE]))
    if number == NONE:
        return 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    lean, free = math.atan2(b * sine, a + b * cosine), 0 if number == TWO else ONE_ELBOW
    towards = math.atan2(y, x)
    if distance <= ROUNDING * arm[SCALE]:  # the links fold on each other, and any second joint will do
        lean, towards, free = 0.0, arm[MIDDLES + 1] + arm[UPPER + 1], free | ANY_ELBOW
    q2, q3 = towards - arm[UPPER + 1], arm[UPPER + 1] - arm[LOWER + 1]
    return 2 if number == TWO else 1, q2 - lean, q3 + t, q2 + lean, q3 - t, sine, free
