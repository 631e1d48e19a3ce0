"""What a benchmark says: sheets of measured rows, goals met or missed, and the machine it all was measured on."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.output import OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.table import Table

__all__ = ["SOLVED_MEANS", "GoalsOption", "Heading", "Machine", "PeersOption", "Promise", "Sheet", "conclude"]

GoalsOption = Annotated[bool, typer.Option("--goals/--no-goals", help="Exit with 1 when a goal is missed.")]
PeersOption = Annotated[bool, typer.Option("--peers", help="Measure every installed peer beside.")]

SOLVED_MEANS = (
    "Solved: Pinocchio on the whole model confirms 1e-6 m, 1e-6 rad and all limits; near: 1e-4 m, 1e-3 rad and limits."
)


@dataclass(frozen=True, slots=True)
class Heading:
    """One column of a sheet: the key in its rows, the text above it, and how its numbers print ("" for text)."""

    key: str
    text: str
    spec: str = ""

    def cell(self, row: Mapping[str, Any]) -> str:
        """The text of this column in a row; what was not measured stays empty."""
        value = row.get(self.key)
        if value is None:
            return ""
        return format(value, self.spec) if self.spec else str(value)


@dataclass(frozen=True, slots=True)
class Sheet:
    """Measured rows under headings.

    Attributes:
        name: Key in the JSON report.
        title: What was measured, and in which unit.
        headings: The columns that are printed; rows may hold more for the JSON report.
        rows: Plain data.
    """

    name: str
    title: str
    headings: tuple[Heading, ...]
    rows: Sequence[Mapping[str, Any]]

    def table(self) -> Table:
        """The sheet as a table for people."""
        from nao_kin.table import Column, Table

        columns = tuple(Column(heading.text, number=bool(heading.spec)) for heading in self.headings)
        cells = tuple(tuple(heading.cell(row) for heading in self.headings) for row in self.rows)
        return Table(columns, cells, title=self.title)


@dataclass(frozen=True, slots=True)
class Promise:
    """A promise and what was measured of it.

    Attributes:
        what: The quantity.
        value: Its measured value.
        bound: What it should be.
        at_least: Whether the bound is the least or the greatest value that will do.
    """

    what: str
    value: float
    bound: float
    at_least: bool = True

    @property
    def met(self) -> bool:
        """Whether the promise holds; a value that is not a number meets nothing."""
        return self.value >= self.bound if self.at_least else self.value <= self.bound


@dataclass(frozen=True)
class Machine:
    """Where it was measured. Make one before measuring: the load is to be that of others, not our own."""

    python: str = field(default_factory=platform.python_version)
    processor: str = field(default_factory=platform.machine)
    cores: int = field(default_factory=lambda: len(os.sched_getaffinity(0)))
    load: float | None = field(default_factory=lambda: _load())
    versions: dict[str, str] = field(default_factory=lambda: _versions("pin", "numpy", "numba"))

    @property
    def warning(self) -> str:
        """What to think of the figures if others were using the machine; empty if it was quiet."""
        if self.load is None or self.load <= 0.5 * self.cores:
            return ""
        return "The machine was busy: what runs on all cores suffers most, so repeat before believing a missed goal."

    def __str__(self) -> str:
        packages = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        load = "" if self.load is None else f", load {self.load:.1f} at the start"
        what = f"Python {self.python}, {packages}; {self.processor}, {self.cores} cores{load}."
        return f"{what} {self.warning}".rstrip()


def _load() -> float | None:
    try:
        return os.getloadavg()[0]
    except OSError:
        return None


def _versions(*packages: str) -> dict[str, str]:
    import importlib.metadata

    return {package: importlib.metadata.version(package) for package in packages}


def conclude(
    machine: Machine,
    sheets: Sequence[Sheet],
    goals: Sequence[Promise],
    notes: Sequence[str],
    format: OutputFormat,
    enforce: bool,
) -> None:
    """Prints everything.

    Raises:
        typer.Exit: With status 1, if goals are enforced and one is missed.
    """
    if format is OutputFormat.json:
        data: dict[str, Any] = {
            "machine": asdict(machine),
            "notes": list(notes),
            "goals": [asdict(goal) | {"met": goal.met} for goal in goals],
            "sheets": [
                {"name": sheet.name, "title": sheet.title, "columns": [asdict(heading) for heading in sheet.headings]}
                for sheet in sheets
            ],
        }
        report_json(data | {sheet.name: [dict(row) for row in sheet.rows] for sheet in sheets})
    else:
        for sheet in sheets:
            report(sheet.table(), "")
        report(_goal_table(goals), *notes, str(machine))
    if enforce and not all(goal.met for goal in goals):
        raise typer.Exit(1)


def _goal_table(goals: Sequence[Promise]) -> Table:
    from nao_kin.table import Column, Style, Table

    columns = (Column("goal"), Column("is", number=True), Column("should be", number=True), Column("met"))
    rows, styles = [], dict[int, Style]()
    for index, goal in enumerate(goals):
        bound = f"{'≥' if goal.at_least else '≤'} {goal.bound:.4g}"
        rows.append((goal.what, f"{goal.value:.4g}", bound, "yes" if goal.met else "NO"))
        styles[index] = "good" if goal.met else "bad"
    return Table(columns, tuple(rows), styles=styles)
