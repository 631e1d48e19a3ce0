"""What a target asks of the tip, for compiled loops: the error, its Jacobian's rows, and whether it makes sense.

A target is a kind and a `goal` (4, 4). For a pose, position or orientation the goal is T_base_target; a position reads
the translation only, an orientation the rotation only. For pointing, the goal's last column is the position, its first
column a unit axis in tip axes and its second column the unit axis in base axes along which that is to point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from nao_kin.ik.target import ORIENTATION, POINTING, POSE, POSITION
from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "ORIENTATION",
    "POINTING",
    "POSE",
    "POSITION",
    "SweepGoal",
    "goal_violation",
    "raw_error",
    "rotation_vector",
    "shape_rows",
]


class SweepGoal(NamedTuple):
    """What the geometric methods head for.

    Attributes:
        kind: What is wanted, a value of `nao_kin.ik.target.KINDS`.
        goal: The target (4, 4).
        closeness: Weight of the squared distance [1/m²] against the rotation, see `nao_kin.ik.starts`.
    """

    kind: int
    goal: Floats
    closeness: float


@leaf_jit
def raw_error(kind: int, goal: Floats, tip: Floats, e: Floats) -> None:
    """What is missing, in base axes: e (6,) = (linear [m]; rotation vector [rad]), parts that the kind leaves free 0.

    Args:
        kind: What is wanted.
        goal: The target (4, 4).
        tip: T_base_tip (12,) as `place` writes it.
        e: Written.
    """
    for i in range(3):
        e[i] = 0.0 if kind == ORIENTATION else goal[i, 3] - tip[9 + i]
    if kind == POSITION:
        e[3], e[4], e[5] = 0.0, 0.0, 0.0
    elif kind == POINTING:
        ax, ay, az = pointing_axis(goal, tip)
        bx, by, bz = goal[0, 1], goal[1, 1], goal[2, 1]
        e[3], e[4], e[5] = _turn(ax, ay, az, bx, by, bz)
    else:
        e[3], e[4], e[5] = rotation_vector(goal, tip)


@leaf_jit
def rotation_vector(goal: Floats, tip: Floats) -> tuple[float, float, float]:
    """The rotation vector [rad], base axes, that turns the tip to the goal: log(R_goal R_tipᵀ), angle in [0, π].

    The angle comes from sine and cosine together, which loses no digits at either end. Near π the sine is too small to
    carry the axis, so that is read off the symmetric part.
    """
    E00 = goal[0, 0] * tip[0] + goal[0, 1] * tip[1] + goal[0, 2] * tip[2]
    E01 = goal[0, 0] * tip[3] + goal[0, 1] * tip[4] + goal[0, 2] * tip[5]
    E02 = goal[0, 0] * tip[6] + goal[0, 1] * tip[7] + goal[0, 2] * tip[8]
    E10 = goal[1, 0] * tip[0] + goal[1, 1] * tip[1] + goal[1, 2] * tip[2]
    E11 = goal[1, 0] * tip[3] + goal[1, 1] * tip[4] + goal[1, 2] * tip[5]
    E12 = goal[1, 0] * tip[6] + goal[1, 1] * tip[7] + goal[1, 2] * tip[8]
    E20 = goal[2, 0] * tip[0] + goal[2, 1] * tip[1] + goal[2, 2] * tip[2]
    E21 = goal[2, 0] * tip[3] + goal[2, 1] * tip[4] + goal[2, 2] * tip[5]
    E22 = goal[2, 0] * tip[6] + goal[2, 1] * tip[7] + goal[2, 2] * tip[8]
    x, y, z = 0.5 * (E21 - E12), 0.5 * (E02 - E20), 0.5 * (E10 - E01)
    sine, cosine = math.sqrt(x * x + y * y + z * z), 0.5 * (E00 + E11 + E22 - 1.0)
    if cosine > -0.99:
        scale = 1.0 if sine < 1e-9 else math.atan2(sine, cosine) / sine
        return scale * x, scale * y, scale * z
    # (E + Eᵀ) / 2 − cos · 1 = (1 − cos) a aᵀ: the column of its largest diagonal entry is parallel to the axis a.
    if E00 >= E11 and E00 >= E22:
        ax, ay, az = E00 - cosine, 0.5 * (E01 + E10), 0.5 * (E02 + E20)
    elif E11 >= E22:
        ax, ay, az = 0.5 * (E01 + E10), E11 - cosine, 0.5 * (E12 + E21)
    else:
        ax, ay, az = 0.5 * (E02 + E20), 0.5 * (E12 + E21), E22 - cosine
    scale = math.atan2(sine, cosine) / math.sqrt(ax * ax + ay * ay + az * az)
    if ax * x + ay * y + az * z < 0.0:
        scale = -scale
    return scale * ax, scale * ay, scale * az


@leaf_jit
def pointing_axis(goal: Floats, tip: Floats) -> tuple[float, float, float]:
    """The pointing axis as it is now, in base axes."""
    tx, ty, tz = goal[0, 0], goal[1, 0], goal[2, 0]
    return (
        tip[0] * tx + tip[1] * ty + tip[2] * tz,
        tip[3] * tx + tip[4] * ty + tip[5] * tz,
        tip[6] * tx + tip[7] * ty + tip[8] * tz,
    )


@leaf_jit
def _turn(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> tuple[float, float, float]:
    """The shortest rotation vector [rad] that turns unit vector a to unit vector b; any of them where b = −a."""
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    sine, cosine = math.sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz
    if sine < 1e-9:
        if cosine > 0.0:
            return x, y, z
        # Opposite: turn about the coordinate axis that is least parallel to a, made perpendicular to it.
        if abs(ax) <= abs(ay) and abs(ax) <= abs(az):
            x, y, z = 0.0, az, -ay
        elif abs(ay) <= abs(az):
            x, y, z = -az, 0.0, ax
        else:
            x, y, z = ay, -ax, 0.0
        sine, cosine = math.sqrt(x * x + y * y + z * z), -1.0
        scale = math.pi / sine
    else:
        scale = math.atan2(sine, cosine) / sine
    return scale * x, scale * y, scale * z


@leaf_jit
def shape_rows(kind: int, goal: Floats, weights: Floats, tip: Floats, e: Floats, J: Floats) -> None:
    """Makes the frame Jacobian's rows those of the weighted error: J · Δq takes as much off it, to first order.

    Args:
        kind: What is wanted.
        goal: The target (4, 4).
        weights: Weight of each base axis (6,), position x y z, rotation x y z; 0 leaves it free.
        tip: T_base_tip (12,).
        e: Raw error (6,), weighted in place.
        J: Frame Jacobian (6, n), changed in place.
    """
    if kind == POINTING:
        ax, ay, az = pointing_axis(goal, tip)
        for k in range(J.shape[1]):
            along = ax * J[3, k] + ay * J[4, k] + az * J[5, k]
            J[3, k] -= ax * along
            J[4, k] -= ay * along
            J[5, k] -= az * along
    elif weights[3] != 1.0 or weights[4] != 1.0 or weights[5] != 1.0:
        _log_rows(e, J)
    for i in range(6):
        if weights[i] != 1.0:
            e[i] *= weights[i]
            for k in range(J.shape[1]):
                J[i, k] *= weights[i]


@leaf_jit
def _log_rows(e: Floats, J: Floats) -> None:
    """Turns angular velocity rows into those of the rotation vector e[3:], exactly: rows ← Jr(e)⁻¹ rows.

    Needed only where its components count differently: a full step towards all of e is the same with and without,
    because Jr(e) e = e.
    """
    x, y, z = e[3], e[4], e[5]
    squared = x * x + y * y + z * z
    angle = math.sqrt(squared)
    if angle < 1e-4:
        second = 1.0 / 12.0
    else:
        second = (1.0 - 0.5 * angle * math.cos(0.5 * angle) / math.sin(0.5 * angle)) / squared
    for k in range(J.shape[1]):
        u, v, w = J[3, k], J[4, k], J[5, k]
        cx, cy, cz = y * w - z * v, z * u - x * w, x * v - y * u
        J[3, k] = u + 0.5 * cx + second * (y * cz - z * cy)
        J[4, k] = v + 0.5 * cy + second * (z * cx - x * cz)
        J[5, k] = w + 0.5 * cz + second * (x * cy - y * cx)


@leaf_jit
def goal_violation(kind: int, goal: Floats) -> float:
    """How far the goal is from one of its kind: rounding if it is one, NaN where it is not finite.

    For a pose or orientation the largest entry of |RᵀR − 1|, or 2 for a reflection; for pointing, by how much the axes
    are not of unit length; for all, how far the last row is from (0, 0, 0, 1).
    """
    nothing, worst = 0.0, abs(goal[3, 3] - 1.0)
    for i in range(4):
        worst = max(worst, abs(goal[3, i])) if i < 3 else worst
        for j in range(4):
            nothing += 0.0 * goal[i, j]  # NaN of NaN and of infinity
    if nothing != 0.0:
        return math.nan
    if kind == POINTING:
        for j in range(2):
            length = math.sqrt(goal[0, j] ** 2 + goal[1, j] ** 2 + goal[2, j] ** 2)
            worst = max(worst, abs(length - 1.0))
    elif kind != POSITION:
        for i in range(3):
            for j in range(i + 1):
                entry = goal[0, i] * goal[0, j] + goal[1, i] * goal[1, j] + goal[2, i] * goal[2, j]
                worst = max(worst, abs(entry - (1.0 if i == j else 0.0)))
        if _determinant(goal) < 0.0:
            worst = 2.0
    return float(worst)


@leaf_jit
def _determinant(goal: Floats) -> float:
    """Determinant of the rotation part."""
    determinant: float = (
        goal[0, 0] * (goal[1, 1] * goal[2, 2] - goal[1, 2] * goal[2, 1])
        - goal[0, 1] * (goal[1, 0] * goal[2, 2] - goal[1, 2] * goal[2, 0])
        + goal[0, 2] * (goal[1, 0] * goal[2, 1] - goal[1, 1] * goal[2, 0])
    )
    return determinant
