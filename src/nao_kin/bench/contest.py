"""Solvers side by side on the same targets, block by block in turns, every answer checked by the referee."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

import nao_kin as nk
from nao_kin.bench.measuring import timed, undisturbed
from nao_kin.bench.referee import NEAR, REACHED, Referee
from nao_kin.bench.sheet import Heading
from nao_kin.chain import neutral, random_configurations
from nao_kin.output import progress

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = [
    "CONTEST_HEADINGS",
    "Contender",
    "Score",
    "SolverTask",
    "TargetKind",
    "contest",
    "contest_rows",
    "duels",
    "ours",
]

TargetKind: TypeAlias = Literal["pose", "position"]

_BLOCK = 25  # targets that one solver gets before the next one's turn: a few milliseconds

CONTEST_HEADINGS = (
    Heading("solver", "solver"),
    Heading("success", "solved %", ".1f"),
    Heading("near", "near %", ".1f"),
    Heading("p95", "p95", ".1f"),
    Heading("median", "median", ".1f"),
    Heading("median_ratio", "÷ ours", ".2f"),
    Heading("mean", "mean", ".1f"),
    Heading("mean_ratio", "÷ ours", ".2f"),
)


@dataclass(frozen=True, eq=False)
class SolverTask:
    """What all solvers are asked.

    Attributes:
        chain: The chain.
        targets: T_base_target (N, 4, 4).
        kind: Whether the orientation counts.
    """

    chain: UrdfChain
    targets: Floats
    kind: TargetKind = "pose"
    start: Floats = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", neutral(self.chain))

    @classmethod
    def reachable(cls, chain: UrdfChain, count: int, seed: int, kind: TargetKind = "pose") -> SolverTask:
        """Targets that Pinocchio's forward kinematics of random joints within the limits gives."""
        referee, Q = Referee(chain), random_configurations(chain, count, np.random.default_rng(seed))
        return cls(chain, np.array([referee.pose(q) for q in Q]).reshape(-1, 4, 4), kind)

    @property
    def native(self) -> Floats:
        """The targets as `nk.solve` and `nk.solve_batch` take them: matrices, or points where those are wanted."""
        if self.kind == "pose":
            return self.targets
        return np.ascontiguousarray(self.targets[:, :3, 3])


@dataclass(frozen=True)
class Contender:
    """A solver set up for one chain.

    Attributes:
        name: What to call it.
        call: What is timed: a target in, whatever the solver returns out.
        joints: Reads the joints (n,) out of that, or None where the solver says that it has none; not timed.
        prepare: Turns the targets into the solver's own form; not timed.
    """

    name: str
    call: Callable[[Any], Any]
    joints: Callable[[Any], Floats | None]
    prepare: Callable[[SolverTask], Sequence[Any]] = lambda task: list(task.targets)


@dataclass(frozen=True, eq=False)
class Score:
    """What a contender did.

    Attributes:
        name: Its name.
        times: Times (runs, N) [s].
        claimed: How many targets it said to have reached, in the first run.
        reached: How many of them the referee confirms.
        near: How many the referee would confirm if it were lenient.
    """

    name: str
    times: Floats
    claimed: int
    reached: int
    near: int

    def percent(self, count: int) -> float:
        """A number of targets [%]."""
        return 100.0 * count / len(self.times[0])


def ours(chain: UrdfChain) -> Contender:
    """`nk.solve` with default settings, its judge and its result object included."""
    solve, start = nk.solve, neutral(chain)
    return Contender(
        name="nao_kin",
        call=lambda target: solve(chain, target, start),
        joints=lambda result: result.q if result.solved else None,
        prepare=lambda task: list(task.native),
    )


def contest(task: SolverTask, contenders: Sequence[Contender], runs: int, what: str) -> list[Score]:
    """Every contender on every target, `runs` times, in turns of a few targets each."""
    referee, count = Referee(task.chain), len(task.targets)
    inputs = [contender.prepare(task) for contender in contenders]
    for contender, given in zip(contenders, inputs, strict=True):
        timed(contender.call, given[:3])  # whatever happens only once
    times = np.empty((len(contenders), runs, count))
    found: list[list[Floats | None]] = [[] for _ in contenders]
    blocks = [(run, first) for run in range(runs) for first in range(0, count, _BLOCK)]
    with undisturbed():
        for run, first in progress(blocks, what, len(blocks)):
            rows = slice(first, first + _BLOCK)
            for k, (contender, given) in enumerate(zip(contenders, inputs, strict=True)):
                contender.call(given[first - 1])  # the solver before has left the processor's caches full of its own
                times[k, run, rows], answers = timed(contender.call, given[rows])
                if run == 0:
                    found[k] += map(contender.joints, answers)
    return [_score(task, referee, c.name, times[k], found[k]) for k, c in enumerate(contenders)]


def _score(task: SolverTask, referee: Referee, name: str, times: Floats, found: Sequence[Floats | None]) -> Score:
    def confirmed(within: tuple[float, float]) -> int:
        pairs = zip(found, task.targets, strict=True)
        only = task.kind == "position"
        return sum(referee.accepts(q, T, position_only=only, within=within) for q, T in pairs)

    claimed = sum(q is not None for q in found)
    return Score(name, times, claimed, confirmed(REACHED), confirmed(NEAR))


def duels(task: SolverTask, peers: Sequence[Contender], runs: int, what: str) -> list[dict[str, Any]]:
    """Our row, and a row of each peer with its ratio to ours in a contest between these two alone.

    All in one contest would not be fair to the quick ones: after a solver that works for milliseconds a target, the
    processor's caches and branch predictors take longer to recover than a quick solver's whole turn.
    """
    mine = ours(task.chain)
    pairs = [contest(task, [mine, peer], runs, f"{what}, {peer.name}") for peer in peers]
    rows = [contest_rows(pair) for pair in pairs or [contest(task, [mine], runs, what)]]
    return [rows[0][0], *(peer_row for _, *others in rows for peer_row in others)]


def contest_rows(scores: Sequence[Score]) -> list[dict[str, Any]]:
    """Success [%] and times [µs] of each; the first score is ours, and the ratios are the others' times over it."""
    microseconds = [score.times * 1e6 for score in scores]
    return [
        {
            "solver": score.name,
            "success": score.percent(score.reached),
            "near": score.percent(score.near),
            "median": float(np.median(taken)),
            "p95": float(np.percentile(taken, 95)),
            "mean": float(taken.mean()),
            "median_ratio": float(np.median(taken) / np.median(microseconds[0])),
            "mean_ratio": float(taken.mean() / microseconds[0].mean()),
            "claimed": score.claimed,
            "reached": score.reached,
            "targets": int(taken.shape[1]),
            "runs": int(taken.shape[0]),
        }
        for score, taken in zip(scores, microseconds, strict=True)
    ]
