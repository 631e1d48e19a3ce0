"""NAO's joints: ranges, efforts, speeds, coupling, and left against right.

Every expected figure is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.make_urdf.files import NAO, floats, joints, limit, placement

# Public nao.urdf of V50: lower, upper, effort, as printed.
LIMITS = {
    "HeadYaw": (-2.08567, 2.08567, 1.547),
    "HeadPitch": (-0.671952, 0.514872, 1.532),
    "LShoulderPitch": (-2.08567, 2.08567, 1.329),
    "LShoulderRoll": (-0.314159, 1.32645, 1.7835),
    "LElbowYaw": (-2.08567, 2.08567, 1.547),
    "LElbowRoll": (-1.54462, -0.0349066, 1.532),
    "LWristYaw": (-1.82387, 1.82387, 0.4075),
    "LHand": (0, 1, 0.292),
    "LHipYawPitch": (-1.14529, 0.740718, 3.348),
    "LHipRoll": (-0.379435, 0.79046, 3.348),
    "LHipPitch": (-1.53589, 0.48398, 3.023),
    "LKneePitch": (-0.0923279, 2.11255, 3.023),
    "LAnklePitch": (-1.18944, 0.922581, 3.023),
    "LAnkleRoll": (-0.397761, 0.768992, 3.348),
    "RHipYawPitch": (-1.14529, 0.740718, 3.348),
    "RHipRoll": (-0.79046, 0.379435, 3.348),
    "RHipPitch": (-1.53589, 0.48398, 3.0226),
    "RKneePitch": (-0.0923279, 2.11255, 3.0226),
    "RAnklePitch": (-1.1863, 0.932006, 3.0226),
    "RAnkleRoll": (-0.768992, 0.397761, 3.348),
    "RShoulderPitch": (-2.08567, 2.08567, 1.329),
    "RShoulderRoll": (-1.32645, 0.314159, 1.783),
    "RElbowYaw": (-2.08567, 2.08567, 1.547),
    "RElbowRoll": (0.0349066, 1.54462, 1.532),
    "RWristYaw": (-1.82387, 1.82387, 0.4075),
    "RHand": (0, 1, 0.292),
}
LIMITS_V32 = {  # public nao.urdf of V32
    "LShoulderRoll": (0.00872665, 1.64934, 1.7835),
    "RShoulderRoll": (-1.64934, -0.00872665, 1.783),
    "LElbowRoll": (-1.56207, -0.00872665, 1.532),
    "RElbowRoll": (0.00872665, 1.56207, 1.532),
}


@pytest.mark.parametrize("robot", NAO)
def test_joints_ranges_and_efforts_of_the_nao(robot):
    expected = LIMITS | (LIMITS_V32 if "v32" in robot else {})
    if "h21" in robot:
        expected = {name: row for name, row in expected.items() if not name.endswith(("WristYaw", "Hand"))}
    moving = {name for name, joint in joints(robot).items() if joint.attrib["type"] == "revolute"}
    assert moving == set(expected)
    for name, (lower, upper, effort) in expected.items():
        given = limit(robot, name)
        assert (given["lower"], given["upper"], given["effort"]) == (lower, upper, effort), name


# NAOqi documentation (V3.2, V3.3) and rUNSWift: motor speed [rpm] and reduction ratio, by joint without its side.
RATIOS = {
    201.3: ("HipYawPitch", "HipRoll", "AnkleRoll"),
    130.85: ("HipPitch", "KneePitch", "AnklePitch"),
    150.27: ("HeadYaw", "ElbowYaw", "ShoulderPitch"),
    173.22: ("HeadPitch", "ShoulderRoll", "ElbowRoll"),
    50.61: ("WristYaw",),
    36.24: ("Hand",),
}
LEG_RPM = {"v32": 8000, "v33": 8000, "v40": 8300, "v50": 8300, "v60": 8700}
ARM_RPM = {"v32": 11900, "v33": 11900, "v40": 10700, "v50": 10700, "v60": 10700}
HAND_RPM = {"v33": 11900, "v40": 8400, "v50": 8400, "v60": 8400}


@pytest.mark.parametrize("robot", NAO)
def test_speeds_are_those_of_the_motors(robot):
    version = robot.split("_")[1]
    for name, joint in joints(robot).items():
        if joint.attrib["type"] == "fixed":
            continue
        kind = name if name.startswith("Head") else name[1:]
        ratio = next(ratio for ratio, kinds in RATIOS.items() if kind in kinds)
        rpm = LEG_RPM[version] if ratio in (201.3, 130.85) else ARM_RPM[version]
        if kind in {"WristYaw", "Hand"}:
            rpm = HAND_RPM.get(version, math.nan)
        if (version, kind) == ("v60", "ShoulderPitch"):
            rpm = 11400
        wanted = {"WristYaw": 5.03144, "Hand": 3.71}[kind] if math.isnan(rpm) else rpm * 2 * math.pi / 60 / ratio
        assert limit(robot, name)["velocity"] == pytest.approx(wanted, abs=1e-4), name


@pytest.mark.parametrize("robot", NAO)
def test_hip_yaw_pitch_axes_are_exact_and_coupled(robot):
    half = math.sqrt(0.5)
    assert floats(joints(robot)["LHipYawPitch"].find("axis").attrib["xyz"]) == [0, half, -half]
    assert floats(joints(robot)["RHipYawPitch"].find("axis").attrib["xyz"]) == [0, half, half]
    mimics = {
        name: dict(joint.find("mimic").attrib)
        for name, joint in joints(robot).items()
        if joint.find("mimic") is not None
    }
    assert mimics == {"RHipYawPitch": {"joint": "LHipYawPitch", "multiplier": "1", "offset": "0"}}


@pytest.mark.parametrize("robot", NAO)
def test_positive_hip_yaw_pitch_turns_both_toes_inward_and_swings_the_legs_back(robot):
    left = placement(robot, "l_sole", "torso", {"LHipYawPitch": 0.3})
    right = placement(robot, "r_sole", "torso", {"RHipYawPitch": 0.3})
    assert left.rotation[1, 0] < -0.1
    assert left.translation[0] < -0.02
    mirror = np.diag([1.0, -1.0, 1.0])
    np.testing.assert_allclose(right.translation, mirror @ left.translation, atol=1e-15)
    np.testing.assert_allclose(right.rotation, mirror @ left.rotation @ mirror, atol=1e-15)


@pytest.mark.parametrize("robot", NAO)
def test_right_mirrors_left(robot):
    """Origins, axes and ranges, but for RAnklePitch, whose range differs in the public URDF."""
    table = joints(robot)
    for name, joint in table.items():
        if not name.startswith(("L", "l_")) or "Fsr" in name:
            continue
        other = table[("r" if name[0] == "l" else "R") + name[1:]]
        x, y, z = floats(joint.find("origin").attrib["xyz"])
        assert floats(other.find("origin").attrib["xyz"]) == [x, -y, z]
        roll, pitch, yaw = floats(joint.find("origin").attrib["rpy"])
        assert floats(other.find("origin").attrib["rpy"]) == [-roll, pitch, -yaw]
        if joint.attrib["type"] == "fixed" or name in {"LAnklePitch", "LHand", "LHipYawPitch"}:
            continue
        axis = floats(joint.find("axis").attrib["xyz"])
        assert floats(other.find("axis").attrib["xyz"]) == axis
        left, right = limit(robot, name), limit(robot, other.attrib["name"])
        same = axis == [0, 1, 0]  # pitch; roll and yaw change sign in a mirror
        wanted = (left["lower"], left["upper"]) if same else (-left["upper"], -left["lower"])
        assert (right["lower"], right["upper"]) == wanted, name
