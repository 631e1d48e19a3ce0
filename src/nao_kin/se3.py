"""Distances between poses, roll-pitch-yaw, and the way in for poses, all on `pin.SE3`.

`T_a_b` is the pose of frame b in frame a; composing reads left to right and the inner names cancel:
`T_a_c = T_a_b * T_b_c`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, matrix, vector
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "ROTATION_TOLERANCE",
    "PoseLike",
    "as_pose",
    "from_xyz_rpy",
    "nearest_rotation",
    "position_distance",
    "rotation_angle",
    "rotation_distance",
    "rotation_violation",
    "rotation_x",
    "rotation_y",
    "rotation_z",
    "rpy",
    "translation",
]

PoseLike: TypeAlias = "pin.SE3 | ArrayLike"

ROTATION_TOLERANCE = 1e-8
"""Largest entry of R^T R − 1 at which a matrix still counts as a rotation: far below what any joint resolves, far above
the rounding of a product of transforms in double precision."""


def as_pose(value: PoseLike, what: str = "pose") -> pin.SE3:
    """A pose from a `pin.SE3` or a homogeneous (4, 4) matrix, as a copy.

    Raises:
        InvalidInputError: Wrong shape, not finite, last row not (0, 0, 0, 1), or a rotation part that is not a
            rotation (the message gives the size of the violation).
    """
    homogeneous = matrix(value.homogeneous if isinstance(value, pin.SE3) else value, what, (4, 4))
    if np.abs(homogeneous[3] - (0.0, 0.0, 0.0, 1.0)).max() > ROTATION_TOLERANCE:
        raise InvalidInputError(f"{what}, last row", "(0, 0, 0, 1)", str(tuple(float(x) for x in homogeneous[3])))
    rotation = homogeneous[:3, :3]
    violation = rotation_violation(rotation)
    if violation > ROTATION_TOLERANCE:
        raise InvalidInputError(
            f"{what}, rotation part",
            f"a rotation matrix (R^T R = 1 to {ROTATION_TOLERANCE:g}, det +1)",
            f"a violation of {violation:.2g}; nao_kin.se3.nearest_rotation(R) gives the closest rotation",
        )
    return pin.SE3(rotation.copy(), homogeneous[:3, 3].copy())


def rotation_violation(rotation: ArrayLike) -> float:
    """How far a (3, 3) matrix is from a rotation: the largest entry of |R^T R − 1|, or 2 for a reflection."""
    R = matrix(rotation, "rotation", (3, 3))
    if np.linalg.det(R) < 0.0:
        return 2.0
    return float(np.abs(R.T @ R - np.eye(3)).max())


def nearest_rotation(almost: ArrayLike) -> Floats:
    """The rotation matrix closest to a (3, 3) matrix in the Frobenius norm (orthogonal Procrustes problem).

    Raises:
        InvalidInputError: The matrix is singular or closer to a reflection, so no closest rotation is meant.
    """
    M = matrix(almost, "rotation", (3, 3))
    U, stretch, Vt = np.linalg.svd(M)
    if stretch[-1] <= 1e-6 * stretch[0] or np.linalg.det(M) < 0.0:
        raise InvalidInputError("rotation", "a matrix near a rotation", f"determinant {np.linalg.det(M):.3g}")
    return np.ascontiguousarray(U @ Vt)


def position_distance(T_a_b: pin.SE3, T_a_c: pin.SE3) -> float:
    """Distance of the two origins [m]."""
    return math.dist(T_a_b.translation, T_a_c.translation)


def rotation_distance(T_a_b: pin.SE3, T_a_c: pin.SE3) -> float:
    """Angle of the rotation between two poses [rad], in [0, π], accurate at both ends.

    The arc cosine of the trace loses half of the digits near 0 and π; the arc tangent of sine and cosine does not.
    """
    return rotation_angle(T_a_b.rotation.T @ T_a_c.rotation)


def rotation_angle(R: Floats) -> float:
    """Angle of a rotation matrix (3, 3) [rad], in [0, π]."""
    doubled_sine = math.hypot(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    return math.atan2(doubled_sine, R[0, 0] + R[1, 1] + R[2, 2] - 1.0)


def rpy(T_a_b: pin.SE3) -> Floats:
    """Roll, pitch, yaw [rad] with R = Rz(yaw) Ry(pitch) Rx(roll), URDF's convention; pitch in [−π/2, π/2]."""
    return np.asarray(pin.rpy.matrixToRpy(T_a_b.rotation), dtype=np.float64)


def from_xyz_rpy(xyz: ArrayLike = (0, 0, 0), rpy: ArrayLike = (0, 0, 0)) -> pin.SE3:
    """A pose from a position [m] and roll, pitch, yaw [rad], R = Rz(yaw) Ry(pitch) Rx(roll).

    Raises:
        InvalidInputError: Not three finite numbers each.
    """
    roll, pitch, yaw = vector(rpy, "rpy", 3)
    rotation = rotation_z(yaw) * rotation_y(pitch) * rotation_x(roll)
    return pin.SE3(rotation.rotation, vector(xyz, "xyz", 3))


def translation(x: float, y: float, z: float) -> pin.SE3:
    """A pure translation [m]."""
    return pin.SE3(np.eye(3), np.array([x, y, z], dtype=np.float64))


def rotation_x(angle: float) -> pin.SE3:
    """A rotation about x [rad]."""
    c, s = _cos_sin(angle)
    return pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]), np.zeros(3))


def rotation_y(angle: float) -> pin.SE3:
    """A rotation about y [rad]."""
    c, s = _cos_sin(angle)
    return pin.SE3(np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]), np.zeros(3))


def rotation_z(angle: float) -> pin.SE3:
    """A rotation about z [rad]."""
    c, s = _cos_sin(angle)
    return pin.SE3(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))


def _cos_sin(angle: float) -> tuple[float, float]:
    return math.cos(angle), math.sin(angle)
