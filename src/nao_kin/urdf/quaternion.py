"""Rotations that a file gives as a quaternion, in the form that every other origin has.

Plain floats: nothing here may need Pinocchio, because `nao-kin check` starts without it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nao_kin.urdf.elements import Triple

__all__ = ["SHORTEST_QUATERNION", "rpy_of_quaternion"]

SHORTEST_QUATERNION = 1e-12
"""A quaternion shorter than this says nothing about a rotation."""


def rpy_of_quaternion(x: float, y: float, z: float, w: float) -> Triple:
    """Roll, pitch and yaw [rad] about fixed axes, R = Rz(yaw) Ry(pitch) Rx(roll), of a quaternion of any length.

    The roll is worked out from what yaw has left over, so that the three give the same rotation to rounding where the
    pitch is ±π/2 too and only the difference of roll and yaw is determined. The steps are those of G. Slabaugh,
    "Computing Euler angles from a rotation matrix" (1999), with that order for the degenerate case.
    """
    length = math.hypot(x, y, z, w)
    x, y, z, w = x / length, y / length, z / length, w / length
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    r00, r10, r20 = ww + xx - yy - zz, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)
    r01, r11 = 2.0 * (x * y - w * z), ww - xx + yy - zz
    r02, r12 = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x)
    yaw = math.atan2(r10, r00)
    pitch = math.atan2(-r20, math.hypot(r00, r10))
    sin, cos = math.sin(yaw), math.cos(yaw)
    roll = math.atan2(sin * r02 - cos * r12, cos * r11 - sin * r01)
    return roll, pitch, yaw
