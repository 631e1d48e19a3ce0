"""`nao-kin bench startup`: whole processes, against what they cannot do without."""

from __future__ import annotations

import sys
import time
from typing import Annotated

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

__all__ = ["startup"]

_CLI = (sys.executable, "-m", "nao_kin")

_FIRST_SOLVE = """
import nao_kin as nk
arm = nk.load("jaco2").chain("arm")
assert nk.solve(arm, arm.pose([0.3, 2.5, 1.5, 0.4, 0.5, 0.6])).solved
"""

# What is started, what it is measured against, and the ratio it should stay below.
_STARTUP: tuple[tuple[str, tuple[str, ...], str, float], ...] = (
    ("import nao_kin", (sys.executable, "-c", "import nao_kin"), "import numpy", 1.5),
    ("nao-kin robots", (*_CLI, "robots"), "import numpy", 4.0),
    ("nao-kin fk jaco2", (*_CLI, "fk", "jaco2"), "import numpy, pinocchio", 2.5),
    ("nao-kin check nao", (*_CLI, "check", "nao"), "import numpy, pinocchio", 2.5),
    ("first solve, warm cache", (sys.executable, "-c", _FIRST_SOLVE), "import numba, pinocchio", 3.0),
)


def startup(
    rounds: Annotated[int, typer.Option(min=1, help="Runs of each command, taken in turns.")] = 9,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Start-up times of whole processes, as ratios to what they cannot do without."""
    import statistics

    machine = Machine()
    commands: dict[str, tuple[str, ...]] = {ref: (sys.executable, "-c", ref) for _, _, ref, _ in _STARTUP}
    commands |= {name: command for name, command, _, _ in _STARTUP}
    seconds: dict[str, list[float]] = {name: [] for name in commands}
    for _ in progress(range(rounds + 1), "starting processes", rounds + 1):
        for name, command in commands.items():  # in turns, so that a slow phase of the machine hits all alike
            seconds[name].append(_seconds(command))
    medians = {name: statistics.median(taken[1:]) for name, taken in seconds.items()}  # the first round warms up
    rows = [
        {
            "what": name,
            "ms": medians[name] * 1e3,
            "against": ref,
            "against_ms": medians[ref] * 1e3,
            "ratio": medians[name] / medians[ref],
        }
        for name, _, ref, _ in _STARTUP
    ]
    headings = (
        Heading("what", "started"),
        Heading("ms", "[ms]", ".0f"),
        Heading("against", "against"),
        Heading("against_ms", "[ms]", ".0f"),
        Heading("ratio", "ratio", ".2f"),
    )
    sheet = Sheet("rows", f"whole processes, median of {rounds} rounds", headings, rows)
    bounds = [
        Promise(f"{name} / {ref}", medians[name] / medians[ref], bound, at_least=False)
        for name, _, ref, bound in _STARTUP
    ]
    conclude(machine, [sheet], bounds, [], format, goals)


def _seconds(command: tuple[str, ...]) -> float:
    import subprocess

    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # noqa: S603 - our own constant commands
    return time.perf_counter() - started
