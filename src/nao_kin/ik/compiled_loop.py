"""The compiled loop: the reference loop's iteration on flat arrays, for one target or many.

Python hands over plain arrays, because every tuple or object costs a call as much as an iteration; what their entries
mean stands below. There is no random state: an outcome depends on the arguments only, not on other targets or threads.

Every function here is compiled in two versions. Without `memory`, which is None for the default method, the compiler
drops the branches of all others, so the version that most people need compiles and loads in a fraction of the time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.ik.aim import ORIENTATION, POSITION, goal_violation, raw_error, shape_rows
from nao_kin.ik.geometric.sweep import CCD, sweep, sweep_memory
from nao_kin.ik.heading import measure_starts, misses_by, take_nearest, to_shell
from nao_kin.ik.layout import (
    AMOUNT,
    BAD_GOAL,
    BAD_START,
    BUDGET_SPENT,
    CLOSENESS,
    CODE,
    FROM_STORED,
    GAINS,
    GOAL_TOLERANCE,
    ITERATIONS,
    KIND,
    LARGEST_STEP,
    MAX_ITERATIONS,
    MERIT,
    NOT_FINITE,
    OUT_OF_REACH,
    OUTCOME,
    PATIENCE,
    POSITION_ERROR,
    POSITION_TOLERANCE,
    RESTARTS,
    ROTATION_ERROR,
    ROTATION_TOLERANCE,
    RULE,
    SOLVED,
    STALLED,
    START_MOVED,
    STARTS,
    TIP,
    WEIGHTS,
)
from nao_kin.ik.proposing import propose, take_step, weighted_merit
from nao_kin.ik.reference_loop import PATIENCE_ONCE_REACHED, POLISHED, REACHED
from nao_kin.ik.rules import levenberg_marquardt
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.joint_limits import hold, move_inside
from nao_kin.kernels.motion import jacobian, place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats


def scratch_size(joints: Floats, stored: Floats) -> int:
    """Numbers of scratch memory that `solve_one` needs for a chain (m + 1, 16) with stored starts (K, n + 12)."""
    m, n = joints.shape[0] - 1, stored.shape[1] - TIP
    return int(2 * n + 6 * m + TIP + 6 + 6 * n + 6 + 36 + 16 + stored.shape[0])


def memory_size(joints: Floats, n: int) -> int:
    """Numbers of memory that methods other than the default need for a chain (m + 1, 16) of n columns."""
    return max(3 * n, sweep_memory(joints))


@leaf_jit
def solve_one(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    stored: Floats,
    settings: Floats,
    goal: Floats,
    q0: Floats,
    outcome: Floats,
    trace: Floats,
    scratch: Floats,
    memory: Floats | None,
) -> None:
    """Runs starts until one reaches the target or the budget is spent.

    Args:
        joints: The chain (m + 1, 16), see `nao_kin.kernels.motion`.
        limits: Least and greatest joint values (2, n).
        coupled: Coupled limits (k, 7), see `nao_kin.kernels.joint_limits`.
        stored: Stored starts with their tips (K, n + 12), see `nao_kin.ik.starts`.
        settings: What is wanted and how long to try (SETTINGS,).
        goal: The target (4, 4), see `nao_kin.ik.aim`.
        q0: The caller's start (n,).
        outcome: Written (OUTCOME + n,).
        trace: Written, a row (q, position error, rotation error, number of the start) (n + 3,) an iterate, as many as
            iterations and starts together; what does not fit is left out.
        scratch: Memory (`scratch_size`,).
        memory: More of it (`memory_size`,), or None for the default method; see the module.
    """
    if not _begin(limits, coupled, settings, goal, q0, outcome, scratch):
        return
    distances = scratch[scratch.shape[0] - stored.shape[0] :]
    missing = misses_by(settings, goal)
    if missing > 0.0:  # then the nearest place that link lengths allow is what to head for
        near = scratch[scratch.shape[0] - stored.shape[0] - 16 : scratch.shape[0] - stored.shape[0]].reshape(4, 4)
        to_shell(settings, goal, near)
        goal = near
    if settings[FROM_STORED] != 0.0:
        measure_starts(settings, goal, stored, distances)
        take_nearest(stored, distances, scratch)
    code = _descend(joints, limits, coupled, settings, goal, outcome, trace, scratch, memory)
    if code != SOLVED and missing == 0.0 and settings[FROM_STORED] == 0.0:
        measure_starts(settings, goal, stored, distances)
    starts = 1.0 + min(settings[RESTARTS], stored.shape[0] - settings[FROM_STORED])
    while code != SOLVED and missing == 0.0 and outcome[STARTS] < starts:
        take_nearest(stored, distances, scratch)
        again = _descend(joints, limits, coupled, settings, goal, outcome, trace, scratch, memory)
        # One start that was still getting closer is worth a word: a larger budget may help.
        if not (again == STALLED and code == BUDGET_SPENT):
            code = again
    outcome[CODE] = code if missing == 0.0 else OUT_OF_REACH
    outcome[AMOUNT] = missing


@leaf_jit
def solve_quickly(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    stored: Floats,
    settings: Floats,
    goal: Floats,
    q0: Floats,
    work: Floats,
    memory: Floats | None,
) -> None:
    """`solve_one` without a trace: the first OUTCOME + n numbers of `work` receive the outcome, the rest is scratch."""
    size = OUTCOME + q0.shape[0]
    nothing = work[:0].reshape(0, 1)
    solve_one(joints, limits, coupled, stored, settings, goal, q0, work[:size], nothing, work[size:], memory)


@parallel_jit
def solve_many(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    stored: Floats,
    settings: Floats,
    goals: Floats,
    q0: Floats,
    outcomes: Floats,
    scratch_size: int,
    memory: Floats | None,
) -> None:
    """`solve_one` for each goal (N, 4, 4), outcomes (N, OUTCOME + n), from q0 (N, n), or (1, n) for all.

    `memory` says only how much of it a target needs.
    """
    nothing = np.empty((0, 1))
    for i in prange(goals.shape[0]):
        start = q0[np.int64(i) if q0.shape[0] > 1 else 0]
        scratch = np.empty(scratch_size)
        if memory is None:
            solve_one(joints, limits, coupled, stored, settings, goals[i], start, outcomes[i], nothing, scratch, None)
        else:
            own = np.empty(memory.shape[0])
            solve_one(joints, limits, coupled, stored, settings, goals[i], start, outcomes[i], nothing, scratch, own)


@leaf_jit
def _begin(
    limits: Floats, coupled: Floats, settings: Floats, goal: Floats, q0: Floats, outcome: Floats, scratch: Floats
) -> bool:
    """Whether goal and start make sense; the start, moved into the limits, goes to `scratch` and into the outcome."""
    n = q0.shape[0]
    for k in range(OUTCOME):
        outcome[k] = 0.0
    for k in range(n):
        scratch[k] = q0[k] if abs(q0[k]) < math.inf else 0.0
    outcome[START_MOVED] = 1.0 if move_inside(scratch[:n], limits, coupled) else 0.0
    outcome[MERIT] = outcome[POSITION_ERROR] = outcome[ROTATION_ERROR] = math.inf
    for k in range(n):
        outcome[OUTCOME + k] = scratch[k]  # to be returned should no error ever be finite
        if not abs(q0[k]) < math.inf:
            outcome[CODE], outcome[AMOUNT] = BAD_START, k
    violation = goal_violation(int(settings[KIND]), goal)
    if not violation <= settings[GOAL_TOLERANCE]:
        outcome[CODE], outcome[AMOUNT] = BAD_GOAL, violation
    return bool(outcome[CODE] == SOLVED)


@leaf_jit
def _descend(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    settings: Floats,
    goal: Floats,
    outcome: Floats,
    trace: Floats,
    scratch: Floats,
    memory: Floats | None,
) -> int:
    """Iterates from the start in `scratch`; the best joints of all starts go to the outcome. Returns a code."""
    m, n, kind = joints.shape[0] - 1, limits.shape[1], int(settings[KIND])
    q, step = scratch[:n], scratch[n : 2 * n]
    axes, rest = scratch[2 * n : 2 * n + 6 * m].reshape(m, 6), scratch[2 * n + 6 * m :]
    tip, raw, full = rest[:TIP], rest[TIP : TIP + 6], rest[TIP + 6 : TIP + 6 + 6 * n].reshape(6, n)
    rest = rest[TIP + 6 + 6 * n :]
    # The rows that the target binds: those of the position, of the rotation, or all.
    first, last = 3 if kind == ORIENTATION else 0, 3 if kind == POSITION else 6
    rows, e, J = last - first, raw[first:last], full[first:last]
    y, A = rest[:rows], rest[6 : 6 + rows * rows].reshape(rows, rows)
    previous, halved, waited, reached, allowed = math.inf, math.inf, 0, False, int(settings[MAX_ITERATIONS])
    outcome[STARTS] += 1.0
    for iteration in range(allowed + 1):
        place(joints, q, axes, tip)
        raw_error(kind, goal, tip, raw)
        merit, within = _note(settings, q, raw, outcome, trace)
        reached = reached or within
        if reached and (merit <= POLISHED or merit >= previous):
            return SOLVED
        previous, waited = merit, 0 if merit < 0.5 * halved else waited + 1
        halved = merit if waited == 0 else halved
        if waited >= (min(settings[PATIENCE], PATIENCE_ONCE_REACHED) if reached else settings[PATIENCE]):
            return SOLVED if reached else STALLED
        if iteration == allowed:
            break
        if memory is None:
            jacobian(joints, axes, tip, full)
            shape_rows(kind, goal, settings[WEIGHTS : WEIGHTS + 6], tip, raw, full)
            hold(limits, q, e, J)
            levenberg_marquardt(J, e, settings[GAINS:], A, y, step)
        elif settings[RULE] >= CCD:
            sweep(int(settings[RULE]), joints, limits, coupled, kind, goal, settings[CLOSENESS], q, axes, tip, memory)
            outcome[ITERATIONS] += 1.0
            continue
        else:
            propose(joints, limits, coupled, settings, goal, q, step, axes, tip, raw, full, e, J, y, A, memory)
        if not take_step(step, settings[LARGEST_STEP], limits, coupled, q):
            return NOT_FINITE
        outcome[ITERATIONS] += 1.0
    return SOLVED if reached else BUDGET_SPENT


@leaf_jit
def _note(settings: Floats, q: Floats, raw: Floats, outcome: Floats, trace: Floats) -> tuple[float, bool]:
    """Remembers the best joints and the trace; the weighted error in units of its tolerance, and whether within it.

    Whether the target is reached is asked of the errors themselves, on every axis that is not left free.
    """
    n = q.shape[0]
    position, rotation, merit = 0.0, 0.0, weighted_merit(settings, raw)
    for i in range(3):
        position += raw[i] ** 2 if settings[WEIGHTS + i] > 0.0 else 0.0
        rotation += raw[3 + i] ** 2 if settings[WEIGHTS + 3 + i] > 0.0 else 0.0
    position, rotation = math.sqrt(position), math.sqrt(rotation)
    if merit < outcome[MERIT]:
        outcome[MERIT], outcome[POSITION_ERROR], outcome[ROTATION_ERROR] = merit, position, rotation
        for k in range(n):
            outcome[OUTCOME + k] = q[k]
    row = int(outcome[ITERATIONS] + outcome[STARTS]) - 1
    if row < trace.shape[0]:
        for k in range(n):
            trace[row, k] = q[k]
        trace[row, n], trace[row, n + 1], trace[row, n + 2] = position, rotation, outcome[STARTS] - 1.0
    within = position <= REACHED * settings[POSITION_TOLERANCE] and rotation <= REACHED * settings[ROTATION_TOLERANCE]
    return merit, within
