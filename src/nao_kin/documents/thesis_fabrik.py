"""Bischoff 2016, section 3.4: FABRIK, Algorithm 1 line by line, and (3.4.0.1), as printed.

Points p_1 … p_n are the rows of an array, so p_i is p[i - 1]; likewise d_i. Every block returns new points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numpy import dot
from numpy.linalg import norm

if TYPE_CHECKING:
    from nao_kin.arrays import Floats


def distances(n: int) -> list[tuple[int, int]]:
    """Line 4: the numbers of the two points of every d_i, i = 1, …, n."""
    return [(i + 1, i) for i in range(1, n + 1)]


def distances_corrected(n: int) -> list[tuple[int, int]]:
    """I = 1, …, n − 1."""
    return [(i + 1, i) for i in range(1, n)]


def unreachable(p: Floats, d: Floats, t: Floats) -> Floats:
    """Lines 9 to 16."""
    p, n = p.copy(), len(p)
    for i in range(1, n):
        r_i = norm(t - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i] = (1 - lambda_i) * p[i - 1] + lambda_i * t
    return p


def forward(p: Floats, d: Floats, t: Floats) -> Floats:
    """Lines 24 to 34."""
    p, n = p.copy(), len(p)
    p[n - 1] = t
    for i in range(n - 1, 0, -1):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i - 1] = (1 - lambda_i) * p[i] + lambda_i * p[i - 1]
    return p


def backward(p: Floats, d: Floats, b: Floats) -> Floats:
    """Lines 35 to 43 and 40 to 41 of the second block."""
    p, n = p.copy(), len(p)
    p[0] = b
    for i in range(1, n):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i - 1] = (1 - lambda_i) * p[i - 1] + lambda_i * p[i]
    return p


def backward_corrected(p: Floats, d: Floats, b: Floats) -> Floats:
    """Line 40 sets p_{i+1}."""
    p, n = p.copy(), len(p)
    p[0] = b
    for i in range(1, n):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i] = (1 - lambda_i) * p[i - 1] + lambda_i * p[i]
    return p


def goes_on(dif: float, tol: float) -> bool:
    """Line 23: the loop goes on while the distance to the target is above the tolerance."""
    return dif > tol


def base_and_tip(n: int) -> tuple[int, int]:
    """Text and Figure 7: numbers of the base and of the end effector of a chain of n points."""
    return 0, n - 1


def eq_3_4_0_1(d_i: Floats, d_next: Floats) -> Any:
    """(3.4.0.1): cos θ_i."""
    return dot(d_i, d_next) / (norm(d_i) * norm(d_next))
