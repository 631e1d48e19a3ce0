"""One file read by us and by Pinocchio's own reader: where the two part."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin

from nao_kin.checks.checker import check_bytes
from nao_kin.errors import UrdfError
from nao_kin.robot.robot import Robot
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf import parse_urdf
from nao_kin.urdf.elements import Capsule, Cylinder

__all__ = ["departure"]

AGREEMENT = 1e-12
_LENIENT = "incomplete-limit"
"""The error for which only urdfdom refuses a file: a limit before 1.2 that does not say how fast or how strong."""


def departure(data: bytes, seed: int = 0) -> str:
    """What differs: whether the file is taken, poses, inertias, limits, shapes; "" where nothing does."""
    theirs, ours = _pinocchio(data), _ours(data)
    errors = {finding.code for finding in check_bytes(data).errors}
    if theirs is None:
        if not errors:
            return "Pinocchio refuses it, and the check reports no error"
        return "" if ours is None or _LENIENT in errors else f"Pinocchio refuses it, and it loads with {sorted(errors)}"
    if ours is None:
        return f"Pinocchio loads it, and it is refused with {sorted(errors)}"
    return _models(theirs, ours.model, seed) or _shapes(theirs, data, ours)


def _pinocchio(data: bytes) -> pin.Model | None:
    try:
        return pin.buildModelFromXML(data.decode())
    except ValueError:
        return None


def _ours(data: bytes) -> Robot | None:
    try:
        return Robot.from_document(parse_urdf(data))
    except UrdfError:
        return None


def _models(theirs: pin.Model, ours: pin.Model, seed: int) -> str:
    if list(theirs.names) != list(ours.names) or len(theirs.frames) != len(ours.frames):
        return "other joints or frames"
    for name in ("lowerPositionLimit", "upperPositionLimit", "velocityLimit", "upperEffortLimit"):
        if not np.array_equal(getattr(theirs, name), getattr(ours, name)):
            return f"{name} is {getattr(ours, name)}, Pinocchio's {getattr(theirs, name)}"
    for number, (a, b) in enumerate(zip(theirs.inertias, ours.inertias, strict=True)):
        if not np.allclose(a.matrix(), b.matrix(), rtol=0.0, atol=AGREEMENT):
            return f"the inertia behind {theirs.names[number]}"
    rng = np.random.default_rng(seed)
    scratch = theirs.createData(), ours.createData()
    for _ in range(4):
        q = pin.integrate(theirs, pin.neutral(theirs), rng.uniform(-3.0, 3.0, theirs.nv))
        for model, data in zip((theirs, ours), scratch, strict=True):
            pin.framesForwardKinematics(model, data, q)
        for frame, a, b in zip(theirs.frames, scratch[0].oMf, scratch[1].oMf, strict=True):
            if not np.allclose(a.homogeneous, b.homogeneous, rtol=0.0, atol=AGREEMENT):
                return f"the pose of {frame.name}"
    return ""


def _shapes(model: pin.Model, data: bytes, robot: Robot) -> str:
    """The capsules and cylinders of the file and where they are."""
    for kind in ("visual", "collision"):
        chosen = pin.GeometryType.VISUAL if kind == "visual" else pin.GeometryType.COLLISION
        theirs = {
            shape.name: shape for shape in pin.buildGeomFromUrdfString(model, data.decode(), chosen).geometryObjects
        }
        for link in robot.document.links:
            solids = link.visuals if kind == "visual" else link.collisions
            for number, solid in enumerate(solids):
                other = theirs.get(f"{link.name}_{number}")
                if not isinstance(solid.shape, (Capsule, Cylinder)):
                    if other is not None:
                        return f"a {kind} of {link.name} that we do not know"
                    continue
                if other is None:
                    return f"a {kind} of {link.name} that Pinocchio does not know"
                frame = model.frames[model.getFrameId(link.name, pin.FrameType.BODY)]
                placement = frame.placement * from_xyz_rpy(solid.origin.xyz, solid.origin.rpy)
                if not np.allclose(placement.homogeneous, other.placement.homogeneous, rtol=0.0, atol=AGREEMENT):
                    return f"the place of a {kind} of {link.name}"
                if not _same_size(solid.shape, other.geometry):
                    return f"the size of a {kind} of {link.name}"
    return ""


def _same_size(shape: Capsule | Cylinder, other: Any) -> bool:
    same_kind = type(shape).__name__ == type(other).__name__
    return same_kind and math.isclose(shape.radius, other.radius) and math.isclose(shape.length, 2.0 * other.halfLength)
