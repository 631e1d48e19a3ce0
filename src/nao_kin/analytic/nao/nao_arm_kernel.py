"""The compiled solver of the NAO's arm: every solution of a pose, of a position, of a position with a pointing axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

from nao_kin.analytic.nao.nao_arm import (
    BASE,
    BEND,
    HAND,
    JOINTS,
    LENGTH,
    LOWER,
    OFFSET,
    REACH,
    SHIFTS,
    SHOULDER,
    TIP,
    UPPER,
)
from nao_kin.ik.target import POSE, POSITION
from nao_kin.kernels.compiling import jit, leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import (
    Nine,
    Three,
    between,
    cross,
    dot,
    rotation_at,
    rotation_of_goal,
    times_transposed,
    transposed_times,
    turned,
    turned_about,
    turned_back,
    turned_y,
    turned_z,
    vector_at,
    wrapped,
)
from nao_kin.kernels.trigonometry import circle_roots

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = [
    "ANY_ELBOW_ROLL",
    "ANY_SHOULDER_PITCH",
    "ANY_SHOULDER_ROLL",
    "ANY_TURN",
    "NEARLY_NOTHING",
    "NOTHING",
    "REGULAR",
    "TRIES",
    "Shoulder",
    "Upper",
    "any_inside",
    "before_elbow",
    "from_elbow_point",
    "from_shoulder",
    "pointing",
    "shoulder_at",
    "solve",
    "solve_many",
    "trial",
    "upper_arm",
    "write",
]

Upper: TypeAlias = tuple[float, float, float, float, float, float]
"""Cosine, sine and value of θ1; cosine, sine and value of θ2."""

Shoulder: TypeAlias = tuple[float, float, float, int]
"""Distance of the elbow point from axis 1; θ1 and the upper arm's direction on that side; singularity."""

# Numbers of `nao_kin.analytic.nao.nao_arm.SINGULARITIES`.
REGULAR: Final = 0
ANY_ELBOW_YAW: Final = 1
ANY_SHOULDER_PITCH: Final = 2
ANY_PITCH_AND_YAW: Final = 3
ANY_SHOULDER_ROLL: Final = 4
ANY_ELBOW_ROLL: Final = 5
ANY_TURN: Final = 6

NOTHING: Final = 1e-13
"""Sines of angles, and lengths over the upper arm's, below which rounding has eaten the angle: there is a continuum."""

TRIES: Final = 129
"""Angles of a free joint that are tried for a representative within limits."""

NEARLY_NOTHING: Final = 1e-3
"""Below this the shoulder pitch of four joints is better known from the orientation than from the elbow's place."""


@leaf_jit
def from_shoulder(parameters: Floats, goal: Floats) -> Three:
    """The goal's position seen from the shoulder, in shoulder axes [m]."""
    p = (
        goal[0, 3] - parameters[SHOULDER],
        goal[1, 3] - parameters[SHOULDER + 1],
        goal[2, 3] - parameters[SHOULDER + 2],
    )
    return turned_back(rotation_at(parameters, BASE), p)


@leaf_jit
def shoulder_at(parameters: Floats, e: Three) -> Shoulder:
    """What both shoulders share that put the elbow point to e: (e_x, −e_z) = ±across (cos θ1, sin θ1)."""
    across = math.sqrt(e[0] * e[0] + e[2] * e[2])
    if across <= NOTHING * parameters[REACH]:
        return across, 0.0, math.atan2(e[1], across), ANY_SHOULDER_PITCH
    return across, math.atan2(-e[2], e[0]), math.atan2(e[1], across), REGULAR


@leaf_jit
def upper_arm(parameters: Floats, e: Three, at: Shoulder, shoulder: int) -> Upper:
    """θ1 and θ2 of a shoulder; θ2 turns the upper arm (L, o) to (±across, e_y), whatever the two lengths."""
    L, o = parameters[LENGTH], parameters[OFFSET]
    across, t1, direction, singular = at
    signed = across
    if (shoulder == 0) != (L >= 0.0):
        signed, t1, direction = -across, t1 + math.pi, math.pi - direction
    c1, s1 = (e[0] / signed, -e[2] / signed) if singular == REGULAR else (math.cos(t1), math.sin(t1))
    both = parameters[REACH] * math.sqrt(across * across + e[1] * e[1])
    if both == 0.0:
        return c1, s1, 1.0, 0.0, t1, 0.0
    c2, s2 = (L * signed + o * e[1]) / both, (L * e[1] - o * signed) / both
    return c1, s1, c2, s2, t1, direction - parameters[BEND]


@jit
def before_elbow(upper: Upper, v: Three) -> Three:
    """Rz(−θ2) Ry(−θ1) v."""
    return turned_z(upper[2], -upper[3], turned_y(upper[0], -upper[1], v))


@leaf_jit
def from_elbow_point(parameters: Floats, e: Three, R: Nine, first: int, count: int, rows: Floats) -> int:
    """Solutions with the elbow point at e and the hand frame turned by R, both in shoulder axes.

    Labels count from `first`, rows from `count`.
    """
    at = shoulder_at(parameters, e)
    for shoulder in range(2):
        upper, begin, label = upper_arm(parameters, e, at, shoulder), count, first + 2 * shoulder
        if parameters[JOINTS] == 4.0:
            count = _four_joints(parameters, R, at, upper, label, begin, rows)
        else:
            count = _wrist(parameters, R, upper, label, at[3], begin, rows)
            k = 1
            while at[3] != REGULAR and k < TRIES and not any_inside(parameters, rows, begin, count):
                t1 = trial(k)
                turned = (math.cos(t1), math.sin(t1), upper[2], upper[3], t1, upper[5])
                count = _wrist(parameters, R, turned, label, at[3], begin, rows)
                k += 1
        if at[3] != REGULAR and abs(upper[2]) <= NOTHING:
            _share(parameters, 1.0 if upper[3] > 0.0 else -1.0, begin, count, rows)
    return count


@leaf_jit
def _share(parameters: Floats, sense: float, begin: int, end: int, rows: Floats) -> None:
    """Gives shoulder pitch and elbow yaw equal parts of what they do together where both turn about one axis."""
    for i in range(begin, end):
        rows[i, 2] = 0.5 * wrapped(rows[i, 2] + sense * rows[i, 0])
        rows[i, 0] = sense * rows[i, 2]
        rows[i, int(parameters[JOINTS]) + 1] = ANY_PITCH_AND_YAW


@leaf_jit
def _wrist(parameters: Floats, R: Nine, upper: Upper, label: int, singular: int, count: int, rows: Floats) -> int:
    """Elbow yaw and roll and wrist yaw: the x-z-x Euler angles of M = Rz(−θ2) Ry(−θ1) R.

    M e_x = (cos θ4, cos θ3 sin θ4, sin θ3 sin θ4) gives θ4 and θ3; θ5 is what is left when θ3 is undone, so that it
    makes up for a θ3 that a small sin θ4 leaves uncertain.
    """
    x = before_elbow(upper, (R[0], R[3], R[6]))
    y = before_elbow(upper, (R[1], R[4], R[7]))
    z = before_elbow(upper, (R[2], R[5], R[8]))
    s4 = math.sqrt(x[1] * x[1] + x[2] * x[2])
    if s4 <= NOTHING:
        # θ3 ± θ5 is all that is known; equal parts stay farthest from the limits.
        sense, found = 1.0 if x[0] > 0.0 else -1.0, singular if singular != REGULAR else ANY_ELBOW_YAW
        t5 = 0.5 * wrapped(math.atan2(y[2], z[2]) - sense * parameters[SHIFTS + 2])
        t3, t4 = sense * t5 + parameters[SHIFTS + 2], math.atan2(0.0, x[0])
        return write(parameters, upper, (t3, t4, t5), label, found, count, rows)
    c3, s3, t4 = x[1] / s4, x[2] / s4, math.atan2(s4, x[0])
    t3, t5 = math.atan2(x[2], x[1]), math.atan2(c3 * y[2] - s3 * y[1], c3 * z[2] - s3 * z[1])
    count = write(parameters, upper, (t3, t4, t5), label, singular, count, rows)
    return write(parameters, upper, (t3 + math.pi, -t4, t5 + math.pi), label + 1, singular, count, rows)


@jit
def trial(k: int) -> float:
    """The k-th angle to try for a joint that is free: 0, then ever farther to both sides, up to ±π [rad]."""
    step = 2.0 * math.pi / (TRIES - 1)
    return step * ((k + 1) // 2) * (1.0 if k % 2 == 1 else -1.0)


@leaf_jit
def any_inside(parameters: Floats, rows: Floats, begin: int, end: int) -> bool:
    """Whether one of the rows begin ≤ row < end is within the arm's limits."""
    for i in range(begin, end):
        inside = True
        for j in range(int(parameters[JOINTS])):
            inside = inside and parameters[LOWER + j] <= rows[i, j] <= parameters[UPPER + j]
        if inside:
            return True
    return False


@leaf_jit
def _four_joints(parameters: Floats, R: Nine, at: Shoulder, upper: Upper, label: int, count: int, rows: Floats) -> int:
    """Solutions of a pose for an arm without wrist yaw: θ3 and θ4 are read off, the judge sees to the rest.

    On axis 1 the elbow's place says nothing about θ1. There R e_z = Ry(θ1) (s2 s3, −c2 s3, c3) does: its second entry
    gives s3, and both signs of c3 are tried.
    """
    c2, s2 = upper[2], upper[3]
    across = at[0] / parameters[REACH]
    if across >= NEARLY_NOTHING or across >= abs(c2):
        return _forearm(parameters, R, upper, label, at[3], count, rows)
    s3 = max(-1.0, min(1.0, -R[5] / c2))
    for sign in range(2):
        c3 = math.sqrt((1.0 - s3) * (1.0 + s3)) * (1.0 - 2.0 * sign)
        t1 = math.atan2(R[2], R[8]) - math.atan2(s2 * s3, c3)
        turned = (math.cos(t1), math.sin(t1), c2, s2, t1, upper[5])
        count = _forearm(parameters, R, turned, label, REGULAR, count, rows)
        if c3 == 0.0:
            break
    return count


@leaf_jit
def _forearm(parameters: Floats, R: Nine, upper: Upper, label: int, singular: int, count: int, rows: Floats) -> int:
    """θ3 and θ4 of M = Rz(−θ2) Ry(−θ1) R = Rx(θ3) Rz(θ4)."""
    x = before_elbow(upper, (R[0], R[3], R[6]))
    y = before_elbow(upper, (R[1], R[4], R[7]))
    z = before_elbow(upper, (R[2], R[5], R[8]))
    wrist = (math.atan2(-z[1], z[2]), math.atan2(-y[0], x[0]), 0.0)
    return write(parameters, upper, wrist, label + (0 if y[0] < 0.0 else 1), singular, count, rows)


@leaf_jit
def write(parameters: Floats, upper: Upper, wrist: Three, label: int, singular: int, count: int, rows: Floats) -> int:
    """Writes a solution into row `count`, q = θ − shift, and returns the next row's number."""
    n, row = int(parameters[JOINTS]), rows[count]
    row[0] = wrapped(upper[4])
    row[1] = wrapped(upper[5] - parameters[SHIFTS + 1])
    row[2] = wrapped(wrist[0] - parameters[SHIFTS + 2])
    row[3] = wrapped(wrist[1] - parameters[SHIFTS + 3])
    if n == 5:
        row[4] = wrapped(wrist[2])
    row[n], row[n + 1] = label, singular
    return count + 1


@parallel_jit
def solve_many(
    parameters: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4) on all threads; given (N, k), or (1, k) for all, rows (N, B, n + 2), counts (N,)."""
    shared = given.shape[0] == 1
    for i in prange(goals.shape[0]):
        own = given[0] if shared else given[i]
        counts[i] = solve(parameters, kind, goals[i], own, slack, rows[i])


@leaf_jit
def solve(parameters: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:
    """Writes every solution of a goal into rows (B, n + 2); see `nao_kin.analytic.form.ClosedForm`."""
    if kind == POSE:
        return _pose(parameters, goal, slack, rows)
    if kind == POSITION:
        return _position(parameters, goal, given, slack, rows)
    return pointing(parameters, goal, slack, rows)


@leaf_jit
def _pose(parameters: Floats, goal: Floats, slack: float, rows: Floats) -> int:
    R = times_transposed(
        transposed_times(rotation_at(parameters, BASE), rotation_of_goal(goal)), rotation_at(parameters, HAND)
    )
    reach = turned(R, vector_at(parameters, TIP))
    d = from_shoulder(parameters, goal)
    e = (d[0] - reach[0], d[1] - reach[1], d[2] - reach[2])
    if abs(math.sqrt(dot(e, e)) - parameters[REACH]) > slack:
        return 0
    return from_elbow_point(parameters, e, R, 0, 0, rows)


@leaf_jit
def _position(parameters: Floats, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:
    """Solutions of a position with the elbow yaw given, and the wrist yaw if there is one.

    |(L, o, 0) + Rx(θ3) Rz(θ4) h| is the distance of shoulder and tip, h the tip seen from the elbow point.
    """
    t3 = given[0] + parameters[SHIFTS + 2]
    c3, s3 = math.cos(t3), math.sin(t3)
    t5 = given[1] if parameters[JOINTS] == 5.0 else 0.0
    hx, y, z = vector_at(parameters, TIP)
    hy, hz = math.cos(t5) * y - math.sin(t5) * z, math.sin(t5) * y + math.cos(t5) * z
    e, L, o = from_shoulder(parameters, goal), parameters[LENGTH], parameters[OFFSET]
    distance = math.sqrt(dot(e, e))
    a, b = L * hx + o * c3 * hy, o * c3 * hx - L * hy
    c = 0.5 * (distance * distance - L * L - o * o - hx * hx - hy * hy - hz * hz) + o * s3 * hz
    count = 0
    if math.hypot(a, b) <= NOTHING * (L * L + o * o):
        if abs(c) > slack * max(distance, math.hypot(L, o)):
            return 0
        t4 = parameters[SHIFTS + 3]
        v = _tip_before_roll(parameters, c3, s3, math.cos(t4), math.sin(t4), (hx, hy, hz))
        return _from_tip(parameters, e, v, (t3, t4, t5), 0, ANY_ELBOW_ROLL, slack, count, rows)
    roots, c4, s4, other_c4, other_s4 = circle_roots(a, b, c, slack * max(distance, math.hypot(L, o)))
    for elbow in range(roots):
        if elbow == 1:
            c4, s4 = other_c4, other_s4
        v = _tip_before_roll(parameters, c3, s3, c4, s4, (hx, hy, hz))
        count = _from_tip(parameters, e, v, (t3, math.atan2(s4, c4), t5), elbow, REGULAR, slack, count, rows)
    return count


@leaf_jit
def _tip_before_roll(parameters: Floats, c3: float, s3: float, c4: float, s4: float, h: Three) -> Three:
    """(L, o, 0) + Rx(θ3) Rz(θ4) h: the tip seen from the shoulder, before roll and pitch [m]."""
    x, y, z = turned_z(c4, s4, h)
    return parameters[LENGTH] + x, parameters[OFFSET] + c3 * y - s3 * z, s3 * y + c3 * z


@leaf_jit
def _from_tip(
    parameters: Floats,
    e: Three,
    v: Three,
    wrist: Three,
    elbow: int,
    singular: int,
    slack: float,
    count: int,
    rows: Floats,
) -> int:
    """Shoulder pitch and roll with Ry(θ1) Rz(θ2) v = e, for vectors of the same length.

    Rz(θ2) turns (v_x, v_y) to (±s, e_y), where s² is what the distance from axis 1 leaves beside v_z.
    """
    across = math.sqrt(e[0] * e[0] + e[2] * e[2])
    if abs(v[2]) - across > slack:
        return count
    s = math.sqrt(max(0.0, (across - v[2]) * (across + v[2])))
    # (±s, e_y) and (v_x, v_y), then (e_x, e_z) and (±s, v_z): each difference of two directions is an angle.
    free, direction, own = singular, math.atan2(e[1], s), math.atan2(v[1], v[0])
    if v[0] * v[0] + v[1] * v[1] <= (NOTHING * parameters[REACH]) ** 2:
        free, own = ANY_SHOULDER_ROLL if singular == REGULAR else singular, direction - parameters[SHIFTS + 1]
    around, rise = math.atan2(e[0], e[2]), math.atan2(s, v[2])
    if across <= NOTHING * parameters[REACH]:
        free, around = ANY_SHOULDER_PITCH if singular == REGULAR else singular, rise
    for shoulder in range(2 if s > 0.0 else 1):
        if (shoulder == 0) == (parameters[LENGTH] >= 0.0):
            upper = (0.0, 0.0, 0.0, 0.0, around - rise, direction - own)
        else:
            upper = (0.0, 0.0, 0.0, 0.0, around + rise, math.pi - direction - own)
        count = write(parameters, upper, wrist, 2 * shoulder + elbow, free, count, rows)
    return count


@leaf_jit
def pointing(parameters: Floats, goal: Floats, slack: float, rows: Floats) -> int:
    """Solutions of a position and a pointing axis.

    With R0 any rotation that points right and b the axis in the base, all are R = Rot(b, ψ) R0. The elbow point
    e = d − R t must be as far from the shoulder as the upper arm is long, which is linear in cos ψ and sin ψ.
    """
    base, hand = rotation_at(parameters, BASE), rotation_at(parameters, HAND)
    a = turned(hand, (goal[0, 0], goal[1, 0], goal[2, 0]))
    b = turned_back(base, (goal[0, 1], goal[1, 1], goal[2, 1]))
    d, start = from_shoulder(parameters, goal), _any_turn(a, b)
    t = turned(start, vector_at(parameters, TIP))
    along = dot(t, b)
    beside = (t[0] - along * b[0], t[1] - along * b[1], t[2] - along * b[2])
    f = (d[0] - along * b[0], d[1] - along * b[1], d[2] - along * b[2])
    square = cross(b, beside)
    rho = parameters[REACH]
    p, q, c = dot(f, beside), dot(f, square), 0.5 * (dot(f, f) + dot(beside, beside) - rho * rho)
    lever, count, through = math.hypot(p, q), 0, dot(beside, beside) > (NOTHING * rho) ** 2
    if lever <= NEARLY_NOTHING * rho * rho and through and (parameters[JOINTS] == 4.0 or lever <= NOTHING * rho * rho):
        count = _around_shoulder(parameters, f, beside, b, start, slack, rows)
    if lever <= NOTHING * rho * rho:
        if abs(math.sqrt(max(0.0, rho * rho + 2.0 * c)) - rho) > slack:
            return 0
        if through:
            return count
        return _aim_along_hand(parameters, f, d, a, b, slack, rows)
    roots, cosine, sine, other_cosine, other_sine = circle_roots(p, q, c, slack * rho)
    for turn in range(roots):
        if turn == 1:
            cosine, sine = other_cosine, other_sine
        e = _elbow_point(f, beside, b, cosine, sine)
        # Four joints can aim at b without ψ, and more exactly so, unless the axis is nearly that of the elbow roll or
        # the elbow's place does not give the shoulder pitch.
        blind = a[0] * a[0] + a[1] * a[1] < 0.25 or math.hypot(e[0], e[2]) < NEARLY_NOTHING * rho
        if parameters[JOINTS] == 5.0 or blind:
            R = _turned_on(b, cosine, sine, start)
            count = from_elbow_point(parameters, e, R, 4 + 4 * turn, count, rows)
        else:
            count = _aim(parameters, e, d, a, b, 0.0, 4 + 4 * turn, REGULAR, slack, count, rows)
    return count


@jit
def _any_turn(a: Three, b: Three) -> Nine:
    """A rotation R0 with R0 a = b."""
    x, y, z = between(a, b, (1.0, 0.0, 0.0)), between(a, b, (0.0, 1.0, 0.0)), between(a, b, (0.0, 0.0, 1.0))
    return x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]


@jit
def _turned_on(b: Three, cosine: float, sine: float, R: Nine) -> Nine:
    """Rot(b, ψ) R."""
    x = turned_about(b, cosine, sine, (R[0], R[3], R[6]))
    y = turned_about(b, cosine, sine, (R[1], R[4], R[7]))
    z = turned_about(b, cosine, sine, (R[2], R[5], R[8]))
    return x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]


@jit
def _elbow_point(f: Three, beside: Three, b: Three, cosine: float, sine: float) -> Three:
    """Where the elbow point is after a turn ψ about the pointing axis: f − Rot(b, ψ) beside."""
    x, y, z = turned_about(b, cosine, sine, beside)
    return f[0] - x, f[1] - y, f[2] - z


@leaf_jit
def _around_shoulder(
    parameters: Floats, f: Three, beside: Three, b: Three, start: Nine, slack: float, rows: Floats
) -> int:
    """Solutions where the pointing axis passes through the shoulder, so that every turn ψ keeps the elbow's distance.

    Five joints follow any turn; the first that is within limits stands for the rest. Four joints follow those where
    the x-z-x Euler angles need no wrist yaw: ψ is searched for by sign, one shoulder after the other. Where the axis
    nearly passes there, this is how ψ is known to all its digits; the elbow's distance then says if it is one.
    """
    count, n = 0, int(parameters[JOINTS])
    if n == 5:
        for k in range(TRIES + 1):
            cosine, sine = math.cos(trial(k % TRIES)), math.sin(trial(k % TRIES))  # the first again if none is inside
            e, R = _elbow_point(f, beside, b, cosine, sine), _turned_on(b, cosine, sine, start)
            count = from_elbow_point(parameters, e, R, 0, 0, rows)
            if any_inside(parameters, rows, 0, count):
                break
        for i in range(count):
            rows[i, n + 1] = ANY_TURN
        return count
    for shoulder in range(2):
        count = _search(parameters, f, beside, b, start, shoulder, slack, count, rows)
    return count


@leaf_jit
def _search(
    parameters: Floats,
    f: Three,
    beside: Three,
    b: Three,
    start: Nine,
    shoulder: int,
    slack: float,
    count: int,
    rows: Floats,
) -> int:
    """Solutions at the turns ψ where four joints need no wrist yaw: changes of sign, and dips that may hide two."""
    step = 2.0 * math.pi / (TRIES - 1)
    at_before = _wrist_needed(parameters, f, beside, b, start, shoulder, -math.pi)
    at_low = _wrist_needed(parameters, f, beside, b, start, shoulder, step - math.pi)
    for k in range(2, TRIES + 2):  # two steps more than a turn, so that each sample is once in the middle
        before, low, high = (k - 2) * step - math.pi, (k - 1) * step - math.pi, k * step - math.pi
        at_high = _wrist_needed(parameters, f, beside, b, start, shoulder, high)
        if at_low * at_high <= 0.0:
            turn = _bisected(parameters, f, beside, b, start, shoulder, low, high)
            count = _follow(parameters, f, beside, b, start, turn, slack, count, rows)
        elif at_before * at_low > 0.0 and abs(at_low) <= abs(at_before) and abs(at_low) <= abs(at_high):
            dip = _lowest(parameters, f, beside, b, start, shoulder, before, high)
            first = _bisected(parameters, f, beside, b, start, shoulder, before, dip)
            second = _bisected(parameters, f, beside, b, start, shoulder, high, dip)
            count = _follow(parameters, f, beside, b, start, first, slack, count, rows)
            count = _follow(parameters, f, beside, b, start, second, slack, count, rows)
        at_before, at_low = at_low, at_high
    return count


@leaf_jit
def _follow(
    parameters: Floats,
    f: Three,
    beside: Three,
    b: Three,
    start: Nine,
    turn: float,
    slack: float,
    count: int,
    rows: Floats,
) -> int:
    """The solutions at a turn ψ, if it puts the elbow point where the upper arm reaches."""
    cosine, sine = math.cos(turn), math.sin(turn)
    e, R = _elbow_point(f, beside, b, cosine, sine), _turned_on(b, cosine, sine, start)
    if abs(math.sqrt(dot(e, e)) - parameters[REACH]) > slack or count + 8 > rows.shape[0]:
        return count
    return from_elbow_point(parameters, e, R, 0, count, rows)


@leaf_jit
def _lowest(
    parameters: Floats, f: Three, beside: Three, b: Three, start: Nine, shoulder: int, low: float, high: float
) -> float:
    """The turn between two at which what is needed of the wrist comes nearest to changing its sign, or changes it."""
    sign = _wrist_needed(parameters, f, beside, b, start, shoulder, low)
    for _ in range(60):
        left, right = low + 0.382 * (high - low), high - 0.382 * (high - low)
        at_left = sign * _wrist_needed(parameters, f, beside, b, start, shoulder, left)
        at_right = sign * _wrist_needed(parameters, f, beside, b, start, shoulder, right)
        if at_left < at_right:
            high = right
        else:
            low = left
        if at_left < 0.0 or at_right < 0.0:
            return left if at_left < at_right else right
    return 0.5 * (low + high)


@leaf_jit
def _wrist_needed(
    parameters: Floats, f: Three, beside: Three, b: Three, start: Nine, shoulder: int, turn: float
) -> float:
    """Sine of elbow roll times sine of the wrist yaw that a turn ψ asks for: 0 where four joints can follow."""
    cosine, sine = math.cos(turn), math.sin(turn)
    e, R = _elbow_point(f, beside, b, cosine, sine), _turned_on(b, cosine, sine, start)
    needed: float = before_elbow(upper_arm(parameters, e, shoulder_at(parameters, e), shoulder), (R[2], R[5], R[8]))[0]
    return needed


@leaf_jit
def _bisected(
    parameters: Floats, f: Three, beside: Three, b: Three, start: Nine, shoulder: int, low: float, high: float
) -> float:
    """The turn between two of different sign at which no wrist yaw is needed; of equal sign, the second one."""
    sign = _wrist_needed(parameters, f, beside, b, start, shoulder, low)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if sign * _wrist_needed(parameters, f, beside, b, start, shoulder, middle) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@leaf_jit
def _aim_along_hand(parameters: Floats, e: Three, d: Three, a: Three, b: Three, slack: float, rows: Floats) -> int:
    """Solutions where the pointing axis passes through the elbow point, so that a turn about it moves nothing else.

    Of five joints one is free then: the first wrist yaw that is within limits with all others stands for the rest.
    """
    if parameters[JOINTS] != 5.0:
        return _aim(parameters, e, d, a, b, 0.0, 0, REGULAR, slack, 0, rows)
    for k in range(TRIES):
        count = _aim(parameters, e, d, a, b, trial(k), 0, ANY_TURN, slack, 0, rows)
        if any_inside(parameters, rows, 0, count):
            return count
    return _aim(parameters, e, d, a, b, 0.0, 0, ANY_TURN, slack, 0, rows)


@leaf_jit
def _aim(
    parameters: Floats,
    e: Three,
    d: Three,
    a: Three,
    b: Three,
    t5: float,
    first: int,
    singular: int,
    slack: float,
    count: int,
    rows: Floats,
) -> int:
    """Solutions with the elbow point at e, the tip at d and the hand's axis a along b, and θ5 known.

    Rx(θ3) Rz(θ4) turns a' = Rx(θ5) a to m, which is b before the elbow, and the hand t' likewise to d − e.
    """
    c5, s5 = math.cos(t5), math.sin(t5)
    a = (a[0], c5 * a[1] - s5 * a[2], s5 * a[1] + c5 * a[2])
    if math.sqrt(a[0] * a[0] + a[1] * a[1]) <= NOTHING:
        return count  # the hand's axis is that of the elbow roll: it points by chance, if at all
    hx, ty, tz = vector_at(parameters, TIP)
    hy, at = c5 * ty - s5 * tz, shoulder_at(parameters, e)
    free = singular if singular != REGULAR else at[3]
    for shoulder in range(2):
        upper = upper_arm(parameters, e, at, shoulder)
        m = before_elbow(upper, b)
        ahead = before_elbow(upper, (d[0] - e[0], d[1] - e[1], d[2] - e[2]))[0]
        roots, c4, s4, other_c4, other_s4 = circle_roots(a[0], -a[1], m[0], math.inf)
        for elbow in range(roots):
            if elbow == 1:
                c4, s4 = other_c4, other_s4
            if abs(c4 * hx - s4 * hy - ahead) > slack:
                continue
            y, z = s4 * a[0] + c4 * a[1], a[2]
            t3 = math.atan2(m[2] * y - m[1] * z, m[1] * y + m[2] * z)
            count = write(
                parameters, upper, (t3, math.atan2(s4, c4), t5), first + 2 * shoulder + elbow, free, count, rows
            )
    return count
