"""The compiled loop, top to bottom: `nao_kin.ik.reference_loop` is its readable twin, the same iteration in Python.

Python hands over plain arrays, because every tuple or object costs a call as much as an iteration; what their entries
mean stands below, and inside they become named tuples once. There is no random state: an outcome depends on the
arguments only, not on other targets or threads.

Every function here is compiled in two versions. Without `memory`, which is None for the default method, the compiler
drops the branches of all others, so the version that most people need compiles and loads in a fraction of the time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from nao_kin.ik.aim import ORIENTATION, POINTING, POSITION, SweepGoal, goal_violation, raw_error, shape_rows
from nao_kin.ik.geometric.sweep import CCD, sweep, sweep_memory
from nao_kin.ik.orientation import recast_rows
from nao_kin.ik.problem import Status
from nao_kin.ik.rules import PARAMETERS, levenberg_marquardt, update
from nao_kin.ik.stopping import REACHED, gives_up, improved, is_polished, step_scale
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.joint_limits import hold, move_inside
from nao_kin.kernels.motion import Arm, At, jacobian, place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

# Entries of an outcome (OUTCOME + n,): errors of the best joints [m], [rad], why the run ended, iterations over all
# starts, starts, whether the caller's start was moved into the limits, an amount that belongs to the code, the larger
# error in units of its tolerance; the best joints follow.
POSITION_ERROR, ROTATION_ERROR, CODE, ITERATIONS, STARTS, START_MOVED, AMOUNT, MERIT, OUTCOME = range(9)

# Codes: the numbers of `Status`, or below 0 where nothing was tried. The amount is by how much the target misses the
# reach [m], by how much the goal is none (see `goal_violation`), or which joint of the start is not finite.
SOLVED, STALLED, BUDGET_SPENT, OUT_OF_REACH, NOT_FINITE, NO_SOLUTION = (
    Status.SOLVED.number,
    Status.STALLED.number,
    Status.BUDGET_SPENT.number,
    Status.OUT_OF_REACH.number,
    Status.NOT_FINITE.number,
    Status.NO_SOLUTION.number,
)
BAD_GOAL, BAD_START = -1, -2

# Entries of the settings (SETTINGS,): kind of target, update rule, the budget's four, whether the first start is the
# nearest stored one instead of the caller's, tolerances [m], [rad], largest violation of a goal that is still
# one, closeness of the stored starts [1/m²], reach shell (centre (3), least and greatest distance) [m], weight of each
# base axis (6), form of the orientation error, parameters of the rule (see `nao_kin.ik.rules`).
KIND, RULE, MAX_ITERATIONS, RESTARTS, PATIENCE, LARGEST_STEP, FROM_STORED = range(7)
POSITION_TOLERANCE, ROTATION_TOLERANCE, GOAL_TOLERANCE, CLOSENESS, CENTRE, INNER, OUTER = 7, 8, 9, 10, 11, 14, 15
WEIGHTS, ORIENTATION_ERROR, GAINS = 16, 22, 23
SETTINGS: Final = GAINS + PARAMETERS

TIP: Final = 12
"""Numbers of a pose: rotation row by row, translation [m]."""


class Rows(NamedTuple):
    """Error and Jacobian of one iterate, and the memory of a rule.

    Attributes:
        raw: What is missing (6,) = (linear [m]; rotation vector [rad]), base axes.
        full: Frame Jacobian (6, n).
        e: The entries of `raw` that the target binds (r,).
        J: The rows of `full` that it binds (r, n).
        y: Scratch (r,).
        A: Scratch (r, r).
    """

    raw: Floats
    full: Floats
    e: Floats
    J: Floats
    y: Floats
    A: Floats


@leaf_jit
def scratch_size(joints: Floats, stored: Floats) -> int:
    """Numbers of scratch memory that `solve_one` needs for a chain (m + 1, 16) with stored starts (K, n + 12)."""
    m, n = joints.shape[0] - 1, stored.shape[1] - TIP
    size: int = 2 * n + 6 * m + TIP + 6 + 6 * n + 6 + 36 + 16 + stored.shape[0]
    return size


def memory_size(joints: Floats, n: int) -> int:
    """Numbers of memory that methods other than the default need for a chain (m + 1, 16) of n columns."""
    return max(3 * n, sweep_memory(joints))


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
    arm = Arm(joints, limits, coupled)
    solve_one(arm, stored, settings, goal, q0, work[:size], nothing, work[size:], memory)


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
    memory: Floats | None,
) -> None:
    """`solve_one` for each goal (N, 4, 4), outcomes (N, OUTCOME + n), from q0 (N, n), or (1, n) for all.

    `memory` says only how much of it a target needs.
    """
    nothing, size = np.empty((0, 1)), scratch_size(joints, stored)
    for i in prange(goals.shape[0]):
        start = q0[np.int64(i) if q0.shape[0] > 1 else 0]
        arm, scratch = Arm(joints, limits, coupled), np.empty(size)
        if memory is None:
            solve_one(arm, stored, settings, goals[i], start, outcomes[i], nothing, scratch, None)
        else:
            own = np.empty(memory.shape[0])
            solve_one(arm, stored, settings, goals[i], start, outcomes[i], nothing, scratch, own)


@leaf_jit
def solve_one(
    arm: Arm,
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
        arm: The chain.
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
    if not _begin(arm, settings, goal, q0, outcome, scratch):
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
    code = _descend(arm, settings, goal, outcome, trace, scratch, memory)
    if code != SOLVED and missing == 0.0 and settings[FROM_STORED] == 0.0:
        measure_starts(settings, goal, stored, distances)
    starts = 1.0 + min(settings[RESTARTS], stored.shape[0] - settings[FROM_STORED])
    while code != SOLVED and missing == 0.0 and outcome[STARTS] < starts:
        take_nearest(stored, distances, scratch)
        again = _descend(arm, settings, goal, outcome, trace, scratch, memory)
        # One start that was still getting closer is worth a word: a larger budget may help.
        if not (again == STALLED and code == BUDGET_SPENT):
            code = again
    outcome[CODE] = code if missing == 0.0 else OUT_OF_REACH
    outcome[AMOUNT] = missing


@leaf_jit
def _begin(arm: Arm, settings: Floats, goal: Floats, q0: Floats, outcome: Floats, scratch: Floats) -> bool:
    """Whether goal and start make sense; the start, moved into the limits, goes to `scratch` and into the outcome."""
    n = q0.shape[0]
    for k in range(OUTCOME):
        outcome[k] = 0.0
    for k in range(n):
        scratch[k] = q0[k] if abs(q0[k]) < math.inf else 0.0
    outcome[START_MOVED] = 1.0 if move_inside(scratch[:n], arm.limits, arm.coupled) else 0.0
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
def measure_starts(settings: Floats, goal: Floats, stored: Floats, distances: Floats) -> None:
    """How far the tip of each stored start (K, n + 12) is from the goal, in what the kind binds."""
    n, kind, closeness = stored.shape[1] - TIP, int(settings[KIND]), settings[CLOSENESS]
    for k in range(stored.shape[0]):
        total = 0.0
        if kind != ORIENTATION:
            for i in range(3):
                total += closeness * (stored[k, n + 9 + i] - goal[i, 3]) ** 2
        if kind not in (POSITION, POINTING):
            for i in range(3):
                for j in range(3):
                    total += (stored[k, n + 3 * i + j] - goal[i, j]) ** 2
        distances[k] = total


@leaf_jit
def take_nearest(stored: Floats, distances: Floats, scratch: Floats) -> None:
    """Puts the nearest start not taken before to the front of the scratch memory."""
    nearest = 0
    for k in range(1, distances.shape[0]):
        if distances[k] < distances[nearest]:
            nearest = k
    distances[nearest] = math.inf
    for k in range(stored.shape[1] - TIP):
        scratch[k] = stored[nearest, k]


@leaf_jit
def misses_by(settings: Floats, goal: Floats) -> float:
    """A distance by which the goal certainly misses the reach [m]; 0 within tolerance, or where nothing is proven."""
    if settings[KIND] == ORIENTATION:
        return 0.0
    for i in range(3):
        if settings[WEIGHTS + i] == 0.0:
            return 0.0
    distance = _from_centre(settings, goal)
    beyond = max(distance - settings[OUTER], settings[INNER] - distance)
    return beyond if beyond > settings[POSITION_TOLERANCE] else 0.0


@leaf_jit
def to_shell(settings: Floats, goal: Floats, near: Floats) -> None:
    """Writes the goal, its position moved to the nearest point of the reach shell."""
    distance = _from_centre(settings, goal)
    scale = min(max(distance, settings[INNER]), settings[OUTER]) / distance if distance > 0.0 else 0.0
    for i in range(4):
        for j in range(4):
            near[i, j] = goal[i, j]
    for i in range(3):
        near[i, 3] = settings[CENTRE + i] + scale * (goal[i, 3] - settings[CENTRE + i])
    if distance == 0.0:
        near[0, 3] += settings[INNER]


@leaf_jit
def _from_centre(settings: Floats, goal: Floats) -> float:
    """Distance of the goal from the centre of the shell [m], which does not overflow where its square would."""
    x, y, z = goal[0, 3] - settings[CENTRE], goal[1, 3] - settings[CENTRE + 1], goal[2, 3] - settings[CENTRE + 2]
    largest = max(abs(x), abs(y), abs(z))
    if largest == 0.0:
        return 0.0
    x, y, z = x / largest, y / largest, z / largest
    distance: float = largest * math.sqrt(x * x + y * y + z * z)
    return distance


@leaf_jit
def _descend(
    arm: Arm,
    settings: Floats,
    goal: Floats,
    outcome: Floats,
    trace: Floats,
    scratch: Floats,
    memory: Floats | None,
) -> int:
    """Iterates from the start in `scratch`; the best joints of all starts go to the outcome. Returns a code."""
    joints, limits, coupled = arm
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
        if reached and is_polished(merit, previous):
            return SOLVED
        previous, waited = merit, 0 if improved(merit, halved) else waited + 1
        halved = merit if waited == 0 else halved
        if gives_up(waited, settings[PATIENCE], reached):
            return SOLVED if reached else STALLED
        if iteration == allowed:
            break
        if memory is None:
            jacobian(joints, axes, tip, full)
            shape_rows(kind, goal, settings[WEIGHTS : WEIGHTS + 6], tip, raw, full)
            hold(limits, q, e, J)
            levenberg_marquardt(J, e, settings[GAINS:], A, y, step)
        elif settings[RULE] >= CCD:
            sweep(int(settings[RULE]), arm, SweepGoal(kind, goal, settings[CLOSENESS]), At(q, axes, tip), memory)
            outcome[ITERATIONS] += 1.0
            continue
        else:
            propose(arm, settings, goal, At(q, axes, tip), Rows(raw, full, e, J, y, A), step, memory)
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


@leaf_jit
def propose(arm: Arm, settings: Floats, goal: Floats, at: At, rows: Rows, step: Floats, memory: Floats) -> None:
    """Writes the step of any update rule; the default one has its own lines in `_descend`."""
    n = at.q.shape[0]
    jacobian(arm.joints, at.axes, at.tip, rows.full)
    recast_rows(int(settings[ORIENTATION_ERROR]), goal, at.tip, rows.raw, rows.full)
    shape_rows(int(settings[KIND]), goal, settings[WEIGHTS : WEIGHTS + 6], at.tip, rows.raw, rows.full)
    hold(arm.limits, at.q, rows.e, rows.J)
    steps = memory[: 2 * n].reshape(2, n)
    if update(int(settings[RULE]), rows.J, rows.e, settings[GAINS:], rows.A, rows.y, steps) == 2:
        _keep_better(arm, settings, goal, at, steps, memory[2 * n : 3 * n], rows.raw)
    for k in range(n):
        step[k] = steps[0, k]


@leaf_jit
def _keep_better(arm: Arm, settings: Floats, goal: Floats, at: At, steps: Floats, trial: Floats, raw: Floats) -> None:
    """Puts that row of `steps` (2, n) first which leads closer; `trial`, `raw`, axes and tip are scratch."""
    least = math.inf
    for row in range(2):
        for k in range(at.q.shape[0]):
            trial[k] = at.q[k]
        if take_step(steps[row], settings[LARGEST_STEP], arm.limits, arm.coupled, trial):
            place(arm.joints, trial, at.axes, at.tip)
            raw_error(int(settings[KIND]), goal, at.tip, raw)
            merit = weighted_merit(settings, raw)
            if merit < least:
                least = merit
                for k in range(at.q.shape[0]):
                    steps[0, k] = steps[row, k]


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
    scale = step_scale(largest, largest_step)
    for k in range(q.shape[0]):
        q[k] += scale * step[k]
    move_inside(q, limits, coupled)
    return True


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
