"""Practicum sheet on numeric inverse kinematics of a 6-axis arm (Kinova JACO2 j2n6s300): chain and check pose.

The sheet says that the DH parameters are on another sheet; those here are the manufacturer's constants of the arm.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import pinocchio as pin

from nao_kin.dh.dh_chain import DHChain, DHRow

__all__ = ["CHECK_Q_DEG", "CHECK_T_BASE_HAND", "jaco2"]

CHECK_Q_DEG: Final = (180.0, 270.0, 90.0, 180.0, 180.0, 0.0)
"""Task 1b: the joint angles of the check [deg]."""

CHECK_T_BASE_HAND: Final = (
    (0.0, 1.0, 0.0, 0.41),
    (-0.5, 0.0, 0.866, 0.2595),
    (0.866, 0.0, 0.5, 0.084),
    (0.0, 0.0, 0.0, 1.0),
)
"""Task 1b: the printed transform of the hand in the base [m], to the digits printed."""

# Kinova's own names: link lengths D1…D6, elbow offset e2 [m], half of the oblique wrist's bend aa.
_D1, _D2, _D3, _D4, _D5, _D6, _E2 = 0.2755, 0.4100, 0.2073, 0.0741, 0.0741, 0.1600, 0.0098
_AA = math.pi / 6
_BENT = math.sin(_AA) / math.sin(2.0 * _AA)
_QUARTER = math.pi / 2


def jaco2() -> DHChain:
    """The arm's DH table, standard convention, from the arm's own joint angles."""
    return DHChain(
        rows=(
            DHRow(0.0, _QUARTER, _D1, 0.0, sign=-1, name="joint_1"),
            DHRow(_D2, math.pi, 0.0, -_QUARTER, name="joint_2"),
            DHRow(0.0, _QUARTER, -_E2, _QUARTER, name="joint_3"),
            DHRow(0.0, 2.0 * _AA, -(_D3 + _D4 * _BENT), 0.0, name="joint_4"),
            DHRow(0.0, 2.0 * _AA, -(_D4 + _D5) * _BENT, -math.pi, name="joint_5"),
            DHRow(0.0, math.pi, -(_D6 + _D5 * _BENT), _QUARTER, name="joint_6"),
        ),
        convention="standard",
        base=pin.SE3(np.eye(4)),
        tool=pin.SE3(np.eye(4)),
        name="practicum_jaco2",
        base_name="link_base",
        tip_name="end_effector",
    )
