"""Sine and cosine for compiled loops, and where a cosine and a sine add up to something."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from nao_kin.kernels.compiling import jit

__all__ = ["FAR", "HALF_PI", "circle_roots", "near_sine_cosine", "sine_cosine"]

HALF_PI: Final = (
    float.fromhex("0x1.921fb544p+0"),
    float.fromhex("0x1.0b4611a6p-34"),
    float.fromhex("0x1.3198a2e037073p-69"),
)
"""π/2 in three parts; the first two have 33 bits, so that their products with whole numbers below 2²⁰ are exact."""
FAR: Final = 1e5
"""Up to this angle [rad] `near_sine_cosine` holds; beyond it the C library computes."""


@jit
def sine_cosine(v: float) -> tuple[float, float]:
    """Sine and cosine of any angle [rad], each within 2.3e-16; NaN of an angle that is not finite."""
    if abs(v) <= FAR:
        return near_sine_cosine(v)
    return math.sin(v), math.cos(v)


@jit
def near_sine_cosine(v: float) -> tuple[float, float]:
    """Sine and cosine of |v| ≤ `FAR`, each within 2.3e-16, without a branch.

    v = k π/2 + r with |r| ≤ π/4, and polynomials in r; their coefficients are those of FreeBSD's msun (k_sin.c,
    k_cos.c). k and its bits stay floating-point numbers: the integer floor would keep loops from being vectorised.
    """
    k = np.floor(v * (2.0 / math.pi) + 0.5)
    r = ((v - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2]
    w = r * r
    s = 2.75573137070700676789e-06 + w * (-2.50507602534068634195e-08 + w * 1.58969099521155010221e-10)
    s = 8.33333333332248946124e-03 + w * (-1.98412698298579493134e-04 + w * s)
    s = r + r * w * (-1.66666666666666324348e-01 + w * s)
    c = -2.75573143513906633035e-07 + w * (2.08757232129817482790e-09 + w * -1.13596475577881948265e-11)
    c = -1.38888888888741095749e-03 + w * (2.48015872894767294178e-05 + w * c)
    c = (1.0 - 0.5 * w) + w * w * (4.16666666666666019037e-02 + w * c)
    half = np.floor(0.5 * k)
    swap = k != 2.0 * half
    sign = 1.0 - 2.0 * (half - 2.0 * np.floor(0.5 * half))
    return sign * (c if swap else s), sign * (-s if swap else c)


@jit
def circle_roots(a: float, b: float, c: float, slack: float) -> tuple[int, float, float, float, float]:
    """The angles with a cos x + b sin x = c: how many, and cosine and sine of the greater and of the smaller one.

    They are atan2(b, a) ± arccos(c / hypot(a, b)), which is never computed. Where |c| is beyond hypot(a, b) by no more
    than `slack`, the one angle that comes nearest counts as a root. Both are written always; a and b are not both 0.
    """
    most = math.sqrt(a * a + b * b)
    if abs(c) - most > slack:
        return 0, 1.0, 0.0, 1.0, 0.0
    a, b, c = a / most, b / most, max(-1.0, min(1.0, c / most))
    w = math.sqrt((1.0 - c) * (1.0 + c))
    return 1 if w == 0.0 else 2, a * c - b * w, b * c + a * w, a * c + b * w, b * c - a * w
