"""`nao-kin bench gait`: feet that are to stay where they are, of a walking hexapod and under a moving torso."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    import pinocchio as pin

    from nao_kin.arrays import Floats
    from nao_kin.motion.hexapod.gait import Walk
    from nao_kin.robot.robot import Robot

__all__ = ["gait"]

# What the body does: velocity forward and to the left [m/s], turn rate [rad/s], pose [m, rad].
_WAYS: Final[tuple[tuple[str, dict[str, Any]], ...]] = (
    ("ahead", {"velocity": (0.08, 0.0)}),
    ("back, left, turns", {"velocity": (-0.05, 0.05), "turn": -0.1}),
    ("turns, leaning", {"velocity": (0.0, 0.0), "turn": 0.3, "body": (0.01, -0.01, 0.01, 0.05, -0.05, 0.1)}),
    ("right, turns, leaning", {"velocity": (0.0, -0.05), "turn": 0.2, "body": (0.0, 0.0, -0.01, -0.1, 0.05, -0.1)}),
)
_SHARES: Final = {"tripod": 1.0, "ripple": 0.6, "wave": 0.3}
_DIRECTIONS: Final[tuple[tuple[str, dict[str, Any]], ...]] = (
    ("ahead", {"velocity": (0.1, 0.0)}),
    ("sideways", {"velocity": (0.0, 0.1)}),
    ("turning", {"velocity": (0.0, 0.0), "turn": 0.5}),
)
_STANDING_BOUND: Final = 1e-9  # [m]
_TORSO_BOUND: Final = 1e-6  # [m]
_SAMPLES: Final = 25


def gait(
    paths: Annotated[int, typer.Option(min=1, help="Random paths of the torso.")] = 20,
    seed: Annotated[int, typer.Option(help="Seed of the paths.")] = 0,
    duration: Annotated[float, typer.Option(min=0.5, help="How long each walk is [s].")] = 10.0,
    speeds: Annotated[bool, typer.Option("--speeds/--no-speeds", help="Look for the greatest speeds.")] = True,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Ten seconds of every gait, how fast each can be, and torsos that move over a NAO's feet."""
    from nao_kin.robot.robot import load

    machine, hexapod = Machine(), load("phantomx")
    cases = [(name, what, way) for name in _SHARES for what, way in _WAYS]
    rows = [_walked(hexapod, duration, *case) for case in progress(cases, "walking", len(cases))]
    greatest = [_speed_sheet(_speeds(hexapod))] if speeds else []
    torsos = [_torso(give, paths, seed) for give in progress(("feet", "yaw"), "moving the torso", 2)]
    sheets = [_walking_sheet(rows, duration), *greatest, _torso_sheet(torsos, paths)]
    moved = max(float(row["slip"]) for row in rows)
    far = max(float(row["far"]) for row in torsos)
    bounds = [
        Promise("walks that can be walked", float(sum(row["walkable"] for row in rows)), float(len(rows))),
        Promise("a standing foot moves [m]", moved, _STANDING_BOUND, at_least=False),
        Promise("torso motions that can be done", float(sum(row["done"] for row in torsos)), 2.0 * paths),
        Promise("a NAO's foot moves [m]", far, _TORSO_BOUND, at_least=False),
    ]
    conclude(machine, sheets, bounds, [], format, goals)


def _walked(robot: Robot, duration: float, name: str, what: str, way: dict[str, Any]) -> dict[str, Any]:
    from nao_kin.motion.hexapod.gait import walk
    from nao_kin.motion.hexapod.walk_request import WalkCommand

    found = walk(robot, WalkCommand(gait=name, duration=duration, **way).at_speed(_SHARES[name]))
    return {
        "gait": name,
        "way": what,
        "seconds": found.attempt.duration,
        "walkable": found.walkable,
        "down": int(found.stance.sum(axis=1).min()),
        "slip": _slip(robot, found),
        "between": found.slip_between,
        "margin": 1e3 * found.least,
        "share": 100.0 * float(found.speed_share.max()),
    }


def _slip(robot: Robot, found: Walk) -> float:
    """Farthest that a standing foot gets from where it began to stand [m], by the whole robot."""
    import numpy as np

    places, farthest = dict[str, Any](), 0.0
    for i, T in enumerate(found.T_world_body):
        poses = robot.link_poses(found.attempt.posture(i))
        for k, leg in enumerate(found.legs):
            foot = T[:3, :3] @ poses[f"foot_{leg}"].translation + T[:3, 3]
            if not found.stance[i, k]:
                places.pop(leg, None)
                continue
            farthest = max(farthest, float(np.linalg.norm(foot - places.setdefault(leg, foot))))
    return farthest


def _speeds(robot: Robot) -> list[dict[str, Any]]:
    from nao_kin.motion.hexapod.gait import fastest
    from nao_kin.motion.hexapod.walk_request import WalkCommand

    rows = []
    for name in progress(list(_SHARES), "looking for the greatest speeds", len(_SHARES)):
        command = WalkCommand(gait=name)
        row: dict[str, Any] = {"gait": name, "cycle": command.period, "duty": command.rhythm.duty}
        for what, way in _DIRECTIONS:
            found = fastest(robot, replace(command, duration=3.0 * command.period, **way))
            row[what] = found.command.turn if what == "turning" else max(found.command.velocity)
        rows.append(row)
    return rows


def _torso(give: str, paths: int, seed: int) -> dict[str, Any]:
    import numpy as np

    from nao_kin.motion.nao.feet import torso_motion
    from nao_kin.robot.robot import load

    robot, times, rng = load("nao"), np.linspace(0.0, 4.0, _SAMPLES), np.random.default_rng(seed)
    motions = [torso_motion(robot, times, _path(rng, times), give=give) for _ in range(paths)]  # type: ignore[arg-type]
    return {
        "give": give,
        "done": sum(motion.trajectory is not None for motion in motions),
        "far": max(float(motion.position_errors.max()) for motion in motions),
        "turned": max(float(motion.rotation_errors.max()) for motion in motions),
        "yaw": max(float(np.abs(motion.yaw).max()) for motion in motions),
    }


def _path(rng: Any, times: Floats) -> list[pin.SE3]:
    """A random path of the torso that begins where it stands: three harmonics in each axis, to 15 mm and 0.08 rad."""
    import numpy as np

    from nao_kin.se3 import from_xyz_rpy

    sizes = np.array([0.015, 0.015, 0.012, 0.08, 0.08, 0.08])
    amplitudes = 0.5 * rng.uniform(-1.0, 1.0, (6, 3)) * sizes[:, None]
    waves = np.sin(np.outer(np.arange(1, 4), np.pi * times / times[-1]))
    return [from_xyz_rpy(six[:3], six[3:]) for six in (amplitudes @ waves).T]


def _walking_sheet(rows: list[dict[str, Any]], duration: float) -> Sheet:
    headings = (
        Heading("gait", "gait"),
        Heading("way", "the body goes"),
        Heading("down", "down", "d"),
        Heading("slip", "foot moves [m]", ".1e"),
        Heading("margin", "margin [mm]", ".0f"),
        Heading("share", "speed [%]", ".0f"),
    )
    return Sheet("walks", f"PhantomX, {duration:g} s each; joint speed in % of what is allowed", headings, rows)


def _speed_sheet(rows: list[dict[str, Any]]) -> Sheet:
    headings = (
        Heading("gait", "gait"),
        Heading("duty", "duty", ".3f"),
        Heading("cycle", "cycle [s]", ".1f"),
        Heading("ahead", "ahead [m/s]", ".3f"),
        Heading("sideways", "sideways [m/s]", ".3f"),
        Heading("turning", "turning [rad/s]", ".2f"),
    )
    return Sheet("speeds", "greatest speeds, found to a hundredth", headings, rows)


def _torso_sheet(rows: list[dict[str, Any]], paths: int) -> Sheet:
    headings = (
        Heading("give", "gives way"),
        Heading("done", "done", "d"),
        Heading("far", "feet move [m]", ".1e"),
        Heading("turned", "feet turn [rad]", ".1e"),
        Heading("yaw", "torso yaws [rad]", ".1e"),
    )
    return Sheet("torsos", f"NAO, {paths} random paths of the torso in six axes", headings, rows)
