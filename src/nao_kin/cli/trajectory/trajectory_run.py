"""`nao-kin trajectory run`: a file read again and run through a model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import SPEC_HELP, chain_from_spec, chain_of_robot, document_or_file
from nao_kin.cli.trajectory.summary import joints_table, trajectory_data
from nao_kin.output import FormatOption, OutputFormat, number, report, report_json

if TYPE_CHECKING:
    from nao_kin.chain import Chain
    from nao_kin.trajectory.replaying import Replay

__all__ = ["run"]


def run(
    file: Annotated[str, typer.Argument(help="A trajectory: .txt, .csv or .json.")],
    robot: Annotated[str, typer.Argument(help=SPEC_HELP)],
    chain: Annotated[str | None, typer.Option(help="A named chain of the robot, as left_arm.")] = None,
    base: Annotated[str | None, typer.Option(help="Base frame; default the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip frame.")] = None,
    max_acceleration: Annotated[float | None, typer.Option(help="Of every joint [rad/s², m/s²].")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Forward kinematics of every sample, joint limits and speeds; exit status 1 where the robot cannot do it."""
    from nao_kin.trajectory.files.reading import read_trajectory
    from nao_kin.trajectory.replaying import replay

    found = replay(_chain(robot, chain, base, tip), read_trajectory(file), max_acceleration=max_acceleration)
    if format is OutputFormat.json:
        report_json(_data(found))
    else:
        report(joints_table(found.demand, found.trajectory), "", *_tip(found))
        report("", *(found.faults or ["Every joint stays within its range and its speed."]))
    if not found.possible:
        raise typer.Exit(1)


def _chain(robot: str, name: str | None, base: str | None, tip: str | None) -> Chain:
    if name is None and base is None and tip is None:
        return chain_from_spec(robot)
    if document_or_file(robot) is not None:
        raise typer.BadParameter(f"{robot} is a table: it has one chain, without --chain, --base or --tip.")
    from nao_kin.robot.robot import load

    return chain_of_robot(load(robot), name, base, tip)


def _tip(found: Replay) -> list[str]:
    places = [" ".join(number(x, 4) for x in found.tips[k, :3, 3]) for k in (0, -1)]
    lines = [f"The tip goes from ({places[0]}) to ({places[1]}) [m], {found.tip_path_length:.4f} m on its way."]
    if len(found.trajectory) > 1:
        speed = float(found.tip_speeds.max())
        lines.append(
            f"Its largest speed is {speed:.4f} m/s; it leaves the straight line by {found.off_the_line:.3g} m."
        )
    return lines


def _data(found: Replay) -> dict[str, Any]:
    return trajectory_data(found.trajectory, found.demand) | {
        "possible": found.possible,
        "faults": list(found.faults),
        "tip_start": found.tips[0],
        "tip_end": found.tips[-1],
        "tip_path_length": found.tip_path_length,
        "tip_speed": float(found.tip_speeds.max(initial=0.0)),
        "off_the_line": found.off_the_line,
    }
