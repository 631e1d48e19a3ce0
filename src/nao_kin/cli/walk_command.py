"""`nao-kin walk`: a hexapod walks, and what is measured of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.motion.hexapod.gait import Walk

__all__ = ["walk"]

Pair = tuple[float, float]
Triple = tuple[float, float, float]


def walk(
    robot: Annotated[str, typer.Argument(help="A hexapod: a known robot.")] = "phantomx",
    gait: Annotated[str, typer.Option(help="tripod, ripple or wave.")] = "tripod",
    velocity: Annotated[Pair, typer.Option(help="Forward and to the left [m/s].")] = (0.04, 0.0),
    turn: Annotated[float, typer.Option(help="Turn rate, counter-clockwise [rad/s].")] = 0.0,
    duration: Annotated[float, typer.Option(help="How long the body moves [s].")] = 10.0,
    shift: Annotated[Triple, typer.Option(help="The body moved by x y z while it walks [m].")] = (0.0, 0.0, 0.0),
    rpy: Annotated[Triple, typer.Option(help="The body turned by roll pitch yaw [rad].")] = (0.0, 0.0, 0.0),
    step_height: Annotated[float, typer.Option(help="How high feet are lifted [m].")] = 0.03,
    cycle: Annotated[float | None, typer.Option(help="Time of a cycle [s]; default half a second a swing.")] = None,
    margin: Annotated[float, typer.Option(help="How far the centre of mass must stay inside the feet [m].")] = 0.0,
    greatest: Annotated[bool, typer.Option("--fastest", help="The greatest multiple of the speed.")] = False,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write the motion: .txt, .csv, .json.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """A hexapod walks from standing to standing: reach, limits, joint speeds, balance and slip, measured.

    Exit status 1 means that it cannot be walked; then the greatest part of the speed that can be is named.
    """
    from nao_kin.motion.hexapod.gait import fastest
    from nao_kin.motion.hexapod.gait import walk as walked
    from nao_kin.motion.hexapod.walk_request import WalkCommand
    from nao_kin.robot.robot import load

    model = load(robot)
    command = WalkCommand(
        gait=gait,
        velocity=velocity,
        turn=turn,
        duration=duration,
        body=(*shift, *rpy),
        step_height=step_height,
        cycle=cycle,
        margin=margin,
    )
    found = fastest(model, command) if greatest else walked(model, command)
    slower = None if found.walkable or greatest else fastest(model, command)
    if format is OutputFormat.json:
        report_json(_data(found) | ({} if slower is None else {"fastest": _data(slower)}))
    else:
        vx, vy = found.command.velocity
        speed = f"Speed {vx:.4g} m/s forward, {vy:.4g} m/s to the left, {found.command.turn:.4g} rad/s turning; "
        speed += f"a cycle is {found.command.period:.3g} s, duty factor {found.command.rhythm.duty:.3g}."
        report(found.table(), speed, found.message, *([] if slower is None else [_hint(slower)]))
    if found.trajectory is None:
        raise typer.Exit(1)
    if output is not None:
        from nao_kin.trajectory.files.reading import write_trajectory

        typer.echo(f"wrote {write_trajectory(output, found.trajectory)}", err=True)


def _hint(slower: Walk) -> str:
    if not slower.walkable:
        return f"Not even stepping on the spot works: {slower.message}"
    (vx, vy), turn = slower.command.velocity, slower.command.turn
    return f"The fastest walk this way is at {vx:.4g} {vy:.4g} m/s, turning at {turn:.4g} rad/s."


def _data(found: Walk) -> dict[str, Any]:
    """A walk as plain data."""
    down = found.stance.sum(axis=1)
    return {
        "gait": found.command.rhythm.name,
        "walkable": found.walkable,
        "message": found.message,
        "velocity": list(found.command.velocity),
        "turn": found.command.turn,
        "duty": found.command.rhythm.duty,
        "cycle": found.command.period,
        "duration": found.attempt.duration,
        "feet_down": int(down.min()),
        "slip": found.slip,
        "slip_between_samples": found.slip_between,
        "least_margin": found.least,
        "joint_speed_share": dict(zip(found.attempt.joint_names, found.speed_share.tolist(), strict=True)),
        "refused": [
            {"what": r.what, "reason": r.reason, "from": r.time, "worst": r.worst, "amount": r.amount, "unit": r.unit}
            for r in found.refused
        ],
    }
