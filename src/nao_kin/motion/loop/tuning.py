"""Gains for a servo, found the same way for every plant: the best run without feed-forward that does not overshoot.

Over a fixed ladder of gains, each is tried with a small step of every motor; those whose answer overshoots it by more
than allowed are out. Of the others the one with the least RMS error along the reference is taken, feed-forward off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.motion.loop.servo import PRACTICUM_PERIOD, Gains, Servo, ServoRun, reference_samples, run_servo

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.motion.loop.plants import Plant
    from nao_kin.trajectory import Trajectory

__all__ = ["FeedForwardComparison", "compare_feed_forward", "overshoot", "tune"]

_LADDER: Final = tuple(float(kp) for kp in np.geomspace(1.0, 100.0, 25))  # [1/s]
_STEP: Final = 0.01  # [rad or m] small enough to meet no limit on speed or effort
_LONGEST: Final = 20.0  # [s] after the step
_SETTLED: Final = 0.005  # of the step, and of the step a second
P_OVERSHOOT: Final = 0.01
"""Share of a step by which a P servo may overshoot it."""


def overshoot(plant: Plant, gains: Gains, q: Floats, period: float = PRACTICUM_PERIOD) -> float:
    """By how much of a small step of all motors the worst of them overshoots it, feed-forward off.

    Args:
        plant: What is driven.
        gains: The gains.
        q: Motor values (n,) at which the step is made, away from the ends of the ranges.
        period: Control period [s].
    """
    servo = Servo(plant.motors, replace(gains, feed_forward=False), period=period)
    inwards = np.where(plant.motors.upper - q > q - plant.motors.lower, _STEP, -_STEP)
    state, still, farthest = plant.at_rest(q), np.zeros_like(q), -np.inf
    for _ in range(round(_LONGEST / period)):
        command, _ = servo.command(q + inwards, still, state.q)
        state = plant.advance(state, command, period)
        farthest = max(farthest, float(((state.q - q) / inwards).max()))
        unstable = not farthest < 2.0
        left = np.abs(q + inwards - state.q).max()
        if unstable or max(left, np.abs(state.velocity).max()) < _SETTLED * _STEP:
            break
    return farthest - 1.0


def tune(
    plant: Plant,
    reference: Trajectory,
    *,
    hold: Mapping[str, float] | None = None,
    period: float = PRACTICUM_PERIOD,
    integral_times: Iterable[float] = (),
    allowed: float = P_OVERSHOOT,
) -> Gains:
    """The gains of the module's rule: for a P servo, or for a PI servo if integral times are given.

    Args:
        plant: What is driven.
        reference: What it should follow.
        hold: Values of motors that the reference does not name.
        period: Control period [s].
        integral_times: Values of kp / ki [s] to try; none for a P servo.
        allowed: Share of a step that the answer may overshoot by.

    Raises:
        InvalidInputError: Every gain of the ladder overshoots by more.
    """
    q = reference_samples(plant.motors, reference, hold, period, 0.0)[1][0]
    ladder = [Gains(kp, kp / t) for kp in _LADDER for t in integral_times] or [Gains(kp) for kp in _LADDER]
    steady = [gains for gains in ladder if overshoot(plant, gains, q, period) <= allowed]
    if not steady:
        raise InvalidInputError("allowed overshoot", "one that some gain keeps", f"{allowed:g}")
    errors = [run_servo(plant, reference, gains, hold=hold, period=period).rms_error for gains in steady]
    return steady[int(np.argmin(errors))]


@dataclass(frozen=True, eq=False, slots=True)
class FeedForwardComparison:
    """Two runs with the same gains.

    Attributes:
        gains: The gains, tuned for the run without feed-forward.
        without: The run without.
        with_it: The run with velocity feed-forward.
    """

    gains: Gains
    without: ServoRun
    with_it: ServoRun

    @property
    def rms_ratio(self) -> float:
        """How many times smaller the RMS error is with feed-forward."""
        return self.without.rms_error / self.with_it.rms_error

    @property
    def largest_ratio(self) -> float:
        """How many times smaller the largest error is with feed-forward."""
        return self.without.largest_error / self.with_it.largest_error


def compare_feed_forward(plant: Plant, reference: Trajectory, gains: Gains, **options: Any) -> FeedForwardComparison:
    """The same run without and with velocity feed-forward; options are those of `run_servo`.

    Raises:
        InvalidInputError, UnknownNameError: See `run_servo`.
    """
    runs = [run_servo(plant, reference, replace(gains, feed_forward=on), **options) for on in (False, True)]
    return FeedForwardComparison(replace(gains, feed_forward=False), *runs)
