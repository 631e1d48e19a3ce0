"""A move along one axis with a trapezoidal speed: speeding up, cruising, braking."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np

from nao_kin.arrays import finite, positive
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.instants import SAMPLING, sample_times
from nao_kin.trajectory.ramps import Course, Move, lasting, shortest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["Trapezoid"]


@dataclass(frozen=True, slots=True)
class Trapezoid:
    """Position over time of one axis, in the least time that its limits allow or in a given longer one.

    Lengths may be metres, radians, or shares of a path; the rates are per second of the same unit. A distance too short
    for the greatest speed gives a triangle; a distance too short for the speeds at its ends is overshot and driven
    back, as ruckig does it, for there is no other way within the limits.

    Source: practicum, section 2, (19) to (33) for a cruise from rest to rest, derived anew for all other cases.

    Attributes:
        start: Position before [m or rad].
        end: Position after [m or rad].
        max_velocity: Greatest speed, either way [m/s or rad/s].
        acceleration: Greatest acceleration in the direction from start to end [m/s² or rad/s²].
        braking: Greatest acceleration against it [m/s² or rad/s²]. Where start and end coincide, the direction is the
            positive one.
        start_velocity: Speed at the start, signed [m/s or rad/s].
        end_velocity: Speed at the end, signed [m/s or rad/s].
        start_time: When it starts [s].
        course: The three phases, in the direction of travel.
    """

    start: float
    end: float
    max_velocity: float
    acceleration: float
    braking: float
    start_velocity: float
    end_velocity: float
    start_time: float
    course: Course

    def __init__(
        self,
        start: float,
        end: float,
        *,
        max_velocity: float,
        acceleration: float,
        braking: float | None = None,
        start_velocity: float = 0.0,
        end_velocity: float = 0.0,
        start_time: float = 0.0,
        duration: float | None = None,
    ) -> None:
        """Plans the move.

        Args:
            start: Position before [m or rad].
            end: Position after.
            max_velocity: Greatest speed, either way.
            acceleration: Greatest acceleration in the direction of travel.
            braking: Greatest acceleration against it, a positive number; as `acceleration` unless given.
            start_velocity: Speed at the start, signed.
            end_velocity: Speed at the end, signed.
            start_time: When it starts [s].
            duration: How long it is to take [s]; the least possible time unless given. A longer move keeps its ramps
                and cruises more slowly.

        Raises:
            InvalidInputError: A number is not finite or not positive where it must be, a speed at an end is above the
                limit, or no course within the limits takes that long.
        """
        values = {
            "start": finite(start, "start"),
            "end": finite(end, "end"),
            "max_velocity": positive(max_velocity, "max_velocity"),
            "acceleration": positive(acceleration, "acceleration"),
            "braking": positive(acceleration if braking is None else braking, "braking"),
            "start_velocity": finite(start_velocity, "start_velocity"),
            "end_velocity": finite(end_velocity, "end_velocity"),
            "start_time": finite(start_time, "start_time", "[s]"),
        }
        for name in ("start_velocity", "end_velocity"):
            if abs(values[name]) > values["max_velocity"]:
                raise InvalidInputError(
                    name, f"at most max_velocity = {max_velocity:g}, either way", f"{values[name]:g}"
                )
        for name, value in values.items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "course", _course(self.move, duration))

    @property
    def direction(self) -> float:
        """The sign of travelling, a plain 1 or −1; 1 where start and end coincide."""
        return -1.0 if self.end < self.start else 1.0

    @property
    def move(self) -> Move:
        """What is asked for, positive in the direction of travel."""
        sign = self.direction
        v_start, v_end = sign * self.start_velocity, sign * self.end_velocity
        return Move(abs(self.end - self.start), v_start, v_end, self.max_velocity, self.acceleration, self.braking)

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return self.course.duration

    @property
    def end_time(self) -> float:
        """When it ends [s]."""
        return self.start_time + self.duration

    @property
    def phase_times(self) -> tuple[float, float, float, float]:
        """Start, begin and end of the cruise, end [s]: the practicum's t_0, t_1, t_2, t_n."""
        t_1 = self.start_time + self.course.first
        return self.start_time, t_1, t_1 + self.course.cruise, self.end_time

    @property
    def peak_velocity(self) -> float:
        """Speed of the cruise, signed [m/s or rad/s]; in a triangle, the speed at its peak."""
        return self.direction * self.course.v

    @overload
    def position(self, time: float) -> float: ...
    @overload
    def position(self, time: ArrayLike) -> Floats: ...
    def position(self, time: ArrayLike) -> Floats | float:
        """Position [m or rad] at a time or at many (k,) [s]; before the start and after the end it stands there."""
        t, left = self._since_start(time), self._until_end(time)
        sign, course = self.direction, self.course
        t_1, t_2 = course.first, course.first + course.cruise
        a_first, a_last = self._accelerations
        cruise_from = self.start + t_1 * (self.start_velocity + self.peak_velocity) / 2.0
        place = np.select(
            [t <= 0.0, t < t_1, t < t_2],
            [
                np.full_like(t, self.start),
                self.start + t * (self.start_velocity + sign * a_first * t / 2.0),
                cruise_from + self.peak_velocity * (t - t_1),
            ],
            self.end + left * (self.end_velocity + sign * a_last * left / 2.0),
        )
        return _as_given(np.where(left >= 0.0, self.end, place))

    @overload
    def velocity(self, time: float) -> float: ...
    @overload
    def velocity(self, time: ArrayLike) -> Floats: ...
    def velocity(self, time: ArrayLike) -> Floats | float:
        """Speed [m/s or rad/s] at a time or at many (k,) [s], signed; 0 before the start and after the end."""
        t, left = self._since_start(time), self._until_end(time)
        sign, course, peak = self.direction, self.course, self.peak_velocity
        t_1, t_2 = course.first, course.first + course.cruise
        a_first, a_last = self._accelerations
        first = _between(self.start_velocity + sign * a_first * t, self.start_velocity, peak)
        last = _between(self.end_velocity + sign * a_last * left, self.end_velocity, peak)
        outside = (t < 0.0) | (left > 0.0)
        return _as_given(np.select([outside, t < t_1, t < t_2], [np.zeros_like(t), first, np.full_like(t, peak)], last))

    @overload
    def acceleration_at(self, time: float) -> float: ...
    @overload
    def acceleration_at(self, time: ArrayLike) -> Floats: ...
    def acceleration_at(self, time: ArrayLike) -> Floats | float:
        """Acceleration [m/s² or rad/s²] at a time or many (k,) [s], signed; at a change, the new one. 0 outside."""
        t, sign, course = self._since_start(time), self.direction, self.course
        a_first, a_last = self._accelerations
        phases = [t < 0.0, t < course.first, t < course.first + course.cruise, self._until_end(time) < 0.0]
        return _as_given(np.select(phases, [0.0, sign * a_first, 0.0, sign * a_last], np.zeros_like(t)))

    def sample_times(self, sampling: float = SAMPLING) -> Floats:
        """Times of its samples (k,) [s] at a sampling interval [s]; see `nao_kin.trajectory.instants.sample_times`."""
        return sample_times(self.duration, sampling, self.start_time)

    @property
    def _accelerations(self) -> tuple[float, float]:
        """Of the first and the last phase, positive in the direction of travel."""
        move, v = self.move, self.course.v
        return move.acceleration(move.v_start, v), move.acceleration(v, move.v_end)

    def _since_start(self, time: ArrayLike) -> Floats:
        return np.asarray(time, dtype=np.float64) - self.start_time

    def _until_end(self, time: ArrayLike) -> Floats:
        """Negative before the end. The last phase is counted back from there, so that the end is exact."""
        return np.asarray(time, dtype=np.float64) - self.end_time


def _course(move: Move, duration: float | None) -> Course:
    if duration is None:
        course = shortest(move)
    else:
        wanted = positive(duration, "duration", "[s]") if duration != 0.0 else 0.0
        found = lasting(move, wanted)
        if found is None:
            least = shortest(move).duration
            why = f"at least {least:.6g} s" if wanted < least else "one that the speeds at both ends leave possible"
            raise InvalidInputError("duration", why, f"{wanted:.6g} s")
        course = found
    if not math.isfinite(course.v + course.duration):
        raise InvalidInputError("start, end and limits", "a move whose numbers a float holds", repr(move))
    return course


def _between(value: Floats, one: float, other: float) -> Floats:
    """Keeps rounding from carrying a speed beyond the speeds at the ends of its ramp."""
    return np.clip(value, min(one, other), max(one, other))


def _as_given(value: Floats) -> Floats | float:
    """An array for an array, a number for a number."""
    return float(value) if value.ndim == 0 else value
