"""Ramps and a cruise: what an axis with bounded speed and acceleration can do in the least, or in a given, time.

A course has three phases of constant acceleration: from the start speed to a cruising speed v, at v, and from v to the
end speed. The distance covered in a given time rises with v, so the course of a given time is unique; the shortest
one cruises as fast as the distance allows. Derived from the integrals of a constant acceleration alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

__all__ = ["Course", "Move", "duration_edges", "lasting", "shortest"]

_ROUNDING: Final = 1e-12  # relative; a duration this little too short for a move is meant to be the shortest one


@dataclass(frozen=True, slots=True)
class Move:
    """What an axis is asked for, positive in the direction of travel.

    Attributes:
        distance: How far [m or rad].
        v_start: Speed at the start [m/s or rad/s].
        v_end: Speed at the end.
        v_max: Greatest speed, either way; > 0.
        up: Greatest acceleration in the direction of travel [m/s² or rad/s²]; > 0.
        down: Greatest acceleration against it; > 0.
    """

    distance: float
    v_start: float
    v_end: float
    v_max: float
    up: float
    down: float

    @property
    def mirrored(self) -> Move:
        """The same move seen from the other direction."""
        return Move(-self.distance, -self.v_start, -self.v_end, self.v_max, self.down, self.up)

    @property
    def direct(self) -> tuple[float, float]:
        """Time and distance of one ramp from the start speed to the end speed."""
        rate = self.acceleration(self.v_start, self.v_end)
        time = (self.v_end - self.v_start) / rate
        return time, time * (self.v_start + self.v_end) / 2.0

    def acceleration(self, v_from: float, v_to: float) -> float:
        """Acceleration of a ramp between two speeds, with its sign."""
        return self.up if v_to > v_from else -self.down


@dataclass(frozen=True, slots=True)
class Course:
    """Three phases.

    Attributes:
        v: Speed of the middle phase, positive in the direction of travel.
        first: Duration of the ramp to it [s].
        cruise: Duration at it [s].
        last: Duration of the ramp from it [s].
    """

    v: float
    first: float
    cruise: float
    last: float

    @property
    def duration(self) -> float:
        """All three [s]."""
        return self.first + self.cruise + self.last


def shortest(move: Move) -> Course:
    """The course of least time.

    One ramp covers a certain distance; whoever has farther to go must first speed up, whoever has less far must first
    turn back. Both end in a peak, or at the speed limit.
    """
    _, on_the_way = move.direct
    if move.distance == on_the_way:
        return _through(move, move.v_end)
    if move.distance > on_the_way:
        return _through(move, max(_peak(move), move.v_start, move.v_end))
    back = move.mirrored
    return _mirrored(_through(back, max(_peak(back), back.v_start, back.v_end)))


def lasting(move: Move, duration: float) -> Course | None:
    """The course of a given duration [s]; None where speeds at the ends leave no such course.

    Its ramps are as steep as allowed; what varies is the speed in between.
    """
    direct_time, direct_distance = move.direct
    spare = duration - direct_time
    if spare < -_ROUNDING * max(duration, direct_time):
        return None
    spare = max(spare, 0.0)
    fast, slow = max(move.v_start, move.v_end), min(move.v_start, move.v_end)
    if move.distance > direct_distance + fast * spare:
        return _above_both_ends(move, duration)
    if move.distance < direct_distance + slow * spare:
        found = _above_both_ends(move.mirrored, duration)
        return None if found is None else _mirrored(found)
    v = (move.distance - direct_distance) / spare if spare > 0.0 else move.v_end
    return _at(move, min(max(v, slow), fast), duration)


def duration_edges(move: Move) -> tuple[float, ...]:
    """Every duration [s] at which a course of it may begin or cease to exist, the least possible one among them.

    With speeds at the ends a slower course need not exist: who arrives at speed can dawdle only so long and must then
    turn back and take a new run-up.
    """
    back, found = move.mirrored, [shortest(move)]
    for side in (move, back):
        radicand, low = _peak_squared(side), max(side.v_start, side.v_end)
        root = math.sqrt(max(radicand, 0.0))
        found += [_through(side, peak) for peak in (root, -root) if radicand >= 0.0 and peak >= low]
    return tuple(sorted({course.duration for course in found}))


def _peak_squared(move: Move) -> float:
    """v² of the peak between two ramps that together cover the distance."""
    up, down = move.up, move.down
    ends = down * move.v_start * move.v_start + up * move.v_end * move.v_end
    return (2.0 * up * down * move.distance + ends) / (up + down)


def _peak(move: Move) -> float:
    return math.sqrt(max(_peak_squared(move), 0.0))


def _through(move: Move, peak: float) -> Course:
    """The course that reaches a peak, or cruises at the speed limit below it."""
    v = min(max(peak, -move.v_max), move.v_max)
    course = _ramps(move, v)
    if v == peak:
        return course
    covered = course.first * (move.v_start + v) / 2.0 + course.last * (v + move.v_end) / 2.0
    return replace(course, cruise=max((move.distance - covered) / v, 0.0))


def _above_both_ends(move: Move, duration: float) -> Course | None:
    """The course of a given duration whose cruise is faster than both ends: a quadratic in v."""
    up, down, v_start, v_end = move.up, move.down, move.v_start, move.v_end
    steep = (1.0 / up + 1.0 / down) / 2.0
    linear = duration + v_start / up + v_end / down
    constant = move.distance + v_start * v_start / (2.0 * up) + v_end * v_end / (2.0 * down)
    radicand = linear * linear - 4.0 * steep * constant
    if radicand < -_ROUNDING * linear * linear:
        return None
    root = math.sqrt(max(radicand, 0.0))
    # The lesser root, without the difference of two equal numbers.
    v = 2.0 * constant / (linear + root) if linear > 0.0 else (linear - root) / (2.0 * steep)
    if v > move.v_max * (1.0 + _ROUNDING):
        return None
    return _at(move, min(v, move.v_max), duration)


def _at(move: Move, v: float, duration: float) -> Course | None:
    course = _ramps(move, v)
    cruise = duration - course.duration
    return None if cruise < -1e-9 * duration else replace(course, cruise=max(cruise, 0.0))


def _ramps(move: Move, v: float) -> Course:
    first = (v - move.v_start) / move.acceleration(move.v_start, v)
    last = (move.v_end - v) / move.acceleration(v, move.v_end)
    return Course(v, first, 0.0, last)


def _mirrored(course: Course) -> Course:
    return replace(course, v=-course.v)
