"""A small robot with one joint of each moving kind, read from a file as a user's would be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from nao_kin.robot.robot import Robot, load

if TYPE_CHECKING:
    from pathlib import Path

SMALL = """<?xml version="1.0"?>
<robot name="small">
  <link name="base"><visual><geometry><box size="0.4 0.3 0.1"/></geometry></visual></link>
  <link name="arm">
    <visual>
      <origin xyz="0 0 0.2" rpy="0 0 0"/>
      <geometry><cylinder radius="0.04" length="0.4"/></geometry>
      <material name="red"><color rgba="0.8 0.1 0.1 1"/></material>
    </visual>
  </link>
  <link name="slide"><visual><geometry><sphere radius="0.06"/></geometry></visual></link>
  <link name="wheel"><visual><geometry><mesh filename="missing/wheel.stl"/></geometry></visual></link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0.1 0 0.05" rpy="0.1 -0.2 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="arm"/><child link="slide"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" velocity="1" effort="1"/>
  </joint>
  <joint name="roll" type="continuous">
    <parent link="slide"/><child link="wheel"/>
    <origin xyz="0 0 0.1"/><axis xyz="1 0 0"/>
  </joint>
  <joint name="flange" type="fixed"><parent link="wheel"/><child link="tip"/><origin xyz="0 0 0.1"/></joint>
</robot>
"""


@pytest.fixture
def small(tmp_path: Path) -> Robot:
    path = tmp_path / "small.urdf"
    path.write_text(SMALL, encoding="utf-8")
    return load(path)
