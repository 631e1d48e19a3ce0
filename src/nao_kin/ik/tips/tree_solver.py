"""Inverse kinematics of several tips at once: `solve_tree`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.arrays import positive
from nao_kin.chain import configuration, neutral, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.methods import METHODS, method_named
from nao_kin.ik.reference_loop import Budget, Update, require_options
from nao_kin.ik.scales import scales_of
from nao_kin.ik.target import Target
from nao_kin.ik.tips.tree_aim import aims_of
from nao_kin.ik.tips.tree_loop import run_tree
from nao_kin.ik.tips.tree_problem import TreeProblem, TreeResult, judge_tree
from nao_kin.robot.tree import Tree
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.ik.target import TargetLike

__all__ = ["solve_tree"]

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
