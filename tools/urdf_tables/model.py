"""What a URDF file of ours consists of, as immutable data; and the few ways to make and mirror primitive shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable

Triple: TypeAlias = tuple[float, float, float]
Sextuple: TypeAlias = tuple[float, float, float, float, float, float]
AxisName: TypeAlias = Literal["x", "y", "z"]

ZERO: Triple = (0.0, 0.0, 0.0)
X: Triple = (1.0, 0.0, 0.0)
Y: Triple = (0.0, 1.0, 0.0)
Z: Triple = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Pose:
    """Translation [m] and fixed-axis roll, pitch, yaw [rad], the URDF `origin`."""

    xyz: Triple = ZERO
    rpy: Triple = ZERO


@dataclass(frozen=True, slots=True)
class Box:
    """Full edge lengths along x, y, z."""

    size: Triple


@dataclass(frozen=True, slots=True)
class Cylinder:
    """Axis along z of its pose, centred."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """Centred on its pose."""

    radius: float


@dataclass(frozen=True, slots=True)
class Solid:
    """A primitive in its link's frame; the material is the name of a colour, empty for a collision shape."""

    shape: Box | Cylinder | Sphere
    pose: Pose
    material: str = ""


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and (ixx, ixy, ixz, iyy, iyz, izz) about the centre of mass in the link's axes."""

    mass: float
    com: Triple
    inertia: Sextuple


@dataclass(frozen=True, slots=True)
class Limit:
    """Range (None for a continuous joint), greatest speed and effort."""

    lower: float | None
    upper: float | None
    velocity: float
    effort: float


@dataclass(frozen=True, slots=True)
class Link:
    """A body, or a mere frame when it holds nothing; the remark becomes a comment of the file."""

    name: str
    visuals: tuple[Solid, ...] = ()
    collisions: tuple[Solid, ...] = ()
    inertial: Inertial | None = None
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint with its child link named; `mimic` names the leader of a joint that copies it one to one."""

    name: str
    kind: Literal["revolute", "continuous", "fixed"]
    parent: str
    child: str
    pose: Pose = Pose()
    axis: Triple | None = None
    limit: Limit | None = None
    mimic: str = ""


@dataclass(frozen=True, slots=True)
class Robot:
    """A file: name, paragraphs of its header, named colours (r, g, b, a), root link, then each joint with its child."""

    name: str
    header: tuple[str, ...]
    materials: dict[str, tuple[float, float, float, float]]
    root: Link
    limbs: tuple[tuple[Joint, Link], ...]


def frame(name: str, parent: str, xyz: Triple = ZERO, rpy: Triple = ZERO) -> tuple[Joint, Link]:
    """A massless frame fixed on a link; the joint is named after it so that no link and joint share a name."""
    return Joint(f"{name}_fixedjoint", "fixed", parent, name, Pose(xyz, rpy)), Link(name)


def box(material: str, size: Triple, xyz: Triple = ZERO, rpy: Triple = ZERO) -> Solid:
    """A box of full edge lengths."""
    return Solid(Box(size), Pose(xyz, rpy), material)


def ball(material: str, radius: float, xyz: Triple = ZERO) -> Solid:
    """A sphere."""
    return Solid(Sphere(radius), Pose(xyz), material)


def rod(material: str, radius: float, length: float, xyz: Triple = ZERO, axis: AxisName = "z") -> Solid:
    """A cylinder along one of the link's axes, centred at `xyz`."""
    quarter = math.pi / 2
    turn = {"x": (0.0, quarter, 0.0), "y": (quarter, 0.0, 0.0), "z": ZERO}[axis]
    return Solid(Cylinder(radius, length), Pose(xyz, turn), material)


def bar(material: str, radius: float, start: Triple, end: Triple) -> Solid:
    """A cylinder from one point to another."""
    dx, dy, dz = (b - a for a, b in zip(start, end, strict=True))
    length = math.hypot(dx, dy, dz)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, (start[2] + end[2]) / 2)
    turn = (0.0, math.atan2(math.hypot(dx, dy), dz), math.atan2(dy, dx))
    return Solid(Cylinder(radius, length), Pose(middle, turn), material)


def mirrored(solids: Iterable[Solid]) -> tuple[Solid, ...]:
    """The same shapes on the other side of the x-z plane."""
    return tuple(replace(solid, pose=mirror_pose(solid.pose)) for solid in solids)


def mirror_pose(pose: Pose) -> Pose:
    """The pose on the other side of the x-z plane, for a shape that is its own mirror image."""
    (x, y, z), (roll, pitch, yaw) = pose.xyz, pose.rpy
    return Pose((x, -y, z), (-roll, pitch, -yaw))


def shifted(solids: Iterable[Solid], by: Triple) -> tuple[Solid, ...]:
    """The same shapes moved along, as when a link is merged into its parent."""
    return tuple(replace(s, pose=Pose(_sum(s.pose.xyz, by), s.pose.rpy)) for s in solids)


def _sum(a: Triple, b: Triple) -> Triple:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])
