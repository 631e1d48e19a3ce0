"""The way through a robot from one frame to another: which joints it meets, from which side, and what moves them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.kernels.joint_path import PathJoint
from nao_kin.robot.couplings import couplings_on
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.couplings import Coupling
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["PathStep", "walk"]


@dataclass(frozen=True, eq=False, slots=True)
class PathStep:
    """One moving joint on the way, as it is met.

    Attributes:
        joint: The joint in the file.
        placement: Fixed transform from the previous step's joint frame (the base, for the first) to this one's.
        axis: Unit axis in that frame (3,), reversed where the joint is met from its child's side.
        behind: Fixed transform from the joint's frame to the link behind it.
        coupling: How it hangs on the joint of the path that owns its motor's column, which may be itself.
        column: That column of q.
    """

    joint: UrdfJoint
    placement: pin.SE3
    axis: Floats
    behind: pin.SE3
    coupling: Coupling
    column: int

    @property
    def flat(self) -> PathJoint:
        """The same for the flat form of a chain."""
        return PathJoint(
            placement=self.placement.homogeneous,
            axis=self.axis,
            prismatic=self.joint.kind == "prismatic",
            column=self.column,
            multiplier=self.coupling.multiplier,
            offset=self.coupling.offset,
        )


def walk(robot: Robot, base: str, tip: str) -> tuple[tuple[PathStep, ...], pin.SE3]:
    """The moving joints from base to tip, and the fixed transform from the last one's frame to the tip.

    Going up, a joint is met from its child's side: it turns the other way, and its own fixed transform comes after it.
    """
    up, down = robot.path(base, tip)
    met = [(joint, True) for joint in up] + [(joint, False) for joint in down]
    couplings = couplings_on([joint.name for joint, _ in met if joint.kind != "fixed"], robot.couplings)
    # In the order of the path; an owner may come after the first joint that goes with it.
    own = [name for name, c in couplings.items() if c.leader == name]
    steps: list[PathStep] = []
    T_joint_here = pin.SE3.Identity()
    for joint, upward in met:
        T_parent_joint = from_xyz_rpy(joint.origin.xyz, joint.origin.rpy)
        before, behind = T_parent_joint, pin.SE3.Identity()
        if upward:
            before, behind = pin.SE3.Identity(), T_parent_joint.inverse()
        if joint.kind == "fixed":
            T_joint_here = T_joint_here * before * behind
            continue
        c = couplings[joint.name]
        axis = np.array(joint.axis, dtype=np.float64) * (-1.0 if upward else 1.0)
        steps.append(PathStep(joint, T_joint_here * before, axis, behind, c, own.index(c.leader)))
        T_joint_here = behind
    return tuple(steps), T_joint_here
