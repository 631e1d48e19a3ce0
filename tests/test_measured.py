"""No figure in README and docs that a command does not print.

A measured table is written by tools/bench_page.py from a kept run. Whatever other figure a page has in its prose is
looked up here, or stands in a section that names the command which prints it.
"""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import nao_kin as nk
from nao_kin.bench import bench

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tools"))

import bench_page  # noqa: E402

MEASURED = re.compile(r"<!-- measured:.*?<!-- /measured -->", flags=re.DOTALL)
CODE = re.compile(r"^```.*?^```", flags=re.DOTALL | re.MULTILINE)
COMMAND = re.compile(r"nao-kin [a-z]+|python tools/")
FIGURE = re.compile(r"(?<![\w.])(\d[\d.]*(?:e-?\d+)?) ?(%|µs|ms|seconds?|times|mm|µm|MB|GB|µrad|rad)(?!\w)")
WRITTEN = {"benchmarks.md", "changes.md"}  # wholly by the tool, and the changelog
PAGES = [ROOT / "README.md", *(page for page in sorted((ROOT / "docs").glob("*.md")) if page.name not in WRITTEN)]


def below_ankle(frame: str) -> float:
    """How far a frame is below the ankle's axes [mm], with NAO standing upright."""
    robot = nk.load("nao")
    return -1e3 * float(robot.pose({}, frame, "l_ankle").translation[2])


def module(name: str) -> ModuleType:
    return importlib.import_module(f"nao_kin.{name}")  # a command's function hides its module from an import


SOURCES: dict[tuple[str, str], Callable[[], str]] = {
    ("README.md", "15 times"): lambda: f"{module('bench.bench_fk')._GOALS['Jacobians']:g} times",
    ("README.md", "4 times"): lambda: f"{module('bench.bench_ik')._POSE_GOALS[0]:g} times",
    ("README.md", "3 times"): lambda: f"{module('bench.bench_reach')._TIMES:g} times",
    ("check.md", "64 MB"): lambda: f"{module('checks.rules.mesh_rules')._BYTES // 1024**2} MB",
    ("many-solutions.md", "0.5 rad"): lambda: "0.5 rad",  # the argument beside it
    ("notation.md", "45.11 mm"): lambda: f"{below_ankle('l_sole'):.2f} mm",
    ("notation.md", "45.19 mm"): lambda: f"{below_ankle('LLeg'):.2f} mm",
    ("streaming.md", "12 ms"): lambda: f"{1e3 * module('motion.loop.guard').NAO_PERIOD:g} ms",
}


def sections(page: Path) -> list[str]:
    text = MEASURED.sub("", page.read_text(encoding="utf-8"))
    return re.split(r"^#+ ", text, flags=re.MULTILINE)


def figures(section: str) -> list[str]:
    prose = re.sub(r"`[^`]*`", "", CODE.sub("", section))
    return [f"{number} {unit}" for number, unit in FIGURE.findall(prose)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_figure_in_prose_has_a_source(page: Path) -> None:
    for section in sections(page):
        if page.name == "README.md":  # there the command stands on the same line
            section = "\n".join(line for line in section.splitlines() if not COMMAND.search(line))
        printed = COMMAND.search(section) is not None
        unsaid = [figure for figure in figures(section) if (page.name, figure) not in SOURCES]
        assert printed or not unsaid, (
            f"{page.name}: name the command that prints {unsaid}, or say it in a measured table"
        )


@pytest.mark.parametrize(("page", "figure"), SOURCES)
def test_a_figure_with_a_source_is_what_the_source_says(page: str, figure: str) -> None:
    assert SOURCES[page, figure]() == figure
    (path,) = (each for each in PAGES if each.name == page)
    assert figure in [each for section in sections(path) for each in figures(section)]


def test_measured_tables_are_those_of_the_kept_runs() -> None:
    for path, text in bench_page.written().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name}: run python tools/bench_page.py"


def test_readme_and_docs_show_measured_tables() -> None:
    shown = {page.name for page in PAGES if MEASURED.search(page.read_text(encoding="utf-8"))}
    assert {"README.md", "choose-a-method.md"} <= shown


def test_kept_runs_are_of_commands_that_exist_with_the_peers_that_they_name() -> None:
    commands = {command.name or command.callback.__name__ for command in bench.registered_commands}
    for name, report in bench_page.kept().items():
        assert name in commands
        versions = report["machine"]["versions"]
        assert {"pin", "numpy", "numba"} <= versions.keys()
        if "--peers" in bench_page.RUNS[name]:
            assert {"ssik", "eaik"} <= versions.keys(), f"measure {name} where its peers are installed"
    assert "roboticstoolbox" in [row["solver"] for row in bench_page.kept()["ik"]["single_pose"]]
