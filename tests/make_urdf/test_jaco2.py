"""The JACO2's file says what its sources say.

Every expected figure is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from tests.make_urdf.files import floats, joints, limit, placement

if TYPE_CHECKING:
    import pinocchio as pin


def arm_pose(degrees: tuple[float, ...]) -> pin.SE3:
    posture = {f"joint_{k}": math.radians(angle) for k, angle in enumerate(degrees, start=1)}
    return placement("jaco2", "end_effector", "link_base", posture)


@pytest.mark.parametrize(
    ("degrees", "position", "tolerance"),
    [
        ((180, 270, 90, 180, 180, 0), (0.410000, 0.259456, 0.084059), 1e-6),
        ((180,) * 6, (0.0, 0.259456, 0.876941), 1e-6),
        # "Home" and "Retract" of kinova_moveit's j2n6s300 SRDF; the angles are printed to 1e-3 degrees
        ((275.288, 167.580, 57.410, 240.825, 82.838, 75.820), (0.212743, -0.256609, 0.506962), 2e-5),
        ((-89.780, 150.052, 26.860, -92.178, 5.180, 99.752), (0.027817, -0.169251, 0.298066), 2e-5),
    ],
)
def test_jaco2_check_poses(degrees, position, tolerance):
    np.testing.assert_allclose(arm_pose(degrees).translation, position, rtol=0, atol=tolerance)


def test_jaco2_orientation_of_the_practicum_check():
    expected = [[0, 1, 0], [-0.5, 0, math.sqrt(0.75)], [math.sqrt(0.75), 0, 0.5]]
    np.testing.assert_allclose(arm_pose((180, 270, 90, 180, 180, 0)).rotation, expected, rtol=0, atol=1e-12)


def test_jaco2_is_the_table_of_j2n6s300():
    half, third = math.pi / 2, math.pi / 3
    expected = {  # j2n6s300.xacro of kinova-ros: type, xyz, rpy, range [deg], speed [deg/s], effort
        "joint_1": ("continuous", [0, 0, 0.15675], [0, math.pi, 0], None, 36, 40),
        "joint_2": ("revolute", [0, 0.0016, -0.11875], [-half, 0, math.pi], (47, 313), 36, 80),
        "joint_3": ("revolute", [0, -0.41, 0], [0, math.pi, 0], (19, 341), 36, 40),
        "joint_4": ("continuous", [0, 0.2073, -0.0114], [-half, 0, math.pi], None, 48, 20),
        "joint_5": ("continuous", [0, -0.03703, -0.06414], [third, 0, math.pi], None, 48, 20),
        "joint_6": ("continuous", [0, -0.03703, -0.06414], [third, 0, math.pi], None, 48, 20),
    }
    for name, (kind, xyz, rpy, span, speed, effort) in expected.items():
        joint, given = joints("jaco2")[name], limit("jaco2", name)
        assert joint.attrib["type"] == kind
        assert floats(joint.find("origin").attrib["xyz"]) == xyz
        assert floats(joint.find("origin").attrib["rpy"]) == rpy
        assert floats(joint.find("axis").attrib["xyz"]) == [0, 0, 1]
        assert given["velocity"] == pytest.approx(math.radians(speed), rel=1e-15)
        assert given["effort"] == effort
        if span is None:
            assert set(given) == {"velocity", "effort"}
        else:
            assert (given["lower"], given["upper"]) == pytest.approx([math.radians(a) for a in span], rel=1e-15)
    tool = joints("jaco2")["joint_end_effector"]
    assert floats(tool.find("origin").attrib["xyz"]) == [0, 0, -0.16]
    assert floats(tool.find("origin").attrib["rpy"]) == [math.pi, 0, half]
