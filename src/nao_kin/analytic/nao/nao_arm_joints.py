"""Joints of the NAO's arm from the place of its elbow point and the turn of its hand, compiled for every kind of goal.

Angles θ are those of the arm's own frames; q = θ − shift. Cosines and sines are made of lengths, and the arc tangents
of one branch serve the others, because they are what a solution costs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

from nao_kin.analytic.nao.nao_arm import BASE, BEND, JOINTS, LENGTH, LOWER, OFFSET, REACH, SHIFTS, SHOULDER, UPPER
from nao_kin.kernels.compiling import jit, leaf_jit
from nao_kin.kernels.rotation import Nine, Three, rotation_at, turned_back, turned_y, turned_z, wrapped

if TYPE_CHECKING:
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
    "shoulder_at",
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
