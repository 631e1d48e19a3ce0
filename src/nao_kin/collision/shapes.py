"""The collision shapes of a robot as coal takes them, and solid planes beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import coal
import numpy as np
import pinocchio as pin

from nao_kin.arrays import frozen, vector
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, Capsule, Cylinder, Sphere

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import Shape

__all__ = ["CollisionBody", "Plane", "coal_shape", "link_bodies", "plane_body"]


@dataclass(frozen=True, eq=False, slots=True)
class Plane:
    """Solid ground or a table: every point p of the root frame with normal · p ≤ offset.

    Attributes:
        name: What to call it; no link may have the same name.
        normal: Unit normal pointing out of the solid (3,), in the root frame.
        offset: Distance of the surface from the root frame's origin along the normal [m].
    """

    name: str
    normal: Floats
    offset: float

    def __init__(self, name: str, normal: ArrayLike = (0.0, 0.0, 1.0), offset: float = 0.0) -> None:
        """Checks, and brings the normal to unit length.

        Raises:
            InvalidInputError: A normal of length 0, or something that is not finite.
        """
        direction = vector(normal, f"normal of {name}", 3)
        size = float(np.abs(direction).max())
        if size == 0.0:
            raise InvalidInputError(f"normal of {name}", "a vector that points somewhere", "length 0")
        direction = direction / size  # whose square neither runs over nor vanishes
        length = float(np.linalg.norm(direction))
        height = float(vector([offset], f"offset of {name} [m]", 1)[0])
        for field, value in (("name", name), ("normal", frozen(direction / length)), ("offset", height)):
            object.__setattr__(self, field, value)


@dataclass(frozen=True, eq=False, slots=True)
class CollisionBody:
    """One rigid shape.

    Attributes:
        owner: Name of its link, or of the plane.
        joint: Number of the Pinocchio joint that it hangs on; 0 where nothing moves it.
        T_joint_shape: Its pose in that joint's frame.
        shape: The `coal.CollisionGeometry`.
        reach: A distance from the joint frame's origin that none of its points exceeds [m]; infinite for a plane.
    """

    owner: str
    joint: int
    T_joint_shape: pin.SE3
    shape: Any
    reach: float


def coal_shape(shape: Shape) -> Any:
    """The shape for coal; None for a mesh, for what URDF does not define, and for a size of 0."""
    match shape:
        case Box(size) if min(size) > 0.0:
            return coal.Box(np.array(size))
        case Cylinder(radius, length) if radius > 0.0 and length > 0.0:
            return coal.Cylinder(radius, length)
        case Capsule(radius, length) if radius > 0.0:
            return coal.Capsule(radius, length) if length > 0.0 else coal.Sphere(radius)
        case Sphere(radius) if radius > 0.0:
            return coal.Sphere(radius)
    return None


def link_bodies(robot: Robot) -> tuple[tuple[CollisionBody, ...], tuple[str, ...]]:
    """The collision shapes of all links, and a sentence about each that cannot be taken.

    Meshes are not: without their convex hulls they are surfaces, and one inside another would count as apart.
    """
    model, bodies, notes = robot.model, list[CollisionBody](), list[str]()
    for link in robot.document.links:
        frame = model.frames[model.getFrameId(link.name, pin.FrameType.BODY)]
        for solid in link.collisions:
            shape = coal_shape(solid.shape)
            if shape is None:
                kind = type(solid.shape).__name__
                notes.append(f"Link {link.name}, line {solid.line}: its {kind} is not watched; boxes, cylinders,")
                notes[-1] += " capsules and spheres with a size are."
                continue
            placement = frame.placement * from_xyz_rpy(solid.origin.xyz, solid.origin.rpy)
            shape.computeLocalAABB()
            reach = float(np.linalg.norm(placement.act(shape.aabb_center)) + shape.aabb_radius)
            bodies.append(CollisionBody(link.name, int(frame.parentJoint), placement, shape, reach))
    return tuple(bodies), tuple(notes)


def plane_body(plane: Plane) -> CollisionBody:
    """A plane as a body that nothing moves."""
    return CollisionBody(plane.name, 0, pin.SE3.Identity(), coal.Halfspace(plane.normal, plane.offset), np.inf)
