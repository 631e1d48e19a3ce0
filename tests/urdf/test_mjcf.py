"""MJCF as input for kinematics; Pinocchio's own model of the same file is the oracle."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.errors import UrdfError
from nao_kin.urdf import UrdfWarning
from nao_kin.urdf.elements import Box, Capsule, Cylinder, Sphere

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.robot.robot import Robot

ARM = """<mujoco model="arm">
  <compiler angle="degree"/>
  <default><joint damping="1"/><default class="big"><geom type="capsule" size="0.05 0.2"/></default></default>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base" pos="0 0 0.5" euler="0 0 90">
      <geom type="box" size="0.1 0.2 0.3" rgba="1 0 0 1"/>
      <body name="upper" pos="0.1 0 0.2" quat="0.9 0.1 0.2 0.3">
        <joint name="shoulder" type="hinge" axis="0 1 0" pos="0.01 0.02 0.03" range="-90 45"/>
        <joint name="twist" type="hinge" axis="1 1 0" pos="0 0 0.05" range="-30 30"/>
        <inertial pos="0.01 0 0.1" mass="2" diaginertia="0.1 0.2 0.25" quat="1 0.1 0 0"/>
        <geom class="big" pos="0 0 0.1"/>
        <body name="plate" pos="0 0.2 0"><geom type="sphere" size="0.02" mass="0.1"/>
          <body name="slider" pos="0 0 0.3" euler="20 0 0">
            <joint name="rail" type="slide" axis="0 0 1" range="-0.2 0.3"/>
            <geom type="cylinder" size="0.03 0.1" mass="0.5"/>
            <body name="wheel" pos="0.1 0 0">
              <joint name="spin" axis="0 0 1"/><geom type="sphere" size="0.05" mass="0.3"/>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="shoulder" joint2="twist"/></equality>
</mujoco>
"""


def loaded(text: str, folder: Path) -> Robot:
    path = folder / "arm.xml"
    path.write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UrdfWarning)
        return nk.load(path)


def test_poses_are_those_of_pinocchios_own_model(tmp_path: Path) -> None:
    robot = loaded(ARM, tmp_path)
    model = pin.buildModelFromMJCF(str(tmp_path / "arm.xml"))
    data, rng = model.createData(), np.random.default_rng(0)
    assert robot.joint_names == ("shoulder", "twist", "rail", "spin")
    for _ in range(20):
        values = dict(zip(robot.joint_names, rng.uniform(-1.5, 1.5, 4).tolist(), strict=True))
        q = pin.neutral(model)
        q[:3] = values["shoulder"], values["twist"], values["rail"]
        q[3:] = (np.cos(values["spin"]), np.sin(values["spin"])) if model.nq == 5 else (values["spin"],)
        pin.framesForwardKinematics(model, data, q)
        for body in ("base", "upper", "plate", "slider", "wheel"):
            expected = data.oMf[model.getFrameId(body, pin.FrameType.BODY)].homogeneous
            np.testing.assert_allclose(robot.pose(values, body).homogeneous, expected, atol=1e-12)


def test_weight_is_pinocchios(tmp_path: Path) -> None:
    robot = loaded(ARM, tmp_path)
    theirs = pin.buildModelFromMJCF(str(tmp_path / "arm.xml"))
    ours = robot.model
    np.testing.assert_allclose(
        pin.computeTotalMass(ours) + ours.inertias[0].mass, pin.computeTotalMass(theirs) + theirs.inertias[0].mass
    )
    a, b = ours.createData(), theirs.createData()
    np.testing.assert_allclose(
        pin.centerOfMass(ours, a, pin.neutral(ours)), pin.centerOfMass(theirs, b, pin.neutral(theirs)), atol=1e-12
    )


def test_ranges_are_those_of_the_file(tmp_path: Path) -> None:
    robot = loaded(ARM, tmp_path)
    chain = robot.chain("base", "wheel")
    np.testing.assert_allclose(chain.lower[:3], [-np.pi / 2.0, -np.pi / 6.0, -0.2], atol=1e-12)
    np.testing.assert_allclose(chain.upper[:3], [np.pi / 4.0, np.pi / 6.0, 0.3], atol=1e-12)
    assert np.isinf(chain.upper[3])
    radians = ARM.replace('"degree"', '"radian"').replace("-90 45", "-1.5 0.7").replace("-30 30", "-0.5 0.5")
    np.testing.assert_allclose(loaded(radians, tmp_path).chain("base", "wheel").upper[:3], [0.7, 0.5, 0.3])


def test_shapes_are_drawn_and_inverse_kinematics_works(tmp_path: Path) -> None:
    robot = loaded(ARM, tmp_path)
    shapes = {type(solid.shape) for link in robot.document.links for solid in link.visuals}
    assert shapes == {Box, Capsule, Cylinder, Sphere}
    nk.export_html(tmp_path / "page.html", robot)
    assert (tmp_path / "page.html").stat().st_size > 10_000
    chain = robot.chain("base", "wheel")
    target = chain.pose([0.3, 0.2, 0.1, 0.5])
    assert nk.solve(chain, target, q0=[0.0, 0.0, 0.0, 0.0]).solved


def test_joints_and_bodies_without_names_get_some(tmp_path: Path) -> None:
    text = "".join(
        (
            '<mujoco><worldbody><body name="a"><joint axis="0 0 1"/><joint axis="0 1 0"/><geom size="0.1"/>',
            '<body><joint axis="1 0 0"/><geom size="0.1"/></body></body></worldbody></mujoco>',
        )
    )
    robot = loaded(text, tmp_path)
    assert len(set(robot.joint_names)) == 3
    assert len(robot.chain(robot.chain_names[0]).joints) == 3


def test_what_is_lost_is_said_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM.replace('<body name="base" ', '<body name="base" ').replace(
        '<geom type="box"', '<freejoint name="float"/><geom type="mesh" mesh="m"/><geom type="box"'
    ))  # fmt: skip
    with pytest.warns(UrdfWarning) as caught:
        robot = nk.load(path)
    (told,) = (str(warning.message) for warning in caught)
    assert "<equality> is not read" in told
    assert "line 25: <equality>" in told
    assert "free joint 'float' is taken as fixed" in told
    assert "Meshes are not read" in told
    assert robot.joint_names == ("shoulder", "twist", "rail", "spin")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('type="hinge" axis="0 1 0"', 'type="ball"', "of the kind spherical"),
        ("<worldbody>", '<include file="/etc/passwd"/><worldbody>', "includes another file"),
        ("<mujoco", "<robot", "begins with <mujoco>"),
        ('name="twist"', 'name="rail"', "exists already"),
        ("<worldbody>", "<worldbody><body", "not well-formed"),
        ('quat="0.9 0.1 0.2 0.3"', 'quat="x"', "instead of 4"),
    ],
)
def test_what_cannot_be_read_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match=words):
        loaded(
            ARM.replace(old, new).replace("</mujoco>", f"</{new[1:]}>" if new == "<robot" else "</mujoco>"), tmp_path
        )


def test_several_joints_of_a_body_turn_it_one_after_the_other_as_mujoco_says(tmp_path: Path) -> None:
    # MuJoCo, "Computation": a body's frame is moved by each of its joints in turn, about the joint's place in the body.
    robot = loaded(ARM, tmp_path)
    rng = np.random.default_rng(1)
    quaternion = pin.Quaternion(0.9, 0.1, 0.2, 0.3).normalized()
    T_base_upper = pin.SE3(quaternion.matrix(), np.array([0.1, 0.0, 0.2]))
    for _ in range(10):
        a, b = rng.uniform(-1.0, 1.0, 2).tolist()
        expected = T_base_upper
        for place, axis, angle in (((0.01, 0.02, 0.03), (0.0, 1.0, 0.0), a), ((0.0, 0.0, 0.05), (1.0, 1.0, 0.0), b)):
            unit = np.array(axis) / np.linalg.norm(axis)
            there = pin.SE3(np.eye(3), np.array(place))
            expected = expected * there * pin.SE3(pin.exp3(unit * angle), np.zeros(3)) * there.inverse()
        found = robot.pose({"shoulder": a, "twist": b}, "upper", base="base")
        np.testing.assert_allclose(found.homogeneous, expected.homogeneous, atol=1e-12)
