"""The meaning of a word by the version of the format that the file declares; Pinocchio's own reader is the oracle."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

import nao_kin as nk
from nao_kin.errors import UrdfError
from nao_kin.robot.robot import Robot
from nao_kin.urdf import UrdfWarning, parse_urdf
from nao_kin.urdf.elements import Capsule, OtherShape
from nao_kin.urdf.quaternion import rpy_of_quaternion

if TYPE_CHECKING:
    from pathlib import Path

TURNED = '<origin xyz="0 0 0.1" quat_xyzw="0 0 0.7071067811865476 0.7071067811865476"/>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def arm(version: str = "", joint: str = LIMIT, link: str = "", kind: str = "revolute") -> str:
    """A base, one joint that turns about z, and a tip 0.3 m along x from it."""
    declared = f' version="{version}"' if version else ""
    return (
        f'<robot name="arm"{declared}>\n<link name="base">{link}</link><link name="a"/><link name="tip"/>\n'
        f'<joint name="j" type="{kind}"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>\n{joint}</joint>\n'
        '<joint name="f" type="fixed"><parent link="a"/><child link="tip"/><origin xyz="0.3 0 0"/></joint></robot>'
    )


def robot_of(text: str) -> Robot:
    return Robot.from_document(parse_urdf(text.encode()))


@pytest.mark.parametrize(
    ("version", "expected"),
    [("", (0.3, 0, 0.1)), ("1.0", (0.3, 0, 0.1)), ("1.1", (0, 0.3, 0.1)), ("1.2", (0, 0.3, 0.1))],
)
def test_a_quaternion_turns_a_joint_from_1_1_on(version: str, expected: tuple[float, float, float]) -> None:
    # pinocchio#2893, urdfdom#235
    text = arm(version, TURNED + LIMIT)
    place = robot_of(text).pose({}, "tip").translation
    np.testing.assert_allclose(place, expected, atol=1e-15)
    model = pin.buildModelFromXML(text)
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    np.testing.assert_allclose(place, data.oMf[model.getFrameId("tip")].translation, atol=1e-15)


components = st.floats(-1.0, 1.0)


@given(st.tuples(components, components, components, components))
def test_three_angles_say_the_rotation_of_a_quaternion(quaternion: tuple[float, float, float, float]) -> None:
    if math.hypot(*quaternion) < 1e-3:
        return
    x, y, z, w = quaternion
    expected = pin.Quaternion(w, x, y, z).normalized().matrix()
    np.testing.assert_allclose(pin.rpy.rpyToMatrix(*rpy_of_quaternion(x, y, z, w)), expected, atol=2e-15)


@pytest.mark.parametrize("bend", [0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_so_do_they_at_and_near_a_pitch_of_a_quarter_turn(bend: float, side: float) -> None:
    for roll in np.linspace(-3.0, 3.0, 7):
        expected = pin.rpy.rpyToMatrix(roll, side * (math.pi / 2.0 - bend), 0.7)
        angles = rpy_of_quaternion(*pin.Quaternion(expected).coeffs())
        np.testing.assert_allclose(pin.rpy.rpyToMatrix(*angles), expected, atol=2e-15)


def test_capsules_are_shapes_from_1_1_on() -> None:
    solid = '<collision><geometry><capsule radius="0.05" length="0.2"/></geometry></collision>'
    assert robot_of(arm(link=solid)).document.links[0].collisions[0].shape == OtherShape("capsule")
    for version in ("1.1", "1.2"):
        assert robot_of(arm(version, link=solid)).document.links[0].collisions[0].shape == Capsule(0.05, 0.2)


def test_limits_without_speed_and_effort_bound_nothing() -> None:
    robot = robot_of(arm("1.2", '<limit lower="-1" upper="1"/>'))
    limit = robot.document.joint("j").limit
    assert limit is not None
    assert (limit.velocity, limit.effort) == (None, None)
    assert robot.model.velocityLimit.tolist() == robot.model.upperEffortLimit.tolist() == [math.inf]
    assert robot.chain("base", "tip").max_velocity.tolist() == [math.inf]


def test_accelerations_are_read_from_1_2_on() -> None:
    text = LIMIT.replace("/>", ' acceleration="3" deceleration="4" jerk="50"/>')
    newest, older = (robot_of(arm(version, text)).document.joint("j").limit for version in ("1.2", "1.1"))
    assert newest is not None
    assert older is not None
    assert (newest.acceleration, newest.deceleration, newest.jerk) == (3.0, 4.0, 50.0)
    assert (older.acceleration, older.deceleration, older.jerk) == (None, None, None)


SENSOR = "<gazebo reference='tip'><sensor:camera name='c'/></gazebo>"
READ_ANYWAY = {
    "a prefix that nothing declares": (arm().replace("</robot>", f"\n{SENSOR}</robot>"), "line 6", "sensor:camera"),
    "xacro beside a whole robot": (
        arm().replace("</robot>", "\n<xacro:property name='x'/></robot>"),
        "line 6",
        "xacro",
    ),
    "an axis without direction": (arm().replace('<axis xyz="0 0 1"/>', "<axis/>"), "line 3", "no xyz, and x is taken"),
    "swapped limits": (arm(joint=LIMIT.replace("-1", "2")), "line 4", "lower limit 2"),
}


@pytest.mark.parametrize(("text", "line", "words"), READ_ANYWAY.values(), ids=READ_ANYWAY)
def test_it_is_read_with_one_warning_that_names_the_line(text: str, line: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    with pytest.warns(UrdfWarning, match=words) as caught:
        robot = nk.load(path)
    assert len(caught) == 1
    assert line in str(caught[0].message)
    assert any(
        f.code in {"undeclared-prefix", "leftover-xacro", "missing-number", "inverted-limit"} for f in nk.check(path)
    )
    if "<axis/>" in text:
        return  # Pinocchio takes the axis 0 0 0
    model = pin.buildModelFromXML(text)
    data, q = model.createData(), np.array([0.7])
    pin.framesForwardKinematics(model, data, q)
    expected = data.oMf[model.getFrameId("tip")].homogeneous
    np.testing.assert_allclose(robot.pose({"j": 0.7}, "tip").homogeneous, expected, atol=1e-12)


def test_a_sound_file_is_read_without_a_word(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(arm())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        nk.load(path)


def test_an_axis_of_a_fixed_joint_needs_no_direction() -> None:
    text = arm(kind="fixed", joint="").replace('<axis xyz="0 0 1"/>', "<axis/>")
    assert robot_of(text).document.tolerated == ()
    assert pin.buildModelFromXML(text).njoints == 1


def test_swapped_limits_are_refused_by_the_chains_that_they_are_on() -> None:
    robot = robot_of(arm(joint=LIMIT.replace("-1", "2")))
    with pytest.raises(UrdfError, match="lower limit 2 of the joint 'j' is above its upper limit 1") as caught:
        robot.chain("base", "tip")
    assert (caught.value.code, caught.value.line) == ("inverted-limit", 4)
    assert robot.neutral == {"j": 0.0}
    assert robot.outside_limits({"j": 9.0}) == ()
