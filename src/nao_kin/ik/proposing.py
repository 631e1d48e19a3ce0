"""What an update rule proposes, for compiled loops: its step, the better of two, and taking it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.ik.aim import raw_error, shape_rows
from nao_kin.ik.layout import (
    GAINS,
    KIND,
    LARGEST_STEP,
    ORIENTATION_ERROR,
    POSITION_TOLERANCE,
    ROTATION_TOLERANCE,
    RULE,
    WEIGHTS,
)
from nao_kin.ik.orientation import recast_rows
from nao_kin.ik.rules import update
from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.joint_limits import hold, move_inside
from nao_kin.kernels.motion import jacobian, place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["propose", "take_step", "weighted_merit"]


@leaf_jit
def propose(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    settings: Floats,
    goal: Floats,
    q: Floats,
    step: Floats,
    axes: Floats,
    tip: Floats,
    raw: Floats,
    full: Floats,
    e: Floats,
    J: Floats,
    y: Floats,
    A: Floats,
    memory: Floats,
) -> None:
    """Writes the step of any update rule; `e` and `J` are the rows of `raw` and `full` that the target binds."""
    n = q.shape[0]
    jacobian(joints, axes, tip, full)
    recast_rows(int(settings[ORIENTATION_ERROR]), goal, tip, raw, full)
    shape_rows(int(settings[KIND]), goal, settings[WEIGHTS : WEIGHTS + 6], tip, raw, full)
    hold(limits, q, e, J)
    steps = memory[: 2 * n].reshape(2, n)
    if update(int(settings[RULE]), J, e, settings[GAINS:], A, y, steps) == 2:
        _keep_better(joints, limits, coupled, settings, goal, q, steps, memory[2 * n : 3 * n], axes, tip, raw)
    for k in range(n):
        step[k] = steps[0, k]


@leaf_jit
def _keep_better(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    settings: Floats,
    goal: Floats,
    q: Floats,
    steps: Floats,
    trial: Floats,
    axes: Floats,
    tip: Floats,
    raw: Floats,
) -> None:
    """Puts that row of `steps` (2, n) first which leads closer to the goal; the last three are scratch."""
    least = math.inf
    for row in range(2):
        for k in range(q.shape[0]):
            trial[k] = q[k]
        if take_step(steps[row], settings[LARGEST_STEP], limits, coupled, trial):
            place(joints, trial, axes, tip)
            raw_error(int(settings[KIND]), goal, tip, raw)
            merit = weighted_merit(settings, raw)
            if merit < least:
                least = merit
                for k in range(q.shape[0]):
                    steps[0, k] = steps[row, k]


@leaf_jit
def weighted_merit(settings: Floats, raw: Floats) -> float:
    """The larger weighted error in units of its tolerance."""
    position, rotation = 0.0, 0.0
    for i in range(3):
        position += (settings[WEIGHTS + i] * raw[i]) ** 2
        rotation += (settings[WEIGHTS + 3 + i] * raw[3 + i]) ** 2
    return max(
        _ratio(math.sqrt(position), settings[POSITION_TOLERANCE]),
        _ratio(math.sqrt(rotation), settings[ROTATION_TOLERANCE]),
    )


@leaf_jit
def _ratio(error: float, tolerance: float) -> float:
    if tolerance > 0.0:
        return error / tolerance
    return 0.0 if error == 0.0 else math.inf


@leaf_jit
def take_step(step: Floats, largest_step: float, limits: Floats, coupled: Floats, q: Floats) -> bool:
    """Adds the step to q, scaled down to the largest one allowed, and moves q inside its limits.

    False, and q as it was, where the step is not finite.
    """
    largest, nothing = 0.0, 0.0
    for k in range(q.shape[0]):
        largest = max(largest, abs(step[k]))
        nothing += 0.0 * step[k]  # NaN of NaN and of infinity
    if nothing != 0.0:
        return False
    scale = largest_step / largest if largest > largest_step else 1.0
    for k in range(q.shape[0]):
        q[k] += scale * step[k]
    move_inside(q, limits, coupled)
    return True
