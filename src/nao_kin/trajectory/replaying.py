"""Running a trajectory through a model: where the tip goes, and whether the joints can do it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import Floats, frozen
from nao_kin.chain import OutsideLimit, outside_limits
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.tolerances import TOLERANCES
from nao_kin.trajectory.demand import Demand, demand_of
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.chain import Chain

__all__ = ["Replay", "replay"]


@dataclass(frozen=True, eq=False, slots=True)
class Replay:
    """A trajectory as a chain carries it out.

    Attributes:
        trajectory: The motion, its columns in the chain's order, with the chain's own limits.
        tips: T_base_tip at every sample (N, 4, 4) [m]; read-only.
        outside: Of each joint that leaves its own or its coupled range, the sample where it is farthest outside, and
            how; the first sample to do so comes first.
        demand: Speeds and accelerations beside their limits.
    """

    trajectory: Trajectory
    tips: Floats
    outside: tuple[tuple[int, OutsideLimit], ...]
    demand: Demand

    @property
    def faults(self) -> tuple[str, ...]:
        """A sentence for everything that the chain cannot do; empty if it can do all of it."""
        left = [f"At sample {sample} {limit}." for sample, limit in self.outside]
        return (*left, *self.demand.faults)

    @property
    def possible(self) -> bool:
        """Whether all joints stay within their ranges and speeds."""
        return not self.faults

    def __repr__(self) -> str:
        told = " ".join(self.faults) or "The joints can do it."
        return f"<Replay: {len(self.tips)} samples over {self.trajectory.duration:g} s. {told}>"

    @property
    def tip_path_length(self) -> float:
        """How far the tip travels, from sample to sample [m]."""
        return float(np.linalg.norm(np.diff(self.tips[:, :3, 3], axis=0), axis=1).sum())

    @property
    def tip_speeds(self) -> Floats:
        """Speed of the tip from each sample to the next (N − 1,) [m/s]."""
        moves = np.linalg.norm(np.diff(self.tips[:, :3, 3], axis=0), axis=1)
        return np.asarray(moves / np.diff(self.trajectory.times))

    @property
    def off_the_line(self) -> float:
        """Largest distance of the tip from the straight line between its first and its last place [m]."""
        places = self.tips[:, :3, 3] - self.tips[0, :3, 3]
        way = places[-1]
        length = float(np.linalg.norm(way))
        if length < 1e-12:
            return float(np.linalg.norm(places, axis=1).max())
        shares = np.clip(places @ way / length**2, 0.0, 1.0)
        return float(np.linalg.norm(places - shares[:, None] * way, axis=1).max())


def replay(chain: Chain, trajectory: Trajectory, *, max_acceleration: ArrayLike | None = None) -> Replay:
    """Runs a trajectory through a chain's forward kinematics, sample by sample, and checks it against its limits.

    Nothing is moved into limits: what is outside is reported.

    Args:
        chain: The chain.
        trajectory: The motion; its joints are found by their names, in any order.
        max_acceleration: Greatest joint accelerations, (n,) or one for all [rad/s² or m/s²]; none unless given.

    Returns:
        Where the tip goes, what is outside its limits, and what it asks of the joints.

    Raises:
        UnknownNameError: The chain has a joint that the trajectory has not, or the other way round.
        InvalidInputError: A joint turns here and slides there.
    """
    ordered = _in_chain_order(chain, trajectory)
    worst: dict[str, tuple[int, int, OutsideLimit]] = {}
    for sample, q in enumerate(ordered.q):
        for limit in outside_limits(chain, q, TOLERANCES.limits):
            first, _, known = worst.get(limit.joint, (sample, sample, limit))
            if limit.joint not in worst or _beyond(limit) > _beyond(known):
                worst[limit.joint] = (first, sample, limit)
    outside = tuple((sample, limit) for _, sample, limit in sorted(worst.values(), key=lambda found: found[0]))
    demand = demand_of(ordered, max_acceleration=max_acceleration)
    return Replay(ordered, frozen(chain.poses(ordered.q)), outside, demand)


def _in_chain_order(chain: Chain, trajectory: Trajectory) -> Trajectory:
    for name in chain.joint_names:
        if name not in trajectory.joint_names:
            raise UnknownNameError("joint", name, trajectory.joint_names, f"trajectory {trajectory.name}".rstrip())
    for joint in trajectory.joints:
        if joint.name not in chain.joint_names:
            raise UnknownNameError("joint", joint.name, chain.joint_names, chain.name)
        own = chain.joints[chain.joint_names.index(joint.name)]
        if (own.kind == "prismatic") != (joint.kind == "prismatic"):
            raise InvalidInputError(f"trajectory, {joint.name}", f"a {own.kind} joint, as in {chain.name}", joint.kind)
    columns = [trajectory.joint_names.index(name) for name in chain.joint_names]
    return Trajectory(chain.joints, trajectory.times, trajectory.q[:, columns], trajectory.name)


def _beyond(limit: OutsideLimit) -> float:
    return max(limit.lower - limit.value, limit.value - limit.upper)
