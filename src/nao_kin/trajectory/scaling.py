"""Slowing a motion down where its joints cannot keep up, along the same joints' path.

With u the time as planned, the motion is q(u) and time runs at the rate du/dt. Writing x = (du/dt)² and w = d²u/dt²,

    dq/dt = q' √x,    d²q/dt² = q' w + q'' x,    x(u + Δu) = x(u) + 2 w Δu,

so that limits of speed and acceleration are linear in x and w. Going back from the end, the largest x from which the
rest can be done is found at every sample; going forward, time then runs as fast as that allows.

Source: H. Pham and Q.-C. Pham, "A new approach to time-optimal path parameterization based on reachability analysis",
2018; here time never runs faster than planned, x ≤ 1, so that what is within the limits stays as it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.trajectory.demand import demand_of
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["slowed"]

_STILL: Final = 1e-12  # a rate this small against its limit bounds nothing


def slowed(trajectory: Trajectory, max_velocity: Floats, max_acceleration: Floats) -> Trajectory:
    """The same samples at later times, so that the speeds and accelerations from sample to sample keep their limits.

    Args:
        trajectory: The motion as planned.
        max_velocity: Greatest speeds (n,) [rad/s or m/s]; +inf where there is none.
        max_acceleration: Greatest accelerations (n,) [rad/s² or m/s²]; +inf where there is none.

    Returns:
        The trajectory itself where it keeps them already.
    """
    limits = {"max_velocity": max_velocity, "max_acceleration": max_acceleration}
    if len(trajectory) < 2 or demand_of(trajectory, **limits).kept:
        return trajectory
    steps = np.diff(trajectory.times)
    x = _rates_squared(trajectory, steps, max_velocity, max_acceleration)
    longer = 2.0 * steps / (np.sqrt(x[:-1]) + np.sqrt(x[1:]))
    # The bounds are met at samples; between them the measured rates differ a little, and one factor mends that.
    for _ in range(3):
        found = _at(trajectory, longer)
        demand = demand_of(found, **limits)
        if demand.kept:
            break
        speed = float((demand.speed / max_velocity).max())
        acceleration = float((demand.acceleration / max_acceleration).max())
        longer = longer * max(1.0, speed, np.sqrt(acceleration)) * (1.0 + 1e-12)
    return found


def _at(trajectory: Trajectory, steps: Floats) -> Trajectory:
    times = trajectory.times[0] + np.concatenate([[0.0], np.cumsum(steps)])
    return Trajectory(trajectory.joints, times, trajectory.q, trajectory.name)


def _rates_squared(trajectory: Trajectory, steps: Floats, v_max: Floats, a_max: Floats) -> Floats:
    """X = (du/dt)² at the samples (N,), each in (0, 1]."""
    velocities = trajectory.velocities
    first, second = _derivatives(velocities, trajectory.accelerations, steps)
    # A speed holds for the whole step, so a sample keeps to the slower of its two.
    with np.errstate(divide="ignore"):
        allowed = np.minimum(1.0, (v_max / np.abs(velocities)).min(axis=1)) ** 2
    bound = np.minimum(np.append(allowed, 1.0), np.append(1.0, allowed))
    # The accelerations at both ends of a step, the later one at x + 2 w Δu, in the form first w + second x: with the
    # earlier one alone x would swing up and down where a joint turns back.
    later = first[1:] + 2.0 * steps[:, None] * second[1:]
    first, second = np.hstack([first[:-1], later]), np.hstack([second[:-1], second[1:]])
    bounds = np.concatenate([a_max, a_max])
    count = len(bound)
    high = bound.copy()
    for i in range(count - 2, -1, -1):
        high[i] = min(bound[i], _largest_x(first[i], second[i], bounds, high[i + 1], steps[i]))
    x = high.copy()
    for i in range(count - 1):
        fastest = _largest_w(first[i], second[i], bounds, x[i])
        x[i + 1] = min(high[i + 1], max(x[i] + 2.0 * steps[i] * fastest, 0.0))
    floored: Floats = np.maximum(x, 1e-12)
    return floored


def _derivatives(velocities: Floats, accelerations: Floats, steps: Floats) -> tuple[Floats, Floats]:
    """Q' and q'' at the samples (N, n), by differences; at both ends those of the neighbour, carried on."""
    if not len(accelerations):
        first = np.concatenate([velocities, velocities])
        return first, np.zeros_like(first)
    before = velocities[0] - accelerations[0] * steps[0] / 2.0
    after = velocities[-1] + accelerations[-1] * steps[-1] / 2.0
    middle = (velocities[:-1] + velocities[1:]) / 2.0
    first = np.concatenate([before[None], middle, after[None]])
    return first, np.concatenate([accelerations[:1], accelerations, accelerations[-1:]])


def _largest_x(first: Floats, second: Floats, a_max: Floats, next_high: float, step: float) -> float:
    """The largest x ≤ 1 for which some w keeps the accelerations within limits and x + 2 w Δu within [0, next_high].

    Each limit bounds w by a line in x from below or from above; every lower one must stay under every upper one.
    """
    moving = np.abs(first) > _STILL * a_max
    still = ~moving & (np.abs(second) > _STILL * a_max) & np.isfinite(a_max)
    x = float((a_max[still] / np.abs(second[still])).min(initial=1.0))
    used = moving & np.isfinite(a_max)
    size, slope = np.abs(first[used]), -second[used] / first[used]
    reach = a_max[used] / size
    # w ≥ −reach + slope x and w ≤ reach + slope x; and the step: −x/(2Δu) ≤ w ≤ (next_high − x)/(2Δu).
    turn = -0.5 / step
    low, low_slope = np.append(-reach, 0.0), np.append(slope, turn)
    high, high_slope = np.append(reach, next_high * 0.5 / step), np.append(slope, turn)
    rise = low_slope[:, None] - high_slope[None, :]
    room = high[None, :] - low[:, None]
    crossing = rise > 1e-300
    return min(x, float((room[crossing] / rise[crossing]).min(initial=1.0)))


def _largest_w(first: Floats, second: Floats, a_max: Floats, x: float) -> float:
    """The largest w that keeps the accelerations within limits at x; +inf where nothing bounds it."""
    used = (np.abs(first) > _STILL * a_max) & np.isfinite(a_max)
    size, slope = np.abs(first[used]), -second[used] / first[used]
    return float((a_max[used] / size + slope * x).min(initial=np.inf))
