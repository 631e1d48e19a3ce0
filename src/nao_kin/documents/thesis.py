"""S. Bischoff, bachelor thesis on inverse upper-body kinematics of the NAO, April 2016: the arms as printed.

Lengths are those of the thesis' Table 2, which prints LowerArmLength as 55.98 (its Table 1 has 55.95).
"""

from __future__ import annotations

import math
from typing import Final

from nao_kin.dh.dh_chain import DHChain, DHRow
from nao_kin.se3 import rotation_z, translation

__all__ = ["left_arm", "right_arm"]

# Table 2, "named dimensions of the arms", in metres.
SHOULDER_OFFSET_Y: Final = 0.09800
ELBOW_OFFSET_Y: Final = 0.01500
UPPER_ARM_LENGTH: Final = 0.10500
LOWER_ARM_LENGTH: Final = 0.05598
SHOULDER_OFFSET_Z: Final = 0.10000
HAND_OFFSET_X: Final = 0.05775

_QUARTER: Final = math.pi / 2


def left_arm() -> DHChain:
    """Table 3 between T_Basis and Rz(π/2) T_End, equation (3.1.0.1), with the standard matrix of (2.2.2.6).

    The equation prints five factors A_0^1 … A_4^5, the table has four rows; the four are taken.
    """
    return DHChain(
        rows=(
            DHRow(0.0, -_QUARTER, 0.0, 0.0, name="LShoulderPitch"),
            DHRow(0.0, _QUARTER, 0.0, -_QUARTER, name="LShoulderRoll"),
            DHRow(0.0, -_QUARTER, UPPER_ARM_LENGTH, 0.0, sign=-1, name="LElbowYaw"),
            DHRow(0.0, _QUARTER, 0.0, 0.0, name="LElbowRoll"),
        ),
        convention="standard",
        base=translation(0.0, SHOULDER_OFFSET_Y + ELBOW_OFFSET_Y, SHOULDER_OFFSET_Z),
        tool=rotation_z(_QUARTER) * translation(HAND_OFFSET_X + LOWER_ARM_LENGTH, 0.0, 0.0),
        name="thesis_left_arm",
        base_name="torso",
        tip_name="LArm",
    )


def right_arm() -> DHChain:
    """Table 4 between T_Basis and Rz(−π/2) T_End Rz(−π), equation (3.1.0.2), with the standard matrix of (2.2.2.6).

    Four factors for the table's four rows, where the equation prints five.
    """
    return DHChain(
        rows=(
            DHRow(0.0, -_QUARTER, 0.0, 0.0, name="RShoulderPitch"),
            DHRow(0.0, _QUARTER, 0.0, _QUARTER, name="RShoulderRoll"),
            DHRow(0.0, -_QUARTER, -UPPER_ARM_LENGTH, 0.0, name="RElbowYaw"),
            DHRow(0.0, _QUARTER, 0.0, 0.0, name="RElbowRoll"),
        ),
        convention="standard",
        base=translation(0.0, -SHOULDER_OFFSET_Y - ELBOW_OFFSET_Y, SHOULDER_OFFSET_Z),
        tool=rotation_z(-_QUARTER) * translation(HAND_OFFSET_X + LOWER_ARM_LENGTH, 0.0, 0.0) * rotation_z(-math.pi),
        name="thesis_right_arm",
        base_name="torso",
        tip_name="RArm",
    )
