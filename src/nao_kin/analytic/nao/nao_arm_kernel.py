"""The compiled solver of the NAO's arm: every solution of a pose, of a position, of a position with a pointing axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.analytic.nao.nao_arm import BASE, HAND, JOINTS, LENGTH, OFFSET, REACH, SHIFTS, TIP
from nao_kin.analytic.nao.nao_arm_joints import (
    ANY_ELBOW_ROLL,
    ANY_SHOULDER_PITCH,
    ANY_SHOULDER_ROLL,
    ANY_TURN,
    NEARLY_NOTHING,
    NOTHING,
    REGULAR,
    TRIES,
    any_inside,
    before_elbow,
    from_elbow_point,
    from_shoulder,
    shoulder_at,
    trial,
    upper_arm,
    write,
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
    turned_z,
    vector_at,
)
from nao_kin.kernels.trigonometry import circle_roots

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["pointing", "solve", "solve_many"]


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
