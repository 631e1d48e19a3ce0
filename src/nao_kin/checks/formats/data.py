"""Findings for programs, as plain data for JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from nao_kin.checks.finding import Finding, Report

__all__ = ["LAYOUT", "as_data"]

LAYOUT: Final = 1
"""Number of the layout; it changes when a reader of the old one would break."""


def as_data(report: Report) -> dict[str, Any]:
    """The report as dictionaries, lists, texts and numbers."""
    return {
        "layout": LAYOUT,
        "paths": list(report.paths),
        "errors": len(report.errors),
        "warnings": len(report.warnings),
        "notes": len(report.notes),
        "findings": [_finding_data(finding) for finding in report.findings],
        "incomplete": [{"path": path, "code": code} for path, code in report.incomplete],
    }


def _finding_data(finding: Finding) -> dict[str, Any]:
    return {
        "path": finding.path,
        "line": finding.line,
        "column": finding.column or None,
        "width": finding.width or None,
        "code": finding.code,
        "severity": finding.severity.value,
        "element": finding.element,
        "message": finding.message,
        "hint": finding.hint,
    }
