"""Robots of robot_descriptions.py by name: from the cache, never from the network; chains that a robot has anyway."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest
from tests.urdf.macro_packages import FILES, write_packages

import nao_kin as nk
from nao_kin.errors import UnknownNameError
from nao_kin.robot.descriptions import CHAINS, NotFetchedError, description_names, find_description

if TYPE_CHECKING:
    from pathlib import Path

ARM = """<robot name="arm"><link name="base"/><link name="a"/><link name="hand"/><link name="camera"/>
<joint name="j" type="continuous"><parent link="base"/><child link="a"/></joint>
<joint name="k" type="continuous"><parent link="a"/><child link="hand"/></joint>
<joint name="f" type="fixed"><parent link="base"/><child link="camera"/></joint></robot>"""
SRDF = """<robot name="arm">
<group name="all"><chain base_link="base" tip_link="hand"/></group>
<group name="wrist"><joint name="k"/></group><group name="both"><joint name="j"/><joint name="k"/></group>
<group name="apart"><joint name="k"/><joint name="j"/></group><group name="link"><link name="hand"/></group></robot>"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path))
    for name in [name for name in sys.modules if name.startswith("robot_descriptions.") and "._" not in name]:
        monkeypatch.delitem(sys.modules, name)
    return tmp_path


def test_what_is_not_in_the_cache_is_not_downloaded(cache: Path) -> None:
    for name in ("ur5e_description", "ur5e"):
        with pytest.raises(NotFetchedError, match="nao-kin robots --fetch ur5e_description"):
            nk.load(name)
    assert list(cache.iterdir()) == []
    with pytest.raises(UnknownNameError, match=r"so_arm101"):
        nk.load("so_arm_101_description")
    with pytest.raises(UnknownNameError, match="There is no robot 'zzzzzz'"):
        nk.load("zzzzzz")


def test_a_description_of_macros_loads_with_its_arguments(cache: Path) -> None:
    write_packages(cache)

    assert find_description("ur5e").path == cache / FILES["ur"]
    robot = nk.load("ur5e")
    assert robot.name == "ur5e_description"
    assert "shoulder_link" in robot.frame_names
    assert "arm" in robot.chain_names
    with pytest.raises(UnknownNameError, match="tool0"):
        robot.chain("arm")  # the small copy has no flange


def test_named_chains_are_of_descriptions_that_exist() -> None:
    assert set(description_names()) >= CHAINS.keys()


def test_any_robot_has_chains_to_its_ends_and_of_the_groups_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "urdf" / "arm.urdf"
    path.parent.mkdir()
    path.write_text(ARM)
    assert nk.load(path).chain_names == ("hand",)
    assert nk.load(path).chain("hand").joint_names == ("j", "k")
    (tmp_path / "srdf").mkdir()
    (tmp_path / "srdf" / "arm.srdf").write_text(SRDF)
    robot = nk.load(path)
    assert robot.chain_names == ("hand", "all", "wrist", "both")
    assert robot.chain("wrist").joint_names == ("k",)
    assert (robot.chain("both").base, robot.chain("both").tip) == ("base", "hand")
    with pytest.raises(UnknownNameError, match=r"no chain 'wrst'.*'wrist'"):
        robot.chain("wrst")
    assert nk.load("nao").chain_names[:5] == ("left_arm", "right_arm", "left_leg", "right_leg", "head")
