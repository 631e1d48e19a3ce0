"""A chain through a robot, with Pinocchio doing the arithmetic.

Pinocchio's own configuration vector, its alphabetical joint order and its (cos, sin) pairs for continuous joints stay
inside this module: outside, a chain has `q`, one plain number a joint.
"""

from __future__ import annotations

import threading
from functools import cached_property
from typing import TYPE_CHECKING, Any

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
from nao_kin.kernels.path import JointPath, joint_path
from nao_kin.urdf_path import Step, chain_joints, walk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot import Robot

__all__ = ["UrdfChain"]


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
        steps, self._T_joint_tip = walk(robot, base, tip)
        if not steps:
            raise NoPathError(base, tip, robot.name)
        self._steps, self._joints = steps, chain_joints(steps)
        self._lower, self._upper, self._max_velocity = stacked_limits(self._joints)
        names = set(self.joint_names)
        self._limit_rules = tuple(r for r in robot.limit_rules if r.joint in names and r.by in names)
        self._model, self._link_ids, self._tip_id = _serial_model(steps, self._T_joint_tip)
        self._workspace = _Workspace(self._model)
        # Values of the physical joints: spread · q + shift. None where each joint has a column of its own.
        self._spread: Floats | None = None
        if any(step.follows for step in steps):
            self._spread = np.zeros((len(steps), len(self._joints)))
            for k, step in enumerate(steps):
                self._spread[k, step.column] = step.multiplier
        self._shift = np.array([step.offset for step in steps])

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

    @cached_property
    def joint_path(self) -> JointPath:
        """The flat form that compiled code runs on."""
        flat = (step.flat for step in self._steps)
        return joint_path(flat, self._T_joint_tip.homogeneous, self._lower, self._upper)

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


def _serial_model(steps: Sequence[Step], T_joint_tip: pin.SE3) -> tuple[pin.Model, list[int], int]:
    """The path as a Pinocchio model rooted at its base, the frame ids of the links behind its joints, and the tip's.

    Continuous joints become revolute ones, so every joint takes one number.
    """
    model, parent, links = pin.Model(), 0, []
    for step in steps:
        kind = pin.JointModelPrismaticUnaligned if step.joint.kind == "prismatic" else pin.JointModelRevoluteUnaligned
        parent = model.addJoint(parent, kind(step.axis), step.placement, step.joint.name)
        frame = pin.Frame(f"behind {step.joint.name}", parent, step.behind, pin.FrameType.OP_FRAME)
        links.append(model.addFrame(frame))
    return model, links, model.addFrame(pin.Frame("tip", parent, T_joint_tip, pin.FrameType.OP_FRAME))
