"""Whether a robot can do a motion, and what of it not: joint ranges, coupled ranges and joint speeds.

A motion that cannot be done is no error: it comes back with its refusals and without a trajectory.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import LimitRule
    from nao_kin.trajectory import Trajectory

__all__ = ["Attempted", "Reason", "Refusal", "refusal_where", "refusals", "said"]

Reason: TypeAlias = Literal[
    "below its range",
    "above its range",
    "too fast",
    "too far",
    "too near",
    "out of balance",
    "off its place",
    "off its aim",
]

_ROUNDING = 1e-12  # relative: a motion stretched until a joint moves at its greatest speed may round beyond it


@dataclass(frozen=True, slots=True)
class Refusal:
    """One thing that a motion asks for and the robot cannot do.

    Attributes:
        what: The joint, or the leg or foot that misses its place, or the body.
        reason: What is wrong.
        time: When it begins [s], counted as the trajectory's times are.
        amount: How much is too much at the worst instant, in `unit`.
        unit: ``"rad"``, ``"m"``, ``"rad/s"`` or ``"m/s"``.
        worst: The worst instant [s].
    """

    what: str
    reason: Reason
    time: float
    amount: float
    unit: str
    worst: float

    def __str__(self) -> str:
        since = f"from {self.time:.3f} s on, worst at {self.worst:.3f} s"
        return f"{self.what} is {self.reason} by {self.amount:.3g} {self.unit} {since}"


class Attempted:
    """A motion that was worked out and measured: its ``attempt``, and what of it the robot cannot do, ``refused``."""

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def attempt(self) -> Trajectory:
            """What the joints would do."""

        @property
        def refused(self) -> tuple[Refusal, ...]:
            """What of it cannot be done."""

    @property
    def trajectory(self) -> Trajectory | None:
        """The joints over time; None where the motion is refused."""
        return None if self.refused else self.attempt


def refusals(
    trajectory: Trajectory, rules: Iterable[LimitRule] = (), tolerances: Tolerances = TOLERANCES
) -> tuple[Refusal, ...]:
    """What of a trajectory leaves the ranges and speeds of its joints, and the coupled ranges.

    Ranges and speeds hold on the whole way if they hold at the samples, since the way between them is straight;
    coupled ranges are looked at at the samples.
    """
    found, times = [], trajectory.times
    middles = 0.5 * (times[1:] + times[:-1])
    speeds = np.abs(trajectory.velocities)
    for k, joint in enumerate(trajectory.joints):
        unit = "m" if joint.kind == "prismatic" else "rad"
        found += _range(trajectory.q[:, k], times, joint.name, (joint.lower, joint.upper), unit, tolerances)
        fast = speeds[:, k] - joint.max_velocity
        allowed = _ROUNDING * joint.max_velocity if np.isfinite(joint.max_velocity) else 0.0
        found += refusal_where(fast > allowed, fast, middles, joint.name, "too fast", f"{unit}/s")
    for rule in rules:
        if rule.joint in trajectory.joint_names and rule.by in trajectory.joint_names:
            ends = np.array([rule.range(by) for by in trajectory.column(rule.by).tolist()])
            column = trajectory.column(rule.joint)
            found += _range(column, times, rule.joint, (ends[:, 0], ends[:, 1]), "rad", tolerances, rule.by)
    return tuple(found)


def refusal_where(
    bad: NDArray[np.bool_], amount: Floats, times: Floats, what: str, reason: Reason, unit: str
) -> list[Refusal]:
    """The refusal of the instants (N,) that are bad, or none."""
    if not bad.any():
        return []
    worst = int(np.where(bad, amount, -np.inf).argmax())
    first = float(times[int(bad.argmax())])
    return [Refusal(what, reason, first, float(amount[worst]), unit, float(times[worst]))]


def said(refused: tuple[Refusal, ...], most: int = 3) -> str:
    """The first refusals as a sentence, and how many more there are."""
    rest = f"; and {len(refused) - most} more" if len(refused) > most else ""
    return "; ".join(map(str, refused[:most])) + rest + "."


def _range(
    values: Floats,
    times: Floats,
    joint: str,
    ends: tuple[float, float] | tuple[Floats, Floats],
    unit: str,
    tolerances: Tolerances,
    by: str = "",
) -> list[Refusal]:
    what = f"{joint} (as {by} stands)" if by else joint
    below, above = ends[0] - values, values - ends[1]
    slack = tolerances.limits
    return [
        *refusal_where(below > slack, below, times, what, "below its range", unit),
        *refusal_where(above > slack, above, times, what, "above its range", unit),
    ]
