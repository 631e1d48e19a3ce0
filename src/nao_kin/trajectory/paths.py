"""Where a tip goes, without saying when: straight lines of positions and poses, and screws.

A path is a function of its share, from 0 at its start to 1 at its end; the start and the end are met exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, finite, frozen, vector
from nao_kin.errors import InvalidInputError
from nao_kin.ik.target import Target
from nao_kin.se3 import PoseLike, as_pose, rotation_distance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["Path", "PoseLine", "PositionLine", "Screw", "line_points"]


class Path(Protocol):
    """A way from a start to an end."""

    @property
    def length(self) -> float:
        """How far the tip travels [m]."""

    @property
    def angle(self) -> float:
        """How far it turns [rad]."""

    def target(self, share: float) -> Target:
        """What is wanted of the tip at a share of the way, in the base frame."""


@dataclass(frozen=True, eq=False, slots=True)
class PositionLine:
    """A straight line of positions, in any orientation.

    Attributes:
        start: Position (3,) [m].
        end: Position (3,) [m].
    """

    start: Floats
    end: Floats

    def __init__(self, start: ArrayLike, end: ArrayLike) -> None:
        """Checks and copies.

        Raises:
            InvalidInputError: Not three finite numbers each.
        """
        object.__setattr__(self, "start", frozen(vector(start, "start", 3)))
        object.__setattr__(self, "end", frozen(vector(end, "end", 3)))

    @property
    def length(self) -> float:
        """Distance of the ends [m]."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def angle(self) -> float:
        """A plain 0 [rad]: the orientation is free."""
        return 0.0

    def target(self, share: float) -> Target:
        """The position in the base frame at a share of the way, 0 … 1."""
        return Target.position(_on_line(self.start, self.end, _share(share)))


@dataclass(frozen=True, eq=False, slots=True)
class PoseLine:
    """A straight line of the tip's position, while its orientation turns evenly about one axis (SLERP).

    Source of the turn: Shoemake 1985, Animating rotation with quaternion curves.

    Attributes:
        start: T_base_tip.
        end: T_base_tip.
    """

    start: pin.SE3
    end: pin.SE3

    def __init__(self, start: PoseLike, end: PoseLike) -> None:
        """Checks and copies.

        Raises:
            InvalidInputError: Not rigid poses.
        """
        object.__setattr__(self, "start", as_pose(start, "start"))
        object.__setattr__(self, "end", as_pose(end, "end"))

    @property
    def length(self) -> float:
        """Distance of the ends [m]."""
        return float(np.linalg.norm(self.end.translation - self.start.translation))

    @property
    def angle(self) -> float:
        """Angle between the orientations of the ends [rad]."""
        return rotation_distance(self.start, self.end)

    def target(self, share: float) -> Target:
        """The pose in the base frame at a share of the way, 0 … 1."""
        part = _share(share)
        if part in (0.0, 1.0):
            return Target.pose(self.end if part else self.start)
        turned = pin.Quaternion(self.start.rotation).slerp(part, pin.Quaternion(self.end.rotation))
        place = _on_line(self.start.translation, self.end.translation, part)
        return Target.pose(pin.SE3(turned.normalized().matrix(), place))


@dataclass(frozen=True, eq=False, slots=True)
class Screw:
    """A motion with constant twist in tip axes: a turn about one fixed axis and a shift along it.

    T(s) = T_start exp(s log(T_start⁻¹ T_end)), the geodesic of SE(3) that Pinocchio's `SE3.Interpolate` walks; the
    tip's origin runs along a helix.

    Attributes:
        start: T_base_tip.
        end: T_base_tip.
        twist: log(T_start⁻¹ T_end), (linear; angular) in tip axes (6,) [m; rad].
    """

    start: pin.SE3
    end: pin.SE3
    twist: Floats

    def __init__(self, start: PoseLike, end: PoseLike) -> None:
        """Checks and copies.

        Raises:
            InvalidInputError: Not rigid poses.
        """
        first, last = as_pose(start, "start"), as_pose(end, "end")
        object.__setattr__(self, "start", first)
        object.__setattr__(self, "end", last)
        object.__setattr__(self, "twist", frozen(np.array(pin.log6(first.actInv(last)).vector)))

    @property
    def length(self) -> float:
        """Length of the helix [m]: in tip axes the origin's velocity is constant."""
        return float(np.linalg.norm(self.twist[:3]))

    @property
    def angle(self) -> float:
        """Angle of the turn [rad]."""
        return float(np.linalg.norm(self.twist[3:]))

    def target(self, share: float) -> Target:
        """The pose in the base frame at a share of the way, 0 … 1."""
        part = _share(share)
        if part in (0.0, 1.0):
            return Target.pose(self.end if part else self.start)
        return Target.pose(self.start * pin.exp6(part * self.twist))


def line_points(start: ArrayLike, end: ArrayLike, count: int) -> Floats:
    """Evenly spaced points (count, 3) [m] of a straight line, both ends among them.

    Raises:
        InvalidInputError: Not three finite numbers each, or fewer than two points.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 2:
        raise InvalidInputError("count", "an integer ≥ 2", repr(count))
    line = PositionLine(start, end)
    return np.array([_on_line(line.start, line.end, share) for share in np.linspace(0.0, 1.0, count)])


def _on_line(start: Floats, end: Floats, share: float) -> Floats:
    """The point at a share of the way; both ends exactly."""
    return np.asarray((1.0 - share) * start + share * end)


def _share(value: float) -> float:
    share = finite(value, "share")
    if not 0.0 <= share <= 1.0:
        raise InvalidInputError("share", "a number from 0 to 1", f"{share:g}")
    return share
