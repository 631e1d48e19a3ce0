"""What differs in meaning: each kind of change is named, other words for the same are not."""

from __future__ import annotations

import json
import math

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.checks.diff import compare_robots
from nao_kin.cli.app import main
from nao_kin.robot.robot import Robot
from nao_kin.urdf import parse_urdf

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="a">
    <inertial><origin xyz="0.1 0 0"/><mass value="2"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial>
  </link>
  <link name="tip"/>
  <joint name="j" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 0.1" rpy="0 0 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="2" effort="3"/></joint>
  <joint name="f" type="fixed"><parent link="a"/><child link="tip"/><origin xyz="0.3 0 0"/></joint>
</robot>"""


def robot_of(text: str) -> Robot:
    return Robot.from_document(parse_urdf(text.encode()))


CHANGES = {
    "placement": ('xyz="0 0 0.1"', 'xyz="0 0.003 0.104"', "placement", "j", "moved by 5 mm, turned by 0 mrad"),
    "rotation": ('rpy="0 0 0.5"', 'rpy="0 0 0.502"', "placement", "j", "moved by 0 mm, turned by 2 mrad"),
    "axis": ('<axis xyz="0 0 1"/>', '<axis xyz="0 0.001 1"/>', "axis", "j", "leans by 1 mrad"),
    "limit": ('upper="1"', 'upper="1.2"', "limit", "j", "upper 1 → 1.2"),
    "effort": ('effort="3"', 'effort="4"', "limit", "j", "effort 3 → 4"),
    "type": ('type="revolute"', 'type="continuous"', "joint", "j", "revolute → continuous"),
    "mass": ('value="2"', 'value="2.5"', "mass", "a", "2 → 2.5 kg"),
    "centre": ('xyz="0.1 0 0"', 'xyz="0.1 0.02 0"', "mass", "a", "20 mm elsewhere"),
    "inertia": ('izz="2.5"', 'izz="2.6"', "inertia", "a", "1 2 2.5 → 1 2 2.6"),
    "link": ('"tip"', '"tool"', "link", "tip", "is gone"),
}


@pytest.mark.parametrize(("old", "new", "kind", "name", "said"), CHANGES.values(), ids=CHANGES)
def test_a_change_is_named(old: str, new: str, kind: str, name: str, said: str) -> None:
    found = compare_robots(robot_of(ARM), robot_of(ARM.replace(old, new)))
    assert not found.same
    assert any(d.kind == kind and d.name == name and said in d.said for d in found.differences), found.differences
    if kind not in {"link", "joint"}:
        assert {(d.kind, d.name) for d in found.differences} == {(kind, name)}


def test_other_words_for_the_same_are_no_difference() -> None:
    x, y, z, w = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, 0.0, 0.5)).coeffs()
    turned = 'version="1.1" name="arm"><!-- --><link name="tip"/>'
    text = ARM.replace('  <link name="tip"/>\n', "").replace('name="arm">', turned)
    text = text.replace('rpy="0 0 0.5"', f'quat_xyzw="{x} {y} {z} {w}"').replace('"0 0 1"/>', '"0 0 3"/>')
    # The same inertia in other axes.
    text = text.replace('xyz="0.1 0 0"', f'xyz="0.1 0 0" rpy="0 0 {math.pi / 2!r}"')
    text = text.replace('ixx="1"', 'ixx="2"').replace('iyy="2"', 'iyy="1"')
    assert compare_robots(robot_of(ARM), robot_of(text)).same
    assert compare_robots(nk.load("nao"), nk.load("nao")).same


def test_how_far_the_tips_have_moved_is_measured() -> None:
    found = compare_robots(robot_of(ARM), robot_of(ARM.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')))
    (tip,) = found.tips
    assert tip.tip == "tip"
    # 0.3 m out, turned about z or about y by the same q: from (cos q, sin q, 0) to (cos q, 0, -sin q).
    assert 0.0 < tip.position <= 0.3 * math.sqrt(2.0) * math.sin(1.0) + 1e-12
    moved = compare_robots(robot_of(ARM), robot_of(ARM.replace('xyz="0 0 0.1"', 'xyz="0 0.003 0.104"')))
    np.testing.assert_allclose(moved.tips[0].position, 0.005, atol=1e-12)
    assert moved.tips[0].rotation < 1e-7


def test_the_command(tmp_path, monkeypatch, capsys) -> None:  # type: ignore[no-untyped-def]
    for name, text in (("a", ARM), ("b", ARM.replace('upper="1"', 'upper="1.2"'))):
        (tmp_path / f"{name}.urdf").write_text(text)
    monkeypatch.chdir(tmp_path)
    for words, status in ((("a.urdf", "a.urdf"), 0), (("a.urdf", "b.urdf"), 1)):
        monkeypatch.setattr("sys.argv", ["nao-kin", "diff", *words, "--format", "json"])
        with pytest.raises(SystemExit) as caught:
            main()
        assert (caught.value.code or 0) == status
        found = json.loads(capsys.readouterr().out)
        assert found["same"] is (status == 0)
    assert found["differences"] == [{"kind": "limit", "name": "j", "said": "upper 1 → 1.2"}]
