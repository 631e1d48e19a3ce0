"""Targets for `nao-kin bench methods`, and what a method makes of a set of them; every answer goes to the referee."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import nao_kin as nk
from nao_kin.bench.bench_edges import farthest, near_full_reach
from nao_kin.bench.measuring import timed, undisturbed
from nao_kin.bench.referee import Referee
from nao_kin.chain import random_configurations

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.bench.contest import TargetKind
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["LONG", "Outcome", "TargetSet", "at_edge", "at_singularity", "easy", "full_range", "run"]

LONG = nk.Budget(iterations=5000, restarts=0, patience=5000)
"""One start, and as many iterations as it takes."""

_MARGIN = math.radians(10.0)
_NEAR = 0.2  # [rad or m]


@dataclass(frozen=True, eq=False, slots=True)
class TargetSet:
    """What methods are asked.

    Attributes:
        name: What to call it.
        short: The same for a column.
        chain: The chain.
        kind: Whether the orientation counts.
        poses: T_base_target (N, 4, 4), all reachable.
        starts: Where each search begins (N, n) [rad or m].
    """

    name: str
    short: str
    chain: UrdfChain
    kind: TargetKind
    poses: Floats
    starts: Floats

    @property
    def native(self) -> Floats:
        """The targets as `nk.solve` takes them: matrices, or points where those are wanted."""
        return self.poses if self.kind == "pose" else np.ascontiguousarray(self.poses[:, :3, 3])

    def smallest_singular_values(self, Q: Floats) -> Floats:
        """Of the Jacobian rows that count, at each configuration (N, n)."""
        rows = slice(0, 6 if self.kind == "pose" else 3)
        J = np.array([self.chain.jacobian(q)[rows] for q in Q])
        return np.asarray(np.linalg.svd(J, compute_uv=False)[:, -1])


@dataclass(frozen=True, eq=False, slots=True)
class Outcome:
    """What a method made of a set.

    Attributes:
        of: The set.
        method: The method's name.
        solved: Which targets it says it reached, and the referee confirms (N,).
        false: How many it says it reached and the referee does not confirm.
        q: Joints returned (N, n).
        iterations: Iterations (N,).
        seconds: Time of each call (N,) [s].
    """

    of: TargetSet
    method: str
    solved: NDArray[np.bool_]
    false: int
    q: Floats
    iterations: NDArray[np.int64]
    seconds: Floats

    @property
    def success(self) -> float:
        """Targets reached [%]."""
        return 100.0 * float(self.solved.mean())

    @property
    def median_iterations(self) -> float:
        """Iterations of a target that was reached; NaN if none was."""
        return float(np.median(self.iterations[self.solved])) if self.solved.any() else math.nan

    @property
    def median_seconds(self) -> float:
        """Time of a target that was reached [s]; NaN if none was."""
        return float(np.median(self.seconds[self.solved])) if self.solved.any() else math.nan

    @property
    def largest_move(self) -> float:
        """Median over the targets reached of the largest move of a joint from its start [rad or m]."""
        return float(np.median(self._moves[self.solved])) if self.solved.any() else math.nan

    @property
    def wild_move(self) -> float:
        """The same of all targets, exceeded by one in twenty of them."""
        return float(np.percentile(self._moves, 95.0))

    @property
    def _moves(self) -> Floats:
        return np.asarray(np.abs(self.q - self.of.starts).max(axis=1))


def run(
    targets: TargetSet,
    method: str,
    budget: nk.Budget | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Outcome:
    """Solves every target of a set by itself, from its own start."""

    def call(pair: tuple[Floats, Floats]) -> nk.IKResult:
        return nk.solve(targets.chain, pair[0], pair[1], method=method, budget=budget, parameters=parameters)

    pairs = list(zip(targets.native, targets.starts, strict=True))
    call(pairs[0])  # compiles, and works out what depends on the chain
    with undisturbed():
        taken, results = timed(call, pairs)
    referee, position_only = Referee(targets.chain), targets.kind == "position"
    claimed = np.array([result.solved for result in results])
    confirmed = np.array(
        [
            referee.accepts(result.q, T, position_only=position_only, within=(1.001e-6, 1.001e-6))
            for result, T in zip(results, targets.poses, strict=True)
        ]
    )
    return Outcome(
        of=targets,
        method=method,
        solved=claimed & confirmed,
        false=int((claimed & ~confirmed).sum()),
        q=np.array([result.q for result in results]),
        iterations=np.array([result.iterations for result in results]),
        seconds=np.array(taken),
    )


def easy(chain: UrdfChain, kind: TargetKind, count: int, rng: np.random.Generator) -> TargetSet:
    """Targets FK(q0 + δ) with |δ| ≤ 0.2 rad, start and target 10° inside the limits, the start being q0."""
    half = np.full(len(chain.joints), math.pi)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -half) + _MARGIN
    upper = np.where(np.isfinite(chain.upper), chain.upper, half) - _MARGIN
    starts, ends = list["Floats"](), list["Floats"]()
    while len(ends) < count:
        q0 = rng.uniform(lower, upper)
        q = q0 + rng.uniform(-_NEAR, _NEAR, len(q0))
        if ((lower <= q) & (q <= upper)).all():
            starts.append(q0)
            ends.append(q)
    return TargetSet(f"{chain.name}, near", _short(chain), chain, kind, _poses(chain, np.array(ends)), np.array(starts))


def full_range(chain: UrdfChain, kind: TargetKind, count: int, rng: np.random.Generator) -> TargetSet:
    """Targets of random postures, from random postures, all inside the limits."""
    Q = random_configurations(chain, 2 * count, rng)
    return TargetSet(f"{chain.name}, full range", _short(chain), chain, kind, _poses(chain, Q[:count]), Q[count:])


def at_edge(chain: UrdfChain, kind: TargetKind, count: int, samples: int, rng: np.random.Generator) -> TargetSet:
    """Targets at 99.9 % of the largest distance that is seen, from random postures."""
    q_far, reach = farthest(chain, samples, rng)
    poses = near_full_reach(chain, q_far, 0.999 * reach, count, rng)
    return TargetSet(
        "99.9 % of reach", f"{_short(chain)}, edge", chain, kind, poses, random_configurations(chain, count, rng)
    )


def at_singularity(chain: UrdfChain, joint: int, count: int, rng: np.random.Generator) -> TargetSet:
    """Poses at which a joint stands at exactly 0 and the arm loses a direction, from starts within 0.2 rad."""
    Q = random_configurations(chain, count, rng)
    Q[:, joint] = 0.0
    starts = np.clip(Q + rng.uniform(-_NEAR, _NEAR, Q.shape), chain.lower, chain.upper)
    return TargetSet(
        f"{chain.joint_names[joint]} = 0", f"{_short(chain)}, q{joint + 1} = 0", chain, "pose", _poses(chain, Q), starts
    )


def _short(chain: UrdfChain) -> str:
    return chain.robot.name.split("_")[0]


def _poses(chain: UrdfChain, Q: Floats) -> Floats:
    referee = Referee(chain)
    return np.array([referee.pose(q) for q in Q])
