"""Task 2b of the practicum, measured: the end in one go, or along a line of points."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["Comparison", "compare"]

_ENOUGH: Final = 0.01  # [m] task 1g
_QUARTER: Final = math.pi / 2.0
_APART: Final = 0.01  # [m] between points of a line
_FINE: Final = 20  # places at which a move between two sets of joints is looked at


@dataclass(frozen=True, slots=True)
class Comparison:
    """Both ways.

    Attributes:
        rows: Figures of the direct way, and of the way along the line.
        off_line: How many ends were reached along the line although the tip left it by 1 cm or more.
    """

    rows: tuple[dict[str, Any], dict[str, Any]]
    off_line: int


@dataclass(frozen=True, slots=True)
class _Trip:
    reached: bool
    inside: bool
    turned: bool
    off: float


def compare(count: int, seed: int) -> Comparison:
    """Random starts inside the limits, and positions 0.2 to 0.6 m away that the arm can reach."""
    import numpy as np

    from nao_kin.chain import random_configurations
    from nao_kin.output import progress
    from nao_kin.robot.robot import load

    arm, rng = load("jaco2").chain("arm"), np.random.default_rng(seed)
    problems: list[tuple[Floats, Floats]] = []
    while len(problems) < count:
        q, other = random_configurations(arm, 2, rng)
        end = arm.pose(other).translation.copy()
        if 0.2 <= np.linalg.norm(end - arm.pose(q).translation) <= 0.6:
            problems.append((q, end))
    trips = [(_direct(arm, q, p), _stepwise(arm, q, p)) for q, p in progress(problems, "task 2b", count)]
    direct, stepwise = zip(*trips, strict=True)
    off_line = sum(trip.reached and trip.off >= _ENOUGH for trip in stepwise)
    return Comparison((_row("in one go", direct), _row("1 cm steps", stepwise)), off_line)


def _direct(arm: Chain, q: Floats, p: Floats) -> _Trip:
    """The sheet's IK to the end, and all joints driven there at once."""
    from nao_kin.documents.practicum.position_ik import ik_pseudo_inverse

    return _trip(arm, [q, ik_pseudo_inverse(q, p, chain=arm).q], p)


def _stepwise(arm: Chain, q: Floats, p: Floats) -> _Trip:
    """The sheet's IK to each point of the line; where a point is missed or a joint leaps, it ends."""
    import numpy as np

    from nao_kin.documents.practicum.position_ik import ik_checked
    from nao_kin.documents.practicum.practicum_tasks import interpolate_position

    start = arm.pose(q).translation.copy()
    points = interpolate_position(start, p, math.ceil(float(np.linalg.norm(p - start)) / _APART) - 1)
    way = [q]
    for point in points[1:]:
        found = ik_checked(way[-1], point, iterations=16, largest_error=1e-3, largest_jump=0.5, chain=arm)
        if found.fault:
            break
        way.append(found.q)
    return _trip(arm, way, p)


def _trip(arm: Chain, way: list[Floats], p: Floats) -> _Trip:
    """What driving from one set of joints to the next does, seen by Pinocchio's forward kinematics."""
    import numpy as np

    from nao_kin.chain import in_limits

    shares = np.linspace(0.0, 1.0, _FINE + 1)[:, None]
    fine = [a + shares * (b - a) for a, b in itertools.pairwise(way)] or [way[0][None]]
    places = arm.poses(np.concatenate(fine))[:, :3, 3] - arm.pose(way[0]).translation
    reached = bool(np.linalg.norm(arm.pose(way[-1]).translation - p) < _ENOUGH)
    line = p - arm.pose(way[0]).translation
    along = np.clip(places @ line / (line @ line), 0.0, 1.0)
    off = float(np.linalg.norm(places - along[:, None] * line, axis=1).max())
    turned = any(bool(np.abs(b - a).max() > _QUARTER) for a, b in itertools.pairwise(way))
    return _Trip(reached, all(in_limits(arm, q) for q in way), turned, off)


def _row(how: str, trips: tuple[_Trip, ...]) -> dict[str, Any]:
    import numpy as np

    there = [trip for trip in trips if trip.reached]
    return {
        "how": how,
        "reached": 100.0 * len(there) / len(trips),
        "inside": 100.0 * sum(trip.inside for trip in there) / len(trips),
        "jumped": 100.0 * sum(trip.turned for trip in there) / len(trips),
        "off": float(np.median([trip.off for trip in there])) if there else 0.0,
        "largest": max((trip.off for trip in there), default=0.0),
    }
