"""`nao-kin ik`: joints that bring a tip to a target."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import parse_posture, robot_and_chain
from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.ik.problem import IKResult
    from nao_kin.ik.target import TargetLike
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["ik", "result_data"]

Triple = tuple[float, float, float]


def ik(
    robot: Annotated[str, typer.Argument(help="ROBOT, ROBOT:CHAIN or ROBOT:BASE:TIP.")],
    chain: Annotated[str | None, typer.Option(help="A named chain of the robot, as left_arm.")] = None,
    base: Annotated[str | None, typer.Option(help="Base frame; default the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip frame.")] = None,
    xyz: Annotated[Triple | None, typer.Option(help="Wanted position in the base frame [m].")] = None,
    rpy: Annotated[Triple | None, typer.Option(help="Wanted roll pitch yaw [rad]; without it any will do.")] = None,
    posture: Annotated[list[str] | None, typer.Option(help="NAME=VALUE, repeated: the target is its pose.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="--rpy, --posture and --lock are in degrees.")] = False,
    method: Annotated[str, typer.Option(help="A name in nao_kin.METHODS.")] = "lm",
    seed: Annotated[int, typer.Option(help="Seed of the stored starts.")] = 0,
    all: Annotated[bool, typer.Option("--all", help="Every solution, by closed form.")] = False,
    lock: Annotated[list[str] | None, typer.Option(help="With --all, NAME=VALUE, repeated: a joint's value.")] = None,
    redundancy: Annotated[str | None, typer.Option(help="With --all, the joint of which to sample values.")] = None,
    samples: Annotated[int, typer.Option(min=2, help="How many values of --redundancy.")] = 64,
    html: Annotated[str | None, typer.Option(help="Write a page: the solution and the way to it, or all.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Inverse kinematics: joints that bring the tip to a position, a pose, or where a posture has it."""
    from nao_kin.chain import joint_table
    from nao_kin.solving import solve

    model, path = robot_and_chain(robot, chain, base, tip)
    target = _target(model, path, xyz, rpy, posture, deg)
    if all:
        if method != "lm":
            raise typer.BadParameter("--method is for one solution; leave out --all.")
        options = {"locked": parse_posture(lock or [], deg, model), "redundancy": redundancy, "samples": samples}
        _every_solution(path, target, options, html, format)
        return
    if lock or redundancy:
        raise typer.BadParameter(f"{'--lock' if lock else '--redundancy'} goes with --all.")
    result = solve(path, target, method=method, seed=seed, trace=html is not None)
    if format is OutputFormat.json:
        report_json(result_data(result))
    else:
        branch = f" Branch: {result.branch}." if result.branch else ""
        report(joint_table(path, result.q, f"{path.name}: {path.base} → {path.tip}"), result.message + branch)
    if html is not None:
        from nao_kin.view.export import export_html

        typer.echo(f"wrote {export_html(html, result)}", err=True)
    if not result.solved:
        raise typer.Exit(1)


def _every_solution(
    path: UrdfChain, target: TargetLike, options: dict[str, Any], html: str | None, format: OutputFormat
) -> None:
    from nao_kin.analytic.solutions import solve_all

    solutions = solve_all(path, target, **options)
    if format is OutputFormat.json:
        data = [result_data(result) | {"branch": result.branch} for result in solutions]
        report_json({"chain": path.name, "reason": solutions.reason, "solutions": data})
    else:
        report(solutions.table(f"{path.name}: {path.base} → {path.tip}, {len(solutions)} solutions"))
    if html is not None and solutions:
        from nao_kin.view.export import export_html

        typer.echo(f"wrote {export_html(html, solutions)}", err=True)
    elif html is not None:
        typer.echo(f"nao-kin: there is no solution to show, so {html} is not written.", err=True)
    if not solutions.solved:
        raise typer.Exit(1)


def _target(
    robot: Robot, path: UrdfChain, xyz: Triple | None, rpy: Triple | None, posture: list[str] | None, degrees: bool
) -> TargetLike:
    import numpy as np

    from nao_kin.se3 import from_xyz_rpy

    if (xyz is None) == (not posture):
        raise typer.BadParameter("say where to: either --xyz (and --rpy), or --posture.")
    if posture:
        if rpy is not None:
            raise typer.BadParameter("--rpy goes with --xyz; a posture has its own orientation.")
        return path.pose(path.q_of(parse_posture(posture, degrees, robot)))
    if rpy is None:
        return np.array(xyz)
    return from_xyz_rpy(xyz or (0, 0, 0), np.radians(rpy) if degrees else np.array(rpy))


def result_data(result: IKResult) -> dict[str, Any]:
    """A result as plain data."""
    return {
        "chain": result.problem.chain.name,
        "solved": result.solved,
        "status": result.status.name,
        "message": result.message,
        "q": result.posture,
        "position_error": result.position_error,
        "rotation_error": result.rotation_error,
        "iterations": result.iterations,
    }
