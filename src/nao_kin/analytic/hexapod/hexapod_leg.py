"""Legs of three joints, as a hexapod's: a coxa axis, and femur and tibia axes parallel to each other across it.

With the leg's own angles t_k = ±q_k + offset_k the foot is, in the frame of the coxa (z up along its axis),

    p = Rz(t1) · (c + a sin t2 + b sin(t2 + t3), e, a cos t2 + b cos(t2 + t3))

with coxa c, femur a, tibia b, and a foot that may lie beside the leg's plane by e (0 where nothing is skewed). So the
foot's distance from the coxa axis gives t1, for a leg that points at the foot and for one that reaches over the body,
and what is left is a triangle of femur, tibia and the line from the femur axis to the foot, with its knee up or down:
four solutions, and nothing else exists.

Source: the hexapod article, steps 3 to 5, solves the leg that points at the foot; see
`nao_kin.analytic.hexapod.plane_construction`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, largest, screws
from nao_kin.analytic.hexapod.hexapod_leg_kernel import pack

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["LABELS", "SINGULARITIES", "recognise"]

LABELS: Final = tuple(f"coxa {coxa}, knee {knee}" for coxa in ("forward", "reaching over") for knee in ("up", "down"))
"""Coxa: whether the leg points at its foot or reaches over the body to it. Knee: on which side of the line from femur
axis to foot; up is where, at q = 0, the femur axis is seen from the foot."""

_FREE: Final = ("both knee branches in one", "any coxa", "any femur", "both coxa branches in one")
SINGULARITIES: Final = tuple(
    ", ".join(words for bit, words in enumerate(_FREE) if number >> bit & 1) for number in range(1 << len(_FREE))
)
"""What is free at a singularity, by the sum of the kernel's bits."""

_SHORTEST: Final = 1e-6  # a femur or tibia below this [m] is a joint's offset and no segment
_LEVEL: Final = 1e-9  # what is less than this [m] to a side is on neither


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The leg's numbers for the kernel."""
    leg = screws(path, 3)
    if isinstance(leg, Mismatch):
        return leg
    residual = largest(
        {
            "the first two axes depart from a right angle": float(leg.axes[0] @ leg.axes[1]),
            "the last two axes depart from parallel": float(np.linalg.norm(np.cross(leg.axes[1], leg.axes[2]))),
        }
    )
    if isinstance(residual, Mismatch):
        return residual
    T_base_coxa = _coxa_frame(leg)
    # Everything from here on in the coxa's frame, the leg being in its x-z plane at q = 0.
    signs, (coxa, lateral), (femur, tibia) = _measured(leg, T_base_coxa)
    lengths = (coxa, float(np.linalg.norm(femur)), float(np.linalg.norm(tibia)))
    if min(lengths[1:]) < _SHORTEST:
        return Mismatch(f"its femur and tibia are {lengths[1]:.3g} m and {lengths[2]:.3g} m long, too short to be any")
    at_zero = [float(np.arctan2(*segment)) for segment in (femur, tibia)]  # from straight up, outwards
    offsets = np.array([0.0, at_zero[0], at_zero[1] - at_zero[0]])
    return Geometry(pack(T_base_coxa, lengths, lateral, signs, offsets, path), residual)


def _coxa_frame(leg: Screws) -> Floats:
    """The frame of `nao_kin.analytic.hexapod.hexapod_leg_kernel.pack` (4, 4), at q = 0 and in the leg's base."""
    axis, foot = leg.axes[0], leg.tip[:3, 3]
    z = -axis if axis @ (foot - leg.points[1]) > _LEVEL else axis
    origin = leg.points[0] + z * (z @ (leg.points[1] - leg.points[0]))
    x = np.cross(leg.axes[1], z)
    x /= np.linalg.norm(x)
    out = x @ (leg.points[1] - origin)
    if (out if abs(out) > _LEVEL else x @ (foot - origin)) < 0.0:
        x = -x
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, np.cross(z, x), z, origin
    return T


def _measured(leg: Screws, T_base_coxa: Floats) -> tuple[Floats, tuple[float, float], tuple[Floats, Floats]]:
    """Signs of the joints, length of the coxa and the foot's place beside the plane, femur and tibia as (x, z) [m]."""
    x, y, z = T_base_coxa[:3, 0], T_base_coxa[:3, 1], T_base_coxa[:3, 2]
    signs = np.sign(np.array([leg.axes[0] @ z, leg.axes[1] @ y, leg.axes[2] @ y]))
    foot, plane = leg.tip[:3, 3], np.array([x, z])
    lateral = float(y @ (foot - T_base_coxa[:3, 3]))
    coxa = float(x @ (leg.points[1] - T_base_coxa[:3, 3]))
    return signs, (coxa, lateral), (plane @ (leg.points[2] - leg.points[1]), plane @ (foot - leg.points[2]))
