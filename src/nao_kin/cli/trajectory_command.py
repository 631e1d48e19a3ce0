"""`nao-kin trajectory`: plan a motion into a file, run a file through a model, show what is in one."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Final, NoReturn

import typer

from nao_kin.cli.chain_arguments import (
    SPEC_HELP,
    chain_from_spec,
    chain_of_robot,
    document_or_file,
    parse_posture,
    robot_and_chain,
)
from nao_kin.output import FormatOption, OutputFormat, number, report, report_json

if TYPE_CHECKING:
    import pinocchio as pin

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain
    from nao_kin.table import Table
    from nao_kin.trajectory.demand import Demand
    from nao_kin.trajectory.following import FollowResult
    from nao_kin.trajectory.paths import Path
    from nao_kin.trajectory.replaying import Replay
    from nao_kin.trajectory.trajectory import Trajectory

__all__ = ["By", "curve", "curves", "headline", "joints_table", "plan", "run", "show", "trajectory_data"]

_LEVELS: Final = "▁▂▃▄▅▆▇█"
_WIDTH: Final = 40  # of a curve
_NAME: Final = 16  # of a joint


def headline(trajectory: Trajectory) -> str:
    """Name, number of samples, duration, and how far apart the samples are."""
    import numpy as np

    count = len(trajectory)
    said = f"{trajectory.name or 'trajectory'}: {count} sample{'s' if count > 1 else ''}, {trajectory.duration:.6g} s"
    if count < 2:
        return said
    steps = np.diff(trajectory.times)
    return f"{said}, {steps.min():.4g} to {steps.max():.4g} s apart"


def joints_table(demand: Demand, trajectory: Trajectory) -> Table:
    """A row a joint: where it starts, ends and goes, and how fast."""
    import math

    from nao_kin.table import Column, Style, Table

    rows, styles = [], dict[int, Style]()
    for i, (joint, column) in enumerate(zip(trajectory.joints, trajectory.q.T.tolist(), strict=True)):
        numbers = [column[0], column[-1], min(column), max(column)]
        limit = float(demand.max_velocity[i])
        allowed = f"{limit:.4f}" if math.isfinite(limit) else ""
        rows.append((_shortened(joint.name), *(_fixed(x) for x in numbers), f"{demand.speed[i]:.4f}", allowed))
        if any(fault.startswith(f"{joint.name} ") for fault in demand.faults):
            styles[i] = "bad"
    headings = ("start", "end", "least", "greatest", "speed", "limit")
    columns = (Column("joint"), *(Column(heading, number=True) for heading in headings))
    note = "Values [rad, m]; the largest speed from sample to sample [rad/s, m/s]."
    return Table(columns, tuple(rows), title=headline(trajectory), note=note, styles=styles)


def curves(trajectory: Trajectory) -> list[str]:
    """Two lines a joint: its value and its speed over time."""
    import numpy as np

    lines = []
    middles = (trajectory.times[1:] + trajectory.times[:-1]) / 2.0
    for i, joint in enumerate(trajectory.joints):
        value = trajectory.q[:, i]
        lines.append(_line(joint.name, "q", trajectory.times, value))
        if len(trajectory) > 1:
            lines.append(_line("", "v", middles, np.asarray(trajectory.velocities[:, i])))
    return lines


def curve(times: Floats, values: Floats, width: int = _WIDTH) -> str:
    """Values over time as one line of bars, the lowest for the least value, evenly spaced in time."""
    import numpy as np

    lowest, span = float(values.min()), float(values.max() - values.min())
    if not span > 0.0:
        return _LEVELS[0] * width
    shares = (np.interp(np.linspace(times[0], times[-1], width), times, values) - lowest) / span
    return "".join(_LEVELS[min(int(share * len(_LEVELS)), len(_LEVELS) - 1)] for share in shares)


def trajectory_data(trajectory: Trajectory, demand: Demand) -> dict[str, Any]:
    """A trajectory's figures as plain data, without its samples."""
    return {
        "name": trajectory.name,
        "samples": len(trajectory),
        "start_time": float(trajectory.times[0]),
        "duration": trajectory.duration,
        "joints": [
            {
                "name": joint.name,
                "kind": joint.kind,
                "start": float(column[0]),
                "end": float(column[-1]),
                "least": float(column.min()),
                "greatest": float(column.max()),
                "speed": float(demand.speed[i]),
                "speed_at": int(demand.speed_at[i]),
                "max_velocity": float(demand.max_velocity[i]),
                "acceleration": float(demand.acceleration[i]),
                "acceleration_at": int(demand.acceleration_at[i]),
            }
            for i, (joint, column) in enumerate(zip(trajectory.joints, trajectory.q.T, strict=True))
        ],
        "faults": list(demand.faults),
    }


def _line(name: str, what: str, times: Floats, values: Floats) -> str:
    ends = f"{_fixed(float(values.min())):>8}  {curve(times, values)}  {_fixed(float(values.max())):>8}"
    return f"{_shortened(name):<{_NAME}} {what} {ends}"


def _shortened(name: str) -> str:
    """A name that leaves room for its row, without what would spoil a terminal."""
    plain = "".join(letter if letter.isprintable() else "?" for letter in name)
    return plain if len(plain) <= _NAME else plain[: _NAME - 1] + "…"


def _fixed(value: float) -> str:
    text = f"{round(value, 4) + 0.0:.4f}"
    return text if len(text) <= 8 else f"{value:.1e}"


Triple = tuple[float, float, float]


class By(StrEnum):
    """How to get there."""

    line = "line"
    screw = "screw"
    joints = "joints"


@dataclass(frozen=True, slots=True)
class _Rates:
    """How fast, as typed."""

    speed: float
    acceleration: float
    braking: float | None
    turn_speed: float
    turn_acceleration: float
    joint_acceleration: float | None
    sampling: float


@dataclass(frozen=True, slots=True)
class _Ends:
    """From where to where: joints at the start, and at the end either joints or a place (3,) or pose of the tip."""

    path: UrdfChain
    q_start: Floats
    q_end: Floats | None
    target: Floats | pin.SE3 | None


def plan(
    robot: Annotated[str, typer.Argument(help="ROBOT, ROBOT:CHAIN or ROBOT:BASE:TIP.")],
    chain: Annotated[str | None, typer.Option(help="A named chain of the robot, as left_arm.")] = None,
    base: Annotated[str | None, typer.Option(help="Base frame; default the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip frame.")] = None,
    start: Annotated[list[str] | None, typer.Option("--from", help="NAME=VALUE, repeated: the start.")] = None,
    end: Annotated[list[str] | None, typer.Option("--to", help="NAME=VALUE, repeated: the end.")] = None,
    xyz: Annotated[Triple | None, typer.Option(help="The end: a position in the base frame [m].")] = None,
    rpy: Annotated[Triple | None, typer.Option(help="Its roll pitch yaw [rad]; without it any will do.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="--rpy, --from and --to are in degrees.")] = False,
    by: Annotated[By, typer.Option(help="A straight line of the tip, a screw, or joint by joint.")] = By.line,
    speed: Annotated[float, typer.Option(help="Of the tip [m/s].")] = 0.1,
    acceleration: Annotated[float, typer.Option(help="Of the tip [m/s²].")] = 0.5,
    braking: Annotated[float | None, typer.Option(help="Of the tip [m/s²]; as --acceleration.")] = None,
    turn_speed: Annotated[float, typer.Option(help="Of the tip [rad/s].")] = 1.0,
    turn_acceleration: Annotated[float, typer.Option(help="Of the tip [rad/s²].")] = 5.0,
    joint_acceleration: Annotated[float | None, typer.Option(help="Of every joint [rad/s², m/s²].")] = None,
    sampling: Annotated[float, typer.Option(help="Time between samples [s].")] = 0.01,
    scale: Annotated[bool, typer.Option("--scale/--no-scale", help="Slow down for joints' limits.")] = True,
    output: Annotated[str | None, typer.Option(help="File to write: .txt, .csv or .json.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Plan a motion; exit status 1, and no file, where the robot cannot do it."""
    from nao_kin.trajectory.files.reading import form_of

    if output is not None:
        form_of(output)  # before the work, not after it
    model, path = robot_and_chain(robot, chain, base, tip)
    rates = _Rates(speed, acceleration, braking, turn_speed, turn_acceleration, joint_acceleration, sampling)
    if (xyz is None) == (not end):
        raise typer.BadParameter("say where to: either --xyz (and --rpy), or --to.")
    if rpy is not None and xyz is None:
        raise typer.BadParameter("--rpy goes with --xyz; a posture has its own orientation.")
    q_end = _q(model, path, end, deg) if end else None
    ends = _Ends(path, _q(model, path, start or [], deg), q_end, _target(xyz, rpy, deg))
    if by is By.joints:
        _conclude(_by_joints(ends, rates, format), None, output, format)
        return
    found = _by_path(ends, by, rates, scale)
    if not found.completed or found.trajectory is None:
        _say_no(found.reason, path, format, found)
    _conclude(found.trajectory, found, output, format)


def _q(robot: Robot, path: UrdfChain, words: list[str], degrees: bool) -> Floats:
    """Joints of the path: what is not named is at the robot's neutral posture."""
    return path.q_of(robot.complete(parse_posture(words, degrees, robot)))


def _target(xyz: Triple | None, rpy: Triple | None, degrees: bool) -> Floats | pin.SE3 | None:
    import numpy as np

    from nao_kin.se3 import from_xyz_rpy

    if xyz is None:
        return None
    place = np.array(xyz)
    return place if rpy is None else from_xyz_rpy(place, np.radians(rpy) if degrees else np.array(rpy))


def _by_joints(ends: _Ends, rates: _Rates, format: OutputFormat) -> Trajectory:
    from nao_kin.ik.single import solve
    from nao_kin.trajectory.joint_space import joint_motion

    path, q_end = ends.path, ends.q_end
    if ends.target is not None:
        result = solve(path, ends.target, ends.q_start)
        if not result.solved:
            _say_no(result.message, path, format)
        q_end = result.q
    assert q_end is not None  # noqa: S101 - one of both is given
    rate = 2.0 if rates.joint_acceleration is None else rates.joint_acceleration
    name = f"{path.robot.name} {path.tip} by joints"
    return joint_motion(path, ends.q_start, q_end, acceleration=rate, sampling=rates.sampling, name=name)


def _by_path(ends: _Ends, by: By, rates: _Rates, scale: bool) -> FollowResult:
    from nao_kin.trajectory.following import follow
    from nao_kin.trajectory.timing import timed

    walked = timed(
        _way(ends, by),
        speed=rates.speed,
        acceleration=rates.acceleration,
        braking=rates.braking,
        turn_speed=rates.turn_speed,
        turn_acceleration=rates.turn_acceleration,
        sampling=rates.sampling,
    )
    name = f"{ends.path.robot.name} {ends.path.tip} by {by.value}"
    return follow(ends.path, walked, ends.q_start, scale=scale, max_acceleration=rates.joint_acceleration, name=name)


def _way(ends: _Ends, by: By) -> Path:
    import numpy as np

    from nao_kin.trajectory.paths import PoseLine, PositionLine, Screw

    first = ends.path.pose(ends.q_start)
    last = ends.target if ends.q_end is None else ends.path.pose(ends.q_end)
    if isinstance(last, np.ndarray):
        if by is By.screw:
            raise typer.BadParameter("--by screw needs an orientation: give --rpy too.")
        return PositionLine(first.translation, last)
    return Screw(first, last) if by is By.screw else PoseLine(first, last)


def _say_no(why: str, path: UrdfChain, format: OutputFormat, found: FollowResult | None = None) -> NoReturn:
    """Reports a motion that there is not.

    Raises:
        typer.Exit: Always, with status 1.
    """
    if format is OutputFormat.json:
        data: dict[str, Any] = {"chain": path.name, "completed": False, "reason": why}
        if found is not None:
            data |= {"cause": found.cause.name, "ended_at": found.ended_at, "samples": found.samples}
        report_json(data)
    else:
        reached = "" if found is None else f"{len(found.q)} of {found.samples} samples are reached."
        report(f"{path.name}: {path.base} → {path.tip}: no such motion. {reached}".rstrip(), why)
    raise typer.Exit(1)


def _conclude(motion: Trajectory, found: FollowResult | None, output: str | None, format: OutputFormat) -> None:
    from nao_kin.trajectory.demand import demand_of
    from nao_kin.trajectory.files.reading import write_trajectory

    demand = demand_of(motion) if found is None or found.demand is None else found.demand
    if format is OutputFormat.json:
        report_json(_data(motion, found) | trajectory_data(motion, demand))
    else:
        report(joints_table(demand, motion), *_errors(found))
    if not demand.kept:
        raise typer.Exit(1)
    if output is not None:
        typer.echo(f"wrote {write_trajectory(output, motion)}", err=True)


def _data(motion: Trajectory, found: FollowResult | None) -> dict[str, Any]:
    if found is None:
        return {"completed": True, "samples": len(motion)}
    return {
        "completed": found.completed,
        "reason": found.reason,
        "max_position_error": found.max_position_error,
        "max_rotation_error": found.max_rotation_error,
        "position_error_between": found.position_error_between,
        "rotation_error_between": found.rotation_error_between,
        "largest_move": found.largest_move,
        "smallest_singular_value": found.smallest_singular_value,
        "slowed": found.slowed,
    }


def _errors(found: FollowResult | None) -> list[str]:
    if found is None:
        return []
    slowed = f" It takes {found.slowed:.3g} times as long as was asked." if found.slowed > 1.0 + 1e-9 else ""
    return [
        "",
        found.reason + slowed,
        f"Errors: at most {found.max_position_error:.2g} m at samples, {found.position_error_between:.2g} m between.",
    ]


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
        report_json(_replay_data(found))
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


def _replay_data(found: Replay) -> dict[str, Any]:
    return trajectory_data(found.trajectory, found.demand) | {
        "possible": found.possible,
        "faults": list(found.faults),
        "tip_start": found.tips[0],
        "tip_end": found.tips[-1],
        "tip_path_length": found.tip_path_length,
        "tip_speed": float(found.tip_speeds.max(initial=0.0)),
        "off_the_line": found.off_the_line,
    }


def show(
    file: Annotated[str, typer.Argument(help="A trajectory: .txt, .csv or .json.")],
    curve: Annotated[bool, typer.Option("--curves/--no-curves", help="Draw values and speeds over time.")] = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """The joints of a trajectory, their ranges and speeds, and curves; exit status 1 where its own limits are left."""
    from nao_kin.trajectory.demand import demand_of
    from nao_kin.trajectory.files.reading import read_trajectory

    motion = read_trajectory(file)
    demand = demand_of(motion)
    outside = [
        f"{joint.name} is outside its own range [{joint.lower:.6g}, {joint.upper:.6g}] at sample {sample}."
        for joint, column in zip(motion.joints, motion.q.T, strict=True)
        for sample in [
            next((k for k, value in enumerate(column.tolist()) if not joint.lower <= value <= joint.upper), None)
        ]
        if sample is not None
    ]
    if format is OutputFormat.json:
        data = trajectory_data(motion, demand)
        report_json(data | {"faults": [*outside, *data["faults"]]})
    else:
        report(joints_table(demand, motion))
        if curve:
            report("", *curves(motion))
        report(*(["", *outside, *demand.faults] if outside or demand.faults else []))
    if outside or demand.faults:
        raise typer.Exit(1)


trajectory = typer.Typer(help="Motions over time, in files.", no_args_is_help=True, rich_markup_mode=None)
trajectory.command()(plan)
trajectory.command()(run)
trajectory.command()(show)
