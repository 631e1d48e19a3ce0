"""What mutants of macros and of MJCF are made of."""

from __future__ import annotations

from typing import Final

__all__ = ["MACRO_FILES", "MJCF", "macro_file"]

_ARM: Final = """<?xml version="1.0"?>
<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="side" default="left"/>
  <xacro:property name="length" value="0.3"/>
  <xacro:property name="limits" value="${dict(lower=-1.5, upper=1.5)}"/>
  <xacro:macro name="arm" params="prefix parent *origin reflect:=1 color:='1 0 0 1'">
    <link name="${prefix}upper">
      <inertial><mass value="${1.5 * length}"/>
        <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
      <visual><geometry><box size="${length} 0.1 0.1"/></geometry>
        <material name="m"><color rgba="${color}"/></material></visual>
    </link>
    <joint name="${prefix}shoulder" type="revolute">
      <xacro:insert_block name="origin"/><parent link="${parent}"/><child link="${prefix}upper"/>
      <axis xyz="0 ${reflect} 0"/>
      <limit lower="${limits.lower}" upper="${limits['upper']}" velocity="${radians(120)}" effort="10"/>
    </joint>
  </xacro:macro>
  <link name="base"/>
  <xacro:arm prefix="l_" parent="base"><origin xyz="0 ${length / 2} 0" rpy="0 0 ${pi / 2}"/></xacro:arm>
  <xacro:if value="${'$(arg side)' == 'both'}">
    <xacro:arm prefix="r_" parent="base" reflect="-1"><origin xyz="0 ${-length / 2} 0"/></xacro:arm>
  </xacro:if>
</robot>
"""

_LIST: Final = """<robot name="list" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="segment" params="names parent">
    <xacro:if value="${len(names) > 0}">
      <link name="${names[0]}"/>
      <joint name="j_${names[0]}" type="continuous"><parent link="${parent}"/><child link="${names[0]}"/>
        <origin xyz="0 0 ${0.1 * len(names)}"/></joint>
      <xacro:segment names="${names[1:]}" parent="${names[0]}"/>
    </xacro:if>
  </xacro:macro>
  <link name="root"/>
  <xacro:segment names="${['a', 'b', 'c']}" parent="root"/>
</robot>
"""

_FILES: Final = {"arm": _ARM, "list": _LIST}
MACRO_FILES: Final = tuple(_FILES)

MJCF: Final = b"""<mujoco model="arm">
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 0.5">
      <geom type="box" size="0.1 0.2 0.3"/>
      <body name="upper" pos="0.1 0 0.2" quat="0.9 0.1 0.2 0.3">
        <joint name="shoulder" type="hinge" axis="0 1 0" pos="0.01 0.02 0.03" range="-1.5 0.7"/>
        <joint name="twist" axis="1 1 0" range="-0.5 0.5"/>
        <inertial pos="0.01 0 0.1" mass="2" diaginertia="0.1 0.2 0.25"/>
        <body name="slider" pos="0 0 0.3" euler="0.3 0 0">
          <joint name="rail" type="slide" axis="0 0 1" range="-0.2 0.3"/>
          <geom type="cylinder" size="0.03 0.1" mass="0.5"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
"""A small arm."""


def macro_file(name: str) -> bytes:
    """A file of macros by its name in `MACRO_FILES`."""
    return _FILES[name].encode()
