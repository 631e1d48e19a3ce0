"""How precisely a table's numbers were printed, and what that means at the tip."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.crosscheck.tables import ALPHA, THETA, A, D, Tables

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Resolution", "printed_resolution"]

_FINEST_DIGIT = 6  # decimals of a metre, radian or degree; what needs more was computed, not printed
_EXACT_ANGLES = math.pi / 12
_COARSEST = 0.01  # [m, rad] nobody prints less: such round numbers are round, or in another unit than is said


@dataclass(frozen=True, slots=True)
class Resolution:
    """What the digits of a table can say.

    Attributes:
        length: Unit of the last digit of its lengths [m]; 0 if they have all digits.
        angle: The same for its angles [rad].
        position: How far the tip can be off by rounding alone [m]: half a unit of every number, at full reach.
        rotation: The same for its orientation [rad].
    """

    length: float
    angle: float
    position: float
    rotation: float


def printed_resolution(table: Tables) -> Resolution:
    """The resolution of a table, read off its numbers.

    All lengths are taken to be printed to the decimal of the one with the most. Multiples of 15° are exact; other
    angles were printed in degrees or radians, whichever they have few decimals in. More than six decimals are no print,
    nor are fewer than two: such numbers count as exact.

    Args:
        table: A batch of one.
    """
    numbers = table.numbers[0]
    lengths = [
        x
        for x in (*numbers[:, [A, D]].ravel(), *table.base_translation[0], *table.tool_in_tip_axes[0])
        if abs(x) > 1e-12
    ]
    angles = [x for x in numbers[:, [ALPHA, THETA]].ravel() if not _is_multiple(x, _EXACT_ANGLES)]
    length = _last_digit(lengths)
    angle = max(math.radians(_last_digit(math.degrees(x) for x in angles)), _last_digit(angles))
    length, angle = (unit if unit <= _COARSEST else 0.0 for unit in (length, angle))
    rotation = 0.5 * angle * len(angles)
    position = 0.5 * length * len(lengths) + rotation * float(np.abs(lengths).sum() if lengths else 0.0)
    return Resolution(length, angle, position, rotation)


def _last_digit(values: Iterable[float]) -> float:
    """The largest power of ten, at most 1, of which all values are multiples; 0 if none of the first decimals is."""
    values = list(values)
    for decimals in range(_FINEST_DIGIT + 1):
        unit = 10.0**-decimals
        if values and all(_is_multiple(x, unit) for x in values):
            return unit
    return 0.0


def _is_multiple(value: float, unit: float) -> bool:
    return abs(value / unit - round(value / unit)) * unit < 1e-11
