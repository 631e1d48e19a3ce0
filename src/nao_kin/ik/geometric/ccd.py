"""Cyclic coordinate descent: one joint at a time, from the tip to the base, is set where it serves best.

The error that falls is w |p − p_goal|² + |R − R_goal|² (squared Frobenius distance, 4 − 4 cos of the angle between
them), each part where the kind of target binds it; for pointing the second is |a − b|² of the two unit axes.

Source: L.-C. T. Wang and C. C. Chen, "A combined optimization method for solving the inverse kinematics problem of
mechanical manipulators", 1991; the closed form of one joint is theirs, the limits and the coupled joints are not.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.ik.aim import ORIENTATION, POINTING, POSITION, pointing_axis
from nao_kin.ik.geometric.best_turn import best_turn, point_wave, spin
from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.joint_limits import column_range, decides, move_inside
from nao_kin.kernels.motion import COLUMN, MULTIPLIER, SLIDES, place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.ik.aim import SweepGoal
    from nao_kin.kernels.motion import Arm, At

__all__ = ["ccd_pass", "move_column", "squared_error"]

_LARGEST_TRIAL: Final = 1.0
"""A column that is moved by trial takes no longer step than this at first [rad or m]."""

_TRIALS: Final = 40
"""Halvings of such a step before the column is left where it is; then the step is below rounding."""


@leaf_jit
def squared_error(aim: SweepGoal, tip: Floats) -> float:
    """The error that the geometric methods bring down.

    Args:
        aim: What is wanted; a position alone is not weighted [m²].
        tip: T_base_tip (12,).
    """
    kind, goal, total = aim.kind, aim.goal, 0.0
    if kind != ORIENTATION:
        for i in range(3):
            total += (tip[9 + i] - goal[i, 3]) ** 2
        total *= _weight(aim)
    if kind == POINTING:
        ax, ay, az = pointing_axis(goal, tip)
        total += (ax - goal[0, 1]) ** 2 + (ay - goal[1, 1]) ** 2 + (az - goal[2, 1]) ** 2
    elif kind != POSITION:
        for i in range(3):
            for j in range(3):
                total += (tip[3 * i + j] - goal[i, j]) ** 2
    return total


@leaf_jit
def _weight(aim: SweepGoal) -> float:
    return 1.0 if aim.kind == POSITION else aim.closeness


@leaf_jit
def ccd_pass(arm: Arm, aim: SweepGoal, at: At, memory: Floats) -> None:
    """Moves every column once, from the tip to the base; axes and tip belong to the new q afterwards.

    Args:
        arm: The chain.
        aim: What is wanted.
        at: Joints inside the limits, changed in place, and their axes and tip.
        memory: Scratch (n + 6 m + 12,).
    """
    for k in range(arm.joints.shape[0] - 2, -1, -1):
        if _leads(arm.joints, k):
            move_column(arm, aim, k, at, memory)
    place(arm.joints, at.q, at.axes, at.tip)


@leaf_jit
def _leads(joints: Floats, k: int) -> bool:
    """Whether joint k is the one nearest to the tip that its column moves."""
    behind = 0
    for other in range(k + 1, joints.shape[0] - 1):
        behind += joints[other, COLUMN] == joints[k, COLUMN]
    return behind == 0


@leaf_jit
def _alone(joints: Floats, k: int) -> bool:
    """Whether the column of joint k moves no other joint."""
    moved = 0
    for other in range(joints.shape[0] - 1):
        moved += joints[other, COLUMN] == joints[k, COLUMN]
    return moved == 1


@leaf_jit
def move_column(arm: Arm, aim: SweepGoal, k: int, at: At, memory: Floats) -> None:
    """Moves the column of joint k so that the error falls or, where it cannot, stays.

    A column with one joint goes to the exact optimum inside its range. One that moves several joints, or that decides
    the range of another, is moved by trial on the true error, see `_move_by_trial`. The arguments are those of
    `ccd_pass`; of `axes` only the rows up to k need to belong to q, and of what is written only `tip` and q count.
    """
    joints, q, column = arm.joints, at.q, int(arm.joints[k, COLUMN])
    if _alone(joints, k) and not decides(arm.coupled, column):
        lower, upper = column_range(arm.limits, arm.coupled, q, column)
        delta = _best_move(joints, aim, k, q[column], lower, upper, at)
        if delta != 0.0:
            q[column] = min(max(q[column] + delta / joints[k, MULTIPLIER], lower), upper)
            _carry_tip(joints[k, SLIDES] != 0.0, delta, at.axes[k], at.tip)
    else:
        place(joints, q, at.axes, at.tip)
        _move_by_trial(arm, aim, k, at, memory)


@leaf_jit
def _best_move(joints: Floats, aim: SweepGoal, k: int, value: float, lower: float, upper: float, at: At) -> float:
    """By how much joint k [rad or m] should move, its column standing at `value` in [lower, upper]."""
    factor = joints[k, MULTIPLIER]
    low, high = factor * (lower - value), factor * (upper - value)
    low, high = min(low, high, 0.0), max(low, high, 0.0)
    if joints[k, SLIDES] == 0.0:
        A, B = _wave(aim, at.axes[k], at.tip)
        return best_turn(A, B, low, high)
    if aim.kind == ORIENTATION:
        return 0.0
    along = 0.0
    for i in range(3):
        along += at.axes[k, i] * (aim.goal[i, 3] - at.tip[9 + i])
    nearest: float = min(max(along, low), high)
    return nearest


@leaf_jit
def _wave(aim: SweepGoal, axis: Floats, tip: Floats) -> tuple[float, float]:
    """A and B such that turning about an axis (6,) by δ makes the error a constant less A cos δ + B sin δ."""
    kind, goal, ax, ay, az = aim.kind, aim.goal, axis[0], axis[1], axis[2]
    A, B = 0.0, 0.0
    if kind != ORIENTATION:
        rx, ry, rz = tip[9] - axis[3], tip[10] - axis[4], tip[11] - axis[5]
        sx, sy, sz = goal[0, 3] - axis[3], goal[1, 3] - axis[4], goal[2, 3] - axis[5]
        A, B = point_wave(ax, ay, az, rx, ry, rz, sx, sy, sz)
        A, B = _weight(aim) * A, _weight(aim) * B
    if kind == POINTING:
        ux, uy, uz = pointing_axis(goal, tip)
        C, S = point_wave(ax, ay, az, ux, uy, uz, goal[0, 1], goal[1, 1], goal[2, 1])
        A, B = A + C, B + S
    elif kind != POSITION:
        for j in range(3):  # |R − R_goal|² is the squared distances of the columns, added up
            C, S = point_wave(ax, ay, az, tip[j], tip[3 + j], tip[6 + j], goal[0, j], goal[1, j], goal[2, j])
            A, B = A + C, B + S
    return A, B


@leaf_jit
def _carry_tip(slides: bool, delta: float, axis: Floats, tip: Floats) -> None:
    """Moves the tip's pose (12,) with a joint that turns or slides by δ."""
    if slides:
        for i in range(3):
            tip[9 + i] += delta * axis[i]
        return
    ax, ay, az = axis[0], axis[1], axis[2]
    s, c = math.sin(delta), math.cos(delta)
    for i in range(3):
        tip[9 + i] -= axis[3 + i]
    spin(ax, ay, az, s, c, tip[9:12])
    for i in range(3):
        tip[9 + i] += axis[3 + i]
    for j in range(3):
        spin(ax, ay, az, s, c, tip[j:9:3])


@leaf_jit
def _move_by_trial(arm: Arm, aim: SweepGoal, k: int, at: At, memory: Floats) -> None:
    """A Gauss–Newton step of one column, halved until the true error is lower, else none.

    A column whose range hangs on this one is moved along into its new range, and the error is measured after that.
    """
    joints, q = arm.joints, at.q
    n, m, column = q.shape[0], joints.shape[0] - 1, int(joints[k, COLUMN])
    trial, trial_axes = memory[:n], memory[n : n + 6 * m].reshape(m, 6)
    trial_tip = memory[n + 6 * m : n + 6 * m + 12]
    before = squared_error(aim, at.tip)
    step = _newton_step(joints, aim, column, at)
    step = min(max(step, -_LARGEST_TRIAL), _LARGEST_TRIAL)
    for _ in range(_TRIALS):
        for i in range(n):
            trial[i] = q[i]
        trial[column] += step
        move_inside(trial, arm.limits, arm.coupled)
        place(joints, trial, trial_axes, trial_tip)
        if squared_error(aim, trial_tip) < before:
            for i in range(n):
                q[i] = trial[i]
            place(joints, q, at.axes, at.tip)
            return
        step *= 0.5


@leaf_jit
def _newton_step(joints: Floats, aim: SweepGoal, column: int, at: At) -> float:
    """Slope over Gauss–Newton curvature of half the error, by one column; 0 where the column does not count."""
    kind, goal, axes, tip = aim.kind, aim.goal, at.axes, at.tip
    slope, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(axes.shape[0]):
        if int(joints[k, COLUMN]) != column:
            continue
        factor, x, y, z = joints[k, MULTIPLIER], axes[k, 0], axes[k, 1], axes[k, 2]
        if joints[k, SLIDES] != 0.0:
            vx, vy, vz = vx + factor * x, vy + factor * y, vz + factor * z
            if kind != ORIENTATION:
                for i in range(3):
                    slope += factor * _weight(aim) * axes[k, i] * (goal[i, 3] - tip[9 + i])
            continue
        _, B = _wave(aim, axes[k], tip)
        slope += 0.5 * factor * B
        rx, ry, rz = tip[9] - axes[k, 3], tip[10] - axes[k, 4], tip[11] - axes[k, 5]
        vx, vy, vz = vx + factor * (y * rz - z * ry), vy + factor * (z * rx - x * rz), vz + factor * (x * ry - y * rx)
        wx, wy, wz = wx + factor * x, wy + factor * y, wz + factor * z
    curvature = 0.0 if kind == ORIENTATION else _weight(aim) * (vx * vx + vy * vy + vz * vz)
    if kind == POINTING:
        ux, uy, uz = pointing_axis(goal, tip)
        curvature += wx * wx + wy * wy + wz * wz - (wx * ux + wy * uy + wz * uz) ** 2
    elif kind != POSITION:
        curvature += 2.0 * (wx * wx + wy * wy + wz * wz)
    return slope / curvature if curvature > 0.0 else 0.0
