"""Inverse kinematics of several tips at once: `solve_tree`, and the loop behind it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.arrays import positive
from nao_kin.chain import configuration, into_limits, neutral, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.geometric.fabrik_tree import tree_sweep
from nao_kin.ik.geometric.sweep import FABRIK
from nao_kin.ik.methods import METHODS, method_named
from nao_kin.ik.problem import Status
from nao_kin.ik.reference_loop import Budget, Update, require_options
from nao_kin.ik.rules import DAMPED
from nao_kin.ik.scales import scales_of
from nao_kin.ik.starts import STORED
from nao_kin.ik.stopping import POLISHED, REACHED, gives_up, improved, is_polished, step_scale
from nao_kin.ik.target import Target
from nao_kin.ik.tips.precedence import prioritised_step
from nao_kin.ik.tips.tree_aim import Aim, aims_of, apart, stacked, unreachable_last
from nao_kin.ik.tips.tree_problem import TreeProblem, TreeResult, TreeRun, TreeTrace, judge_tree
from nao_kin.kernels.joint_limits import packed_rules
from nao_kin.kernels.motion import packed_joints
from nao_kin.robot.tree import Tree
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.ik.tips.tree_aim import Levels, Seen

    TraceRow = tuple[Floats, Floats, Floats, int]
    from numpy.typing import ArrayLike

    from nao_kin.ik.target import TargetLike

__all__ = ["run_tree", "solve_tree"]

USUAL: Final = Update(METHODS["lm"].code, METHODS["lm"].tuned({}, None))
"""What brings tips back where the method itself has no step for some of them only."""

SETTLING: Final = 200
"""Iterations at most that look for the best compromise where not all targets can be met."""

SHORTEST: Final = 1e-6
"""A compromise is found when the largest joint step that makes it better is shorter than this [rad or m]."""

AT_END: Final = 1e-6
"""A joint this near to an end of its range [rad or m] is at it for a compromise: the shortest step of all would be cut
off there, and what is left of it need not be better."""

REPAIRS: Final = 4
"""Steps at most that bring the tips which come first back, after a step of those which come after them."""

SLACK: Final = 1e-6
"""Relative change of a squared error that counts as none, so that tips in second place may still improve."""


@np.errstate(over="ignore", invalid="ignore")  # a huge error's square is infinite; the loop copes with that
def run_tree(
    problem: TreeProblem, method: Update, q0: Floats, budget: Budget, rng: np.random.Generator, keep_trace: bool
) -> TreeRun:
    """Runs starts until every tip is at its target or the budget is spent, and returns the best joints found.

    Tips that share no joint are solved apart. Where targets are proven out of reach, their tips head for the nearest
    place that the lengths of the links allow, and count only after the others of their level.
    """
    tree, aims = problem.tree, aims_of(problem)
    q = into_limits(tree, q0)
    moved = not np.array_equal(q, q0)
    iterations, starts, ended, rows = 0, 0, set[Status](), list["TraceRow"]()
    for group in apart(tree, problem.targets):
        levels = unreachable_last(problem.levels, group, aims)
        search = _Search(tree, aims, levels, problem.tolerances, method, budget, rows if keep_trace else None)
        ended.add(search.run(q, rng))
        q, iterations, starts = search.best_q, iterations + search.iterations, max(starts, search.starts)
    misses = {tip: one.misses_by for tip, one in aims.items() if one.misses_by}
    reasons = (Status.NOT_FINITE, Status.BUDGET_SPENT, Status.STALLED, Status.SOLVED)
    reason = Status.OUT_OF_REACH if misses else next(reason for reason in reasons if reason in ended)
    return TreeRun(q, reason, iterations, starts, moved, misses, _trace(rows) if keep_trace else None)


@dataclass
class _Search:
    """The search for one group of tips that share joints; it moves no other joints."""

    tree: Tree
    aims: Mapping[str, Aim]
    levels: Levels
    tolerances: Tolerances
    method: Update
    budget: Budget
    trace: list[TraceRow] | None
    best_q: Floats = field(default_factory=lambda: np.empty(0))
    best_key: tuple[float, ...] = (math.inf,)
    iterations: int = 0
    starts: int = 0

    def run(self, q0: Floats, rng: np.random.Generator) -> Status:
        """Descends from q0, then from random configurations, those first whose tips are nearest to their targets.

        Where the first descent does not serve all tips, the levels are brought in one after the other, so that a far
        target of a later one cannot lead those before it astray.
        """
        ended = self._descend(q0, self.levels)
        further = [] if self._served(self.levels) else self._further(q0, rng)
        for count in range(1, len(self.levels) + 1):
            levels = self.levels[:count]
            for q in further if count == 1 else [self.best_q, *further]:
                if self._served(levels):
                    break
                again = self._descend(q, levels)
                # One start that was still getting closer is worth a word: a larger budget may help.
                ended = Status.BUDGET_SPENT if again is Status.STALLED and ended is Status.BUDGET_SPENT else again
        if any(self.best_key[:-1]):
            self._settle()
        return ended

    def _served(self, levels: Levels) -> bool:
        """Whether the best joints meet all targets of the first levels that are not proven out of reach."""
        costs = zip(levels, self.best_key, strict=False)
        return not any(cost for level, cost in costs if not self.aims[level[0]].misses_by)

    def _further(self, q0: Floats, rng: np.random.Generator) -> list[Floats]:
        aims = [self.aims[tip] for level in self.levels for tip in level]
        own = np.any([one.spread.any(axis=0) for one in aims], axis=0)
        Q = np.where(own, random_configurations(self.tree, STORED, rng), q0)
        far = np.sum([one.distances(Q) for one in aims], axis=0)
        return [into_limits(self.tree, Q[row]) for row in np.argsort(far, kind="stable")[: self.budget.restarts]]

    def _descend(self, q: Floats, levels: Levels) -> Status:
        """Iterates from one start; remembers the best joints of all starts."""
        self.starts += 1
        previous, halved, waited, reached = math.inf, [math.inf] * len(levels), 0, False
        for iteration in range(self.budget.iterations + 1):
            seen = self._look(q)
            merits = [max(seen[tip].merit(self.tolerances) for tip in level) for level in levels]
            merit = max(merits)
            reached = reached or merit <= REACHED
            if reached and is_polished(merit, previous):
                return Status.SOLVED
            previous, waited = merit, waited + 1
            for k, level_merit in enumerate(merits):
                if improved(max(level_merit, POLISHED), halved[k]):
                    halved[k], waited = max(level_merit, POLISHED), 0
            if gives_up(waited, self.budget.patience, reached):
                return Status.SOLVED if reached else Status.STALLED
            if iteration == self.budget.iterations:
                break
            q = self._advance(q, seen, levels)
            if not np.isfinite(q).all():
                return Status.NOT_FINITE
        return Status.SOLVED if reached else Status.BUDGET_SPENT

    def _advance(self, q: Floats, seen: Mapping[str, Seen], levels: Levels) -> Floats:
        """The joints after one iteration: a step of the update rule, or a sweep."""
        if self.method.rule != FABRIK:
            return into_limits(self.tree, q + self._step(q, seen, levels, self.method))
        self.iterations += 1
        tips = [tip for level in levels for tip in level]
        chains = [self.aims[tip].chain for tip in tips]
        return tree_sweep(
            paths=[packed_joints(chain.joint_path) for chain in chains],
            columns=[self.tree.columns[tip] for tip in tips],
            limits=np.array([self.tree.lower, self.tree.upper]),
            coupled=packed_rules(self.tree.limit_rules, self.tree.joint_names),
            goals=[self.aims[tip].target.goal for tip in tips],
            q=q,
        )

    def _settle(self) -> None:
        """Takes the best joints on to where no step makes an error smaller without one of a level above growing.

        Levenberg's damping, more after a step that was worse and less after one that was better: close to what cannot
        be met the error's own curvature counts, of which a method for reachable targets knows nothing.
        """
        q, damping = self.best_q, 1e-3
        seen = self._look(q)
        for _ in range(min(SETTLING, self.budget.iterations)):
            damped = Update(DAMPED, (1.0, math.sqrt(damping)))
            step = self._step(q, seen, self.levels, damped, AT_END)
            if not np.isfinite(step).all() or np.abs(step).max() < SHORTEST:
                break
            trial, nearer = self._repaired(into_limits(self.tree, q + step))
            if self._better(nearer, seen):
                q, seen, damping = trial, nearer, damping / 2.0
            else:
                damping *= 4.0
        self.best_q = q

    def _repaired(self, q: Floats) -> tuple[Floats, dict[str, Seen]]:
        """Brings back the tips of all levels but the last, with the smallest steps that do."""
        seen, above = self._look(q), self.levels[:-1]
        for _ in range(REPAIRS if above else 0):
            if max(seen[tip].merit(self.tolerances) for level in above for tip in level) <= POLISHED:
                break
            step = self._step(q, seen, above, USUAL if self.method.rule == FABRIK else self.method, AT_END)
            if not np.isfinite(step).all():
                break
            q = into_limits(self.tree, q + step)
            seen = self._look(q)
        return q, seen

    def _better(self, new: Mapping[str, Seen], old: Mapping[str, Seen]) -> bool:
        for this, that in zip(self._key(new), self._key(old), strict=True):
            if abs(this - that) > SLACK * that:
                return this < that
        return False

    def _step(self, q: Floats, seen: Mapping[str, Seen], levels: Levels, rule: Update, margin: float = 0.0) -> Floats:
        self.iterations += 1
        tasks = [stacked(self.aims[tip].task(q, seen[tip]) for tip in level) for level in levels]
        step = prioritised_step(tasks, rule, q <= self.tree.lower + margin, q >= self.tree.upper - margin)
        bounded: Floats = step * step_scale(float(np.abs(step).max()), self.budget.largest_step)
        return bounded

    def _look(self, q: Floats) -> dict[str, Seen]:
        """Where all tips are; remembers q if it is the best so far."""
        seen = {tip: self.aims[tip].look(q) for level in self.levels for tip in level}
        key = self._key(seen)
        if key < self.best_key or not self.best_q.size:
            self.best_q, self.best_key = q, key
        if self.trace is not None:
            everywhere = [one.look(q) for one in self.aims.values()]
            position, rotation = (np.array([getattr(s, part) for s in everywhere]) for part in ("position", "rotation"))
            self.trace.append((q, position, rotation, self.starts - 1))
        return seen

    def _key(self, seen: Mapping[str, Seen]) -> tuple[float, ...]:
        """Less is better: the cost of each level, 0 where its targets are met, then the worst error of all."""
        merits = {tip: near.merit(self.tolerances) for tip, near in seen.items()}
        met = [max(merits[tip] for tip in level) <= REACHED for level in self.levels]
        costs = [sum(self.aims[tip].cost(seen[tip]) for tip in level) for level in self.levels]
        return (*(0.0 if done else cost for done, cost in zip(met, costs, strict=True)), max(merits.values()))


def _trace(rows: Sequence[TraceRow]) -> TreeTrace:
    q, position, rotation, start = zip(*rows, strict=True)
    return TreeTrace(np.array(q), np.array(position), np.array(rotation), np.array(start))


SEEN: Final = 64
"""Random configurations that gains and dampings are scaled by."""


def solve_tree(
    tree: Tree,
    targets: Mapping[str, TargetLike],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    weights: Mapping[str, float] | None = None,
    priority: Sequence[str] | None = None,
    trace: bool = False,
    parameters: Mapping[str, float] | None = None,
) -> TreeResult:
    """Joints that bring several tips to their targets at once, each measured again before they are returned.

    A target that is proven out of reach ends as `Status.OUT_OF_REACH` with the tip and the distance in
    ``result.misses_by``; the others are served as though it were not there, and its tip is brought near from there by a
    local search.

    Args:
        tree: The tree, as ``robot.tree("torso", ["LArm", "RArm"])`` gives it.
        targets: Tip name to target, each as `nao_kin.solve` takes one. Tips that are not named are free.
        q0: Start, a vector (n,) or a posture of the whole robot (joints not named at 0). Outside the limits it is moved
            inside and the result says so. By default all zeros, moved inside.
        method: A name in `nao_kin.METHODS` of a method that serves several tips.
        tolerances: When a target counts as reached.
        budget: How long to try; iterations and restarts of each group of tips that share joints.
        seed: For the starts; the same call gives the same result.
        weights: Tip name to a number > 0, by default 1: which compromise is found where not all targets can be met.
            Every target must still be met to tolerance to count as solved.
        priority: Tips in order of precedence. Each is served with what freedom those before it leave, and disturbs none
            of them; tips not named come last, all alike. By default all tips count alike.
        trace: Keep every iterate in the result.
        parameters: What to tune the method with, see `nao_kin.solve`.

    Returns:
        A result whether solved or not: ask ``result.solved`` and read ``result.status`` and ``result.missed``.

    Raises:
        InvalidInputError: Not a tree, no targets, a target that makes no sense, or an option that is none.
        UnknownNameError: No such tip or method, or the start names a joint that does not exist; carries near matches.
    """
    _require_tree(tree)
    require_options(budget, tolerances)
    wanted = _targets(tree, targets)
    levels = _levels(tree, wanted, priority)
    problem = TreeProblem(tree, wanted, _weights(tree, levels, weights), levels, tolerances)
    start = neutral(tree) if q0 is None else tree.q_of(q0) if isinstance(q0, Mapping) else configuration(tree, q0)
    update = _update(problem, method, parameters or {}, np.random.default_rng(_seed(seed)))
    budget = budget or method_named(method).budget
    return judge_tree(problem, run_tree(problem, update, start, budget, np.random.default_rng(seed), trace))


def _require_tree(tree: object) -> None:
    if not isinstance(tree, Tree):
        got = f"a {type(tree).__name__}"
        raise InvalidInputError("tree", "a tree, as robot.tree('torso', ['LArm', 'RArm']) gives one", got)


def _targets(tree: Tree, targets: Mapping[str, TargetLike]) -> dict[str, Target]:
    if not isinstance(targets, Mapping) or not targets:
        expected = "targets by tip name, as {'LArm': T_base_target}"
        raise InvalidInputError("targets", expected, repr(targets)[:60])
    for tip in targets:
        tree.require_tip(tip)
    return {tip: _target(tip, targets[tip]) for tip in tree.tip_names if tip in targets}


def _target(tip: str, target: TargetLike) -> Target:
    try:
        return Target.of(target)
    except InvalidInputError as error:
        raise InvalidInputError(f"{error.what} of {tip}", error.expected, error.got) from None


def _levels(tree: Tree, wanted: Mapping[str, Target], priority: Sequence[str] | None) -> tuple[tuple[str, ...], ...]:
    if priority is None:
        return (tuple(wanted),)
    if isinstance(priority, str) or not isinstance(priority, Sequence):
        raise InvalidInputError("priority", "a list of tips, as ['LArm', 'RArm']", repr(priority)[:60])
    for tip in priority:
        tree.require_tip(tip)
        if tip not in wanted:
            raise InvalidInputError("priority", "tips that have a target", repr(tip))
    if len(set(priority)) < len(priority):
        raise InvalidInputError("priority", "each tip once", str(list(priority)))
    last = tuple(tip for tip in wanted if tip not in priority)
    return (*((tip,) for tip in priority), *((last,) if last else ()))


def _weights(tree: Tree, levels: Sequence[Sequence[str]], weights: Mapping[str, float] | None) -> dict[str, float]:
    """The weights, the largest of each level 1."""
    given = {} if weights is None else weights
    if not isinstance(given, Mapping):
        raise InvalidInputError("weights", "numbers by tip name, as {'LArm': 2.0}", repr(weights)[:60])
    for tip in given:
        tree.require_tip(tip)
        if not any(tip in level for level in levels):
            raise InvalidInputError("weights", "tips that have a target", repr(tip))
    checked = {tip: positive(weight, f"weight of {tip}") for tip, weight in given.items()}
    every = {tip: checked.get(tip, 1.0) for level in levels for tip in level}
    return {tip: every[tip] / max(every[other] for other in level) for level in levels for tip in level}


def _update(problem: TreeProblem, method: str, parameters: Mapping[str, float], rng: np.random.Generator) -> Update:
    """The method with its parameters, those that depend on the tree from random configurations."""
    chosen, tree = method_named(method), problem.tree
    if not chosen.several_tips:
        able = ", ".join(name for name, row in METHODS.items() if row.several_tips)
        raise InvalidInputError("method", f"one that serves several tips: {able}", repr(method))
    for tip, target in problem.targets.items():
        refused = chosen.refusal(tree.chains[tip], target)
        if refused is not None:
            raise InvalidInputError(f"{refused.what}, tip {tip}", refused.expected, refused.got)
    if chosen.hinges:
        _require_plain(problem, method)
    if not chosen.scaled:
        return Update(chosen.code, chosen.tuned(parameters, None))
    aims = aims_of(problem).values()
    stacks = [np.vstack([one.task(q, one.look(q)).J for one in aims]) for q in random_configurations(tree, SEEN, rng)]
    return Update(chosen.code, chosen.tuned(parameters, scales_of(np.array(stacks))))


def _require_plain(problem: TreeProblem, method: str) -> None:
    """A method that moves points knows neither precedence nor weights, and each joint has to have its own column."""
    if len(problem.levels) > 1 or set(problem.weights.values()) != {1.0}:
        raise InvalidInputError("priority and weights", f"none for method {method!r}", "some")
    for tip in problem.targets:
        spread, shift = problem.tree.spreads[tip], problem.tree.shifts[tip]
        if not (np.isin(spread, (0.0, 1.0)).all() and (spread.sum(axis=1) == 1.0).all() and not shift.any()):
            expected = f"a motor of its own for each joint of {tip} for method {method!r}"
            raise InvalidInputError("tree", expected, "joints that follow another one")


def _seed(seed: Any) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    return int(seed)
