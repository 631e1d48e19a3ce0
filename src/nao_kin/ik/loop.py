"""The reference loop: iterate an update rule on any object that offers `pose` and `jacobian`, limits inside."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.chain import into_limits, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.problem import Problem, Run, Status, Trace
from nao_kin.ik.reach import reach_shell

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats

    UpdateRule = Callable[[Floats, Floats], Floats]

__all__ = ["Budget", "run_reference"]


@dataclass(frozen=True, slots=True)
class Budget:
    """How long a solver may try.

    Attributes:
        iterations: Iterations of one start.
        restarts: Further starts, at random configurations inside the limits, after the caller's.
        patience: A start is given up after this many iterations that have not halved its error.
        largest_step: Joint steps are scaled down to this [rad or m].

    Raises:
        InvalidInputError: A count is no integer or too small, or the step is not positive.
    """

    iterations: int = 200
    restarts: int = 40
    patience: int = 8
    largest_step: float = 1.0

    def __post_init__(self) -> None:
        for name, least in (("iterations", 0), ("restarts", 0), ("patience", 1)):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or value < least:
                raise InvalidInputError(f"budget, {name}", f"an integer ≥ {least}", repr(value))
        if not 0.0 < self.largest_step < math.inf:
            raise InvalidInputError("budget, largest_step", "a finite number > 0", repr(self.largest_step))


def run_reference(
    problem: Problem, rule: UpdateRule, q0: Floats, budget: Budget, rng: np.random.Generator, keep_trace: bool = False
) -> Run:
    """Runs starts until one reaches the target or the budget is spent, and returns the best joints found.

    Every iterate is inside the limits: joints at an end that the error pushes outwards are held, the others share the
    step.
    """
    start = into_limits(problem.chain, q0)
    moved = not np.array_equal(start, q0)
    shell = reach_shell(problem.chain)
    misses_by = shell.misses_by(problem.target.T_base_target.translation)
    misses_by = misses_by if misses_by > problem.tolerances.position else 0.0
    goal = problem
    if misses_by:  # then the nearest place that link lengths allow is what to head for
        place = pin.SE3(problem.target.T_base_target)
        place.translation = shell.nearest(place.translation)
        goal = replace(problem, target=replace(problem.target, T_base_target=place))
    search = _Search(goal, rule, budget, keep_trace)
    ended = search.descend(start)
    while ended is not Status.SOLVED and not misses_by and search.starts <= budget.restarts:
        again = search.descend(random_configurations(problem.chain, 1, rng)[0])
        # One start that was still getting closer is worth a word: a larger budget may help.
        ended = Status.BUDGET_SPENT if again is Status.STALLED and ended is Status.BUDGET_SPENT else again
    return Run(
        q=search.best_q,
        ended=Status.OUT_OF_REACH if misses_by else ended,
        iterations=search.iterations,
        starts=search.starts,
        start_moved=moved,
        misses_by=misses_by,
        trace=search.trace() if keep_trace else None,
    )


@dataclass
class _Search:
    problem: Problem
    rule: UpdateRule
    budget: Budget
    keep_trace: bool
    best_q: Floats = field(default_factory=lambda: np.empty(0))
    best_merit: float = math.inf
    iterations: int = 0
    starts: int = 0
    rows: list[tuple[Floats, float, float, int]] = field(default_factory=list)

    def descend(self, q: Floats) -> Status:
        """Iterates from one start; remembers the best joints of all starts."""
        chain, target = self.problem.chain, self.problem.target
        self.starts += 1
        halved, waited = math.inf, 0
        for _ in range(self.budget.iterations):
            T_base_tip = chain.pose(q)
            merit = self._note(q, *target.distances(T_base_tip))
            if merit <= 1.0:
                return Status.SOLVED
            waited += 1
            if merit < 0.5 * halved:
                halved, waited = merit, 0
            if waited >= self.budget.patience:
                return Status.STALLED
            step = self._step(q, chain.jacobian(q)[target.rows], target.error(T_base_tip))
            if not np.isfinite(step).all():
                return Status.NOT_FINITE
            q = into_limits(chain, q + step)
            self.iterations += 1
        self._note(q, *target.distances(chain.pose(q)))
        return Status.BUDGET_SPENT

    def _step(self, q: Floats, J: Floats, e: Floats) -> Floats:
        chain = self.problem.chain
        uphill = J.T @ e
        free = ~(((q <= chain.lower) & (uphill < 0.0)) | ((q >= chain.upper) & (uphill > 0.0)))
        step = np.zeros_like(q)
        if free.any():
            step[free] = self.rule(J[:, free], e)
        largest = float(np.abs(step).max())
        return step * (self.budget.largest_step / largest) if largest > self.budget.largest_step else step

    def _note(self, q: Floats, position: float, rotation: float | None) -> float:
        """Errors in units of their tolerances, the larger one; 1 or less is solved."""
        tolerances = self.problem.tolerances
        merit = max(_ratio(position, tolerances.position), _ratio(rotation or 0.0, tolerances.rotation))
        if merit < self.best_merit or not self.best_q.size:
            self.best_q, self.best_merit = q, merit
        if self.keep_trace:
            self.rows.append((q, position, math.nan if rotation is None else rotation, self.starts - 1))
        return merit

    def trace(self) -> Trace:
        q, position, rotation, start = zip(*self.rows, strict=True)
        return Trace(np.array(q), np.array(position), np.array(rotation), np.array(start))


def _ratio(error: float, tolerance: float) -> float:
    if tolerance > 0.0:
        return error / tolerance
    return 0.0 if error == 0.0 else math.inf
