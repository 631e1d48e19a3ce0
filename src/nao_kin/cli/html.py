"""`nao-kin html`: a page that shows a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nao_kin.cli.chains import parse_posture

__all__ = ["html"]


def html(
    robot: Annotated[str, typer.Argument(help="A known robot or the path of a URDF.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The page to write.")],
    posture: Annotated[list[str] | None, typer.Option(help="NAME=VALUE [rad, m], repeated; the rest is at 0.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="--posture is in degrees.")] = False,
    max_mb: Annotated[float, typer.Option(help="Largest page [MB]; meshes are simplified to stay below it.")] = 5.0,
) -> None:
    """Write one self-contained HTML page of a robot in a posture: no server, no network."""
    from nao_kin.robot import load
    from nao_kin.view.export import export_html

    model = load(robot)
    chosen = parse_posture(posture, deg, model) if posture else None
    typer.echo(f"wrote {export_html(output, model, chosen, max_mb=max_mb)}", err=True)
