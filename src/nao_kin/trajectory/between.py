"""How far a tip leaves its path between two samples, where the joints move straight and the path does not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.ik.measure import measure_many
from nao_kin.ik.target import KINDS, Target
from nao_kin.trajectory.paths import PoseLine

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.trajectory.timing import TimedPath

__all__ = ["error_between"]

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
