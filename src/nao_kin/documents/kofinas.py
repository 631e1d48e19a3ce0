"""DH tables of the NAO by Kofinas, Orfanoudakis and Lagoudakis, from whom thesis and MATLAB example take their chains.

Their paper is "Complete analytical inverse kinematics for NAO", 2013; the figures here are those of their public
library NAOKinematics, which are in the modified (Craig) convention. Lengths by default are those of V3.3 to V6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from nao_kin.dh.dh_chain import DHChain, DHRow
from nao_kin.se3 import rotation_x, rotation_y, rotation_z, translation

__all__ = ["V33_LENGTHS", "Lengths", "arm", "head", "leg"]

_HALF, _QUARTER, _EIGHTH = math.pi, math.pi / 2, math.pi / 4

Side = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class Lengths:
    """Documented dimensions of a NAO generation [m], by the manufacturer's names."""

    neck_offset_z: float
    shoulder_offset_y: float
    shoulder_offset_z: float
    elbow_offset_y: float
    upper_arm_length: float
    lower_arm_length: float
    hand_offset_x: float
    hand_offset_z: float
    hip_offset_y: float
    hip_offset_z: float
    thigh_length: float
    tibia_length: float
    foot_height: float


V33_LENGTHS: Final = Lengths(
    neck_offset_z=0.1265,
    shoulder_offset_y=0.098,
    shoulder_offset_z=0.100,
    elbow_offset_y=0.015,
    upper_arm_length=0.105,
    lower_arm_length=0.05595,
    hand_offset_x=0.05775,
    hand_offset_z=0.01231,
    hip_offset_y=0.050,
    hip_offset_z=0.085,
    thigh_length=0.100,
    tibia_length=0.1029,
    foot_height=0.04519,
)
"""NAOqi documentation, links of H25 V3.3; V4, V5 and V6 share them. The URDF's soles use a foot height of 45.11 mm."""


def head(lengths: Lengths = V33_LENGTHS) -> DHChain:
    """Torso to the Head frame, which is at the neck."""
    return DHChain(
        rows=(
            DHRow(0.0, 0.0, 0.0, 0.0, name="HeadYaw"),
            DHRow(0.0, -_QUARTER, 0.0, -_QUARTER, name="HeadPitch"),
        ),
        convention="modified",
        base=translation(0.0, 0.0, lengths.neck_offset_z),
        tool=rotation_x(_QUARTER) * rotation_y(_QUARTER),
        name="kofinas_head",
        base_name="torso",
        tip_name="Head",
    )


def arm(side: Side, hands: Literal["h21", "h25"] = "h25", lengths: Lengths = V33_LENGTHS) -> DHChain:
    """Torso to the hand effector LArm or RArm: five joints on H25, four on H21, whose wrist is fixed."""
    s, letter = (1.0, "L") if side == "left" else (-1.0, "R")
    hand = translation(lengths.hand_offset_x, 0.0, -lengths.hand_offset_z)
    rows = [
        DHRow(0.0, -_QUARTER, 0.0, 0.0, name=f"{letter}ShoulderPitch"),
        DHRow(0.0, _QUARTER, 0.0, _QUARTER, name=f"{letter}ShoulderRoll"),
        DHRow(s * lengths.elbow_offset_y, _QUARTER, lengths.upper_arm_length, 0.0, name=f"{letter}ElbowYaw"),
        DHRow(0.0, -_QUARTER, 0.0, 0.0, name=f"{letter}ElbowRoll"),
    ]
    if hands == "h25":
        rows.append(DHRow(0.0, _QUARTER, lengths.lower_arm_length, 0.0, name=f"{letter}WristYaw"))
        tool = rotation_x(-_QUARTER) * rotation_z(-_QUARTER) * hand
    else:
        tool = rotation_z(-_QUARTER) * translation(lengths.lower_arm_length, 0.0, 0.0) * hand
    return DHChain(
        rows=tuple(rows),
        convention="modified",
        base=translation(0.0, s * lengths.shoulder_offset_y, lengths.shoulder_offset_z),
        tool=tool,
        name=f"kofinas_{side}_arm" + ("_h21" if hands == "h21" else ""),
        base_name="torso",
        tip_name=f"{letter}Arm",
    )


def leg(side: Side, lengths: Lengths = V33_LENGTHS) -> DHChain:
    """Torso to the foot effector LLeg or RLeg, FootHeight below the ankle."""
    s, letter = (1.0, "L") if side == "left" else (-1.0, "R")
    first_twist = -3.0 * _EIGHTH if side == "left" else -_EIGHTH
    return DHChain(
        rows=(
            DHRow(0.0, first_twist, 0.0, -_QUARTER, name=f"{letter}HipYawPitch"),
            DHRow(0.0, -_QUARTER, 0.0, s * _EIGHTH, name=f"{letter}HipRoll"),
            DHRow(0.0, _QUARTER, 0.0, 0.0, name=f"{letter}HipPitch"),
            DHRow(-lengths.thigh_length, 0.0, 0.0, 0.0, name=f"{letter}KneePitch"),
            DHRow(-lengths.tibia_length, 0.0, 0.0, 0.0, name=f"{letter}AnklePitch"),
            DHRow(0.0, -_QUARTER, 0.0, 0.0, name=f"{letter}AnkleRoll"),
        ),
        convention="modified",
        base=translation(0.0, s * lengths.hip_offset_y, -lengths.hip_offset_z),
        tool=rotation_z(_HALF) * rotation_y(-_QUARTER) * translation(0.0, 0.0, -lengths.foot_height),
        name=f"kofinas_{side}_leg",
        base_name="torso",
        tip_name=f"{letter}Leg",
    )
