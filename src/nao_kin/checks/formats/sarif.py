"""Findings as SARIF 2.1.0, which code hosts show beside the changed lines (OASIS, 27 March 2020)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

import nao_kin
from nao_kin.checks.baseline import fingerprint
from nao_kin.checks.catalogue import CATALOGUE

if TYPE_CHECKING:
    from nao_kin.checks.catalogue import Entry
    from nao_kin.checks.finding import Finding, Report

__all__ = ["SCHEMA", "as_sarif"]

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
