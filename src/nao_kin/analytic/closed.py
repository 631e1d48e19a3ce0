"""One solution by closed form: of all branches within limits, the one nearest to where the joints are."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from nao_kin.analytic.certifying import ABSENT, SOLVED
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.solution_batch import certified
from nao_kin.analytic.solutions import error_of, judged, slack_of, sorted_out
from nao_kin.arrays import positive
from nao_kin.chain import configuration, into_limits, neutral
from nao_kin.errors import InvalidInputError
from nao_kin.ik import compiled_loop as loop
from nao_kin.ik.batch import CHUNK, BatchResult, Wanted, audit_batch, judge_rows, starts_of
from nao_kin.ik.measure import measure_many
from nao_kin.ik.methods import METHODS
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.single import solve
from nao_kin.ik.target import KINDS, Target, TargetLike
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["solve_closed", "solve_closed_batch"]

_TURN: Final = 2.0 * math.pi
_EQUAL: Final = 1e-9
_NEARBY: Final = Budget(restarts=0)
_ANY: Final = 1e300  # tolerances [m, rad] that the nearest branch is within, wherever it is


def solve_closed(
    chain: Chain,
    target: TargetLike,
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    tolerances: Tolerances = TOLERANCES,
    jump: float | None = None,
) -> IKResult:
    """The solution within limits whose largest joint move from q0 is least, whole turns chosen likewise.

    Args:
        chain: A chain with a closed form.
        target: As `nao_kin.solve` takes it.
        q0: Where the joints are (n,), or a posture; by default all zeros, moved inside the limits.
        tolerances: When the target counts as reached.
        jump: Largest move of a joint from q0 [rad or m]; a solution that needs more is `Status.JUMPED`.

    Returns:
        The solution; the nearest one outside the limits if there is none inside; and if no branch reaches the target,
        the joints of the branch that misses least, as `Status.NO_SOLUTION` or, where it is proven, `OUT_OF_REACH`.

    Raises:
        InvalidInputError: Not a target, or none for a closed form of this chain; names the methods that take it.
        UnknownNameError: The start names a joint that does not exist; carries near matches.
    """
    problem = Problem(chain, Target.of(target), tolerances)
    found = _form(chain, problem.target)
    start = _start(chain, q0)
    allowed = math.inf if jump is None else positive(jump, "jump", "[rad or m]", endless=True)
    solutions = sorted_out(judged(found, problem, slack_of(tolerances)))
    if not solutions:
        return _nearest_miss(found, problem, start)
    every = solutions.solved or solutions
    q = _wound(chain, np.array([result.q for result in every]), start, tolerances.limits)
    best = int(_nearest(q, start))
    run = Run(q[best], Status.SOLVED, branch=every[best].branch)
    if any(result.run.singular for result in every) or judge(problem, Run(start.copy(), Status.SOLVED)).solved:
        run.q = _nearer_member(problem, start, q[best])
    return judge(problem, run if jump is None else replace(run, start=start, jump=allowed))


def solve_closed_batch(
    chain: Chain,
    targets: ArrayLike | Sequence[Target],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    tolerances: Tolerances = TOLERANCES,
    seed: int = 0,
    audit: Literal["sample", "all"] = "sample",
) -> BatchResult:
    """`solve_closed` for many targets; see `nao_kin.solve_batch` for the arguments.

    Raises:
        InvalidInputError: Wrong shapes, not finite, not rigid (the row is named), mixed kinds, or no closed form.
        UnknownNameError: The start names a joint that does not exist; carries near matches.
        AuditError: Two forward kinematics disagree: a defect of this package or of the machine.
    """
    wanted = Wanted.of(targets)
    found = _form(chain, wanted.first)
    starts = starts_of(chain, q0, len(wanted.given), neutral(chain))
    result = BatchResult.blank(chain, len(wanted.given))
    for first in range(0, len(result), CHUNK):
        chunk = slice(first, min(first + CHUNK, len(result)))
        outcomes = _outcomes(chain, found, wanted, chunk, starts[chunk] if len(starts) > 1 else starts, tolerances)
        judge_rows(wanted.first, tolerances, wanted.goals(chunk), outcomes, result, chunk)
    audit_batch(result, wanted, tolerances, seed, everything=audit == "all")
    return result


def _form(chain: Chain, target: Target) -> Matched:
    """The closed form; without one, an error that says which methods do without."""
    try:
        found = matched(chain, target)
    except InvalidInputError as error:
        if not hasattr(chain, "joint_path"):
            raise
        able = ", ".join(name for name, row in METHODS.items() if row.refusal(chain, target) is None)
        expected = f"a chain and a target that a closed form solves; methods that take these: {able}"
        told = f"{error.what}: {error.got.removesuffix('. nao_kin.solve takes any chain')}; wanted {error.expected}"
        raise InvalidInputError("method 'closed'", expected, told) from None
    return found


def _start(chain: Chain, q0: ArrayLike | Mapping[str, float] | None) -> Floats:
    if q0 is None:
        return neutral(chain)
    return chain.q_of(q0) if isinstance(q0, Mapping) else configuration(chain, q0)


def _wound(chain: Chain, Q: Floats, start: Floats, tolerance: float) -> Floats:
    """Joints (…, n), those that turn moved by whole turns to as near to the start as their own limits let them."""
    with np.errstate(invalid="ignore"):  # NaN where there is no solution
        fewest = np.ceil((chain.lower - tolerance - Q) / _TURN)
        most = np.floor((chain.upper + tolerance - Q) / _TURN)
        turns = np.clip(np.round((start - Q) / _TURN), fewest, most)
    turning = np.array([joint.kind != "prismatic" for joint in chain.joints])
    return np.asarray(Q + np.where(turning & (fewest <= most), turns, 0.0) * _TURN)


def _nearest(q: Floats, start: Floats, candidates: NDArray[np.bool_] | bool = True) -> NDArray[np.intp]:
    """Which of the joints (…, B, n) has the least largest move from the start, of the candidates (…, B)."""
    with np.errstate(invalid="ignore"):
        moves = np.where(candidates, np.abs(q - start).max(axis=-1), np.inf)
    return np.asarray(moves.argmin(axis=-1))


def _stands_there(
    chain: Chain, wanted: Wanted, rows: slice, starts: Floats, tolerances: Tolerances
) -> NDArray[np.bool_]:
    """Whether each start (N, n), or (1, n) for all, is at its target already (N,)."""
    goals = wanted.goals(rows)
    T = np.broadcast_to(chain.poses(starts), (len(goals), 4, 4))
    position, rotation = measure_many(KINDS[wanted.first.kind], goals, wanted.first.counts, T)
    return np.asarray(~((position > tolerances.position) | (rotation > tolerances.rotation)))


def _nearer_member(problem: Problem, start: Floats, found: Floats) -> Floats:
    """The joints found (n,), or nearer ones of a continuum that a branch only stands for: where steps from q0 lead."""
    near = solve(problem.chain, problem.target, start, tolerances=problem.tolerances, budget=_NEARBY)
    return near.q.copy() if near.solved and np.abs(near.q - start).max() < np.abs(found - start).max() else found


def _least(errors: Floats) -> NDArray[np.bool_]:
    """The least of the errors (…, B) and its equals up to rounding, as those of a branch and its mirror image are."""
    return np.asarray(errors <= errors.min(axis=-1, keepdims=True) * (1.0 + _EQUAL) + _EQUAL * _EQUAL)


def _nearest_miss(found: Matched, problem: Problem, start: Floats) -> IKResult:
    """The result where no branch reaches the target."""
    border, q = list(judged(found, problem, math.inf)), into_limits(problem.chain, start)
    if border:
        every = _wound(problem.chain, np.array([result.q for result in border]), start, problem.tolerances.limits)
        q = every[_nearest(every, start, _least(np.array([error_of(result) for result in border])))].copy()
    miss = _misses_by(problem.chain, problem.target, problem.target.goal)
    return judge(problem, Run(q, Status.OUT_OF_REACH if miss else Status.NO_SOLUTION, misses_by=miss))


def _misses_by(chain: Chain, target: Target, goal: Floats) -> float:
    """By how much at least the goal is out of reach [m]; 0 where that is not proven or its place does not count."""
    return reach_shell(chain).misses_by(goal[:3, 3]) if target.counts & 7 == 7 else 0.0


def _outcomes(
    chain: Chain, found: Matched, wanted: Wanted, rows: slice, starts: Floats, tolerances: Tolerances
) -> Floats:
    """Rows (N, OUTCOME + n) as the compiled loop writes them; what they claim is for the judge."""
    every = certified(chain, found, wanted, rows, tolerances, slack_of(tolerances))
    outcomes = np.zeros((len(every.q), loop.OUTCOME + len(chain.joints)))
    q = _wound(chain, every.q, starts[:, None, :], tolerances.limits)
    present, within = every.codes != ABSENT, every.codes == SOLVED
    candidates = within | (present & ~within.any(axis=1, keepdims=True))
    outcomes[:, loop.OUTCOME :] = q[np.arange(len(q)), _nearest(q, starts[:, None, :], candidates)]
    there = _stands_there(chain, wanted, rows, starts, tolerances) | (every.branches[:, :, 1] != 0).any(axis=1)
    for i in np.flatnonzero(there & present.any(axis=1)):
        goal = Target(
            wanted.first.kind, wanted.goals(slice(rows.start + i, rows.start + i + 1))[0], wanted.first.weights
        )
        own = starts[i if len(starts) > 1 else 0]
        best = outcomes[i, loop.OUTCOME :].copy()
        outcomes[i, loop.OUTCOME :] = _nearer_member(Problem(chain, goal, tolerances), own, best)
    missed = np.flatnonzero(~present.any(axis=1))
    if len(missed):
        given = wanted.given[rows][missed]
        own = starts[missed] if len(starts) > 1 else starts
        outcomes[missed] = _misses(chain, found, Wanted(wanted.first, given), own, tolerances)
    return outcomes


def _misses(chain: Chain, found: Matched, wanted: Wanted, starts: Floats, tolerances: Tolerances) -> Floats:
    """`_nearest_miss` for many targets (N, OUTCOME + n)."""
    N = len(wanted.given)
    border = certified(chain, found, wanted, slice(0, N), replace(tolerances, position=_ANY, rotation=_ANY), math.inf)
    errors = np.fmax(np.nan_to_num(border.position_error), np.nan_to_num(border.rotation_error))
    errors = np.where(border.codes != ABSENT, errors, np.inf)
    outcomes = np.zeros((N, loop.OUTCOME + len(chain.joints)))
    q = _wound(chain, border.q, starts[:, None, :], tolerances.limits)
    outcomes[:, loop.OUTCOME :] = q[np.arange(N), _nearest(q, starts[:, None, :], _least(errors))]
    for i in np.flatnonzero(np.isinf(errors).all(axis=1)):
        outcomes[i, loop.OUTCOME :] = into_limits(chain, starts[i if len(starts) > 1 else 0])
    for row, goal in zip(outcomes, wanted.goals(slice(0, N)), strict=True):
        row[loop.AMOUNT] = _misses_by(chain, wanted.first, goal)
        row[loop.CODE] = loop.OUT_OF_REACH if row[loop.AMOUNT] else loop.NO_SOLUTION
    return outcomes
