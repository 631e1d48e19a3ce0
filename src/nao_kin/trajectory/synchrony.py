"""Several axes that start and arrive together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import Floats, vector
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.ramps import duration_edges, lasting
from nao_kin.trajectory.trapezoid import Trapezoid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["per_axis", "synchronised"]

_SLACK: Final = 1e-12  # relative; a duration found from one axis, offered to another


def synchronised(
    start: ArrayLike,
    end: ArrayLike,
    *,
    max_velocity: ArrayLike,
    acceleration: ArrayLike,
    braking: ArrayLike | None = None,
    start_velocity: ArrayLike = 0.0,
    end_velocity: ArrayLike = 0.0,
    start_time: float = 0.0,
) -> tuple[Trapezoid, ...]:
    """Moves of n axes in the least time in which all of them can arrive at once.

    The slowest axis decides; the others keep the slope of their ramps and cruise more slowly. Where speeds at the ends
    keep an axis from taking just that long, all of them take the next duration that suits every one.

    Args:
        start: Positions before (n,) [m or rad].
        end: Positions after (n,).
        max_velocity: Greatest speeds, (n,) or one for all.
        acceleration: Greatest accelerations in the direction of travel, (n,) or one for all.
        braking: Greatest accelerations against it; as `acceleration` unless given.
        start_velocity: Speeds at the start, (n,) or one for all.
        end_velocity: Speeds at the end, (n,) or one for all.
        start_time: When they start [s].

    Raises:
        InvalidInputError: Shapes do not fit, or what `Trapezoid` refuses; the message names the axis.
    """
    count = np.size(start)
    columns = {
        "start": vector(start, "start", count),
        "end": vector(end, "end", count),
        "max_velocity": per_axis(max_velocity, "max_velocity", count),
        "acceleration": per_axis(acceleration, "acceleration", count),
        "braking": per_axis(acceleration if braking is None else braking, "braking", count),
        "start_velocity": per_axis(start_velocity, "start_velocity", count),
        "end_velocity": per_axis(end_velocity, "end_velocity", count),
    }
    if not count:
        raise InvalidInputError("start", "at least one axis", "none")
    rows = [{name: float(column[i]) for name, column in columns.items()} for i in range(count)]
    alone = [_planned(row, i, start_time) for i, row in enumerate(rows)]
    duration = _common_duration(alone)
    return tuple(
        profile if profile.duration == duration else _planned(row, i, start_time, duration)
        for i, (row, profile) in enumerate(zip(rows, alone, strict=True))
    )


def per_axis(value: ArrayLike, what: str, count: int, *, endless: bool = False) -> Floats:
    """A number for each axis, out of that or of one for all; +inf too, if `endless`.

    Raises:
        InvalidInputError: Neither.
    """
    if np.ndim(value) == 0:
        value = np.full(count, value)
    if not endless:
        return vector(value, what, count)
    try:
        given = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return vector(value, what, count)  # which says what is wrong
    none = given == np.inf
    return np.where(none, np.inf, vector(np.where(none, 0.0, given), what, count))


def _common_duration(profiles: list[Trapezoid]) -> float:
    moves = [profile.move for profile in profiles]
    least = max(profile.duration for profile in profiles)
    offered = sorted({least, *(edge for move in moves for edge in duration_edges(move) if edge > least)})
    for duration in offered:
        # A breath longer, so that the axis whose edge it is does not fail by rounding.
        longer = duration if duration == least else duration * (1.0 + _SLACK)
        if all(lasting(move, longer) is not None for move in moves):
            return longer
    raise InvalidInputError("limits", "axes that can arrive together", "durations that exclude each other")


def _planned(row: dict[str, float], axis: int, start_time: float, duration: float | None = None) -> Trapezoid:
    start, end = row["start"], row["end"]
    limits = {name: value for name, value in row.items() if name not in ("start", "end")}
    try:
        return Trapezoid(start, end, **limits, start_time=start_time, duration=duration)
    except InvalidInputError as error:
        raise InvalidInputError(f"axis {axis}, {error.what}", error.expected, error.got) from None
