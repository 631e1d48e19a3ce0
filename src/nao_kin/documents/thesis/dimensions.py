"""Bischoff 2016, sections 2.1 and 3.1: joint counts, names of axes and the two tables of dimensions, as printed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.thesis.thesis_arms import nao
from nao_kin.robot.robot import load

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Form

__all__ = ["CLAIMS"]

_LAST_DIGIT: Final = 0.005
"""Half of the last digit that the tables print [mm]."""

Row = tuple[str, str, float, float, float]


def joint_count() -> tuple[int, int]:
    """Section 2.1: joints, and how many of them are in the upper body."""
    return 21, 12


def joint_count_corrected() -> tuple[int, int]:
    """Two in the head and four in each arm."""
    return 21, 10


def table_1() -> tuple[Row, ...]:
    """Table 1: from joint, to joint, x, y, z [mm]; "" is the torso."""
    return (
        ("", "LShoulderPitch", 0.00, 98.00, 100.00),
        ("LShoulderPitch", "LShoulderRoll", 0.00, 0.00, 0.00),
        ("LShoulderRoll", "LElbowYaw", 105.00, 15.00, 0.00),
        ("LElbowYaw", "LElbowRoll", 0.00, 0.00, 0.00),
        ("LElbowRoll", "LWristYaw", 55.95, 0.00, 0.00),
    )


def table_2() -> dict[str, float]:
    """Table 2: named dimensions [mm]."""
    return {
        "ShoulderOffsetY": 98.00,
        "ElbowOffsetY": 15.00,
        "UpperArmLength": 105.00,
        "LowerArmLength": 55.98,
        "ShoulderOffsetZ": 100.00,
        "HandOffsetX": 57.75,
        "HandOffsetZ": 12.31,
    }


def table_2_corrected() -> dict[str, float]:
    """The same with the forearm of Table 1."""
    return table_2() | {"LowerArmLength": 55.95}


def joint_axes() -> dict[str, tuple[int, int, int]]:
    """Section 3.1: shoulder and elbow have a roll and a yaw axis each; roll, pitch, yaw turn about x, y, z."""
    roll, yaw = (1, 0, 0), (0, 0, 1)
    return {"ShoulderRoll": roll, "ShoulderYaw": yaw, "ElbowRoll": roll, "ElbowYaw": yaw}


def joint_axes_corrected() -> dict[str, tuple[int, int, int]]:
    """What the joints of these names do at the zero posture, arms forward."""
    return {"ShoulderPitch": (0, 1, 0), "ShoulderRoll": (0, 0, 1), "ElbowYaw": (1, 0, 0), "ElbowRoll": (0, 0, 1)}


def _counts(form: Form) -> Measured:
    """Motors of the robot: a joint that follows another one has none."""
    robot = nao()
    followers = {coupling.follower for coupling in robot.couplings}
    motors = [name for name in robot.joint_names if name not in followers]
    upper = [name for name in motors if any(part in name for part in ("Head", "Shoulder", "Elbow"))]
    h25 = [name for name in load("nao_v50_h25").joint_names if any(p in name for p in ("Head", "Shoulder", "Elbow"))]
    found = (
        f"{len(motors)} motors, {len(upper)} of them in the upper body; with LWristYaw and RWristYaw, which these "
        f"robots have fixed, {len(h25) + 2} of {len(motors) + 2}. The legs have {len(motors) - len(upper)} motors."
    )
    all_said, upper_said = form()
    return Measured.worst([all_said - len(motors), upper_said - len(upper)], lambda k: ("all", "upper body")[k], found)


def _placements(form: Form) -> Measured:
    model, rows, errors = load("nao_v50_h25").model, form(), list[float]()
    for before, joint, *xyz in rows:
        number = model.getJointId(joint)
        parent = model.parents[number]
        if parent != (model.getJointId(before) if before else 0):
            return Measured(np.inf, len(rows), f"{joint} does not hang from {before}")
        errors.append(float(np.abs(1000.0 * model.jointPlacements[number].translation - xyz).max()))
    return Measured.worst(errors, lambda k: f"{rows[k][0] or 'Torso'} to {rows[k][1]}")


def _dimensions_mm() -> dict[str, float]:
    """The named dimensions out of the model with wrists [mm]."""
    robot = load("nao_v50_h25")
    to = {name: 1000.0 * robot.model.jointPlacements[robot.model.getJointId(name)].translation for name in _JOINTS}
    wrist = robot.pose({}, "l_wrist", "torso")
    hand: Floats = 1000.0 * wrist.actInv(robot.pose({}, "LArm", "torso")).translation
    return {
        "ShoulderOffsetY": to["LShoulderPitch"][1],
        "ElbowOffsetY": to["LElbowYaw"][1],
        "UpperArmLength": to["LElbowYaw"][0],
        "LowerArmLength": to["LWristYaw"][0],
        "ShoulderOffsetZ": to["LShoulderPitch"][2],
        "HandOffsetX": hand[0],
        "HandOffsetZ": -hand[2],
    }


_JOINTS: Final = ("LShoulderPitch", "LElbowYaw", "LWristYaw")


def _dimensions(form: Form) -> Measured:
    said, wanted = form(), _dimensions_mm()
    names = list(wanted)
    return Measured.worst(
        (said[name] - wanted[name] for name in names), lambda k: f"{names[k]}, in the model {wanted[names[k]]:.2f} mm"
    )


def _axes(form: Form) -> Measured:
    """Angle between the axis a name stands for and the axis of the joint of that name, on both arms."""
    axes: Mapping[str, tuple[int, int, int]] = form()
    cases = [(side + name, axis) for name, axis in axes.items() for side in "LR"]
    model, errors = nao().model, list[float]()
    for name, axis in cases:
        if not model.existJointName(name):
            errors.append(np.pi)  # no axis is farther from any other
            continue
        real = _axis_of(name)
        errors.append(float(np.arctan2(np.linalg.norm(np.cross(real, axis)), np.dot(real, axis))))
    return Measured.worst(errors, lambda k: _misnamed(cases[k][0]), "At the zero posture: " + _axes_found())


def _axis_of(name: str) -> Floats:
    """Unit axis of a joint in the torso frame at the zero posture."""
    chain = nao().chain("left_arm" if name.startswith("L") else "right_arm")
    J = chain.jacobian(np.zeros(len(chain.joints)))
    axis: Floats = np.rint(J[3:, chain.joint_names.index(name)])
    return axis


def _misnamed(name: str) -> str:
    return name if nao().model.existJointName(name) else f"{name}, which does not exist"


def _axes_found() -> str:
    names = ("LShoulderPitch", "LShoulderRoll", "LElbowYaw", "LElbowRoll")
    return ", ".join(f"{name[1:]} {'xyz'[int(np.abs(_axis_of(name)).argmax())]}" for name in names) + "."


CLAIMS: Final = (
    Claim(
        id="000:2.1-joint-count",
        place="section 2.1",
        said="The NAO has 21 joints, 12 of them in the upper body.",
        formula="21 joints, 12 of them in the upper body",
        printed=joint_count,
        check=_counts,
        reference="motors of the V5 model with fixed wrists and hands (H21)",
        domain="the robot that the thesis is about",
        unit="joints",
        tolerance=0.0,
        correction=Correction(
            joint_count_corrected,
            "21 joints, 10 of them in the upper body",
            why="Head 2, arms 4 each; 12 would count the wrists, which the 21 leave out.",
        ),
    ),
    Claim(
        id="000:table-1",
        place="Table 1",
        said="Dimensions of the left side of the upper body, joint to joint.",
        formula="Torso → ShoulderPitch (0, 98, 100), ShoulderRoll (0, 0, 0),\n"
        "ElbowYaw (105, 15, 0), ElbowRoll (0, 0, 0), WristYaw (55.95, 0, 0) mm",
        printed=table_1,
        check=_placements,
        reference="joint placements of the V5 model (Pinocchio)",
        domain="five rows; both sides, the right one mirrored",
        unit="mm",
        tolerance=_LAST_DIGIT,
    ),
    Claim(
        id="000:table-2",
        place="Table 2",
        said="Named dimensions of the arms.",
        formula="ShoulderOffsetY 98.00, ElbowOffsetY 15.00, UpperArmLength 105.00, "
        "LowerArmLength 55.98,\nShoulderOffsetZ 100.00, HandOffsetX 57.75, HandOffsetZ 12.31 mm",
        printed=table_2,
        check=_dimensions,
        reference="joint placements of the V5 model (Pinocchio)",
        domain="seven lengths",
        unit="mm",
        tolerance=_LAST_DIGIT,
        correction=Correction(
            table_2_corrected, "LowerArmLength 55.95 mm", why="Table 1 prints the same length as 55.95 mm."
        ),
    ),
    Claim(
        id="000:3.1-joint-names",
        place="text of section 3.1",
        said="Shoulder and elbow have the axes roll and yaw each; roll, pitch and yaw turn about x, y and z.",
        formula="Shoulder: roll, yaw; elbow: roll, yaw; roll = x, pitch = y, yaw = z",
        printed=joint_axes,
        check=_axes,
        reference="axes of the joints of these names in the V5 model, torso frame, zero posture",
        domain="four joints of each arm",
        unit="rad",
        correction=Correction(
            joint_axes_corrected,
            "Shoulder: pitch (y), roll (z); elbow: yaw (x), roll (z)",
            why="The shoulder has pitch and roll, as Table 1 says; in the arms roll is about z and yaw about x.",
        ),
    ),
)
