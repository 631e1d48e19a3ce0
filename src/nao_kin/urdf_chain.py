"""A chain through a robot, with Pinocchio doing the arithmetic.

Pinocchio's own configuration vector, its alphabetical joint order and its (cos, sin) pairs for continuous joints stay
inside this module: outside, a chain has `q`, one plain number a joint.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pinocchio as pin

from nao_kin.chain import (
    ChainJoint,
    JacobianFrame,
    LimitRule,
    configuration,
    jacobians_by_loop,
    poses_by_loop,
    stacked_limits,
)
from nao_kin.errors import InvalidInputError, NoPathError
from nao_kin.se3 import from_xyz_rpy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["Coupling", "UrdfChain", "joint_range"]


@dataclass(frozen=True, slots=True)
class Coupling:
    """A joint without a motor of its own: value = multiplier · leader + offset [rad or m]."""

    follower: str
    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class _PathJoint:
    """A moving joint on a chain's path: its column, and value = multiplier · q[column] + offset."""

    joint: UrdfJoint
    link_behind: str
    column: int
    multiplier: float
    offset: float
    follows: bool


class _Workspace(threading.local):
    """Pinocchio's scratch memory, one for each thread, so that a chain may be shared between threads."""

    def __init__(self, model: pin.Model) -> None:
        self.data = model.createData()


_REFERENCE = {"base": pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, "tip": pin.ReferenceFrame.LOCAL}


class UrdfChain:
    """A path through a robot, on a Pinocchio model of its own that is rooted at the base and holds the path only.

    The path may run up the tree and down again: a joint met from its child's side turns the other way. A coupled joint
    adds to its leader's column; when its leader is not on the path it stands for itself.

    Attributes:
        robot: The robot it belongs to.
        base: Frame in which poses are given.
        tip: Frame whose pose is given.
        label: Its name among the robot's chains; may be empty.
    """

    def __init__(self, robot: Robot, base: str, tip: str, label: str = "") -> None:
        self.robot, self.base, self.tip, self.label = robot, base, tip, label
        self._path = _path_joints(robot, base, tip)
        if not self._path:
            raise NoPathError(base, tip, robot.name)
        self._joints = _columns(self._path)
        self._lower, self._upper, self._max_velocity = stacked_limits(self._joints)
        names = set(self.joint_names)
        self._limit_rules = tuple(r for r in robot.limit_rules if r.joint in names and r.by in names)
        self._model, self._link_ids, self._tip_id = _serial_model(robot, base, tip)
        self._workspace = _Workspace(self._model)
        # Values of the physical joints: spread · q + shift. None where each joint has a column of its own.
        self._spread: Floats | None = None
        if any(p.follows for p in self._path):
            self._spread = np.zeros((len(self._path), len(self._joints)))
            for k, p in enumerate(self._path):
                self._spread[k, p.column] = p.multiplier
        self._shift = np.array([p.offset for p in self._path])

    @property
    def name(self) -> str:
        """Robot and chain, for messages."""
        return f"{self.robot.name} {self.label or f'{self.base}→{self.tip}'}"

    @property
    def base_name(self) -> str:
        """Name of the base frame."""
        return self.base

    @property
    def tip_name(self) -> str:
        """Name of the tip frame."""
        return self.tip

    @property
    def joints(self) -> tuple[ChainJoint, ...]:
        """The n joints, base to tip."""
        return self._joints

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(joint.name for joint in self._joints)

    @property
    def lower(self) -> Floats:
        """Least values (n,), read-only; −inf for a continuous joint."""
        return self._lower

    @property
    def upper(self) -> Floats:
        """Greatest values (n,), read-only; +inf for a continuous joint."""
        return self._upper

    @property
    def max_velocity(self) -> Floats:
        """Greatest speeds (n,) [rad/s or m/s], read-only."""
        return self._max_velocity

    @property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """Coupled limits both of whose joints are in the chain."""
        return self._limit_rules

    def pose(self, q: ArrayLike) -> pin.SE3:
        """T_base_tip at q (n,) [rad, m].

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        data = self._workspace.data
        pin.forwardKinematics(self._model, data, self._joint_values(configuration(self, q)))
        return pin.SE3(pin.updateFramePlacement(self._model, data, self._tip_id))

    def jacobian(self, q: ArrayLike, frame: JacobianFrame = "base") -> Floats:
        """Frame Jacobian (6, n) at the tip point, rows (linear; angular), in base axes or (``frame="tip"``) body axes.

        Raises:
            InvalidInputError: Wrong length, not finite, or another frame than these two.
        """
        if frame not in _REFERENCE:
            raise InvalidInputError("frame", "'base' or 'tip'", repr(frame))
        values = self._joint_values(configuration(self, q))
        J = pin.computeFrameJacobian(self._model, self._workspace.data, values, self._tip_id, _REFERENCE[frame])
        J = np.ascontiguousarray(J).reshape(6, -1)  # of a single joint, Pinocchio hands over a vector
        return J if self._spread is None else J @ self._spread

    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses (m, 4, 4) in the base frame of the link behind each physical joint of the path, base to tip."""
        data = self._workspace.data
        pin.framesForwardKinematics(self._model, data, self._joint_values(configuration(self, q)))
        return np.array([data.oMf[i].homogeneous for i in self._link_ids])

    def poses(self, Q: ArrayLike) -> Floats:
        """T_base_tip (N, 4, 4) for configurations (N, n)."""
        return poses_by_loop(self, Q)

    def jacobians(self, Q: ArrayLike) -> Floats:
        """Frame Jacobians (N, 6, n), base axes, for configurations (N, n)."""
        return jacobians_by_loop(self, Q)

    def _joint_values(self, q: Floats) -> Floats:
        return q if self._spread is None else self._spread @ q + self._shift

    def __reduce__(self) -> tuple[Any, ...]:
        return UrdfChain, (self.robot, self.base, self.tip, self.label)

    def __repr__(self) -> str:
        return f"<UrdfChain {self.name}: {', '.join(self.joint_names)}>"


def _path_joints(robot: Robot, base: str, tip: str) -> tuple[_PathJoint, ...]:
    up, down = robot.path(base, tip)
    steps = [(j, j.parent) for j in up if j.kind != "fixed"] + [(j, j.child) for j in down if j.kind != "fixed"]
    on_path = {joint.name for joint, _ in steps}
    couplings = {c.follower: c for c in robot.couplings if c.follower in on_path and c.leader in on_path}
    leaders = [joint.name for joint, _ in steps if joint.name not in couplings]
    found = []
    for joint, link_behind in steps:
        c = couplings.get(joint.name, Coupling(joint.name, joint.name, 1.0, 0.0))
        found.append(
            _PathJoint(joint, link_behind, leaders.index(c.leader), c.multiplier, c.offset, c.leader != joint.name)
        )
    return tuple(found)


def _serial_model(robot: Robot, base: str, tip: str) -> tuple[pin.Model, list[int], int]:
    """The path as a Pinocchio model rooted at base, the frame ids of the links behind its joints, and the tip's.

    Continuous joints become revolute ones, so every joint takes one number.
    """
    model = pin.Model()
    model.name = f"{base} to {tip}"
    up, down = robot.path(base, tip)
    parent, T_parent_here, links = 0, pin.SE3.Identity(), []
    for joint, upward in [(j, True) for j in up] + [(j, False) for j in down]:
        T_above_joint = from_xyz_rpy(joint.origin.xyz, joint.origin.rpy)
        before, behind = (
            (pin.SE3.Identity(), T_above_joint.inverse()) if upward else (T_above_joint, pin.SE3.Identity())
        )
        if joint.kind == "fixed":
            T_parent_here = T_parent_here * before * behind
            continue
        axis = -np.array(joint.axis) if upward else np.array(joint.axis)
        kind = pin.JointModelPrismaticUnaligned if joint.kind == "prismatic" else pin.JointModelRevoluteUnaligned
        parent = model.addJoint(parent, kind(axis), T_parent_here * before, joint.name)
        T_parent_here = behind
        links.append(model.addFrame(pin.Frame(f"behind {joint.name}", parent, behind, pin.FrameType.OP_FRAME)))
    tip_id = model.addFrame(pin.Frame("tip", parent, T_parent_here, pin.FrameType.OP_FRAME))
    return model, links, tip_id


def _columns(path: Sequence[_PathJoint]) -> tuple[ChainJoint, ...]:
    """The chain's joints: a leader's range and speed are cut down to what its followers on the path allow."""
    joints: dict[int, ChainJoint] = {}
    for p in sorted(path, key=lambda p: p.follows):
        ends = [(end - p.offset) / p.multiplier for end in joint_range(p.joint)]
        speed = joint_speed(p.joint) / abs(p.multiplier)
        leader = joints.get(p.column)
        if leader is None:
            joints[p.column] = ChainJoint(p.joint.name, _moving(p.joint), min(ends), max(ends), speed)
        else:
            lower, upper = max(leader.lower, min(ends)), min(leader.upper, max(ends))
            joints[p.column] = ChainJoint(leader.name, leader.kind, lower, upper, min(leader.max_velocity, speed))
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
