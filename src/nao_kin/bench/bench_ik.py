"""`nao-kin bench ik`: one target, many targets, many robots; with peers beside."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import SOLVED_MEANS, GoalsOption, Heading, Machine, PeersOption, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.bench.contest import SolverTask

__all__ = ["ik"]

_REFERENCE = "roboticstoolbox"  # the best of the general solvers, so the one that the goals are about

# Least ratios to it: median and mean of single solves, and time per target of a batch.
_POSE_GOALS = (4.0, 5.0, 12.0)
_POSITION_GOALS = (2.0, None, 8.0)
_MANY_GOAL = 99.9  # [%]


def ik(
    targets: Annotated[int, typer.Option(min=1, help="Targets for single solves, and of every robot.")] = 1000,
    batch: Annotated[int, typer.Option(min=1, help="Targets for batches.")] = 10_000,
    runs: Annotated[int, typer.Option(min=1, help="How often everything is repeated.")] = 3,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the targets.")] = 7,
    peers: PeersOption = False,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Inverse kinematics of reachable targets: success and time, alone and in batches, on many robots."""
    from nao_kin.bench.arms import main_arm
    from nao_kin.bench.contest import SolverTask
    from nao_kin.robot.robot import load

    machine, (arm, notes) = Machine(), main_arm()
    nao = load("nao_v50_h21").chain("left_arm")
    sheets, bounds = list[Sheet](), list[Promise]()
    batch_rows: list[dict[str, Any]] = []
    for task, many, least in (
        (SolverTask.reachable(arm, targets, seed), SolverTask.reachable(arm, batch, seed + 1), _POSE_GOALS),
        (
            SolverTask.reachable(nao, targets, seed, "position"),
            SolverTask.reachable(nao, batch, seed + 1, "position"),
            _POSITION_GOALS,
        ),
    ):
        sheet, row, found, said = _arm(task, many, runs, peers, least)
        sheets.append(sheet)
        batch_rows.append(row)
        bounds += found
        notes += [line for line in said if line not in notes]
    sheets.append(Sheet("batch", f"solve_batch of {batch} targets [µs a target]", _BATCH_HEADINGS, batch_rows))
    success, more, missing = _many_robots(targets, seed)
    notes += [line for line in missing if line not in notes]
    notes.append(SOLVED_MEANS)
    if peers:
        notes.append("Each peer takes turns with nao_kin alone, so that no third one empties the caches of both.")
        notes.append(f"Batches stand beside {_REFERENCE}'s loop over {min(batch, targets)} of their targets.")
    conclude(machine, [*sheets, success], [*bounds, *more], notes, format, goals)


_BATCH_HEADINGS = (
    Heading("what", "chain"),
    Heading("success", "solved %", ".2f"),
    Heading("each", "batch", ".2f"),
    Heading("each_one_thread", "one thread", ".2f"),
    Heading("peer_each", f"{_REFERENCE} loop", ".1f"),
    Heading("ratio", "ratio", ".1f"),
)


def _arm(
    task: SolverTask, many: SolverTask, runs: int, peers: bool, least: tuple[float | None, ...]
) -> tuple[Sheet, dict[str, Any], list[Promise], list[str]]:
    """Single solves and batches on one arm: the sheet of single solves, the row of the batch, goals and notes."""
    from nao_kin.bench.contest import CONTEST_HEADINGS, duels
    from nao_kin.bench.peers import installed_peers

    name = f"{task.chain.robot.name.replace('nao_v50_', 'NAO ')} {task.kind}"
    others, notes = installed_peers(task) if peers else ([], [])
    rows = duels(task, others, runs, name)
    title = f"{name}, one at a time: {len(task.targets)} targets, {runs} runs [µs]"
    sheet = Sheet(f"single_{task.kind}", title, CONTEST_HEADINGS, rows)
    bounds = [Promise(f"{name}: solved %", rows[0]["success"], 100.0)]
    reference = next((row for row in rows if row["solver"] == _REFERENCE), None)
    if reference is not None:
        for key, bound in zip(("median", "mean"), least, strict=False):
            if bound is not None:
                bounds.append(Promise(f"{name}: {_REFERENCE} ÷ ours, {key}", reference[f"{key}_ratio"], bound))
    if peers and reference is None:
        notes.append(f"Without {_REFERENCE}, the goals against it are not measured.")
    loop = next((other for other in others if other.name == _REFERENCE), None)
    row = _batch_row(many, name, runs, loop, len(task.targets))
    bounds.append(Promise(f"{name}, batch: solved %", row["success"], 100.0))
    bounds.append(Promise(f"{name}, batch: same bits always", float(row["same_bits"]), 1.0))
    if row["ratio"] is not None and least[2] is not None:
        bounds.append(Promise(f"{name}, batch: {_REFERENCE} ÷ ours", row["ratio"], least[2]))
    return sheet, row, bounds, notes


def _batch_row(task: SolverTask, name: str, runs: int, loop: Any, share: int) -> dict[str, Any]:
    """A batch against a peer's loop over a share of the same targets, in turns."""
    import statistics

    import numpy as np

    import nao_kin as nk
    from nao_kin.bench.measuring import in_turns, one_thread, timed
    from nao_kin.bench.referee import Referee

    chain, given, start = task.chain, task.native, task.start
    first = nk.solve_batch(chain, given, start)  # compiles, and starts the threads
    referee = Referee(chain)
    answers = zip(first.q, first.solved, task.targets, strict=True)
    reached = sum(solved and referee.accepts(q, T, position_only=task.kind == "position") for q, solved, T in answers)
    order = np.random.default_rng(0).permutation(len(task.targets))
    shuffled = nk.solve_batch(chain, np.asarray(given)[order], start)
    with one_thread():
        alone = nk.solve_batch(chain, given, start)
    jobs: dict[str, Callable[[], Any]] = {
        "batch": lambda: nk.solve_batch(chain, given, start),
        "alone": lambda: one_thread()(nk.solve_batch)(chain, given, start),
    }
    if loop is not None:
        inputs = loop.prepare(task)[:share]
        jobs["loop"] = lambda: timed(loop.call, inputs)
    times = in_turns(jobs, progress(range(runs), f"{name}, batch", runs), {"batch": 3})
    each = {job: statistics.median(taken) / len(task.targets) * 1e6 for job, taken in times.items()}
    peer_each = None if loop is None else statistics.median(times["loop"]) / len(inputs) * 1e6
    return {
        "what": name,
        "success": 100.0 * reached / len(task.targets),
        "each": each["batch"],
        "each_one_thread": each["alone"],
        "peer_each": peer_each,
        "ratio": None if peer_each is None else peer_each / each["batch"],
        "same_bits": bool(np.array_equal(alone.q, first.q) and np.array_equal(shuffled.q, first.q[order])),
        "targets": len(task.targets),
    }


def _many_robots(targets: int, seed: int) -> tuple[Sheet, list[Promise], list[str]]:
    """Reachable targets of many robots, default settings."""
    from nao_kin.bench.arms import many_chains
    from nao_kin.bench.contest import SolverTask, contest, contest_rows, ours

    chains, missing = many_chains()
    rows = []
    for chain, kind in chains:
        task = SolverTask.reachable(chain, targets, seed, kind)
        row = contest_rows(contest(task, [ours(chain)], 1, chain.name))[0]
        rows.append(row | {"chain": chain.name, "joints": len(chain.joints), "kind": kind})
    headings = (
        Heading("chain", "chain"),
        Heading("joints", "joints", "d"),
        Heading("kind", "target"),
        Heading("success", "solved %", ".2f"),
        Heading("median", "median", ".1f"),
        Heading("p95", "p95", ".1f"),
        Heading("mean", "mean", ".1f"),
    )
    worst = min(rows, key=lambda row: float(row["success"]))
    goal = Promise(f"fewest solved %, {worst['chain']}", worst["success"], _MANY_GOAL)
    title = f"many robots, {targets} reachable targets each, default settings [µs]"
    return Sheet("robots", title, headings, rows), [goal], missing
