"""Hexapod article (M. Fauth, "Inverse Kinematik", 2010): body inverse kinematics, steps 1 to 5, as printed.

Angles α about X, β about Y, γ about Z; lengths in mm. The article's figures are not at hand, so what only they show is
named where it matters: which vector h is, and from where the hip's angle is counted.
"""

from __future__ import annotations

from math import cos, sin
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import arccos, arctan2, cross, dot
from numpy.linalg import norm

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats

    Matrix = Callable[[float, float, float], Floats]

__all__ = [
    "a1",
    "a2",
    "a3",
    "a4",
    "a4_corrected",
    "hip_angle",
    "hip_angle_corrected",
    "joint_angles",
    "joint_angles_corrected",
    "joint_count",
    "rotation_matrix",
    "rotation_matrix_corrected",
    "stated_order",
    "thigh_point",
    "virtual_plane",
    "whole_procedure",
    "whole_procedure_corrected",
]


def rotation_matrix(a: float, b: float, g: float) -> Floats:
    """Step 2: the matrix, term for term."""
    return np.array(
        [
            [
                cos(g) * cos(b) + (-sin(g)) * (-sin(a)) * (-sin(b)),
                (-sin(g)) * cos(a),
                cos(g) * sin(b) + (-sin(a)) * sin(b),
            ],
            [
                sin(g) * cos(b) + cos(g) * (-sin(a)) * (-sin(b)),
                cos(g) * cos(a),
                sin(g) * sin(b) + cos(a) * sin(b),
            ],
            [cos(a) * (-sin(b)), sin(a), cos(b)],
        ]
    )


def rotation_matrix_corrected(a: float, b: float, g: float) -> Floats:
    """Rz(γ) Rx(α) Ry(β): the first two columns as printed, and the third."""
    third = [
        cos(g) * sin(b) + sin(g) * sin(a) * cos(b),
        sin(g) * sin(b) - cos(g) * sin(a) * cos(b),
        cos(a) * cos(b),
    ]
    return np.column_stack([rotation_matrix(a, b, g)[:, :2], third])


def stated_order(about_x: Floats, about_y: Floats, about_z: Floats) -> Floats:
    """Step 2, text: turned about Y, then X, and finally Z, as a product of the three matrices."""
    return about_z @ about_x @ about_y


def virtual_plane(points: Floats, delta: float) -> Floats:
    """Step 3: the plane of hip servos shifted in Z, before it is turned."""
    shifted: Floats = points + np.array([0.0, 0.0, 1.0]) * delta
    return shifted


def hip_angle(hip: Floats, virtual_hip: Floats, foot: Floats, along: Floats) -> Any:
    """Step 3: angle of the normals of plane 1 (hip, virtual hip, foot) and plane 2 (along the body, up)."""
    up = virtual_hip - hip
    a, b = cross(up, foot - hip), cross(along, up)
    return arccos(dot(a, b) / (norm(a) * norm(b)))


def hip_angle_corrected(hip: Floats, virtual_hip: Floats, foot: Floats, along: Floats) -> Any:
    """Of directed planes, counted about the body's normal, so that left and right differ."""
    up = virtual_hip - hip
    a, b = cross(up, foot - hip), cross(up, along)
    return arctan2(cross(b, a) @ up / norm(up), a @ b)


def thigh_point(hip: Floats, psi: float, length: float) -> Floats:
    """Step 4: the thigh servo in the unturned body, seen from above; ψ from the X axis."""
    thigh: Floats = hip + np.array([length * cos(psi), length * sin(psi), 0.0])
    return thigh


def a1(thigh: float, shin: float, g: float) -> Any:
    """Step 5."""
    return arccos((thigh**2 + shin**2 - g**2) / (2 * thigh * shin))


def a2(thigh: float, shin: float, g: float) -> Any:
    """Step 5."""
    return arccos((thigh**2 + g**2 - shin**2) / (2 * thigh * g))


def a4(h: Floats, g: Floats) -> Any:
    """Step 5."""
    return arccos(dot(h, g) / (norm(h) * norm(g)))


def a4_corrected(h: Floats, g: Floats, up: Floats) -> Any:
    """Directed: how far g is below h, negative where it is above; h from hip servo to thigh servo."""
    return arctan2(-(g @ up) / norm(up), g @ h / norm(h))


def a3(angle_2: float, angle_4: float) -> float:
    """Step 5."""
    return angle_2 - angle_4


def joint_angles(angle_1: float, angle_2: float, angle_3: float, angle_4: float) -> tuple[float, ...]:
    """The struck sentence: a1, a2, a3, a4 are the angles of the joints."""
    return angle_1, angle_2, angle_3, angle_4


def joint_angles_corrected(angle_1: float, _angle_2: float, angle_3: float, _angle_4: float) -> tuple[float, ...]:
    """The knee's and the thigh's; a2 and a4 only help to find a3."""
    return angle_1, angle_3


def joint_count() -> int:
    """The introduction: joints of the robot."""
    return 18


def whole_procedure(
    hips: Floats, lengths: tuple[float, float, float], turn: Floats, moved: Floats, feet: Floats
) -> Floats:
    """Steps 1 to 5 with the printed matrix; what is left open is chosen so that the rest comes out right.

    Args:
        hips: Hip servos in the body (6, 3): left front, middle, rear, then right.
        lengths: Of hip, thigh and shin.
        turn: α, β, γ.
        moved: Translation (3,).
        feet: Feet on the ground (6, 3).

    Returns:
        ψ, a3 and a1 of each leg (6, 3) [rad]; ψ counted from the forward direction, positive on the left.
    """
    M = rotation_matrix(*turn)
    return _legs(M, hips, lengths, moved, feet)


def whole_procedure_corrected(
    hips: Floats, lengths: tuple[float, float, float], turn: Floats, moved: Floats, feet: Floats
) -> Floats:
    """The same with the matrix of the stated order."""
    return _legs(rotation_matrix_corrected(*turn), hips, lengths, moved, feet)


def _legs(M: Floats, hips: Floats, lengths: tuple[float, float, float], moved: Floats, feet: Floats) -> Floats:
    hip, thigh, shin = lengths
    real, virtual = (points @ M.T + moved for points in (hips, virtual_plane(hips, 50.0)))
    rows = []
    for k, foot in enumerate(feet):
        side = 1.0 if hips[k, 1] > 0.0 else -1.0
        psi = side * hip_angle(real[k], virtual[k], foot, real[2] - real[0])
        thigh_servo = M @ thigh_point(hips[k], psi, hip) + moved
        g, h = foot - thigh_servo, thigh_servo - real[k]
        distance = float(norm(g))
        rows.append((psi, a3(a2(thigh, shin, distance), a4(h, g)), a1(thigh, shin, distance)))
    return np.array(rows)
