"""How a move from rest to rest spends its time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["PEAK", "minimum_jerk"]

PEAK: Final = 1.875
"""The greatest speed of a minimum-jerk move over its mean speed."""


def minimum_jerk(share: Floats) -> Floats:
    """How much of a move is done when a share (N,) of its time is over: 10u³ − 15u⁴ + 6u⁵ (Flash and Hogan 1985)."""
    return np.asarray(share**3 * (10.0 - 15.0 * share + 6.0 * share**2))
