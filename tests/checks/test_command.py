"""`nao-kin check` and `nao-kin explain` as a person or a CI job meets them."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import nao_kin as nk
from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.checks.checker import departure_finding
from nao_kin.cli.app import main

ROOT = Path(__file__).parent.parent.parent
CORPUS = ROOT / "tests" / "corpus"
NAO = ROOT / "urdf" / "nao_v50_h25.urdf"
JACO = ROOT / "urdf" / "jaco2.urdf"
BAD, WARNED, CLEAN = CORPUS / "zero-axis.urdf", CORPUS / "axis-not-unit.urdf", CORPUS / "zero-axis.passes.urdf"


class Done(NamedTuple):
    """What a command has done."""

    returncode: int
    stdout: str
    stderr: str


Run = Callable[..., Done]


def departures(done: Done) -> list[dict[str, Any]]:
    """What a comparison has found, without the notes on the file itself."""
    return [finding for finding in json.loads(done.stdout)["findings"] if finding["severity"] != "note"]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs the command in this process; tests/test_cli.py starts real ones."""
    for name in ("FORCE_COLOR", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)

    def run_here(*arguments: object, **environment: str) -> Done:
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        monkeypatch.setattr(sys, "argv", ["nao-kin", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return Done(int(ended.value.code or 0), *capsys.readouterr())

    return run_here


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ([CLEAN], 0),
        ([BAD], 1),
        ([WARNED], 0),
        ([WARNED, "--strict"], 1),
        ([WARNED, "--strict", "--ignore", "axis-not-unit"], 0),
        ([BAD, "--ignore", "cycle,zero-axis"], 0),
        ([BAD, "--select", "cycle"], 0),
        ([BAD, CLEAN], 1),
        ([CORPUS / "folder"], 1),
        ([CORPUS / "zero-axis*.urdf"], 1),
        ([NAO, "--strict"], 0),
        (["jaco2", "--strict"], 0),
        ([CORPUS / "no_such.urdf", BAD], 2),
        ([CORPUS / "no_such*.urdf"], 2),
        ([CORPUS / "meshes"], 2),
        ([BAD, "--ignore", "zero-axs"], 2),
        ([BAD, "--package", "a=no_such_folder"], 2),
        ([BAD, "--package", "a"], 2),
        ([BAD, "--update-baseline"], 2),
        ([BAD, "--baseline", CORPUS / "lines.csv"], 2),
        ([BAD, "--baseline", "no_such.json"], 2),
        ([BAD, "--format", "xml"], 2),
        ([BAD, CLEAN, "--dh", "table.toml"], 2),
        ([], 2),
    ],
    ids=lambda value: " ".join(Path(str(v)).name for v in value) if isinstance(value, list) else "",
)
def test_exit_status(run: Run, arguments: list[object], status: int) -> None:
    done = run("check", *arguments)
    assert done.returncode == status, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert bool(done.stderr) == (status == 2)


def test_an_unreadable_file_does_not_keep_the_others_from_being_checked(run: Run) -> None:
    done = run("check", CORPUS / "no_such.urdf", BAD)
    assert "no_such.urdf: There is no such file" in done.stderr
    assert "zero-axis" in done.stdout


def test_standard_input_is_checked_without_a_folder() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "nao_kin", "check", "-", "--format", "json"],
        input=(CORPUS / "mesh-unit.urdf").read_bytes(),
        capture_output=True,
        check=False,
    )
    (finding,) = departures(done)
    assert (finding["path"], finding["code"]) == ("<stdin>", "mesh-package")


def test_a_baseline_lets_only_new_findings_fail(run: Run, tmp_path: Path) -> None:
    path, baseline = tmp_path / "arm.urdf", tmp_path / "baseline.json"
    path.write_text(BAD.read_text())
    recorded = run("check", path, "--baseline", baseline, "--update-baseline")
    assert (recorded.returncode, recorded.stdout) == (0, "")
    assert run("check", path, "--baseline", baseline).returncode == 0
    path.write_text("\n\n" + BAD.read_text())
    assert run("check", path, "--baseline", baseline).returncode == 0
    path.write_text(BAD.read_text().replace("child link", "child lnk"))
    again = run("check", path, "--baseline", baseline)
    assert again.returncode == 1
    assert "no-child" in again.stdout
    assert "zero-axis" not in again.stdout


@pytest.mark.parametrize("name", ["json", "sarif"])
def test_machine_formats_are_all_there_is_on_standard_output(run: Run, name: str) -> None:
    done = run("check", BAD, "--format", name)
    assert json.loads(done.stdout)
    assert done.stderr == ""


def test_colours_only_where_they_are_wanted(run: Run) -> None:
    assert "\x1b[" not in run("check", BAD).stdout
    assert "\x1b[" in run("check", BAD, FORCE_COLOR="1").stdout
    assert "\x1b[" not in run("check", BAD, FORCE_COLOR="1", NO_COLOR="1").stdout


def test_a_table_that_departs_is_a_finding_at_its_joint(run: Run, tmp_path: Path) -> None:
    table = tmp_path / "table.toml"
    table.write_text(nk.document_chain("practicum_jaco2").to_toml())
    done = run("check", JACO, "--dh", table, "--format", "json")
    assert done.returncode == 1
    (finding,) = departures(done)
    text = JACO.read_text().split("\n")
    assert (finding["code"], finding["severity"]) == ("departs-from-table", "error")
    assert "row 5 (joint_5): d" in finding["hint"]
    assert '<joint name="joint_5"' in text[finding["line"] - 1]
    table.write_text(nk.document_chain("kofinas_left_arm").to_toml())
    assert run("check", NAO, "--dh", table).returncode == 0


def test_another_model_that_departs_is_a_finding_at_each_joint(run: Run, tmp_path: Path) -> None:
    assert run("check", NAO, "--against", ROOT / "urdf" / "nao_v60_h25.urdf").returncode == 0
    other = tmp_path / "other.urdf"
    other.write_text(JACO.read_text().replace('name="joint_3"', 'name="joint_three"'))
    done = run("check", JACO, "--against", other, "--format", "json")
    (finding,) = departures(done)
    assert "joint_three" in finding["message"]
    other.write_text(JACO.read_text().replace("0.2073", "0.2083"))
    (finding,) = departures(run("check", JACO, "--against", other, "--format", "json"))
    assert finding["code"] == "departs-from-model"
    assert "1 mm" in finding["message"]


def test_ends_that_sit_elsewhere_are_a_finding_at_the_joint_above(run: Run, tmp_path: Path) -> None:
    other = tmp_path / "other.urdf"
    text = JACO.read_text()
    above = text[text.index('<child link="end_effector"/>') :]
    origin = above[above.index("<origin") : above.index("/>", above.index("<origin"))]
    other.write_text(text.replace(origin, '<origin xyz="0 0 -0.2" rpy="0 0 0"'))
    (finding,) = departures(run("check", JACO, "--against", other, "--format", "json"))
    assert "only the ends differ" in finding["message"]
    assert '<child link="end_effector"/>' in "".join(text.split("\n")[finding["line"] - 1 : finding["line"] + 2])


def test_a_frame_or_a_joint_that_the_other_model_lacks_is_a_finding(run: Run, tmp_path: Path) -> None:
    other = tmp_path / "other.urdf"
    other.write_text(JACO.read_text().replace('"end_effector"', '"tool"'))
    (finding,) = departures(run("check", JACO, "--against", other, "--format", "json"))
    assert "'end_effector' is not in" in finding["message"]
    other.write_text(JACO.read_text().replace('"link_base"', '"base"'))
    (finding,) = departures(run("check", JACO, "--against", other, "--format", "json"))
    assert "nothing can be compared" in finding["message"]
    done = run("check", BAD, "--against", JACO)
    assert "was not compared" in done.stderr


def test_a_departure_without_a_joint_stands_at_the_root() -> None:
    finding = departure_finding(CLEAN, "departs-from-model", None, "They differ.")
    assert (finding.line, finding.column) == (1, 14)


@pytest.mark.parametrize("code", CATALOGUE)
def test_every_code_is_explained(code: str) -> None:
    from nao_kin.cli.explain_command import _text

    text = _text(CATALOGUE[code])
    assert text.startswith(f"{code} ({CATALOGUE[code].severity})")
    assert "Why it matters" in text
    assert "How to fix it" in text


def test_explain_prints_one_code_or_lists_them_all(run: Run) -> None:
    done = run("explain", "zero-axis")
    assert done.returncode == 0
    assert '<axis xyz="0 0 0"/>' in done.stdout
    listed = run("explain").stdout
    assert all(code in listed for code in CATALOGUE)
    assert [row["code"] for row in json.loads(run("explain", "--format", "json").stdout)] == list(CATALOGUE)
    wrong = run("explain", "zero-axs")
    assert wrong.returncode == 2
    assert "Did you mean 'zero-axis'" in wrong.stderr
