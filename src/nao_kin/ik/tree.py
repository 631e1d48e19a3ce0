"""Inverse kinematics of several tips at once: `solve_tree`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.chain import configuration, neutral
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.catalogue import METHODS
from nao_kin.ik.loop import Budget, Update
from nao_kin.ik.target import Target
from nao_kin.ik.tree_loop import run_tree
from nao_kin.ik.tree_problem import TreeProblem, TreeResult, judge_tree
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.tree import Tree

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.ik.target import TargetLike

__all__ = ["solve_tree"]


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
        method: A name in `nao_kin.METHODS` of a method with an update rule.
        tolerances: When a target counts as reached.
        budget: How long to try; iterations and restarts of each group of tips that share joints.
        seed: For the starts; the same call gives the same result.
        weights: Tip name to a number > 0, by default 1: which compromise is found where not all targets can be met.
            Every target must still be met to tolerance to count as solved.
        priority: Tips in order of precedence. Each is served with what freedom those before it leave, and disturbs none
            of them; tips not named come last, all alike. By default all tips count alike.
        trace: Keep every iterate in the result.

    Returns:
        A result whether solved or not: ask ``result.solved`` and read ``result.status`` and ``result.missed``.

    Raises:
        InvalidInputError: Not a tree, no targets, a target that makes no sense, or an option that is none.
        UnknownNameError: No such tip or method, or the start names a joint that does not exist; carries near matches.
    """
    _require_tree(tree)
    wanted = _targets(tree, targets)
    levels = _levels(tree, wanted, priority)
    problem = TreeProblem(tree, wanted, _weights(tree, levels, weights), levels, tolerances)
    start = neutral(tree) if q0 is None else tree.q_of(q0) if isinstance(q0, Mapping) else configuration(tree, q0)
    rng = np.random.default_rng(_seed(seed))
    return judge_tree(problem, run_tree(problem, _rule(method, wanted), start, budget or Budget(), rng, trace))


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
    for tip, weight in given.items():
        tree.require_tip(tip)
        if not any(tip in level for level in levels):
            raise InvalidInputError("weights", "tips that have a target", repr(tip))
        if isinstance(weight, bool) or not isinstance(weight, (int, float, np.number)) or not 0.0 < weight < np.inf:
            raise InvalidInputError(f"weight of {tip}", "a finite number > 0", repr(weight))
    every = {tip: float(given.get(tip, 1.0)) for level in levels for tip in level}
    return {tip: every[tip] / max(every[other] for other in level) for level in levels for tip in level}


def _rule(method: str, wanted: Mapping[str, Target]) -> Update:
    if method not in METHODS:
        raise UnknownNameError("method", method, METHODS)
    chosen = METHODS[method]
    for tip, target in wanted.items():
        if target.kind not in chosen.targets:
            expected = f"a {' or '.join(chosen.targets)} target, which is all that method {method!r} handles"
            raise InvalidInputError(f"target of {tip}", expected, f"a {target.kind} target")
    return Update(chosen.code, chosen.tuned({}, None))


def _seed(seed: Any) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    return int(seed)
