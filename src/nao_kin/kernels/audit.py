"""A second compiled forward kinematics, to measure what the first one's results are worth.

It is written apart from `nao_kin.kernels.forward` on purpose and shares no code with it: plain products of 4×4
homogeneous matrices, one configuration at a time, sine and cosine from the C library. A mistake has to be made twice,
in two different ways, to go unnoticed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.kernels.compiling import jit, parallel_jit, prange

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["tips"]


def tips(path: JointPath, Q: Floats) -> Floats:
    """T_base_tip of many configurations, as the product of the path's matrices, on all cores.

    Args:
        path: The chain.
        Q: Configurations (N, n) [rad, m], C-contiguous and finite; see `nao_kin.arrays.rows`.

    Returns:
        Homogeneous matrices (N, 4, 4).
    """
    measured = np.empty((len(Q), 4, 4))
    _measure(path, Q, measured)
    return measured


@parallel_jit
def _measure(path: JointPath, Q: Floats, measured: Floats) -> None:
    size = 256  # configurations a thread takes at a time, to make its matrices once for all of them
    for chunk in prange((Q.shape[0] + size - 1) // size):
        before, behind, factor = np.empty((4, 4)), np.empty((4, 4)), np.empty((4, 4))
        for row in range(chunk * size, min((chunk + 1) * size, Q.shape[0])):
            _set_identity(before)
            for k in range(path.columns.shape[0]):
                _set_transform(factor, path.rotations[k], path.translations[k])
                _multiply(before, factor, behind)
                value = path.offsets[k] + Q[row, path.columns[k]] * path.multipliers[k]
                _set_joint(factor, value, path.prismatic[k] == 1)
                _multiply(behind, factor, before)
            _set_transform(factor, path.tool_rotation, path.tool_translation)
            _multiply(before, factor, measured[row])


@jit
def _set_identity(M: Floats) -> None:
    for i in range(4):
        for j in range(4):
            M[i, j] = 1.0 if i == j else 0.0


@jit
def _set_transform(M: Floats, R: Floats, t: Floats) -> None:
    """M := [R t; 0 1]."""
    for i in range(3):
        for j in range(3):
            M[i, j] = R[i, j]
        M[i, 3] = t[i]
        M[3, i] = 0.0
    M[3, 3] = 1.0


@jit
def _set_joint(M: Floats, value: float, slides: bool) -> None:
    """M := Trans_z(value) or Rot_z(value)."""
    _set_identity(M)
    if slides:
        M[2, 3] = value
    else:
        M[0, 0] = M[1, 1] = math.cos(value)
        M[1, 0] = math.sin(value)
        M[0, 1] = -M[1, 0]


@jit
def _multiply(left: Floats, right: Floats, product: Floats) -> None:
    """Product := left · right."""
    for i in range(4):
        a, b, c, d = left[i, 0], left[i, 1], left[i, 2], left[i, 3]
        for j in range(4):
            product[i, j] = a * right[0, j] + b * right[1, j] + c * right[2, j] + d * right[3, j]
