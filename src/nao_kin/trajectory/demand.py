"""What a motion asks of its joints: speeds and accelerations, and how they compare with what the joints can do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import Floats, frozen
from nao_kin.trajectory.synchrony import per_axis

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from nao_kin.trajectory.trajectory import Trajectory

__all__ = ["ROUNDING", "Demand", "demand_of"]

ROUNDING = 1e-9
"""Relative; a rate this little above its limit is at it: differences of samples lose that much."""


@dataclass(frozen=True, eq=False, slots=True)
class Demand:
    """Largest rates of each joint, measured from sample to sample, beside their limits.

    Attributes:
        joint_names: The joints.
        speed: Largest speed (n,) [rad/s or m/s].
        speed_at: Number of the sample that the fastest step leads to (n,).
        max_velocity: What is allowed (n,), +inf where nothing is known.
        acceleration: Largest acceleration at a sample between two others (n,) [rad/s² or m/s²].
        acceleration_at: Number of that sample (n,).
        max_acceleration: What is allowed (n,), +inf where nothing is known.
    """

    joint_names: tuple[str, ...]
    speed: Floats
    speed_at: NDArray[np.int64]
    max_velocity: Floats
    acceleration: Floats
    acceleration_at: NDArray[np.int64]
    max_acceleration: Floats

    @property
    def faults(self) -> tuple[str, ...]:
        """A sentence for each limit that is not kept, the worst first; empty where all are."""
        found = []
        rates = (
            ("needs a speed of", self.speed, self.max_velocity, self.speed_at),
            ("needs an acceleration of", self.acceleration, self.max_acceleration, self.acceleration_at),
        )
        for what, values, limits, samples in rates:
            over = values / limits
            for i in np.argsort(-over):
                if over[i] > 1.0 + ROUNDING:
                    said = f"{self.joint_names[i]} {what} {values[i]:.4g} at sample {samples[i]}"
                    found.append((over[i], f"{said}; its limit is {limits[i]:.4g}."))
        return tuple(text for _, text in sorted(found, key=lambda pair: -pair[0]))

    @property
    def kept(self) -> bool:
        """Whether every joint stays within its limits."""
        return not self.faults


def demand_of(
    trajectory: Trajectory, *, max_velocity: ArrayLike | None = None, max_acceleration: ArrayLike | None = None
) -> Demand:
    """The demand of a trajectory, whose samples are joined by straight moves.

    Args:
        trajectory: The motion.
        max_velocity: Greatest speeds, (n,) or one for all [rad/s or m/s]; those of its joints unless given.
        max_acceleration: Greatest accelerations, (n,) or one for all [rad/s² or m/s²]; none unless given.

    Raises:
        InvalidInputError: Shapes do not fit.
    """
    count = len(trajectory.joints)
    own = np.array([joint.max_velocity for joint in trajectory.joints])
    speed, speed_at = _largest(trajectory.velocities, count)
    acceleration, acceleration_at = _largest(trajectory.accelerations, count)
    return Demand(
        trajectory.joint_names,
        speed,
        speed_at + 1,
        frozen(own if max_velocity is None else per_axis(max_velocity, "max_velocity", count, endless=True)),
        acceleration,
        acceleration_at + 1,
        frozen(
            per_axis(np.inf if max_acceleration is None else max_acceleration, "max_acceleration", count, endless=True)
        ),
    )


def _largest(rates: Floats, count: int) -> tuple[Floats, NDArray[np.int64]]:
    """Largest size in each column, and its row."""
    if not len(rates):
        return frozen(np.zeros(count)), np.zeros(count, dtype=np.int64)
    sizes = np.abs(rates)
    return frozen(sizes.max(axis=0)), sizes.argmax(axis=0)
