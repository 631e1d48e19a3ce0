"""Compiled forward kinematics and frame Jacobians of many configurations of a `JointPath`, on all cores.

Many configurations are worked on in blocks; see `nao_kin.kernels.blocks`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.kernels.blocks import (
    K_STEP,
    LANES,
    W_SIZE,
    add_followers,
    keep_joint,
    move_block,
    place_block,
    start_block,
    turn_into_column,
)
from nao_kin.kernels.compiling import jit, parallel_jit, prange

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["jacobians", "poses"]

_CHUNK: Final = 16 * LANES  # configurations a thread takes at a time: one workspace serves them all


def poses(path: JointPath, Q: Floats) -> Floats:
    """T_base_tip of many configurations, on all cores.

    The result of a row depends on that row alone, to the last bit: not on its place, its neighbours or the number of
    threads.

    Args:
        path: The chain.
        Q: Configurations (N, n) [rad, m], C-contiguous and finite; see `nao_kin.arrays.rows`.

    Returns:
        Homogeneous matrices (N, 4, 4), each within 1e-12 of the exact one for lengths of some metres.
    """
    T = np.empty((len(Q), 4, 4))  # numpy asks for huge pages, the allocator of compiled code does not
    _fill_poses(path, Q, T)
    return T


def jacobians(path: JointPath, Q: Floats) -> Floats:
    """Frame Jacobians of many configurations, on all cores; a row's result depends on that row alone.

    Args:
        path: The chain.
        Q: Configurations (N, n) [rad, m], C-contiguous and finite; see `nao_kin.arrays.rows`.

    Returns:
        Jacobians (N, 6, n) at the tip point in base axes, rows (linear; angular) [m/rad, 1; m/m, 0]. A joint that
        follows another adds to its leader's column.
    """
    J = np.empty((len(Q), 6, Q.shape[1]))
    _fill_jacobians(path, Q, J)
    return J


@parallel_jit
def _fill_poses(path: JointPath, Q: Floats, T: Floats) -> None:
    for chunk in prange((len(Q) + _CHUNK - 1) // _CHUNK):
        W = np.empty(W_SIZE)
        for first in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(Q)), LANES):
            count = min(LANES, len(Q) - first)
            start_block(W)
            for k in range(path.columns.size):
                place_block(W, path.rotations[k], path.translations[k])
                move_block(path, k, Q, first, count, W)
            place_block(W, path.tool_rotation, path.tool_translation)
            _write_poses(W, T, first, count)


@parallel_jit
def _fill_jacobians(path: JointPath, Q: Floats, J: Floats) -> None:
    m = path.columns.size
    sources = _sources_of_entries(path, Q.shape[1])
    for chunk in prange((len(Q) + _CHUNK - 1) // _CHUNK):
        W, K = np.empty(W_SIZE), np.zeros((m + 1) * K_STEP)
        for first in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(Q)), LANES):
            count = min(LANES, len(Q) - first)
            start_block(W)
            for k in range(m):
                place_block(W, path.rotations[k], path.translations[k])
                keep_joint(W, K[k * K_STEP :])
                move_block(path, k, Q, first, count, W)
            place_block(W, path.tool_rotation, path.tool_translation)
            for k in range(m):
                turn_into_column(path, k, W, K[k * K_STEP :])
            add_followers(path, K)
            _write_jacobians(K, sources, J, first, count)


@jit
def _sources_of_entries(path: JointPath, n: int) -> NDArray[np.int64]:
    """Where in K the entries of a Jacobian (6, n) begin (6 n,): at the first joint that its column moves.

    A column that moves no joint of this path gets the zeros behind the last joint.
    """
    m = path.columns.size
    joints = np.full(n, m)
    for k in range(m - 1, -1, -1):
        joints[path.columns[k]] = k
    sources = np.empty(6 * n, np.int64)
    for row in range(6):
        for j in range(n):
            sources[row * n + j] = joints[j] * K_STEP + row * LANES
    return sources


@jit
def _write_poses(W: Floats, T: Floats, first: int, count: int) -> None:
    for i in range(count):
        for a in range(3):
            for b in range(4):
                T[first + i, a, b] = W[(4 * a + b) * LANES + i]
        T[first + i, 3, 0], T[first + i, 3, 1], T[first + i, 3, 2], T[first + i, 3, 3] = 0.0, 0.0, 0.0, 1.0


@jit
def _write_jacobians(K: Floats, sources: NDArray[np.int64], J: Floats, first: int, count: int) -> None:
    entries = J.reshape(-1)[first * sources.size :]
    for i in range(count):
        for e in range(sources.size):
            entries[i * sources.size + e] = K[sources[e] + i]
