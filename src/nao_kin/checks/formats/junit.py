"""Findings as JUnit XML: a suite a file, a case a finding, a failure where it counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from nao_kin.checks.finding import Severity

if TYPE_CHECKING:
    from nao_kin.checks.finding import Finding, Report

__all__ = ["as_junit"]


def as_junit(report: Report, threshold: Severity = Severity.error) -> str:
    """The report as XML; findings below the threshold are cases that pass and say what was found.

    Args:
        report: The findings.
        threshold: What counts as a failure.
    """
    root = etree.Element("testsuites", name="nao-kin check")
    for path in dict.fromkeys(report.paths):
        findings = [finding for finding in report.findings if finding.path == path]
        failures = sum(finding.severity.rank <= threshold.rank for finding in findings)
        counts = {"tests": str(max(len(findings), 1)), "failures": str(failures), "errors": "0", "skipped": "0"}
        suite = etree.SubElement(root, "testsuite", {"name": _allowed(path), **counts})
        if not findings:
            etree.SubElement(suite, "testcase", name="no findings", classname=_allowed(path), time="0")
        for finding in findings:
            _case(suite, finding, failed=finding.severity.rank <= threshold.rank)
    return etree.tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True).decode("utf-8")


def _case(suite: etree._Element, finding: Finding, *, failed: bool) -> None:
    line = f" line {finding.line}" if finding.line else ""
    case = etree.SubElement(suite, "testcase", name=f"{finding.code}{line}", classname=_allowed(finding.path), time="0")
    text = _allowed("\n".join(filter(None, [str(finding), finding.source.strip(), finding.hint])))
    if failed:
        failure = etree.SubElement(case, "failure", type=finding.code, message=_allowed(finding.message))
        failure.text = text
    else:
        etree.SubElement(case, "system-out").text = text


def _allowed(text: str) -> str:
    """The text without the control characters that XML has no way to write."""
    return "".join(c if c.isprintable() or c in "\n\t" else "�" for c in text)
