"""The reference loop: iterate an update rule on any object that offers `pose` and `jacobian`, limits inside.

`nao_kin.ik.compiled_loop` is its compiled twin, the same iteration on flat arrays; a test holds them together.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import positive
from nao_kin.chain import into_limits
from nao_kin.errors import InvalidInputError
from nao_kin.ik import aim
from nao_kin.ik.geometric.sweep import CCD, sweep, sweep_memory
from nao_kin.ik.measure import errors
from nao_kin.ik.orientation import ROTATION_VECTOR, recast_rows
from nao_kin.ik.problem import Problem, Run, Status, Trace
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.rules import update
from nao_kin.ik.starts import STORED, make_starts, nearest_first
from nao_kin.ik.stopping import REACHED, gives_up, improved, is_polished, step_scale
from nao_kin.ik.target import KINDS
from nao_kin.kernels.joint_limits import packed_rules
from nao_kin.kernels.motion import Arm, At, packed_joints, place
from nao_kin.tolerances import Tolerances

if TYPE_CHECKING:
    import pinocchio as pin

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import Target

__all__ = ["Budget", "Update", "require_options", "run_reference"]


@dataclass(frozen=True, slots=True)
class Update:
    """A method as the loops run it.

    Attributes:
        rule: Code of the update rule, see `nao_kin.ik.rules`.
        parameters: Its parameters, in its order.
        orientation_error: Form of the orientation error that it sees, see `nao_kin.ik.orientation`.
    """

    rule: int
    parameters: tuple[float, ...]
    orientation_error: int = ROTATION_VECTOR

    def proposals(self, J: Floats, e: Floats) -> Floats:
        """The rule's proposals (1 or 2, n) for the Jacobian J (m, n) and the error e (m,), see `nao_kin.ik.rules`."""
        m, n = J.shape
        steps, parameters = np.empty((2, n)), np.array(self.parameters, dtype=np.float64)
        count = update(self.rule, np.array(J, order="C"), e, parameters, np.empty((m, m)), np.empty(m), steps)
        return steps[:count]


@dataclass(frozen=True, slots=True)
class Budget:
    """How long a solver may try.

    Attributes:
        iterations: Iterations of one start.
        restarts: Further starts, at stored configurations inside the limits, after the caller's; at most 256.
        patience: A start is given up after this many iterations that have not halved its error.
        largest_step: Joint steps are scaled down to this [rad or m].

    Raises:
        InvalidInputError: A count is no integer or out of range, or the step is not positive.
    """

    iterations: int = 200
    restarts: int = 100
    patience: int = 5
    largest_step: float = 1.0

    def __post_init__(self) -> None:
        for name, least, most in (("iterations", 0, 10**6), ("restarts", 0, STORED), ("patience", 1, 10**6)):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
                raise InvalidInputError(f"budget, {name}", f"an integer from {least} to {most}", repr(value)[:40])
        positive(self.largest_step, "budget, largest_step")


def require_options(budget: object, tolerances: object) -> None:
    """Does nothing for a budget, or None, and tolerances.

    Raises:
        InvalidInputError: Something else.
    """
    if budget is not None and not isinstance(budget, Budget):
        raise InvalidInputError("budget", "a nao_kin.Budget, or None for the method's own", repr(budget)[:60])
    if not isinstance(tolerances, Tolerances):
        raise InvalidInputError("tolerances", "nao_kin.Tolerances", repr(tolerances)[:60])


@np.errstate(over="ignore", invalid="ignore")  # a huge error's square is infinite; the loop copes with that
def run_reference(
    problem: Problem, method: Update, q0: Floats, budget: Budget, rng: np.random.Generator, keep_trace: bool = False
) -> Run:
    """Runs starts until one reaches the target or the budget is spent, and returns the best joints found.

    Every iterate is inside the limits: joints at an end that the error pushes outwards are held, the others share the
    step. The further starts are random configurations, those first whose tip is nearest to the target.
    """
    start = into_limits(problem.chain, q0)
    moved = not np.array_equal(start, q0)
    misses_by, goal = _reachable(problem)
    starts = make_starts(problem.chain, rng)
    search = _Search(problem.chain, goal, problem.tolerances, method, budget, starts.closeness, keep_trace)
    ended = search.descend(start)
    if ended is not Status.SOLVED and not misses_by:
        for q in itertools.islice(nearest_first(starts, goal), budget.restarts):
            again = search.descend(q)
            # One start that was still getting closer is worth a word: a larger budget may help.
            ended = Status.BUDGET_SPENT if again is Status.STALLED and ended is Status.BUDGET_SPENT else again
            if ended is Status.SOLVED:
                break
    return Run(
        q=search.best_q,
        ended=Status.OUT_OF_REACH if misses_by else ended,
        iterations=search.iterations,
        starts=search.starts,
        start_moved=moved,
        misses_by=misses_by,
        trace=search.trace() if keep_trace else None,
    )


def _reachable(problem: Problem) -> tuple[float, Target]:
    """A distance by which the target certainly misses the reach [m], 0 where that is not proven; and what to head for.

    That is the target itself, or the nearest place to it that the lengths of the links allow.
    """
    target = problem.target
    if target.kind == "orientation" or min(target.weights[:3]) == 0.0:
        return 0.0, target
    shell, wanted = reach_shell(problem.chain), target.goal[:3, 3]
    misses_by = shell.misses_by(wanted)
    if misses_by <= problem.tolerances.position:
        return 0.0, target
    return misses_by, target.moved_to(shell.nearest(wanted))


@dataclass
class _Search:
    chain: Chain
    target: Target
    tolerances: Tolerances
    method: Update
    budget: Budget
    closeness: float
    keep_trace: bool
    best_q: Floats = field(default_factory=lambda: np.empty(0))
    best_merit: float = math.inf
    iterations: int = 0
    starts: int = 0
    rows: list[tuple[Floats, float, float, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.goal, self.weights, self.kind = self.target.goal, np.array(self.target.weights), KINDS[self.target.kind]
        self.bound = {"position": slice(0, 3), "orientation": slice(3, 6)}.get(self.target.kind, slice(0, 6))

    def descend(self, q: Floats) -> Status:
        """Iterates from one start; remembers the best joints of all starts."""
        self.starts += 1
        previous, halved, waited, reached = math.inf, math.inf, 0, False
        for iteration in range(self.budget.iterations + 1):
            T_base_tip = self.chain.pose(q)
            tip = np.concatenate([T_base_tip.rotation.ravel(), T_base_tip.translation])
            e = np.empty(6)
            aim.raw_error(self.kind, self.goal, tip, e)
            merit, within = self._note(q, e, T_base_tip)
            reached = reached or within
            if reached and is_polished(merit, previous):
                return Status.SOLVED
            previous, waited = merit, 0 if improved(merit, halved) else waited + 1
            halved = merit if waited == 0 else halved
            if gives_up(waited, self.budget.patience, reached):
                return Status.SOLVED if reached else Status.STALLED
            if iteration == self.budget.iterations:
                break
            if self.method.rule >= CCD:
                q = self._swept(q)
            else:
                step = self._step(q, e, tip)
                if not np.isfinite(step).all():
                    return Status.NOT_FINITE
                q = into_limits(self.chain, q + step)
            self.iterations += 1
        return Status.SOLVED if reached else Status.BUDGET_SPENT

    def _step(self, q: Floats, e: Floats, tip: Floats) -> Floats:
        full = np.ascontiguousarray(self.chain.jacobian(q))
        recast_rows(self.method.orientation_error, self.goal, tip, e, full)
        aim.shape_rows(self.kind, self.goal, self.weights, tip, e, full)
        J, e = full[self.bound], e[self.bound]
        uphill = J.T @ e
        held = ((q <= self.chain.lower) & (uphill < 0.0)) | ((q >= self.chain.upper) & (uphill > 0.0))
        proposed = self.method.proposals(np.where(held, 0.0, J), e)
        return min(map(self._bounded, proposed), key=lambda step: self._merit_after(q, step, len(proposed)))

    def _swept(self, q: Floats) -> Floats:
        """The joints after a sweep; sweeps work on the flat form of the chain, here as in the compiled loop."""
        joints, limits = packed_joints(self.chain.joint_path), np.array([self.chain.lower, self.chain.upper])
        coupled = packed_rules(self.chain.limit_rules, self.chain.joint_names)
        axes, tip, swept = np.empty((len(joints) - 1, 6)), np.empty(12), q.copy()
        place(joints, swept, axes, tip)
        memory = np.empty(sweep_memory(joints))
        wanted = aim.SweepGoal(self.kind, self.goal, self.closeness)
        sweep(self.method.rule, Arm(joints, limits, coupled), wanted, At(swept, axes, tip), memory)
        return swept

    def _bounded(self, step: Floats) -> Floats:
        return step * step_scale(float(np.abs(step).max()), self.budget.largest_step)

    def _merit_after(self, q: Floats, step: Floats, proposed: int) -> float:
        """How good the joints after a step are; needed only where there is a choice."""
        if proposed == 1 or not np.isfinite(step).all():
            return math.inf
        T_base_tip, e = self.chain.pose(into_limits(self.chain, q + step)), np.empty(6)
        aim.raw_error(self.kind, self.goal, np.concatenate([T_base_tip.rotation.ravel(), T_base_tip.translation]), e)
        return self._merit(e)

    def _note(self, q: Floats, e: Floats, T_base_tip: pin.SE3) -> tuple[float, bool]:
        """The larger weighted error in units of its tolerance, and whether the target is reached."""
        merit = self._merit(e)
        if merit < self.best_merit or not self.best_q.size:
            self.best_q, self.best_merit = q, merit
        position, rotation = errors(
            self.kind, self.goal, self.target.counts, T_base_tip.rotation, T_base_tip.translation
        )
        if self.keep_trace:
            self.rows.append((q, position, rotation, self.starts - 1))
        far = position > REACHED * self.tolerances.position or rotation > REACHED * self.tolerances.rotation
        return merit, not far

    def _merit(self, e: Floats) -> float:
        weighted = self.weights * e
        return max(
            _ratio(float(np.linalg.norm(weighted[:3])), self.tolerances.position),
            _ratio(float(np.linalg.norm(weighted[3:])), self.tolerances.rotation),
        )

    def trace(self) -> Trace:
        """What was iterated, all starts in one."""
        q, position, rotation, start = zip(*self.rows, strict=True)
        return Trace(np.array(q), np.array(position), np.array(rotation), np.array(start))


def _ratio(error: float, tolerance: float) -> float:
    if tolerance > 0.0:
        return error / tolerance
    return 0.0 if error == 0.0 else math.inf
