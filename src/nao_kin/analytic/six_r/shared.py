"""What the compiled closed forms of six-joint arms share: the goal, the shoulder, polishing, writing a solution.

An arm is read as six screws at q = 0, in base axes: with G = T_base_tip(q) · T_base_tip(0)⁻¹,

    G = exp(ξ1 q1) · … · exp(ξ6 q6),    exp(ξk q) turning by q about axis h_k through point p_k,

so a point that is at x when q = 0 and moves with the last link is at G x. Met from the tip, the arm is G⁻¹ with the
same screws in the opposite order and sense, and the joints keep their values: a mirrored class needs nothing else.

Formulas run on axes that are exactly parallel and points where axes exactly meet. The arm's own numbers, which may
depart by roundings of its file, are kept beside them, and `settle` moves a solution on to those.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from nao_kin.analytic.triangle import ROUNDING
from nao_kin.kernels.compiling import jit, leaf_jit
from nao_kin.kernels.extended import refine
from nao_kin.kernels.linear import add_to_diagonal, solve_positive, times_own_transpose, transpose_times
from nao_kin.kernels.rotation import (
    Nine,
    Three,
    cross,
    dot,
    rotation_at,
    times_transposed,
    turned,
    turned_about,
    turned_back,
    vector_at,
    wrapped,
)
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

    Placed: TypeAlias = tuple[Nine, Three]
    Roots: TypeAlias = tuple[int, float, float, float, float]

__all__ = [
    "SIZE",
    "axis",
    "goal_of",
    "in_plane",
    "is_rough",
    "point",
    "refined",
    "roots",
    "settle",
    "shoulder",
    "store",
    "turn_between",
]

# Where an arm's numbers stand; see `nao_kin.analytic.six_r.recognising.packed`. Joints are in the order in which it is
# solved.
BACKWARDS, TIP, AXES, POINTS, OWN_AXES, OWN_POINTS = 0, 1, 13, 31, 49, 67
ACROSS, ALONG, MIDDLES, UPPER, LOWER, LAST, SIDE, RESIDUAL, SCALE = 85, 88, 91, 97, 99, 101, 103, 104, 105
SENSES, FOREARM = 106, 112  # a joint turns by its sense times q
JOINTS, SIZE = 116, 228  # the chain itself (7, 16), see `nao_kin.kernels.motion`

ONE_SHOULDER, ANY_SHOULDER, ANY_WRIST, ONE_ELBOW, ANY_ELBOW, ONE_WRIST = 1, 2, 4, 8, 16, 32  # bits of the singularity
ROUGH: Final = 64  # the bit of a row whose last digits are still to be found, until `refined`

_STEPS: Final = 12
_WANDERINGS: Final = 60
_NEAR: Final = 1e-6  # relative: from here Newton's steps do
CERTIFIED: Final = 1e-10  # largest miss of a solution [m, rad]
_ENOUGH: Final = 2e-16  # relative: rounding has the rest
_NEARLY: Final = 1e-4  # a solution whose joints' sines multiply to less is polished even if the arm is exact
_INVERSE_PIVOT: Final = 1e6  # [1/m²]: of the square of a singular value, which a rounding is to be small against
_MERGED: Final = 1e-7  # sine of half the angle between two roots that are one


@leaf_jit
def axis(arm: Floats, joint: int) -> Three:
    """Unit axis of a joint (0 to 5)."""
    return vector_at(arm, AXES + 3 * joint)


@leaf_jit
def point(arm: Floats, joint: int) -> Three:
    """A point on the axis of a joint (0 to 5) [m]."""
    return vector_at(arm, POINTS + 3 * joint)


@leaf_jit
def goal_of(arm: Floats, goal: Floats) -> Placed:
    """G of a goal (4, 4), or G⁻¹ for an arm that is solved from its tip: rotation, and translation [m]."""
    a, b, c = goal[0, 0], goal[0, 1], goal[0, 2]
    d, e, f = goal[1, 0], goal[1, 1], goal[1, 2]
    g, h, i = goal[2, 0], goal[2, 1], goal[2, 2]
    # `times_transposed` with the tip's rotation at q = 0; TIP holds it and the tip's place.
    R = times_transposed((a, b, c, d, e, f, g, h, i), rotation_at(arm, TIP))
    x, y, z = turned(R, vector_at(arm, TIP + 9))
    t = (goal[0, 3] - x, goal[1, 3] - y, goal[2, 3] - z)
    if arm[BACKWARDS] == 0.0:
        return R, t
    x, y, z = turned_back(R, t)
    return (R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8]), (-x, -y, -z)


@jit
def minus(a: Three, b: Three) -> Three:
    """A − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@jit
def plus(a: Three, b: Three) -> Three:
    """A + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@jit
def moved(G: Placed, v: Three) -> Three:
    """Where a point of the last link is now."""
    return plus(turned(G[0], v), G[1])


@leaf_jit
def roots(h: Three, k: Three, v: Three, value: float, slack: float) -> Roots:
    """The turns about k that give h · Rot(k, q) v a value: how many, and cosine and sine of two of them.

    They are atan2(B, A) ± arccos(…) in the order +, −; −1 where every turn does. Two that rounding hardly tells apart
    are one, at the extreme between them.
    """
    part = dot(h, k) * dot(k, v)
    a, b, c = dot(h, v) - part, dot(h, cross(k, v)), value - part
    most = math.sqrt(a * a + b * b)
    if abs(c) > most + slack:
        return 0, 1.0, 0.0, 1.0, 0.0
    if most <= slack:
        return -1, 1.0, 0.0, 1.0, 0.0
    a, b, c = a / most, b / most, max(-1.0, min(1.0, c / most))
    w = math.sqrt((1.0 - c) * (1.0 + c))
    if w <= _MERGED:
        c, w = math.copysign(1.0, c), 0.0
    return 1 if w == 0.0 else 2, a * c - b * w, b * c + a * w, a * c + b * w, b * c - a * w


@jit
def turn_between(k: Three, a: Three, b: Three) -> float:
    """The turn about k that takes a to b, seen along k [rad]; to all digits also where both are nearly along k."""
    a, b = cross(k, a), cross(k, b)
    return math.atan2(dot(k, cross(a, b)), dot(a, b))


@jit
def off_axis(k: Three, a: Three) -> float:
    """Sine of the angle between two unit vectors."""
    x, y, z = cross(k, a)
    return math.sqrt(x * x + y * y + z * z)


@jit
def beside(k: Three) -> Three:
    """A vector across k, at least half as long."""
    if abs(k[0]) < 0.6:
        return cross(k, (1.0, 0.0, 0.0))
    return cross(k, (0.0, 1.0, 0.0))


@leaf_jit
def in_plane(arm: Floats, v: Three) -> tuple[float, float]:
    """A vector in the plane across the parallel axes."""
    return dot(vector_at(arm, ACROSS), v), dot(vector_at(arm, ALONG), v)


@leaf_jit
def shoulder(arm: Floats, w: Three, slack: float) -> Roots:
    """The turns −q1 that bring a point, at w from the first axis' point, as far beside the arm's plane as it must."""
    slack = max(slack, ROUNDING * arm[SCALE])
    return roots(axis(arm, 1), axis(arm, 0), w, arm[SIDE], slack)


@leaf_jit
def store(arm: Floats, rows: Floats, count: int, q: tuple[float, ...], label: int, singularity: int) -> int:
    """Writes a solution, joints in the chain's order; the number of rows then."""
    for k in range(6):
        rows[count, 5 - k if arm[BACKWARDS] != 0.0 else k] = wrapped(arm[SENSES + k] * q[k])
    rows[count, 6], rows[count, 7] = label, singularity
    return count + 1


@leaf_jit
def needs_settling(arm: Floats, clearance: float) -> bool:
    """Whether roundings of the arm's numbers can show in a solution this far from singular."""
    return arm[RESIDUAL] > 0.1 * CERTIFIED * clearance or clearance < _NEARLY


@leaf_jit
def reach(arm: Floats, q: Floats, J: Floats) -> Placed:
    """G at q (6,), in the order of solving, of the arm's own numbers; writes the screws' Jacobian J (6, 6).

    Rows are (linear; angular), of the point that is at the base's origin.
    """
    R: Nine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    t: Three = (0.0, 0.0, 0.0)
    for k in range(6):
        h, p = vector_at(arm, OWN_AXES + 3 * k), vector_at(arm, OWN_POINTS + 3 * k)
        now, through = turned(R, h), plus(turned(R, p), t)
        moment = cross(through, now)
        J[0, k], J[1, k], J[2, k] = moment
        J[3, k], J[4, k], J[5, k] = now
        s, c = sine_cosine(q[k])
        x = turned_about(now, c, s, (R[0], R[3], R[6]))
        y = turned_about(now, c, s, (R[1], R[4], R[7]))
        z = turned_about(now, c, s, (R[2], R[5], R[8]))
        R = (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])
        t = minus(through, turned(R, p))
    return R, t


@leaf_jit
def _miss(G: Placed, reached: Placed, r: Floats) -> float:
    """The twist (6,) from where the arm is to its goal, written; the larger of its lengths [m, rad], 9 if half way."""
    E = times_transposed(G[0], reached[0])
    x, y, z = minus(G[1], turned(E, reached[1]))
    r[3], r[4], r[5] = 0.5 * (E[7] - E[5]), 0.5 * (E[2] - E[6]), 0.5 * (E[3] - E[1])
    if E[0] + E[4] + E[8] < 1.0:
        return 9.0
    r[0], r[1], r[2] = x, y, z
    ux, uy, uz = minus(G[1], reached[1])
    place, turn = ux * ux + uy * uy + uz * uz, r[3] * r[3] + r[4] * r[4] + r[5] * r[5]
    return math.sqrt(max(place, turn))


@leaf_jit
def settle(arm: Floats, G: Placed, q: Floats, W: Floats) -> float:
    """Newton's steps for the arm's own numbers, as long as they help; the miss that is left [m, rad].

    Args:
        arm: The arm.
        G: The goal, of `goal_of`.
        q: Joints (6,) in the order of solving, changed.
        W: Workspace (3, 6, 6).
    """
    J, A, r, y, step = W[0], W[1], W[2, 0], W[2, 1], W[2, 2]
    best, last = W[2, 3], math.inf
    A[0, 0] = math.inf  # for `is_rough`, where no step is taken
    for _ in range(_STEPS):
        miss = _miss(G, reach(arm, q, J), r)
        if not miss < last:
            for k in range(6):
                q[k] = best[k]
            return last
        last = miss
        for k in range(6):
            best[k] = q[k]
        if miss < _ENOUGH * arm[SCALE]:
            break
        times_own_transpose(J, A)
        add_to_diagonal(A, 1e-16 + 1e-3 * miss * miss)
        solve_positive(A, r, y)
        transpose_times(J, y, step)
        for k in range(6):
            q[k] += step[k]
    return last


@leaf_jit
def is_rough(W: Floats) -> bool:
    """Whether roundings show in the joints that `settle` left: a pivot of J Jᵀ says that a singularity is near."""
    largest = 0.0
    for k in range(6):
        largest = max(largest, W[1, k, k])
    return not largest < _INVERSE_PIVOT


@leaf_jit
def wander(arm: Floats, G: Placed, q: Floats, W: Floats) -> None:
    """Levenberg's steps from anywhere (6,), none longer than a radian; `settle` takes the same and is to follow."""
    J, A, r, y, step = W[0], W[1], W[2, 0], W[2, 1], W[2, 2]
    for _ in range(_WANDERINGS):
        miss = _miss(G, reach(arm, q, J), r)
        if miss < _NEAR * arm[SCALE]:
            return
        times_own_transpose(J, A)
        add_to_diagonal(A, 1e-14 + 1e-3 * min(1.0, miss * miss))
        solve_positive(A, r, y)
        transpose_times(J, y, step)
        longest = 1.0
        for k in range(6):
            longest = max(longest, abs(step[k]))
        for k in range(6):
            q[k] += step[k] / longest


@jit
def wandered(arm: Floats, G: Placed, starts: Floats) -> int:
    """Starts (N, 6) become solutions: the first ones, as many as returned, certified but not told apart."""
    W, count = np.empty((3, 6, 6)), 0
    for i in range(len(starts)):
        q = starts[i]
        wander(arm, G, q, W)
        if settle(arm, G, q, W) < CERTIFIED:
            for k in range(6):
                starts[count, k] = q[k]
            count += 1
    return count


@jit
def settled_rows(arm: Floats, G: Placed, rows: Floats, count: int, first: int, clearance: float) -> int:
    """Polishes the rows written since `first` where that is needed; drops those that then miss; the number left."""
    if not needs_settling(arm, clearance):
        return count
    W, q = np.empty((3, 6, 6)), np.empty(6)
    kept = first
    for row in range(first, count):
        for k in range(6):
            q[k] = arm[SENSES + k] * rows[row, 5 - k if arm[BACKWARDS] != 0.0 else k]
        miss = settle(arm, G, q, W)
        if miss < CERTIFIED or arm[RESIDUAL] < CERTIFIED:
            angles = (q[0], q[1], q[2], q[3], q[4], q[5])
            kept = store(arm, rows, kept, angles, rows[row, 6], rows[row, 7] + (ROUGH if is_rough(W) else 0))
    return kept


@jit
def refined(arm: Floats, goal: Floats, rows: Floats, count: int) -> int:
    """Finds the last digits of the rows that lack them, for a goal (4, 4); the number of rows, as before."""
    rough = 0
    for row in range(count):
        rough += rows[row, 7] >= ROUGH
    if rough == 0:
        return count
    joints, W, X = arm[JOINTS:SIZE].reshape(7, 16), np.empty((4, 6, 6)), np.empty((3, 4, 2))
    for row in range(count):
        if rows[row, 7] >= ROUGH:
            rows[row, 7] -= ROUGH
            refine(joints, goal, rows[row, :6], W, X)
            for k in range(6):
                rows[row, k] = wrapped(rows[row, k])
    return count
