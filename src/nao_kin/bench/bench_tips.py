"""`nao-kin bench tips`: two hands at once, one before the other, and how far a hand gets when the legs help."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import typer

from nao_kin.bench.measuring import timed
from nao_kin.bench.referee import REACHED, Referee
from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.chain import random_configurations
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import Target
from nao_kin.ik.tips.tree_solver import solve_tree
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.ik.tips.tree_problem import TreeResult
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.tree import Tree

__all__ = ["AXES", "Wish", "attempt", "farthest_along", "reachable_wishes", "tips", "with_far_tip"]

_ROBOT = "nao"
_BASES = ("torso", "l_sole")
_HANDS = ("LArm", "RArm")
_SOLVED_PERCENT = 99.0
_TOUR = (
    ("positions", "position", _HANDS, ()),
    ("poses", "pose", _HANDS, ()),
    ("positions, left first", "position", _HANDS, ("LArm",)),
    ("poses, left first", "pose", _HANDS, ("LArm",)),
    ("positions, head turned", "position", (*_HANDS, "Head"), ()),
)
_FAR_TOUR = (("torso", ()), ("l_sole", ()), ("l_sole", ("LArm",)))  # from the torso, the hands share no joint
_NOTES = (
    "Targets: the tips of random joints within all limits. Solved: Pinocchio on the whole model confirms every tip to "
    "1e-6 m and 1e-6 rad, every limit, and the motor that both hip joints share.",
    "Reach: RArm in the frame of the sole it stands on, at joints that the model confirms to be within their limits; "
    "the farthest found, so a lower bound. Neither balance nor the floor nor collisions are considered.",
)


def tips(
    targets: Annotated[int, typer.Option(min=1, help="Targets of each kind.")] = 500,
    samples: Annotated[int, typer.Option(min=100, help="Configurations that the reach is looked for from.")] = 100_000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the targets.")] = 11,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Both hands of the NAO at once, with and without priority, and its reach from a foot."""
    from nao_kin.robot.robot import load

    machine, robot = Machine(), load(_ROBOT)
    hands, solved = _reachable(robot, targets, seed)
    beyond, honest = _unreachable(robot, targets, seed)
    reach, gained = _reach(robot, samples, seed)
    conclude(machine, [hands, beyond, reach], [*solved, *honest, *gained], _NOTES, format, goals)


def _reachable(robot: Robot, targets: int, seed: int) -> tuple[Sheet, list[Promise]]:
    """Targets of several tips that some joints reach."""
    from nao_kin.bench.bench_tips import attempt, reachable_wishes

    rows, bounds = list[dict[str, Any]](), list[Promise]()
    for base in _BASES:
        for what, kind, tip_names, priority in _TOUR:
            tree = robot.tree(base, tip_names)
            wishes: list[Wish] = reachable_wishes(tree, kind, targets, seed)
            row = attempt(tree, wishes, f"{what} from {base}", priority=priority or None)
            rows.append({"base": base, "what": what} | row)
            bounds.append(Promise(f"{base}: {what}, solved %", row["solved"], _SOLVED_PERCENT))
    bounds.append(Promise("reachable, falsely solved", sum(row["false"] for row in rows), 0.0, at_least=False))
    headings = (
        Heading("base", "base"),
        Heading("what", "both hands"),
        Heading("solved", "solved %", ".1f"),
        Heading("false", "falsely", "d"),
        Heading("starts", "starts", ".1f"),
        Heading("iterations", "iterations", ".0f"),
    )
    return Sheet("reachable", f"{robot.name}: {targets} targets each, several tips at once", headings, rows), bounds


def _unreachable(robot: Robot, targets: int, seed: int) -> tuple[Sheet, list[Promise]]:
    """The right hand wanted where it mostly cannot be, the left one where it can."""
    from nao_kin.bench.bench_tips import attempt, reachable_wishes, with_far_tip
    from nao_kin.ik.reference_loop import Budget

    few, rows = Budget(iterations=50, restarts=5), list[dict[str, Any]]()
    for base, priority in _FAR_TOUR:
        tree = robot.tree(base, _HANDS)
        wishes = with_far_tip(tree, "RArm", reachable_wishes(tree, "position", targets, seed), seed)
        row = attempt(tree, wishes, f"unreachable from {base}", priority=priority or None, budget=few)
        rows.append({"base": base, "priority": "left first" if priority else "alike"} | row)
    bounds = [
        Promise(f"{base}: left first, left hand served %", row["LArm"], _SOLVED_PERCENT)
        for (base, priority), row in zip(_FAR_TOUR, rows, strict=True)
        if priority
    ]
    bounds.append(Promise("unreachable, falsely solved", sum(row["false"] for row in rows), 0.0, at_least=False))
    headings = (
        Heading("base", "base"),
        Heading("priority", "hands count"),
        Heading("LArm", "left served %", ".1f"),
        Heading("solved", "both %", ".1f"),
        Heading("false", "falsely", "d"),
        Heading("proven", "OUT_OF_REACH", "d"),
    )
    return Sheet("unreachable", "the right hand's target moved up to 0.5 m away", headings, rows), bounds


def _reach(robot: Robot, samples: int, seed: int) -> tuple[Sheet, list[Promise]]:
    """The right hand's reach standing still, and with the whole body on one foot."""
    from nao_kin.bench.bench_tips import AXES, farthest_along

    rows, bounds = list[dict[str, Any]](), list[Promise]()
    for what, axis in AXES.items():
        still = farthest_along(robot, "torso", ("RArm",), axis, samples, seed)
        moving = farthest_along(robot, "l_sole", ("RArm",), axis, samples, seed)
        both = farthest_along(robot, "l_sole", _HANDS, axis, samples, seed)
        rows.append({"what": what, "still": still, "moving": moving, "gain": moving - still, "both": both})
        bounds.append(Promise(f"{what}: gain from the legs [m]", moving - still, 0.0))
    headings = (
        Heading("what", "as far as possible"),
        Heading("still", "torso standing", ".4f"),
        Heading("moving", "whole body", ".4f"),
        Heading("gain", "gain", ".4f"),
        Heading("both", "both hands", ".4f"),
    )
    return Sheet("reach", f"{robot.name}: reach of RArm from l_sole [m]", headings, rows), bounds


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
