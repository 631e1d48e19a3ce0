"""MATLAB example: its lengths and its chain of the left hand, held against Pinocchio's model of the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.chain import random_configurations
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.kofinas import V33_LENGTHS
from nao_kin.documents.matlab import chain_matrices as printed
from nao_kin.documents.samples import deviation
from nao_kin.robot.robot import load

if TYPE_CHECKING:
    from nao_kin.documents.claim import Form

__all__ = ["CLAIMS"]

_COUNT, _SEED = 100, 8
_ROBOT: Final = "nao_v33_h25"
_LENGTHS: Final = {
    "ShoulderOffsetY": V33_LENGTHS.shoulder_offset_y,
    "ElbowOffsetY": V33_LENGTHS.elbow_offset_y,
    "ShoulderOffsetZ": V33_LENGTHS.shoulder_offset_z,
    "UpperArmLength": V33_LENGTHS.upper_arm_length,
    "LowerArmLength": V33_LENGTHS.lower_arm_length,
    "HandOffsetX": V33_LENGTHS.hand_offset_x,
    "HandOffsetZ": V33_LENGTHS.hand_offset_z,
}


def _left_hand(form: Form) -> Measured:
    """Position [m] of the hand; the orientation is measured beside."""
    chain = load("nao_v33_h21").chain("torso", "LArm")
    Q = random_configurations(chain, _COUNT, np.random.default_rng(_SEED))
    wanted = [chain.pose(q) for q in Q]
    got = [np.asarray(form(q, _LENGTHS)) for q in Q]
    apart = [float(np.linalg.norm(T[:3, 3] - W.translation)) for T, W in zip(got, wanted, strict=True)]
    turned = max(deviation(T[:3, :3], W.rotation) for T, W in zip(got, wanted, strict=True))
    off = [max(x, turned if turned > 1e-9 else 0.0) for x in apart]
    return Measured.worst(
        off,
        lambda i: "q = (" + ", ".join(f"{x:.3f}" for x in Q[i]) + ") rad",
        found=f"The hand is {1e3 * float(np.median(apart)):.2f} mm off in the median, {1e3 * max(apart):.2f} mm at "
        f"worst; its orientation is right to {turned:.1g}.",
    )


def _parameters(form: Form) -> Measured:
    """In millimetres."""
    robot = load(_ROBOT)
    camera = robot.pose({}, "CameraTop_frame", base="Head").translation
    wanted = 1e3 * np.array([camera[0], camera[2], robot.pose({}, "Head").translation[2]])
    stated = form()
    names = ("CameraX", "CameraZ", "NeckOffsetZ")
    return Measured.worst(
        np.array(stated) - wanted,
        lambda i: names[i],
        found="; ".join(f"{n} {x:g} and {y:g} mm" for n, x, y in zip(names, stated, wanted, strict=True))
        + ", the example's and the robot's.",
    )


CLAIMS: Final = (
    Claim(
        id="004:example-parameters",
        said="Lengths of the verification run, which calls them values for illustration.",
        formula="CameraX = 53.9, CameraZ = 67.9, NeckOffsetZ = −5",
        latex=r"CameraX = 53.9,\; CameraZ = 67.9,\; NeckOffsetZ = -5",
        printed=printed.example_parameters,
        check=_parameters,
        reference="the NAO V3.3's model",
        domain="the three numbers; V4 and later have CameraX = 58.71, CameraZ = 63.64",
        unit="mm",
        tolerance=0.05,
        place="step 4",
        correction=Correction(
            printed.example_parameters_of_v33,
            "CameraX = 53.9, CameraZ = 67.9, NeckOffsetZ = 126.5",
            r"CameraX = 53.9,\; CameraZ = 67.9,\; NeckOffsetZ = 126.5",
            "The camera's are those of V3.3; no NAO has its neck 5 mm below the torso's centre.",
        ),
    ),
    Claim(
        id="004:lefthand-chain",
        said="From the torso to the left hand.",
        formula="T = ABase0*T01*T12*T32*T43*Rz*AEnd4,\n"
        "ABase0 = getA([0, ShoulderOffsetY + ElbowOffsetY, ShoulderOffsetZ]),\n"
        "AEnd4 = getA([HandOffsetX + LowerArmLength, 0, 0]),\nT32 = getT(0, −π/2, UpperArmLength, θ_3)",
        latex=r"T = A_{Base,0} \, T_{0,1} \, T_{1,2} \, T_{3,2} \, T_{4,3} \, R_z \, A_{End,4}",
        printed=printed.left_hand_chain,
        check=_left_hand,
        reference="Pinocchio on the NAO V3.3's model without wrists, torso to LArm",
        domain="100 configurations inside the limits; lengths of the robot",
        unit="m",
        place="helper functions, case 'lefthand'",
        correction=Correction(
            printed.left_hand_chain_corrected,
            "ABase0 = getA([0, ShoulderOffsetY, ShoulderOffsetZ]),\n"
            "AEnd4 = getA([HandOffsetX + LowerArmLength, 0, −HandOffsetZ]),\n"
            "T32 = getT(−ElbowOffsetY, −π/2, UpperArmLength, θ_3)",
            r"T_{3,2} = \mathrm{getT}(-ElbowOffsetY, -\tfrac{\pi}{2}, UpperArmLength, \theta_3)",
            "The elbow's offset turns with the shoulder, so it cannot be added at the base; and the hand's point is "
            "HandOffsetZ below its axis.",
        ),
    ),
)
