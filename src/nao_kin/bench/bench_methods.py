"""`nao-kin bench methods`: every method on the same targets, and what the documents say of them held against it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

import nao_kin as nk
from nao_kin.bench.method_sets import LONG
from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.errors import MissingExtraError
from nao_kin.ik.methods import METHODS
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.bench.method_sets import Outcome, TargetSet

__all__ = ["draw", "methods"]

_ENOUGH = 99.0  # [%]
_SECOND = 1.0  # [s] that a target may take with restarts
_TRANSPOSES = ("transpose", "transpose_buss")  # whose way is too long by nature

# Methods that need not reach near poses, and why. Whoever else misses the goal fails the run.
_SLOW_TO_POSES = {
    "transpose": "its step along a direction shrinks with σ², so the end of the way takes more iterations than 5000",
    "transpose_buss": "one step length for all directions, so those that the joints hardly move come last",
    "combination": "where the arm is nearly singular the transpose's small step often comes closer than the long one",
    "ccd": "joints take turns, and where several are needed together each alone can do little",
}
_TWO_HANDS = {"iterations": 300, "restarts": 10, "patience": 50}  # the loop for several tips is Python
_SAMPLES = 200_000  # configurations that the reach is seen in


def methods(
    targets: Annotated[int, typer.Option(min=10, help="Targets of each set.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of starts and targets.")] = 3,
    plots: Annotated[Path | None, typer.Option(help="Folder for convergence plots (extra notebook).")] = None,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Thesis section 3.5 measured: success, iterations and time of every method, and a verdict on each claim."""
    import numpy as np

    from nao_kin.bench.claims import Figures, claims
    from nao_kin.bench.closed_beside import measured
    from nao_kin.bench.closed_beside import sheet as beside_sheet

    machine, rng = Machine(), np.random.default_rng(seed)
    sets = _sets(targets, rng)
    easy = [outcome for s in sets["easy"] for outcome in _everybody(s, long=True)]
    alone = [outcome for s in sets["full"] for outcome in _everybody(s, long=True)]
    again = [outcome for s in sets["full"] for outcome in _everybody(s)]
    hard = [outcome for s in sets["hard"] for outcome in _everybody(s, long=True)]
    beside = measured(seed)
    sheets = [
        _sheet("easy", f"near targets, one start, up to 5000 iterations; {targets} each", easy),
        _sheet("alone", "full range, one start, up to 5000 iterations", alone),
        _sheet("restarts", "full range, with restarts", again),
        _sheet("hard", "edge of reach and singularity, one start, up to 5000 iterations", hard, timed=True),
        _time_sheet(again),
        _two_hands(max(10, targets // 5), seed),
        beside_sheet(beside),
    ]
    everything = [*easy, *alone, *again, *hard]
    bounds = [*_easy_goals(easy), *_restart_goals(again), _honesty(everything)]
    notes = ["%: targets reached and confirmed by Pinocchio; it.: median iterations of those.", *_misses(easy)]
    notes += [*claims(Figures(easy, alone, again, hard, beside))]
    if plots is not None:
        from nao_kin.bench.bench_methods import draw

        notes.append(f"Plots: {', '.join(map(str, draw(sets['easy'], plots)))}")
    conclude(machine, sheets, bounds, notes, format, goals)


def _sets(count: int, rng: Any) -> dict[str, list[TargetSet]]:
    """Near targets and the full range on a NAO arm (positions) and two arms (poses); the edge; a singularity."""
    from nao_kin.bench.arms import main_arm
    from nao_kin.bench.method_sets import at_edge, at_singularity, easy, full_range
    from nao_kin.robot.robot import load

    nao, jaco2, (arm, _) = load("nao_v33_h21").chain("left_arm"), load("jaco2").chain("arm"), main_arm()
    arms = [jaco2] if arm.robot.name == "jaco2" else [arm, jaco2]
    return {
        "easy": [easy(nao, "position", count, rng), *(easy(a, "pose", count, rng) for a in arms)],
        "full": [full_range(nao, "position", count, rng), full_range(jaco2, "pose", count, rng)],
        "hard": [at_edge(nao, "position", count, _SAMPLES, rng), at_singularity(arm, 4, count, rng)],
    }


def _everybody(targets: TargetSet, long: bool = False) -> list[Outcome]:
    """Every method that can do this kind of target on this chain."""
    from nao_kin.bench.method_sets import LONG, run
    from nao_kin.ik.methods import METHODS
    from nao_kin.ik.target import Target
    from nao_kin.output import progress

    target = Target.of(targets.native[0])
    able = [name for name, method in METHODS.items() if method.refusal(targets.chain, target) is None]
    return [run(targets, name, LONG if long else None) for name in progress(able, targets.name, len(able))]


def _sheet(name: str, title: str, outcomes: list[Outcome], timed: bool = False) -> Sheet:
    """One row a method: success and iterations of each set side by side; with `timed`, the time of a solve as well."""
    sets = list(dict.fromkeys(outcome.of.name for outcome in outcomes))
    short = {outcome.of.name: outcome.of.short for outcome in outcomes}
    rows: dict[str, dict[str, Any]] = {}
    for outcome in outcomes:
        row, k = rows.setdefault(outcome.method, {"method": outcome.method}), sets.index(outcome.of.name)
        row[f"success_{k}"] = outcome.success
        if not math.isnan(outcome.median_iterations):
            row[f"iterations_{k}"] = outcome.median_iterations
            if timed:
                row[f"median_{k}"] = outcome.median_seconds * 1e6
    headings = [Heading("method", "method")]
    for k, of in enumerate(sets):
        headings += [Heading(f"success_{k}", f"{short[of]} %", ".1f"), Heading(f"iterations_{k}", "it.", ".0f")]
        headings += [Heading(f"median_{k}", "µs", ".0f")] if timed else []
    return Sheet(name, title, tuple(headings), list(rows.values()))


def _time_sheet(outcomes: list[Outcome]) -> Sheet:
    """What a solve with restarts takes, in units of the default method's."""
    import numpy as np

    usual = {outcome.of.name: outcome.median_seconds for outcome in outcomes if outcome.method == "lm"}
    sets, rows = list(usual), dict[str, dict[str, Any]]()
    short = {outcome.of.name: outcome.of.short for outcome in outcomes}
    for outcome in outcomes:
        row, k = rows.setdefault(outcome.method, {"method": outcome.method}), sets.index(outcome.of.name)
        row[f"median_{k}"] = outcome.median_seconds * 1e6
        row[f"ratio_{k}"] = outcome.median_seconds / usual[outcome.of.name]
        row[f"worst_{k}"] = float(np.max(outcome.seconds)) * 1e3
    headings = [Heading("method", "method")]
    for k, of in enumerate(sets):
        headings += [
            Heading(f"median_{k}", f"{short[of]} [µs]", ".0f"),
            Heading(f"ratio_{k}", "÷ lm", ".1f"),
            Heading(f"worst_{k}", "max [ms]", ".1f"),
        ]
    return Sheet(
        "time",
        "time of a solve, with restarts: median of those reached, longest of all",
        tuple(headings),
        list(rows.values()),
    )


def _two_hands(count: int, seed: int) -> Sheet:
    """Both hands of the NAO at once, from the torso and from a foot, by every method that serves several tips."""
    from nao_kin.bench.bench_tips import attempt, reachable_wishes
    from nao_kin.ik.methods import METHODS
    from nao_kin.ik.reference_loop import Budget
    from nao_kin.robot.robot import load

    robot, rows, budget = load("nao"), list[dict[str, Any]](), Budget(**_TWO_HANDS)
    trees = {base: robot.tree(base, ["LArm", "RArm"]) for base in ("torso", "l_sole")}
    wishes = {base: reachable_wishes(tree, "position", count, seed) for base, tree in trees.items()}
    for name in (name for name, method in METHODS.items() if method.several_tips):
        row: dict[str, Any] = {"method": name}
        for base, tree in trees.items():
            found = attempt(tree, wishes[base], f"{name}, both hands from {base}", method=name, budget=budget)
            row |= {f"{base}_{key}": found[key] for key in ("solved", "iterations", "ms")}
        rows.append(row)
    headings = (
        Heading("method", "method"),
        Heading("torso_solved", "from torso %", ".1f"),
        Heading("torso_iterations", "it.", ".0f"),
        Heading("torso_ms", "ms", ".1f"),
        Heading("l_sole_solved", "from l_sole %", ".1f"),
        Heading("l_sole_iterations", "it.", ".0f"),
        Heading("l_sole_ms", "ms", ".1f"),
    )
    title = f"both hands at once, positions, at most {_TWO_HANDS['restarts']} restarts; {count} targets"
    return Sheet("two_hands", title, headings, rows)


def _easy_goals(outcomes: list[Outcome]) -> list[Promise]:
    """At least 99 % of the near targets for every method, the worst of its arms; see `_SLOW_TO_POSES`."""
    worst: dict[str, float] = {}
    for outcome in outcomes:
        if outcome.of.kind == "position" or outcome.method not in _SLOW_TO_POSES:
            worst[outcome.method] = min(worst.get(outcome.method, 100.0), outcome.success)
    few = min(worst, key=worst.__getitem__)
    return [Promise(f"near targets, every method but those listed below, % ({few})", worst[few], _ENOUGH)]


def _restart_goals(outcomes: list[Outcome]) -> list[Promise]:
    """Full range with restarts on the NAO arm, within a second a target: the worst method."""
    reached = {
        outcome.method: 100.0 * float((outcome.solved & (outcome.seconds <= _SECOND)).mean())
        for outcome in outcomes
        if outcome.of.kind == "position" and outcome.method not in _TRANSPOSES
    }
    few = min(reached, key=reached.__getitem__)
    text = f"NAO arm, full range, in 1 s, every method but the transposes, % ({few})"
    return [Promise(text, reached[few], _ENOUGH)]


def _honesty(outcomes: list[Outcome]) -> Promise:
    runs = sum(len(outcome.solved) for outcome in outcomes)
    false = sum(outcome.false for outcome in outcomes)
    return Promise(f"false successes in {runs} runs", float(false), 0.0, at_least=False)


def _misses(outcomes: list[Outcome]) -> list[str]:
    """A line for each method below the goal on near targets: by how much, and what its misses have in common."""
    import numpy as np

    lines = []
    for outcome in outcomes:
        if outcome.success >= _ENOUGH:
            continue
        sigma = outcome.of.smallest_singular_values(outcome.q)
        missed, reached = float(np.median(sigma[~outcome.solved])), float(np.median(sigma[outcome.solved]))
        lines.append(
            f"{outcome.method} reaches {outcome.success:.1f} % of the near targets of {outcome.of.chain.name}: "
            f"{_SLOW_TO_POSES.get(outcome.method, 'unexplained')}. Where it ends without success the smallest singular "
            f"value is {missed:.2g} in the median, {reached:.2g} where it succeeds."
        )
    return lines


_TARGETS = 50  # a median of more looks the same
_ITERATIONS = 5000


def draw(sets: Sequence[TargetSet], folder: Path) -> list[Path]:
    """One PNG a set: position error [m] over iterations, both logarithmic, a line a method.

    Raises:
        MissingExtraError: Matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ImportError:
        raise MissingExtraError("Convergence plots", "notebook") from None
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for of in sets:
        figure, axes = plt.subplots(figsize=(9.0, 5.5), layout="constrained")
        _lines(axes, of)
        written.append(folder / f"convergence_{of.chain.name.replace(' ', '_')}.png")
        figure.savefig(written[-1], dpi=110)
        plt.close(figure)
    return written


def _lines(axes: Any, of: TargetSet) -> None:
    target = nk.Target.of(of.native[0])
    able = [method for method in METHODS.values() if method.refusal(of.chain, target) is None]
    for number, method in enumerate(able):
        error = _median_error(of, method.name)
        dashes = ("-", "--", ":")[number // 7]
        axes.plot(np.arange(1, len(error) + 1), error, dashes, color=f"C{number % 7}", label=method.name, linewidth=1.6)
    axes.axhline(1e-6, color="0.6", linewidth=0.8)
    axes.text(1.0, 1.2e-6, "reached", color="0.4", fontsize=8)
    axes.set(xscale="log", yscale="log", xlabel="iteration + 1", ylabel="position error, median [m]")
    axes.set_title(f"{of.name}: {of.kind} targets within 0.2 rad, one start")
    axes.set_ylim(bottom=1e-10)
    axes.legend(ncols=1, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))


def _median_error(of: TargetSet, method: str) -> Floats:
    """Median position error [m] of the iterates, each run's last one kept until the longest has ended."""
    traces = []
    for target, q0 in zip(of.native[:_TARGETS], of.starts[:_TARGETS], strict=True):
        result = nk.solve(of.chain, target, q0, method=method, budget=LONG, trace=True)
        if result.trace is not None:
            traces.append(result.trace.position_error)
    longest = min(_ITERATIONS, max(map(len, traces)))
    padded = [np.concatenate([t[:longest], np.full(max(0, longest - len(t)), t[-1])]) for t in traces]
    return np.asarray(np.median(np.maximum(padded, 1e-17), axis=0))
