"""Two older forms of the orientation error, for compiled loops, each with the Jacobian rows that belong to it.

The rotation vector of `nao_kin.ik.aim` is what everything is measured by. These two replace it in the update only: they
are what the practicum prints, and Newton's method with them goes another way to the same target.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["EULER", "QUATERNION", "ROTATION_VECTOR", "recast_rows"]

ROTATION_VECTOR: Final = 0
EULER: Final = 1
QUATERNION: Final = 2


@leaf_jit
def recast_rows(error: int, goal: Floats, tip: Floats, e: Floats, J: Floats) -> None:
    """Turns the rotation part of the raw error e (6,) and of the frame Jacobian J (6, n) into those of another form.

    Args:
        error: `EULER` or `QUATERNION`; `ROTATION_VECTOR` changes nothing.
        goal: T_base_target (4, 4).
        tip: T_base_tip (12,) as `nao_kin.kernels.motion.place` writes it.
        e: Raw error, changed in place.
        J: Frame Jacobian, base axes, changed in place.
    """
    if error == EULER:
        _euler_rows(goal, tip, e, J)
    elif error == QUATERNION:
        _quaternion_rows(e, J)


@leaf_jit
def _euler_rows(goal: Floats, tip: Floats, e: Floats, J: Floats) -> None:
    """Differences of roll, pitch and yaw, R = Rz(yaw) Ry(pitch) Rx(roll), each in [−π, π]; singular at pitch = ±π/2.

    With ω = E(ρ) ρ̇ in base axes the rows are E⁻¹ times those of ω.

    Source: practicum (5), (10) and (11).
    """
    roll, pitch, yaw = _roll_pitch_yaw(tip[0], tip[3], tip[6], tip[7], tip[8])
    wanted_roll, wanted_pitch, wanted_yaw = _roll_pitch_yaw(goal[0, 0], goal[1, 0], goal[2, 0], goal[2, 1], goal[2, 2])
    e[3], e[4], e[5] = _wrapped(wanted_roll - roll), wanted_pitch - pitch, _wrapped(wanted_yaw - yaw)
    s, c, cosine, tangent = math.sin(yaw), math.cos(yaw), math.cos(pitch), math.tan(pitch)
    for k in range(J.shape[1]):
        x, y, z = J[3, k], J[4, k], J[5, k]
        along = c * x + s * y
        J[3, k], J[4, k], J[5, k] = along / cosine, c * y - s * x, z + tangent * along


@leaf_jit
def _quaternion_rows(e: Floats, J: Floats) -> None:
    """Vector part ε = n sin(θ/2) of ΔQ = Q_d Q_a⁻¹, whose sign is that of the shorter turn; singular at θ = π.

    The turn ω of the tip takes ½ (η ω + ε × ω) off ε, with η = cos(θ/2), so that is what happens to the rows.

    Source: practicum (6) and (8).
    """
    angle = math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    part = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    eta, x, y, z = math.cos(0.5 * angle), part * e[3], part * e[4], part * e[5]
    e[3], e[4], e[5] = x, y, z
    for k in range(J.shape[1]):
        u, v, w = J[3, k], J[4, k], J[5, k]
        J[3, k] = 0.5 * (eta * u + y * w - z * v)
        J[4, k] = 0.5 * (eta * v + z * u - x * w)
        J[5, k] = 0.5 * (eta * w + x * v - y * u)


@leaf_jit
def _roll_pitch_yaw(R00: float, R10: float, R20: float, R21: float, R22: float) -> tuple[float, float, float]:
    return math.atan2(R21, R22), math.atan2(-R20, math.hypot(R00, R10)), math.atan2(R10, R00)


@leaf_jit
def _wrapped(angle: float) -> float:
    """The same angle in [−π, π]; of a difference of two angles in that range."""
    if angle > math.pi:
        return angle - 2.0 * math.pi
    if angle < -math.pi:
        return angle + 2.0 * math.pi
    return angle
