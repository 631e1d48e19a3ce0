"""Compiled sampling of a `JointPath` inside its limits, and where the tips fall in a grid of cells.

Configuration number i is a function of i and of two numbers a joint, so it does not matter who computes which ones, in
which order and how many at a time. Sums are sums of whole numbers, so that they do not hang on the order either.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

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
from nao_kin.kernels.joint_limits import column_range, move_inside
from nao_kin.kernels.linear import dot, orthogonal_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["LEAST", "NOTHING", "VOLUME", "Cells", "Samples", "configurations", "sort_into_cells"]

NOTHING: Final = 0
VOLUME: Final = 1
LEAST: Final = 2
"""What is measured of the Jacobian's linear part J at each tip: nothing, √det(J Jᵀ), or its smallest singular value."""

_SHIFTS: Final = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_FACTORS: Final = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_UNIT: Final = 2.0**-53


class Samples(NamedTuple):
    """A sequence of configurations.

    Attributes:
        starts: Where the sequence of each joint begins (n,).
        steps: What it adds from one configuration to the next (n,), modulo 2⁶⁴.
        mixed: 1 if the bits are mixed, which makes the sequence random; 0 if it is taken as it is.
        limits: Least and greatest values (2, n) [rad or m], all finite.
        coupled: Coupled limits (k, 7); see `nao_kin.kernels.joint_limits`.
        cut: The columns whose range hangs on other columns (c,), each after those that decide it.
    """

    starts: NDArray[np.uint64]
    steps: NDArray[np.uint64]
    mixed: int
    limits: Floats
    coupled: Floats
    cut: NDArray[np.int64]


class Cells(NamedTuple):
    """A grid of cubes in the base frame, cube (0, 0, 0) of the unbounded grid having its lowest corner at the origin.

    Attributes:
        edge: Length of an edge [m].
        corner: Number of the lowest cube along each axis (3,).
        shape: How many cubes there are along each axis (3,).
        counts: Which of the directions x, y, z count in the measure, 1 or 0 (3,).
        measure: `NOTHING`, `VOLUME` or `LEAST`.
        scale: What the measure is multiplied by to become a whole number.
    """

    edge: float
    corner: NDArray[np.int64]
    shape: NDArray[np.int64]
    counts: NDArray[np.int64]
    measure: int
    scale: float


def configurations(samples: Samples, first: int, count: int) -> Floats:
    """Configurations first … first + count − 1 (count, n) [rad or m]."""
    Q = np.empty((count, samples.starts.size))
    _fill_configurations(samples, first, Q)
    return Q


@parallel_jit
def sort_into_cells(
    path: JointPath, samples: Samples, cells: Cells, first: int, count: int, totals: NDArray[np.int64]
) -> None:
    """Adds the tips of `count` configurations to the totals.

    Args:
        path: The chain.
        samples: Its configurations.
        cells: The grid.
        first: Number of the first configuration.
        count: How many there are.
        totals: Added to, (t, c, 3): for each of t threads and c cubes how many tips are in it, the sum of the scaled
            measure and its greatest value. A tip outside the grid is counted nowhere.
    """
    parts, m, d = totals.shape[0], path.columns.size, int(cells.counts.sum())
    blocks = (count + LANES - 1) // LANES
    for part in prange(parts):
        W, K, G = np.empty(W_SIZE), np.zeros((m + 1) * K_STEP), np.empty(8 * LANES)
        Q, J, U = np.empty((LANES, samples.starts.size)), np.empty((d, m)), np.empty((d, d))
        for block in range(part * blocks // parts, (part + 1) * blocks // parts):
            _sample_block(samples, first + block * LANES, Q)
            start_block(W)
            for k in range(m):
                place_block(W, path.rotations[k], path.translations[k])
                keep_joint(W, K[k * K_STEP :])
                move_block(path, k, Q, 0, LANES, W)
            place_block(W, path.tool_rotation, path.tool_translation)
            _find_cells(cells, W, G)
            if cells.measure != NOTHING:
                for k in range(m):
                    turn_into_column(path, k, W, K[k * K_STEP :])
                add_followers(path, K)
                if cells.measure == VOLUME:
                    _volumes(path, cells, K, G)
                else:
                    _least_values(path, cells, K, J, U, G)
            _add_block(G, min(LANES, count - block * LANES), cells.measure, totals[part])


@parallel_jit
def _fill_configurations(samples: Samples, first: int, Q: Floats) -> None:
    for block in prange((len(Q) + LANES - 1) // LANES):
        part = Q[block * LANES : (block + 1) * LANES]
        _sample_block(samples, first + block * LANES, part)


@jit
def _sample_block(samples: Samples, first: int, Q: Floats) -> None:
    """Configurations from number `first` on, as many as Q (count, n) has rows."""
    lower, upper = samples.limits[0], samples.limits[1]
    for j in range(Q.shape[1]):
        start, step, width = samples.starts[j], samples.steps[j], upper[j] - lower[j]
        for i in range(Q.shape[0]):
            bits = start + np.uint64(first + i) * step
            if samples.mixed:
                bits = _mixed(bits)
            Q[i, j] = min(lower[j] + width * (np.float64(bits >> _SHIFTS[3]) * _UNIT), upper[j])
    if samples.cut.size:
        for i in range(Q.shape[0]):
            _cut_down(samples, Q[i])


@jit
def _mixed(bits: np.uint64) -> np.uint64:
    """64 bits that look random; the last step of SplitMix64.

    Source: G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014, figure 16.
    """
    bits = (bits ^ (bits >> _SHIFTS[0])) * _FACTORS[0]
    bits = (bits ^ (bits >> _SHIFTS[1])) * _FACTORS[1]
    return bits ^ (bits >> _SHIFTS[2])


@jit
def _cut_down(samples: Samples, q: Floats) -> None:
    """Maps the joints with coupled limits from their own range to what the other joints leave them."""
    lower, upper = samples.limits[0], samples.limits[1]
    for j in samples.cut:
        if upper[j] > lower[j]:
            low, high = column_range(samples.limits, samples.coupled, q, j)
            q[j] = low + (high - low) * ((q[j] - lower[j]) / (upper[j] - lower[j]))
    move_inside(q, samples.limits, samples.coupled)  # rounding, and limits that decide each other in a circle


@jit
def _find_cells(cells: Cells, W: Floats, G: Floats) -> None:
    """The number of each tip's cube, in the first row of G; −1 outside the grid. Whole numbers below 2⁵³ are exact."""
    nx, ny, nz = float(cells.shape[0]), float(cells.shape[1]), float(cells.shape[2])
    cx, cy, cz = float(cells.corner[0]), float(cells.corner[1]), float(cells.corner[2])
    for i in range(LANES):
        x = np.floor(W[3 * LANES + i] / cells.edge) - cx
        y = np.floor(W[7 * LANES + i] / cells.edge) - cy
        z = np.floor(W[11 * LANES + i] / cells.edge) - cz
        inside = (x >= 0.0) & (x < nx) & (y >= 0.0) & (y < ny) & (z >= 0.0) & (z < nz)
        G[i] = (x * ny + y) * nz + z if inside else -1.0


@jit
def _volumes(path: JointPath, cells: Cells, K: Floats, G: Floats) -> None:
    """√det(J Jᵀ) of each lane, scaled, in the second row of G; rows 2 … 7 are J Jᵀ: xx, yy, zz, xy, xz, yz."""
    for e in range(2 * LANES, 8 * LANES):
        G[e] = 0.0
    for k in range(path.columns.size):
        if _leads(path, k):
            _add_square(K[k * K_STEP :], G)
    for a in range(3):
        if not cells.counts[a]:
            _leave_out(a, G)
    for i in range(LANES):
        a, b, c = G[2 * LANES + i], G[3 * LANES + i], G[4 * LANES + i]
        d, e, f = G[5 * LANES + i], G[6 * LANES + i], G[7 * LANES + i]
        det = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)
        G[LANES + i] = math.sqrt(max(det, 0.0)) * cells.scale


@jit
def _leads(path: JointPath, k: int) -> bool:
    """Whether joint k is the first one on its column, to which `add_followers` has added the others."""
    for j in range(k):  # noqa: SIM110 - a generator does not compile
        if path.columns[j] == path.columns[k]:
            return False
    return True


@jit
def _add_square(K: Floats, G: Floats) -> None:
    """Adds j jᵀ of a column's linear part j."""
    for i in range(LANES):
        x, y, z = K[i], K[LANES + i], K[2 * LANES + i]
        G[2 * LANES + i] += x * x
        G[3 * LANES + i] += y * y
        G[4 * LANES + i] += z * z
        G[5 * LANES + i] += x * y
        G[6 * LANES + i] += x * z
        G[7 * LANES + i] += y * z


@jit
def _leave_out(a: int, G: Floats) -> None:
    """Gives direction a the factor 1 in the determinant."""
    for i in range(LANES):
        G[(2 + a) * LANES + i] = 1.0
        for b in range(3):
            if b != a:
                G[(4 + a + b) * LANES + i] = 0.0  # xy, xz and yz are rows 5, 6 and 7


@jit
def _least_values(path: JointPath, cells: Cells, K: Floats, J: Floats, U: Floats, G: Floats) -> None:
    """The smallest singular value of each lane's J (d, m), scaled, in the second row of G; d directions count."""
    for i in range(LANES):
        row = 0
        for a in range(3):
            if cells.counts[a]:
                for k in range(path.columns.size):
                    J[row, k] = K[k * K_STEP + a * LANES + i] if _leads(path, k) else 0.0
                row += 1
        orthogonal_rows(J, U)
        least = np.inf
        for row in range(J.shape[0]):
            least = min(least, dot(J[row], J[row]))
        G[LANES + i] = math.sqrt(least) * cells.scale


@jit
def _add_block(G: Floats, count: int, measure: int, totals: NDArray[np.int64]) -> None:
    for i in range(count):
        cell = int(G[i])
        if cell < 0:
            continue
        totals[cell, 0] += 1
        if measure != NOTHING:
            value = int(G[LANES + i] + 0.5)
            totals[cell, 1] += value
            totals[cell, 2] = max(totals[cell, 2], value)
