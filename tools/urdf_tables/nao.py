"""The NAO: lengths, joints, limits, speeds and frames of every version, and the robot built from them.

Sources: "Docs" is the Aldebaran / SoftBank Robotics NAOqi documentation (links, joints, motors, video and effector
pages of V3.2, V3.3, H21 and H25); "URDF" is the generated nao.urdf of ros-naoqi/nao_robot for V32, V33, V40 and V50;
the lengths of V4 to V6 are confirmed by the published robot configurations of NaoTH (BerlinUnited), rUNSWift and
B-Human.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from urdf_tables import nao_header, nao_shapes
from urdf_tables.inertia import merged
from urdf_tables.model import ZERO, Joint, Limit, Link, Pose, Robot, X, Y, Z, frame, mirrored, shifted
from urdf_tables.nao_masses import BODIES

if TYPE_CHECKING:
    from urdf_tables.model import Inertial, Solid, Triple

NECK_OFFSET_Z = 0.1265
SHOULDER_OFFSET_Y, SHOULDER_OFFSET_Z = 0.098, 0.1
HIP_OFFSET_Y, HIP_OFFSET_Z = 0.05, 0.085
THIGH_LENGTH, TIBIA_LENGTH = 0.1, 0.1029
SOLE_HEIGHT = 0.04511  # the public URDF's l_sole and r_sole in every version
_DIAGONAL = math.sqrt(0.5)  # the URDF prints 0.707106


@dataclass(frozen=True, slots=True)
class Version:
    """What differs between the robots, in metres and rad/s.

    Attributes:
        foot_height: AnkleRoll to the documented effector LLeg (Docs: 45.11 mm for V3.2, 45.19 mm from V3.3 on).
        hand: HandOffsetX and HandOffsetZ. The V33 URDF prints 0.01213 for the right hand; Docs and xacro say 0.01231.
        cameras: For top and bottom: x, z and pitch in the Head link.
        speeds: Greatest speed by motor group (see `_JOINTS`).
        masses: Key of the table of masses.
    """

    elbow_y: float
    upper_arm: float
    lower_arm: float
    hand: tuple[float, float]
    foot_height: float
    cameras: tuple[Triple, Triple]
    speeds: dict[str, float]
    masses: str


# Docs, motors pages (V3.2, V3.3); rUNSWift bodyV5.cpp and bodyV6.cpp: no-load rpm / reduction ratio, as rad/s.
# Ratios: leg roll 201.3, leg pitch 130.85, yaw and shoulder 150.27, head pitch and arm roll 173.22, wrist 50.61, hand
# 36.24.
# Motors in rpm: V3.x legs 8000, arms 11900; V4, V5 legs 8300, arms 10700, hands 8400; V6 as V5, but legs 8700 and
# ShoulderPitch 11400.
_GROUPS = ("leg_roll", "leg_pitch", "yaw", "shoulder", "roll", "wrist", "hand")
_SPEEDS: dict[str, tuple[float, ...]] = {
    "V32": (4.1617, 6.4024, 8.2928, 8.2928, 7.1941, 5.03144, 3.71),  # wrist and hand: URDF V32
    "V33": (4.1617, 6.4024, 8.2928, 8.2928, 7.1941, 24.6229, 34.3865),
    "V40": (4.3178, 6.6425, 7.4566, 7.4566, 6.4687, 17.3809, 24.2728),
    "V60": (4.5259, 6.9626, 7.4566, 7.9444, 6.4687, 17.3809, 24.2728),
}
_OLD_CAMERAS = ((0.0539, 0.0679, 0.0), (0.0488, 0.02381, 0.6981))  # Docs video; URDF V32, V33
_NEW_CAMERAS = ((0.05871, 0.06364, 0.0209435), (0.05071, 0.01774, 0.692896))  # Docs video; URDF V40, V50; NaoTH (V6)


def _version(speeds: str, cameras: tuple[Triple, Triple], masses: str) -> Version:
    by_group = dict(zip(_GROUPS, _SPEEDS[speeds], strict=True))
    if speeds == "V32":  # Docs, links of V3.2; URDF V32
        return Version(0.0, 0.09, 0.05055, (0.058, 0.0159), 0.04511, cameras, by_group, masses)
    return Version(0.015, 0.105, 0.05595, (0.05775, 0.01231), 0.04519, cameras, by_group, masses)


VERSIONS: dict[str, Version] = {
    "v32": _version("V32", _OLD_CAMERAS, "V33"),
    "v33": _version("V33", _OLD_CAMERAS, "V33"),
    "v40": _version("V40", _NEW_CAMERAS, "V40"),
    "v50": _version("V40", _NEW_CAMERAS, "V50"),
    "v60": _version("V60", _NEW_CAMERAS, "V50"),
}
NAMES: tuple[str, ...] = (
    "nao_v32_h25",
    *(f"nao_{v}_{h}" for v in ("v33", "v40", "v50", "v60") for h in ("h21", "h25")),
)

# Joint, parent, child, axis, lower, upper, effort, motor group. Source: URDF V50, equal in V33 and V40, as printed
# (LAnklePitch and RAnklePitch differ, and so do the efforts 3.023 and 3.0226, 1.7835 and 1.783).
_Row = tuple[str, str, str, "Triple", float, float, float, str]
_JOINTS: tuple[_Row, ...] = (
    ("HeadYaw", "torso", "Neck", Z, -2.08567, 2.08567, 1.547, "yaw"),
    ("HeadPitch", "Neck", "Head", Y, -0.671952, 0.514872, 1.532, "roll"),
    ("LShoulderPitch", "torso", "LShoulder", Y, -2.08567, 2.08567, 1.329, "shoulder"),
    ("LShoulderRoll", "LShoulder", "LBicep", Z, -0.314159, 1.32645, 1.7835, "roll"),
    ("LElbowYaw", "LBicep", "LElbow", X, -2.08567, 2.08567, 1.547, "yaw"),
    ("LElbowRoll", "LElbow", "LForeArm", Z, -1.54462, -0.0349066, 1.532, "roll"),
    ("LWristYaw", "LForeArm", "l_wrist", X, -1.82387, 1.82387, 0.4075, "wrist"),
    ("LHand", "l_wrist", "l_gripper", X, 0.0, 1.0, 0.292, "hand"),
    ("LHipYawPitch", "torso", "LPelvis", (0.0, _DIAGONAL, -_DIAGONAL), -1.14529, 0.740718, 3.348, "leg_roll"),
    ("LHipRoll", "LPelvis", "LHip", X, -0.379435, 0.79046, 3.348, "leg_roll"),
    ("LHipPitch", "LHip", "LThigh", Y, -1.53589, 0.48398, 3.023, "leg_pitch"),
    ("LKneePitch", "LThigh", "LTibia", Y, -0.0923279, 2.11255, 3.023, "leg_pitch"),
    ("LAnklePitch", "LTibia", "LAnklePitch", Y, -1.18944, 0.922581, 3.023, "leg_pitch"),
    ("LAnkleRoll", "LAnklePitch", "l_ankle", X, -0.397761, 0.768992, 3.348, "leg_roll"),
    ("RHipYawPitch", "torso", "RPelvis", (0.0, _DIAGONAL, _DIAGONAL), -1.14529, 0.740718, 3.348, "leg_roll"),
    ("RHipRoll", "RPelvis", "RHip", X, -0.79046, 0.379435, 3.348, "leg_roll"),
    ("RHipPitch", "RHip", "RThigh", Y, -1.53589, 0.48398, 3.0226, "leg_pitch"),
    ("RKneePitch", "RThigh", "RTibia", Y, -0.0923279, 2.11255, 3.0226, "leg_pitch"),
    ("RAnklePitch", "RTibia", "RAnklePitch", Y, -1.1863, 0.932006, 3.0226, "leg_pitch"),
    ("RAnkleRoll", "RAnklePitch", "r_ankle", X, -0.768992, 0.397761, 3.348, "leg_roll"),
    ("RShoulderPitch", "torso", "RShoulder", Y, -2.08567, 2.08567, 1.329, "shoulder"),
    ("RShoulderRoll", "RShoulder", "RBicep", Z, -1.32645, 0.314159, 1.783, "roll"),
    ("RElbowYaw", "RBicep", "RElbow", X, -2.08567, 2.08567, 1.547, "yaw"),
    ("RElbowRoll", "RElbow", "RForeArm", Z, 0.0349066, 1.54462, 1.532, "roll"),
    ("RWristYaw", "RForeArm", "r_wrist", X, -1.82387, 1.82387, 0.4075, "wrist"),
    ("RHand", "r_wrist", "r_gripper", X, 0.0, 1.0, 0.292, "hand"),
)
_LIMITS_V32: dict[str, tuple[float, float]] = {  # URDF V32
    "LShoulderRoll": (0.00872665, 1.64934),
    "LElbowRoll": (-1.56207, -0.00872665),
    "RShoulderRoll": (-1.64934, -0.00872665),
    "RElbowRoll": (0.00872665, 1.56207),
}
_LEADERS = {"RHipYawPitch": "LHipYawPitch"}  # Docs: one motor turns both
_HAND_JOINTS = ("WristYaw", "Hand")  # absent in H21


def build(name: str) -> Robot:
    """The robot of one of `NAMES`."""
    _, version_name, body = name.split("_")
    version, full = VERSIONS[version_name], body == "h25"
    shapes = _shapes(version)
    bodies = BODIES[version.masses]
    limits = _LIMITS_V32 if version_name == "v32" else {}
    limbs: list[tuple[Joint, Link]] = []
    for row in _JOINTS:
        if full or not row[0].endswith(_HAND_JOINTS):
            link = _link(row[2], version, bodies, shapes, full=full)
            limbs.append((_joint(row, version, limits), link))
        limbs.extend(_frames_after(row[0], version, full=full))
    limbs.extend(_torso_frames())
    header = nao_header.paragraphs(version_name, full=full)
    root = Link("torso", nao_shapes.TORSO, nao_shapes.COLLISIONS["torso"], bodies["torso"])
    return Robot(name, header, nao_shapes.MATERIALS, root, tuple(limbs))


def _joint(row: _Row, version: Version, limits: dict[str, tuple[float, float]]) -> Joint:
    name, parent, child, axis, lower, upper, effort, group = row
    lower, upper = limits.get(name, (lower, upper))
    limit = Limit(lower, upper, version.speeds[group], effort)
    return Joint(name, "revolute", parent, child, Pose(_origin(name, version)), axis, limit, _LEADERS.get(name, ""))


def _origin(joint: str, version: Version) -> Triple:
    """Where a joint sits in its parent link; at zero all frames are parallel to the torso's."""
    side = 1.0 if joint.startswith("L") else -1.0
    hand_x, hand_z = version.hand
    origins: dict[str, Triple] = {
        "HeadYaw": (0.0, 0.0, NECK_OFFSET_Z),
        "ShoulderPitch": (0.0, side * SHOULDER_OFFSET_Y, SHOULDER_OFFSET_Z),
        "ElbowYaw": (version.upper_arm, side * version.elbow_y, 0.0),
        "WristYaw": (version.lower_arm, 0.0, 0.0),
        "Hand": (hand_x, 0.0, -hand_z),
        "HipYawPitch": (0.0, side * HIP_OFFSET_Y, -HIP_OFFSET_Z),
        "KneePitch": (0.0, 0.0, -THIGH_LENGTH),
        "AnklePitch": (0.0, 0.0, -TIBIA_LENGTH),
    }
    return origins.get(joint if joint.startswith("Head") else joint[1:], ZERO)


def _link(
    name: str, version: Version, bodies: dict[str, Inertial], shapes: dict[str, tuple[Solid, ...]], *, full: bool
) -> Link:
    visuals, collisions = shapes.get(name, ()), nao_shapes.COLLISIONS.get(name, ())
    inertial = bodies.get(name)
    if name.endswith("ForeArm") and not full:
        wrist, reach = f"{name[0].lower()}_wrist", (version.lower_arm, 0.0, 0.0)
        visuals += shifted(shapes[wrist], reach)
        collisions += shifted(nao_shapes.COLLISIONS[wrist], reach)
        inertial = merged([(bodies[name], ZERO), (bodies[wrist], reach)])
    remark = (
        "no inertia of its own: the published figures of the wrist link include the hand" if "gripper" in name else ""
    )
    return Link(name, visuals, collisions, inertial, remark)


def _shapes(version: Version) -> dict[str, tuple[Solid, ...]]:
    """Visuals by link; the right side mirrors the left."""
    left = nao_shapes.left_arm(version.upper_arm, version.elbow_y, version.lower_arm) | nao_shapes.LEFT_LEG
    right = {nao_shapes.right_name(name): mirrored(solids) for name, solids in left.items()}
    return {"Neck": nao_shapes.NECK, "Head": nao_shapes.head(version.cameras)} | left | right


def _frames_after(joint: str, version: Version, *, full: bool) -> list[tuple[Joint, Link]]:
    if joint == "HeadPitch":
        return _head_frames(version)
    if joint.endswith("AnkleRoll"):
        return _foot_frames(joint[0], version)
    if joint.endswith("Hand"):
        return _arm_frames(joint[0], version, full=full)
    return []


def _head_frames(version: Version) -> list[tuple[Joint, Link]]:
    """Docs, video; URDF. `gaze` is at the V4 top camera in the public files of every version."""
    frames = [frame("gaze", "Head", (0.05871, 0.0, 0.06364))]
    for which, (x, z, pitch) in zip(("Top", "Bottom"), version.cameras, strict=True):
        name = f"Camera{which}_frame"
        frames.append(frame(name, "Head", (x, 0.0, z), (0.0, pitch, 0.0)))
        frames.append(frame(f"Camera{which}_optical_frame", name, ZERO, (-math.pi / 2, 0.0, -math.pi / 2)))
    return frames


def _arm_frames(side: str, version: Version, *, full: bool) -> list[tuple[Joint, Link]]:
    """The effector LArm or RArm (Docs); without wrist and hand motors also the frames that would move with them."""
    (hand_x, hand_z), small = version.hand, side.lower()
    if full:
        return [frame(f"{side}Arm", f"{small}_wrist", (hand_x, 0.0, -hand_z))]
    forearm, reach = f"{side}ForeArm", version.lower_arm
    hand = (reach + hand_x, 0.0, -hand_z)
    return [
        frame(f"{small}_wrist", forearm, (reach, 0.0, 0.0)),
        frame(f"{small}_gripper", forearm, hand),
        frame(f"{side}Arm", forearm, hand),
    ]


# URDF V50: pressure sensors of the left and the right foot in the ankle's frame, x and y.
_PRESSURE: dict[str, dict[str, tuple[float, float]]] = {
    "L": {"FL": (0.07025, 0.0299), "FR": (0.07025, -0.0231), "RL": (-0.03025, 0.0299), "RR": (-0.02965, -0.0191)},
    "R": {"FL": (0.07025, 0.0231), "FR": (0.07025, -0.0299), "RL": (-0.03025, 0.0191), "RR": (-0.02965, -0.0299)},
}


def _foot_frames(side: str, version: Version) -> list[tuple[Joint, Link]]:
    """The sole of the URDF, the effector LLeg or RLeg (Docs) and the pressure sensors."""
    ankle = f"{side.lower()}_ankle"
    frames = [
        frame(f"{side.lower()}_sole", ankle, (0.0, 0.0, -SOLE_HEIGHT)),
        frame(f"{side}Leg", ankle, (0.0, 0.0, -version.foot_height)),
    ]
    for corner, (x, y) in _PRESSURE[side].items():
        frames.append(frame(f"{side}Fsr{corner}_frame", ankle, (x, y, -SOLE_HEIGHT)))
    return frames


def _torso_frames() -> list[tuple[Joint, Link]]:
    """URDF V50: inertial unit and sonars."""
    sonar = (-0.00478508, 0.0436497, 0.392441)
    return [
        frame("ImuTorsoAccelerometer_frame", "torso", (-0.008, 0.00606, 0.027)),
        frame("ImuTorsoGyrometer_frame", "torso", (-0.008, 0.006, 0.029)),
        frame("LSonar_frame", "torso", (0.00558253, 0.0192068, 0.0623853), sonar),
        frame("RSonar_frame", "torso", (0.00558253, -0.0192068, 0.0623853), (-sonar[0], sonar[1], -sonar[2])),
    ]
