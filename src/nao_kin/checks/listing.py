"""The findings of one file as they come in, bounded in number, each with its place."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.checks.finding import Finding, Report
from nao_kin.urdf.outline import describe
from nao_kin.urdf.positions import Place

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from nao_kin.checks.subject import Subject
    from nao_kin.errors import UrdfError
    from nao_kin.urdf.outline import Defect

__all__ = ["MOST_OF_A_CODE", "Listing", "bounded", "finding_of"]

MOST_OF_A_CODE: Final = 100
"""Findings of one code that are listed for one file; nobody reads more, and a hostile file has millions."""

_QUOTED: Final = 4 * 1024 * 1024  # [bytes] of larger files that are no XML no line is quoted


def finding_of(subject: Subject, defect: Defect) -> Finding:
    """A defect with its place in the text and the severity that the catalogue gives it."""
    place, said = subject.positions.place(defect), defect.message
    path, source = subject.path, subject.positions.line_text(place.line)
    line: int | None = place.line
    if subject.expansion is not None:
        place, traced = Place(place.line), subject.expansion.place(subject.outline.root, defect)
        if traced is None:
            line, said = None, f"{said.rstrip('.')} (line {line} of the expanded file)."
        else:
            (path, line), source = traced, subject.expansion.line_text(*traced)
    return Finding(
        path=path,
        line=line,
        column=place.column,
        width=place.width,
        code=defect.code,
        severity=CATALOGUE[defect.code].severity,
        element=describe(defect.at),
        message=said,
        hint=defect.hint,
        source=source,
    )


def bounded(defects: Iterator[Defect]) -> Iterator[Defect]:
    """The first defects of a rule, up to one more than is listed of the code that it finds most."""
    counts: Counter[str] = Counter()
    for defect in defects:
        yield defect
        counts[defect.code] += 1
        if counts[defect.code] > MOST_OF_A_CODE:
            return


@dataclass
class Listing:
    """The findings of one file as they come in."""

    path: str
    select: Collection[str]
    ignore: Collection[str]
    findings: list[Finding] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)

    def add(self, subject: Subject, defects: Iterable[Defect]) -> None:
        """Takes up the wanted ones, of each code as many as are listed."""
        for defect in defects:
            if self._wanted(defect.code):
                self.counts[defect.code] += 1
                if self.counts[defect.code] <= MOST_OF_A_CODE:
                    self.findings.append(finding_of(subject, defect))

    def report(self) -> Report:
        """All that has come in."""
        crowded = [(self.path, code) for code, count in self.counts.items() if count > MOST_OF_A_CODE]
        return Report.of([self.path], self.findings, crowded)

    def report_refusal(self, refusal: UrdfError, data: bytes) -> Report:
        """The report on a file that never became a tree."""
        lines = data.decode("utf-8", "replace").split("\n") if refusal.line and len(data) < _QUOTED else []
        source = lines[refusal.line - 1].rstrip("\r") if refusal.line and refusal.line <= len(lines) else ""
        code, severity = refusal.code, CATALOGUE[refusal.code].severity
        if self._wanted(code):
            self.findings.append(
                Finding(refusal.path, refusal.line, 0, 0, code, severity, "file", refusal.reason, refusal.hint, source)
            )
        return self.report()

    def _wanted(self, code: str) -> bool:
        return code not in self.ignore and (not self.select or code in self.select)
