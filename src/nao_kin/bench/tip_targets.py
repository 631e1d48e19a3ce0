"""Targets for `nao-kin bench tips`, their referee, and the search for the farthest ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.bench.measuring import timed
from nao_kin.bench.referee import REACHED, Referee
from nao_kin.chain import random_configurations
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import Target
from nao_kin.ik.tips.tree_solver import solve_tree
from nao_kin.output import progress

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.ik.tips.tree_problem import TreeResult
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.tree import Tree

__all__ = ["AXES", "Wish", "attempt", "farthest_along", "reachable_wishes", "with_far_tip"]

Wish = dict[str, Target]
"""Tip name to target."""

AXES: Final = {"up": 2, "forward": 0}
"""Axes of the sole: x forward, y to the left, z up."""

_STEP = (0.0, 0.5)  # [m] by which an unreachable target is moved away
_ACCURACY = 1e-4  # [m]
_PUSHING = Budget(restarts=20)
_LIMITS = 1e-9  # [rad or m], as the referee's
_FREE = dict.fromkeys("xyz", 0.0)


def reachable_wishes(tree: Tree, kind: str, count: int, seed: int) -> list[Wish]:
    """Targets at the tips of random joints within the limits; of the head only its orientation."""
    referees = _referees(tree)
    wishes = []
    for q in random_configurations(tree, count, np.random.default_rng(seed)):
        poses = {tip: referee.pose(tree.chain_q(tip, q)) for tip, referee in referees.items()}
        wishes.append({tip: _target("orientation" if tip == "Head" else kind, T) for tip, T in poses.items()})
    return wishes


def with_far_tip(tree: Tree, tip: str, wishes: Sequence[Wish], seed: int) -> list[Wish]:
    """The same, with the target of one tip moved away from the middle of its reach."""
    rng, centre = np.random.default_rng(seed), reach_shell(tree.chains[tip]).centre
    moved = []
    for wish in wishes:
        p = wish[tip].goal[:3, 3]
        away = (p - centre) / np.linalg.norm(p - centre)
        moved.append(wish | {tip: wish[tip].moved_to(p + rng.uniform(*_STEP) * away)})
    return moved


def attempt(
    tree: Tree,
    wishes: Sequence[Wish],
    what: str,
    *,
    priority: Sequence[str] | None = None,
    budget: Budget | None = None,
    method: str = "lm",
) -> dict[str, Any]:
    """How many are solved [%], how many tips are served [%], and what the referee says of it."""
    referees = _referees(tree)
    asked = progress(wishes, what, len(wishes))
    solve_tree(tree, wishes[0], priority=priority, budget=budget, method=method)  # compiles
    taken, found = timed(lambda wish: solve_tree(tree, wish, priority=priority, budget=budget, method=method), asked)
    served = {tip: sum(_served(referees[tip], r, tip) for r in found) for tip in referees}
    solved = [_confirmed(referees, r) for r in found]
    percent = 100.0 / len(wishes)
    return {
        "solved": percent * sum(solved),
        "false": sum(result.solved and not confirmed for result, confirmed in zip(found, solved, strict=True)),
        "proven": sum(result.status.name == "OUT_OF_REACH" for result in found),
        "starts": float(np.mean([result.run.starts for result in found])),
        "iterations": float(np.mean([result.iterations for result in found])),
        "ms": 1e3 * float(np.median(taken)),
    } | {tip: percent * count for tip, count in served.items()}


def farthest_along(robot: Robot, base: str, tips: Sequence[str], axis: int, samples: int, seed: int) -> float:
    """How far along an axis of the left sole all tips get at once [m], the robot's other joints at rest.

    With the torso as base the legs are at rest too, so that the robot stands. From the best of random joints the target
    is moved outwards by bisection between what was reached and what the lengths of the links allow.
    """
    tree = robot.tree(base, tips)
    T_sole_base = robot.pose(robot.neutral, base, base="l_sole")
    if abs(T_sole_base.rotation[axis, axis] - 1.0) > 1e-12:
        raise ValueError(f"{robot.name} does not stand upright at rest")
    offset = float(T_sole_base.translation[axis])
    Q = random_configurations(tree, samples, np.random.default_rng(seed))
    along = [chain.poses(tree.chain_q(tip, Q))[:, axis, 3] for tip, chain in tree.chains.items()]
    q = Q[int(np.argmax(np.min(along, axis=0)))]
    near = _least(robot, tree, q, axis)
    shells = [reach_shell(chain) for chain in tree.chains.values()]
    far = offset + min(float(shell.centre[axis]) + shell.outer for shell in shells)
    while far - near > _ACCURACY:
        middle = 0.5 * (near + far)
        wish = {tip: _plane(axis, middle - offset) for tip in tips}
        result = solve_tree(tree, wish, q, budget=_PUSHING)
        reached = _least(robot, tree, result.q, axis)
        # Short of the target, the best joints found may still be farther out than any before.
        if reached > near:
            q, near = result.q, reached
        if not result.solved:
            far = middle
    return near


def _plane(axis: int, value: float) -> Target:
    """Everything at one coordinate [m], the other two free."""
    p = np.zeros(3)
    p[axis] = value
    return Target.position(p, {**_FREE, "xyz"[axis]: 1.0})


def _least(robot: Robot, tree: Tree, q: Floats, axis: int) -> float:
    """The smallest coordinate of all tips in the sole's frame [m], on the model of the whole robot.

    Raises:
        ValueError: A joint is outside its limits.
    """
    posture = robot.complete(dict(zip(tree.joint_names, q.tolist(), strict=True)))
    if outside := _outside(robot, posture):
        raise ValueError(f"{robot.name}: {outside}")
    return min(float(robot.pose(posture, tip, base="l_sole").translation[axis]) for tip in tree.tip_names)


def _outside(robot: Robot, posture: Mapping[str, float]) -> str:
    found = robot.outside_limits(posture)
    return "; ".join(str(o) for o in found if max(o.lower - o.value, o.value - o.upper) > _LIMITS)


def _referees(tree: Tree) -> dict[str, Referee]:
    return {tip: Referee(tree.chains[tip]) for tip in tree.tip_names}  # type: ignore[arg-type]


def _target(kind: str, T: Floats) -> Target:
    if kind == "orientation":
        return Target.orientation(T[:3, :3])
    return Target.pose(T) if kind == "pose" else Target.position(T[:3, 3])


def _served(referee: Referee, result: TreeResult, tip: str) -> bool:
    """Whether the whole model confirms that a tip is at its target and its chain's joints are in their ranges."""
    target, q = result.problem.targets[tip], result.problem.tree.chain_q(tip, result.q)
    within = (float("inf"), REACHED[1]) if target.kind == "orientation" else REACHED
    return referee.accepts(q, target.goal, position_only=target.kind == "position", within=within)


def _confirmed(referees: Mapping[str, Referee], result: TreeResult) -> bool:
    """The same of all tips, with the posture of the whole robot: one motor one value, every coupled limit."""
    robot = result.problem.tree.robot
    if robot is None or _outside(robot, robot.complete(result.posture)):
        return False
    return all(_served(referee, result, tip) for tip, referee in referees.items())
