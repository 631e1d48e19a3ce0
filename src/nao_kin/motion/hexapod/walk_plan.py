"""A walk without its joints: where the body and all six feet are at any time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.hexapod.footfall import LEGS, Steps, steps
from nao_kin.motion.loop.profile import minimum_jerk
from nao_kin.se3 import from_xyz_rpy, rotation_z

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.motion.hexapod.walk_request import WalkCommand
    from nao_kin.robot.robot import Robot

__all__ = ["WalkPlan", "hexapod_legs"]


def hexapod_legs(robot: Robot, legs: Mapping[str, Chain] | None) -> dict[str, Chain]:
    """The six legs in the order of `footfall.LEGS`: those given, or the robot's chains ``leg_…``.

    Raises:
        InvalidInputError: A leg is missing, is no chain of three joints, or does not begin at the robot's root.
        UnknownNameError: A leg of another name; carries near matches.
    """
    if legs is None:
        names = {leg: f"leg_{leg}" for leg in LEGS}
        if absent := [name for name in names.values() if name not in robot.chain_frames]:
            expected = "a hexapod with chains leg_lf to leg_rr, or its legs as legs={'lf': chain, …}"
            raise InvalidInputError("robot", expected, f"{robot.name} without {', '.join(absent)}")
        legs = {leg: robot.chain(name) for leg, name in names.items()}
    for leg in legs:
        if leg not in LEGS:
            raise UnknownNameError("leg", leg, LEGS, "legs")
    for leg in LEGS:
        if leg not in legs:
            raise InvalidInputError("legs", "six legs", f"none for {leg}")
        if (base := legs[leg].base_name) != robot.root or len(legs[leg].joints) != 3:
            expected = f"three joints from {robot.root} to the foot"
            raise InvalidInputError(f"leg {leg}", expected, f"{len(legs[leg].joints)} from {base}")
    return {leg: legs[leg] for leg in LEGS}


@dataclass(frozen=True, eq=False, slots=True)
class WalkPlan:
    """Body and feet over time; time 0 is the first lift-off.

    Attributes:
        command: What was asked for.
        homes: Where the feet usually are under the body, in its axes (6, 2) [m].
        steps: The steps of each leg.
        lean: How long the body takes to its pose before the first step, and back after the last [s].
        end: When the last foot has landed and the body stands still [s].
    """

    command: WalkCommand
    homes: Floats
    steps: tuple[Steps, ...]
    lean: float
    end: float

    @classmethod
    def of(cls, command: WalkCommand, chains: Mapping[str, Chain]) -> WalkPlan:
        """The plan of a command for the legs in the order of `nao_kin.motion.hexapod.footfall.LEGS`."""
        homes = np.array([_home(chain, command.spread) for chain in chains.values()])
        planned = tuple(
            steps(command.course, command.rhythm, command.period, leg, home)
            for leg, home in zip(chains, homes, strict=True)
        )
        end = max([command.duration, *(float(each.land[-1]) for each in planned)])
        return cls(command, homes, planned, command.period if any(command.body) else 0.0, end)

    @property
    def standing(self) -> Floats:
        """Where the feet are before the first step (6, 3) [m]."""
        return np.column_stack([self.homes, np.zeros(len(self.homes))])

    def sample_times(self) -> Floats:
        """Every `sample_time` from standing to standing, and the end itself (N,) [s]."""
        step, last = self.command.sample_time, self.end + self.lean
        count = int(np.floor((last + self.lean) / step + 1e-9))
        times = np.asarray(step * np.arange(count + 1) - self.lean, dtype=np.float64)
        if last - times[-1] > 1e-9 * step:
            return np.append(times, last)
        times[-1] = last
        return times

    def at(self, time: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """T_world_body (N, 4, 4), the feet in the world (N, 6, 3) [m] and which of them are on the ground (N, 6)."""
        feet, down = zip(*(each.at(time, self.command.step_height) for each in self.steps), strict=True)
        return self._bodies(time), np.stack(feet, axis=1), np.stack(down, axis=1)

    def _bodies(self, time: Floats) -> Floats:
        offset, T = np.array(self.command.body), np.empty((len(time), 4, 4))
        rows = zip(self.command.course.poses(time).tolist(), self._leaning(time).tolist(), strict=True)
        for i, ((x, y, heading), share) in enumerate(rows):
            usual = pin.SE3(rotation_z(heading).rotation, np.array([x, y, self.command.height]))
            T[i] = (usual * from_xyz_rpy(share * offset[:3], share * offset[3:])).homogeneous
        return T

    def _leaning(self, time: Floats) -> Floats:
        """How much of its pose the body has taken up (N,), from 0 to 1."""
        if not self.lean:
            return np.ones(len(time))
        u = np.clip(np.minimum(time + self.lean, self.end + self.lean - time) / self.lean, 0.0, 1.0)
        return minimum_jerk(u)


def _home(chain: Chain, spread: float) -> Floats:
    """Where a foot is that stands straight out from its coxa axis, seen from above (2,) [m]."""
    zero = np.zeros(len(chain.joints))
    coxa, foot = chain.link_poses(zero)[0][:2, 3], chain.pose(zero).translation[:2]
    return np.asarray(coxa + spread * (foot - coxa) / np.linalg.norm(foot - coxa))
