"""Forward kinematics and frame Jacobian of one configuration, for compiled loops: nothing is allocated.

A chain comes as one array, because each array that Python hands to compiled code costs a call as much as a joint's
arithmetic does. Row k (16,) of `joints` (m + 1, 16) is a joint of a `JointPath`: placement rotation row by row (9),
placement translation (3), whether it slides, column of q, multiplier, offset. The last row is the tool, which has a
placement only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["COLUMN", "MULTIPLIER", "OFFSET", "SLIDES", "Arm", "At", "jacobian", "packed_joints", "place"]

SLIDES, COLUMN, MULTIPLIER, OFFSET = 12, 13, 14, 15


class Arm(NamedTuple):
    """A chain inside compiled loops; from Python its arrays come one by one, because a tuple costs microseconds there.

    Attributes:
        joints: The joints and the tool (m + 1, 16), see the module.
        limits: Least and greatest joint values (2, n).
        coupled: Coupled limits (k, 7), see `nao_kin.kernels.joint_limits`.
    """

    joints: Floats
    limits: Floats
    coupled: Floats


class At(NamedTuple):
    """Where an arm is, inside compiled loops.

    Attributes:
        q: Joints (n,) [rad or m].
        axes: Each joint's unit axis and a point on it [m], in base axes (m, 6), as `place` writes them.
        tip: T_base_tip (12,), as `place` writes it.
    """

    q: Floats
    axes: Floats
    tip: Floats


def packed_joints(path: JointPath) -> Floats:
    """The joints and the tool of a path in one array (m + 1, 16)."""
    m = len(path.columns)
    joints = np.zeros((m + 1, 16))
    joints[:m, :9], joints[m, :9] = path.rotations.reshape(m, 9), path.tool_rotation.ravel()
    joints[:m, 9:12], joints[m, 9:12] = path.translations, path.tool_translation
    joints[:m, 12:] = np.column_stack([path.prismatic, path.columns, path.multipliers, path.offsets])
    return joints


@leaf_jit
def place(joints: Floats, q: Floats, axes: Floats, tip: Floats) -> None:
    """Forward kinematics: the joints' axes and the tip's pose at q.

    Args:
        joints: The chain (m + 1, 16).
        q: Joints (n,) [rad or m].
        axes: Written (m, 6): each joint's unit axis and a point on it [m], in base axes.
        tip: Written (12,): T_base_tip, rotation row by row, then translation [m].
    """
    m = joints.shape[0] - 1
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    px, py, pz = 0.0, 0.0, 0.0
    for k in range(m + 1):
        px += xx * joints[k, 9] + xy * joints[k, 10] + xz * joints[k, 11]
        py += yx * joints[k, 9] + yy * joints[k, 10] + yz * joints[k, 11]
        pz += zx * joints[k, 9] + zy * joints[k, 10] + zz * joints[k, 11]
        xx, xy, xz = _row(xx, xy, xz, joints, k)
        yx, yy, yz = _row(yx, yy, yz, joints, k)
        zx, zy, zz = _row(zx, zy, zz, joints, k)
        if k == m:
            break
        value = joints[k, MULTIPLIER] * q[int(joints[k, COLUMN])] + joints[k, OFFSET]
        if joints[k, SLIDES] != 0.0:
            px, py, pz = px + value * xz, py + value * yz, pz + value * zz
        else:
            s, c = sine_cosine(value)
            xx, xy = c * xx + s * xy, c * xy - s * xx
            yx, yy = c * yx + s * yy, c * yy - s * yx
            zx, zy = c * zx + s * zy, c * zy - s * zx
        axes[k, 0], axes[k, 1], axes[k, 2] = xz, yz, zz
        axes[k, 3], axes[k, 4], axes[k, 5] = px, py, pz
    tip[0], tip[1], tip[2], tip[3], tip[4], tip[5] = xx, xy, xz, yx, yy, yz
    tip[6], tip[7], tip[8], tip[9], tip[10], tip[11] = zx, zy, zz, px, py, pz


@leaf_jit
def _row(x: float, y: float, z: float, joints: Floats, k: int) -> tuple[float, float, float]:
    """One row of a rotation times a placement's rotation."""
    return (
        x * joints[k, 0] + y * joints[k, 3] + z * joints[k, 6],
        x * joints[k, 1] + y * joints[k, 4] + z * joints[k, 7],
        x * joints[k, 2] + y * joints[k, 5] + z * joints[k, 8],
    )


@leaf_jit
def jacobian(joints: Floats, axes: Floats, tip: Floats, J: Floats) -> None:
    """Frame Jacobian J (6, n), rows (linear; angular), at the tip point in base axes, from what `place` wrote.

    A joint that follows another one adds to its leader's column.
    """
    for i in range(6):
        for k in range(J.shape[1]):
            J[i, k] = 0.0
    for k in range(axes.shape[0]):
        column, factor = int(joints[k, COLUMN]), joints[k, MULTIPLIER]
        x, y, z = factor * axes[k, 0], factor * axes[k, 1], factor * axes[k, 2]
        if joints[k, SLIDES] != 0.0:
            J[0, column] += x
            J[1, column] += y
            J[2, column] += z
            continue
        rx, ry, rz = tip[9] - axes[k, 3], tip[10] - axes[k, 4], tip[11] - axes[k, 5]
        J[0, column] += y * rz - z * ry
        J[1, column] += z * rx - x * rz
        J[2, column] += x * ry - y * rx
        J[3, column] += x
        J[4, column] += y
        J[5, column] += z
