"""Rules about what gravity does to the robot: does it stand, and can its motors hold it."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.checks.rules.pose_rules import sample_postures
from nao_kin.robot.pinocchio_layout import PinocchioLayout
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, Capsule, Cylinder, Sphere
from nao_kin.urdf.outline import Defect, describe, first, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.checks.subject import Subject
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import UrdfLink

__all__ = ["balance_at_zero", "efforts_against_gravity"]

_POSTURES = 200
_MARGIN = 0.01  # of the effort: printed figures are rounded
_FOOT = re.compile(r"(?:^|[_\W]|(?<=[a-z]))(?:[Ff]oot|[Ss]ole|FOOT|SOLE|Foot|Sole)(?=$|[_\W\d]|[A-Z]|_?link)")
_LEVEL = 0.02  # [m] feet that the robot stands on are about level
_SIZE = 0.05  # [m] half the edge of a foot whose shape is a mesh, and what the centre of mass may be outside


def efforts_against_gravity(subject: Subject) -> Iterator[Defect]:
    """In no posture within its limits does holding the robot still ask more of a joint than its effort."""
    robot = subject.robot
    joints = {j.name: j for j in robot.moving_joints if j.limit and j.limit.effort and j.mimic is None}
    model = robot.model  # its gravity is 9.81 m/s² along −z of the root
    layout, data = PinocchioLayout.of(model, robot.joint_names), model.createData()
    worst: dict[str, tuple[float, Mapping[str, float]]] = {name: (0.0, {}) for name in joints}
    for posture in sample_postures(robot, _POSTURES):
        values = robot.expand(posture)
        q = layout.q(np.array([values[name] for name in robot.joint_names]))
        torques = pin.computeGeneralizedGravity(model, data, q)
        for name in joints:
            torque = abs(float(torques[model.joints[model.getJointId(name)].idx_v]))
            if torque > worst[name][0]:
                worst[name] = torque, values
    for name, (torque, held) in worst.items():
        limit = joints[name].limit
        effort = 0.0 if limit is None or limit.effort is None else limit.effort
        if torque > (1.0 + _MARGIN) * effort:
            element, unit = subject.joint(name), "N" if joints[name].kind == "prismatic" else "N m"
            at = first(element, "limit")
            message = f"The effort {effort:g} {unit} of the {describe(element)} does not hold the robot: gravity takes "
            message += f"{torque:.4g} {unit} with {_shown(robot, held)}."
            hint = "With the root fixed and z up. Is the effort the motor's before the gear, or a mass wrong?"
            yield Defect("weak-effort", element if at is None else at, message, hint, "effort")


def _shown(robot: Robot, values: Mapping[str, float]) -> str:
    """A posture for a message: the joints away from 0, the first dozen."""
    moved = [f"{name} {values[name]:.3g}" for name in robot.joint_names if abs(values[name]) > 5e-4]
    return ", ".join(moved[:12]) + (f" and {len(moved) - 12} more" if len(moved) > 12 else "") or "every joint at 0"


def balance_at_zero(subject: Subject) -> Iterator[Defect]:
    """With every joint at 0 the centre of mass of a robot that stands on feet is above them."""
    robot = subject.robot
    feet = [link for link in robot.document.links if _FOOT.search(link.name)]
    if len(feet) < 2 or not any(link.inertial and link.inertial.mass > 0.0 for link in robot.document.links):
        return
    poses = robot.link_poses({})
    points = [_ground_points(link, poses[link.name]) for link in feet]
    ground = min(float(each[:, 2].min()) for each in points)
    standing = [each for each in points if each[:, 2].min() < ground + _LEVEL]
    if len(standing) < 2:
        return
    centre = _centre_of_mass(robot, poses)
    outside = _distance_outside(np.vstack(standing)[:, :2], centre[:2])
    if outside > _SIZE:
        message = f"With every joint at 0 the centre of mass is at x {centre[0]:.3g}, y {centre[1]:.3g} m, "
        message += f"{outside * 1e3:.0f} mm outside the feet {', '.join(shown(link.name) for link in feet[:4])}."
        hint = "Does the robot stand at 0? Is a mass or its place wrong?"
        yield Defect("falls-at-zero", subject.outline.root, message, hint, "name")


def _ground_points(link: UrdfLink, pose: pin.SE3) -> Floats:
    """Corners (N, 3) of a foot's shapes in the root frame; those of a small square where they are meshes."""
    corners = []
    for solid in link.collisions or link.visuals:
        half = _half_size(solid.shape)
        if half is not None:
            T_root_solid = pose * from_xyz_rpy(solid.origin.xyz, solid.origin.rpy)
            signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
            corners.append(signs * half @ T_root_solid.rotation.T + T_root_solid.translation)
    if corners:
        return np.vstack(corners)
    square = np.array([(x, y, 0.0) for x in (-_SIZE, _SIZE) for y in (-_SIZE, _SIZE)])
    points: Floats = square + pose.translation
    return points


def _half_size(shape: object) -> Floats | None:
    match shape:
        case Box(size):
            return np.array(size) / 2.0
        case Cylinder(radius, length):
            return np.array([radius, radius, length / 2.0])
        case Capsule(radius, length):
            return np.array([radius, radius, length / 2.0 + radius])
        case Sphere(radius):
            return np.full(3, radius)
    return None


def _centre_of_mass(robot: Robot, poses: Mapping[str, pin.SE3]) -> Floats:
    total, moment = 0.0, np.zeros(3)
    for link in robot.document.links:
        if link.inertial is not None:
            total += link.inertial.mass
            moment += link.inertial.mass * poses[link.name].act(np.array(link.inertial.origin.xyz))
    centre: Floats = moment / total
    return centre


def _distance_outside(points: Floats, point: Floats) -> float:
    """How far [m] a point is outside the convex hull of others in the plane; 0 inside.

    A point is outside if it lies beyond the hull's extent in some direction, and as far as in the direction in which
    it does most; directions are tried every half degree, which shortens a distance by less than 1e-5 of it.
    """
    angles = np.arange(720) * math.pi / 360.0
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    beyond = directions @ point - (points @ directions.T).max(axis=0)
    return max(float(beyond.max()), 0.0)
