"""The hexapod article's construction of a walker's joint angles from planes, set right.

It is another way to what `nao_kin.analytic.hexapod.body.body_ik` computes, with vectors in the ground's frame instead
of angles in the legs' frames, and so a check on it. It differs from the article (steps 1 to 5) in four places:

* the rotation is Rz(γ) Rx(α) Ry(β), the product that the article's text names; three entries of its matrix are not;
* an arc cosine cannot tell left from right, so the hip's angle is that of directed planes, counted about the body's
  normal; likewise the angle by which the foot is below the hip;
* g runs from the thigh servo and h to it, so that thigh, shin and g are the sides of one triangle;
* the arc cosines of that triangle are taken by half angles, which exist exactly where it does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.arrays import rows, vector
from nao_kin.se3 import PoseLike, as_pose, rotation_x, rotation_y, rotation_z

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["Walker", "body_pose", "plane_construction"]

_DELTA = 0.1  # [m] height of the virtual plane above the plane of the hip servos; any will do


@dataclass(frozen=True, eq=False, slots=True)
class Walker:
    """Dimensions of a machine with legs of three servos.

    Attributes:
        hips: The hip servos in the body's frame (L, 3) [m]; their axes are along the body's z.
        hip: From hip servo to thigh servo [m].
        thigh: From thigh servo to knee [m].
        shin: From knee to foot [m].
        front: Number of a hip servo.
        rear: Number of the one directly behind it; the line from it to `front` is where hip angles are counted from.
    """

    hips: Floats
    hip: float
    thigh: float
    shin: float
    front: int
    rear: int


def body_pose(translation: ArrayLike, alpha: float, beta: float, gamma: float) -> pin.SE3:
    """T_ground_body: turned about Y by beta, then X by alpha, then Z by gamma [rad], then moved [m].

    Source: hexapod article, step 2, in the order that its text gives.

    Raises:
        InvalidInputError: Not three finite numbers.
    """
    rotation = rotation_z(gamma) * rotation_x(alpha) * rotation_y(beta)
    return pin.SE3(rotation.rotation, vector(translation, "translation", 3))


def plane_construction(walker: Walker, T_ground_body: PoseLike, feet: ArrayLike) -> Floats:
    """Angles of all legs, knees up, that hold the feet while the body takes a pose.

    Args:
        walker: The machine.
        T_ground_body: The pose of the body in the ground's frame.
        feet: Where the feet stand (L, 3) [m], in the ground's frame.

    Returns:
        One row a leg (L, 3) [rad]: the hip's turn from the forward direction about the body's z, the thigh's rise above
        the body's plane, and the angle between thigh and shin. NaN in a row whose foot is out of reach; `body_ik` says
        by how much.

    Raises:
        InvalidInputError: Not a pose, or not L finite points.
    """
    T = as_pose(T_ground_body, "T_ground_body")
    feet = rows(feet, "feet", 3)
    # Steps 1 and 2: the hip servos and their virtual twins, where the body's pose takes them.
    hip_servo = _placed(T, walker.hips)
    normal = _unit(_placed(T, walker.hips + np.array([0.0, 0.0, _DELTA])) - hip_servo)
    forward = hip_servo[walker.front] - hip_servo[walker.rear]
    # Step 3: from the plane along the body to the plane through hip axis and foot, both directed away from the axis.
    leg_plane, reference_plane = np.cross(normal, feet - hip_servo), np.cross(normal, forward)
    hip_angle = np.arctan2(_dot(np.cross(reference_plane, leg_plane), normal), _dot(reference_plane, leg_plane))
    # Step 4: the thigh servos, found in the body and taken along.
    along = _unit(walker.hips[walker.front] - walker.hips[walker.rear])
    aside = np.cross((0.0, 0.0, 1.0), along)
    reached = np.cos(hip_angle)[:, None] * along + np.sin(hip_angle)[:, None] * aside
    thigh_servo = _placed(T, walker.hips + walker.hip * reached)
    # Step 5: the triangle of thigh, shin and the line g from the thigh servo to the foot, in the leg's plane.
    h, g = thigh_servo - hip_servo, feet - thigh_servo
    length = np.linalg.norm(g, axis=1)
    a1 = _opposite(length, walker.thigh, walker.shin)
    a2 = _opposite(walker.shin, walker.thigh, length)
    a4 = np.arctan2(-_dot(g, normal), _dot(g, _unit(h)))  # how far g is below h
    angles = np.column_stack([hip_angle, a2 - a4, a1])
    angles[np.isnan(a1)] = np.nan
    return angles


def _opposite(side: Floats | float, left: Floats | float, right: Floats | float) -> Floats:
    """The angle of a triangle opposite a side [rad]; NaN where there is no such triangle.

    The law of cosines by half angles: tan²(angle / 2) = (side² − (left − right)²) / ((left + right)² − side²).
    """
    opened = (side - left + right) * (side + left - right)
    closed = (left + right - side) * (left + right + side)
    triangle = np.asarray((opened >= 0.0) & (closed >= 0.0))
    half = np.arctan2(np.sqrt(np.where(triangle, opened, 0.0)), np.sqrt(np.where(triangle, closed, 0.0)))
    return np.where(triangle, 2.0 * half, np.nan)


def _placed(T_ground_body: pin.SE3, points: Floats) -> Floats:
    placed: Floats = points @ T_ground_body.rotation.T + T_ground_body.translation
    return placed


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=-1))


def _unit(vectors: Floats) -> Floats:
    unit: Floats = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
