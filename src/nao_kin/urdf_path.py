"""The way through a robot from one frame to another: which joints it meets, from which side, and what moves them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import pinocchio as pin

from nao_kin.chain import ChainJoint
from nao_kin.errors import InvalidInputError
from nao_kin.kernels.path import PathJoint
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["Coupling", "Step", "chain_joints", "joint_range", "walk"]


@dataclass(frozen=True, slots=True)
class Coupling:
    """A joint without a motor of its own: value = multiplier · leader + offset [rad or m]."""

    follower: str
    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False, slots=True)
class Step:
    """One moving joint on the way, as it is met.

    Attributes:
        joint: The joint in the file.
        placement: Fixed transform from the previous step's joint frame (the base, for the first) to this one's.
        axis: Unit axis in that frame (3,), reversed where the joint is met from its child's side.
        behind: Fixed transform from the joint's frame to the link behind it.
        column: The column of q that moves it: value = multiplier · q[column] + offset.
        multiplier: See there.
        offset: See there [rad or m].
        follows: Whether the column belongs to another joint, its leader.
    """

    joint: UrdfJoint
    placement: pin.SE3
    axis: Floats
    behind: pin.SE3
    column: int
    multiplier: float
    offset: float
    follows: bool

    @property
    def flat(self) -> PathJoint:
        """The same for the flat form of a chain."""
        return PathJoint(
            placement=self.placement.homogeneous,
            axis=self.axis,
            prismatic=self.joint.kind == "prismatic",
            column=self.column,
            multiplier=self.multiplier,
            offset=self.offset,
        )


def walk(robot: Robot, base: str, tip: str) -> tuple[tuple[Step, ...], pin.SE3]:
    """The moving joints from base to tip, and the fixed transform from the last one's frame to the tip.

    Going up, a joint is met from its child's side: it turns the other way, and its own fixed transform comes after it.
    """
    up, down = robot.path(base, tip)
    met = [(joint, True) for joint in up] + [(joint, False) for joint in down]
    moving = {joint.name for joint, _ in met if joint.kind != "fixed"}
    # A follower whose leader is off the path stands for itself.
    couplings = {c.follower: c for c in robot.couplings if c.follower in moving and c.leader in moving}
    own = [joint.name for joint, _ in met if joint.kind != "fixed" and joint.name not in couplings]
    steps: list[Step] = []
    T_joint_here = pin.SE3.Identity()
    for joint, upward in met:
        T_parent_joint = from_xyz_rpy(joint.origin.xyz, joint.origin.rpy)
        before, behind = T_parent_joint, pin.SE3.Identity()
        if upward:
            before, behind = pin.SE3.Identity(), T_parent_joint.inverse()
        if joint.kind == "fixed":
            T_joint_here = T_joint_here * before * behind
            continue
        c = couplings.get(joint.name, Coupling(joint.name, joint.name, 1.0, 0.0))
        axis = np.array(joint.axis, dtype=np.float64) * (-1.0 if upward else 1.0)
        placement, column, follows = T_joint_here * before, own.index(c.leader), c.leader != joint.name
        steps.append(Step(joint, placement, axis, behind, column, c.multiplier, c.offset, follows))
        T_joint_here = behind
    return tuple(steps), T_joint_here


def chain_joints(steps: Sequence[Step]) -> tuple[ChainJoint, ...]:
    """The columns of a chain: a leader's range and speed are cut down to what its followers on the path allow.

    Raises:
        InvalidInputError: The followers leave a leader no value at all.
    """
    joints: dict[int, ChainJoint] = {}
    for step in sorted(steps, key=lambda step: step.follows):
        lower, upper, speed = *joint_range(step.joint), joint_speed(step.joint)
        leader = joints.get(step.column)
        if leader is None:
            joints[step.column] = ChainJoint(step.joint.name, _moving(step.joint), lower, upper, speed)
        elif step.multiplier:
            ends = sorted((end - step.offset) / step.multiplier for end in (lower, upper))
            lower, upper = max(leader.lower, ends[0]), min(leader.upper, ends[1])
            if lower > upper:
                expected = f"a value of {leader.name} that its follower {step.joint.name} allows"
                raise InvalidInputError("coupled joints", expected, "ranges that exclude each other")
            speed = min(leader.max_velocity, speed / abs(step.multiplier))
            joints[step.column] = ChainJoint(leader.name, leader.kind, lower, upper, speed)
    return tuple(joints[column] for column in sorted(joints))


def _moving(joint: UrdfJoint) -> Literal["revolute", "continuous", "prismatic"]:
    if joint.kind == "fixed":
        raise ValueError(joint.name)  # paths hold moving joints only
    return joint.kind


def joint_range(joint: UrdfJoint) -> tuple[float, float]:
    """Least and greatest value [rad or m]; infinite for a continuous joint."""
    if joint.kind == "continuous" or joint.limit is None or joint.limit.lower is None or joint.limit.upper is None:
        return -math.inf, math.inf
    return joint.limit.lower, joint.limit.upper


def joint_speed(joint: UrdfJoint) -> float:
    """Greatest speed [rad/s or m/s]; infinite where the file names none."""
    velocity = joint.limit.velocity if joint.limit else None
    return math.inf if velocity is None else velocity
