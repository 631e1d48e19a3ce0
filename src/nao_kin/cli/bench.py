"""`nao-kin bench`: speed as ratios taken in one run, never as bare seconds."""

from __future__ import annotations

import platform
import statistics
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from typing import Annotated

import typer

from nao_kin.cli.output import FormatOption, OutputFormat, progress, report, report_json

__all__ = ["bench"]

bench = typer.Typer(help="Measure speed as ratios within one run.", no_args_is_help=True, rich_markup_mode=None)

_CLI = (sys.executable, "-m", "nao_kin")

# What is started, what it is measured against, and the ratio it should stay below.
_STARTUP: tuple[tuple[str, tuple[str, ...], str, float], ...] = (
    ("import nao_kin", (sys.executable, "-c", "import nao_kin"), "import numpy", 1.5),
    ("nao-kin robots", (*_CLI, "robots"), "import numpy", 4.0),
    ("nao-kin fk jaco2", (*_CLI, "fk", "jaco2"), "import numpy, pinocchio", 2.5),
)


@dataclass(frozen=True, slots=True)
class _Row:
    what: str
    against: str
    ms: float
    ratio: float
    goal: float


@bench.callback()
def root() -> None:
    """Measure speed as ratios within one run."""


@bench.command()
def startup(
    rounds: Annotated[int, typer.Option(min=1, help="Runs of each command, taken in turns.")] = 9,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Start-up times of whole processes, as ratios to what they cannot do without."""
    from nao_kin.table import Column, Table

    commands: dict[str, tuple[str, ...]] = {ref: (sys.executable, "-c", ref) for _, _, ref, _ in _STARTUP}
    commands |= {name: command for name, command, _, _ in _STARTUP}
    seconds: dict[str, list[float]] = {name: [] for name in commands}
    for _ in progress(range(rounds + 1), "starting processes", rounds + 1):
        for name, command in commands.items():  # in turns, so that a slow phase of the machine hits all alike
            seconds[name].append(_seconds(command))
    medians = {name: statistics.median(taken[1:]) for name, taken in seconds.items()}  # the first round warms up
    rows = [
        _Row(what=name, against=ref, ms=medians[name] * 1e3, ratio=medians[name] / medians[ref], goal=goal)
        for name, _, ref, goal in _STARTUP
    ]
    machine = f"Python {platform.python_version()}, {platform.machine()}, median of {rounds} rounds"
    if format is OutputFormat.json:
        report_json(
            {
                "machine": machine,
                "rows": [asdict(row) for row in rows],
                "reference_ms": {k: v * 1e3 for k, v in medians.items()},
            }
        )
    else:
        columns = ("[ms]", "ratio", "goal")
        report(
            Table(
                (Column("started"), Column("against"), *(Column(c, number=True) for c in columns)),
                tuple((r.what, r.against, f"{r.ms:.0f}", f"{r.ratio:.2f}", f"≤ {r.goal}") for r in rows),
                note=machine,
            )
        )
    if any(row.ratio > row.goal for row in rows):
        raise typer.Exit(1)


def _seconds(command: tuple[str, ...]) -> float:
    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # noqa: S603 - our own constant commands
    return time.perf_counter() - started
