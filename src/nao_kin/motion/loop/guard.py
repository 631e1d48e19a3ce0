"""Moving towards targets without touching anything: every step taken leaves room to brake.

Each cycle the guard proposes a step towards the target within the limits on speed and acceleration. It takes the step
only if the step and the braking after it, one straight line in joint space, are proven to keep clear and within all
limits. Else it brakes on the line that was proven the cycle before. So there is always a proven way to stand still, by
induction from the start.

Braking scales all speeds alike, so that it stays on the line: from speeds v it takes n = max ⌈|v_j| / (a_j Δt)⌉ cycles
and covers v Δt (n − 1) / 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import Floats, positive, vector
from nao_kin.chain import configuration, outside_limits
from nao_kin.collision import DISTANCE_ACCURACY
from nao_kin.errors import InvalidInputError
from nao_kin.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.chain import LimitRule, OutsideLimit
    from nao_kin.collision import CollisionModel

__all__ = ["NAO_PERIOD", "Clearance", "Guard", "Guarded"]

NAO_PERIOD: Final = 0.012
"""Cycle of NAO's own control loop, 83 Hz [s] (NAOqi 2.8 documentation, LoLA)."""


@dataclass(frozen=True, eq=False, slots=True)
class Guarded:
    """What the guard commands for one cycle.

    Attributes:
        q: Where the motors are to be at the end of the cycle (n,) [rad or m].
        velocity: Their speeds during it (n,) [rad/s or m/s].
        blocked_by: Why the step towards the target was not taken, in words; empty if it was.
    """

    q: Floats
    velocity: Floats
    blocked_by: str = ""

    @property
    def at_rest(self) -> bool:
        """Whether nothing moves."""
        return not self.velocity.any()


class Guard:
    """Steps towards targets, stopping before bodies come near each other or a joint its limits.

    The promise is about the commanded motion: no point of it is nearer to contact than half the model's margin, and a
    straight move from rest that keeps the margin is never stopped. How far a motor may lag behind its command has to be
    part of the margin. It stops at each target unless a new one comes, so a stream of close targets is followed with a
    lag of the braking distance.

    Args:
        collisions: The bodies to keep apart, with a margin of at least 1 mm.
        start: Motor values (n,) to start from at rest, in the order of `collisions.motors`.
        period: Cycle [s].
        velocity: Greatest speeds (n,) [rad/s or m/s]; the file's by default.
        acceleration: Greatest accelerations (n,) [rad/s² or m/s²], also for braking. By default each motor brakes from
            its greatest speed within `braking_time`.
        braking_time: See there [s].

    Raises:
        InvalidInputError: A start outside the limits or too near to contact, a motor without a greatest speed, or
            limits that are not above 0.
    """

    def __init__(
        self,
        collisions: CollisionModel,
        start: ArrayLike,
        *,
        period: float = NAO_PERIOD,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        braking_time: float = 0.2,
    ) -> None:
        self.motors, self.clearance = collisions.motors, Clearance(collisions)
        self.period = positive(period, "period", "[s]")
        n = len(self.motors.joints)
        self.max_velocity = self._speeds(velocity, n)
        if acceleration is None:
            self.max_acceleration = self.max_velocity / positive(braking_time, "braking_time", "[s]")
        else:
            self.max_acceleration = _above_zero(vector(acceleration, "acceleration", n), "acceleration")
        self.q, self.velocity = self.checked(start, "start"), np.zeros(n)
        nearest = self.clearance.obstacle(self.q, self.q)
        if nearest is not None:
            expected = f"bodies more than {self.clearance.floor:g} m apart"
            raise InvalidInputError("start", expected, f"{nearest[0]} and {nearest[1]} nearer")

    def checked(self, target: ArrayLike, what: str = "target") -> Floats:
        """A target within all limits, as a copy.

        Raises:
            InvalidInputError: Wrong length, not finite, or a joint outside its own or its coupled range, by name.
        """
        q = configuration(self.motors, target)
        outside = outside_limits(self.motors, q, TOLERANCES.limits)
        if outside:
            raise InvalidInputError(what, "joints within their limits", "; ".join(map(str, outside)))
        return q

    def step(self, target: Floats) -> Guarded:
        """Moves on by one cycle.

        Args:
            target: Motor values (n,) to go to, as `checked` gives them.
        """
        velocity = self._towards(target)
        blocked = self._obstacle(velocity)
        if blocked:
            velocity = self._braked()
        self.q, self.velocity = self.q + velocity * self.period, velocity
        return Guarded(self.q.copy(), velocity.copy(), blocked)

    def _towards(self, target: Floats) -> Floats:
        """Speeds for this cycle: towards the target as fast as may be, so that braking ends at it."""
        way = target - self.q
        wanted = way * self._pace(way)
        change = wanted - self.velocity
        # All speeds change by the same share of what they want to, so a straight move stays straight.
        excess = float((np.abs(change) / (self.max_acceleration * self.period)).max())
        return self.velocity + change / max(1.0, excess)

    def _pace(self, way: Floats) -> float:
        """Shares of the way to go a second, such that braking from there ends at its end.

        A pace w that takes n cycles to brake, w ≤ n a Δt, covers w Δt (n + 1) / 2 with the cycle before, at most all.
        """
        size = np.abs(way)
        if not size.any():
            return 0.0
        with np.errstate(divide="ignore"):  # a joint that has arrived sets no limit
            fastest = float((self.max_velocity / size).min())
            braking = float((self.max_acceleration / size).min())
        if not math.isfinite(braking * self.period**2):  # the way is shorter than numbers are apart
            return min(fastest, 1.0 / self.period)
        n = math.floor(0.5 * (math.sqrt(1.0 + 8.0 / (braking * self.period**2)) - 1.0))
        stopping = max(n * braking * self.period, 2.0 / (self.period * (n + 2)))
        return min(fastest, stopping)

    def _braked(self) -> Floats:
        """Speeds one cycle of braking later."""
        cycles = self._braking_cycles(self.velocity)
        return self.velocity * (1.0 - 1.0 / cycles) if cycles else self.velocity

    def _braking_cycles(self, velocity: Floats) -> int:
        cycles = float((np.abs(velocity) / (self.max_acceleration * self.period)).max())
        return math.ceil(cycles - 1e-9)  # a whole number of cycles stays one when it is rounded up

    def _obstacle(self, velocity: Floats) -> str:
        """Why a cycle at these speeds and braking after it are not safe; empty if they are."""
        travel = velocity * self.period
        end = self.q + travel * (1.0 + 0.5 * max(self._braking_cycles(velocity) - 1, 0))
        for point in self._limit_points(self.q, end):
            outside: tuple[OutsideLimit, ...] = outside_limits(self.motors, point, TOLERANCES.limits)
            if outside:
                return str(outside[0])
        near = self.clearance.obstacle(self.q, end)
        return "" if near is None else f"{near[0]} and {near[1]}"

    def _limit_points(self, start: Floats, end: Floats) -> Iterator[Floats]:
        """The postures of a straight move where a limit is broken first, if any is: its end and the tables' corners."""
        for rule in self.motors.limit_rules:
            by = self.motors.index(rule.by)
            for corner in _corners(rule):
                if min(start[by], end[by]) < corner < max(start[by], end[by]):
                    yield start + (corner - start[by]) / (end[by] - start[by]) * (end - start)
        yield end

    def _speeds(self, velocity: ArrayLike | None, n: int) -> Floats:
        if velocity is not None:
            return _above_zero(vector(velocity, "velocity", n), "velocity")
        for joint in self.motors.joints:
            if not 0.0 < joint.max_velocity < math.inf:
                raise InvalidInputError("velocity", f"a greatest speed of {joint.name}", "none in the file")
        return self.motors.max_velocity.copy()


def _corners(rule: LimitRule) -> set[float]:
    """Where the range of a coupled limit bends."""
    return {sign * at for at in rule.at for sign in ((1.0, -1.0) if rule.even else (1.0,))} | {0.0}


def _above_zero(values: Floats, what: str) -> Floats:
    if not (values > 0.0).all():
        raise InvalidInputError(what, "numbers > 0", str(float(values.min())))
    return values


_LEAST_MARGIN: Final = 100.0 * DISTANCE_ACCURACY


class Clearance:
    """Proves that straight joint moves keep a clearance, remembering distances from one move to the next.

    What it lets pass keeps at least `floor`, half the model's margin; what keeps the margin is let pass.

    Args:
        collisions: The bodies, and the margin.

    Raises:
        InvalidInputError: A margin below 1 mm, or a prismatic joint without limits, whose reach is endless.
    """

    def __init__(self, collisions: CollisionModel) -> None:
        if collisions.margin < _LEAST_MARGIN:
            got = f"{collisions.margin:g} m"
            raise InvalidInputError("margin of the collision model", f"at least {_LEAST_MARGIN:g} m", got)
        self.collisions, self.levers = collisions, collisions.levers
        if not np.isfinite(self.levers).all():
            joint = collisions.motors.joint_names[int(np.argwhere(~np.isfinite(self.levers))[0, 1])]
            raise InvalidInputError("joints", "limits on every prismatic joint", f"none above or at {joint}")
        self.floor = 0.5 * collisions.margin
        # A move this short that fails has an end nearer than the margin, whatever coal's distances are off by.
        self._shortest = 2.0 * (collisions.margin - self.floor - 2.0 * DISTANCE_ACCURACY)
        pairs, motors = self.levers.shape
        self._seen_at, self._seen = np.zeros((pairs, motors)), np.full(pairs, -np.inf)

    def obstacle(self, start: Floats, end: Floats) -> tuple[str, str] | None:
        """The bodies that may come nearer than the margin on the way from one posture to another; None if none do.

        Args:
            start: Motor values (n,) that the move starts from.
            end: Motor values (n,) that it ends at, every joint in a straight line and at its own constant share.
        """
        doubtful = self._unproven(start, end)
        if not len(doubtful):
            return None
        self._look(start, doubtful)
        doubtful = doubtful[np.isin(doubtful, self._unproven(start, end))]
        if not len(doubtful):
            return None
        at_start = self._seen[doubtful]
        pair = self._nearest(start, end, at_start, self._measured(end, doubtful), doubtful)
        return None if pair is None else self.collisions.owners(pair)

    def _unproven(self, start: Floats, end: Floats) -> NDArray[np.intp]:
        """The pairs that what was measured last does not prove to be clear: it holds less and less with the way."""
        ways = [np.einsum("pn,pn->p", self.levers, np.abs(q - self._seen_at)) for q in (start, end)]
        # The way from where it was measured is a convex function along the move, so it is greatest at an end.
        return np.flatnonzero(self._seen - DISTANCE_ACCURACY - np.maximum(*ways) < self.floor)

    def _look(self, q: Floats, pairs: NDArray[np.intp]) -> None:
        self._seen[pairs], self._seen_at[pairs] = self._measured(q, pairs), q

    def _measured(self, q: Floats, pairs: NDArray[np.intp]) -> Floats:
        return self.collisions.measure(q, pairs.tolist())

    def _nearest(self, a: Floats, b: Floats, at_a: Floats, at_b: Floats, pairs: NDArray[np.intp]) -> int | None:
        """A pair that is not proven to be clear between two postures at which its distances are known [m]."""
        least = self.floor + DISTANCE_ACCURACY
        near = np.minimum(at_a, at_b) < least
        if near.any():
            return int(pairs[near][0])
        way = self.levers[pairs] @ np.abs(b - a)
        doubtful = 0.5 * (at_a + at_b - way) < least
        hopeless = doubtful & (way <= self._shortest)
        if hopeless.any():
            return int(pairs[hopeless][0])
        if not doubtful.any():
            return None
        rest, middle = pairs[doubtful], 0.5 * (a + b)
        at_middle = self._measured(middle, rest)
        first = self._nearest(a, middle, at_a[doubtful], at_middle, rest)
        return first if first is not None else self._nearest(middle, b, at_middle, at_b[doubtful], rest)
