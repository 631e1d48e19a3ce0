"""The compiled solver of the NAO's arm: every solution of a pose, of a position, of a position with a pointing axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.analytic.nao.nao_arm import BASE, HAND, JOINTS, LENGTH, OFFSET, REACH, SHIFTS, TIP
from nao_kin.analytic.nao.nao_arm_joints import (
    ANY_ELBOW_ROLL,
    ANY_SHOULDER_PITCH,
    ANY_SHOULDER_ROLL,
    NOTHING,
    REGULAR,
    from_elbow_point,
    from_shoulder,
    write,
)
from nao_kin.analytic.nao.nao_arm_pointing import pointing
from nao_kin.ik.target import POSE, POSITION
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import (
    Three,
    dot,
    rotation_at,
    rotation_of_goal,
    times_transposed,
    transposed_times,
    turned,
    turned_z,
    vector_at,
)
from nao_kin.kernels.trigonometry import circle_roots

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["solve", "solve_many"]


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
