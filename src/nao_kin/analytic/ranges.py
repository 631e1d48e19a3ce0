"""Ranges of joints by middle and half width, which is how closed forms choose where a solution is not unique."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["middles_and_halves"]


def middles_and_halves(lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Middles and half widths (n,) [rad] of ranges; 0 and π for a joint without limits, or with one only."""
    finite = np.isfinite(lower) & np.isfinite(upper)
    low, high = np.where(finite, lower, -math.pi), np.where(finite, upper, math.pi)
    return 0.5 * (low + high), 0.5 * (high - low)
