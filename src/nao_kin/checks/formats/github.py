"""Findings as workflow commands, which GitHub Actions turns into annotations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.checks.finding import Severity

if TYPE_CHECKING:
    from nao_kin.checks.finding import Finding, Report

__all__ = ["as_github"]

_LEVELS: Final = {Severity.error: "error", Severity.warning: "warning", Severity.note: "notice"}


def as_github(report: Report) -> str:
    """One command a finding, each on a line of its own."""
    return "\n".join(map(_command, report.findings))


def _command(finding: Finding) -> str:
    properties = {"file": finding.path, "line": finding.line, "col": finding.column or None, "title": finding.code}
    given = ",".join(f"{key}={_escaped(str(value), ':,')}" for key, value in properties.items() if value is not None)
    return f"::{_LEVELS[finding.severity]} {given}::{_escaped(f'{finding.message} {finding.hint}'.rstrip())}"


def _escaped(text: str, more: str = "") -> str:
    """The text as a command's value; an unescaped line break would begin a command of the file's choosing."""
    return "".join(f"%{ord(c):02X}" if c in f"%\r\n{more}" else c for c in text)
