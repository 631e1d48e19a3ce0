"""The PhantomX's file says what its sources say.

Every expected figure is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.make_urdf.files import floats, joints, limit, placement

LEGS = ("rf", "rm", "rr", "lf", "lm", "lr")


# HumaRobotics phantomx_urdf.xacro: coxa joint in the body and heading of the leg at zero [deg from +x].
COXAS = {
    "rf": (0.1248, -0.06164, -45),
    "rm": (0.0, -0.1034, -90),
    "rr": (-0.1248, -0.06164, -135),
    "lf": (0.1248, 0.06164, 45),
    "lm": (0.0, 0.1034, 90),
    "lr": (-0.1248, 0.06164, 135),
}


def point_of(leg: str, outward: float, down: float) -> np.ndarray:
    x, y, heading = COXAS[leg]
    ahead = math.radians(heading)
    return np.array([x + outward * math.cos(ahead), y + outward * math.sin(ahead), 0.001116 - down])


@pytest.mark.parametrize("leg", LEGS)
def test_phantomx_leg_at_zero(leg):
    """Coxa 54 mm, femur 64.5 outward and 14.5 down (HumaRobotics), tibia 133 mm at 34 degrees (KevinOchs, 48 - 14)."""
    lean = math.radians(34)
    for name, outward, down in (
        (f"c1_{leg}", 0, 0),
        (f"thigh_{leg}", 0.054, 0),
        (f"tibia_{leg}", 0.1185, 0.0145),
        (f"foot_{leg}", 0.1185 + 0.133 * math.sin(lean), 0.0145 + 0.133 * math.cos(lean)),
    ):
        pose = placement("phantomx", name, "base_link")
        np.testing.assert_allclose(pose.translation, point_of(leg, outward, down), rtol=0, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("leg", LEGS)
def test_phantomx_axes_and_limits(leg):
    """Coxa about the body's z; tibia axis opposite to the femur's; a positive thigh angle lowers the knee."""
    for joint in ("c1", "thigh", "tibia"):
        given = limit("phantomx", f"j_{joint}_{leg}")
        assert given == {"lower": -2.6179939, "upper": 2.6179939, "velocity": 5.6548668, "effort": 2.8}
        assert floats(joints("phantomx")[f"j_{joint}_{leg}"].find("axis").attrib["xyz"]) == [1, 0, 0]
    coxa, thigh, tibia = (
        placement("phantomx", f"{part}_{leg}", "base_link").rotation[:, 0] for part in ("c1", "thigh", "tibia")
    )
    np.testing.assert_allclose(coxa, (0, 0, 1), rtol=0, atol=1e-15)
    np.testing.assert_allclose(tibia, -thigh, rtol=0, atol=1e-15)
    assert thigh[2] == pytest.approx(0, abs=1e-15)
    assert thigh @ (point_of(leg, 1, 0) - point_of(leg, 0, 0)) == pytest.approx(0, abs=1e-15)
    knee = [placement("phantomx", f"tibia_{leg}", "base_link", {f"j_thigh_{leg}": q}).translation[2] for q in (0, 0.1)]
    foot = [placement("phantomx", f"foot_{leg}", "base_link", {f"j_tibia_{leg}": q}).translation[2] for q in (0, 0.1)]
    assert knee[1] < knee[0]
    assert foot[1] > foot[0]


def test_phantomx_angles_are_exact_multiples_of_a_quarter_turn():
    for joint in joints("phantomx").values():
        eighths = [angle / (math.pi / 4) for angle in floats(joint.find("origin").attrib["rpy"])]
        assert eighths == [round(value) for value in eighths]


def test_phantomx_reaches_its_published_start_position_within_the_limits():
    """KevinOchs phantomX.yaml: middle foot 0.141 m from the coxa axis, body 0.09 m above the ground."""
    femur, tibia, outward, down = math.hypot(0.0645, 0.0145), 0.133, 0.141 - 0.054, 0.09 + 0.001116
    reach = math.hypot(outward, down)
    slope = math.atan2(down, outward) - math.acos((femur**2 + reach**2 - tibia**2) / (2 * femur * reach))
    knee = np.array([femur * math.cos(slope), femur * math.sin(slope)])  # outward, down
    shin = math.atan2(outward - knee[0], down - knee[1])  # from straight down, outward positive
    thigh = slope - math.atan2(0.0145, 0.0645)
    posture = {"j_thigh_lm": thigh, "j_tibia_lm": shin - math.radians(34) + thigh}
    foot = placement("phantomx", "foot_lm", "base_link", posture).translation
    np.testing.assert_allclose(foot, (0, 0.1034 + 0.141, -0.09), rtol=0, atol=1e-12)
    assert max(abs(angle) for angle in posture.values()) < math.radians(100)
