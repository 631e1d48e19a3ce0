"""A loop in step with NAO's own cycle: targets come from a peer, the guard makes them safe, a drive carries them out.

The newest valid command counts, older ones are passed over. A cycle in which none came in time is a missed deadline:
the last accepted target is held, and the guard brings the robot to rest at it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol, TypeAlias

from nao_kin.errors import NaoKinError
from nao_kin.motion.loop.messages import Message, target_of
from nao_kin.motion.loop.servo import Gains, Servo

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.motion.loop.guard import Guard
    from nao_kin.motion.loop.plants import Plant, PlantState
    from nao_kin.motion.loop.transports import Transport

__all__ = [
    "Clock",
    "Cycle",
    "Drive",
    "MonotonicClock",
    "SimulatedDrive",
    "StreamLoop",
    "StreamState",
    "StreamStatistics",
]

StreamState: TypeAlias = Literal["waiting", "following", "holding", "blocked"]
"""No command yet; a command came in time; none did; the guard does not go on towards the target."""


class Clock(Protocol):
    """Time, so that tests can have their own."""

    def now(self) -> float:
        """Seconds since some instant."""

    def sleep_until(self, instant: float) -> None:
        """Comes back at an instant, or at once if it has passed."""


class MonotonicClock:
    """The machine's own clock."""

    def now(self) -> float:
        """See `Clock`."""
        return time.monotonic()

    def sleep_until(self, instant: float) -> None:
        """See `Clock`."""
        left = instant - time.monotonic()
        if left > 0.0:
            time.sleep(left)


class Drive(Protocol):
    """What carries out what the guard commands: a simulated robot, or the way to a real one."""

    def follow(self, q: Floats, velocity: Floats) -> tuple[Floats, Floats]:
        """Goes to motor values (n,) within a cycle, at speeds (n,); measured values and speeds come back."""


class SimulatedDrive:
    """A servo and a plant in the place of a robot, at rest at the start.

    Args:
        plant: What the servo drives.
        gains: The servo's gains.
        start: Motor values (n,).
        period: Cycle [s].
    """

    def __init__(self, plant: Plant, gains: Gains, start: Floats, period: float) -> None:
        self._plant, self._servo, self._period = plant, Servo(plant.motors, gains, period=period), period
        self._last = start.copy()
        self.state: PlantState = plant.at_rest(start)

    def follow(self, q: Floats, velocity: Floats) -> tuple[Floats, Floats]:
        """See `Drive`; the servo's error is taken at the beginning of the cycle."""
        command, _ = self._servo.command(self._last, velocity, self.state.q)
        self.state, self._last = self._plant.advance(self.state, command, self._period), q.copy()
        return self.state.q.copy(), self.state.velocity.copy()


@dataclass(slots=True)
class StreamStatistics:
    """Counts of a loop so far.

    Attributes:
        cycles: Cycles carried out.
        met: Cycles for which a valid command came in time.
        missed: Cycles for which none did, from the first command on.
        passed_over: Valid commands that a newer one replaced within the same cycle.
        refused: Messages that were refused.
        skipped: Cycles that the loop itself came too late for; nothing moves in them.
        worst_lateness: Longest time from a cycle's due start to its start [s].
        last_refusal: Why a message was refused last; empty if none was.
    """

    cycles: int = 0
    met: int = 0
    missed: int = 0
    passed_over: int = 0
    refused: int = 0
    skipped: int = 0
    worst_lateness: float = 0.0
    last_refusal: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Cycle:
    """One cycle of a loop.

    Attributes:
        number: Its number, from 0; skipped cycles have one too.
        state: What the loop did.
        target: The target that holds (n,) [rad or m].
        q: What was commanded (n,).
        measured: What the drive measured (n,).
        blocked_by: Why the guard did not go on, in words; empty if it did.
    """

    number: int
    state: StreamState
    target: Floats
    q: Floats
    measured: Floats
    blocked_by: str = ""


class StreamLoop:
    """Receives, guards, drives and answers, once a cycle.

    Args:
        guard: Holds period, limits and the posture commanded last.
        transport: Where commands come from and measurements go to.
        drive: What carries out the motion; by default it is believed to be where it was commanded to.
        clock: Time.
    """

    def __init__(
        self, guard: Guard, transport: Transport, drive: Drive | None = None, clock: Clock | None = None
    ) -> None:
        self.guard, self.transport, self.drive = guard, transport, drive
        self.clock: Clock = MonotonicClock() if clock is None else clock
        self.statistics, self.target = StreamStatistics(), guard.q.copy()
        self._start: float | None = None
        self._next = 0
        self._commanded = False

    def run(self, cycles: int) -> StreamStatistics:
        """Carries out that many cycles, each at its time."""
        for _ in range(cycles):
            self.cycle()
        return self.statistics

    def cycle(self) -> Cycle:
        """Waits for the next cycle's time and carries it out."""
        number = self._wait()
        fresh = self._take_commands()
        done = self.guard.step(self.target)
        measured, speeds = (done.q, done.velocity) if self.drive is None else self.drive.follow(done.q, done.velocity)
        state = self._judge(fresh, blocked=bool(done.blocked_by))
        self.transport.send(self._measurements(number, state, measured, speeds, done.blocked_by))
        return Cycle(number, state, self.target.copy(), done.q, measured, done.blocked_by)

    def _wait(self) -> int:
        """Waits for the next cycle and gives its number. Cycles that are over are skipped, never caught up with."""
        period = self.guard.period
        if self._start is None:
            self._start = self.clock.now()
        self.clock.sleep_until(self._start + self._next * period)
        lateness = max(0.0, self.clock.now() - self._start - self._next * period)
        over = int(lateness / period)
        self.statistics.worst_lateness = max(self.statistics.worst_lateness, lateness)
        self.statistics.skipped += over
        self.statistics.cycles += 1
        number = self._next + over
        self._next = number + 1
        return number

    def _take_commands(self) -> bool:
        """Takes over the newest valid command, each read on top of the one before; whether there was any."""
        received, valid = self.transport.receive(), 0
        for reason in received.refused:
            self._refuse(reason)
        for message in received.messages:
            try:
                self.target = self.guard.checked(target_of(message, self.guard.motors, self.target))
            except NaoKinError as error:
                self._refuse(str(error))
            else:
                valid += 1
        self.statistics.passed_over += max(0, valid - 1)
        return valid > 0

    def _refuse(self, reason: str) -> None:
        self.statistics.refused += 1
        self.statistics.last_refusal = reason

    def _judge(self, fresh: bool, *, blocked: bool) -> StreamState:
        if fresh:
            self._commanded = True
            self.statistics.met += 1
        elif self._commanded:
            self.statistics.missed += 1
        if blocked:
            return "blocked"
        if not self._commanded:
            return "waiting"
        return "following" if fresh else "holding"

    def _measurements(self, number: int, state: StreamState, q: Floats, velocity: Floats, blocked_by: str) -> Message:
        names = self.guard.motors.joint_names
        return {
            "cycle": number,
            "time": number * self.guard.period,
            "state": state,
            "position": dict(zip(names, q.tolist(), strict=True)),
            "velocity": dict(zip(names, velocity.tolist(), strict=True)),
            "missed": self.statistics.missed,
            "refused": self.statistics.refused,
            "blocked_by": blocked_by,
            "last_refusal": self.statistics.last_refusal[:500],
        }
