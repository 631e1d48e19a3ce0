"""Joints of the NAO's arm from the place of its elbow point and the turn of its hand, compiled for every kind of goal.

Angles θ are those of the arm's own frames; q = θ − shift. Cosines and sines are made of lengths wherever those are at
hand, so a solution takes five arc tangents.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

from nao_kin.analytic.nao_arm import JOINTS, LENGTH, LOWER, OFFSET, SHIFTS, UPPER
from nao_kin.kernels.compiling import jit, leaf_jit
from nao_kin.kernels.rotation import Nine, Three, turned_y, turned_z, wrapped

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "ANY_ELBOW_ROLL",
    "ANY_SHOULDER_PITCH",
    "ANY_SHOULDER_ROLL",
    "ANY_TURN",
    "NOTHING",
    "REGULAR",
    "TRIES",
    "Upper",
    "any_inside",
    "before_elbow",
    "from_elbow_point",
    "shoulder_pitch",
    "shoulder_roll",
    "trial",
    "write",
]

Upper: TypeAlias = tuple[float, float, float, float]
"""Cosine and sine of θ1, cosine and sine of θ2."""

# Numbers of `nao_kin.analytic.nao_arm.SINGULARITIES`.
REGULAR: Final = 0
ANY_ELBOW_YAW: Final = 1
ANY_SHOULDER_PITCH: Final = 2
ANY_PITCH_AND_YAW: Final = 3
ANY_SHOULDER_ROLL: Final = 4
ANY_ELBOW_ROLL: Final = 5
ANY_TURN: Final = 6

NOTHING: Final = 1e-13
"""Sines of angles, and lengths over the upper arm's, below which rounding has eaten the angle: there is a continuum."""

TRIES: Final = 33
"""Angles of a free joint that are tried for a representative within limits."""

_NEARLY_NOTHING: Final = 1e-3
"""Below this the shoulder pitch of four joints is better known from the orientation than from the elbow's place."""


@leaf_jit
def shoulder_roll(parameters: Floats, across: float, along: float) -> tuple[float, float]:
    """Cosine and sine of θ2 that turn the upper arm (L, o) to (±across, along), whatever the two lengths."""
    L, o = parameters[LENGTH], parameters[OFFSET]
    signed = across if L >= 0.0 else -across
    both = math.hypot(L, o) * math.hypot(across, along)
    if both == 0.0:
        return 1.0, 0.0
    return (L * signed + o * along) / both, (L * along - o * signed) / both


@leaf_jit
def shoulder_pitch(parameters: Floats, e: Three, shoulder: int) -> tuple[float, float, int]:
    """Cosine and sine of θ1 from the elbow's place (e_x, −e_z) = ±across (cos θ1, sin θ1); singular on axis 1."""
    across = math.hypot(e[0], e[2])
    if across <= NOTHING * math.hypot(parameters[LENGTH], parameters[OFFSET]):
        return 1.0, 0.0, ANY_SHOULDER_PITCH
    signed = across if (shoulder == 0) == (parameters[LENGTH] >= 0.0) else -across
    return e[0] / signed, -e[2] / signed, REGULAR


@leaf_jit
def before_elbow(upper: Upper, v: Three) -> Three:
    """Rz(−θ2) Ry(−θ1) v."""
    c1, s1, c2, s2 = upper
    return turned_z(c2, -s2, turned_y(c1, -s1, v))


@leaf_jit
def from_elbow_point(parameters: Floats, e: Three, R: Nine, first: int, count: int, rows: Floats) -> int:
    """Solutions with the elbow point at e and the hand frame turned by R, both in shoulder axes.

    Labels count from `first`, rows from `count`.
    """
    across = math.hypot(e[0], e[2])
    for shoulder in range(2):
        c2, s2 = shoulder_roll(parameters, across if shoulder == 0 else -across, e[1])
        if parameters[JOINTS] == 5.0:
            c1, s1, singular = shoulder_pitch(parameters, e, shoulder)
            begin, label = count, first + 2 * shoulder
            count = _wrist(parameters, R, (c1, s1, c2, s2), label, singular, begin, rows)
            k = 1
            while singular != REGULAR and k < TRIES and not any_inside(parameters, rows, begin, count):
                c1, s1 = math.cos(trial(k)), math.sin(trial(k))
                count = _wrist(parameters, R, (c1, s1, c2, s2), label, singular, begin, rows)
                k += 1
        else:
            count = _four_joints(parameters, R, e, c2, s2, shoulder, first + 2 * shoulder, count, rows)
    return count


@leaf_jit
def _wrist(parameters: Floats, R: Nine, upper: Upper, label: int, singular: int, count: int, rows: Floats) -> int:
    """Elbow yaw and roll and wrist yaw: the x-z-x Euler angles of M = Rz(−θ2) Ry(−θ1) R.

    M e_x = (cos θ4, cos θ3 sin θ4, sin θ3 sin θ4) gives θ4 and θ3; θ5 is what is left when θ3 is undone, so that it
    makes up for a θ3 that a small sin θ4 leaves uncertain.
    """
    x = before_elbow(upper, (R[0], R[3], R[6]))
    y = before_elbow(upper, (R[1], R[4], R[7]))
    z = before_elbow(upper, (R[2], R[5], R[8]))
    bend = math.hypot(x[1], x[2])
    if bend <= NOTHING:
        # θ3 ± θ5 is all that is known; equal parts stay farthest from the limits.
        both = wrapped(math.atan2(y[2], z[2]) - parameters[SHIFTS + 2] * (1.0 if x[0] > 0.0 else -1.0))
        q3 = 0.5 * both if x[0] > 0.0 else -0.5 * both
        t3, t4 = q3 + parameters[SHIFTS + 2], math.atan2(0.0, x[0])
        found = singular if singular != REGULAR else ANY_ELBOW_YAW
        return write(parameters, upper, (t3, t4, 0.5 * both), label, found, count, rows)
    for elbow in range(2):
        s4 = bend if elbow == 0 else -bend
        c3, s3 = x[1] / s4, x[2] / s4
        t5 = math.atan2(c3 * y[2] - s3 * y[1], c3 * z[2] - s3 * z[1])
        wrist = (math.atan2(s3, c3), math.atan2(s4, x[0]), t5)
        count = write(parameters, upper, wrist, label + elbow, singular, count, rows)
    return count


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
def _four_joints(
    parameters: Floats, R: Nine, e: Three, c2: float, s2: float, shoulder: int, label: int, count: int, rows: Floats
) -> int:
    """Solutions of a pose for an arm without wrist yaw: θ3 and θ4 are read off, the judge sees to the rest.

    On axis 1 the elbow's place says nothing about θ1. There R e_z = Ry(θ1) (s2 s3, −c2 s3, c3) does: its second entry
    gives s3, and both signs of c3 are tried.
    """
    across = math.hypot(e[0], e[2]) / math.hypot(parameters[LENGTH], parameters[OFFSET])
    if across >= _NEARLY_NOTHING or across >= abs(c2):
        c1, s1, singular = shoulder_pitch(parameters, e, shoulder)
        return _forearm(parameters, R, (c1, s1, c2, s2), label, singular, count, rows)
    s3 = max(-1.0, min(1.0, -R[5] / c2))
    for sign in range(2):
        c3 = math.sqrt((1.0 - s3) * (1.0 + s3)) * (1.0 - 2.0 * sign)
        x, z = s2 * s3, c3
        size = math.hypot(x, z) * math.hypot(R[2], R[8])
        c1, s1 = (1.0, 0.0) if size == 0.0 else ((R[2] * x + R[8] * z) / size, (R[2] * z - R[8] * x) / size)
        count = _forearm(parameters, R, (c1, s1, c2, s2), label, REGULAR, count, rows)
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
    c1, s1, c2, s2 = upper
    n, row = int(parameters[JOINTS]), rows[count]
    row[0] = wrapped(math.atan2(s1, c1))
    row[1] = wrapped(math.atan2(s2, c2) - parameters[SHIFTS + 1])
    row[2] = wrapped(wrist[0] - parameters[SHIFTS + 2])
    row[3] = wrapped(wrist[1] - parameters[SHIFTS + 3])
    if n == 5:
        row[4] = wrapped(wrist[2])
    if singular == ANY_SHOULDER_PITCH and abs(c2) <= NOTHING:
        # The elbow yaw turns about the axis of the shoulder pitch: the two share what one of them would do.
        row[2] *= 0.5
        row[0] = row[2] if s2 > 0.0 else -row[2]
        singular = ANY_PITCH_AND_YAW
    row[n], row[n + 1] = label, singular
    return count + 1
