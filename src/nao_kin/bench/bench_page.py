"""`nao-kin bench page`: what a page costs, against importing Pinocchio, and how large it is."""

from __future__ import annotations

import sys
import time
from typing import Annotated, Final

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

__all__ = ["page"]

_ROBOTS: Final = ("nao", "jaco2", "phantomx")

_IMPORT: Final = """
import time
started = time.perf_counter()
import pinocchio
print(time.perf_counter() - started)
"""


def page(
    rounds: Annotated[int, typer.Option(min=1, help="Pages of each robot, taken in turns.")] = 9,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Pages written in a warm process, as ratios to a fresh process's import of Pinocchio; and their sizes."""
    import statistics
    import tempfile
    from pathlib import Path

    from nao_kin.robot.robot import load
    from nao_kin.view.export import export_html

    machine = Machine()
    robots = {name: load(name) for name in _ROBOTS}
    seconds: dict[str, list[float]] = {name: [] for name in (*_ROBOTS, "import")}
    sizes = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in progress(range(rounds + 1), "writing pages", rounds + 1):
            seconds["import"].append(_import_seconds())
            for name, robot in robots.items():  # in turns, so that a slow phase of the machine hits all alike
                started = time.perf_counter()
                written = export_html(Path(folder) / f"{name}.html", robot)
                seconds[name].append(time.perf_counter() - started)
                sizes[name] = written.stat().st_size / 1e6
    medians = {name: statistics.median(taken[1:]) for name, taken in seconds.items()}  # the first round warms up
    rows = [
        {
            "robot": name,
            "ms": medians[name] * 1e3,
            "import_ms": medians["import"] * 1e3,
            "ratio": medians[name] / medians["import"],
            "mb": sizes[name],
        }
        for name in _ROBOTS
    ]
    headings = (
        Heading("robot", "page of"),
        Heading("ms", "[ms]", ".0f"),
        Heading("import_ms", "import pinocchio [ms]", ".0f"),
        Heading("ratio", "ratio", ".2f"),
        Heading("mb", "size [MB]", ".2f"),
    )
    sheet = Sheet("rows", f"pages in a warm process, median of {rounds} rounds", headings, rows)
    bounds = [
        Promise("nao's page / import pinocchio", medians["nao"] / medians["import"], 1.0, at_least=False),
        Promise("nao's page [MB]", sizes["nao"], 1.5, at_least=False),
    ]
    conclude(machine, [sheet], bounds, [], format, goals)


def _import_seconds() -> float:
    import subprocess

    done = subprocess.run((sys.executable, "-c", _IMPORT), check=True, capture_output=True, text=True)  # noqa: S603 - our own constant program
    return float(done.stdout)
