"""Repairs: what they change in the text, and that they change nothing in the robot."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.conftest import BUNDLED

import nao_kin as nk
from nao_kin.checks.checker import check_bytes
from nao_kin.checks.diff import compare_robots
from nao_kin.checks.fix import fix_urdf
from nao_kin.cli.app import main
from nao_kin.robot.known import find_known, robot_file
from nao_kin.robot.robot import Robot
from nao_kin.urdf import parse_urdf

CORPUS = Path(__file__).parent.parent / "corpus"
MENDED = ("axis-not-unit", "quaternion-not-unit", "duplicate-material", "undeclared-prefix", "inverted-limit")


def robot_of(text: str) -> Robot:
    return Robot.from_document(parse_urdf(text.encode()))


@pytest.mark.parametrize("code", MENDED)
def test_what_is_mended_is_found_no_more_and_the_rest_of_the_text_stays(code: str) -> None:
    path = CORPUS / f"{code}.urdf"
    fixed = fix_urdf(path.read_bytes(), str(path), swap_limits=True)
    assert {repair.code for repair in fixed.repairs} == {code}
    assert code not in check_bytes(fixed.after.encode()).codes
    changed = [line for line in fixed.diff().split("\n")[3:] if line.startswith(("-", "+"))]
    assert 1 <= len(changed) <= 2
    if code != "inverted-limit":
        assert compare_robots(robot_of(fixed.before), robot_of(fixed.after)).same


def test_comments_and_formatting_stay() -> None:
    text = (CORPUS / "axis-not-unit.urdf").read_text().replace('xyz="0 1 1"', "xyz =\t' 0   1 1'  ")
    text = text.replace("<joint", "<!-- <axis xyz='0 0 9'/> -->\r\n<joint", 1)
    fixed = fix_urdf(text.encode())
    (repair,) = fixed.repairs
    assert (
        fixed.after == text.replace("' 0   1 1'", "'0 0.707106781186547 0.707106781186547'")
        or repair.text in fixed.after
    )
    assert "<!-- <axis xyz='0 0 9'/> -->\r\n<joint" in fixed.after


def test_a_missing_inertial_becomes_a_comment_because_nobody_has_measured_it() -> None:
    path = CORPUS / "missing-inertia.urdf"
    fixed = fix_urdf(path.read_bytes())
    assert re.search(r'<link name="hand">\n    <!-- missing.*<inertial>', fixed.after)
    assert "missing-inertia" in check_bytes(fixed.after.encode()).codes


def test_swapped_limits_are_left_unless_that_is_asked_for() -> None:
    data = (CORPUS / "inverted-limit.urdf").read_bytes()
    fixed = fix_urdf(data)
    assert (fixed.repairs, fixed.after, fixed.swapped) == ((), data.decode(), (9,))


def test_materials_that_differ_are_left() -> None:
    text = (CORPUS / "duplicate-material.urdf").read_text().replace("1 1 1 1", "1 0 1 1", 1)
    assert fix_urdf(text.encode()).repairs == ()


@pytest.mark.parametrize("name", BUNDLED)
def test_our_robots_need_none(name: str) -> None:
    assert fix_urdf(robot_file(find_known(name)).read_bytes()).repairs == ()


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["nao-kin", *map(str, words)])
    with pytest.raises(SystemExit) as caught:
        main()
    return int(caught.value.code or 0)


def test_nothing_is_written_without_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "arm.urdf"
    before = (CORPUS / "axis-not-unit.urdf").read_bytes()
    path.write_bytes(before)
    assert run(monkeypatch, "check", "--fix", path) == 1
    assert path.read_bytes() == before
    assert '+    <axis xyz="0 0.707' in capsys.readouterr().out
    assert run(monkeypatch, "check", "--fix", "--write", path) == 0
    assert "axis-not-unit" not in nk.check(path).codes
    assert run(monkeypatch, "check", "--fix", path) == 0
    assert run(monkeypatch, "check", "--write", path) == 2
