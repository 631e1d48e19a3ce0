"""Servo control of all axes along a trajectory, simulated: P or PI on position, with or without velocity feed-forward.

Each control period the servo commands the speeds u = kp e + ki ∫e dt + v_ref, where e is the reference's position minus
the measured one and v_ref the reference's speed, which is left out without feed-forward (practicum, tasks 2e and 2h).
Commands are cut to what speed, acceleration and the joints' ranges allow, and every cut is on record.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.arrays import Floats, finite, frozen, positive, vector
from nao_kin.chain import neutral
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory import Trajectory
from nao_kin.trajectory.instants import LARGEST_COUNT
from nao_kin.trajectory.synchrony import per_axis

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.motion.loop.plants import Plant
    from nao_kin.robot.motors import Motors

__all__ = [
    "PRACTICUM_PERIOD",
    "FeedForwardComparison",
    "Gains",
    "Servo",
    "ServoRun",
    "compare_feed_forward",
    "overshoot",
    "reference_samples",
    "run_servo",
    "tune",
]

PRACTICUM_PERIOD: Final = 0.01
"""Sampling time of the practicum's controller [s] (practicum, task 2c)."""


@dataclass(frozen=True, slots=True)
class Gains:
    """What the servo multiplies with.

    Attributes:
        position: kp, commanded speed an error [1/s].
        integral: ki, commanded speed an error times second [1/s²]; 0 for a P servo.
        feed_forward: Whether the reference's speed is added.

    Raises:
        InvalidInputError: A gain below 0 or not finite.
    """

    position: float
    integral: float = 0.0
    feed_forward: bool = False

    def __post_init__(self) -> None:
        for name, value in (("position", self.position), ("integral", self.integral)):
            if not 0.0 <= value < np.inf:
                raise InvalidInputError(f"gain {name}", "a finite number ≥ 0", repr(value))


class Servo:
    """The controller of all motors, one loop each.

    Args:
        motors: The motors, whose ranges and speeds bound the commands.
        gains: The gains.
        period: Control period [s].
        acceleration: Greatest change of a commanded speed a second (n,), or one number; endless by default.

    Raises:
        InvalidInputError: A period or an acceleration that is not above 0.
    """

    def __init__(
        self,
        motors: Motors,
        gains: Gains,
        *,
        period: float = PRACTICUM_PERIOD,
        acceleration: ArrayLike = np.inf,
    ) -> None:
        n = len(motors.joints)
        self.motors, self.gains, self.period = motors, gains, positive(period, "period", "[s]")
        self.acceleration = per_axis(acceleration, "acceleration", n, endless=True)
        if not (self.acceleration > 0.0).all():
            raise InvalidInputError("acceleration", "numbers > 0", str(float(self.acceleration.min())))
        self._integral, self._command = np.zeros(n), np.zeros(n)

    def command(self, q_ref: Floats, v_ref: Floats, q: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Speeds for this period, (n,), and which of them were cut to a limit.

        Args:
            q_ref: Where the motors should be now (n,).
            v_ref: Speeds of the reference during the coming period (n,).
            q: Where they are (n,).
        """
        error = q_ref - q
        wanted = self.gains.position * error + self._integral
        if self.gains.feed_forward:
            wanted = wanted + v_ref
        allowed = self._allowed(wanted, q)
        cut = allowed != wanted
        # Anti-windup: what cannot be commanded is not summed up, unless the error leads back.
        winding = cut & ((wanted - allowed) * error > 0.0)
        self._integral = np.where(winding, self._integral, self._integral + self.gains.integral * error * self.period)
        self._command = allowed
        return allowed, cut

    def _allowed(self, wanted: Floats, q: Floats) -> Floats:
        speed, change = self.motors.max_velocity, self.acceleration * self.period
        command = np.clip(wanted, -speed, speed)
        command = np.clip(command, self._command - change, self._command + change)
        # Last, since a joint had better brake too hard than leave its range.
        return np.clip(command, -self._brakes_before(q - self.motors.lower), self._brakes_before(self.motors.upper - q))

    def _brakes_before(self, room: Floats) -> Floats:
        """Speeds from which braking ends within the room left (n,); 0 beyond a range, where only the way back is open.

        A cycle at u and braking after it cover u T / 2 + u² / 2a.
        """
        room, half = np.maximum(room, 0.0), 0.5 * self.period
        with np.errstate(invalid="ignore"):
            speed = np.sqrt((self.acceleration * half) ** 2 + 2.0 * self.acceleration * room) - self.acceleration * half
        endless = np.isinf(room) | np.isinf(self.acceleration)
        return np.where(endless, np.where(np.isinf(room), np.inf, room / self.period), speed)


@dataclass(frozen=True, eq=False, slots=True)
class ServoRun:
    """What a run of a servo along a reference was, one row a control period.

    Attributes:
        joint_names: Names of the motors, one a column.
        times: (N,) [s].
        reference: Where the motors should have been (N, n) [rad or m].
        q: Where they were (N, n).
        velocity: Their speeds (N, n) [rad/s or m/s].
        command: The commanded speeds (N, n); the last row is not executed.
        effort: What they pushed with (N, n) [N m or N]; 0 for a plant without efforts.
        cut: Where a command was cut to a limit (N, n).
        effort_cut: Where an effort was cut to its limit (N, n).
    """

    joint_names: tuple[str, ...]
    times: Floats
    reference: Floats
    q: Floats
    velocity: Floats
    command: Floats
    effort: Floats
    cut: NDArray[np.bool_]
    effort_cut: NDArray[np.bool_]

    @property
    def errors(self) -> Floats:
        """Reference minus measured position (N, n) [rad or m]."""
        return self.reference - self.q

    @property
    def rms_error(self) -> float:
        """Root of the mean square of all errors of the motors that the reference moves [rad or m]."""
        moved = np.ptp(self.reference, axis=0) > 0.0
        return float(np.sqrt((self.errors[:, moved] ** 2).mean())) if moved.any() else 0.0

    @property
    def largest_error(self) -> float:
        """Largest error of any motor at any time [rad or m]."""
        return float(np.abs(self.errors).max())

    @property
    def trajectory(self) -> Trajectory:
        """The measured motion."""
        return Trajectory(self.joint_names, self.times, self.q, "measured")


def run_servo(
    plant: Plant,
    reference: Trajectory,
    gains: Gains,
    *,
    hold: Mapping[str, float] | None = None,
    period: float = PRACTICUM_PERIOD,
    acceleration: ArrayLike = np.inf,
    settle: float = 0.0,
) -> ServoRun:
    """Drives a plant along a reference, starting at rest on it.

    Args:
        plant: What is driven.
        reference: Where some or all motors should be over time.
        gains: The servo's gains.
        hold: Values of motors that the reference does not name [rad or m]; neutral by default.
        period: Control period [s].
        acceleration: Greatest change of a commanded speed a second.
        settle: How long to hold the end of the reference [s].

    Raises:
        InvalidInputError, UnknownNameError: Names that are no motors of the plant, or numbers that do not fit.
    """
    servo = Servo(plant.motors, gains, period=period, acceleration=acceleration)
    times, wanted = reference_samples(plant.motors, reference, hold, period, settle)
    speeds = np.vstack([np.diff(wanted, axis=0) / period, np.zeros((1, wanted.shape[1]))])
    state = plant.at_rest(wanted[0])
    states, commands, cuts = [], [], []
    for row, speed in zip(wanted, speeds, strict=True):
        command, cut = servo.command(row, speed, state.q)
        states.append(state)
        commands.append(command)
        cuts.append(cut)
        state = plant.advance(state, command, period)
    columns = zip(*((s.q, s.velocity, s.effort, s.at_limit) for s in states), strict=True)
    q, velocity, effort, effort_cut = (np.array(column) for column in columns)
    names = plant.motors.joint_names
    return ServoRun(names, times, wanted, q, velocity, np.array(commands), effort, np.array(cuts), effort_cut)


def reference_samples(
    motors: Motors, reference: Trajectory, hold: Mapping[str, float] | None, period: float, settle: float
) -> tuple[Floats, Floats]:
    """Instants (N,) [s] a period apart and all motors' values (N, n) at them.

    Raises:
        InvalidInputError, UnknownNameError: See `run_servo`.
    """
    still = neutral(motors) if hold is None else motors.q_of(hold)
    rest = finite(settle, "settle", "[s]")
    if rest < 0.0:
        raise InvalidInputError("settle", "a number ≥ 0 [s]", f"{rest:g}")
    periods = (reference.duration + rest) / positive(period, "period", "[s]")
    if not periods < LARGEST_COUNT:
        raise InvalidInputError("period", f"at most {LARGEST_COUNT} control periods", f"{periods:.3g}")
    count = int(np.ceil(periods - 1e-9)) + 1
    times = reference.times[0] + period * np.arange(count)
    wanted = np.tile(vector(still, "hold", len(motors.joints)), (count, 1))
    for name, column in zip(reference.joint_names, reference.q.T, strict=True):
        wanted[:, motors.index(name)] = np.interp(times, reference.times, column)
    return frozen(times), frozen(wanted)


_LADDER: Final = tuple(float(kp) for kp in np.geomspace(1.0, 100.0, 25))  # [1/s]
_STEP: Final = 0.01  # [rad or m] small enough to meet no limit on speed or effort
_LONGEST: Final = 20.0  # [s] after the step
_SETTLED: Final = 0.005  # of the step, and of the step a second
P_OVERSHOOT: Final = 0.01
"""Share of a step by which a P servo may overshoot it."""


def overshoot(plant: Plant, gains: Gains, q: Floats, period: float = PRACTICUM_PERIOD) -> float:
    """By how much of a small step of all motors the worst of them overshoots it, feed-forward off.

    Args:
        plant: What is driven.
        gains: The gains.
        q: Motor values (n,) at which the step is made, away from the ends of the ranges.
        period: Control period [s].
    """
    servo = Servo(plant.motors, replace(gains, feed_forward=False), period=period)
    inwards = np.where(plant.motors.upper - q > q - plant.motors.lower, _STEP, -_STEP)
    state, still, farthest = plant.at_rest(q), np.zeros_like(q), -np.inf
    for _ in range(round(_LONGEST / period)):
        command, _ = servo.command(q + inwards, still, state.q)
        state = plant.advance(state, command, period)
        farthest = max(farthest, float(((state.q - q) / inwards).max()))
        unstable = not farthest < 2.0
        left = np.abs(q + inwards - state.q).max()
        if unstable or max(left, np.abs(state.velocity).max()) < _SETTLED * _STEP:
            break
    return farthest - 1.0


def tune(
    plant: Plant,
    reference: Trajectory,
    *,
    hold: Mapping[str, float] | None = None,
    period: float = PRACTICUM_PERIOD,
    integral_times: Iterable[float] = (),
    allowed: float = P_OVERSHOOT,
) -> Gains:
    """The gains of the module's rule: for a P servo, or for a PI servo if integral times are given.

    Args:
        plant: What is driven.
        reference: What it should follow.
        hold: Values of motors that the reference does not name.
        period: Control period [s].
        integral_times: Values of kp / ki [s] to try; none for a P servo.
        allowed: Share of a step that the answer may overshoot by.

    Raises:
        InvalidInputError: Every gain of the ladder overshoots by more.
    """
    q = reference_samples(plant.motors, reference, hold, period, 0.0)[1][0]
    ladder = [Gains(kp, kp / t) for kp in _LADDER for t in integral_times] or [Gains(kp) for kp in _LADDER]
    steady = [gains for gains in ladder if overshoot(plant, gains, q, period) <= allowed]
    if not steady:
        raise InvalidInputError("allowed overshoot", "one that some gain keeps", f"{allowed:g}")
    errors = [run_servo(plant, reference, gains, hold=hold, period=period).rms_error for gains in steady]
    return steady[int(np.argmin(errors))]


@dataclass(frozen=True, eq=False, slots=True)
class FeedForwardComparison:
    """Two runs with the same gains.

    Attributes:
        gains: The gains, tuned for the run without feed-forward.
        without: The run without.
        with_it: The run with velocity feed-forward.
    """

    gains: Gains
    without: ServoRun
    with_it: ServoRun

    @property
    def rms_ratio(self) -> float:
        """How many times smaller the RMS error is with feed-forward."""
        return self.without.rms_error / self.with_it.rms_error

    @property
    def largest_ratio(self) -> float:
        """How many times smaller the largest error is with feed-forward."""
        return self.without.largest_error / self.with_it.largest_error


def compare_feed_forward(plant: Plant, reference: Trajectory, gains: Gains, **options: Any) -> FeedForwardComparison:
    """The same run without and with velocity feed-forward; options are those of `run_servo`.

    Raises:
        InvalidInputError, UnknownNameError: See `run_servo`.
    """
    runs = [run_servo(plant, reference, replace(gains, feed_forward=on), **options) for on in (False, True)]
    return FeedForwardComparison(replace(gains, feed_forward=False), *runs)
