"""The NAO's head in closed form: yaw and pitch about axes that meet at a right angle.

T_base_tip = T_base_neck · Rz(θ1) Ry(θ2) · T_head_tip. The tip is the head itself or any camera on it: its place
t = (CameraX, 0, CameraZ) and its tilt are in T_head_tip.

* An orientation R = Rz(θ1) Ry(θ2) has one solution, if it has one.
* A position Rz(θ1) Ry(θ2) t = d has two: the tip before the neck, or behind it.
* So has a direction, which is the same for unit vectors, and looking at a point, where t is a point on the camera's
  axis as far away as the one that is to be seen.

Source: MATLAB example, equations eq1 to eq3, where x and z are given and y is found; here all three are given, so that
no case distinction is left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, largest, screws

if TYPE_CHECKING:
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["BASE", "HEAD", "LABELS", "NECK", "SINGULARITIES", "TIP", "recognise"]

# Where the parameters begin: rotation and origin of the neck frame in the base, rotation and place of the tip in the
# head frame.
BASE: Final = 0
NECK: Final = 9
HEAD: Final = 12
TIP: Final = 21
_SIZE: Final = 24

LABELS: Final = ("", "before the neck", "behind the neck")
"""The one solution of an orientation; the tip or its direction before or behind the neck, as the head faces by θ1."""

SINGULARITIES: Final = ("", "any yaw", "any pitch", "any yaw and pitch")


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The neck's frame and the tip's place, if the chain is a pan-tilt neck."""
    at_zero = screws(path, 2)
    if isinstance(at_zero, Mismatch):
        return at_zero
    w, p = at_zero.axes, at_zero.points
    residual = largest(
        {
            "axes 1 and 2 are out of square": float(w[0] @ w[1]),
            "axes 1 and 2 miss each other": float((p[1] - p[0]) @ np.cross(w[0], w[1])),
        }
    )
    if isinstance(residual, Mismatch):
        return residual
    y = w[1] - (w[1] @ w[0]) * w[0]
    y /= np.linalg.norm(y)
    frame = np.column_stack([np.cross(y, w[0]), y, w[0]])  # z along axis 1, y along axis 2
    neck = p[0] + (p[1] - p[0]) @ w[0] * w[0]
    parameters = np.empty(_SIZE)
    parameters[BASE:NECK], parameters[NECK:HEAD] = frame.ravel(), neck
    parameters[HEAD:TIP] = (frame.T @ at_zero.tip[:3, :3]).ravel()
    parameters[TIP:] = frame.T @ (at_zero.tip[:3, 3] - neck)
    return Geometry(parameters, residual)
