"""Files of macros: they expand as xacro itself expands them, and what is wrong with them is told at their own lines."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from lxml import etree
from tests.urdf.macro_packages import ARGUMENTS, FILES, write_packages

import nao_kin as nk
from nao_kin.cli.app import main
from nao_kin.errors import InvalidInputError, UrdfError
from nao_kin.urdf.xacro import expand_xacro, read_xacro

if TYPE_CHECKING:
    from pathlib import Path

# xacro as ROS runs it, but for `$(find)`, which asks an index that ROS installs.
_XACRO_ITSELF = """
import json, pathlib, sys, xacro, xacro.substitution_args as s
root, path, arguments = pathlib.Path(sys.argv[1]), sys.argv[2], json.loads(sys.argv[3])
s._eval_find = lambda name: str(root / name)
print(xacro.process_file(path, mappings=arguments).toprettyxml(indent='  '))
"""


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_packages(tmp_path_factory.mktemp("macros"))


def canonical(text: bytes | str) -> list[str]:
    parser = etree.XMLParser(remove_comments=True, remove_blank_text=True)
    root = etree.fromstring(text if isinstance(text, bytes) else text.encode(), parser)
    lines = []
    for element in root.iter("*"):
        attributes = " ".join(f"{name}={value}" for name, value in sorted(element.attrib.items()))
        lines.append(f"{element.tag} {attributes} {(element.text or '').strip()}")
    return lines


@pytest.mark.parametrize("kind", FILES)
def test_macros_expand_as_xacro_itself_expands_them(kind: str, packages: Path) -> None:
    path = packages / FILES[kind]
    command = [sys.executable, "-c", _XACRO_ITSELF, str(packages), str(path), json.dumps(ARGUMENTS[kind])]
    itself = subprocess.run(command, capture_output=True, text=True, check=True, cwd=path.parent)
    ours = expand_xacro(path, ARGUMENTS[kind])
    assert canonical(ours.data) == canonical(itself.stdout)
    assert len(ours.places) == len(canonical(ours.data))


@pytest.mark.parametrize("kind", FILES)
def test_the_robot_loads_and_the_check_reads_it(kind: str, packages: Path) -> None:
    path = packages / FILES[kind]
    robot = nk.load(path, arguments=ARGUMENTS[kind])
    assert len(robot.frame_names) >= 3
    report = nk.check(path, arguments=ARGUMENTS[kind])
    assert report.errors == ()


def test_a_finding_names_the_line_of_the_macro(packages: Path, tmp_path: Path) -> None:
    folder = write_packages(tmp_path)
    macro = folder / "ur_description/urdf/ur_macro.xacro"
    text = macro.read_text().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 2"/>')
    macro.write_text(text)
    line = 1 + text[: text.index('<axis xyz="0 0 2"/>')].count("\n")
    report = nk.check(folder / FILES["ur"], arguments=ARGUMENTS["ur"], select=["axis-not-unit"])
    (finding,) = report
    assert (finding.path, finding.line) == (str(macro), line)
    assert finding.source.strip() == '<axis xyz="0 0 2"/>'


def test_a_defect_that_refuses_the_file_names_the_line_of_the_macro(tmp_path: Path) -> None:
    folder = write_packages(tmp_path)
    macro = folder / "ur_description/urdf/ur_macro.xacro"
    macro.write_text(macro.read_text().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>'))
    with pytest.raises(UrdfError, match="has no length") as caught:
        read_xacro(folder / FILES["ur"], ARGUMENTS["ur"])
    assert caught.value.path == str(macro)
    assert caught.value.line is not None
    assert macro.read_text().split("\n")[caught.value.line - 1].strip().startswith("<axis")


def test_what_cannot_be_traced_says_the_line_of_the_expanded_text(tmp_path: Path) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(
        '<robot name="a" xmlns:xacro="x">\n<link name="b"/>\n'
        '<xacro:element xacro:name="link"/>\n<!-- see: there -->\n</robot>'
    )
    found = {finding.code: finding for finding in nk.check(path)}
    assert found["no-name"].line is None
    assert "of the expanded file" in found["no-name"].message
    assert "of the expanded file" in found["colon-in-comment"].message


@pytest.mark.parametrize(
    ("inside", "line", "words"),
    [
        ("<xacro:unknown/>", 3, "unknown macro name"),
        ('<xacro:property name="x" value="1"/>\n<link name="${y}"/>', 4, "name 'y' is not defined"),
        ('<xacro:include filename="nowhere.xacro"/>', 3, "No such file.*nowhere"),
        ('<link name="$(arg side)"/>', 3, "side"),
        ('<link name="$(find nowhere)"/>', 3, "'nowhere' was not found"),
        ('<link name="${1 +}"/>', 3, "invalid syntax"),
    ],
)
def test_what_fails_is_told_with_its_line(inside: str, line: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(
        f'<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<link name="b"/>\n{inside}\n</robot>'
    )
    (finding,) = nk.check(path)
    assert (finding.code, finding.line) == ("xacro-failed", line)
    with pytest.raises(UrdfError, match=words) as caught:
        nk.load(path)
    assert caught.value.line == line


def test_packages_are_found_where_they_are_named(
    packages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "cell.urdf.xacro"
    path.write_text(
        '<robot name="cell" xmlns:xacro="x"><xacro:include filename="$(find nao_description)/urdf/lengths.xacro"/>'
        '<link name="${NeckOffsetZ}"/></robot>'
    )
    with pytest.raises(UrdfError, match="nao_description"):
        nk.load(path)
    for given in ({"nao_description": packages / "nao_description"}, [packages], [packages / "nao_description"]):
        assert nk.load(path, packages=given).frame_names == ("0.1265",)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(packages))
    assert nk.load(path).frame_names == ("0.1265",)
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    share = tmp_path / "install" / "share"
    share.mkdir(parents=True)
    (share / "nao_description").symlink_to(packages / "nao_description")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    assert nk.load(path).frame_names == ("0.1265",)


def test_arguments_are_for_files_that_take_them(packages: Path) -> None:
    with pytest.raises(InvalidInputError, match=r"file of macros"):
        nk.load("nao", arguments={"name": "x"})
    with pytest.raises(InvalidInputError, match="text, a number or a truth value"):
        nk.load(packages / FILES["nao"], arguments={"name": [1]})


def test_commands_take_arguments_and_packages(
    packages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lonely = tmp_path / "cell.urdf.xacro"
    lonely.write_text((packages / FILES["ur"]).read_text())
    monkeypatch.chdir(tmp_path)
    given = ["name:=ur5e", "tf_prefix:=l_", "--package", f"ur_description={packages / 'ur_description'}"]
    for words, status in (
        (["fk", "cell.urdf.xacro", "--tip", "l_shoulder_link", "0.3"], 0),
        (["html", "cell.urdf.xacro", "-o", "page.html"], 0),
        (["compare", "cell.urdf.xacro:world:l_shoulder_link", "cell.urdf.xacro:world:l_shoulder_link"], 0),
        (["diff", "cell.urdf.xacro", str(packages / FILES["ur"])], 0),
        (["check", "cell.urdf.xacro"], 0),
    ):
        monkeypatch.setattr("sys.argv", ["nao-kin", *words, *given])
        with pytest.raises(SystemExit) as caught:
            main()
        assert (caught.value.code or 0) == status, capsys.readouterr()
    assert (tmp_path / "page.html").is_file()
    monkeypatch.setattr("sys.argv", ["nao-kin", "fk", "cell.urdf.xacro", "--tip", "l_shoulder_link"])
    with pytest.raises(SystemExit) as caught:
        main()
    assert caught.value.code == 2
