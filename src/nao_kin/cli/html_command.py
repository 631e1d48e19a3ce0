"""`nao-kin html`: a page that shows a robot, in a posture or several, or in motion."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import parse_posture

if TYPE_CHECKING:
    from nao_kin.view.contents import Content

__all__ = ["html"]


def html(
    robot: Annotated[str, typer.Argument(help="A known robot or the path of a URDF.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The page to write.")],
    posture: Annotated[list[str] | None, typer.Option(help="NAME=VALUE [rad, m], repeated; the rest is at 0.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="--posture is in degrees.")] = False,
    postures: Annotated[
        Path | None, typer.Option(help="JSON file of one posture [rad, m], or of several by name.")
    ] = None,
    trajectory: Annotated[Path | None, typer.Option(help="A trajectory file, to be played.")] = None,
    gait: Annotated[str | None, typer.Option(help="A hexapod walks: tripod, ripple or wave.")] = None,
    max_mb: Annotated[float, typer.Option(help="Largest page [MB]; meshes are simplified to stay below it.")] = 5.0,
) -> None:
    """Write one self-contained HTML page of a robot: no server, no network.

    It shows the robot in its neutral posture, or with one of --posture, --postures, --trajectory and --gait. Pages of
    solutions are written by nao-kin ik --html, of comparisons by nao-kin compare --html.
    """
    from nao_kin.robot.robot import load
    from nao_kin.view.export import export_html

    if sum(map(bool, (posture, postures, trajectory, gait))) > 1:
        raise typer.BadParameter("one of --posture, --postures, --trajectory and --gait is enough.")
    model = load(robot)
    if gait is not None:
        from nao_kin.motion.hexapod.gait import walk
        from nao_kin.motion.hexapod.walk_request import WalkCommand

        typer.echo(f"wrote {export_html(output, model, walk(model, WalkCommand(gait=gait)), max_mb=max_mb)}", err=True)
        return
    content = parse_posture(posture, deg, model) if posture else _content(postures, trajectory)
    typer.echo(f"wrote {export_html(output, model, content, max_mb=max_mb)}", err=True)


def _content(postures: Path | None, trajectory: Path | None) -> Content | None:
    if trajectory is not None:
        from nao_kin.trajectory.files.reading import read_trajectory

        return read_trajectory(trajectory)
    return None if postures is None else _read_postures(postures)


def _read_postures(path: Path) -> Any:
    """A posture, or postures by name, out of a JSON file; what they hold is checked where they are shown."""
    try:
        read = json.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        raise typer.BadParameter(f"{path}: no JSON: {error}.") from None
    if not isinstance(read, dict):
        raise typer.BadParameter(f"{path}: expected an object of joint names and numbers, or of such objects.")
    return read
