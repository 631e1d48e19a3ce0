"""Blocks of 64 configurations of a `JointPath`, worked on together; `forward` and `reaching` are loops over them.

The number of the configuration is the innermost index, so that the compiler turns each inner loop into vector
instructions. Three things keep it able to:

* inner loops run over all 64 lanes, a constant; a block that is not full computes zeros in the rest. That also makes a
  result independent of its place in the block, since every lane goes through the same instructions;
* a block's numbers lie in one flat array at constant distances, so that loads and stores are known not to overlap;
* sine and cosine are our own, without a branch and without a call.

A row of T_base_k = [x y z p], one of three, never meets the other two on the way along the path, so `_placed` and
`_turned` take a row. One configuration at a time, inside another loop, is what `nao_kin.kernels.motion` is for.

W is flat; its rows of 64 lanes are x, y, z, p of the first row of T, of the second, of the third, and the joint's
value, sine and cosine. K holds, for each joint, origin and axis, which become its column of the Jacobian.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import jit
from nao_kin.kernels.trigonometry import FAR, near_sine_cosine, sine_cosine

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = [
    "K_STEP",
    "LANES",
    "W_SIZE",
    "add_followers",
    "keep_joint",
    "move_block",
    "place_block",
    "start_block",
    "turn_into_column",
]

LANES: Final = 64  # a power of two that several vectors of any machine divide; 32 is unrolled instead of vectorised
_V: Final = 12 * LANES
_S: Final = 13 * LANES
_C: Final = 14 * LANES
W_SIZE: Final = 15 * LANES
K_STEP: Final = 6 * LANES  # from one joint to the next


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


@jit
def start_block(W: Floats) -> None:
    """T = identity."""
    for row in range(12):
        value = 1.0 if row % 5 == 0 else 0.0
        for i in range(LANES):
            W[row * LANES + i] = value


@jit
def place_block(W: Floats, R: Floats, t: Floats) -> None:
    """T := T times a fixed transform."""
    P = _placement(R, t)
    for i in range(LANES):
        for a in range(3):
            x, y, z, p = (
                4 * a * LANES + i,
                (4 * a + 1) * LANES + i,
                (4 * a + 2) * LANES + i,
                (4 * a + 3) * LANES + i,
            )
            W[x], W[y], W[z], W[p] = _placed(W[x], W[y], W[z], W[p], P)


@jit
def move_block(path: JointPath, k: int, Q: Floats, first: int, count: int, W: Floats) -> None:
    """T := T · Z_k."""
    column, multiplier, offset = path.columns[k], path.multipliers[k], path.offsets[k]
    for i in range(count):
        W[_V + i] = multiplier * Q[first + i, column] + offset
    for i in range(count, LANES):
        W[_V + i] = 0.0
    if path.prismatic[k]:
        for i in range(LANES):
            for a in range(3):
                W[(4 * a + 3) * LANES + i] += W[_V + i] * W[(4 * a + 2) * LANES + i]
    else:
        _turn_block(W)


@jit
def _turn_block(W: Floats) -> None:
    """T := T times the turn about z by the joint's values."""
    for i in range(LANES):
        W[_S + i], W[_C + i] = near_sine_cosine(W[_V + i])
    far = 0
    for i in range(LANES):
        far += 1 if abs(W[_V + i]) > FAR else 0
    if far:
        for i in range(LANES):
            W[_S + i], W[_C + i] = sine_cosine(W[_V + i])
    for i in range(LANES):
        for a in range(3):
            x, y = 4 * a * LANES + i, (4 * a + 1) * LANES + i
            W[x], W[y] = _turned(W[x], W[y], W[_S + i], W[_C + i])


@jit
def keep_joint(W: Floats, K: Floats) -> None:
    """Keeps origin and axis of the joint whose frame T is."""
    for a in range(3):
        for i in range(LANES):
            K[a * LANES + i] = W[(4 * a + 3) * LANES + i]
            K[(a + 3) * LANES + i] = W[(4 * a + 2) * LANES + i]


@jit
def turn_into_column(path: JointPath, k: int, W: Floats, K: Floats) -> None:
    """Replaces origin and axis of joint k by its column of the Jacobian, now that T is that of the tip."""
    factor = path.multipliers[k]
    if path.prismatic[k]:
        for a in range(3):
            for i in range(LANES):
                K[a * LANES + i] = factor * K[(a + 3) * LANES + i]
                K[(a + 3) * LANES + i] = 0.0
        return
    for i in range(LANES):
        dx = W[3 * LANES + i] - K[i]
        dy = W[7 * LANES + i] - K[LANES + i]
        dz = W[11 * LANES + i] - K[2 * LANES + i]
        zx, zy, zz = factor * K[3 * LANES + i], factor * K[4 * LANES + i], factor * K[5 * LANES + i]
        K[i], K[LANES + i], K[2 * LANES + i] = zy * dz - zz * dy, zz * dx - zx * dz, zx * dy - zy * dx
        K[3 * LANES + i], K[4 * LANES + i], K[5 * LANES + i] = zx, zy, zz


@jit
def add_followers(path: JointPath, K: Floats) -> None:
    """Adds the column of every joint that is not the first on its column of q to that of the first one."""
    for k in range(1, path.columns.size):
        for leader in range(k):
            if path.columns[leader] == path.columns[k]:
                for e in range(K_STEP):
                    K[leader * K_STEP + e] += K[k * K_STEP + e]
                break
