"""`nao-kin ik`: joints that bring a tip to a target."""

from __future__ import annotations

from typing import Annotated

import typer

from nao_kin.cli.chains import chain_of_robot, parse_posture
from nao_kin.cli.output import FormatOption, OutputFormat, report, report_json

__all__ = ["ik"]

Triple = tuple[float, float, float]


def ik(
    robot: Annotated[str, typer.Argument(help="A known robot or the path of a URDF.")],
    chain: Annotated[str | None, typer.Option(help="A named chain of the robot, as left_arm.")] = None,
    base: Annotated[str | None, typer.Option(help="Base frame; default the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip frame.")] = None,
    xyz: Annotated[Triple | None, typer.Option(help="Wanted position in the base frame [m].")] = None,
    rpy: Annotated[Triple | None, typer.Option(help="Wanted roll pitch yaw [rad]; without it any will do.")] = None,
    posture: Annotated[list[str] | None, typer.Option(help="NAME=VALUE, repeated: the target is its pose.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="--rpy and --posture are in degrees.")] = False,
    method: Annotated[str, typer.Option(help="Method.")] = "lm",
    seed: Annotated[int, typer.Option(help="Seed of the random restarts.")] = 0,
    html: Annotated[str | None, typer.Option(help="Write a page that shows the solution.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Inverse kinematics: joints that bring the tip to a position, a pose, or where a posture has it."""
    import numpy as np

    from nao_kin.ik.methods import solve
    from nao_kin.robot import load
    from nao_kin.se3 import from_xyz_rpy

    if (xyz is None) == (not posture):
        raise typer.BadParameter("say where to: either --xyz (and --rpy), or --posture.")
    model = load(robot)
    path = chain_of_robot(model, chain, base, tip)
    if posture:
        target = model.pose(parse_posture(posture, deg, model), path.tip, path.base)
    elif rpy is None:
        target = np.array(xyz)
    else:
        target = from_xyz_rpy(xyz or (0, 0, 0), np.radians(rpy) if deg else np.array(rpy))
    result = solve(path, target, method=method, seed=seed)
    if html is not None:
        from nao_kin.view.export import export_html

        typer.echo(f"wrote {export_html(html, model, result.posture)}", err=True)
    if format is OutputFormat.json:
        report_json(
            {
                "chain": path.name,
                "solved": result.solved,
                "status": result.status.name,
                "message": result.message,
                "q": result.posture,
                "position_error": result.position_error,
                "rotation_error": result.rotation_error,
                "iterations": result.iterations,
            }
        )
    else:
        from nao_kin.cli.tables import joint_table

        report(joint_table(path, result.q, f"{path.name}: {path.base} → {path.tip}"), result.message)
    if not result.solved:
        raise typer.Exit(1)
