"""Every solution of a closed form, judged one by one, and which of them is nearest."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from nao_kin.analytic.certifying import BESIDE, MEETS, SAME, placed
from nao_kin.analytic.form import GOALS
from nao_kin.analytic.matching import Matched, matched
from nao_kin.chain import configuration, value_unit
from nao_kin.errors import InvalidInputError
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.target import Target, TargetLike
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["Solutions", "error_of", "judged", "nearest", "slack_of", "solve_all", "sorted_out"]

_FEW: Final = 4  # solutions whose joints a terminal has room for with all their digits
_TURN: Final = 2.0 * math.pi
_MOST_TURNS: Final = 1000.0  # a range wider than this is a file's way to say that there is no limit
_REACHED: Final = (Status.SOLVED, Status.OUTSIDE_LIMITS)


class Solutions(tuple[IKResult, ...]):
    """Every solution of a target, each measured by the judge, with its branch; those outside the limits say so.

    Attributes:
        reason: Why none is within the limits, a sentence; empty if one is.
    """

    reason: str

    def __new__(cls, results: Iterable[IKResult], reason: str = "") -> Self:
        """From judged results."""
        made = super().__new__(cls, results)
        made.reason = reason
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return tuple(self), self.reason

    @property
    def solved(self) -> Solutions:
        """Those within tolerance and limits."""
        return Solutions((result for result in self if result.solved), self.reason)

    def __repr__(self) -> str:
        lines = [f"<{len(self)} solutions{': ' + self.reason if self.reason else ''}"]
        return "\n  ".join([*lines, *(f"{result.branch or 'the only one'}: {result!r}" for result in self)]) + ">"

    def table(self, title: str = "") -> Table:
        """One column a solution, with its joints' values; below, the status and branch of each."""
        joints = self[0].problem.chain.joints if self else ()
        names = tuple(joint.name for joint in joints)
        columns = (
            Column(f"joint [{value_unit(joints)}]"),
            *(Column(f"#{i + 1}", number=True) for i in range(len(self))),
        )
        digits = 6 if len(self) <= _FEW else 4
        shown = [np.round(result.q, digits) + 0.0 for result in self]  # rounding's −0 is 0
        rows = tuple((name, *(f"{q[k]:.{digits}f}" for q in shown)) for k, name in enumerate(names))
        told = [f"#{i + 1} {r.status.name}: {r.branch or 'the only one'}." for i, r in enumerate(self)]
        return Table(columns, rows, title=title, note="\n".join([*told, self.reason]).strip())

    def _repr_html_(self) -> str:
        chain = f" of {self[0].problem.chain.name}" if self else ""
        return self.table(f"{len(self)} solutions{chain}, {len(self.solved)} within limits")._repr_html_()


def solve_all(
    chain: Chain,
    target: TargetLike,
    *,
    locked: Mapping[str, float] | None = None,
    redundancy: str | None = None,
    samples: int = 64,
    tolerances: Tolerances = TOLERANCES,
    windings: bool = False,
) -> Solutions:
    """Every joint vector that brings the tip to a target, by closed form, each measured before it is returned.

    Which closed form it is, is found by measuring the chain. What it can be asked depends on the form: a NAO's arm of
    five joints takes a pose, a position with elbow yaw and wrist yaw locked, or a position with a pointing axis.

    Args:
        chain: The chain.
        target: T_base_target as a `pin.SE3` or (4, 4) matrix, a position (3,) [m], or a `Target`.
        locked: Values of joints by name [rad or m], for what the target leaves free or a chain has too many of.
        redundancy: A joint that the target leaves free, as an arm of seven has one: its self-motion is sampled, and
            each branch says the joint's value.
        samples: How many values of that joint, over its range or one turn.
        tolerances: When the target counts as reached, and how far a joint may be outside its range.
        windings: Return every whole turn of a solution that its limits allow, and not only the middle one.

    Returns:
        The solutions, those within limits first; the others have `Status.OUTSIDE_LIMITS`. At a singularity, where there
        are endlessly many, one stands for them all and its branch says which joint is free. Empty if none reaches the
        target: ``reason`` then says by how much the nearest branch misses.

    Raises:
        InvalidInputError: Not a target, or no closed form fits; the message says what was measured and what to do. Or
            fewer than two samples, or a free joint that slides without limits or is locked.
        UnknownNameError: A locked or free joint is not one of the chain; carries near matches.
    """
    wanted = Target.of(target)
    if redundancy is not None:
        from nao_kin.analytic.redundancy import self_motion  # it solves for each value by this function

        found_there = self_motion(
            chain,
            wanted,
            redundancy=redundancy,
            samples=samples,
            locked=locked,
            tolerances=tolerances,
            windings=windings,
        )
        swept = [
            _labelled(result, f"{redundancy} at {sample.value:.6g}")
            for sample in found_there
            for result in sample.solutions
        ]
        return _swept(swept, redundancy)
    problem = Problem(chain, wanted, tolerances)
    found = matched(chain, wanted, locked)
    if len(found.given) != 1:
        raise InvalidInputError("locked", "one number a joint; nao_kin.solve_all_batch takes arrays", "an array")
    solutions = sorted_out(judged(found, problem, slack_of(tolerances), windings=windings))
    if not solutions:
        solutions.reason = _miss(list(judged(found, problem, math.inf)))
    return solutions


def _labelled(result: IKResult, words: str) -> IKResult:
    """The result with further words in its branch."""
    branch = ", ".join(part for part in (result.branch, words) if part)
    return replace(result, run=replace(result.run, branch=branch))


def _swept(results: list[IKResult], redundancy: str) -> Solutions:
    """The solutions of all samples of a free joint, those within the limits first."""
    results.sort(key=lambda result: not result.solved)
    if not results:
        return Solutions((), f"No sample of {redundancy} has a solution.")
    return Solutions(results, "" if results[0].solved else "Every solution is outside the limits.")


def sorted_out(results: Iterable[IKResult]) -> Solutions:
    """Judged results without those that miss and without repetitions, those within the limits first."""
    good = sorted(_kept(results), key=lambda result: not result.solved)
    return Solutions(good, "" if not good or good[0].solved else "Every solution is outside the limits.")


def slack_of(tolerances: Tolerances) -> float:
    """How far beyond the border a kernel is to look [m]: a bit more than what the judge might accept."""
    return 2.0 * (tolerances.position + tolerances.rotation) + 1e-12


def judged(found: Matched, problem: Problem, slack: float, *, windings: bool = False) -> Iterator[IKResult]:
    """What a closed form writes for a problem, each measured by the judge; a slack [m] for branches at the border."""
    form, n = found.form, found.form.joints
    rows = np.empty((found.request.branches, n + 2))
    goal = np.ascontiguousarray(problem.target.goal)
    count = form.solve(found.geometry.parameters, GOALS[found.kind], goal, found.given[0], slack, rows)
    for row in rows[:count]:
        q = found.template.copy()
        q[list(found.columns)] = row[:n]
        label, singular = form.label(int(row[n]), int(row[n + 1])), bool(row[n + 1])
        inside = placed(q, found.ranges)
        for wound in _windings(problem.chain, inside, problem.tolerances.limits) if windings else [inside]:
            yield judge(problem, Run(wound, Status.SOLVED, branch=label, singular=singular))


def _windings(chain: Chain, q: Floats, tolerance: float) -> Iterator[Floats]:
    """Every whole turn of the joints that is within limits; a joint that no turn brings inside, or without, stays."""
    choices = []
    for k, joint in enumerate(chain.joints):
        lower, upper = chain.lower[k] - tolerance, chain.upper[k] + tolerance
        if joint.kind == "prismatic" or not upper - lower < _MOST_TURNS * _TURN:
            choices.append([q[k]])
            continue
        first, last = math.ceil((lower - q[k]) / _TURN), math.floor((upper - q[k]) / _TURN)
        choices.append([q[k] + turn * _TURN for turn in range(first, last + 1)] or [q[k]])
    for values in itertools.product(*choices):
        yield np.array(values)


def _kept(results: Iterable[IKResult]) -> list[IKResult]:
    """The results that reach their target, each once.

    Of a goal with more conditions than joints, a branch that just misses while another one meets is not a solution,
    though it may be within tolerance. Where there are joints enough, one that stands for others is one all the same:
    a member of a continuum that a rounded target has left by less than the tolerance.
    """
    reached = [result for result in results if result.status in _REACHED]
    bound = max(MEETS, 1e3 * min((error_of(result) for result in reached), default=0.0))
    good: list[IKResult] = []
    for result in reached:
        meets = error_of(result) <= bound
        if not meets and result.run.singular and not _is_overdetermined(result):
            exact = (other for other in reached if error_of(other) <= bound)
            meets = all(np.abs(result.q - other.q).max() > BESIDE for other in exact)
        if meets and not any(np.abs(result.q - other.q).max() <= SAME for other in good):
            good.append(result)
    return good


def _is_overdetermined(result: IKResult) -> bool:
    """Whether the target binds more than there are joints."""
    return conditions(result.problem.target) > len(result.problem.chain.joints)


def conditions(target: Target) -> int:
    """How many numbers a target binds."""
    return target.counts.bit_count() - (target.kind == "pointing")


def error_of(result: IKResult) -> float:
    """The larger of the errors that the target does not leave free [m, rad]."""
    return max(result.position_error or 0.0, result.rotation_error or 0.0)


def _miss(border: Sequence[IKResult]) -> str:
    if not border:
        return "The closed form has no branch for this target."
    best = min(border, key=error_of)
    parts = [] if best.position_error is None else [f"{best.position_error:.3g} m"]
    parts += [] if best.rotation_error is None else [f"{best.rotation_error:.3g} rad"]
    return f"No joints reach the target: the nearest of the closed form's branches misses by {' and '.join(parts)}."


def nearest(results: Iterable[IKResult], q: ArrayLike) -> IKResult:
    """The solution whose largest joint move from q is least.

    Whole turns count, since a joint with limits has to make them; only of a joint that turns without limits they do
    not. With ``windings=True`` of `solve_all` every turn that the limits allow is among the results. Only solutions
    within limits are compared. If there is none, the others are, and the result's status says so.

    Args:
        results: What `solve_all` returned.
        q: Joints to come from (n,) [rad or m].

    Returns:
        One of the results, as it is.

    Raises:
        InvalidInputError: No result at all, or q of a wrong length or not finite.
    """
    every = list(results)
    if not every:
        reason = getattr(results, "reason", "") or "none"
        raise InvalidInputError("results", "at least one solution", reason.rstrip("."))
    chain = every[0].problem.chain
    start = configuration(chain, q)
    endless = np.isinf(chain.lower) & np.isinf(chain.upper) & [joint.kind != "prismatic" for joint in chain.joints]

    def largest_move(result: IKResult) -> float:
        move = result.q - start
        return float(np.abs(np.where(endless, np.remainder(move + math.pi, _TURN) - math.pi, move)).max())

    return min([result for result in every if result.solved] or every, key=largest_move)
