"""What a check has found: one defect of a URDF file, and all of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.table import Style, Table

__all__ = ["Finding", "Report", "Severity"]


class Severity(StrEnum):
    """How bad a finding is."""

    error = "error"
    """Some reader refuses the file, loads another robot than is meant, or the model is impossible."""

    warning = "warning"
    """It loads, but is nearly certainly not what was meant."""

    note = "note"
    """Worth knowing; working robots have it on purpose."""

    @property
    def rank(self) -> int:
        """0 for the worst."""
        return tuple(Severity).index(self)


@dataclass(frozen=True, slots=True)
class Finding:
    """One defect of a file.

    Attributes:
        path: The file as named by the caller.
        line: Line, 1-based, or None where the whole file is meant.
        column: First character of the place on the line, 1-based; 0 where only the line is known.
        width: Number of characters of the place.
        code: Name of the broken rule; `nao-kin explain` takes it.
        severity: How bad it is.
        element: The element, for example ``"axis of joint 'elbow'"``.
        message: What is wrong, one sentence.
        hint: What to do about it; may be empty.
        source: The line's text; may be empty.
    """

    path: str
    line: int | None
    column: int
    width: int
    code: str
    severity: Severity
    element: str
    message: str
    hint: str = ""
    source: str = field(default="", repr=False)

    @property
    def place(self) -> str:
        """The place as compilers print it, ``path:line:column`` as far as it is known."""
        return ":".join([self.path, *(str(n) for n in (self.line, self.column) if n)])

    @property
    def order(self) -> tuple[str, int, int, str, str]:
        """What findings are sorted by: file, line, column, code."""
        return self.path, self.line or 0, self.column, self.code, self.message

    def __str__(self) -> str:
        return f"{self.place}: {self.severity} {self.code}: {self.message}"


@dataclass(frozen=True, slots=True)
class Report:
    """All findings of one or more files, sorted by file, line, column and code, none twice.

    Attributes:
        paths: The files that were checked, as named by the caller.
        findings: The findings.
        incomplete: Pairs of path and code of which there are more findings than are listed.
    """

    paths: tuple[str, ...]
    findings: tuple[Finding, ...]
    incomplete: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(
        cls, paths: Iterable[str], findings: Iterable[Finding], incomplete: Iterable[tuple[str, str]] = ()
    ) -> Report:
        """A report on the paths, of findings in any order; `incomplete` as in the attribute."""
        unique = {finding.order: finding for finding in findings}
        return cls(tuple(paths), tuple(unique[key] for key in sorted(unique)), tuple(sorted(set(incomplete))))

    @classmethod
    def joined(cls, reports: Iterable[Report]) -> Report:
        """One report of several."""
        every = list(reports)
        return cls.of(
            (path for report in every for path in report.paths),
            (finding for report in every for finding in report.findings),
            (pair for report in every for pair in report.incomplete),
        )

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def __bool__(self) -> bool:
        raise TypeError("A report is neither true nor false: ask for .errors, .warnings or .findings.")

    def of_severity(self, severity: Severity) -> tuple[Finding, ...]:
        """The findings of one severity."""
        return tuple(finding for finding in self.findings if finding.severity is severity)

    @property
    def errors(self) -> tuple[Finding, ...]:
        """Findings of severity error."""
        return self.of_severity(Severity.error)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Findings of severity warning."""
        return self.of_severity(Severity.warning)

    @property
    def notes(self) -> tuple[Finding, ...]:
        """Findings of severity note."""
        return self.of_severity(Severity.note)

    @property
    def codes(self) -> tuple[str, ...]:
        """The codes that occur, sorted."""
        return tuple(sorted({finding.code for finding in self.findings}))

    def at_or_above(self, threshold: Severity) -> tuple[Finding, ...]:
        """The findings at least as bad as the threshold."""
        return tuple(finding for finding in self.findings if finding.severity.rank <= threshold.rank)

    def summary(self) -> str:
        """How many findings of each severity, in words."""
        counts = Counter(finding.severity for finding in self.findings)
        parts = [f"{counts[kind]} {kind}{'' if counts[kind] == 1 else 's'}" for kind in Severity if counts[kind]]
        files = "1 file" if len(self.paths) == 1 else f"{len(self.paths)} files"
        return f"{', '.join(parts) or 'no findings'} in {files}"

    def table(self) -> Table:
        """The findings, one a row."""
        from nao_kin.table import Column, Table

        styles: dict[Severity, Style] = {Severity.error: "bad", Severity.note: "faint"}
        rows = tuple((f.place, f.severity.value, f.code, f.message) for f in self.findings)
        columns = (Column("place"), Column("severity"), Column("code"), Column("message"))
        colours = {row: styles.get(f.severity, "") for row, f in enumerate(self.findings)}
        return Table(columns, rows, note=self.summary(), styles=colours)

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()

    def __repr__(self) -> str:
        return f"<Report: {self.summary()}>"
