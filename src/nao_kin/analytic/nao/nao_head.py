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

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, largest, screws
from nao_kin.ik.target import ORIENTATION, POSE, POSITION
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.rotation import (
    Three,
    rotation_at,
    rotation_of_goal,
    times_transposed,
    transposed_times,
    turned,
    turned_back,
    vector_at,
    wrapped,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["BASE", "HEAD", "LABELS", "NECK", "SINGULARITIES", "TIP", "recognise", "solve", "solve_many"]

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


_NOTHING: Final = 1e-13  # lengths below this part of the tip's distance from the neck are rounding


@parallel_jit
def solve_many(
    parameters: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4) on all threads; rows (N, 2, 4), counts (N,)."""
    for i in prange(goals.shape[0]):
        counts[i] = solve(parameters, kind, goals[i], given[0], slack, rows[i])


@leaf_jit
def solve(parameters: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:  # noqa: ARG001 - nothing is left free, but all forms are called alike
    """Writes every solution of a goal into rows (2, 4); see `nao_kin.analytic.form.ClosedForm`."""
    base, head = rotation_at(parameters, BASE), rotation_at(parameters, HEAD)
    p = (goal[0, 3] - parameters[NECK], goal[1, 3] - parameters[NECK + 1], goal[2, 3] - parameters[NECK + 2])
    d, t = turned_back(base, p), vector_at(parameters, TIP)
    if kind == POSITION:
        return _carry(t, d, slack, rows)
    if kind in (POSE, ORIENTATION):
        R = times_transposed(transposed_times(base, rotation_of_goal(goal)), head)
        r = turned(R, t)
        if kind == POSE and math.hypot(math.hypot(d[0] - r[0], d[1] - r[1]), d[2] - r[2]) > slack:
            return 0
        rows[0, 0], rows[0, 1] = math.atan2(-R[1], R[4]), math.atan2(-R[6], R[8])
        rows[0, 2], rows[0, 3] = 0.0, 0.0
        return 1
    a = turned(head, (goal[0, 0], goal[1, 0], goal[2, 0]))
    return _carry(a, turned_back(base, (goal[0, 1], goal[1, 1], goal[2, 1])), slack, rows)


@leaf_jit
def _carry(t: Three, d: Three, slack: float, rows: Floats) -> int:
    """Yaw and pitch with Rz(θ1) Ry(θ2) t = d, for vectors of the same length.

    The pitch turns (t_x, t_z) to (±u, d_z), where u² is what the distance from the yaw axis leaves beside t_y.
    """
    across, size = math.hypot(d[0], d[1]), math.hypot(t[0], t[2])
    length = math.hypot(size, t[1])
    if abs(t[1]) - across > slack or abs(math.hypot(across, d[2]) - length) > slack:
        return 0
    u = math.sqrt(max(0.0, (across - t[1]) * (across + t[1])))
    for behind in range(2 if u > 0.0 else 1):
        signed, pitch, yaw, free = -u if behind == 1 else u, 0.0, 0.0, 0
        if size > _NOTHING * length:
            pitch = math.atan2(signed * t[2] - d[2] * t[0], signed * t[0] + d[2] * t[2])
        else:
            free = 2
        if length > 0.0 and across > _NOTHING * length:
            yaw = wrapped(math.atan2(d[1], d[0]) - math.atan2(t[1], signed))
        else:
            free += 1
        rows[behind, 0], rows[behind, 1] = yaw, pitch
        rows[behind, 2], rows[behind, 3] = 1.0 + behind, free
    return 2 if u > 0.0 else 1
