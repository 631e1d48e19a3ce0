"""Every format says the same: text as recorded, SARIF by its schema, JUnit by a parser of its own, commands escaped."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import pytest
from lxml import etree
from tests.conftest import needs

from nao_kin.checks.checker import check_bytes
from nao_kin.checks.finding import Finding, Report, Severity
from nao_kin.checks.formats.machine import as_data, as_github, as_junit, as_sarif
from nao_kin.checks.formats.text import as_text

DATA = Path(__file__).parent / "data"
NASTY = '<script>alert("1")</script> & \x1b[31m \u202e \ud800 % :: \r\n]]>'


def sample() -> Report:
    return check_bytes((DATA / "sample.urdf").read_bytes(), "robots/sample.urdf")


def nasty() -> Report:
    finding = Finding(NASTY, 3, 2, 4, "zero-axis", Severity.error, NASTY, NASTY, NASTY, NASTY)
    whole_file = Finding("a b.urdf", None, 0, 0, "empty-file", Severity.error, "file", "The file is empty.")
    return Report.of([NASTY, "a b.urdf", "clean.urdf"], [finding, whole_file], [(NASTY, "zero-axis")])


@pytest.mark.parametrize(("colour", "name"), [(False, "sample.txt"), (True, "sample.colour.txt")])
def test_text_is_as_recorded(colour: bool, name: str) -> None:
    assert as_text(sample(), colour=colour) + "\n" == (DATA / name).read_text(encoding="utf-8")


def test_text_is_80_columns_wide_and_colour_adds_nothing() -> None:
    plain, coloured = as_text(sample()), as_text(sample(), colour=True)
    assert max(map(len, plain.split("\n"))) <= 80
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured) == plain


def test_text_gives_no_control_to_the_file() -> None:
    text = as_text(nasty())
    assert all(line.isprintable() for line in text.split("\n"))


@pytest.mark.parametrize("report", [sample(), nasty(), Report.of(["clean.urdf"], [])], ids=["sample", "nasty", "clean"])
def test_sarif_is_valid(report: Report) -> None:
    jsonschema = needs("jsonschema")
    schema = json.loads((DATA / "sarif-2.1.0-rtm.5.json").read_text(encoding="utf-8"))
    log = as_sarif(report)
    jsonschema.validate(json.loads(json.dumps(log)), schema, format_checker=jsonschema.FormatChecker())
    (run,) = log["runs"]
    assert [result["ruleId"] for result in run["results"]] == [finding.code for finding in report]
    rules = run["tool"]["driver"]["rules"]
    assert all(rules[result["ruleIndex"]]["id"] == result["ruleId"] for result in run["results"])


def test_sarif_names_the_place() -> None:
    (result,) = (r for r in as_sarif(sample())["runs"][0]["results"] if r["ruleId"] == "zero-axis")
    (location,) = result["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "robots/sample.urdf"},
        "region": {"startLine": 14, "startColumn": 16, "endColumn": 21},
    }


@pytest.mark.parametrize("report", [sample(), nasty()], ids=["sample", "nasty"])
def test_junit_is_read_by_a_parser_of_its_own(report: Report) -> None:
    junitparser = needs("junitparser")
    suites = list(junitparser.JUnitXml.fromstring(as_junit(report).encode()))
    assert len(suites) == len(report.paths)
    cases = [case for suite in suites for case in suite]
    failed = [case for case in cases if any(isinstance(result, junitparser.Failure) for result in case.result)]
    assert len(failed) == len(report.errors)
    assert sum(suite.failures for suite in suites) == len(report.errors)
    assert sum(suite.tests for suite in suites) == len(cases)


def test_junit_counts_from_the_threshold_on() -> None:
    def failures(threshold: Severity) -> int:
        return len(etree.parse(io.BytesIO(as_junit(sample(), threshold).encode())).findall(".//failure"))

    report = sample()
    assert failures(Severity.error) == len(report.errors) > 0
    assert failures(Severity.warning) == len(report.errors) + len(report.warnings) > failures(Severity.error)


def test_a_workflow_command_is_one_line_that_the_file_cannot_leave() -> None:
    lines = as_github(nasty()).split("\n")
    assert len(lines) == 2
    assert lines[0].startswith("::error file=")
    assert "\r" not in lines[0]
    assert lines[0].count("::") == 4  # the two of the command; those in message and hint mean nothing there
    assert lines[1] == "::error file=a b.urdf,title=empty-file::The file is empty."


def test_json_carries_everything() -> None:
    data = as_data(sample())
    assert data["errors"] == len(sample().errors)
    assert [row["code"] for row in data["findings"]] == [finding.code for finding in sample()]
    row = next(row for row in data["findings"] if row["code"] == "zero-axis")
    assert (row["line"], row["column"], row["width"], row["severity"]) == (14, 16, 5, "error")


def test_a_report_is_sorted_without_repeats_and_neither_true_nor_false() -> None:
    findings = sample().findings
    again = Report.of(["robots/sample.urdf"], [*reversed(findings), *findings])
    assert again.findings == findings
    assert [finding.line for finding in findings] == sorted(finding.line or 0 for finding in findings)
    with pytest.raises(TypeError, match="neither true nor false"):
        bool(again)
    assert "unknown-child" in again._repr_html_()
    assert "<script>" not in nasty()._repr_html_()
