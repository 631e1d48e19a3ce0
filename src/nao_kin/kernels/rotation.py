"""Rotations as nine numbers, row by row, and vectors as three, for compiled code that makes no arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from nao_kin.kernels.compiling import jit, leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "Nine",
    "Three",
    "between",
    "cross",
    "dot",
    "rotation_at",
    "rotation_of_goal",
    "times",
    "times_transposed",
    "transposed_times",
    "turned",
    "turned_about",
    "turned_back",
    "turned_y",
    "turned_z",
    "vector_at",
    "wrapped",
]

Three: TypeAlias = tuple[float, float, float]
Nine: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

_TURN, _PER_TURN = 2.0 * math.pi, 0.5 / math.pi


@leaf_jit
def rotation_at(numbers: Floats, first: int) -> Nine:
    """The rotation that begins at an index of a flat array."""
    n, i = numbers, first
    return n[i], n[i + 1], n[i + 2], n[i + 3], n[i + 4], n[i + 5], n[i + 6], n[i + 7], n[i + 8]


@leaf_jit
def vector_at(numbers: Floats, first: int) -> Three:
    """The vector that begins at an index of a flat array."""
    return numbers[first], numbers[first + 1], numbers[first + 2]


@leaf_jit
def rotation_of_goal(T: Floats) -> Nine:
    """The rotation part of a homogeneous matrix (4, 4)."""
    return T[0, 0], T[0, 1], T[0, 2], T[1, 0], T[1, 1], T[1, 2], T[2, 0], T[2, 1], T[2, 2]


@jit
def times(A: Nine, B: Nine) -> Nine:
    """A · B."""
    a, b, c, d, e, f, g, h, i = A
    p, q, r, s, t, u, v, w, x = B
    return (
        a * p + b * s + c * v,
        a * q + b * t + c * w,
        a * r + b * u + c * x,
        d * p + e * s + f * v,
        d * q + e * t + f * w,
        d * r + e * u + f * x,
        g * p + h * s + i * v,
        g * q + h * t + i * w,
        g * r + h * u + i * x,
    )


@jit
def transposed_times(A: Nine, B: Nine) -> Nine:
    """Aᵀ · B."""
    a, b, c, d, e, f, g, h, i = A
    return times((a, d, g, b, e, h, c, f, i), B)


@jit
def times_transposed(A: Nine, B: Nine) -> Nine:
    """A · Bᵀ."""
    a, b, c, d, e, f, g, h, i = B
    return times(A, (a, d, g, b, e, h, c, f, i))


@jit
def turned(R: Nine, v: Three) -> Three:
    """R · v."""
    a, b, c, d, e, f, g, h, i = R
    x, y, z = v
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


@jit
def turned_back(R: Nine, v: Three) -> Three:
    """Rᵀ · v."""
    a, b, c, d, e, f, g, h, i = R
    x, y, z = v
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


@jit
def turned_y(c: float, s: float, v: Three) -> Three:
    """A vector turned about y by the angle with this cosine and sine."""
    return c * v[0] + s * v[2], v[1], c * v[2] - s * v[0]


@jit
def turned_z(c: float, s: float, v: Three) -> Three:
    """A vector turned about z by the angle with this cosine and sine."""
    return c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]


@jit
def turned_about(axis: Three, cosine: float, sine: float, v: Three) -> Three:
    """A vector turned about a unit axis (Rodrigues)."""
    part, side = (1.0 - cosine) * dot(axis, v), cross(axis, v)
    return (
        cosine * v[0] + sine * side[0] + part * axis[0],
        cosine * v[1] + sine * side[1] + part * axis[1],
        cosine * v[2] + sine * side[2] + part * axis[2],
    )


@jit
def dot(a: Three, b: Three) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@jit
def cross(a: Three, b: Three) -> Three:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@jit
def between(a: Three, b: Three, v: Three) -> Three:
    """A vector turned by a rotation that takes the unit vector a to the unit vector b.

    The shortest one; from beyond a right angle, half a turn about a perpendicular of a first, which stays exact where b
    is opposite to a.
    """
    if dot(a, b) < 0.0:
        x, y, z = a
        k = (
            (0.0, z, -y)
            if abs(x) <= abs(y) and abs(x) <= abs(z)
            else (-z, 0.0, x)
            if abs(y) <= abs(z)
            else (y, -x, 0.0)
        )
        part = 2.0 * dot(k, v) / dot(k, k)
        v = (part * k[0] - v[0], part * k[1] - v[1], part * k[2] - v[2])
        a = (-x, -y, -z)
    k = cross(a, b)
    first, part = cross(k, v), dot(k, v) / (1.0 + dot(a, b))
    c = dot(a, b)
    return c * v[0] + first[0] + part * k[0], c * v[1] + first[1] + part * k[1], c * v[2] + first[2] + part * k[2]


@jit
def wrapped(angle: float) -> float:
    """The same angle [rad] in [−π, π); one already there is returned to the bit."""
    whole: float = angle - _TURN * np.floor((angle + math.pi) * _PER_TURN)
    return whole
