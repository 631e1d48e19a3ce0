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

from nao_kin.analytic.six_r.shared import (
    ACROSS,
    ALONG,
    BACKWARDS,
    CERTIFIED,
    FOREARM,
    LOWER,
    RESIDUAL,
    ROUGH,
    SCALE,
    SENSES,
    SIDE,
    UPPER,
    axis,
    goal_of,
    in_plane,
    is_rough,
    minus,
    moved,
    plus,
    point,
    refined,
    settle,
    store,
    turn_between,
)
from nao_kin.analytic.triangle import FAR
from nao_kin.kernels.compiling import jit, leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import cross, dot, turned, turned_about, vector_at, wrapped
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.analytic.six_r.shared import Placed
    from nao_kin.arrays import Floats

    Loop: TypeAlias = tuple[float, float, float]
    Two: TypeAlias = tuple[float, float]
    State: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

__all__ = ["BRANCHES", "SAMPLES", "lines", "shoulder_loops", "solve", "solve_densely", "solve_many", "state"]

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
        L: What `nao_kin.analytic.six_r.six_r_bent_wrist.lines` wrote of it.
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


_COARSE: Final = 32  # samples of the room that the shoulder has
_LOOP_BISECTIONS: Final = 54
_TOUCHING: Final = 1e-13  # relative: room that misses zero by no more than that, touches it
_AT_END: Final = 1e-4  # sine of the loop's parameter from which on its ends' linear law holds to rounding's square root


@leaf_jit
def lines(arm: Floats, G: Placed, L: Floats) -> None:
    """C from the first joint's point [m] and the direction of axis 5, each as constant, cosine's and sine's part of q6.

    In the shoulder's axes, z along the first joint's and x such that the parallel axes have no y. Written to L (10, 3),
    with those axes' direction (x, ., z) and the way from the second joint's point to the first one's in the last rows.
    """
    k1, h, k6, D = axis(arm, 0), axis(arm, 1), axis(arm, 5), point(arm, 5)
    lean = dot(h, k1)
    wide = math.sqrt((1.0 - lean) * (1.0 + lean))
    X = ((h[0] - lean * k1[0]) / wide, (h[1] - lean * k1[1]) / wide, (h[2] - lean * k1[2]) / wide)
    Y = cross(k1, X)
    L[6, 0], L[6, 1], L[6, 2] = wide, 0.0, lean
    for i in range(2):
        v = axis(arm, 4) if i == 1 else minus(point(arm, 3), D)
        along = dot(k6, v)
        constant = (along * k6[0], along * k6[1], along * k6[2])
        side = cross(v, k6)  # Rot(k6, −q) v = constant + (v − constant) cos q + v × k6 sin q
        parts = (constant, minus(v, constant), side)
        for j in range(3):
            u = turned(G[0], parts[j])
            if i == 0 and j == 0:
                u = minus(plus(plus(u, turned(G[0], D)), G[1]), point(arm, 0))
            L[3 * i + j, 0], L[3 * i + j, 1], L[3 * i + j, 2] = dot(X, u), dot(Y, u), dot(k1, u)
    for j in range(2):
        u = vector_at(arm, ALONG if j else ACROSS)
        L[8 + j, 0], L[8 + j, 1], L[8 + j, 2] = dot(X, u), dot(Y, u), dot(k1, u)
    L[7, 0], L[7, 1] = in_plane(arm, minus(point(arm, 0), point(arm, 1)))


@leaf_jit
def _room(arm: Floats, L: Floats, q6: float) -> tuple[float, float]:
    """The square of C's distance beside the extreme of the first joint's equation [m²], and its slope.

    Negative: no shoulder.
    """
    s, c = sine_cosine(q6)
    x, y = L[0, 0] + L[1, 0] * c + L[2, 0] * s, L[0, 1] + L[1, 1] * c + L[2, 1] * s
    z = L[0, 2] + L[1, 2] * c + L[2, 2] * s
    dx, dy, dz = L[2, 0] * c - L[1, 0] * s, L[2, 1] * c - L[1, 1] * s, L[2, 2] * c - L[1, 2] * s
    k, dk = (arm[SIDE] - L[6, 2] * z) / L[6, 0], -L[6, 2] * dz / L[6, 0]
    return x * x + y * y - k * k, 2.0 * (x * dx + y * dy - k * dk)


@jit
def shoulder_loops(arm: Floats, L: Floats, loops: Floats) -> int:
    """Intervals of the last joint on which shoulders exist: middle and half width; half width −1: all round.

    `_room` is a trigonometric polynomial of degree 2: at most four zeros, and at most four extremes, so that two of
    them hardly fit between two samples. What a change of sign does not tell, an extreme near zero does.
    """
    ends, number, N = np.empty(16), 0, _COARSE  # turning points in rising order: into room, out of room, …
    first, slope = _room(arm, L, 0.0)
    left, start, start_slope = 0.0, first, slope
    for i in range(N):
        right = 2.0 * math.pi * (i + 1) / N
        end, end_slope = _room(arm, L, right)
        if i + 1 == N:  # the same place, and it has to be on the same side of zero
            end, end_slope = first, slope
        number = _turning_points(arm, L, (left, right), (start, end), (start_slope, end_slope), ends, number)
        left, start, start_slope = right, end, end_slope
    if number == 0:
        loops[0, 0], loops[0, 1], loops[0, 2] = 0.0, -1.0, 1.0
        loops[1, 0], loops[1, 1], loops[1, 2] = 0.0, -1.0, -1.0
        return 2 if first >= 0.0 else 0
    into = 0 if first < 0.0 else 1
    count = min(number // 2, len(loops))
    for k in range(count):
        start = ends[2 * k + into]
        end = ends[(2 * k + into + 1) % number]
        if end < start:
            end += 2.0 * math.pi
        loops[k, 0], loops[k, 1], loops[k, 2] = 0.5 * (start + end), 0.5 * (end - start), 0.0
    return count


@leaf_jit
def _turning_points(arm: Floats, L: Floats, at: Two, values: Two, slopes: Two, ends: Floats, number: int) -> int:
    """Writes the zeros of `_room` between two angles; the number of ends then."""
    (left, right), outside = at, values[0] < 0.0
    if outside != (values[1] < 0.0):
        ends[number] = _edge(arm, L, left, right)
        return number + 1
    sign = -1.0 if outside else 1.0
    if number >= ends.shape[0] - 2 or sign * slopes[0] > 0.0 or sign * slopes[1] < 0.0:
        return number
    top = _extreme(arm, L, left, right, sign)
    value, _ = _room(arm, L, top)
    if outside and abs(value) <= _TOUCHING * arm[SCALE] * arm[SCALE]:
        ends[number], ends[number + 1] = top, top
        return number + 2
    if (value < 0.0) != outside:
        ends[number], ends[number + 1] = _edge(arm, L, left, top), _edge(arm, L, top, right)
        return number + 2
    return number


@leaf_jit
def _edge(arm: Floats, L: Floats, a: float, b: float) -> float:
    """The zero of `_room` between two angles of which one has room; on the side that has."""
    value, _ = _room(arm, L, a)
    has = value >= 0.0
    for _ in range(_LOOP_BISECTIONS):
        middle = 0.5 * (a + b)
        value, _ = _room(arm, L, middle)
        if (value >= 0.0) == has:
            a = middle
        else:
            b = middle
    return a if has else b


@leaf_jit
def _extreme(arm: Floats, L: Floats, a: float, b: float, sign: float) -> float:
    """Where sign · `_room` is least between two angles whose slopes say that it is."""
    for _ in range(_LOOP_BISECTIONS):
        middle = 0.5 * (a + b)
        _, slope = _room(arm, L, middle)
        if sign * slope < 0.0:
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


@leaf_jit
def _last_joint(loop: Loop, phi: float) -> tuple[float, float, float, float]:
    """q6, the side of the shoulder, the slope of q6 along the loop, and the parameter's sine; 1 on a whole turn."""
    middle, half, side = loop
    if half < 0.0:
        return phi, side, 1.0, 1.0
    sine, cosine = sine_cosine(phi)
    return middle + half * cosine, 1.0 if sine >= 0.0 else -1.0, -half * sine, sine


@leaf_jit
def state(arm: Floats, L: Floats, loop: Loop, phi: float) -> State:
    """What a loop's parameter stands for: q6, cosine and sine of q1, C in the plane, and both elbows' equations.

    a ± b S are the equations of the two elbows, times |C|² [m⁴]; a, b and S² come next, and last the slope of their
    product along the loop. It is found as the values are, by the chain rule.
    """
    half, (q6, side, rate, sine) = loop[1], _last_joint(loop, phi)
    s, c = sine_cosine(q6)
    x, y = L[0, 0] + L[1, 0] * c + L[2, 0] * s, L[0, 1] + L[1, 1] * c + L[2, 1] * s
    z = L[0, 2] + L[1, 2] * c + L[2, 2] * s
    dx, dy, dz = L[2, 0] * c - L[1, 0] * s, L[2, 1] * c - L[1, 1] * s, L[2, 2] * c - L[1, 2] * s
    # Turned back by q1, C stands at (k, r, z).
    k, dk = (arm[SIDE] - L[6, 2] * z) / L[6, 0], -L[6, 2] * dz / L[6, 0]
    r = side * math.sqrt(max(x * x + y * y - k * k, 0.0))
    inverse = 1.0 / math.sqrt((x * x + y * y) * (k * k + r * r) + 1e-300)
    c1, s1 = (k * x + r * y) * inverse, (k * y - r * x) * inverse
    # Slopes along the loop. At its ends r vanishes with the rate, and their quotient is the root of another one.
    per = rate / r if r != 0.0 else 0.0
    if half >= 0.0 and abs(sine) < _AT_END:
        per = -math.sqrt(half / (abs(x * dx + y * dy - k * dk) + 1e-300))
    turn = per * (dk - c1 * dx - s1 * dy)
    dx, dy, dz, dk = rate * dx, rate * dy, rate * dz, rate * dk
    dr = c1 * dy - s1 * dx - turn * k
    u, v = L[3, 0] + L[4, 0] * c + L[5, 0] * s, L[3, 1] + L[4, 1] * c + L[5, 1] * s
    w, dw = L[3, 2] + L[4, 2] * c + L[5, 2] * s, L[5, 2] * c - L[4, 2] * s
    du, dv, dw = rate * (L[5, 0] * c - L[4, 0] * s), rate * (L[5, 1] * c - L[4, 1] * s), rate * dw
    u, v, du, dv = c1 * u + s1 * v, c1 * v - s1 * u, c1 * du + s1 * dv, c1 * dv - s1 * du
    du, dv = du + turn * v, dv - turn * u
    px = L[7, 0] + L[8, 0] * k + L[8, 1] * r + L[8, 2] * z
    py = L[7, 1] + L[9, 0] * k + L[9, 1] * r + L[9, 2] * z
    dpx, dpy = L[8, 0] * dk + L[8, 1] * dr + L[8, 2] * dz, L[9, 0] * dk + L[9, 1] * dr + L[9, 2] * dz
    ux, uy = L[8, 0] * u + L[8, 1] * v + L[8, 2] * w, L[9, 0] * u + L[9, 1] * v + L[9, 2] * w
    dux, duy = L[8, 0] * du + L[8, 1] * dv + L[8, 2] * dw, L[9, 0] * du + L[9, 1] * dv + L[9, 2] * dw
    zx, zy = ux * px + uy * py, ux * py - uy * px  # conj(U) · P
    dzx = dux * px + duy * py + ux * dpx + uy * dpy
    dzy = dux * py - duy * px + ux * dpy - uy * dpx
    mx, my = arm[FOREARM], arm[FOREARM + 1]
    zx, zy, dzx, dzy = zx * mx - zy * my, zx * my + zy * mx, dzx * mx - dzy * my, dzx * my + dzy * mx
    upper, lower = arm[UPPER] * arm[UPPER], arm[LOWER] * arm[LOWER]
    square, dsquare = px * px + py * py, 2.0 * (px * dpx + py * dpy)
    t, dt = 0.5 * (lower - upper + square), 0.5 * dsquare
    g, dg = (
        (L[6, 0] * u + L[6, 2] * w) * arm[FOREARM + 2] - arm[FOREARM + 3],
        arm[FOREARM + 2] * (L[6, 0] * du + L[6, 2] * dw),
    )
    a, da = zx * t + square * g, dzx * t + zx * dt + dsquare * g + square * dg
    S2, dS2 = lower * square - t * t, lower * dsquare - 2.0 * t * dt
    slope = 2.0 * a * da - 2.0 * zy * dzy * S2 - zy * zy * dS2
    return q6, c1, s1, px, py, a, zy, S2, slope
