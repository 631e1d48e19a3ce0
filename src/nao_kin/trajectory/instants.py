"""When a motion is sampled: at a fixed rate, and exactly at its end."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from nao_kin.arrays import Floats, finite, positive
from nao_kin.errors import InvalidInputError

__all__ = ["LARGEST_COUNT", "SAMPLING", "sample_times"]

SAMPLING: Final = 0.01
"""Sampling time unless another is asked for [s]; practicum, task 2c."""

LARGEST_COUNT: Final = 1_000_000
"""Most samples of one motion; nearly three hours at the usual sampling time."""

_SHORTEST_STEP: Final = 1e-6  # a last step shorter than this share of a full one is rounding, and left out


def sample_times(duration: float, sampling: float = SAMPLING, start_time: float = 0.0) -> Floats:
    """Times (N,) [s] from the start to the end: full steps, and a shorter one last where they do not fit.

    Args:
        duration: How long the motion takes [s]; 0 gives one sample.
        sampling: Time between samples [s].
        start_time: When the motion starts [s].

    Raises:
        InvalidInputError: A number is not finite or not positive, the samples are too many, or the time between them
            is lost in the rounding of the start time.
    """
    step, length = positive(sampling, "sampling", "[s]"), finite(duration, "duration", "[s]")
    if length < 0.0:
        raise InvalidInputError("duration", "a number ≥ 0 [s]", f"{length:g}")
    if length / step > LARGEST_COUNT:
        raise InvalidInputError("sampling", f"at most {LARGEST_COUNT} samples", f"{length:g} s in steps of {step:g} s")
    count = math.ceil(length / step - _SHORTEST_STEP)
    times = finite(start_time, "start_time", "[s]") + np.append(np.arange(count) * step, length)
    if (np.diff(times) <= 0.0).any():
        raise InvalidInputError("start_time", f"one that steps of {step:g} s can be told apart at", f"{start_time:g} s")
    return times
