"""The smooth loops of a bent wrist, compiled: where its last joint leaves a shoulder, and what is at a point of them.

See `nao_kin.analytic.six_r.six_r_bent_wrist`, which searches them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from nao_kin.analytic.six_r.shared import (
    ACROSS,
    ALONG,
    FOREARM,
    LOWER,
    SCALE,
    SIDE,
    UPPER,
    axis,
    in_plane,
    minus,
    plus,
    point,
)
from nao_kin.kernels.compiling import jit, leaf_jit
from nao_kin.kernels.rotation import cross, dot, turned, vector_at
from nao_kin.kernels.trigonometry import sine_cosine

if TYPE_CHECKING:
    from nao_kin.analytic.six_r.shared import Placed
    from nao_kin.arrays import Floats

    Loop: TypeAlias = tuple[float, float, float]
    Two: TypeAlias = tuple[float, float]
    State: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

__all__ = ["lines", "shoulder_loops", "state"]

_COARSE: Final = 32  # samples of the room that the shoulder has
_BISECTIONS: Final = 54
_TOUCHING: Final = 1e-13  # relative: room that misses zero by no more than that, touches it
_AT_END: Final = 1e-4  # sine of the loop's parameter from which on its ends' linear law holds to rounding's square root


@leaf_jit
def lines(arm: Floats, G: Placed, L: Floats) -> None:
    """C from the first joint's point [m] and the direction of axis 5, each as constant, cosine's and sine's part of q6.

    In the shoulder's axes, z along the first joint's and x such that the parallel axes have no y. Written to L (10, 3),
    with those axes' direction (x, ., z) and the way from the second joint's point to the first one's in the last rows.
    """
    k1, h, k6, D = axis(arm, 0), axis(arm, 1), axis(arm, 5), point(arm, 5)
    lean = dot(h, k1)
    wide = math.sqrt((1.0 - lean) * (1.0 + lean))
    X = ((h[0] - lean * k1[0]) / wide, (h[1] - lean * k1[1]) / wide, (h[2] - lean * k1[2]) / wide)
    Y = cross(k1, X)
    L[6, 0], L[6, 1], L[6, 2] = wide, 0.0, lean
    for i in range(2):
        v = axis(arm, 4) if i == 1 else minus(point(arm, 3), D)
        along = dot(k6, v)
        constant = (along * k6[0], along * k6[1], along * k6[2])
        side = cross(v, k6)  # Rot(k6, −q) v = constant + (v − constant) cos q + v × k6 sin q
        parts = (constant, minus(v, constant), side)
        for j in range(3):
            u = turned(G[0], parts[j])
            if i == 0 and j == 0:
                u = minus(plus(plus(u, turned(G[0], D)), G[1]), point(arm, 0))
            L[3 * i + j, 0], L[3 * i + j, 1], L[3 * i + j, 2] = dot(X, u), dot(Y, u), dot(k1, u)
    for j in range(2):
        u = vector_at(arm, ALONG if j else ACROSS)
        L[8 + j, 0], L[8 + j, 1], L[8 + j, 2] = dot(X, u), dot(Y, u), dot(k1, u)
    L[7, 0], L[7, 1] = in_plane(arm, minus(point(arm, 0), point(arm, 1)))


@leaf_jit
def _room(arm: Floats, L: Floats, q6: float) -> tuple[float, float]:
    """The square of C's distance beside the extreme of the first joint's equation [m²], and its slope.

    Negative: no shoulder.
    """
    s, c = sine_cosine(q6)
    x, y = L[0, 0] + L[1, 0] * c + L[2, 0] * s, L[0, 1] + L[1, 1] * c + L[2, 1] * s
    z = L[0, 2] + L[1, 2] * c + L[2, 2] * s
    dx, dy, dz = L[2, 0] * c - L[1, 0] * s, L[2, 1] * c - L[1, 1] * s, L[2, 2] * c - L[1, 2] * s
    k, dk = (arm[SIDE] - L[6, 2] * z) / L[6, 0], -L[6, 2] * dz / L[6, 0]
    return x * x + y * y - k * k, 2.0 * (x * dx + y * dy - k * dk)


@jit
def shoulder_loops(arm: Floats, L: Floats, loops: Floats) -> int:
    """Intervals of the last joint on which shoulders exist: middle and half width; half width −1: all round.

    `_room` is a trigonometric polynomial of degree 2: at most four zeros, and at most four extremes, so that two of
    them hardly fit between two samples. What a change of sign does not tell, an extreme near zero does.
    """
    ends, number, N = np.empty(16), 0, _COARSE  # turning points in rising order: into room, out of room, …
    first, slope = _room(arm, L, 0.0)
    left, start, start_slope = 0.0, first, slope
    for i in range(N):
        right = 2.0 * math.pi * (i + 1) / N
        end, end_slope = _room(arm, L, right)
        if i + 1 == N:  # the same place, and it has to be on the same side of zero
            end, end_slope = first, slope
        number = _turning_points(arm, L, (left, right), (start, end), (start_slope, end_slope), ends, number)
        left, start, start_slope = right, end, end_slope
    if number == 0:
        loops[0, 0], loops[0, 1], loops[0, 2] = 0.0, -1.0, 1.0
        loops[1, 0], loops[1, 1], loops[1, 2] = 0.0, -1.0, -1.0
        return 2 if first >= 0.0 else 0
    into = 0 if first < 0.0 else 1
    count = min(number // 2, len(loops))
    for k in range(count):
        start = ends[2 * k + into]
        end = ends[(2 * k + into + 1) % number]
        if end < start:
            end += 2.0 * math.pi
        loops[k, 0], loops[k, 1], loops[k, 2] = 0.5 * (start + end), 0.5 * (end - start), 0.0
    return count


@leaf_jit
def _turning_points(arm: Floats, L: Floats, at: Two, values: Two, slopes: Two, ends: Floats, number: int) -> int:
    """Writes the zeros of `_room` between two angles; the number of ends then."""
    (left, right), outside = at, values[0] < 0.0
    if outside != (values[1] < 0.0):
        ends[number] = _edge(arm, L, left, right)
        return number + 1
    sign = -1.0 if outside else 1.0
    if number >= ends.shape[0] - 2 or sign * slopes[0] > 0.0 or sign * slopes[1] < 0.0:
        return number
    top = _extreme(arm, L, left, right, sign)
    value, _ = _room(arm, L, top)
    if outside and abs(value) <= _TOUCHING * arm[SCALE] * arm[SCALE]:
        ends[number], ends[number + 1] = top, top
        return number + 2
    if (value < 0.0) != outside:
        ends[number], ends[number + 1] = _edge(arm, L, left, top), _edge(arm, L, top, right)
        return number + 2
    return number


@leaf_jit
def _edge(arm: Floats, L: Floats, a: float, b: float) -> float:
    """The zero of `_room` between two angles of which one has room; on the side that has."""
    value, _ = _room(arm, L, a)
    has = value >= 0.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (a + b)
        value, _ = _room(arm, L, middle)
        if (value >= 0.0) == has:
            a = middle
        else:
            b = middle
    return a if has else b


@leaf_jit
def _extreme(arm: Floats, L: Floats, a: float, b: float, sign: float) -> float:
    """Where sign · `_room` is least between two angles whose slopes say that it is."""
    for _ in range(_BISECTIONS):
        middle = 0.5 * (a + b)
        _, slope = _room(arm, L, middle)
        if sign * slope < 0.0:
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


@leaf_jit
def _last_joint(loop: Loop, phi: float) -> tuple[float, float, float, float]:
    """q6, the side of the shoulder, the slope of q6 along the loop, and the parameter's sine; 1 on a whole turn."""
    middle, half, side = loop
    if half < 0.0:
        return phi, side, 1.0, 1.0
    sine, cosine = sine_cosine(phi)
    return middle + half * cosine, 1.0 if sine >= 0.0 else -1.0, -half * sine, sine


@leaf_jit
def state(arm: Floats, L: Floats, loop: Loop, phi: float) -> State:
    """What a loop's parameter stands for: q6, cosine and sine of q1, C in the plane, and both elbows' equations.

    a ± b S are the equations of the two elbows, times |C|² [m⁴]; a, b and S² come next, and last the slope of their
    product along the loop. It is found as the values are, by the chain rule.
    """
    half, (q6, side, rate, sine) = loop[1], _last_joint(loop, phi)
    s, c = sine_cosine(q6)
    x, y = L[0, 0] + L[1, 0] * c + L[2, 0] * s, L[0, 1] + L[1, 1] * c + L[2, 1] * s
    z = L[0, 2] + L[1, 2] * c + L[2, 2] * s
    dx, dy, dz = L[2, 0] * c - L[1, 0] * s, L[2, 1] * c - L[1, 1] * s, L[2, 2] * c - L[1, 2] * s
    # Turned back by q1, C stands at (k, r, z).
    k, dk = (arm[SIDE] - L[6, 2] * z) / L[6, 0], -L[6, 2] * dz / L[6, 0]
    r = side * math.sqrt(max(x * x + y * y - k * k, 0.0))
    inverse = 1.0 / math.sqrt((x * x + y * y) * (k * k + r * r) + 1e-300)
    c1, s1 = (k * x + r * y) * inverse, (k * y - r * x) * inverse
    # Slopes along the loop. At its ends r vanishes with the rate, and their quotient is the root of another one.
    per = rate / r if r != 0.0 else 0.0
    if half >= 0.0 and abs(sine) < _AT_END:
        per = -math.sqrt(half / (abs(x * dx + y * dy - k * dk) + 1e-300))
    turn = per * (dk - c1 * dx - s1 * dy)
    dx, dy, dz, dk = rate * dx, rate * dy, rate * dz, rate * dk
    dr = c1 * dy - s1 * dx - turn * k
    u, v = L[3, 0] + L[4, 0] * c + L[5, 0] * s, L[3, 1] + L[4, 1] * c + L[5, 1] * s
    w, dw = L[3, 2] + L[4, 2] * c + L[5, 2] * s, L[5, 2] * c - L[4, 2] * s
    du, dv, dw = rate * (L[5, 0] * c - L[4, 0] * s), rate * (L[5, 1] * c - L[4, 1] * s), rate * dw
    u, v, du, dv = c1 * u + s1 * v, c1 * v - s1 * u, c1 * du + s1 * dv, c1 * dv - s1 * du
    du, dv = du + turn * v, dv - turn * u
    px = L[7, 0] + L[8, 0] * k + L[8, 1] * r + L[8, 2] * z
    py = L[7, 1] + L[9, 0] * k + L[9, 1] * r + L[9, 2] * z
    dpx, dpy = L[8, 0] * dk + L[8, 1] * dr + L[8, 2] * dz, L[9, 0] * dk + L[9, 1] * dr + L[9, 2] * dz
    ux, uy = L[8, 0] * u + L[8, 1] * v + L[8, 2] * w, L[9, 0] * u + L[9, 1] * v + L[9, 2] * w
    dux, duy = L[8, 0] * du + L[8, 1] * dv + L[8, 2] * dw, L[9, 0] * du + L[9, 1] * dv + L[9, 2] * dw
    zx, zy = ux * px + uy * py, ux * py - uy * px  # conj(U) · P
    dzx = dux * px + duy * py + ux * dpx + uy * dpy
    dzy = dux * py - duy * px + ux * dpy - uy * dpx
    mx, my = arm[FOREARM], arm[FOREARM + 1]
    zx, zy, dzx, dzy = zx * mx - zy * my, zx * my + zy * mx, dzx * mx - dzy * my, dzx * my + dzy * mx
    upper, lower = arm[UPPER] * arm[UPPER], arm[LOWER] * arm[LOWER]
    square, dsquare = px * px + py * py, 2.0 * (px * dpx + py * dpy)
    t, dt = 0.5 * (lower - upper + square), 0.5 * dsquare
    g, dg = (
        (L[6, 0] * u + L[6, 2] * w) * arm[FOREARM + 2] - arm[FOREARM + 3],
        arm[FOREARM + 2] * (L[6, 0] * du + L[6, 2] * dw),
    )
    a, da = zx * t + square * g, dzx * t + zx * dt + dsquare * g + square * dg
    S2, dS2 = lower * square - t * t, lower * dsquare - 2.0 * t * dt
    slope = 2.0 * a * da - 2.0 * zy * dzy * S2 - zy * zy * dS2
    return q6, c1, s1, px, py, a, zy, S2, slope
