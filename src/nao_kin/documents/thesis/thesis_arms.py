"""Bischoff 2016: its arms as printed, the robot's own, and the arm that sections 3.1 and 3.3 describe."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
import pinocchio as pin

from nao_kin.dh.dh_chain import DHChain, DHRow
from nao_kin.robot.robot import Robot, load
from nao_kin.se3 import rotation_z, translation

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = [
    "DescribedArm",
    "Side",
    "arm_configurations",
    "described_arm",
    "left_arm",
    "nao",
    "right_arm",
    "robot_arm",
    "shoulder_to_forearm",
]

Side = Literal["left", "right"]

ROBOT: Final = "nao_v50_h21"
"""Version 5, and wrists fixed, as the thesis has it."""


@cache
def nao() -> Robot:
    """The robot."""
    return load(ROBOT)


@cache
def robot_arm(side: Side) -> UrdfChain:
    """Torso to the hand effector, as the robot has it."""
    return nao().chain(f"{side}_arm")


@dataclass(frozen=True, eq=False, slots=True)
class DescribedArm:
    """The robot's arm with ElbowOffsetY moved to the shoulder and without HandOffsetZ.

    Attributes:
        side: Which.
        model: Pinocchio's model of the robot, so changed.
        joints: Its four joints, shoulder to elbow.
        shoulder: Where the shoulder is in the torso frame (3,) [m].
        l1: Its distance from the plane of symmetry, ShoulderOffsetY + ElbowOffsetY [m].
        l2: Its height, ShoulderOffsetZ [m].
        l3: UpperArmLength [m].
        l4: HandOffsetX + LowerArmLength [m].
    """

    side: Side
    model: pin.Model
    joints: tuple[int, ...]
    shoulder: Floats
    l1: float
    l2: float
    l3: float
    l4: float

    def pose(self, q: Floats) -> Floats:
        """T_torso_hand (4, 4) at the robot's own joint angles (4,)."""
        forearm = self._forearm(q)
        return np.asarray((forearm * translation(self.l4, 0.0, 0.0)).homogeneous)

    def elbow(self, q: Floats) -> Floats:
        """Where the elbow is in the torso frame (3,) [m]."""
        return np.array(self._forearm(q).translation)

    def _forearm(self, q: Floats) -> pin.SE3:
        values, data = pin.neutral(self.model), self.model.createData()
        for joint, value in zip(self.joints, q, strict=True):
            values[self.model.joints[joint].idx_q] = value
        pin.forwardKinematics(self.model, data, values)
        return pin.SE3(data.oMi[self.joints[-1]])


@cache
def described_arm(side: Side) -> DescribedArm:
    """The arm of sections 3.1 and 3.3, out of the robot's model."""
    model = pin.Model(nao().model)
    names = robot_arm(side).joint_names
    joints = tuple(model.getJointId(name) for name in names)  # names of this model, so none is unknown
    placements = model.jointPlacements
    offset = np.array([0.0, placements[joints[2]].translation[1], 0.0])
    for joint, moved in ((joints[0], offset), (joints[2], -offset)):
        placement = placements[joint]
        model.jointPlacements[joint] = pin.SE3(placement.rotation, placement.translation + moved)
    shoulder = np.array(model.jointPlacements[joints[0]].translation)
    hand = nao().pose({}, "LArm" if side == "left" else "RArm", "torso").translation
    l3 = float(model.jointPlacements[joints[2]].translation[0])
    return DescribedArm(
        side, model, joints, shoulder, abs(float(shoulder[1])), float(shoulder[2]), l3, float(hand[0]) - l3
    )


def shoulder_to_forearm(side: Side, q: Floats) -> Floats:
    """The four joints of the described arm alone (4, 4): from the shoulder's frame to the forearm's."""
    arm = described_arm(side)
    T = arm.pose(q)
    T[:3, 3] -= arm.shoulder + T[:3, 0] * arm.l4
    return T


def arm_configurations(side: Side, count: int, seed: int, keep: Callable[[Floats], bool] | None = None) -> Floats:
    """Configurations (N, 4) of the robot's arm, uniform inside its limits, of those that are to be kept."""
    chain, rng, found = robot_arm(side), np.random.default_rng(seed), list["Floats"]()
    while len(found) < count:
        q = rng.uniform(chain.lower, chain.upper)
        if keep is None or keep(q):
            found.append(q)
    return np.array(found)


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
