"""A chain through a robot, with Pinocchio doing the arithmetic.

Its model is made for the path alone: no joint order but the path's, and one number for a continuous joint as for any
other.
"""

from __future__ import annotations

import threading
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from nao_kin.chain import (
    ChainJoint,
    FlatChain,
    JacobianFrame,
    LimitRule,
    configuration,
    limit_table,
)
from nao_kin.errors import InvalidInputError, NoPathError, UrdfError
from nao_kin.kernels.joint_path import JointPath, joint_path
from nao_kin.robot.couplings import spread_and_shift
from nao_kin.robot.path import PathStep, walk
from nao_kin.robot.tool import as_tool

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.tool import ToolLike

__all__ = ["UrdfChain"]


class _Workspace(threading.local):
    """Pinocchio's scratch memory, one for each thread, so that a chain may be shared between threads."""

    def __init__(self, model: pin.Model) -> None:
        self.data = model.createData()


_FLOAT64 = np.dtype(np.float64)
_REFERENCE = {"base": pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, "tip": pin.ReferenceFrame.LOCAL}


class UrdfChain(FlatChain):
    """A path through a robot, on a Pinocchio model of its own that is rooted at the base and holds the path only.

    The path may run up the tree and down again: a joint met from its child's side turns the other way. A coupled joint
    adds to its leader's column; when its leader is not on the path it stands for itself.
    """

    def __init__(
        self,
        robot: Robot,
        base: str,
        tip: str,
        label: str = "",
        *,
        tool: pin.SE3 | None = None,
        mount: pin.SE3 | None = None,
    ) -> None:
        self._robot, self._base, self._tip, self._label = robot, base, tip, label
        self._tool, self._mount = tool, mount
        steps, self._T_joint_tip = walk(robot, base, tip)
        if not steps:
            raise NoPathError(base, tip, robot.name)
        if mount is not None:
            steps = (replace(steps[0], placement=mount * steps[0].placement), *steps[1:])
        if tool is not None:
            self._T_joint_tip = self._T_joint_tip * tool
        _refuse_swapped_limits(robot, steps)
        own = [step.joint.name for step in steps if step.coupling.leader == step.joint.name]
        self._steps, self._joints = steps, tuple(robot.driven_joints[name] for name in own)
        self._limit_rules = tuple(rule for rule in robot.limit_rules if rule.joint in own and rule.by in own)
        self._model, self._link_ids, self._tip_id = _serial_model(steps, self._T_joint_tip)
        self._workspace = _Workspace(self._model)
        self._shape, self._zeros = (len(self._joints),), np.zeros(len(self._joints))
        # Values of the physical joints: spread · q + shift. None where each joint has a column of its own.
        spread, self._shift = spread_and_shift([step.coupling for step in steps], own)
        self._spread: Floats | None = None if len(own) == len(steps) else spread

    def with_tool(self, tool: ToolLike) -> UrdfChain:
        """The same chain with a tool on its tip: poses and Jacobians are those of the tool's frame.

        Args:
            tool: T_tip_tool: a pose, x y z [m] with or without roll pitch yaw [rad], or a DH row; see `as_tool`. A tool
                that is there already is what it sits on.

        Raises:
            InvalidInputError: It is none of these.
        """
        return self._having(self.tool * as_tool(tool), self._mount)

    def with_base(self, mount: ToolLike) -> UrdfChain:
        """The same chain with its poses given in another frame, such as the table that the robot is screwed to.

        Args:
            mount: T_mount_base, in any of the ways of `with_tool`: where the base is in the frame that is wanted.

        Raises:
            InvalidInputError: It is none of these.
        """
        T_mount_base = as_tool(mount, "base")
        return self._having(self._tool, T_mount_base if self._mount is None else T_mount_base * self._mount)

    def _having(self, tool: pin.SE3 | None, mount: pin.SE3 | None) -> UrdfChain:
        return UrdfChain(self._robot, self._base, self._tip, self._label, tool=tool, mount=mount)

    @property
    def tool(self) -> pin.SE3:
        """T_tip_tool from the tip's link to the frame whose pose is given; the identity without a tool."""
        return pin.SE3.Identity() if self._tool is None else pin.SE3(self._tool)

    @property
    def mount(self) -> pin.SE3:
        """T_mount_base, where the base's link is in the frame that poses are given in; the identity without a mount."""
        return pin.SE3.Identity() if self._mount is None else pin.SE3(self._mount)

    @property
    def is_bare(self) -> bool:
        """Whether it has neither a tool nor another base than a link."""
        return self._tool is None and self._mount is None

    @property
    def robot(self) -> Robot:
        """The robot it belongs to."""
        return self._robot

    @property
    def base(self) -> str:
        """The link that it starts at, in whose frame poses are given unless `with_base` says another."""
        return self._base

    @property
    def tip(self) -> str:
        """The link that it ends at, whose pose is given unless a tool sits on it."""
        return self._tip

    @property
    def name(self) -> str:
        """Robot and chain, for messages."""
        tool = "" if self._tool is None else " with tool"
        return f"{self._robot.name} {self._label or f'{self._base}→{self._tip}'}{tool}"

    @property
    def base_name(self) -> str:
        """Name of the base frame."""
        return self.base if self._mount is None else f"mount of {self.base}"

    @property
    def tip_name(self) -> str:
        """Name of the tip frame."""
        return self.tip if self._tool is None else f"tool on {self.tip}"

    @property
    def joints(self) -> tuple[ChainJoint, ...]:
        """The n joints, base to tip."""
        return self._joints

    @property
    def path_joint_names(self) -> tuple[str, ...]:
        """Names of the m physical joints of the path, followers included; `link_poses` has a row for each."""
        return tuple(step.joint.name for step in self._steps)

    @property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """Coupled limits both of whose joints are in the chain."""
        return self._limit_rules

    def pose(self, q: ArrayLike) -> pin.SE3:
        """T_base_tip at q (n,) [rad, m].

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        data, model = self._workspace.data, self._model
        pin.forwardKinematics(model, data, self._joint_values(q))
        return pin.SE3(pin.updateFramePlacement(model, data, self._tip_id))

    def tip_at(self, q: Floats) -> tuple[Floats, Floats]:
        """Rotation (3, 3) and position (3,) [m] of `pose`, in memory that the next call on this thread overwrites.

        For who checks q (n,) otherwise: numbers that are not finite give a pose that is none.
        """
        data, model = self._workspace.data, self._model
        pin.forwardKinematics(model, data, q if self._spread is None else self._spread @ q + self._shift)
        placement = pin.updateFramePlacement(model, data, self._tip_id)
        return placement.rotation, placement.translation

    def jacobian(self, q: ArrayLike, frame: JacobianFrame = "base") -> Floats:
        """Frame Jacobian (6, n) at q (n,) of the tip point, rows (linear; angular), in axes of base or tip frame.

        Raises:
            InvalidInputError: Wrong length, not finite, or another frame than these two.
        """
        if frame not in _REFERENCE:
            raise InvalidInputError("frame", "'base' or 'tip'", repr(frame))
        values = self._joint_values(q)
        J = pin.computeFrameJacobian(self._model, self._workspace.data, values, self._tip_id, _REFERENCE[frame])
        J = np.ascontiguousarray(J).reshape(6, -1)  # of a single joint, Pinocchio hands over a vector
        return J if self._spread is None else J @ self._spread

    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses (m, 4, 4) in the base frame of the link behind each physical joint of the path, base to tip.

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        data = self._workspace.data
        pin.framesForwardKinematics(self._model, data, self._joint_values(q))
        return np.array([data.oMf[i].homogeneous for i in self._link_ids])

    def q_of(self, posture: Mapping[str, float]) -> Floats:
        """This chain's part (n,) of a posture of the whole robot; joints that it does not name are at 0.

        Raises:
            UnknownNameError: A name is no joint of the robot.
            InvalidInputError: A value is not a finite number, or contradicts a coupling.
        """
        values = self._robot.expand(posture)
        return np.array([values[name] for name in self.joint_names], dtype=np.float64)

    @cached_property
    def joint_path(self) -> JointPath:
        """The flat form that compiled code runs on."""
        flat = (step.flat for step in self._steps)
        return joint_path(flat, self._T_joint_tip.homogeneous, self.lower, self.upper)

    def _joint_values(self, q: ArrayLike) -> Floats:
        # What numpy needs to check a vector costs more than the kinematics, so the usual case is decided by hand: the
        # product with zeros is 0 for finite numbers only.
        if type(q) is np.ndarray and q.dtype is _FLOAT64 and q.shape == self._shape and q.dot(self._zeros) == 0.0:
            values: Floats = q
        else:
            values = configuration(self, q)
        return values if self._spread is None else self._spread @ values + self._shift

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._robot, self._base, self._tip, self._label, self._tool, self._mount)

    def __repr__(self) -> str:
        return f"<UrdfChain {self.name}: {', '.join(self.joint_names)}>"

    def _repr_html_(self) -> str:
        return limit_table(self, f"{self.name}: {self.base_name} → {self.tip_name}")._repr_html_()


def _restored(robot: Robot, base: str, tip: str, label: str, tool: pin.SE3 | None, mount: pin.SE3 | None) -> UrdfChain:
    return UrdfChain(robot, base, tip, label, tool=tool, mount=mount)


def _refuse_swapped_limits(robot: Robot, steps: Sequence[PathStep]) -> None:
    """A joint without a single allowed value is nobody's concern until a chain moves it."""
    for step in steps:
        limit = step.joint.limit
        if limit is not None and limit.swapped and step.joint.kind != "continuous":
            reason = f"The lower limit {limit.lower:g} of the joint {step.joint.name!r} is above its upper limit "
            reason += f"{limit.upper:g}, so that no value is allowed on a chain with it."
            raise UrdfError(robot.document.path, limit.line, reason, "Are they swapped?", code="inverted-limit")


def _serial_model(steps: Sequence[PathStep], T_joint_tip: pin.SE3) -> tuple[pin.Model, list[int], int]:
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
