"""All motors of a robot as one vector: what a whole robot is commanded and guarded with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import Floats, frozen, vector
from nao_kin.chain import ChainJoint, JointColumns, LimitRule
from nao_kin.errors import UnknownNameError
from nao_kin.robot.couplings import couplings_on, spread_and_shift
from nao_kin.robot.pinocchio_layout import PinocchioLayout

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from nao_kin.robot.robot import Robot

__all__ = ["Motors"]


@dataclass(frozen=True, eq=False)
class Motors(JointColumns):
    """The n motors of a robot, in file order: every moving joint that follows no other one.

    Make one with `of`. `q` is a vector of n numbers [rad, or m for prismatic joints].

    Attributes:
        robot: Whose motors they are.
        joints: Names, ranges cut down to what all followers allow, and speeds that no follower exceeds.
        spread: (m, n): the values of all m moving joints are spread · q + shift.
        shift: (m,) [rad or m].
    """

    robot: Robot
    joints: tuple[ChainJoint, ...]
    spread: Floats
    shift: Floats

    @classmethod
    def of(cls, robot: Robot) -> Motors:
        """The motors of a robot.

        Raises:
            InvalidInputError: A follower leaves its leader no value at all.
        """
        names, driven = robot.joint_names, robot.driven_joints
        couplings = couplings_on(names, robot.couplings)
        own = [name for name in names if couplings[name].leader == name]
        spread, shift = spread_and_shift(tuple(couplings.values()), own)
        return cls(robot, tuple(driven[name] for name in own), frozen(spread), frozen(shift))

    @property
    def name(self) -> str:
        """What to call them in messages."""
        return f"{self.robot.name}, all motors"

    @cached_property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """Coupled limits both of whose joints are motors."""
        names = self.joint_names
        return tuple(rule for rule in self.robot.limit_rules if rule.joint in names and rule.by in names)

    def q_of(self, posture: Mapping[str, float]) -> Floats:
        """The motors' values (n,) of a posture; joints that it does not name are at 0.

        Raises:
            UnknownNameError, InvalidInputError: See `nao_kin.Robot.expand`.
        """
        values = self.robot.expand(posture)
        return np.array([values[name] for name in self.joint_names])

    def posture(self, q: ArrayLike) -> dict[str, float]:
        """All moving joints by name, followers included.

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        values = self.spread @ vector(q, f"q of {self.name}", len(self.joints)) + self.shift
        return dict(zip(self.robot.joint_names, values.tolist(), strict=True))

    def index(self, joint: str) -> int:
        """The column of a motor.

        Raises:
            UnknownNameError: There is no such motor.
        """
        if joint not in self.joint_names:
            raise UnknownNameError("motor", joint, self.joint_names, self.robot.name)
        return self.joint_names.index(joint)

    @cached_property
    def _layout(self) -> PinocchioLayout:
        return PinocchioLayout.of(self.robot.model, self.robot.joint_names)

    def pinocchio_q(self, q: Floats) -> Floats:
        """Pinocchio's configuration vector of `robot.model` at motor values that are not checked."""
        values: Floats = self.spread @ q + self.shift
        return self._layout.q(values)

    @cached_property
    def pinocchio_columns(self) -> list[int]:
        """Where in Pinocchio's velocity vector the m moving joints are, in file order."""
        model = self.robot.model
        return [model.joints[model.getJointId(name)].idx_v for name in self.robot.joint_names]
