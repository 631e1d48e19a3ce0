"""MathWorks example on the closed-form inverse kinematics of a NAO head, and its helper for the left hand, as printed.

The helper matrix `getT` is the modified (Craig) one. The head's lengths are those of the example's verification run,
which it calls values for illustration only; the left hand is printed with symbols, so it gets the documented lengths of
the V3.3 robot (Aldebaran NAOqi documentation, links_h25_v33).
"""

from __future__ import annotations

import math
from typing import Final

from nao_kin.dh.dh_chain import DHChain, DHRow
from nao_kin.se3 import rotation_x, rotation_y, rotation_z, translation

__all__ = ["head", "left_hand"]

# Verification example, "CameraX = 53.9; CameraZ = 67.9; NeckOffsetZ = -5", millimetres there.
CAMERA_X: Final = 0.0539
CAMERA_Z: Final = 0.0679
NECK_OFFSET_Z: Final = -0.005

_QUARTER: Final = math.pi / 2


def head() -> DHChain:
    """ABase0 · T01 · T12 · Rx · Ry · A2Head of getKinematicChain('head')."""
    return DHChain(
        rows=(
            DHRow(0.0, 0.0, 0.0, 0.0, name="HeadYaw"),
            DHRow(0.0, -_QUARTER, 0.0, -_QUARTER, name="HeadPitch"),
        ),
        convention="modified",
        base=translation(0.0, 0.0, NECK_OFFSET_Z),
        tool=rotation_x(_QUARTER) * rotation_y(_QUARTER) * translation(CAMERA_X, 0.0, CAMERA_Z),
        name="matlab_head",
        base_name="torso",
        tip_name="CameraTop_frame",
    )


def left_hand() -> DHChain:
    """ABase0 · T01 · T12 · T32 · T43 · Rz · AEnd4 of getKinematicChain('lefthand')."""
    shoulder_offset_y, elbow_offset_y, shoulder_offset_z = 0.098, 0.015, 0.100
    upper_arm_length, lower_arm_length, hand_offset_x = 0.105, 0.05595, 0.05775
    return DHChain(
        rows=(
            DHRow(0.0, -_QUARTER, 0.0, 0.0, name="LShoulderPitch"),
            DHRow(0.0, _QUARTER, 0.0, -_QUARTER, name="LShoulderRoll"),
            DHRow(0.0, -_QUARTER, upper_arm_length, 0.0, name="LElbowYaw"),
            DHRow(0.0, _QUARTER, 0.0, 0.0, name="LElbowRoll"),
        ),
        convention="modified",
        base=translation(0.0, shoulder_offset_y + elbow_offset_y, shoulder_offset_z),
        tool=rotation_z(_QUARTER) * translation(hand_offset_x + lower_arm_length, 0.0, 0.0),
        name="matlab_left_hand",
        base_name="torso",
        tip_name="LArm",
    )
