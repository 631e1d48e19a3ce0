"""docs/check.md says what the check does: its codes, its example, the robots it was tried on."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.checks.test_robots import KNOWN_ERRORS
from tests.urdf.macro_packages import FILES, write_packages

from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.checks.checker import MOST_OF_A_CODE, check_bytes
from nao_kin.checks.formats.text import as_text
from nao_kin.cli.app import main

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "check.md").read_text(encoding="utf-8")


def test_every_code_is_in_the_table_as_it_is_in_the_catalogue() -> None:
    rows = re.findall(r"^\| `([a-z0-9-]+)` \| (error|warning|note) \| (.+) \|$", PAGE, flags=re.MULTILINE)
    listed = [(code, severity, what.replace("\\", "")) for code, severity, what in rows]
    assert listed == [(entry.code, entry.severity.value, entry.what) for entry in CATALOGUE.values()]


def test_the_example_is_what_is_printed() -> None:
    data = (Path(__file__).parent / "data" / "sample.urdf").read_bytes()
    printed = as_text(check_bytes(data, "my_robot.urdf", select=["zero-axis"])).split("\n\n")[0]
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, flags=re.DOTALL)
    assert printed.strip() == shown.strip()


@pytest.mark.parametrize("path", KNOWN_ERRORS)
def test_every_known_error_is_explained(path: str) -> None:
    folder, _, name = path.rpartition("/")
    (row,) = (line for line in PAGE.split("\n") if line.startswith("|") and name in re.split(r"[ |,/]+", line))
    assert folder in row
    assert all(code in row for code in KNOWN_ERRORS[path])


def test_the_numbers_on_the_page() -> None:
    assert f"Of each code {MOST_OF_A_CODE} findings a file are listed" in PAGE
    assert f"{len(CATALOGUE)} codes" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_hook_runs_the_check_on_urdf_files() -> None:
    hook = (ROOT / ".pre-commit-hooks.yaml").read_text()
    assert "entry: nao-kin check\n" in hook
    (pattern,) = re.findall(r"files: (.*)", hook)
    for name, meant in (
        ("a/arm.urdf", True),
        ("arm.urdf.xacro", True),
        ("a.srdf", True),
        ("macros.xacro", False),
        ("a.xml", False),
    ):
        assert bool(re.search(pattern, name)) is meant
    assert "id: nao-kin-check" in PAGE


def test_the_job_of_the_page_runs_on_a_repository_with_urdf_xacro_and_srdf(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write_packages(tmp_path / "src")
    corpus = ROOT / "tests" / "corpus"
    folder = tmp_path / "urdf"
    folder.mkdir()
    for name in ("arm.urdf", "srdf-unknown-joint.srdf"):
        (folder / name).write_bytes((corpus / "srdf" / name).read_bytes())
    (folder / "bent.urdf").write_bytes((corpus / "zero-axis.urdf").read_bytes())
    nao = (tmp_path / "src" / FILES["nao"]).rename(folder / "nao.urdf.xacro")
    nao.with_name("lengths.xacro").write_bytes((tmp_path / "src/nao_description/urdf/lengths.xacro").read_bytes())
    (command,) = re.findall(r"- run: (nao-kin check .*)", PAGE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", command.split())
    with pytest.raises(SystemExit) as caught:
        main()
    assert caught.value.code == 1
    errors = [line for line in capsys.readouterr().out.split("\n") if line.startswith("::error")]
    assert [re.findall(r"file=([^,]*),line=(\d+)", line)[0] for line in errors] == [
        ("urdf/bent.urdf", "10"),
        ("urdf/srdf-unknown-joint.srdf", "7"),
    ]
