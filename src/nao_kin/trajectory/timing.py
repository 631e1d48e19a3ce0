"""Paths with times: where a tip is to be, and when."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import Floats, frozen, positive
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.instants import SAMPLING, sample_times
from nao_kin.trajectory.trapezoid import Trapezoid

if TYPE_CHECKING:
    from nao_kin.ik.target import Target
    from nao_kin.trajectory.paths import Path

__all__ = ["TimedPath", "timed"]


@dataclass(frozen=True, eq=False, slots=True)
class TimedPath:
    """A path walked by a profile, and the times at which it is sampled.

    Attributes:
        path: Where.
        profile: Which share of it, over time: from 0 to 1.
        times: Times of the samples (N,) [s], the last one exactly at the end; read-only.
    """

    path: Path
    profile: Trapezoid
    times: Floats

    @property
    def targets(self) -> tuple[Target, ...]:
        """What is wanted at each sample."""
        return tuple(self.path.target(share) for share in self.shares)

    @property
    def shares(self) -> Floats:
        """Share of the path at each sample (N,)."""
        return np.clip(self.profile.position(self.times), 0.0, 1.0)

    @property
    def speeds(self) -> Floats:
        """Speed of the tip at each sample (N,) [m/s]."""
        return np.asarray(self.path.length * self.profile.velocity(self.times))

    @property
    def accelerations(self) -> Floats:
        """Acceleration along the path at each sample (N,) [m/s²]; where it changes, the new one."""
        return np.asarray(self.path.length * self.profile.acceleration_at(self.times))

    def target_at(self, time: float) -> Target:
        """What is wanted at a time [s]; before the start and after the end, what is wanted there."""
        return self.path.target(min(max(self.profile.position(float(time)), 0.0), 1.0))


def timed(
    path: Path,
    *,
    speed: float,
    acceleration: float,
    braking: float | None = None,
    turn_speed: float = math.inf,
    turn_acceleration: float = math.inf,
    turn_braking: float | None = None,
    start_speed: float = 0.0,
    end_speed: float = 0.0,
    sampling: float = SAMPLING,
    start_time: float = 0.0,
) -> TimedPath:
    """A path with a trapezoidal speed along its length, its turn in step with it.

    Args:
        path: Where.
        speed: Greatest speed of the tip [m/s].
        acceleration: Greatest acceleration along the path [m/s²].
        braking: Greatest deceleration along it [m/s²]; as `acceleration` unless given.
        turn_speed: Greatest angular speed [rad/s]; what it takes if it is not given, but needed for a pure turn.
        turn_acceleration: Greatest angular acceleration [rad/s²], likewise.
        turn_braking: Greatest angular deceleration [rad/s²]; as `turn_acceleration` unless given.
        start_speed: Speed of the tip at the start [m/s].
        end_speed: Speed of the tip at the end [m/s].
        sampling: Time between samples [s]; the last step is shorter where it has to be.
        start_time: When it starts [s].

    Returns:
        The path with its times, for `nao_kin.follow`.

    Raises:
        InvalidInputError: A rate is not positive, a speed at an end is above the limit, a pure turn without limits of
            the turn, or too many samples.
    """
    slow = acceleration if braking is None else braking
    turn_slow = turn_acceleration if turn_braking is None else turn_braking
    if not path.length and not path.angle:
        resting = Trapezoid(1.0, 1.0, max_velocity=1.0, acceleration=1.0, start_time=start_time)
        return TimedPath(path, resting, frozen(sample_times(0.0, sampling, start_time)))
    profile = Trapezoid(
        0.0,
        1.0,
        max_velocity=_share_rate(path, speed, turn_speed, "speed", "[m/s, rad/s]"),
        acceleration=_share_rate(path, acceleration, turn_acceleration, "acceleration", "[m/s², rad/s²]"),
        braking=_share_rate(path, slow, turn_slow, "braking", "[m/s², rad/s²]"),
        start_velocity=_end_share(path, start_speed, "start_speed"),
        end_velocity=_end_share(path, end_speed, "end_speed"),
        start_time=start_time,
    )
    shares = profile.position(np.array(profile.phase_times))
    if shares.min() < 0.0 or shares.max() > 1.0 or profile.course.v < 0.0:
        expected = f"speeds at the ends that {path.length:g} m of path leave room for"
        raise InvalidInputError("start_speed, end_speed", expected, f"{start_speed:g} m/s and {end_speed:g} m/s")
    return TimedPath(path, profile, frozen(sample_times(profile.duration, sampling, start_time)))


def _share_rate(path: Path, along: float, turn: float, what: str, unit: str) -> float:
    """The rate of the share at which neither the tip's way nor its turn is faster than allowed."""
    way, turning = positive(along, what, unit, endless=True), positive(turn, f"turn_{what}", unit, endless=True)
    rate = min(way / path.length if path.length else math.inf, turning / path.angle if path.angle else math.inf)
    if not math.isfinite(rate):
        raise InvalidInputError(what if path.length else f"turn_{what}", f"a finite number > 0 {unit}", "none")
    return rate


def _end_share(path: Path, speed: float, what: str) -> float:
    if not speed:
        return 0.0
    if not path.length:
        raise InvalidInputError(what, "0 on a path that has no length", f"{speed:g} m/s")
    if not speed > 0.0:
        raise InvalidInputError(what, "a number ≥ 0 [m/s]: backwards leaves the path", repr(speed))
    return speed / path.length
