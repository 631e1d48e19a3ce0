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

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["Coupling", "PinocchioLayout", "UrdfChain", "joint_range"]


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


@dataclass(frozen=True)
class PinocchioLayout:
    """Where in Pinocchio's vectors the named joints are.

    Attributes:
        neutral: Pinocchio's own neutral configuration.
        plain: Joints with one number: their places in our order, and in Pinocchio's vector.
        turning: The same for continuous joints, which take a cosine and a sine.
        columns: The joints' columns in Pinocchio's Jacobians.
    """

    neutral: Floats
    plain: tuple[list[int], list[int]]
    turning: tuple[list[int], list[int]]
    columns: list[int]

    @classmethod
    def of(cls, model: pin.Model, names: Sequence[str]) -> PinocchioLayout:
        """The layout of the named joints in a model."""
        joints = [model.joints[model.getJointId(name)] for name in names]
        plain = [k for k, joint in enumerate(joints) if joint.nq == 1]
        turning = [k for k, joint in enumerate(joints) if joint.nq == 2]
        return cls(
            neutral=pin.neutral(model),
            plain=(plain, [joints[k].idx_q for k in plain]),
            turning=(turning, [joints[k].idx_q for k in turning]),
            columns=[joint.idx_v for joint in joints],
        )

    def q(self, values: Floats) -> Floats:
        """Pinocchio's configuration vector: continuous joints become a cosine and a sine."""
        q: Floats = self.neutral.copy()
        source, target = self.plain
        q[target] = values[source]
        for k, i in zip(*self.turning, strict=True):
            q[i], q[i + 1] = math.cos(values[k]), math.sin(values[k])
        return q


class UrdfChain:
    """A path through a robot; Pinocchio computes on a reduced model that holds the path's joints only.

    The path may run up the tree and down again. A coupled joint adds to its leader's column; when its leader is not
    on the path it stands for itself.

    Attributes:
        robot: The robot it belongs to.
        base: Frame in which poses are given.
        tip: Frame whose pose is given.
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
        self._column_of = [p.column for p in self._path]
        self._scale = np.array([p.multiplier for p in self._path])
        self._shift = np.array([p.offset for p in self._path])
        self._spread = np.zeros((len(self._path), len(self._joints)))
        self._spread[range(len(self._path)), self._column_of] = self._scale
        self._reduce()

    def _reduce(self) -> None:
        """Lock every joint off the path at zero: none of them changes T_base_tip."""
        model = self.robot.model
        path = {p.joint.name for p in self._path}
        locked = [i for i in range(1, model.njoints) if model.names[i] not in path]
        self._model = pin.buildReducedModel(model, locked, pin.neutral(model))
        self._layout = PinocchioLayout.of(self._model, [p.joint.name for p in self._path])
        self._tip_id, self._base_id = (self._model.getFrameId(f, pin.FrameType.BODY) for f in (self.tip, self.base))
        self._links_behind = [self._model.getFrameId(p.link_behind, pin.FrameType.BODY) for p in self._path]
        self._workspace = _Workspace(self._model)

    @property
    def name(self) -> str:
        """Robot and chain, for messages."""
        return f"{self.robot.name} {self.label or f'{self.base} → {self.tip}'}"

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
        pin.framesForwardKinematics(self._model, data, self._pinocchio_q(configuration(self, q)))
        T_base_tip: pin.SE3 = data.oMf[self._base_id].actInv(data.oMf[self._tip_id])
        return T_base_tip

    def jacobian(self, q: ArrayLike, frame: JacobianFrame = "base") -> Floats:
        """Frame Jacobian (6, n) at the tip point, rows (linear; angular), in base axes or (``frame="tip"``) body axes.

        Raises:
            InvalidInputError: Wrong length, not finite, or another frame than these two.
        """
        if frame not in ("base", "tip"):
            raise InvalidInputError("frame", "'base' or 'tip'", repr(frame))
        data, model = self._workspace.data, self._model
        pin.computeJointJacobians(model, data, self._pinocchio_q(configuration(self, q)))
        pin.updateFramePlacements(model, data)
        T_root_base, T_root_tip = data.oMf[self._base_id], data.oMf[self._tip_id]
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.getFrameJacobian(model, data, self._tip_id, world)
        J_base = pin.getFrameJacobian(model, data, self._base_id, world)
        # The tip's velocity as seen from the base: what the base would give a point of its own at the tip is not ours.
        lever = T_root_tip.translation - T_root_base.translation
        J[:3] -= J_base[:3] - pin.skew(lever) @ J_base[3:]
        J[3:] -= J_base[3:]
        R = (T_root_base if frame == "base" else T_root_tip).rotation.T
        J = J[:, self._layout.columns] @ self._spread
        return np.concatenate([R @ J[:3], R @ J[3:]])

    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses (m, 4, 4) in the base frame of the link behind each physical joint of the path, base to tip."""
        data = self._workspace.data
        pin.framesForwardKinematics(self._model, data, self._pinocchio_q(configuration(self, q)))
        T_root_base = data.oMf[self._base_id]
        return np.array([T_root_base.actInv(data.oMf[i]).homogeneous for i in self._links_behind])

    def poses(self, Q: ArrayLike) -> Floats:
        """T_base_tip (N, 4, 4) for configurations (N, n)."""
        return poses_by_loop(self, Q)

    def jacobians(self, Q: ArrayLike) -> Floats:
        """Frame Jacobians (N, 6, n), base axes, for configurations (N, n)."""
        return jacobians_by_loop(self, Q)

    def _pinocchio_q(self, q: Floats) -> Floats:
        return self._layout.q(self._scale * q[self._column_of] + self._shift)

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
