"""The referee of every answer, ours and the peers': Pinocchio on the robot's whole model, apart from our chains."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["NEAR", "REACHED", "Referee"]

REACHED = (1e-6, 1e-6)
"""Position [m] and rotation [rad] error that counts as reached."""

NEAR = (1e-4, 1e-3)
"""The same for an answer that stopped a little early; many robots could not tell the difference."""

_LIMITS = 1e-9  # [rad or m]: the rounding of an answer at the end of a range


class Referee:
    """Measures joints of a chain on Pinocchio's model of the whole robot, its limits included.

    Nothing of the chain's own kinematics takes part: the joints are found in the model by their names, continuous ones
    as a cosine and a sine, followers of coupled joints with their leader.
    """

    def __init__(self, chain: UrdfChain) -> None:
        self._model: pin.Model = chain.robot.model
        self._data = self._model.createData()
        self._base = self._model.getFrameId(chain.base, pin.FrameType.BODY)
        self._tip = self._model.getFrameId(chain.tip, pin.FrameType.BODY)
        self._neutral, self._n = pin.neutral(self._model), len(chain.joint_names)
        moved = [(column, name, 1.0, 0.0) for column, name in enumerate(chain.joint_names)]
        columns = {name: column for column, name in enumerate(chain.joint_names)}
        moved += [
            (columns[c.leader], c.follower, c.multiplier, c.offset)
            for c in chain.robot.couplings
            if c.leader in columns and c.follower not in columns
        ]
        self._moved = [
            (column, self._model.joints[self._model.getJointId(name)], multiplier, offset)
            for column, name, multiplier, offset in moved
        ]
        self._rules = [(columns[rule.joint], columns[rule.by], rule) for rule in chain.limit_rules]

    def pose(self, q: Floats) -> Floats:
        """T_base_tip (4, 4)."""
        pin.forwardKinematics(self._model, self._data, self._values(q))
        pin.updateFramePlacement(self._model, self._data, self._base)
        pin.updateFramePlacement(self._model, self._data, self._tip)
        T: Floats = self._data.oMf[self._base].actInv(self._data.oMf[self._tip]).homogeneous
        return T

    def jacobian(self, q: Floats) -> Floats:
        """Frame Jacobian (6, n) at the tip point, rows (linear; angular), in base axes and relative to the base."""
        values, aligned = self._values(q), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J_tip = pin.computeFrameJacobian(self._model, self._data, values, self._tip, aligned)
        J_base = pin.computeFrameJacobian(self._model, self._data, values, self._base, aligned)
        pin.updateFramePlacements(self._model, self._data)
        base, tip = self._data.oMf[self._base], self._data.oMf[self._tip]
        # On a path that runs up the tree the base moves too: what counts is the tip as seen from it.
        lever = pin.skew(tip.translation - base.translation)
        linear = J_tip[:3] - J_base[:3] + lever @ J_base[3:]
        R_base_root = base.rotation.T
        whole = np.vstack([R_base_root @ linear, R_base_root @ (J_tip[3:] - J_base[3:])])
        J = np.zeros((6, self._n))
        for column, joint, multiplier, _ in self._moved:
            J[:, column] += multiplier * whole[:, joint.idx_v]
        return J

    def inside(self, q: Floats) -> bool:
        """Whether every joint is within its own range in the model, and within its coupled range."""
        lower, upper = self._model.lowerPositionLimit, self._model.upperPositionLimit
        for column, joint, multiplier, offset in self._moved:
            value, i = multiplier * q[column] + offset, joint.idx_q
            if joint.nq == 1 and not lower[i] - _LIMITS <= value <= upper[i] + _LIMITS:
                return False
        ranges = ((q[column], *rule.range(q[by])) for column, by, rule in self._rules)
        return all(low - _LIMITS <= value <= high + _LIMITS for value, low, high in ranges)

    def accepts(
        self,
        q: Floats | None,
        T_base_target: Floats,
        *,
        position_only: bool = False,
        within: tuple[float, float] = REACHED,
    ) -> bool:
        """Whether joints bring the tip to a target (4, 4) within a position and a rotation error, inside all limits."""
        if q is None or np.shape(q) != (self._n,) or not np.isfinite(q).all():
            return False
        T = self.pose(q)
        if math.dist(T[:3, 3], T_base_target[:3, 3]) > within[0] or not self.inside(q):
            return False
        return position_only or _angle(T[:3, :3], T_base_target[:3, :3]) <= within[1]

    def _values(self, q: Floats) -> Floats:
        """Pinocchio's vector of the whole robot; joints beside the path are at rest."""
        values: Floats = self._neutral.copy()
        for column, joint, multiplier, offset in self._moved:
            value = multiplier * q[column] + offset
            if joint.nq == 2:
                values[joint.idx_q], values[joint.idx_q + 1] = math.cos(value), math.sin(value)
            else:
                values[joint.idx_q] = value
        return values


def _angle(A: Floats, B: Floats) -> float:
    """Angle between two rotations [rad] from their chord, which keeps its digits where the cosine loses them."""
    return 2.0 * math.asin(min(1.0, float(np.linalg.norm(A - B)) / math.sqrt(8.0)))
