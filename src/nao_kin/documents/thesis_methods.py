"""The methods of Bischoff 2016, run side by side: small samples on the NAO's arm, for what sections 3.4 to 4.2 say.

Work is counted in iterations, which are the same on every machine; `nao-kin bench methods` measures time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.documents.thesis_arms import arm_configurations, robot_arm
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.single import solve

if TYPE_CHECKING:
    from nao_kin.ik.problem import IKResult

__all__ = ["ITERATIVE", "JACOBIAN", "TARGETS", "Record", "far", "near"]

JACOBIAN: Final = ("transpose_buss", "pinv", "newton", "dls", "sdls", "tsvd", "lm")
"""Methods on the Jacobian; the transpose with the α of (3.2.1.2)."""

ITERATIVE: Final = (*JACOBIAN, "ccd", "ftl", "fabrik")

TARGETS: Final = 25
_BUDGET: Final = Budget(iterations=300, restarts=0, patience=300)
_NEAR: Final = 0.2  # [rad] from start to target, each joint


@dataclass(frozen=True, slots=True)
class Record:
    """What a method made of the targets, from one start each.

    Attributes:
        solved: How many it reached.
        iterations: Median iterations of those; inf if none.
        moved: Median of the largest move of a joint, of those [rad]; inf if none.
    """

    solved: int
    iterations: float
    moved: float


@cache
def near() -> dict[str, Record]:
    """Positions that a posture within 0.2 rad of the start reaches."""
    return _run(_NEAR, 351)


@cache
def far() -> dict[str, Record]:
    """Positions of any posture from any other."""
    return _run(None, 352)


def _run(within: float | None, seed: int) -> dict[str, Record]:
    chain, rng = robot_arm("left"), np.random.default_rng(seed)
    starts = arm_configurations("left", TARGETS, seed)
    if within is None:
        ends = arm_configurations("left", TARGETS, seed + 10)
    else:
        ends = np.clip(starts + rng.uniform(-within, within, starts.shape), chain.lower, chain.upper)
    records = {}
    for method in ITERATIVE:
        results = [
            solve(chain, chain.pose(q).translation, q_0, method=method, budget=_BUDGET, engine="reference")
            for q, q_0 in zip(ends, starts, strict=True)
        ]
        moves = [float(np.abs(r.q - q_0).max()) for r, q_0 in zip(results, starts, strict=True)]
        records[method] = _record(results, moves)
    return records


def _record(results: list[IKResult], moves: list[float]) -> Record:
    good = [k for k, result in enumerate(results) if result.solved]
    if not good:
        return Record(0, float("inf"), float("inf"))
    iterations = float(np.median([results[k].iterations for k in good]))
    return Record(len(good), iterations, float(np.median([moves[k] for k in good])))
