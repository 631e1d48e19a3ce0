"""The way through a robot from one frame to another: which joints it meets, from which side, and what moves them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import pinocchio as pin

from nao_kin.chain import ChainJoint
from nao_kin.errors import InvalidInputError
from nao_kin.kernels.joint_path import PathJoint
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = [
    "Coupling",
    "Step",
    "chain_joints",
    "couplings_on",
    "joint_kind",
    "joint_range",
    "joint_speed",
    "motor_ranges",
    "walk",
]


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
    couplings = couplings_on([joint.name for joint, _ in met if joint.kind != "fixed"], robot.couplings)
    # In the order of the path; an owner may come after the first joint that goes with it.
    own = [name for name, c in couplings.items() if c.leader == name]
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
        c = couplings[joint.name]
        axis = np.array(joint.axis, dtype=np.float64) * (-1.0 if upward else 1.0)
        placement, column, follows = T_joint_here * before, own.index(c.leader), c.leader != joint.name
        steps.append(Step(joint, placement, axis, behind, column, c.multiplier, c.offset, follows))
        T_joint_here = behind
    return tuple(steps), T_joint_here


def couplings_on(names: Sequence[str], couplings: Sequence[Coupling]) -> dict[str, Coupling]:
    """How each of the named joints hangs on the one among them that owns its motor's column.

    That is the leader where it is among them; else the first of its followers stands for the motor, and the others go
    with it.
    """
    by_follower = {c.follower: c for c in couplings}
    to_motor = {name: by_follower.get(name, Coupling(name, name, 1.0, 0.0)) for name in names}
    owners: dict[str, Coupling] = {}
    for c in to_motor.values():
        if c.leader in to_motor:
            owners[c.leader] = to_motor[c.leader]
        else:
            owners.setdefault(c.leader, c)
    found = {}
    for name, c in to_motor.items():
        owner = owners[c.leader]
        ratio = c.multiplier / owner.multiplier
        found[name] = Coupling(name, owner.follower, ratio, c.offset - ratio * owner.offset)
    return found


def motor_ranges(robot: Robot) -> dict[str, tuple[float, float]]:
    """The range of every joint that is no follower, cut down to what all its followers allow.

    Raises:
        InvalidInputError: A follower leaves its leader no value at all.
    """
    ranges = {joint.name: joint_range(joint) for joint in robot.moving_joints}
    for c in robot.couplings:
        ranges[c.leader] = _narrowed(ranges[c.leader], c, ranges.pop(c.follower))
    return ranges


def chain_joints(robot: Robot, steps: Sequence[Step]) -> tuple[ChainJoint, ...]:
    """The columns of a chain: a range is cut down to what all joints of the same motor allow, on the path or off it.

    Raises:
        InvalidInputError: A follower leaves its leader no value at all.
    """
    ranges, to_motor = motor_ranges(robot), {c.follower: c for c in robot.couplings}
    joints: dict[int, ChainJoint] = {}
    for step in sorted(steps, key=lambda step: step.follows):  # owners first
        name, speed, owner = step.joint.name, joint_speed(step.joint), joints.get(step.column)
        if owner is not None:
            speed = min(owner.max_velocity, speed / abs(step.multiplier))
            joints[step.column] = replace(owner, max_velocity=speed)
            continue
        c = to_motor.get(name, Coupling(name, name, 1.0, 0.0))
        lower, upper = sorted(c.multiplier * end + c.offset for end in ranges[c.leader])
        joints[step.column] = ChainJoint(name, joint_kind(step.joint), lower, upper, speed)
    return tuple(joints[column] for column in sorted(joints))


def _narrowed(leader: tuple[float, float], coupling: Coupling, follower: tuple[float, float]) -> tuple[float, float]:
    """The part of a leader's range in which its follower stays in its own.

    Raises:
        InvalidInputError: There is none.
    """
    ends = sorted((end - coupling.offset) / coupling.multiplier for end in follower)
    lower, upper = max(leader[0], ends[0]), min(leader[1], ends[1])
    if lower > upper:
        expected = f"a value of {coupling.leader} that its follower {coupling.follower} allows"
        raise InvalidInputError("coupled joints", expected, f"ranges {leader} and {follower}, which exclude each other")
    return lower, upper


def joint_kind(joint: UrdfJoint) -> Literal["revolute", "continuous", "prismatic"]:
    """How a moving joint moves."""
    if joint.kind == "fixed":
        raise ValueError(joint.name)  # paths hold moving joints only
    return joint.kind


def joint_range(joint: UrdfJoint) -> tuple[float, float]:
    """Least and greatest value [rad or m]; infinite for a continuous joint."""
    if joint.kind == "continuous" or joint.limit is None or joint.limit.lower is None or joint.limit.upper is None:
        return -math.inf, math.inf
    if joint.limit.swapped:  # no value lies in it; a chain with such a joint is refused
        return -math.inf, math.inf
    return joint.limit.lower, joint.limit.upper


def joint_speed(joint: UrdfJoint) -> float:
    """Greatest speed [rad/s or m/s]; infinite where the file names none."""
    velocity = joint.limit.velocity if joint.limit else None
    return math.inf if velocity is None else velocity
