"""Motions in joint space: every joint with its own profile, or all on one straight line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import positive
from nao_kin.chain import configuration
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.instants import SAMPLING, sample_times
from nao_kin.trajectory.synchrony import per_axis, synchronised
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import JointSpace
    from nao_kin.trajectory.trapezoid import Trapezoid

__all__ = ["joint_motion", "joint_profiles", "speed_limits"]


def joint_motion(
    chain: JointSpace,
    q_start: ArrayLike,
    q_end: ArrayLike,
    *,
    acceleration: ArrayLike,
    braking: ArrayLike | None = None,
    max_velocity: ArrayLike | None = None,
    straight: bool = False,
    sampling: float = SAMPLING,
    start_time: float = 0.0,
    name: str = "",
) -> Trajectory:
    """The joints of a chain or tree from rest to rest, all arriving together.

    Limits of position are not looked at: whoever starts inside them and ends inside them stays inside, coupled limits
    excepted, which `nao_kin.trajectory.checking.audit` measures.

    Args:
        chain: Whose joints; a `Tree` will do.
        q_start: Joints at the start (n,) [rad or m].
        q_end: Joints at the end (n,) [rad or m].
        acceleration: Greatest accelerations, (n,) or one for all [rad/s² or m/s²].
        braking: Greatest decelerations, (n,) or one for all [rad/s² or m/s²]; as `acceleration` unless given.
        max_velocity: Greatest speeds, (n,) or one for all [rad/s or m/s]; the chain's own unless given.
        straight: Whether the joints keep in proportion, which is a straight line in joint space and takes longer where
            one joint is the slowest to speed up and another the slowest to turn.
        sampling: Time between samples [s].
        start_time: When it starts [s].
        name: Name of the trajectory.

    Returns:
        The motion, sampled; its last sample is `q_end` exactly.

    Raises:
        InvalidInputError: Shapes do not fit, numbers are not positive, or a joint has no greatest speed and none is
            given.
    """
    profiles = joint_profiles(
        chain,
        q_start,
        q_end,
        acceleration=acceleration,
        braking=braking,
        max_velocity=max_velocity,
        straight=straight,
        start_time=start_time,
    )
    times = sample_times(max(profile.duration for profile in profiles), sampling, start_time)
    q = np.array([profile.position(times) for profile in profiles]).T
    q[-1] = configuration(chain, q_end)  # rounding of the start time must not cost the end
    return Trajectory(chain.joints, times, q, name)


def joint_profiles(
    chain: JointSpace,
    q_start: ArrayLike,
    q_end: ArrayLike,
    *,
    acceleration: ArrayLike,
    braking: ArrayLike | None = None,
    max_velocity: ArrayLike | None = None,
    straight: bool = False,
    start_time: float = 0.0,
) -> tuple[Trapezoid, ...]:
    """The profiles behind `joint_motion`, one a joint, for exact speeds and accelerations at any time.

    Raises:
        InvalidInputError: See `joint_motion`.
    """
    start, end = configuration(chain, q_start), configuration(chain, q_end)
    count = len(start)
    limits = {
        "max_velocity": speed_limits(chain, max_velocity),
        "acceleration": per_axis(acceleration, "acceleration", count),
        "braking": per_axis(acceleration if braking is None else braking, "braking", count),
    }
    for what, values in limits.items():
        for joint, value in zip(chain.joint_names, values, strict=True):
            positive(float(value), f"{what} of {joint}")
    if not straight:
        return synchronised(start, end, **limits, start_time=start_time)
    way = np.abs(end - start)
    moving = way > 0.0
    if not moving.any():  # nothing to keep in proportion
        return synchronised(start, end, **limits, start_time=start_time)
    rates = {name: float((values[moving] / way[moving]).min()) for name, values in limits.items()}
    scaled = {name: np.where(moving, np.minimum(rate * way, limits[name]), 1.0) for name, rate in rates.items()}
    return synchronised(start, end, **scaled, start_time=start_time)


def speed_limits(chain: JointSpace, max_velocity: ArrayLike | None) -> Floats:
    """Greatest speeds (n,) [rad/s or m/s]: the ones given, or else the chain's own.

    Raises:
        InvalidInputError: Wrong shape, or a joint whose greatest speed nobody gives.
    """
    if max_velocity is not None:
        return per_axis(max_velocity, "max_velocity", len(chain.joints))
    unknown = [joint.name for joint in chain.joints if not np.isfinite(joint.max_velocity)]
    if unknown:
        raise InvalidInputError(
            "max_velocity", f"a speed for {', '.join(unknown)}, for which {chain.name} has none", "none"
        )
    return np.array(chain.max_velocity)
