"""Reports for machines: JSON, workflow commands, JUnit and SARIF."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

from lxml import etree

import nao_kin
from nao_kin.checks.baseline import fingerprint
from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.checks.finding import Severity

if TYPE_CHECKING:
    from nao_kin.checks.catalogue import Entry
    from nao_kin.checks.finding import Finding, Report

__all__ = ["LAYOUT", "SCHEMA", "as_data", "as_github", "as_junit", "as_sarif"]

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


SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"


def as_sarif(report: Report) -> dict[str, Any]:
    """The report as a SARIF log of one run, its rules those that occur."""
    driver = {
        "name": "nao-kin check",
        "version": nao_kin.__version__,
        "rules": [_rule(CATALOGUE[code]) for code in report.codes],
    }
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "artifacts": [{"location": {"uri": _uri(path)}} for path in dict.fromkeys(report.paths)],
        "results": [_result(finding, report.codes.index(finding.code)) for finding in report.findings],
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(entry: Entry) -> dict[str, Any]:
    return {
        "id": entry.code,
        "shortDescription": {"text": entry.what},
        "fullDescription": {"text": entry.why},
        "help": {"text": f"{entry.fix}\n\nWrong:\n{entry.bad}\n\nRight:\n{entry.good}"},
        "defaultConfiguration": {"level": entry.severity.value},
    }


def _result(finding: Finding, rule_index: int) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": _uri(finding.path)}}
    if finding.line:
        place["region"] = {"startLine": finding.line}
    if finding.line and finding.column:
        place["region"] |= {"startColumn": finding.column, "endColumn": finding.column + finding.width}
    return {
        "ruleId": finding.code,
        "ruleIndex": rule_index,
        "level": finding.severity.value,
        "message": {"text": f"{finding.message} {finding.hint}".rstrip()},
        "locations": [{"physicalLocation": place, "logicalLocations": [{"fullyQualifiedName": finding.element}]}],
        "partialFingerprints": {"naoKinFinding/v1": fingerprint(finding)},
    }


def _uri(path: str) -> str:
    if Path(path).is_absolute():
        return Path(path).as_uri()
    return quote(path.replace("\\", "/").encode("utf-8", "surrogatepass"))
