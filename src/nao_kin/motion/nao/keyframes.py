"""A player of keyframes: named postures at instants become a motion of all joints, checked before it is handed out.

* ``cubic``: one curve through all keyframes, twice continuously differentiable, at rest at both ends: the clamped cubic
  spline, of all such curves the one with the least integral of squared acceleration. It may swing beyond the postures
  between keyframes.
* ``stop``: at rest at every keyframe, all joints starting and arriving together on a minimum-jerk profile (Flash and
  Hogan 1985), which never leaves the two postures it runs between.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NoReturn

import numpy as np

from nao_kin.arrays import frozen
from nao_kin.errors import InvalidInputError
from nao_kin.motion.feasible import Attempted, Refusal, refusals, said
from nao_kin.motion.loop.profile import PEAK, minimum_jerk
from nao_kin.robot.motors import Motors
from nao_kin.table import Column, Table
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.arrays import Floats
    from nao_kin.chain import ChainJoint
    from nao_kin.motion.nao.keyframe_file import Keyframes

__all__ = ["Played", "play"]

_MOST_SAMPLES: Final = 200_000
_ROUND_UP: Final = 1.0 + 1e-12  # what is stretched to a joint's greatest speed must not round beyond it


@dataclass(frozen=True, eq=False, slots=True)
class Played(Attempted):
    """A motion through keyframes.

    Attributes:
        keyframes: What was asked for.
        attempt: What the joints would do: every joint of the robot that has a motor; keyframes are among the samples.
        times: When each posture is taken (k,) [s], the start posture first where it is not a keyframe itself.
        asked: When the file wants it (k,) [s].
        refused: What of it cannot be done.
    """

    keyframes: Keyframes
    attempt: Trajectory
    times: Floats
    asked: Floats
    refused: tuple[Refusal, ...]

    @property
    def message(self) -> str:
        """For people: how long it takes, or why it is refused and what to do."""
        if not self.refused:
            slowed = f", slowed down from {self.asked[-1]:.3f} s" if self.times[-1] > self.asked[-1] else ""
            return f"It takes {self.times[-1]:.3f} s{slowed}, within all limits."
        remedies = []
        if any(refusal.reason == "too fast" for refusal in self.refused):
            remedies.append("more time, or too_fast = 'slow', would do for what is too fast")
        if self.keyframes.between == "cubic" and any("range" in refusal.reason for refusal in self.refused):
            remedies.append("between = 'stop' does not swing beyond the postures")
        hint = f" Hint: {'; '.join(remedies)}." if remedies else ""
        return f"It cannot be played: {said(self.refused)}{hint}"

    def table(self) -> Table:
        """One row a keyframe: the posture, when it is asked for and taken, and what moves most on the way to it."""
        names = [key.posture for key in self.keyframes.keys]
        rows = []
        for k, name in enumerate([""] * (len(self.times) - len(names)) + names):
            sample = int(np.argmin(np.abs(self.attempt.times - self.times[k])))
            since = int(np.argmin(np.abs(self.attempt.times - self.times[max(k - 1, 0)])))
            move = np.abs(self.attempt.q[sample] - self.attempt.q[since])
            most = f"{self.attempt.joint_names[int(move.argmax())]} {move.max():.3f}" if move.any() else ""
            rows.append((name or "(start)", f"{self.asked[k]:.3f}", f"{self.times[k]:.3f}", most))
        columns = (
            Column("posture"),
            Column("asked [s]", True),
            Column("taken [s]", True),
            Column("largest move [rad, m]"),
        )
        title = f"{self.keyframes.name or 'keyframes'}: {self.keyframes.robot.name}, {self.keyframes.between}"
        return Table(columns, tuple(rows), title=title)

    def __bool__(self) -> NoReturn:
        raise TypeError("A Played is not a truth value: ask whether played.trajectory is None.")

    def __repr__(self) -> str:
        return f"<Played {self.keyframes.name}: {self.message}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def play(keyframes: Keyframes, start: Mapping[str, float] | None = None) -> Played:
    """The motion through keyframes, sampled and held against ranges, coupled ranges and speeds.

    Args:
        keyframes: What `nao_kin.motion.nao.keyframe_file.read_keyframes` returned.
        start: The posture at time 0, where the first keyframe comes later, and the values of joints that no posture has
            named yet; what it does not name is at its neutral value.

    Raises:
        UnknownNameError, InvalidInputError: A start posture that the robot does not have, or too many samples.
    """
    robot, joints = keyframes.robot, Motors.of(keyframes.robot).joints
    asked, Q = _knots(keyframes, joints, start)
    speeds = np.array([joint.max_velocity or np.inf for joint in joints])  # no time would be long enough for 0
    times = asked
    if keyframes.between == "stop":
        if keyframes.too_fast == "slow" and len(asked) > 1:
            needed = PEAK * _ROUND_UP * (np.abs(np.diff(Q, axis=0)) / speeds).max(axis=1)
            times = np.concatenate([asked[:1], asked[0] + np.cumsum(np.maximum(np.diff(asked), needed))])
        instants = _instants(times, keyframes.sample_time)
        q = _stopping(times, Q, instants)
    else:
        rates = _spline_rates(asked, Q)
        if keyframes.too_fast == "slow":
            stretch = max(1.0, _ROUND_UP * float((_peaks(asked, Q, rates) / speeds).max(initial=0.0)))
            times, rates = asked * stretch, rates / stretch
        instants = _instants(times, keyframes.sample_time)
        q = _cubic(times, Q, rates, instants)
    attempt = Trajectory(joints, instants, q, keyframes.name)
    return Played(keyframes, attempt, frozen(times.copy()), frozen(asked), refusals(attempt, robot.limit_rules))


def _knots(
    keyframes: Keyframes, joints: tuple[ChainJoint, ...], start: Mapping[str, float] | None
) -> tuple[Floats, Floats]:
    """Times (k,) and postures (k, n) of all motors; a start posture at 0 where the first keyframe comes later."""
    robot, names = keyframes.robot, [joint.name for joint in joints]
    motor = {c.follower: c.leader for c in robot.couplings}
    now = robot.complete(start or {})
    rows, times = [], []
    if keyframes.keys[0].time > 0.0:
        rows.append([now[name] for name in names])
        times.append(0.0)
    for key in keyframes.keys:
        posture = keyframes.postures[key.posture]
        expanded = robot.expand(posture)
        now |= {leader: expanded[leader] for leader in (motor.get(name, name) for name in posture)}
        rows.append([now[name] for name in names])
        times.append(key.time)
    return np.array(times), np.array(rows)


def _instants(times: Floats, step: float) -> Floats:
    """Every multiple of the step, and every keyframe in place of the multiples that are next to it."""
    count = (times[-1] - times[0]) / step
    if count > _MOST_SAMPLES:
        raise InvalidInputError("keyframes", f"at most {_MOST_SAMPLES} samples", f"{count:.0f} of {step:g} s")
    grid = times[0] + step * np.arange(1, int(count) + 1)
    before = np.searchsorted(times, grid, side="right") - 1
    next_to = np.minimum(grid - times[before], np.abs(times[np.minimum(before + 1, len(times) - 1)] - grid))
    return np.sort(np.concatenate([times, grid[next_to > 0.1 * step]]))


def _segments(times: Floats, instants: Floats) -> tuple[np.ndarray, Floats, Floats]:
    """Number of the segment of each instant, the share of it that is over, and its length [s]."""
    if len(times) == 1:
        return np.zeros(len(instants), dtype=int), np.zeros(len(instants)), np.ones(len(instants))
    k = np.clip(np.searchsorted(times, instants, side="right") - 1, 0, len(times) - 2)
    length = times[k + 1] - times[k]
    return k, (instants - times[k]) / length, length


def _stopping(times: Floats, Q: Floats, instants: Floats) -> Floats:
    k, u, _ = _segments(times, instants)
    after = np.minimum(k + 1, len(Q) - 1)
    return np.asarray(Q[k] + minimum_jerk(u)[:, None] * (Q[after] - Q[k]))


def _spline_rates(times: Floats, Q: Floats) -> Floats:
    """Speeds (k, n) at the knots of the cubic spline that is at rest at both ends: second derivatives are equal."""
    rates = np.zeros_like(Q)
    if len(times) > 2:
        h = np.diff(times)
        slopes = np.diff(Q, axis=0) / h[:, None]
        left, right = h[1:], h[:-1]
        matrix = np.diag(2.0 * (left + right)) + np.diag(left[1:], -1) + np.diag(right[:-1], 1)
        rates[1:-1] = np.linalg.solve(matrix, 3.0 * (left[:, None] * slopes[:-1] + right[:, None] * slopes[1:]))
    return rates


def _cubic(times: Floats, Q: Floats, rates: Floats, instants: Floats) -> Floats:
    """The curve with these values and speeds at the knots, by Hermite's basis."""
    k, u, length = _segments(times, instants)
    after, u, length = np.minimum(k + 1, len(Q) - 1), u[:, None], length[:, None]
    rest = (1.0 - u) ** 2 * u * length * rates[k] - u**2 * (1.0 - u) * length * rates[after]
    return np.asarray(Q[k] + u**2 * (3.0 - 2.0 * u) * (Q[after] - Q[k]) + rest)


def _peaks(times: Floats, Q: Floats, rates: Floats) -> Floats:
    """Greatest speed of every joint anywhere on the curve (n,): at a knot, or at the top of a parabola between two."""
    if len(times) == 1:
        return np.zeros(Q.shape[1])
    h = np.diff(times)[:, None]
    start, end, mean = rates[:-1], rates[1:], np.diff(Q, axis=0) / h
    # The speed is start (1 − u) + end u + 6 (mean − (start + end) / 2) u (1 − u).
    bulge = 6.0 * mean - 3.0 * (start + end)
    with np.errstate(divide="ignore", invalid="ignore"):
        top = np.clip(np.nan_to_num(0.5 + (end - start) / (2.0 * bulge), nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    at_top = start * (1.0 - top) + end * top + bulge * top * (1.0 - top)
    return np.asarray(np.maximum(np.abs(at_top), np.maximum(np.abs(start), np.abs(end))).max(axis=0))
