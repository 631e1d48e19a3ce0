"""Stored configurations of a chain: where a search begins again, nearest to the target first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.chain import random_configurations

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import Target

__all__ = ["STORED", "Starts", "distances", "make_starts", "nearest_first", "starts_at"]

STORED: Final = 256
"""How many. More of them save few iterations and take longer to look through."""

CLOSENESS: Final = 4.0
"""A tip that is off by as much as the tips of all configurations scatter weighs this much against |R − R_target|²."""


@dataclass(frozen=True, eq=False, slots=True)
class Starts:
    """Configurations with the poses they lead to.

    Attributes:
        table: A row each, the configuration (n,), then T_base_tip (12,): rotation row by row, translation [m].
        closeness: Weight of a squared distance of two tips against the squared Frobenius distance of their rotations
            [1/m²]; from the chain's own size, so that the order does not depend on the unit of length.
    """

    table: Floats
    closeness: float

    @property
    def q(self) -> Floats:
        """The configurations (K, n)."""
        return self.table[:, :-12]


def make_starts(chain: Chain, rng: np.random.Generator, count: int = STORED) -> Starts:
    """`count` random configurations inside the limits, and where the tip is at each."""
    return starts_at(chain, random_configurations(chain, count, rng))


def starts_at(chain: Chain, Q: Floats) -> Starts:
    """Given configurations (K, n), and where the tip is at each."""
    poses, count = chain.poses(Q), len(Q)
    tips = poses[:, :3, 3]
    scatter = float(((tips - tips.mean(axis=0)) ** 2).sum(axis=1).mean())
    table = np.hstack([Q, poses[:, :3, :3].reshape(count, 9), tips])
    # A tip that never moves has no scatter; then its distance to the target is the same for all.
    return Starts(np.ascontiguousarray(table), CLOSENESS / scatter if scatter > 0.0 else 0.0)


def nearest_first(starts: Starts, target: Target) -> Iterator[Floats]:
    """The configurations, those first whose tip is nearest to the target."""
    return iter(starts.q[np.argsort(distances(starts, target), kind="stable")])


def distances(starts: Starts, target: Target) -> Floats:
    """How far the tip is from the target at each configuration (K,), position and orientation in one number."""
    goal, distance = target.goal, np.zeros(len(starts.table))
    if target.kind != "orientation":
        distance += starts.closeness * ((starts.table[:, -3:] - goal[:3, 3]) ** 2).sum(axis=1)
    if target.kind in ("pose", "orientation"):
        distance += ((starts.table[:, -12:-3] - goal[:3, :3].ravel()) ** 2).sum(axis=1)
    return distance
