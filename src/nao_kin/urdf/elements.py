"""The content of a URDF file as plain immutable data, each element with the line it came from.

Lengths in metres, angles in radians, as URDF prescribes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = [
    "Box",
    "Capsule",
    "Cylinder",
    "Inertial",
    "JointKind",
    "Limit",
    "MeshFile",
    "Mimic",
    "Origin",
    "OtherShape",
    "Shape",
    "Solid",
    "Sphere",
    "UrdfJoint",
    "UrdfLink",
]

JointKind: TypeAlias = Literal["revolute", "continuous", "prismatic", "fixed"]
Triple: TypeAlias = tuple[float, float, float]
Colour: TypeAlias = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Origin:
    """Placement of an element in its parent: translation [m] and fixed-axis roll, pitch, yaw [rad] (Rz Ry Rx).

    A quaternion of format 1.1 has become the three angles.
    """

    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Box:
    """Full edge lengths along x, y, z [m], centred on the origin."""

    size: Triple


@dataclass(frozen=True, slots=True)
class Cylinder:
    """Radius and full length [m], axis along z, centred on the origin."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """Radius [m], centred on the origin."""

    radius: float


@dataclass(frozen=True, slots=True)
class Capsule:
    """A cylinder with a half ball on each end: radius and the cylinder's own length [m], axis along z, centred."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class MeshFile:
    """A mesh named by the file, unresolved and untrusted; scale per axis."""

    filename: str
    scale: Triple = (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class OtherShape:
    """A shape that this version of URDF does not define: known to be there, not known in size."""

    tag: str


Shape: TypeAlias = Box | Cylinder | Capsule | Sphere | MeshFile | OtherShape


@dataclass(frozen=True, slots=True)
class Solid:
    """One visual or collision element of a link; colour is (r, g, b, a) in 0…1, None where the file names none."""

    shape: Shape
    origin: Origin
    colour: Colour | None
    line: int


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass [kg], centre of mass and inertia (ixx, ixy, ixz, iyy, iyz, izz) [kg m²] about it, in the origin's axes."""

    mass: float
    origin: Origin
    inertia: tuple[float, float, float, float, float, float]
    line: int


@dataclass(frozen=True, slots=True)
class UrdfLink:
    """One rigid body."""

    name: str
    visuals: tuple[Solid, ...]
    collisions: tuple[Solid, ...]
    inertial: Inertial | None
    line: int


@dataclass(frozen=True, slots=True)
class Limit:
    """Range [rad or m], None where the file gives none, and the greatest magnitudes that the joint may reach.

    Attributes:
        lower: As in the file.
        upper: As in the file; below `lower` in a file that has the two swapped.
        velocity: [rad/s or m/s], None where nothing bounds it.
        effort: [N m or N], None where nothing bounds it.
        line: Where it stands.
        acceleration: [rad/s² or m/s²], None where nothing bounds it or the format is older than 1.2, as the next two.
        deceleration: The same while braking.
        jerk: [rad/s³ or m/s³].
    """

    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    line: int
    acceleration: float | None = None
    deceleration: float | None = None
    jerk: float | None = None

    @property
    def swapped(self) -> bool:
        """Whether no value lies in the range, because its lower end is above its upper one."""
        return self.lower is not None and self.upper is not None and self.lower > self.upper


@dataclass(frozen=True, slots=True)
class Mimic:
    """This joint's value is multiplier times the leader's value plus offset."""

    joint: str
    multiplier: float
    offset: float
    line: int


@dataclass(frozen=True, slots=True)
class UrdfJoint:
    """One joint; `axis` is of unit length, in the joint frame."""

    name: str
    kind: JointKind
    parent: str
    child: str
    origin: Origin
    axis: Triple
    limit: Limit | None
    mimic: Mimic | None
    line: int
