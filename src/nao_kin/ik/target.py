"""What the tip of a chain is wanted to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, vector
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import PoseLike, as_pose, position_distance, rotation_distance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["Target", "TargetKind", "TargetLike"]

TargetKind: TypeAlias = Literal["pose", "position"]
TargetLike: TypeAlias = "Target | PoseLike"


@dataclass(frozen=True, eq=False, slots=True)
class Target:
    """A wanted placement of the tip in the chain's base frame.

    Attributes:
        kind: ``"pose"`` (position and orientation) or ``"position"`` (any orientation will do).
        T_base_target: The placement; of a position, only the translation counts.
    """

    kind: TargetKind
    T_base_target: pin.SE3

    @classmethod
    def pose(cls, T_base_target: PoseLike) -> Target:
        """A full pose from a `pin.SE3` or a (4, 4) matrix.

        Raises:
            InvalidInputError: Not a rigid pose; the message gives the size of the violation.
        """
        return cls("pose", as_pose(T_base_target, "target"))

    @classmethod
    def position(cls, p_base: ArrayLike) -> Target:
        """A position (3,) [m].

        Raises:
            InvalidInputError: Not three finite numbers.
        """
        return cls("position", pin.SE3(np.eye(3), vector(p_base, "target position", 3)))

    @classmethod
    def of(cls, value: TargetLike) -> Target:
        """A target from itself, a `pin.SE3`, a (4, 4) matrix or a position (3,).

        Raises:
            InvalidInputError: None of these, not finite, or not rigid.
        """
        if isinstance(value, Target):
            return value
        if isinstance(value, pin.SE3):
            return cls.pose(value)
        try:
            shape = np.shape(value)
        except ValueError:  # ragged lists
            shape = ()
        if shape == (3,):
            return cls.position(value)
        if shape == (4, 4):
            return cls.pose(value)
        raise InvalidInputError("target", "a pin.SE3, a (4, 4) matrix or a position (3,)", f"shape {shape}")

    @property
    def rows(self) -> slice:
        """The rows of the frame Jacobian (6, n) that the target binds."""
        return slice(0, 6) if self.kind == "pose" else slice(0, 3)

    def error(self, T_base_tip: pin.SE3) -> Floats:
        """What is missing, in base axes: (linear [m]; rotation vector [rad]) of a pose, (linear,) of a position.

        To first order the frame Jacobian's rows times a joint step make this error smaller by that step.
        """
        wanted = self.T_base_target
        linear = wanted.translation - T_base_tip.translation
        if self.kind == "position":
            return np.asarray(linear, dtype=np.float64)
        return np.concatenate([linear, pin.log3(wanted.rotation @ T_base_tip.rotation.T)])

    def distances(self, T_base_tip: pin.SE3) -> tuple[float, float | None]:
        """Position error [m] and rotation error [rad]; None where the target leaves the orientation free."""
        rotation = rotation_distance(T_base_tip, self.T_base_target) if self.kind == "pose" else None
        return position_distance(T_base_tip, self.T_base_target), rotation
