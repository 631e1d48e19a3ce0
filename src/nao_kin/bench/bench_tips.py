"""`nao-kin bench tips`: two hands at once, one before the other, and how far a hand gets when the legs help."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import Goal, GoalsOption, Heading, Machine, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from nao_kin.robot.robot import Robot

__all__ = ["tips"]

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


def _reachable(robot: Robot, targets: int, seed: int) -> tuple[Sheet, list[Goal]]:
    """Targets of several tips that some joints reach."""
    from nao_kin.bench.tip_targets import Wish, attempt, reachable_wishes

    rows, bounds = list[dict[str, Any]](), list[Goal]()
    for base in _BASES:
        for what, kind, tip_names, priority in _TOUR:
            tree = robot.tree(base, tip_names)
            wishes: list[Wish] = reachable_wishes(tree, kind, targets, seed)
            row = attempt(tree, wishes, f"{what} from {base}", priority=priority or None)
            rows.append({"base": base, "what": what} | row)
            bounds.append(Goal(f"{base}: {what}, solved %", row["solved"], _SOLVED_PERCENT))
    bounds.append(Goal("reachable, falsely solved", sum(row["false"] for row in rows), 0.0, at_least=False))
    headings = (
        Heading("base", "base"),
        Heading("what", "both hands"),
        Heading("solved", "solved %", ".1f"),
        Heading("false", "falsely", "d"),
        Heading("starts", "starts", ".1f"),
        Heading("iterations", "iterations", ".0f"),
    )
    return Sheet("reachable", f"{robot.name}: {targets} targets each, several tips at once", headings, rows), bounds


def _unreachable(robot: Robot, targets: int, seed: int) -> tuple[Sheet, list[Goal]]:
    """The right hand wanted where it mostly cannot be, the left one where it can."""
    from nao_kin.bench.tip_targets import attempt, reachable_wishes, with_far_tip
    from nao_kin.ik.reference_loop import Budget

    few, rows = Budget(iterations=50, restarts=5), list[dict[str, Any]]()
    for base, priority in _FAR_TOUR:
        tree = robot.tree(base, _HANDS)
        wishes = with_far_tip(tree, "RArm", reachable_wishes(tree, "position", targets, seed), seed)
        row = attempt(tree, wishes, f"unreachable from {base}", priority=priority or None, budget=few)
        rows.append({"base": base, "priority": "left first" if priority else "alike"} | row)
    bounds = [
        Goal(f"{base}: left first, left hand served %", row["LArm"], _SOLVED_PERCENT)
        for (base, priority), row in zip(_FAR_TOUR, rows, strict=True)
        if priority
    ]
    bounds.append(Goal("unreachable, falsely solved", sum(row["false"] for row in rows), 0.0, at_least=False))
    headings = (
        Heading("base", "base"),
        Heading("priority", "hands count"),
        Heading("LArm", "left served %", ".1f"),
        Heading("solved", "both %", ".1f"),
        Heading("false", "falsely", "d"),
        Heading("proven", "OUT_OF_REACH", "d"),
    )
    return Sheet("unreachable", "the right hand's target moved up to 0.5 m away", headings, rows), bounds


def _reach(robot: Robot, samples: int, seed: int) -> tuple[Sheet, list[Goal]]:
    """The right hand's reach standing still, and with the whole body on one foot."""
    from nao_kin.bench.tip_targets import AXES, farthest_along

    rows, bounds = list[dict[str, Any]](), list[Goal]()
    for what, axis in AXES.items():
        still = farthest_along(robot, "torso", ("RArm",), axis, samples, seed)
        moving = farthest_along(robot, "l_sole", ("RArm",), axis, samples, seed)
        both = farthest_along(robot, "l_sole", _HANDS, axis, samples, seed)
        rows.append({"what": what, "still": still, "moving": moving, "gain": moving - still, "both": both})
        bounds.append(Goal(f"{what}: gain from the legs [m]", moving - still, 0.0))
    headings = (
        Heading("what", "as far as possible"),
        Heading("still", "torso standing", ".4f"),
        Heading("moving", "whole body", ".4f"),
        Heading("gain", "gain", ".4f"),
        Heading("both", "both hands", ".4f"),
    )
    return Sheet("reach", f"{robot.name}: reach of RArm from l_sole [m]", headings, rows), bounds
