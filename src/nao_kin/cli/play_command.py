"""`nao-kin play`: a file of keyframes becomes a motion, and what is measured of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.motion.nao.keyframes import Played

__all__ = ["play"]


def play(
    file: Annotated[str, typer.Argument(help="A TOML file of keyframes, or wave, the example that comes along.")],
    robot: Annotated[str | None, typer.Option(help="Another robot than the file names: known, or a URDF.")] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write the motion: .txt, .csv, .json.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Keyframes, named postures and times, as a motion within limits and joint speeds, or why it cannot be played.

    Exit status 1 means that it cannot be played as the file wants it.
    """
    from nao_kin.motion.nao.keyframe_file import EXAMPLE, read_keyframes
    from nao_kin.motion.nao.keyframes import play as played
    from nao_kin.robot.robot import load

    model = None if robot is None else load(robot)
    found = played(read_keyframes(EXAMPLE if file == "wave" else file, model))
    if format is OutputFormat.json:
        report_json(_data(found))
    else:
        report(found.table(), found.message)
    if found.trajectory is None:
        raise typer.Exit(1)
    if output is not None:
        from nao_kin.trajectory.files.reading import write_trajectory

        typer.echo(f"wrote {write_trajectory(output, found.trajectory)}", err=True)


def _data(found: Played) -> dict[str, Any]:
    """A motion as plain data."""
    return {
        "name": found.keyframes.name,
        "robot": found.keyframes.robot.name,
        "playable": not found.refused,
        "message": found.message,
        "between": found.keyframes.between,
        "keyframes": [key.posture for key in found.keyframes.keys],
        "asked": found.asked,
        "times": found.times,
        "refused": [
            {"what": r.what, "reason": r.reason, "from": r.time, "worst": r.worst, "amount": r.amount, "unit": r.unit}
            for r in found.refused
        ],
    }
