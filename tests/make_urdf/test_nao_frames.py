"""NAO's frames and its looks at the zero posture.

Every expected figure is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

from tests.make_urdf.files import NAO, NAO_H25, floats, links, placement

if TYPE_CHECKING:
    from lxml import etree

# Sums of the NAOqi documentation's lengths [mm] in the torso frame. Arm: 98 + 15 = 113 (V3.2: 98), 105 + 55.95 + 57.75
# = 218.70 (V3.2: 90 + 50.55 + 58 = 198.55), 100 - 12.31 (V3.2: 100 - 15.90). Leg: 85 + 100 + 102.9 = 287.9 to the
# ankle, then 45.11 to the public URDF's sole or 45.19 to the documented effector. Head: 126.5 + the camera's place.
ARM = {"old": (0.19855, 0.098, 0.0841), "new": (0.2187, 0.113, 0.08769)}
CAMERAS = {  # x, z in the torso, pitch: V3.x; V4, V5, V6
    "old": {"CameraTop_frame": (0.0539, 0.1944, 0.0), "CameraBottom_frame": (0.0488, 0.15031, 0.6981)},
    "new": {"CameraTop_frame": (0.05871, 0.19014, 0.0209435), "CameraBottom_frame": (0.05071, 0.14424, 0.692896)},
}


@pytest.mark.parametrize("robot", NAO)
def test_frames_at_zero_are_the_sums_of_the_documented_lengths(robot):
    x, y, z = ARM["old" if "v32" in robot else "new"]
    effector = -0.33301 if "v32" in robot else -0.33309
    expected = {"Head": (0, 0, 0.1265), "gaze": (0.05871, 0, 0.19014)}
    for side, sign in (("L", 1), ("R", -1)):
        small = side.lower()
        expected[f"{side}Arm"] = expected[f"{small}_gripper"] = (x, sign * y, z)
        expected[f"{small}_wrist"] = (0.14055 if "v32" in robot else 0.16095, sign * y, 0.1)
        expected[f"{small}_sole"] = (0, sign * 0.05, -0.33301)
        expected[f"{side}Leg"] = (0, sign * 0.05, effector)
        expected[f"{small}_ankle"] = (0, sign * 0.05, -0.2879)
    for name, position in expected.items():
        pose = placement(robot, name, "torso")
        np.testing.assert_allclose(pose.translation, position, rtol=0, atol=1e-15, err_msg=name)
        np.testing.assert_array_equal(pose.rotation, np.eye(3), err_msg=name)


@pytest.mark.parametrize("robot", NAO)
def test_cameras(robot):
    for name, (x, z, pitch) in CAMERAS["old" if "v3" in robot else "new"].items():
        pose = placement(robot, name, "torso")
        np.testing.assert_allclose(pose.translation, (x, 0, z), rtol=0, atol=1e-15)
        np.testing.assert_allclose(pose.rotation, pin.rpy.rpyToMatrix(0, pitch, 0), rtol=0, atol=1e-15)
        optical = placement(robot, name.replace("_frame", "_optical_frame"), name)  # z looks ahead, x right, y down
        np.testing.assert_allclose(optical.rotation, [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], rtol=0, atol=1e-15)
        np.testing.assert_array_equal(optical.translation, np.zeros(3))


@pytest.mark.parametrize("robot", NAO)
def test_sensor_frames(robot):
    """Public nao.urdf of V50, in the parent named."""
    expected = {
        ("ImuTorsoAccelerometer_frame", "torso"): (-0.008, 0.00606, 0.027),
        ("ImuTorsoGyrometer_frame", "torso"): (-0.008, 0.006, 0.029),
        ("LSonar_frame", "torso"): (0.00558253, 0.0192068, 0.0623853),
        ("RSonar_frame", "torso"): (0.00558253, -0.0192068, 0.0623853),
        ("LFsrFL_frame", "l_sole"): (0.07025, 0.0299, 0),
        ("LFsrFR_frame", "l_sole"): (0.07025, -0.0231, 0),
        ("LFsrRL_frame", "l_sole"): (-0.03025, 0.0299, 0),
        ("LFsrRR_frame", "l_sole"): (-0.02965, -0.0191, 0),
        ("RFsrFL_frame", "r_sole"): (0.07025, 0.0231, 0),
        ("RFsrFR_frame", "r_sole"): (0.07025, -0.0299, 0),
        ("RFsrRL_frame", "r_sole"): (-0.03025, 0.0191, 0),
        ("RFsrRR_frame", "r_sole"): (-0.02965, -0.0299, 0),
    }
    for (name, parent), position in expected.items():
        np.testing.assert_allclose(
            placement(robot, name, parent).translation, position, rtol=0, atol=1e-15, err_msg=name
        )
    sonar = placement(robot, "LSonar_frame", "torso").rotation
    np.testing.assert_allclose(sonar, pin.rpy.rpyToMatrix(-0.00478508, 0.0436497, 0.392441), rtol=0, atol=1e-15)


@pytest.mark.parametrize("robot", NAO_H25)
def test_the_gripper_turns_with_the_hand_and_the_effector_does_not(robot):
    opened = {"LHand": 1.0}
    np.testing.assert_array_equal(placement(robot, "LArm", "l_wrist", opened).rotation, np.eye(3))
    turned = pin.rpy.rpyToMatrix(1.0, 0.0, 0.0)
    np.testing.assert_allclose(placement(robot, "l_gripper", "l_wrist", opened).rotation, turned, rtol=0, atol=1e-15)


@pytest.mark.parametrize("robot", NAO)
def test_the_visuals_stand_573_mm_tall_on_the_published_foot(robot):
    """573 mm: Aldebaran's data sheet. Foot outline, left: 100 and 50, 50.02 and 38.77 mm (B-Human's configuration)."""
    corners = visual_corners(robot)
    highest, lowest = corners["Head"][:, 2].max(), corners["l_ankle"][:, 2].min()
    assert highest - lowest == pytest.approx(0.573, abs=0.003)
    foot = corners["l_ankle"] - placement(robot, "l_sole", "torso").translation
    np.testing.assert_allclose(foot.min(axis=0)[:2], (-0.05, -0.03877), atol=2e-4)
    np.testing.assert_allclose(foot.max(axis=0)[:2], (0.1, 0.05002), atol=2e-4)
    head = corners["Head"]
    assert 0.12 <= np.ptp(head[:, 1]) <= 0.14
    for left, right in (("LBicep", "RBicep"), ("LTibia", "RTibia"), ("l_ankle", "r_ankle")):
        np.testing.assert_allclose(corners[left].max(axis=0)[1], -corners[right].min(axis=0)[1], atol=1e-9)


def visual_corners(robot: str) -> dict[str, np.ndarray]:
    """Extreme points of each link's visuals along the torso's axes, at zero."""
    points: dict[str, list[np.ndarray]] = {}
    for name, link in links(robot).items():
        for visual in link.findall("visual"):
            pose = placement(robot, name, "torso") * origin(visual)
            half = half_extent(visual.find("geometry")[0], pose.rotation)
            points.setdefault(name, []).extend((pose.translation - half, pose.translation + half))
    return {name: np.array(rows) for name, rows in points.items()}


def origin(element: etree._Element) -> pin.SE3:
    found = element.find("origin")
    if found is None:
        return pin.SE3.Identity()
    return pin.SE3(pin.rpy.rpyToMatrix(*floats(found.attrib["rpy"])), np.array(floats(found.attrib["xyz"])))


def half_extent(shape: etree._Element, rotation: np.ndarray) -> np.ndarray:
    if shape.tag == "sphere":
        return np.full(3, float(shape.attrib["radius"]))
    if shape.tag == "box":
        return np.abs(rotation) @ floats(shape.attrib["size"]) / 2
    along = rotation[:, 2]
    across = np.sqrt(np.clip(1 - along**2, 0, None))
    return np.abs(along) * float(shape.attrib["length"]) / 2 + across * float(shape.attrib["radius"])
