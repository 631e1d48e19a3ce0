"""`nao-kin bench servo`: how much smaller a servo's tracking error is with velocity feed-forward, at the same gains."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from nao_kin.motion.loop.plants import Plant
    from nao_kin.robot.motors import Motors
    from nao_kin.trajectory import Trajectory

__all__ = ["servo"]

_START: Final = (0.3, 3.0, 2.0, 0.5, -0.5, 0.2)  # [rad]
_WAY: Final = (1.0, 0.6, -0.8, 1.2, 0.9, -1.0)  # [rad]
_ACCELERATION: Final = 1.0  # [rad/s²]
_PACE: Final = 0.7  # of the greatest speeds, so that a servo that lags can catch up
_PERIOD: Final = 0.01  # [s]
_ENOUGH: Final = 5.0
_INTEGRAL_TIMES: Final = (0.2, 0.5, 1.0)  # [s]
_PI_OVERSHOOT: Final = 0.1  # a PI servo answers every step with some


def servo(
    dynamics: Annotated[bool, typer.Option(help="Also on rigid-body dynamics, which takes longer.")] = True,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """All six axes of a JACO2 along a synchronised motion, without and with velocity feed-forward at the same gains."""
    from nao_kin.motion.loop.plants import RigidBodies, VelocityServos
    from nao_kin.robot.motors import Motors
    from nao_kin.robot.robot import load

    machine, motors = Machine(), Motors.of(load("jaco2"))
    cases: list[tuple[str, Plant, bool]] = [
        ("1st order, P", VelocityServos(motors), False),
        ("1st order, PI", VelocityServos(motors), True),
    ]
    if dynamics:
        cases.append(("rigid, P", RigidBodies(motors, np.array(_START)), False))
    paced, fastest = _reference(motors, _PACE), _reference(motors, 1.0)
    rows = [_row(name, plant, paced, integral) for name, plant, integral in cases]
    flat_out = [_row(name, plant, fastest, integral) for name, plant, integral in cases]
    bounds = [
        Promise(f"{row['case']}: {size} error falls, times", row[key], _ENOUGH) for row in rows for size, key in _SIZES
    ]
    sheets = [
        Sheet("rows", _TITLE, _HEADINGS, rows),
        Sheet("flat_out", f"{_TITLE}, at all of the greatest speeds", _HEADINGS, flat_out),
    ]
    conclude(machine, sheets, bounds, _NOTES, format, goals)


def _reference(motors: Motors, pace: float) -> Trajectory:
    """The motion, its speeds at most so much of the greatest ones."""
    from nao_kin.trajectory.joint_space import joint_motion

    start, way = np.array(_START), np.array(_WAY)
    return joint_motion(
        motors,
        start,
        start + way,
        acceleration=_ACCELERATION,
        max_velocity=pace * motors.max_velocity,
        straight=True,
        sampling=_PERIOD,
    )


_SIZES = (("RMS", "rms_ratio"), ("largest", "largest_ratio"))
_TITLE = "Tracking errors [mrad] without and with feed-forward"
_HEADINGS = (
    Heading("case", "plant, servo"),
    Heading("kp", "kp [1/s]", ".1f"),
    Heading("ki", "ki [1/s²]", ".1f"),
    Heading("rms_without", "RMS", ".1f"),
    Heading("rms_with", "with", ".2f"),
    Heading("rms_ratio", "ratio", ".1f"),
    Heading("largest_without", "max", ".1f"),
    Heading("largest_with", "with", ".1f"),
    Heading("largest_ratio", "ratio", ".1f"),
)
_NOTES = (
    "RMS and largest (max) errors of all joints, and how many times smaller they are. Gains: of a fixed ladder the one "
    "with the least RMS error of the run without feed-forward, among those whose answer to a small step overshoots by "
    "at most 1 % (P) or 10 % (PI). Rigid: forward dynamics with gravity, effort limits and drives that know gravity. "
    f"The motion of the first table, whose goals count, takes at most {100 * _PACE:g} % of the greatest speeds: at all "
    "of them no command is left to catch up with, and feed-forward is worth less.",
)


def _row(case: str, plant: Plant, reference: Trajectory, integral: bool) -> dict[str, Any]:
    from nao_kin.motion.loop.servo import P_OVERSHOOT, compare_feed_forward, tune

    times, allowed = (_INTEGRAL_TIMES, _PI_OVERSHOOT) if integral else ((), P_OVERSHOOT)
    gains = tune(plant, reference, integral_times=times, allowed=allowed, period=_PERIOD)
    found = compare_feed_forward(plant, reference, gains, period=_PERIOD)
    return {
        "case": case,
        "kp": gains.position,
        "ki": gains.integral,
        "rms_without": 1e3 * found.without.rms_error,
        "rms_with": 1e3 * found.with_it.rms_error,
        "rms_ratio": found.rms_ratio,
        "largest_without": 1e3 * found.without.largest_error,
        "largest_with": 1e3 * found.with_it.largest_error,
        "largest_ratio": found.largest_ratio,
        "cut": int(found.with_it.cut.sum() + found.with_it.effort_cut.sum()),
    }
