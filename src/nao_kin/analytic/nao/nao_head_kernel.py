"""The compiled solver of the NAO's head: every solution of a pose, an orientation, a position or a direction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.analytic.nao.nao_head import BASE, HEAD, NECK, TIP
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
    import numpy as np
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["solve", "solve_many"]


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
