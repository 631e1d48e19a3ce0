"""Every code has a file that has it, on a known line, and one that nearly has it and passes."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

import nao_kin as nk
from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.checks.finding import Severity

CORPUS = Path(__file__).parent.parent / "corpus"


def lines(folder: Path = CORPUS) -> dict[str, int | None]:
    with (folder / "lines.csv").open(encoding="utf-8", newline="") as file:
        return {row["code"]: int(row["line"]) if row["line"] else None for row in csv.DictReader(file)}


SRDF = CORPUS / "srdf"
SRDF_LINES = lines(SRDF)
ELSEWHERE = {
    "meshes-not-opened": "test_meshes.py, because its meshes have 65 MB",
    "xacro-failed": "tests/urdf/test_xacro.py, because the macros need a library",
    "xacro-refused": "tests/urdf/test_xacro_confined.py",
    **dict.fromkeys(SRDF_LINES, "below: an SRDF has it"),
    "departs-from-table": "test_command.py, because the command line compares",
    "departs-from-model": "test_command.py, because the command line compares",
}
# What a defect brings along by its nature; anything else would be a false alarm.
COMPANIONS = {
    "out-of-range": {"inertia-out-of-scale", "length-in-millimetres"},
    "unreachable-link": {"cycle"},
    "mesh-absolute": {"mesh-missing"},
    "readers-disagree": {"axis-not-unit"},
}


LINES = lines()
THOROUGH = {"readers-disagree", "weak-effort"}


def bad_file(code: str) -> Path:
    path = CORPUS / f"{code}.urdf"
    return path if path.exists() else CORPUS / "folder" / f"{code}.urdf"


@pytest.mark.parametrize("code", LINES)
def test_defect_is_found_on_its_line_and_nothing_else_alarms(code: str) -> None:
    report = nk.check(bad_file(code), thorough=code in THOROUGH)
    found = [finding for finding in report if finding.code == code]
    assert {finding.line for finding in found} == {LINES[code]}
    assert {finding.severity for finding in found} == {CATALOGUE[code].severity}
    alarms = {finding.code for finding in report.at_or_above(Severity.warning)}
    assert alarms - {code} <= COMPANIONS.get(code, set())


@pytest.mark.parametrize("code", LINES)
def test_near_miss_passes(code: str) -> None:
    report = nk.check(CORPUS / f"{code}.passes.urdf", thorough=code in THOROUGH)
    assert code not in report.codes
    assert report.at_or_above(Severity.warning) == ()


def test_every_code_occurs_and_is_explained() -> None:
    assert LINES.keys() | ELSEWHERE.keys() == CATALOGUE.keys()
    for entry in CATALOGUE.values():
        assert entry.what.endswith(".")
        assert entry.why.endswith(".")
        assert entry.fix
        assert entry.good


def test_every_file_of_the_corpus_is_used() -> None:
    files = {path.name for path in CORPUS.rglob("*.urdf") if path.parent != SRDF}
    assert files == {f"{code}{suffix}.urdf" for code in LINES for suffix in ("", ".passes")}


@pytest.mark.parametrize("code", SRDF_LINES)
def test_defect_of_an_srdf_is_found_on_its_line_and_its_near_miss_passes(code: str) -> None:
    report = nk.check(SRDF / f"{code}.srdf")
    assert [(finding.code, finding.line) for finding in report] == [(code, SRDF_LINES[code])]
    assert report.findings[0].severity is CATALOGUE[code].severity
    assert nk.check(SRDF / f"{code}.passes.srdf").findings == ()


def test_the_urdf_of_an_srdf_may_be_named() -> None:
    assert nk.check(SRDF / "srdf-without-urdf.srdf", urdf=SRDF / "arm.urdf").findings == ()


@pytest.mark.parametrize("code", LINES)
def test_the_caret_stands_under_what_is_meant(code: str) -> None:
    for finding in nk.check(bad_file(code), thorough=code in THOROUGH):
        if finding.column and finding.code not in {"processing-instruction", "colon-in-comment"}:  # which are in none
            text = bad_file(code).read_text(encoding="utf-8-sig").split("\n")[(finding.line or 1) - 1]
            marked = text[finding.column - 1 : finding.column - 1 + finding.width]
            before = text[: finding.column - 1]
            assert marked == marked.strip("<>\"'") or finding.code == "stray-blank"
            assert before.endswith(('"', "<")), f"{finding}: {marked!r}"


def test_a_select_and_an_ignore_are_obeyed_and_a_wrong_code_is_refused() -> None:
    path = CORPUS / "unreachable-link.urdf"
    assert nk.check(path).codes == ("cycle", "unreachable-link")
    assert nk.check(path, select=["cycle"]).codes == ("cycle",)
    assert nk.check(path, ignore=["cycle"]).codes == ("unreachable-link",)
    with pytest.raises(nk.NaoKinError, match="Did you mean 'cycle'"):
        nk.check(path, ignore=["cicle"])
