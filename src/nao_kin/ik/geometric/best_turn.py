"""The best move of one joint while all others stand still, in closed form: what the geometric methods are made of.

A joint that turns by δ about a unit axis a through a point c carries a point at c + r to c + r cos δ + (a × r) sin δ +
a (a·r)(1 − cos δ). So the squared distance to any fixed point is a constant less A cos δ + B sin δ, and so are sums of
such distances, the squared Frobenius distance of two rotations among them. Only A and B have to be added up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["best_turn", "point_wave", "spin"]

_ON_AXIS: Final = 1e-20
"""Square of the part of its distance by which a point may be off an axis and still be on it: rounding would turn it."""


@leaf_jit
def point_wave(
    ax: float, ay: float, az: float, rx: float, ry: float, rz: float, sx: float, sy: float, sz: float
) -> tuple[float, float]:
    """A and B of a point at r, turned about the axis a, that is wanted at s, both seen from a point on the axis.

    |r(δ) − s|² = constant − A cos δ − B sin δ. B is built from s − r, which keeps its digits when r is nearly at s.
    Both are 0 for a point on the axis, which does not move.
    """
    along_r, along_s = ax * rx + ay * ry + az * rz, ax * sx + ay * sy + az * sz
    A = 2.0 * (rx * sx + ry * sy + rz * sz - along_r * along_s)
    cx, cy, cz = ay * rz - az * ry, az * rx - ax * rz, ax * ry - ay * rx
    if cx * cx + cy * cy + cz * cz <= _ON_AXIS * (rx * rx + ry * ry + rz * rz):
        return 0.0, 0.0
    return A, 2.0 * (cx * (sx - rx) + cy * (sy - ry) + cz * (sz - rz))


@leaf_jit
def best_turn(A: float, B: float, lower: float, upper: float) -> float:
    """The δ in [lower, upper], an interval around 0, at which A cos δ + B sin δ is greatest; 0 where none is better.

    That is atan2(B, A), the nearer turn of the two that the interval may hold, or else the better end.
    """
    best = math.atan2(B, A)
    if best < lower or best > upper:
        best -= math.copysign(2.0 * math.pi, best)
    if lower <= best <= upper:
        return best if _gain(A, B, best) > 0.0 else 0.0
    at_lower = _gain(A, B, lower) if lower > -math.inf else -math.inf
    at_upper = _gain(A, B, upper) if upper < math.inf else -math.inf
    if max(at_lower, at_upper) <= 0.0:
        return 0.0
    return lower if at_lower > at_upper else upper


@leaf_jit
def _gain(A: float, B: float, delta: float) -> float:
    """A (cos δ − 1) + B sin δ, without the cancellation of the first term."""
    half = math.sin(0.5 * delta)
    gain: float = B * math.sin(delta) - 2.0 * A * half * half
    return gain


@leaf_jit
def spin(ax: float, ay: float, az: float, s: float, c: float, v: Floats) -> None:
    """Turns a vector v (3,) in place about the unit axis a by the angle with this sine and cosine."""
    x, y, z = v[0], v[1], v[2]
    along = (ax * x + ay * y + az * z) * (1.0 - c)
    v[0] = c * x + s * (ay * z - az * y) + along * ax
    v[1] = c * y + s * (az * x - ax * z) + along * ay
    v[2] = c * z + s * (ax * y - ay * x) + along * az
