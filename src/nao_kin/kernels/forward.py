"""Compiled forward kinematics and frame Jacobians of many configurations of a `JointPath`, on all cores.

Many configurations are worked on in blocks of 64, with the number of the configuration as the innermost index, so that
the compiler turns each inner loop into vector instructions. Three things keep it able to:

* inner loops run over all 64 lanes, a constant; a block that is not full computes zeros in the rest. That also makes a
  result independent of its place in the block, since every lane goes through the same instructions;
* a block's numbers lie in one flat array at constant distances, so that loads and stores are known not to overlap;
* sine and cosine are our own, without a branch and without a call.

A row of T_base_k = [x y z p], one of three, never meets the other two on the way along the path, so `_placed` and
`_turned` take a row. One configuration at a time, inside another loop, is what `nao_kin.kernels.motion` is for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.kernels.compiling import jit, parallel_jit, prange
from nao_kin.kernels.trigonometry import FAR, near_sine_cosine, sine_cosine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.path import JointPath

__all__ = ["jacobians", "poses"]

_LANES: Final = 64  # a power of two that several vectors of any machine divide; 32 is unrolled instead of vectorised
_CHUNK: Final = 16 * _LANES  # configurations a thread takes at a time: one workspace serves them all


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


@jit
def _placement(R: Floats, t: Floats) -> tuple[float, ...]:
    """A fixed transform as 12 numbers, columns of [R t] one after the other, which the compiler keeps in registers."""
    return R[0, 0], R[1, 0], R[2, 0], R[0, 1], R[1, 1], R[2, 1], R[0, 2], R[1, 2], R[2, 2], t[0], t[1], t[2]


@jit
def _placed(x: float, y: float, z: float, p: float, P: tuple[float, ...]) -> tuple[float, float, float, float]:
    """A row [x y z p] of T, times a fixed transform."""
    return (
        x * P[0] + y * P[1] + z * P[2],
        x * P[3] + y * P[4] + z * P[5],
        x * P[6] + y * P[7] + z * P[8],
        x * P[9] + y * P[10] + z * P[11] + p,
    )


@jit
def _turned(x: float, y: float, s: float, c: float) -> tuple[float, float]:
    """The first two entries of a row [x y z p] of T after a turn about z."""
    return x * c + y * s, y * c - x * s


# Blocks. W is flat; its rows of 64 lanes are x, y, z, p of the first row of T, of the second, of the third, and the
# joint's value, sine and cosine. K holds, for each joint, origin and axis, which become its column of the Jacobian.
_V: Final = 12 * _LANES
_S: Final = 13 * _LANES
_C: Final = 14 * _LANES
_W_SIZE: Final = 15 * _LANES
_K_STEP: Final = 6 * _LANES  # from one joint to the next


@parallel_jit
def _fill_poses(path: JointPath, Q: Floats, T: Floats) -> None:
    for chunk in prange((len(Q) + _CHUNK - 1) // _CHUNK):
        W = np.empty(_W_SIZE)
        for first in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(Q)), _LANES):
            count = min(_LANES, len(Q) - first)
            _start_block(W)
            for k in range(path.columns.size):
                _place_block(W, path.rotations[k], path.translations[k])
                _move_block(path, k, Q, first, count, W)
            _place_block(W, path.tool_rotation, path.tool_translation)
            _write_poses(W, T, first, count)


@parallel_jit
def _fill_jacobians(path: JointPath, Q: Floats, J: Floats) -> None:
    m = path.columns.size
    sources = _sources_of_entries(path, Q.shape[1])
    for chunk in prange((len(Q) + _CHUNK - 1) // _CHUNK):
        W, K = np.empty(_W_SIZE), np.zeros((m + 1) * _K_STEP)
        for first in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(Q)), _LANES):
            count = min(_LANES, len(Q) - first)
            _start_block(W)
            for k in range(m):
                _place_block(W, path.rotations[k], path.translations[k])
                _keep_joint(W, K[k * _K_STEP :])
                _move_block(path, k, Q, first, count, W)
            _place_block(W, path.tool_rotation, path.tool_translation)
            for k in range(m):
                _turn_into_column(path, k, W, K[k * _K_STEP :])
            _add_followers(path, K)
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
            sources[row * n + j] = joints[j] * _K_STEP + row * _LANES
    return sources


@jit
def _start_block(W: Floats) -> None:
    """T = identity."""
    for row in range(12):
        value = 1.0 if row % 5 == 0 else 0.0
        for i in range(_LANES):
            W[row * _LANES + i] = value


@jit
def _place_block(W: Floats, R: Floats, t: Floats) -> None:
    """T := T times a fixed transform."""
    P = _placement(R, t)
    for i in range(_LANES):
        for a in range(3):
            x, y, z, p = (
                4 * a * _LANES + i,
                (4 * a + 1) * _LANES + i,
                (4 * a + 2) * _LANES + i,
                (4 * a + 3) * _LANES + i,
            )
            W[x], W[y], W[z], W[p] = _placed(W[x], W[y], W[z], W[p], P)


@jit
def _move_block(path: JointPath, k: int, Q: Floats, first: int, count: int, W: Floats) -> None:
    """T := T · Z_k."""
    column, multiplier, offset = path.columns[k], path.multipliers[k], path.offsets[k]
    for i in range(count):
        W[_V + i] = multiplier * Q[first + i, column] + offset
    for i in range(count, _LANES):
        W[_V + i] = 0.0
    if path.prismatic[k]:
        for i in range(_LANES):
            for a in range(3):
                W[(4 * a + 3) * _LANES + i] += W[_V + i] * W[(4 * a + 2) * _LANES + i]
    else:
        _turn_block(W)


@jit
def _turn_block(W: Floats) -> None:
    """T := T times the turn about z by the joint's values."""
    for i in range(_LANES):
        W[_S + i], W[_C + i] = near_sine_cosine(W[_V + i])
    far = 0
    for i in range(_LANES):
        far += 1 if abs(W[_V + i]) > FAR else 0
    if far:
        for i in range(_LANES):
            W[_S + i], W[_C + i] = sine_cosine(W[_V + i])
    for i in range(_LANES):
        for a in range(3):
            x, y = 4 * a * _LANES + i, (4 * a + 1) * _LANES + i
            W[x], W[y] = _turned(W[x], W[y], W[_S + i], W[_C + i])


@jit
def _keep_joint(W: Floats, K: Floats) -> None:
    """Keeps origin and axis of the joint whose frame T is."""
    for a in range(3):
        for i in range(_LANES):
            K[a * _LANES + i] = W[(4 * a + 3) * _LANES + i]
            K[(a + 3) * _LANES + i] = W[(4 * a + 2) * _LANES + i]


@jit
def _turn_into_column(path: JointPath, k: int, W: Floats, K: Floats) -> None:
    """Replaces origin and axis of joint k by its column of the Jacobian, now that T is that of the tip."""
    factor = path.multipliers[k]
    if path.prismatic[k]:
        for a in range(3):
            for i in range(_LANES):
                K[a * _LANES + i] = factor * K[(a + 3) * _LANES + i]
                K[(a + 3) * _LANES + i] = 0.0
        return
    for i in range(_LANES):
        dx = W[3 * _LANES + i] - K[i]
        dy = W[7 * _LANES + i] - K[_LANES + i]
        dz = W[11 * _LANES + i] - K[2 * _LANES + i]
        zx, zy, zz = factor * K[3 * _LANES + i], factor * K[4 * _LANES + i], factor * K[5 * _LANES + i]
        K[i], K[_LANES + i], K[2 * _LANES + i] = zy * dz - zz * dy, zz * dx - zx * dz, zx * dy - zy * dx
        K[3 * _LANES + i], K[4 * _LANES + i], K[5 * _LANES + i] = zx, zy, zz


@jit
def _add_followers(path: JointPath, K: Floats) -> None:
    """Adds the column of every joint that is not the first on its column of q to that of the first one."""
    for k in range(1, path.columns.size):
        for leader in range(k):
            if path.columns[leader] == path.columns[k]:
                for e in range(_K_STEP):
                    K[leader * _K_STEP + e] += K[k * _K_STEP + e]
                break


@jit
def _write_poses(W: Floats, T: Floats, first: int, count: int) -> None:
    for i in range(count):
        for a in range(3):
            for b in range(4):
                T[first + i, a, b] = W[(4 * a + b) * _LANES + i]
        T[first + i, 3, 0], T[first + i, 3, 1], T[first + i, 3, 2], T[first + i, 3, 3] = 0.0, 0.0, 0.0, 1.0


@jit
def _write_jacobians(K: Floats, sources: NDArray[np.int64], J: Floats, first: int, count: int) -> None:
    entries = J.reshape(-1)[first * sources.size :]
    for i in range(count):
        for e in range(sources.size):
            entries[i * sources.size + e] = K[sources[e] + i]
