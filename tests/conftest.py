"""What several test modules share: robots loaded once, and skips that CI does not accept."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.robot.known import KNOWN_ROBOTS, example_robot_data_share

if TYPE_CHECKING:
    from pathlib import Path

BUNDLED = tuple(name for name, robot in KNOWN_ROBOTS.items() if robot.source == "bundled")
EXAMPLES = tuple(name for name, robot in KNOWN_ROBOTS.items() if robot.source != "bundled")


@cache
def robot(name: str) -> nk.Robot:
    """A known robot, loaded once."""
    return nk.load(name)


def needs_examples() -> None:
    """Skip without example-robot-data, except in CI, where it must be there."""
    if example_robot_data_share() is None:
        if os.environ.get("CI") == "true":
            pytest.fail("the extra 'robots' must be installed in CI")
        pytest.skip("the extra 'robots' (example-robot-data) is not installed")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20160401)


def needs(module: str) -> Any:
    """A module of the extra ``dev``; skip without it, except in CI, where it must be there."""
    if importlib.util.find_spec(module) is None:
        if os.environ.get("CI") == "true":
            pytest.fail(f"{module} must be installed in CI")
        pytest.skip(f"{module} is not installed")
    return importlib.import_module(module)


@pytest.fixture
def this_kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes notebooks run on this very interpreter, whatever kernels the machine has."""
    kernel = tmp_path / "kernels" / "python3"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text(
        f'{{"argv": ["{sys.executable}", "-m", "ipykernel_launcher", "-f", "{{connection_file}}"], '
        '"display_name": "Python 3", "language": "python"}'
    )
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path), prepend=os.pathsep)


MIMIC = """<robot name="m"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="z_lead" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="1" velocity="2"/></joint>
<joint name="m_follow" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
  <origin xyz="1 0 0"/><limit lower="-0.5" upper="3" effort="1" velocity="2"/>
  <mimic joint="z_lead" multiplier="-2" offset="0.5"/></joint>
<joint name="a_follow" type="prismatic"><parent link="c"/><child link="d"/><axis xyz="1 0 0"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/><mimic joint="m_follow" multiplier="0.1"/></joint></robot>"""


@pytest.fixture
def mimic(tmp_path: Path) -> nk.Robot:
    """Two followers of one motor, each sorted before its leader."""
    path = tmp_path / "m.urdf"
    path.write_text(MIMIC)
    return nk.load(path)
