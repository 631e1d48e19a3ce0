"""How the commands are told which chain and which joint values are meant."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

import typer

from nao_kin.cli.shared_options import with_given_tool

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.chain import Chain
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["chain_from_spec", "chain_of_robot", "document_or_file", "parse_posture", "parse_values", "robot_and_chain"]

SPEC_HELP = "A table (TOML file or document chain) or ROBOT, ROBOT:CHAIN or ROBOT:BASE:TIP."


def document_or_file(name: str) -> Chain | None:
    """The DH chain that a name or a TOML file stands for; None if it is neither."""
    from nao_kin.documents.chains import document_chain, document_chain_names

    if name in document_chain_names():
        return document_chain(name)
    if name.endswith(".toml"):
        from nao_kin.dh.dh_chain import DHChain

        return DHChain.from_file(name)
    return None


def chain_from_spec(spec: str) -> Chain:
    """A chain from one word; see `SPEC_HELP`."""
    from nao_kin.documents.chains import document_chain_names
    from nao_kin.errors import UnknownNameError
    from nao_kin.robot.known import robot_names
    from nao_kin.robot.robot import load

    if (table := document_or_file(spec)) is not None:
        return table
    robot, *frames = [spec] if os.path.isfile(spec) else spec.split(":")  # noqa: PTH113 - Path raises for long names
    try:
        model = load(robot)
    except UnknownNameError:
        raise UnknownNameError("robot or document chain", robot, (*robot_names(), *document_chain_names())) from None
    match frames:
        case []:
            return chain_of_robot(model, None, None, None)
        case [name]:
            return chain_of_robot(model, name, None, None)
        case [base, tip]:
            return chain_of_robot(model, None, base, tip)
    raise typer.BadParameter(f"{spec!r}: expected ROBOT, ROBOT:CHAIN or ROBOT:BASE:TIP.")


def robot_and_chain(spec: str, name: str | None, base: str | None, tip: str | None) -> tuple[Robot, UrdfChain]:
    """The robot of a command that takes ROBOT, ROBOT:CHAIN or ROBOT:BASE:TIP, or the chain as options."""
    from nao_kin.robot.robot import load
    from nao_kin.robot.urdf_chain import UrdfChain

    if name is None and base is None and tip is None:
        chain = chain_from_spec(spec)
        if not isinstance(chain, UrdfChain):
            raise typer.BadParameter(f"{spec} is a table; this command needs a robot.")
        return chain.robot, chain
    robot = load(spec)
    return robot, chain_of_robot(robot, name, base, tip)


def chain_of_robot(robot: Robot, name: str | None, base: str | None, tip: str | None) -> UrdfChain:
    """The chain named, or from base (default: the root) to tip, or else the robot's main chain."""
    if name is not None:
        if base is not None or tip is not None:
            raise typer.BadParameter("--chain already says base and tip; give either it or --base and --tip.")
        return with_given_tool(robot.chain(name))
    if tip is not None:
        return with_given_tool(robot.chain(base or robot.root, tip))
    if base is not None:
        raise typer.BadParameter("--base needs --tip.")
    if not robot.chain_frames:
        names = ", ".join(robot.chain_names[:8]) or "none"
        hint = f"say which with --base and --tip, or --chain ({names})"
        raise typer.BadParameter(f"{robot.name} has no named chains: {hint}.")
    return with_given_tool(robot.chain(next(iter(robot.chain_frames))))


def parse_values(values: Sequence[str], degrees: bool, chain: Chain) -> list[float]:
    """Joint values as typed, degrees for turning joints if asked for; what is no number is refused by name."""
    numbers = []
    for word in values:
        try:
            numbers.append(float(word))
        except ValueError:
            what = f"No such option: {word}" if word.startswith("-") else f"{word!r} is not a number"
            raise typer.BadParameter(f"{what}; expected {len(chain.joints)} joint values.") from None
    if not degrees or len(numbers) != len(chain.joints):
        return numbers  # a wrong count is refused where the chain's joints can be named
    return [
        value if joint.kind == "prismatic" else math.radians(value)
        for value, joint in zip(numbers, chain.joints, strict=True)
    ]


def parse_posture(pairs: Sequence[str], degrees: bool, robot: Robot) -> dict[str, float]:
    """A posture from words NAME=VALUE."""
    turning = {joint.name for joint in robot.moving_joints if joint.kind != "prismatic"}
    posture = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        try:
            value = float(text)
        except ValueError:
            raise typer.BadParameter(f"{pair!r}: expected NAME=NUMBER, as in LElbowRoll=-0.5.") from None
        if not equals:
            raise typer.BadParameter(f"{pair!r}: expected NAME=NUMBER.")
        posture[name] = math.radians(value) if degrees and name in turning else value
    return posture
