"""Small packages of macros, built as those of UR, Franka, Kinova and the NAO are, for the tests of xacro."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["ARGUMENTS", "FILES", "write_packages"]

_XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
_INERTIAL = '<inertial><mass value="{m}"/><inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial>'

# ur_description: a macro of many parameters with defaults, limits and placements out of YAML, a block for the origin.
_UR = {
    "package.xml": "<package><name>ur_description</name></package>",
    "config/ur5e/joint_limits.yaml": (
        "joint_limits:\n  shoulder_pan:\n    min_position: !degrees -360.0\n    max_position: !degrees  360.0\n"
        "    max_velocity: !degrees  180.0\n    max_effort: 150.0\n"
    ),
    "config/ur5e/kinematics.yaml": "kinematics:\n  shoulder: {x: 0, y: 0, z: 0.1625, roll: -0, pitch: 0, yaw: 0}\n",
    "urdf/inc/common.xacro": f"""<robot {_XMLNS}>
  <xacro:macro name="cylinder_inertial" params="radius length mass *origin">
    <inertial>
      <mass value="${{mass}}"/>
      <xacro:insert_block name="origin"/>
      <inertia ixx="${{0.0833333 * mass * (3 * radius**2 + length**2)}}" ixy="0.0" ixz="0.0"
        iyy="${{0.0833333 * mass * (3 * radius * radius + length * length)}}" iyz="0.0"
        izz="${{0.5 * mass * radius * radius}}"/>
    </inertial>
  </xacro:macro>
</robot>
""",
    "urdf/ur_macro.xacro": f"""<robot {_XMLNS}>
  <xacro:include filename="$(find ur_description)/urdf/inc/common.xacro"/>
  <xacro:macro name="ur_robot" params="name tf_prefix parent *origin joint_limits_file kinematics_file
    safety_limits:=false generate_ros2_control:=true initial_positions:=${{dict(pan=0.0)}}">
    <xacro:property name="limits" value="${{xacro.load_yaml(joint_limits_file)['joint_limits']}}"/>
    <xacro:property name="k" value="${{xacro.load_yaml(kinematics_file)['kinematics']['shoulder']}}"/>
    <link name="${{tf_prefix}}base_link"/>
    <joint name="${{tf_prefix}}base_joint" type="fixed">
      <xacro:insert_block name="origin"/><parent link="${{parent}}"/><child link="${{tf_prefix}}base_link"/>
    </joint>
    <link name="${{tf_prefix}}shoulder_link">
      <xacro:cylinder_inertial radius="0.06" length="0.15" mass="3.7"><origin xyz="0 0 0"/></xacro:cylinder_inertial>
    </link>
    <joint name="${{tf_prefix}}shoulder_pan_joint" type="revolute">
      <parent link="${{tf_prefix}}base_link"/><child link="${{tf_prefix}}shoulder_link"/>
      <origin xyz="${{k.x}} ${{k.y}} ${{k.z}}" rpy="${{k.roll}} ${{k.pitch}} ${{k.yaw}}"/>
      <axis xyz="0 0 1"/>
      <limit lower="${{limits.shoulder_pan.min_position}}" upper="${{limits.shoulder_pan.max_position}}"
        effort="${{limits.shoulder_pan.max_effort}}" velocity="${{limits.shoulder_pan.max_velocity}}"/>
      <xacro:if value="${{safety_limits}}"><safety_controller soft_lower_limit="-6" k_velocity="1"/></xacro:if>
    </joint>
    <xacro:if value="${{generate_ros2_control and not safety_limits}}">
      <ros2_control name="${{name}}" type="system"><joint name="${{tf_prefix}}shoulder_pan_joint">
        <state_interface name="position"><param name="initial_value">${{initial_positions['pan']}}</param>
        </state_interface></joint></ros2_control>
    </xacro:if>
  </xacro:macro>
</robot>
""",
    "urdf/ur.urdf.xacro": f"""<?xml version="1.0"?>
<robot {_XMLNS} name="$(arg name)">
  <xacro:arg name="ur_type" default="ur5e"/>
  <xacro:arg name="tf_prefix" default=""/>
  <xacro:include filename="$(find ur_description)/urdf/ur_macro.xacro"/>
  <link name="world"/>
  <xacro:ur_robot name="$(arg name)" tf_prefix="$(arg tf_prefix)" parent="world"
    joint_limits_file="$(find ur_description)/config/$(arg ur_type)/joint_limits.yaml"
    kinematics_file="$(find ur_description)/config/$(arg ur_type)/kinematics.yaml">
    <origin xyz="0 0 0" rpy="0 0 ${{-pi / 2}}"/>
  </xacro:ur_robot>
</robot>
""",
}

# franka_description: a namespace of the include, defaults that are forwarded, python expressions, unless.
_FRANKA = {
    "package.xml": "<package><name>franka_description</name></package>",
    "robots/common/utils.xacro": f"""<robot {_XMLNS}>
  <xacro:property name="gap" value="0.05"/>
  <xacro:macro name="link_with_sc" params="no_prefix:=false name gazebo:=^|false color:='0 0 1 1'">
    <xacro:property name="prefix" value="${{'' if no_prefix else arm_id + '_'}}"/>
    <link name="${{prefix}}${{name}}">
      <visual><geometry><sphere radius="${{gap * 2}}"/></geometry>
      <material name="m"><color rgba="${{color}}"/></material></visual>
      <xacro:unless value="${{gazebo}}"><collision><geometry><sphere radius="0.1"/></geometry></collision>
      </xacro:unless>
    </link>
  </xacro:macro>
</robot>
""",
    "robots/fr3/fr3.urdf.xacro": f"""<robot {_XMLNS} name="fr3">
  <xacro:arg name="arm_id" default="fr3"/>
  <xacro:property name="arm_id" value="$(arg arm_id)"/>
  <xacro:property name="gazebo" value="true"/>
  <xacro:include filename="../common/utils.xacro"/>
  <xacro:property name="d" value="${{[0.333, 0, 0.316]}}"/>
  <xacro:link_with_sc name="link0"/>
  <xacro:link_with_sc name="link1" color="${{' '.join([str(c) for c in [1, 0.5, 0, 1]])}}"/>
  <xacro:link_with_sc name="link2" no_prefix="true" gazebo="false"/>
  <joint name="${{arm_id}}_joint1" type="revolute">
    <origin rpy="${{radians(-90)}} 0 0" xyz="0 0 ${{d[0]}}"/>
    <parent link="${{arm_id}}_link0"/><child link="${{arm_id}}_link1"/>
    <axis xyz="0 0 1"/><limit effort="87" lower="${{-2.7437}}" upper="${{python.abs(-2.7437)}}" velocity="2.62"/>
  </joint>
  <joint name="${{arm_id}}_joint2" type="fixed">
    <parent link="${{arm_id}}_link1"/><child link="link2"/><origin xyz="0 ${{-d[2]}} ${{max(d) - 0.333}}"/>
  </joint>
</robot>
""",
}

# kortex_description: a file chosen by an argument, a macro called by a computed name, attributes set by xacro.
_KINOVA = {
    "package.xml": "<package><name>kortex_description</name></package>",
    "arms/gen3/6dof/urdf/gen3_macro.xacro": f"""<robot {_XMLNS}>
  <xacro:macro name="load_arm" params="parent dof *origin">
    <xacro:property name="prefix" value="gen3_" scope="parent"/>
    <link name="base"><xacro:attribute name="kind" value="dof${{dof}}"/>{_INERTIAL.format(m=1.7, i=0.004)}</link>
    <joint name="mount" type="fixed"><xacro:insert_block name="origin"/>
      <parent link="${{parent}}"/><child link="base"/></joint>
  </xacro:macro>
</robot>
""",
    "robots/gen3.xacro": f"""<robot {_XMLNS} name="gen3">
  <xacro:arg name="arm" default="gen3"/>
  <xacro:arg name="dof" default="6"/>
  <xacro:include filename="$(find kortex_description)/arms/$(arg arm)/$(arg dof)dof/urdf/$(arg arm)_macro.xacro"/>
  <link name="world"/>
  <xacro:call macro="load_$(eval 'arm')" parent="world" dof="$(arg dof)">
    <origin xyz="0 0 $(eval 0.5 * 2)"/></xacro:call>
  <link name="${{prefix}}tool"/>
  <joint name="flange" type="fixed"><parent link="base"/><child link="${{prefix}}tool"/></joint>
</robot>
""",
}

# nao_description: plain property files, mirrored sides by a reflected parameter, nested macros, blocks of elements.
_NAO = {
    "package.xml": "<package><name>nao_description</name></package>",
    "urdf/lengths.xacro": f"""<robot {_XMLNS}>
  <xacro:property name="NeckOffsetZ" value="0.1265"/>
  <xacro:property name="ShoulderOffsetY" value="0.098"/>
  <xacro:property name="PI_2" value="${{acos(0)}}"/>
</robot>
""",
    "urdf/nao.urdf.xacro": f"""<robot {_XMLNS} name="nao">
  <xacro:include filename="lengths.xacro"/>
  <xacro:include filename="missing.xacro" optional="true"/>
  <xacro:macro name="joint" params="name parent child lower upper **placement">
    <joint name="${{name}}" type="revolute"><parent link="${{parent}}"/><child link="${{child}}"/>
      <xacro:insert_block name="placement"/><axis xyz="0 1 0"/>
      <limit lower="${{lower}}" upper="${{upper}}" effort="1.5" velocity="8.2"/></joint>
  </xacro:macro>
  <xacro:macro name="arm" params="side reflect">
    <link name="${{side}}Shoulder"/>
    <xacro:joint name="${{side}}ShoulderPitch" parent="torso" child="${{side}}Shoulder" lower="-2.0857" upper="2.0857">
      <placement><origin xyz="0 ${{reflect * ShoulderOffsetY}} 0.1" rpy="0 ${{PI_2 - acos(0)}} 0"/></placement>
    </xacro:joint>
  </xacro:macro>
  <link name="torso">{_INERTIAL.format(m=1.05, i=0.005)}</link>
  <xacro:arm side="L" reflect="1"/>
  <xacro:arm side="R" reflect="-1"/>
  <link name="Head"/>
  <xacro:joint name="HeadYaw" parent="torso" child="Head" lower="${{-2.0857}}" upper="2.0857">
    <placement><origin xyz="0 0 ${{NeckOffsetZ}}"/></placement>
  </xacro:joint>
</robot>
""",
}

FILES = {
    "ur": "ur_description/urdf/ur.urdf.xacro",
    "franka": "franka_description/robots/fr3/fr3.urdf.xacro",
    "kinova": "kortex_description/robots/gen3.xacro",
    "nao": "nao_description/urdf/nao.urdf.xacro",
}
"""The file to expand of each package, from the folder that holds them."""

ARGUMENTS: dict[str, dict[str, str]] = {
    "ur": {"name": "ur5e", "tf_prefix": "left_"},
    "franka": {"arm_id": "left"},
    "kinova": {},
    "nao": {},
}


def write_packages(folder: Path) -> Path:
    """Writes all of them below a folder, which is returned."""
    packages = {"ur_description": _UR, "franka_description": _FRANKA}
    packages |= {"kortex_description": _KINOVA, "nao_description": _NAO}
    for package, files in packages.items():
        for name, text in files.items():
            path = folder / package / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    return folder
