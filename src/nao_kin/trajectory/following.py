"""Following a path on one branch, and in time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import Floats, frozen, positive, vector
from nao_kin.errors import InvalidInputError
from nao_kin.ik.measure import measure_many
from nao_kin.ik.problem import Status
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import KINDS, Target, TargetLike
from nao_kin.solving import CLOSED, solve
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.trajectory.causes import NEAR_SINGULAR, Cause, cause_of, singular_values
from nao_kin.trajectory.demand import Demand, demand_of
from nao_kin.trajectory.paths import PoseLine
from nao_kin.trajectory.synchrony import per_axis
from nao_kin.trajectory.timing import TimedPath
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike

    from nao_kin.chain import Chain

__all__ = ["FollowResult", "error_between", "follow", "slowed"]

_ONE_START = Budget(restarts=0, largest_step=0.2)  # another start would be another branch


@dataclass(frozen=True, eq=False, slots=True)
class FollowResult:
    """A path in joint space, and in time where it has times.

    Attributes:
        q: Joints (k, n) [rad or m] of the samples that were reached, in order; read-only.
        samples: Number of samples asked for.
        status: Why it ended; `Status.SOLVED` if at the last sample.
        cause: What stopped it, `Cause.NONE` if nothing did.
        reason: The same for people, with the sample's number where it ended early, and with the joint that is too slow.
        largest_move: Largest move of a joint between consecutive samples [rad or m].
        largest_move_at: Number of the sample it led to.
        max_position_error: Largest measured distance to a target [m].
        max_rotation_error: Largest measured angle to a wanted orientation [rad]; 0 where it is free.
        position_error_between: Largest distance of the tip from the path between samples, where joints move straight
            [m]; measured at three places of each step.
        rotation_error_between: The same for the angle [rad].
        smallest_singular_value: Smallest singular value of the Jacobian's rows that the path binds [m and rad, a rad].
        smallest_singular_value_at: Number of the sample where.
        trajectory: The joints over time as far as they were reached; None without times.
        demand: What it asks of the joints; None without times.
        planned_duration: How long the samples that were reached were to take [s]; 0 without times.
    """

    q: Floats
    samples: int
    status: Status
    cause: Cause
    reason: str
    largest_move: float
    largest_move_at: int
    max_position_error: float
    max_rotation_error: float
    position_error_between: float
    rotation_error_between: float
    smallest_singular_value: float
    smallest_singular_value_at: int
    trajectory: Trajectory | None = None
    demand: Demand | None = None
    planned_duration: float = 0.0

    @property
    def completed(self) -> bool:
        """Whether every sample was reached without a jump."""
        return len(self.q) == self.samples and self.status is Status.SOLVED

    def table(self) -> Table:
        """The outcome in numbers."""
        rows = (
            ("status", self.status.name),
            ("samples reached", f"{len(self.q)} of {self.samples}"),
            ("largest move of a joint [rad or m]", f"{self.largest_move:.4g}, to sample {self.largest_move_at}"),
            ("largest position error [m]", f"{self.max_position_error:.3g}"),
            ("position error between samples [m]", f"{self.position_error_between:.3g}"),
            ("largest rotation error [rad]", f"{self.max_rotation_error:.3g}"),
            ("rotation error between samples [rad]", f"{self.rotation_error_between:.3g}"),
            ("smallest singular value", f"{self.smallest_singular_value:.3g}, at {self.smallest_singular_value_at}"),
            *(() if self.trajectory is None else (("duration [s]", f"{self.trajectory.duration:.4g}"),)),
        )
        return Table((Column("what"), Column("value")), rows, title="A path in joint space", note=self.reason)

    def __repr__(self) -> str:
        return f"<FollowResult {self.status.name}: {len(self.q)} of {self.samples} samples>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()

    @property
    def ended_at(self) -> int | None:
        """Number of the sample that was not reached; None if all were."""
        return None if self.completed else len(self.q)

    @property
    def slowed(self) -> float:
        """How many times as long it takes as was planned, a plain number; 1 without times."""
        if self.trajectory is None or not self.planned_duration:
            return 1.0
        return self.trajectory.duration / self.planned_duration


def follow(
    chain: Chain,
    path: Iterable[TargetLike] | TimedPath,
    q0: ArrayLike | Mapping[str, float],
    *,
    times: ArrayLike | None = None,
    scale: bool = False,
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    jump: float = 0.5,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    name: str = "",
) -> FollowResult:
    """Joints along a path, each sample solved from the one before: one branch, never a new start.

    It ends early, and says at which sample and why, where a sample is not reached from its predecessor or where a joint
    would have to move by more than `jump`. With times it also measures the joints' speeds and accelerations against
    their limits, and slows down if asked to.

    Args:
        chain: The chain.
        path: Targets in order, as `nao_kin.solve` takes them; or a `TimedPath`, which has its own times.
        q0: Start (n,) or posture, near the first sample.
        times: When each sample is to be reached (k,) [s], strictly increasing; speeds are not looked at without.
        scale: Whether to slow down where a joint would be too fast. Otherwise it is only said.
        max_velocity: Greatest joint speeds, (n,) or one for all [rad/s or m/s]; the chain's own unless given.
        max_acceleration: Greatest joint accelerations, (n,) or one for all [rad/s² or m/s²]; none unless given.
        jump: Largest move of a joint between consecutive samples [rad or m]; the move to the first one is free.
        method: A name in `nao_kin.METHODS`; ``"closed"`` takes at each sample the branch nearest to the one before.
        tolerances: When a sample counts as reached.
        name: Name of the trajectory.

    Returns:
        The joints as far as the path was followed, with why it ended and what was measured on the way.

    Raises:
        InvalidInputError: An empty path, a bad target, times that do not fit, limits or a jump that are not positive.
        UnknownNameError: No such method or joint.
    """
    targets, instants = _samples(path, times)
    limits = _limits(chain, max_velocity, max_acceleration)
    if scale and instants is None:
        raise InvalidInputError("scale", "times, or a path that has them", "none")
    walk = _walk(chain, targets, q0, positive(jump, "jump", "[rad or m]", endless=True), method, tolerances)
    timing = path if isinstance(path, TimedPath) else None
    between = error_between(chain, targets[: len(walk.q)], walk.q, timing)
    trajectory, demand, reason, planned = None, None, walk.reason, 0.0
    if instants is not None and len(walk.q):
        trajectory = Trajectory(chain.joints, instants[: len(walk.q)], walk.q, name)
        planned = trajectory.duration
        if scale:
            trajectory = slowed(trajectory, *limits)
        demand = demand_of(trajectory, max_velocity=limits[0], max_acceleration=limits[1])
        reason = " ".join([reason, *demand.faults[:1]])
    q = frozen(np.array(walk.q, dtype=np.float64).reshape(-1, len(chain.joints)))
    return FollowResult(
        q=q,
        samples=len(targets),
        status=walk.status,
        cause=walk.cause,
        reason=reason,
        largest_move=walk.largest_move,
        largest_move_at=walk.largest_move_at,
        max_position_error=walk.position_error,
        max_rotation_error=walk.rotation_error,
        position_error_between=between[0],
        rotation_error_between=between[1],
        smallest_singular_value=walk.singular_value,
        smallest_singular_value_at=walk.singular_value_at,
        trajectory=trajectory,
        demand=demand,
        planned_duration=planned,
    )


@dataclass(eq=False, slots=True)
class _Walk:
    """What is known so far."""

    q: list[Floats] = field(default_factory=list)
    status: Status = Status.SOLVED
    cause: Cause = Cause.NONE
    reason: str = ""
    largest_move: float = 0.0
    largest_move_at: int = 0
    position_error: float = 0.0
    rotation_error: float = 0.0
    singular_value: float = np.inf
    singular_value_at: int = 0
    singular: bool = False


def _walk(
    chain: Chain,
    targets: list[Target],
    q0: ArrayLike | Mapping[str, float],
    jump: float,
    method: str,
    tolerances: Tolerances,
) -> _Walk:
    """Solves sample after sample until one is not reached."""
    walk, start = _Walk(reason=f"All {len(targets)} samples are reached."), q0
    budget = None if method == CLOSED else _ONE_START
    for index, target in enumerate(targets):
        result = solve(chain, target, start, method=method, tolerances=tolerances, budget=budget)
        before = walk.q[-1] if walk.q else result.q
        moves = np.abs(result.q - before)
        joint = int(moves.argmax())
        if not result.solved or moves[joint] > jump:
            walk.status = Status.JUMPED if result.solved else result.status
            walk.cause, why = cause_of(chain, target, before, result)
            said = f"Sample {index} is not reached"
            if result.solved:
                said = f"At sample {index} {chain.joint_names[joint]} jumps by {moves[joint]:.3g}, more than {jump:g}"
            walk.reason = f"{said}: {why}."
            break
        if moves[joint] > walk.largest_move:
            walk.largest_move, walk.largest_move_at = float(moves[joint]), index
        walk.position_error = max(walk.position_error, result.position_error or 0.0)
        walk.rotation_error = max(walk.rotation_error, result.rotation_error or 0.0)
        values = singular_values(chain, target, result.q)
        if values[-1] < walk.singular_value:
            walk.singular_value, walk.singular_value_at = float(values[-1]), index
            walk.singular = bool(values[-1] < NEAR_SINGULAR * values[0])
        walk.q.append(result.q)
        start = result.q.copy()
    if walk.singular and walk.status is Status.SOLVED:
        walk.reason += f" At sample {walk.singular_value_at} it passes near a singularity"
        walk.reason += f", where the smallest singular value is {walk.singular_value:.2g}."
    return walk


def _samples(path: Iterable[TargetLike] | TimedPath, times: ArrayLike | None) -> tuple[list[Target], Floats | None]:
    if isinstance(path, TimedPath):
        if times is not None:
            raise InvalidInputError("times", "none for a path that has its own", "some")
        return list(path.targets), path.times
    targets = [Target.of(target) for target in path]
    if not targets:
        raise InvalidInputError("path", "at least one target", "none")
    if times is None:
        return targets, None
    instants = vector(times, "times", len(targets))
    if (np.diff(instants) <= 0.0).any():
        at = int(np.argmax(np.diff(instants) <= 0.0))
        said = f"{instants[at + 1]:g} s after {instants[at]:g} s at sample {at + 1}"
        raise InvalidInputError("times", "strictly increasing", said)
    return targets, instants


def _limits(chain: Chain, max_velocity: ArrayLike | None, max_acceleration: ArrayLike | None) -> tuple[Floats, Floats]:
    """Greatest speeds and accelerations (n,), +inf where there are none."""
    count = len(chain.joints)
    own = chain.max_velocity if max_velocity is None else max_velocity
    speeds = per_axis(own, "max_velocity", count, endless=True)
    given = np.inf if max_acceleration is None else max_acceleration
    rates = per_axis(given, "max_acceleration", count, endless=True)
    for what, values in (("max_velocity", speeds), ("max_acceleration", rates)):
        for joint, value in zip(chain.joint_names, values, strict=True):
            positive(float(value), f"{what} of {joint}", endless=True)
    return speeds, rates


_PARTS: Final = (0.25, 0.5, 0.75)


def error_between(
    chain: Chain, targets: Sequence[Target], Q: Sequence[Floats], timing: TimedPath | None
) -> tuple[float, float]:
    """Largest position error [m] and rotation error [rad] at a quarter, the half and three quarters of every step.

    The path there is the timed path at the same time or, of bare targets, the straight line and even turn from one to
    the next. Steps between targets of different kinds or weights are passed over.

    Args:
        chain: The chain.
        targets: What is wanted at the samples (k).
        Q: Joints at the samples (k).
        timing: Where the targets come from, if they have times.
    """
    steps = [i for i in range(len(Q) - 1) if _alike(targets[i], targets[i + 1])]
    if not steps:
        return 0.0, 0.0
    wanted = [_wanted(targets, i, part, timing) for i in steps for part in _PARTS]
    tips = chain.poses(np.array([(1.0 - part) * Q[i] + part * Q[i + 1] for i in steps for part in _PARTS]))
    worst = np.zeros(2)
    for key in {(target.kind, target.counts) for target in wanted}:
        chosen = [n for n, target in enumerate(wanted) if (target.kind, target.counts) == key]
        goals = np.array([wanted[n].goal for n in chosen])
        found = measure_many(KINDS[key[0]], goals, key[1], tips[chosen])
        worst = np.fmax(worst, [np.fmax.reduce(errors) for errors in found])  # NaN is what a target leaves free
    return float(worst[0]), float(worst[1])


def _alike(one: Target, other: Target) -> bool:
    return one.kind == other.kind and one.weights == other.weights


def _wanted(targets: Sequence[Target], i: int, part: float, timing: TimedPath | None) -> Target:
    if timing is not None:
        return timing.target_at((1.0 - part) * timing.times[i] + part * timing.times[i + 1])
    one, other = targets[i], targets[i + 1]
    goal = (1.0 - part) * one.goal + part * other.goal
    if one.kind in ("pose", "orientation"):
        goal[:3, :3] = PoseLine(one.goal, other.goal).target(part).goal[:3, :3]
    if one.kind == "pointing":
        goal[:3, :2] /= np.linalg.norm(goal[:3, :2], axis=0)
    return Target(one.kind, goal, one.weights)


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
