"""The arrays that the compiled loop reads its settings from and writes its outcome to, entry by entry."""

from __future__ import annotations

from typing import Final

from nao_kin.ik.rules import PARAMETERS

# Entries of an outcome (OUTCOME + n,): errors of the best joints [m], [rad], why the run ended, iterations over all
# starts, starts, whether the caller's start was moved into the limits, an amount that belongs to the code, the larger
# error in units of its tolerance; the best joints follow.
POSITION_ERROR, ROTATION_ERROR, CODE, ITERATIONS, STARTS, START_MOVED, AMOUNT, MERIT, OUTCOME = range(9)

# Codes. The amount is by how much the target misses the reach [m], by how much the goal is none (see `goal_violation`),
# or which joint of the start is not finite.
SOLVED, STALLED, BUDGET_SPENT, OUT_OF_REACH, NOT_FINITE, NO_SOLUTION = range(6)
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
