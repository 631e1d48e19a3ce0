"""Paths to compute on: of arbitrary placements, and of a robot with every kind of joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

import nao_kin as nk
from nao_kin.kernels.joint_path import JointPath, PathJoint, joint_path

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.robot.robot import Robot

ODD_ROBOT = """<?xml version="1.0"?>
<robot name="odd">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="tip"/>
  <joint name="first" type="revolute">
    <parent link="base"/><child link="a"/>
    <origin xyz="0.1 -0.2 0.05" rpy="0.1 -0.2 0.3"/><axis xyz="1 2 -3"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="a"/><child link="b"/>
    <origin xyz="0 0.1 0.4" rpy="1 0 2"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-0.2" upper="0.3" velocity="1" effort="1"/>
  </joint>
  <joint name="roll" type="continuous">
    <parent link="b"/><child link="c"/>
    <origin xyz="0.3 0 0.1"/><axis xyz="0 -1 0"/>
  </joint>
  <joint name="follows_first" type="revolute">
    <parent link="c"/><child link="d"/>
    <origin xyz="0 0 0.2" rpy="0 0.5 0"/><axis xyz="0 1 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/>
    <mimic joint="first" multiplier="-0.7" offset="0.2"/>
  </joint>
  <joint name="follows_lift" type="prismatic">
    <parent link="d"/><child link="e"/>
    <origin xyz="0 0 0.1" rpy="0.3 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
    <mimic joint="lift" multiplier="2" offset="-0.05"/>
  </joint>
  <joint name="flange" type="fixed"><parent link="e"/><child link="tip"/><origin xyz="0 0.1 0.1" rpy="0 1 0"/></joint>
</robot>
"""


def screw(axis: str, angle: float, length: float) -> np.ndarray:
    """A turn about a coordinate axis and a shift along it."""
    direction = np.eye(3)["xyz".index(axis)]
    return pin.SE3(pin.AngleAxis(angle, direction).matrix(), length * direction).homogeneous


def random_path(rng: np.random.Generator, joints: int = 6, slides: tuple[int, ...] = ()) -> JointPath:
    """A path of arbitrary placements and axes, of some metres."""
    turns = [pin.Quaternion(rng.normal(size=4)).normalized().matrix() for _ in range(joints + 1)]
    placements = [pin.SE3(R, rng.uniform(-0.5, 0.5, 3)).homogeneous for R in turns]
    axes = [axis / np.linalg.norm(axis) for axis in rng.normal(size=(joints, 3))]
    steps = [PathJoint(placements[k], axes[k], k in slides, k) for k in range(joints)]
    return joint_path(steps, placements[-1], np.full(joints, -np.inf), np.full(joints, np.inf))


def slow_pose(path: JointPath, q: np.ndarray) -> np.ndarray:
    """The definition of `JointPath`, product by product."""
    T = np.eye(4)
    for k in range(len(path.columns)):
        P = np.eye(4)
        P[:3, :3], P[:3, 3] = path.rotations[k], path.translations[k]
        v = path.multipliers[k] * q[path.columns[k]] + path.offsets[k]
        T = T @ P @ (screw("z", 0.0, v) if path.prismatic[k] else screw("z", v, 0.0))
    P = np.eye(4)
    P[:3, :3], P[:3, 3] = path.tool_rotation, path.tool_translation
    return T @ P


def odd_robot(folder: Path) -> Robot:
    """The robot with every kind of joint, loaded as a user's would be."""
    file = folder / "odd.urdf"
    file.write_text(ODD_ROBOT, encoding="utf-8")
    return nk.load(file)
