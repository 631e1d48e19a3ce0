"""Pinocchio's own configuration vector: alphabetical joint order, and a (cos, sin) pair for a continuous joint."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pinocchio as pin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats

__all__ = ["PinocchioLayout"]


@dataclass(frozen=True)
class PinocchioLayout:
    """Where in Pinocchio's vectors the named joints are.

    Attributes:
        neutral: Pinocchio's own neutral configuration.
        plain: Joints with one number: their places in our order, and in Pinocchio's vector.
        turning: The same for continuous joints, which take a cosine and a sine.
    """

    neutral: Floats
    plain: tuple[list[int], list[int]]
    turning: tuple[list[int], list[int]]

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
        )

    def q(self, values: Floats) -> Floats:
        """Pinocchio's configuration vector: continuous joints become a cosine and a sine."""
        q: Floats = self.neutral.copy()
        source, target = self.plain
        q[target] = values[source]
        for k, i in zip(*self.turning, strict=True):
            q[i], q[i + 1] = math.cos(values[k]), math.sin(values[k])
        return q
