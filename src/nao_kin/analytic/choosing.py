"""`solve(method="closed")`: of all branches the one that is the shortest way from the start."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.analytic.solutions import nearest, solve_all
from nao_kin.chain import configuration, neutral
from nao_kin.ik.problem import IKResult, Run, Status, judge

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.ik.problem import Problem

__all__ = ["solve_closed"]

_TURN = 2.0 * math.pi


def solve_closed(problem: Problem, q0: Any, jump: float | None = None) -> IKResult:
    """The branch within limits whose largest joint move from a start is least; of its whole turns, too.

    Args:
        problem: A chain that a closed form fits, and a target.
        q0: Start (n,) or a posture of the whole robot; None: all zeros, moved inside the limits.
        jump: Largest move of a joint from there [rad or m]; None: any.

    Returns:
        That branch; without one within the limits the nearest one outside, which says so; without any the start, with
        `Status.OUT_OF_REACH`.

    Raises:
        InvalidInputError: No closed form fits the chain, or solves such a target; the message says what was measured.
    """
    chain = problem.chain
    given = neutral(chain) if q0 is None else chain.q_of(q0) if hasattr(q0, "keys") else configuration(chain, q0)
    start = np.clip(given, chain.lower, chain.upper)
    run = Run(start.copy(), Status.OUT_OF_REACH, start_moved=bool((start != given).any()))
    if jump is not None:
        run.start, run.jump = given, jump
    found = solve_all(chain, problem.target, tolerances=problem.tolerances)
    if not found:
        return judge(problem, run)
    best = nearest(found, given)
    q = _wound_towards(chain, best.q, given, problem.tolerances.limits)
    return judge(problem, replace(run, q=q, ended=Status.SOLVED, branch=best.branch))


def _wound_towards(chain: Any, q: Floats, start: Floats, tolerance: float) -> Floats:
    """The joints moved by whole turns as near to a start as their limits let them."""
    wound = q.copy()
    for k, joint in enumerate(chain.joints):
        if joint.kind == "prismatic":
            continue
        turns = round((start[k] - q[k]) / _TURN)
        lowest = math.ceil((chain.lower[k] - tolerance - q[k]) / _TURN) if math.isfinite(chain.lower[k]) else turns
        highest = math.floor((chain.upper[k] + tolerance - q[k]) / _TURN) if math.isfinite(chain.upper[k]) else turns
        if lowest <= highest:
            wound[k] = q[k] + _TURN * min(max(turns, lowest), highest)
    return wound
