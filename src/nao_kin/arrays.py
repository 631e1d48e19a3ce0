"""The one place where what a caller passes becomes a float64 array of a known shape, or a float.

Every array is a fresh, C-contiguous copy, so nothing downstream can change the caller's data. What does not fit
raises `InvalidInputError` naming the argument, what was expected and what came.
"""

from __future__ import annotations

import contextlib
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nao_kin.errors import InvalidInputError

__all__ = ["Floats", "finite", "frozen", "matrix", "positive", "rows", "vector"]

Floats = NDArray[np.float64]


def vector(value: ArrayLike, what: str, size: int) -> Floats:
    """A finite vector of `size` numbers, copied.

    Raises:
        InvalidInputError: Not numbers, another shape, or not finite.
    """
    return _finite(_floats(value, what, f"{size} numbers"), what, (size,), f"{size} numbers")


def matrix(value: ArrayLike, what: str, shape: tuple[int, int]) -> Floats:
    """A finite matrix of the given shape, copied.

    Raises:
        InvalidInputError: Not numbers, another shape, or not finite.
    """
    expected = f"a {shape[0]}×{shape[1]} matrix"
    return _finite(_floats(value, what, expected), what, shape, expected)


def rows(value: ArrayLike, what: str, width: int) -> Floats:
    """Finite rows of `width` numbers, shape (N, width), copied.

    Raises:
        InvalidInputError: Not numbers, another shape, or not finite (the first bad row is named).
    """
    expected = f"an (N, {width}) array"
    array = _floats(value, what, expected)
    if array.ndim != 2 or array.shape[1] != width:
        raise InvalidInputError(what, expected, f"shape {array.shape}")
    return _finite(array, what, array.shape, expected)


def finite(value: object, what: str, unit: str = "") -> float:
    """A finite number.

    Raises:
        InvalidInputError: None, or not finite; truth values are no numbers.
    """
    found = _number(value)
    if not math.isfinite(found):
        raise InvalidInputError(what, f"a finite number{f' {unit}' if unit else ''}", _short(value))
    return found


def positive(value: object, what: str, unit: str = "", *, endless: bool = False) -> float:
    """A number above 0, finite unless `endless`.

    Raises:
        InvalidInputError: None of these; truth values are no numbers.
    """
    found = _number(value)
    if not (0.0 < found < math.inf or (endless and found == math.inf)):
        expected = f"a {'' if endless else 'finite '}number > 0{f' {unit}' if unit else ''}"
        raise InvalidInputError(what, expected, _short(value))
    return found


def frozen(array: Floats) -> Floats:
    """The same array, read-only from here on."""
    array.flags.writeable = False
    return array


def _number(value: object) -> float:
    """The number, or NaN for what is none."""
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        with contextlib.suppress(OverflowError):  # an integer too large for a float
            return float(value)
    return math.nan


def _floats(value: ArrayLike, what: str, expected: str) -> Floats:
    try:
        given = np.asarray(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidInputError(what, expected, f"{_short(value)} ({error})") from None
    # Text, truth values, dates and objects would all turn into numbers that nobody meant; a mask would be lost.
    if given.dtype.kind not in "iuf" or hasattr(value, "mask"):  # numpy.ma itself is slow to import
        raise InvalidInputError(what, expected, f"{_short(value)} of type {given.dtype}")
    return np.array(given, dtype=np.float64, order="C")


def _finite(array: Floats, what: str, shape: tuple[int, ...], expected: str) -> Floats:
    if array.shape != shape:
        got = _count(array.size) if array.ndim == 1 else f"shape {array.shape}"
        raise InvalidInputError(what, expected, got)
    if not np.isfinite(array).all():
        at = tuple(int(index) for index in np.argwhere(~np.isfinite(array))[0])
        place = str(at[0]) if len(at) == 1 else str(at)
        raise InvalidInputError(what, f"{expected}, all finite", f"{array[at]} at index {place}")
    return array


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _count(size: int) -> str:
    return "1 number" if size == 1 else f"{size} numbers"
