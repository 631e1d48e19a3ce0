"""Legs of six joints, as NAO's: three hip axes through one point, knee and ankle pitch parallel, ankle roll across.

The hip axes are perpendicular one to the next, the hip pitch axis is parallel to knee and ankle pitch, and the ankle's
two axes meet at a right angle. So, with the leg's own angles t_k = ±q_k + offset_k,

    T_base_tip = B · Rz(t1) Rx(t2) Ry(t3) · Tz(−a) · Ry(t4) · Tz(−b) · Ry(t5) · Ty(−e) · Rx(t6) · E

with thigh a, shank b, and an ankle that may lie beside the plane of the thigh by e (0 for NAO). The solution starts at
the foot, where the hip is seen at r = Rᵀ (H − A): its distance gives the knee, its direction in the foot's y-z plane
the ankle roll, its place in the leg's plane the ankle pitch, and the three hip angles are what is left of the
orientation. Two signs each for knee, ankle and hip make eight solutions; nothing else exists.

A path from the foot to the torso is the same leg backwards and recognised as such.

Source: the leg of Kofinas, Orfanoudakis and Lagoudakis 2013, whose chain this is; the solution is derived here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, largest, screws
from nao_kin.analytic.nao.leg_kernel import pack

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["LABELS", "SINGULARITIES", "meeting_point", "recognise"]

LABELS: Final = tuple(
    f"knee {knee}, ankle {ankle}, hip {hip}"
    for hip in ("upright", "over")
    for ankle in ("upright", "over")
    for knee in "+−"
)
"""Knee: the sense in which it is bent, seen from the straight leg. Ankle: whether the hip is on the side of the foot
that it is on at q = 0, or the foot is rolled over by half a turn. Hip: the same for the hip roll's half turn."""

_FREE: Final = (
    "both knee branches in one",
    "any ankle roll",
    "any hip yaw",
    "any ankle pitch",
    "both ankle branches in one",
)
SINGULARITIES: Final = tuple(
    ", ".join(words for bit, words in enumerate(_FREE) if number >> bit & 1) for number in range(1 << len(_FREE))
)
"""What is free at a singularity, by the sum of the kernel's bits."""

_SHORTEST: Final = 1e-6  # a thigh or shank below this [m] is a joint's offset and no segment


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The leg's numbers for the kernel, of a path from torso to foot or from foot to torso."""
    leg = screws(path, 6)
    if isinstance(leg, Mismatch):
        return leg
    forwards = _measured(leg, path, backwards=False)
    if isinstance(forwards, Geometry):
        return forwards
    backwards = _measured(_reversed(leg), path, backwards=True)
    return backwards if isinstance(backwards, Geometry) else forwards


def _measured(leg: Screws, path: JointPath, *, backwards: bool) -> Geometry | Mismatch:
    """The leg's numbers, if these screws are a leg from hip to foot."""
    axes, points = leg.axes, leg.points
    y = axes[2]
    hip, hips_apart = meeting_point(axes[:3], points[:3])
    ankle, ankles_apart = meeting_point(axes[4:], points[4:])
    residual = largest(
        {
            "the first two axes depart from a right angle": float(axes[0] @ axes[1]),
            "the second and third axis depart from a right angle": float(axes[1] @ y),
            "the first three axes miss a common point": hips_apart,
            "the third and fourth axis depart from parallel": float(np.linalg.norm(np.cross(axes[3], y))),
            "the third and fifth axis depart from parallel": float(np.linalg.norm(np.cross(axes[4], y))),
            "the last two axes depart from a right angle": float(axes[4] @ axes[5]),
            "the last two axes miss a common point": ankles_apart,
        }
    )
    if isinstance(residual, Mismatch):
        return residual
    knee = points[3] + y * (y @ (hip - points[3]))
    ankle_in_plane = ankle + y * (y @ (hip - ankle))
    lengths = np.array([np.linalg.norm(hip - knee), np.linalg.norm(knee - ankle_in_plane)])
    if lengths.min() < _SHORTEST:
        return Mismatch(f"its thigh and shank are {lengths[0]:.3g} m and {lengths[1]:.3g} m long, too short to be any")
    thigh, shank = (hip - knee) / lengths[0], (knee - ankle_in_plane) / lengths[1]  # both upward, as the leg's z is
    # Of the two senses of the leg's own z at the hip and x at the foot, those in which q = 0 is an upright branch.
    hip_sign = -1.0 if np.cross(axes[0], axes[1]) @ y < 0.0 else 1.0
    foot_sign = -1.0 if np.cross(axes[5], y) @ (hip - ankle) < 0.0 else 1.0
    z, x, foot_x = hip_sign * axes[0], axes[1], foot_sign * axes[5]
    foot_z = np.cross(foot_x, y)
    offsets = np.array(
        [
            0.0,
            _angle(np.cross(z, x), y, about=x),
            _angle(np.cross(x, y), thigh, about=y),
            _angle(thigh, shank, about=y),
            _angle(shank, foot_z, about=y),
            0.0,
        ]
    )
    signs = np.array([hip_sign, 1.0, 1.0, np.sign(axes[3] @ y), np.sign(axes[4] @ y), foot_sign])
    lateral = float(y @ (hip - ankle))
    T_base_hip = _frame(x, np.cross(z, x), z, hip)
    T_foot_tip = np.linalg.inv(_frame(foot_x, y, foot_z, ankle)) @ leg.tip
    parameters = pack(T_base_hip, T_foot_tip, lengths, lateral, signs, offsets, path, backwards=backwards)
    return Geometry(parameters, residual)


def _reversed(leg: Screws) -> Screws:
    """The same joints met from the tip, in tip axes."""
    R, p = leg.tip[:3, :3], leg.tip[:3, 3]
    T_tip_base = np.asarray(np.linalg.inv(leg.tip), dtype=np.float64)
    return Screws(-leg.axes[::-1] @ R, (leg.points[::-1] - p) @ R, T_tip_base)


def meeting_point(axes: Floats, points: Floats) -> tuple[Floats, float]:
    """The point nearest to some lines (3,), and how far it is from the farthest of them [m]."""
    across = np.eye(3) - np.einsum("ki,kj->kij", axes, axes)
    point, *_ = np.linalg.lstsq(across.sum(axis=0), np.einsum("kij,kj->i", across, points), rcond=None)
    missed = np.einsum("kij,kj->ki", across, point - points)
    return point, float(np.linalg.norm(missed, axis=1).max())


def _angle(start: Floats, end: Floats, about: Floats) -> float:
    """The turn about a unit axis from one direction across it to another [rad]."""
    return float(np.arctan2(about @ np.cross(start, end), start @ end))


def _frame(x: Floats, y: Floats, z: Floats, origin: Floats) -> Floats:
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, y, z, origin
    return T
