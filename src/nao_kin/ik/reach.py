"""Where a chain can certainly not reach: a shell around a point that the tip never leaves."""

from __future__ import annotations

import itertools
import math
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["ReachShell", "reach_shell"]

_SWEEPS = 500  # at most; each one shortens the bound, and any number of them leaves a valid one
_ROUNDING = 1e-12  # relative; a stretched arm reaches the outer radius up to rounding, and that must count as inside


@dataclass(frozen=True, eq=False, slots=True)
class ReachShell:
    """The tip is always at a distance between `inner` and `outer` from `centre`; proven, not tight.

    Attributes:
        centre: A point on the first joint's axis, in the base frame (3,) [m].
        inner: Least distance [m].
        outer: Greatest distance [m]; infinite where there is no bound.
    """

    centre: Floats
    inner: float
    outer: float

    def misses_by(self, p_base: Floats) -> float:
        """How far at least a point (3,) [m] is from anything the tip can reach; 0 where that is not proven."""
        distance = math.dist(p_base, self.centre)
        return max(0.0, distance - self.outer * (1.0 + _ROUNDING), self.inner * (1.0 - _ROUNDING) - distance)

    def nearest(self, p_base: Floats) -> Floats:
        """The point of the shell (3,) [m] nearest to a point (3,)."""
        away = np.asarray(p_base, dtype=np.float64) - self.centre
        distance = math.dist(p_base, self.centre)
        wanted = min(max(distance, self.inner), self.outer)
        if distance == 0.0:
            away, distance = np.array([1.0, 0.0, 0.0]), 1.0
        nearest: Floats = self.centre + away * (wanted / distance)
        return nearest


_SHELLS: weakref.WeakKeyDictionary[Chain, ReachShell] = weakref.WeakKeyDictionary()


def reach_shell(chain: Chain) -> ReachShell:
    """The shell of a chain, computed once.

    A point on a joint's axis is fixed in the links on both sides of it. So the distances between one such point of
    each joint, and from the last to the tip, never change, and the polygon of these rods bounds how far the tip can be
    from the first point, which the base carries: at most their sum, and at least the longest less all the others. The
    points are slid along their axes to make the sum small. A prismatic joint adds its largest travel to both ends.

    Without a bound, which takes a prismatic joint without limits, the outer radius is infinite.
    """
    try:
        return _SHELLS[chain]
    except KeyError:
        shell = _SHELLS[chain] = _shell(chain)
        return shell


def _shell(chain: Chain) -> ReachShell:
    path = chain.joint_path
    axes, travel = [], 0.0
    R, p = np.eye(3), np.zeros(3)
    for k, column in enumerate(path.columns):  # the physical joints at value 0, whatever moves them
        p, R = p + R @ path.translations[k], R @ path.rotations[k]
        if path.prismatic[k]:
            ends = (path.multipliers[k] * end + path.offsets[k] for end in (path.lower[column], path.upper[column]))
            travel += max(map(abs, ends))
        else:
            axes.append((p, R[:, 2]))
    points = _short_polygon(axes, p + R @ path.tool_translation)
    rods = [math.dist(a, b) for a, b in itertools.pairwise(points)]
    outer = sum(rods)
    inner = max(0.0, 2.0 * max(rods, default=0.0) - outer)
    return ReachShell(points[0], max(0.0, inner - travel), outer + travel)


def _short_polygon(axes: list[tuple[Floats, Floats]], tip: Floats) -> list[Floats]:
    """One point on each axis and the tip, the sum of their distances made small by sliding one point at a time."""
    points = [point for point, _ in axes] + [tip]
    for _ in range(_SWEEPS):
        last = points.copy()
        for k in reversed(range(len(axes))):
            before = points[k - 1] if k else None
            points[k] = _between(*axes[k], before, points[k + 1])
        if max(map(math.dist, points, last)) < 1e-14:
            break
    return points


def _between(point: Floats, direction: Floats, before: Floats | None, after: Floats) -> Floats:
    """The point of a line with the shortest way from `before` over it to `after`, or just to `after`."""

    def along(p: Floats) -> float:
        return float((p - point) @ direction)

    def off(p: Floats) -> float:
        return float(np.linalg.norm(p - point - along(p) * direction))

    if before is None:
        return point + along(after) * direction
    # Unfolded into one plane the way is straight, so it crosses the line at a place weighted by the two distances.
    total = off(before) + off(after)
    share = 0.5 if total == 0.0 else off(before) / total
    return point + ((1.0 - share) * along(before) + share * along(after)) * direction
