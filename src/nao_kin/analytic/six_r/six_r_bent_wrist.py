"""Arms with a bent wrist, as Kinova's JACO2, compiled: one equation in the last joint, sampled on a smooth loop.

Axes 2 and 3 are parallel, 4 and 5 meet in C, 5 and 6 in D. The last joint q6 decides where C is; the first three joints
bring C there, with two shoulders and two elbows; and then axis 4 must stand at the right angle to axis 5:

    f(q6) = h4 · h5 − const = 0

Both elbows are the roots of one quadratic, so the product of their two functions has no square root in it. Shoulders
exist on intervals of q6, and at an interval's ends the two are one: with q6 = middle + half · cos φ they are the two
halves of one loop, on which the function is smooth too. So it is sampled on loops, with its slope: a change of sign
brackets a root; two samples of one sign whose slopes both point to zero may hide two, or a double one, and the dip
between them is searched. Solutions are moved on to the arm's own numbers, certified, and kept once.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from nao_kin.analytic.six_r.loops import lines, shoulder_loops, state
from nao_kin.analytic.six_r.shared import (
    BACKWARDS,
    CERTIFIED,
    LOWER,
    RESIDUAL,
    ROUGH,
    SCALE,
    SENSES,
    UPPER,
    axis,
    goal_of,
    is_rough,
    moved,
    point,
    refined,
    settle,
    store,
    turn_between,
)
from nao_kin.analytic.triangle import FAR
from nao_kin.kernels.compiling import jit, leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import dot, turned, turned_about, wrapped
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.analytic.six_r.shared import Placed
    from nao_kin.arrays import Floats

    Loop: TypeAlias = tuple[float, float, float]
    Two: TypeAlias = tuple[float, float]

__all__ = ["BRANCHES", "SAMPLES", "solve", "solve_densely", "solve_many"]

BRANCHES: Final = 16
SAMPLES: Final = 256  # a loop
_PARTS: Final = 256  # of the space between two samples where roots crowd, a power of 4
_SAME: Final = 1e-6  # two solutions whose joints are all this near are one [rad]
_DIP: Final = 1e-6  # relative: a dip that ends farther from zero is none, unless the arm's own numbers may fill it:
_DEEPER: Final = 100.0  # per relative departure of those numbers
_BISECTIONS: Final = 60
_SECTIONS: Final = 45
_ZERO: Final = 1e-6  # relative: up to this an elbow's equation holds at a root of the product
_EXACT: Final = 1e-11  # steps of a root's search shorter than this [rad] end it; the polish does the rest
_POINT: Final = 1e-7  # an interval this short [rad] is a point


class _Task(NamedTuple):
    """One goal of one arm.

    Attributes:
        arm: The arm's numbers.
        G: Where the goal puts the last link.
        L: What `nao_kin.analytic.six_r.loops.lines` wrote of it.
        rows: The solutions, written.
        W: Room to work in (3, 6, 6).
    """

    arm: Floats
    G: Placed
    L: Floats
    rows: Floats
    W: Floats


@parallel_jit
def solve_many(
    arm: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4), rows (N, 16, 8) and counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve(arm, kind, goals[i], given[0], slack, rows[i])


@jit
def solve(arm: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001
    """Every solution of a pose; see `nao_kin.analytic.form.ClosedForm` for the arguments."""
    count = _solve(arm, goal, rows, SAMPLES)
    if count % 2:  # generic counts are even: a pair was missed, or two are one
        count = _solve(arm, goal, rows, 8 * SAMPLES)
    return refined(arm, goal, rows, count)


@parallel_jit
def solve_densely(arm: Floats, samples: int, goals: Floats, rows: Floats, counts: NDArray[np.int64]) -> None:
    """`solve_many` with more samples a loop than it takes by itself, to see whether it misses any solution."""
    for i in prange(goals.shape[0]):
        counts[i] = refined(arm, goals[i], rows[i], _solve(arm, goals[i], rows[i], samples))


@jit
def _solve(arm: Floats, goal: Floats, rows: Floats, samples: int) -> int:
    G, W, L = goal_of(arm, goal), np.empty((3, 6, 6)), np.empty((10, 3))
    end = moved(G, point(arm, 5))
    if not dot(end, end) < FAR:
        return 0
    lines(arm, G, L)
    loops, count = np.empty((4, 3)), 0
    for i in range(shoulder_loops(arm, L, loops)):
        loop = (loops[i, 0], loops[i, 1], loops[i, 2])
        count = _search(_Task(arm, G, L, rows, W), loop, samples, count)
    return count


@leaf_jit
def _product(task: _Task, loop: Loop, phi: float) -> float:
    """The product of both elbows' equations."""
    _, _, _, _, _, a, b, S2, _ = state(task.arm, task.L, loop, phi)
    return a * a - b * b * S2


@leaf_jit
def _both(task: _Task, loop: Loop, phi: float) -> tuple[float, float]:
    """The product of both elbows' equations, and its slope."""
    _, _, _, _, _, a, b, S2, slope = state(task.arm, task.L, loop, phi)
    return a * a - b * b * S2, slope


@jit
def _search(task: _Task, loop: Loop, N: int, count: int) -> int:
    """Writes the solutions of one loop that are not written yet; the number of rows then."""
    if 0.0 <= loop[1] < _POINT:
        return _write(task, loop, 0.5 * math.pi, math.inf, count)
    V, width = np.empty((N + 1, 2)), 2.0 * math.pi / N
    most = 0.0
    for i in range(N):  # no sample at the ends, which are at 0 and π
        V[i, 0], V[i, 1] = _both(task, loop, width * (i + 0.5))
        most = max(most, abs(V[i, 0]))
    size = math.sqrt(most)  # of one elbow's equation
    V[N, 0], V[N, 1] = V[0, 0], V[0, 1]
    for i in range(N):
        left, start, end = width * (i + 0.5), (V[i, 0], V[i, 1]), (V[i + 1, 0], V[i + 1, 1])
        if _crowded(start, end, width):
            count = _walk(task, loop, left, width, start, end, size, count)
        else:
            count = _between(task, loop, left, width, start, end, size, count)
    return count


@leaf_jit
def _walk(
    task: _Task,
    loop: Loop,
    left: float,
    width: float,
    start: Two,
    end: Two,
    size: float,
    count: int,
) -> int:
    """Writes the solutions between two samples where roots may crowd, in steps as short as they need to be."""
    unit, at, step = width / _PARTS, 0, _PARTS // 4
    while at < _PARTS:
        there = _both(task, loop, left + unit * (at + step)) if at + step < _PARTS else end
        if step > 1 and _crowded(start, there, unit * step):
            step //= 4
            continue
        count = _between(task, loop, left + unit * at, unit * step, start, there, size, count)
        at, start = at + step, there
        while step < _PARTS // 4 and at % (4 * step) == 0:
            step *= 4
    return count


@leaf_jit
def _crowded(start: Two, end: Two, width: float) -> bool:
    """Whether there may be more roots between two samples than their signs and slopes tell.

    Of different signs, three: a cubic with three has a mean slope of at most 2/3 of the mean of its slopes at the ends.
    Of the same sign, two: one of the tangents meets zero between the samples. And near zero anything may be where the
    slope changes by half, as it does where two shoulders nearly become one.
    """
    (f, slope), (g, end_slope) = start, end
    steepest = max(abs(slope), abs(end_slope))
    if abs(end_slope - slope) > 0.5 * steepest and min(abs(f), abs(g)) < width * steepest:
        return True
    if (f < 0.0) != (g < 0.0):
        return abs(g - f) < 0.4 * width * abs(slope + end_slope)
    return abs(f) < width * (slope if f < 0.0 else -slope) or abs(g) < width * (-end_slope if g < 0.0 else end_slope)


@leaf_jit
def _between(
    task: _Task,
    loop: Loop,
    left: float,
    width: float,
    start: Two,
    end: Two,
    size: float,
    count: int,
) -> int:
    """Writes the solutions between two samples, of which there is one or, if their slopes point to zero, two."""
    (f, slope), (g, end_slope), right = start, end, left + width
    if (f < 0.0) != (g < 0.0):
        return _write(task, loop, _root(task, loop, left, right, f, g), _ZERO * size, count)
    sign = -1.0 if f < 0.0 else 1.0
    down, up = -sign * slope, sign * end_slope
    if down <= 0.0 or up <= 0.0:
        return count
    # Where the tangents meet is below the dip, if the function bends towards them as it does near a dip.
    depth = sign * (f * up + g * down) - down * up * width
    if depth >= _shallow(task.arm) * size * size * (down + up):
        return count
    return _dip(task, loop, left, right, sign, size, count)


@leaf_jit
def _shallow(arm: Floats) -> float:
    """Where a dip may hold a double root, relative to the function's size."""
    depth: float = _DIP + _DEEPER * arm[RESIDUAL] / arm[SCALE]
    return depth


@leaf_jit
def _dip(
    task: _Task,
    loop: Loop,
    a: float,
    b: float,
    sign: float,
    size: float,
    count: int,
) -> int:
    """Two roots, a double one, or none, between two samples of one sign whose slopes point to zero."""
    left, right, near = a, b, 1e-3 * size
    for _ in range(_SECTIONS):
        middle = 0.5 * (a + b)
        value, slope = _both(task, loop, middle)
        if sign * value < 0.0:
            f, g = _product(task, loop, left), _product(task, loop, right)
            count = _write(task, loop, _root(task, loop, left, middle, f, value), near, count)
            return _write(task, loop, _root(task, loop, middle, right, value, g), near, count)
        if sign * slope < 0.0:
            a = middle
        else:
            b = middle
    if abs(_product(task, loop, 0.5 * (a + b))) < _shallow(task.arm) * size * size:
        return _write(task, loop, 0.5 * (a + b), near, count)
    return count


@leaf_jit
def _root(task: _Task, loop: Loop, a: float, b: float, f: float, g: float) -> float:
    """The root between two parameters with values of different signs, by the Illinois rule with bisections."""
    kept, last = 0, a
    for i in range(_BISECTIONS):
        x = b - g * (b - a) / (g - f) if i % 4 != 3 and g != f else 0.5 * (a + b)
        value = _product(task, loop, x)
        if value == 0.0 or abs(x - last) < _EXACT:
            return x
        last = x
        if (value < 0.0) == (f < 0.0):
            a, f = x, value
            g = 0.5 * g if kept == 1 else g
            kept = 1
        else:
            b, g = x, value
            f = 0.5 * f if kept == 2 else f
            kept = 2
    return 0.5 * (a + b)


@leaf_jit
def _write(task: _Task, loop: Loop, phi: float, near: float, count: int) -> int:
    """Writes the solutions of a parameter: of the better elbow, and of the other one if it nearly is one."""
    _, _, _, _, _, a, b, S2, _ = state(task.arm, task.L, loop, phi)
    S = math.sqrt(max(S2, 0.0))
    plus_elbow, minus_elbow = abs(a - b * S), abs(a + b * S)
    if plus_elbow <= minus_elbow or plus_elbow < near:
        count = _settled(task, loop, phi, 1.0, count)
    if minus_elbow < plus_elbow or minus_elbow < near:
        count = _settled(task, loop, phi, -1.0, count)
    return count


@leaf_jit
def _settled(task: _Task, loop: Loop, phi: float, bent: float, count: int) -> int:
    """Writes the solution of a parameter and an elbow, if it is one and is not there yet."""
    arm, G, rows, W = task.arm, task.G, task.rows, task.W
    q6, c1, s1, x, y, _, _, S2, _ = state(arm, task.L, loop, phi)
    square, upper, lower = x * x + y * y, arm[UPPER], arm[LOWER]
    S = bent * math.sqrt(max(S2, 0.0))
    t = 0.5 * (lower * lower - upper * upper + square)
    q23 = math.atan2(y, x) + math.atan2(S, t) - arm[LOWER + 1]
    q2 = math.atan2(y, x) - math.atan2(S, square - t) - arm[UPPER + 1]
    s6, c6 = sine_cosine(q6)
    s23, c23 = sine_cosine(q23)
    k1, h, k4, k5, k6 = axis(arm, 0), axis(arm, 1), axis(arm, 3), axis(arm, 4), axis(arm, 5)
    fifth = turned(G[0], turned_about(k6, c6, -s6, k5))
    q4 = turn_between(k4, k5, turned_about(h, c23, -s23, turned_about(k1, c1, -s1, fifth)))
    s4, c4 = sine_cosine(q4)
    end = turned_about(k1, c1, -s1, turned(G[0], k6))
    q5 = turn_between(k5, k6, turned_about(k4, c4, -s4, turned_about(h, c23, -s23, end)))
    q = W[2, 4]
    q[0], q[1], q[2], q[3], q[4], q[5] = math.atan2(s1, c1), q2, q23 - q2, q4, q5, q6
    if not settle(arm, G, q, W) < CERTIFIED:
        return count
    for row in range(count):
        apart = 0.0
        for k in range(6):
            other = rows[row, 5 - k if arm[BACKWARDS] != 0.0 else k]
            apart = max(apart, abs(wrapped(q[k] - arm[SENSES + k] * other)))
        if apart < _SAME:
            return count
    if count == BRANCHES:
        return count
    rough = ROUGH if is_rough(W) else 0
    label = (0 if math.sin(q[2] + arm[LOWER + 1] - arm[UPPER + 1]) >= 0.0 else 1) + (0 if math.sin(q[4]) >= 0.0 else 2)
    side = loop[2] if loop[1] < 0.0 else math.sin(phi)
    return store(arm, rows, count, (q[0], q[1], q[2], q[3], q[4], q[5]), label + (0 if side >= 0.0 else 4), rough)
