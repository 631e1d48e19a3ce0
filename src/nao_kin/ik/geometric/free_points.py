"""FABRIK as published: free points at fixed distances, no hinges and no limits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import rows, vector
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["fabrik_points"]

_STRAIGHT: Final = 1e-9
"""Points that are off a line by less than this part of the chain's length lie on it."""

_BEND: Final = 0.1
"""By which part of the chain's length the inner points of a straight line are moved off it."""


def fabrik_points(
    points: ArrayLike, target: ArrayLike, tolerance: float = 1e-6, iterations: int = 1000
) -> tuple[Floats, int]:
    """Moves points so that the last one comes to the target, the first stays and neighbours keep their distances.

    A target out of reach, too far from the first point or too near to it, is answered with the straight line that ends
    nearest to it. A chain that stands in one line with the target is bent first, always in the same direction, because
    no iteration would leave the line.

    Args:
        points: Positions (k, 3) from base to tip [m], k ≥ 2; points may coincide.
        target: Where the last one is wanted (3,) [m].
        tolerance: Distance to the target at which to stop [m].
        iterations: At most so many.

    Returns:
        The points (k, 3) and the number of iterations, 0 for a target out of reach or already reached. Whether the
        target is reached is for the caller to measure.

    Raises:
        InvalidInputError: Fewer than two points, a wrong shape, a number that is not finite or a negative one.

    Source: A. Aristidou and J. Lasenby, "FABRIK: a fast, iterative solver for the inverse kinematics problem", 2011;
    Bischoff 2016, section 3.4, Algorithm 1, which prints it without the near case and stops only when the target is
    reached.
    """
    p, t = rows(points, "points", 3), vector(target, "target", 3)
    _check(p, tolerance, iterations)
    lengths = np.linalg.norm(np.diff(p, axis=0), axis=1)
    distance = float(np.linalg.norm(t - p[0]))
    if _missing(p, t) <= tolerance:
        return p, 0
    if distance >= lengths.sum() or distance <= 2.0 * lengths.max() - lengths.sum():
        return _line(p, t, lengths, distance), 0
    if _is_straight(p, t, lengths.sum()):
        p[1:-1] += _BEND * lengths.sum() * _across(p[np.linalg.norm(p - p[0], axis=1).argmax()] - p[0])
    base, done = p[0].copy(), 0
    while done < iterations and (done == 0 or _missing(p, t) > tolerance):
        _draw(p[::-1], t, lengths[::-1])
        _draw(p, base, lengths)
        done += 1
    return p, done


def _check(p: Floats, tolerance: float, iterations: int) -> None:
    if len(p) < 2:
        raise InvalidInputError("points", "two or more", str(len(p)))
    if not isinstance(tolerance, (int, float)) or not 0.0 <= tolerance < math.inf:
        raise InvalidInputError("tolerance", "a finite number ≥ 0", repr(tolerance)[:40])
    if not isinstance(iterations, int) or isinstance(iterations, bool) or iterations < 0:
        raise InvalidInputError("iterations", "an integer ≥ 0", repr(iterations)[:40])


def _missing(p: Floats, t: Floats) -> float:
    return float(np.linalg.norm(p[-1] - t))


def _draw(p: Floats, start: Floats, lengths: Floats) -> None:
    """Puts the first point at `start` and draws each next one along the line to where it is, its distance kept."""
    link = p[1:] - p[:-1]  # for a point that comes to lie on the one before it, which leaves no line
    p[0] = start
    for i, length in enumerate(lengths):
        line = p[i + 1] - p[i]
        distance = float(np.linalg.norm(line))
        if distance == 0.0:
            line, distance = link[i], float(np.linalg.norm(link[i]))
        p[i + 1] = p[i] + (line * (length / distance) if distance > 0.0 else 0.0)


def _line(p: Floats, t: Floats, lengths: Floats, distance: float) -> Floats:
    """The straight line nearest to a target out of reach: towards it; if it is too near, folded about the longest."""
    signs = np.ones(len(lengths))
    if distance < lengths.sum():
        signs[:] = -1.0
        signs[lengths.argmax()] = 1.0
    away = t - p[0] if distance > 0.0 else p[-1] - p[0]
    size = float(np.linalg.norm(away))
    direction = away / size if size > 0.0 else np.array([1.0, 0.0, 0.0])
    along = np.concatenate([[0.0], np.cumsum(signs * lengths)])
    line: Floats = p[0] + along[:, None] * direction
    return line


def _is_straight(p: Floats, t: Floats, length: float) -> bool:
    """Whether all points and the target lie on one line through the first point."""
    from_base = np.vstack([p[1:], t]) - p[0]
    farthest = from_base[np.linalg.norm(from_base, axis=1).argmax()]
    direction = farthest / np.linalg.norm(farthest)
    off = from_base - np.outer(from_base @ direction, direction)
    return float(np.linalg.norm(off, axis=1).max()) <= _STRAIGHT * length


def _across(v: Floats) -> Floats:
    """A unit vector perpendicular to this one, towards the coordinate axis that is least parallel to it."""
    across = np.cross(np.cross(v, np.eye(3)[int(np.abs(v).argmin())]), v)
    unit: Floats = across / np.linalg.norm(across)
    return unit
