"""MATLAB example: the matrices and helper functions of its kinematic chains, as printed.

Lengths in any one unit; the example uses millimetres. Matrices are homogeneous (4, 4).
"""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "a_2_head",
    "a_base_0",
    "example_parameters",
    "example_parameters_of_v33",
    "get_a",
    "get_r",
    "get_t",
    "head_chain",
    "left_hand_chain",
    "left_hand_chain_corrected",
    "r_x",
    "r_y",
    "t_01",
    "t_12",
]


def a_base_0(NeckOffsetZ: float) -> Floats:
    """ABase0."""
    return np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, NeckOffsetZ], [0, 0, 0, 1]])


def t_01(theta_1: float) -> Floats:
    """T01."""
    return np.array(
        [[cos(theta_1), -sin(theta_1), 0, 0], [sin(theta_1), cos(theta_1), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    )


def t_12(theta_2: float) -> Floats:
    """T12."""
    return np.array(
        [
            [cos(theta_2 - pi / 2), -sin(theta_2 - pi / 2), 0, 0],
            [0, 0, 1, 0],
            [-sin(theta_2 - pi / 2), -cos(theta_2 - pi / 2), 0, 0],
            [0, 0, 0, 1],
        ]
    )


def r_x() -> Floats:
    """Rx."""
    return np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def r_y() -> Floats:
    """Ry."""
    return np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


def a_2_head(CameraX: float, CameraZ: float) -> Floats:
    """A2Head."""
    return np.array([[1, 0, 0, CameraX], [0, 1, 0, 0], [0, 0, 1, CameraZ], [0, 0, 0, 1]])


def get_a(vec: tuple[float, float, float]) -> Floats:
    """Helper getA."""
    return np.array([[1, 0, 0, vec[0]], [0, 1, 0, vec[1]], [0, 0, 1, vec[2]], [0, 0, 0, 1]])


def get_r(orientation: str, theta: float) -> Floats:
    """Helper getR."""
    c, s = cos(theta), sin(theta)
    return {
        "x": np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]]),
        "y": np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]]),
        "z": np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
    }[orientation]


def get_t(a: float, alpha: float, d: float, theta: float) -> Floats:
    """Helper getT."""
    return np.array(
        [
            [cos(theta), -sin(theta), 0, a],
            [sin(theta) * cos(alpha), cos(theta) * cos(alpha), -sin(alpha), -sin(alpha) * d],
            [sin(theta) * sin(alpha), cos(theta) * sin(alpha), cos(alpha), cos(alpha) * d],
            [0, 0, 0, 1],
        ]
    )


def head_chain(theta_1: float, theta_2: float, CameraX: float, CameraZ: float, NeckOffsetZ: float) -> Floats:
    """T = ABase0*T01*T12*Rx*Ry*A2Head."""
    return a_base_0(NeckOffsetZ) @ t_01(theta_1) @ t_12(theta_2) @ r_x() @ r_y() @ a_2_head(CameraX, CameraZ)


def left_hand_chain(theta: Floats, lengths: dict[str, float]) -> Floats:
    """ABase0*T01*T12*T32*T43*Rz*AEnd4 of getKinematicChain('lefthand'); lengths by the manufacturer's names."""
    a_base = get_a((0, lengths["ShoulderOffsetY"] + lengths["ElbowOffsetY"], lengths["ShoulderOffsetZ"]))
    a_end = get_a((lengths["HandOffsetX"] + lengths["LowerArmLength"], 0, 0))
    t01 = get_t(0, -pi / 2, 0, theta[0])
    t12 = get_t(0, pi / 2, 0, theta[1] - pi / 2)
    t32 = get_t(0, -pi / 2, lengths["UpperArmLength"], theta[2])
    t43 = get_t(0, pi / 2, 0, theta[3])
    return a_base @ t01 @ t12 @ t32 @ t43 @ get_r("z", pi / 2) @ a_end


def left_hand_chain_corrected(theta: Floats, lengths: dict[str, float]) -> Floats:
    """The same with ElbowOffsetY where the elbow is, and with HandOffsetZ."""
    a_base = get_a((0, lengths["ShoulderOffsetY"], lengths["ShoulderOffsetZ"]))
    a_end = get_a((lengths["HandOffsetX"] + lengths["LowerArmLength"], 0, -lengths["HandOffsetZ"]))
    t01 = get_t(0, -pi / 2, 0, theta[0])
    t12 = get_t(0, pi / 2, 0, theta[1] - pi / 2)
    t32 = get_t(-lengths["ElbowOffsetY"], -pi / 2, lengths["UpperArmLength"], theta[2])
    t43 = get_t(0, pi / 2, 0, theta[3])
    return a_base @ t01 @ t12 @ t32 @ t43 @ get_r("z", pi / 2) @ a_end


def example_parameters() -> tuple[float, float, float]:
    """CameraX, CameraZ and NeckOffsetZ of the verification run [mm]."""
    return 53.9, 67.9, -5.0


def example_parameters_of_v33() -> tuple[float, float, float]:
    """The same of a NAO V3.3 (NAOqi documentation) [mm]."""
    return 53.9, 67.9, 126.5
