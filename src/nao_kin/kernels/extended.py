"""Forward kinematics to twice the usual digits, for the last digits of joints near a singularity, compiled.

A pose is rounded by some 1e-16 where it is computed; joints are off by that over the least singular value. Newton's
steps on a residual that is known to 1e-19 take the joints to where the goal itself puts them.

A number is a pair of floats, the second what the first leaves over. Products are split at a fixed place, 2⁻²⁴, so that
the compiler may contract them to fused operations without harm; numbers beyond 4 in size keep fewer digits, none less
than a single float. Source: Dekker 1971.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from nao_kin.kernels.compiling import jit, leaf_jit
from nao_kin.kernels.linear import add_to_diagonal, solve_positive, times_own_transpose, transpose_times
from nao_kin.kernels.motion import COLUMN, MULTIPLIER, OFFSET, SLIDES, jacobian
from nao_kin.kernels.trigonometry import HALF_PI

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

    Pair: TypeAlias = tuple[float, float]

__all__ = ["extended_tip", "refine"]

_SPLIT: Final = 16777216.0
_SIXTH: Final = (1.0 / 6.0, float.fromhex("0x1.5555555555555p-57"))
_TWENTY_FOURTH: Final = (1.0 / 24.0, float.fromhex("0x1.5555555555555p-59"))
_STEPS: Final = 5
_DAMPING: Final = 1e-18  # [m², 1]: far below the square of a singular value that leaves anything to refine
_LONGEST: Final = 1e-5  # [rad]: a longer step is not about last digits


@jit
def _tidy(a: float, b: float) -> Pair:
    """The sum of two floats of which the second is smaller, as a pair."""
    s = a + b
    return s, b - (s - a)


@jit
def _plus(a: Pair, b: Pair) -> Pair:
    s = a[0] + b[0]
    v = s - a[0]
    return _tidy(s, ((a[0] - (s - v)) + (b[0] - v)) + (a[1] + b[1]))


@jit
def _times(a: Pair, b: Pair) -> Pair:
    upper, other = np.floor(a[0] * _SPLIT + 0.5) / _SPLIT, np.floor(b[0] * _SPLIT + 0.5) / _SPLIT
    lower, rest = a[0] - upper, b[0] - other
    return _tidy(upper * other, (upper * rest + lower * other) + (lower * rest + (a[0] * b[1] + a[1] * b[0])))


@jit
def _sine_cosine(v: Pair) -> tuple[Pair, Pair]:
    """Sine and cosine of an angle [rad] below `nao_kin.kernels.trigonometry.FAR`."""
    k = np.floor(v[0] * (2.0 / math.pi) + 0.5)
    r = _plus((v[0] - k * HALF_PI[0], 0.0), (-k * HALF_PI[1], v[1] - k * HALF_PI[2]))
    t = _times(r, r)
    w = t[0]
    tail = 1.0 / 6227020800.0 + w * (-1.0 / 1307674368000.0 + w / 355687428096000.0)
    tail = 1.0 / 362880.0 + w * (-1.0 / 39916800.0 + w * tail)
    tail = r[0] * w * w * (1.0 / 120.0 + w * (-1.0 / 5040.0 + w * tail))
    cube = _times(_times(r, t), _SIXTH)
    s = _plus(_plus(r, (-cube[0], -cube[1])), (tail, 0.0))
    tail = 1.0 / 3628800.0 + w * (-1.0 / 479001600.0 + w * (1.0 / 87178291200.0 - w / 20922789888000.0))
    tail = w * w * w * (-1.0 / 720.0 + w * (1.0 / 40320.0 - w * tail))
    c = _plus((1.0, 0.0), (-0.5 * t[0], -0.5 * t[1]))
    c = _plus(_plus(c, _times(_times(t, t), _TWENTY_FOURTH)), (tail, 0.0))
    quarter = k - 4.0 * np.floor(0.25 * k)
    if quarter == 1.0:
        return c, (-s[0], -s[1])
    if quarter == 2.0:
        return (-s[0], -s[1]), (-c[0], -c[1])
    if quarter == 3.0:
        return (-c[0], -c[1]), s
    return s, c


@leaf_jit
def extended_tip(joints: Floats, q: Floats, axes: Floats, X: Floats) -> None:
    """T_base_tip to twice the digits; arguments as of `nao_kin.kernels.motion.place`, but X (3, 4, 2) for the tip."""
    m = joints.shape[0] - 1
    for a in range(3):
        for b in range(4):
            X[a, b, 0], X[a, b, 1] = (1.0 if a == b else 0.0), 0.0
    for k in range(m + 1):
        for a in range(3):
            _place_row(joints, k, X[a])
        if k == m:
            break
        for a in range(3):
            axes[k, a], axes[k, 3 + a] = X[a, 2, 0], X[a, 3, 0]
        value = _times((joints[k, MULTIPLIER], 0.0), (q[int(joints[k, COLUMN])], 0.0))
        value = _plus(value, (joints[k, OFFSET], 0.0))
        s, c = _sine_cosine(value)
        for a in range(3):
            if joints[k, SLIDES] != 0.0:
                X[a, 3, 0], X[a, 3, 1] = _plus((X[a, 3, 0], X[a, 3, 1]), _times(value, (X[a, 2, 0], X[a, 2, 1])))
            else:
                _turn_row(s, c, X[a])


@leaf_jit
def _place_row(joints: Floats, k: int, X: Floats) -> None:
    """One row [x y z p] (4, 2) of a transform, times a joint's placement."""
    x, y, z = (X[0, 0], X[0, 1]), (X[1, 0], X[1, 1]), (X[2, 0], X[2, 1])
    for b in range(4):
        first, step = (b, 3) if b < 3 else (9, 1)
        total = _times(x, (joints[k, first], 0.0))
        total = _plus(total, _times(y, (joints[k, first + step], 0.0)))
        total = _plus(total, _times(z, (joints[k, first + 2 * step], 0.0)))
        if b == 3:
            total = _plus(total, (X[3, 0], X[3, 1]))
        X[b, 0], X[b, 1] = total


@leaf_jit
def _turn_row(s: Pair, c: Pair, X: Floats) -> None:
    """One row of a transform, times a turn about z."""
    x, y = (X[0, 0], X[0, 1]), (X[1, 0], X[1, 1])
    X[0, 0], X[0, 1] = _plus(_times(c, x), _times(s, y))
    down = _times(s, x)
    X[1, 0], X[1, 1] = _plus(_times(c, y), (-down[0], -down[1]))


@leaf_jit
def _residual(goal: Floats, X: Floats, r: Floats) -> float:
    """What is missing of a goal (4, 4), as (translation; turn) in base axes, written to r (6,); its larger length."""
    for a in range(3):
        r[a] = (goal[a, 3] - X[a, 3, 0]) - X[a, 3, 1]
        b, c = (a + 1) % 3, (a + 2) % 3
        twice = (0.0, 0.0)
        for j in range(3):
            twice = _plus(twice, _times((goal[c, j], 0.0), (X[b, j, 0], X[b, j, 1])))
            twice = _plus(twice, _times((-goal[b, j], 0.0), (X[c, j, 0], X[c, j, 1])))
        r[3 + a] = 0.5 * twice[0]
    place = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    return math.sqrt(max(place, r[3] * r[3] + r[4] * r[4] + r[5] * r[5]))


@leaf_jit
def refine(joints: Floats, goal: Floats, q: Floats, W: Floats, X: Floats) -> None:
    """Newton's steps on joints that reach a goal up to rounding, as long as they bring the tip nearer.

    Args:
        joints: A chain of six joints, see `nao_kin.kernels.motion.packed_joints`.
        goal: The wanted T_base_tip (4, 4).
        q: The joints (6,), changed [rad or m].
        W: Workspace (4, 6, 6).
        X: Workspace (3, 4, 2).
    """
    J, A, axes, tip = W[0], W[1], W[2], W[3, 0:2].reshape(12)
    r, y, step, best = W[3, 2], W[3, 3], W[3, 4], W[3, 5]
    last = math.inf
    for _ in range(_STEPS):
        extended_tip(joints, q, axes, X)
        miss = _residual(goal, X, r)
        if not miss < last:
            for k in range(6):
                q[k] = best[k]
            return
        last = miss
        tip[9], tip[10], tip[11] = X[0, 3, 0], X[1, 3, 0], X[2, 3, 0]
        jacobian(joints, axes, tip, J)
        times_own_transpose(J, A)
        add_to_diagonal(A, _DAMPING)
        solve_positive(A, r, y)
        transpose_times(J, y, step)
        longest = 0.0
        for k in range(6):
            longest = max(longest, abs(step[k]))
        if not longest < _LONGEST:
            return
        for k in range(6):
            best[k] = q[k]
            q[k] += step[k]
