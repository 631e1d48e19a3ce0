"""`nao-kin bench trajectory`: profiles beside ruckig, lines of the JACO2, and what interpolation is good for."""

from __future__ import annotations

import importlib.util
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.trajectory.following import FollowResult

__all__ = ["InterpolationComparison", "compare", "trajectory"]

_START_DEG: Final = (180, 200, 120, 100, 80, 30)  # of the JACO2
_LINES: Final = (
    ("down", (0.0, 0.0, -0.3)),
    ("back", (-0.3, 0.0, 0.0)),
    ("aside and down", (0.0, 0.1, -0.2)),
    ("forward", (0.3, 0.0, 0.0)),
    ("out of reach", (0.0, 0.0, 0.8)),
)
_SAMPLES: Final = 500
_SECONDS: Final = 1.5  # for each line, so that joints are too fast for it


def trajectory(
    cases: Annotated[int, typer.Option(min=100, help="Profiles at random.")] = 10_000,
    targets: Annotated[int, typer.Option(min=10, help="Targets of task 2b.")] = 60,
    seed: Annotated[int, typer.Option(min=0, help="Seed of both.")] = 1,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Durations beside ruckig's, lines of 500 samples, and the practicum's task 2b: why interpolate at all."""
    from nao_kin.bench.bench_trajectory import compare
    from nao_kin.trajectory.demand import ROUNDING

    machine = Machine()
    sheets, bounds, notes = list[Sheet](), list[Promise](), list[str]()
    if importlib.util.find_spec("ruckig") is None:
        notes.append("ruckig is not installed, so no durations are compared: pip install 'nao_kin[dev]'.")
    else:
        worst = _worst_difference(cases, seed)
        row = {"cases": cases, "worst": worst}
        headings = (Heading("cases", "profiles", "d"), Heading("worst", "largest difference [s]", ".2g"))
        sheets.append(Sheet("profiles", "Least durations beside ruckig's with infinite jerk", headings, [row]))
        bounds.append(Promise("durations, largest difference from ruckig's [s]", worst, 1e-6, at_least=False))
    followed = {name: _followed(by) for name, by in _LINES}
    rows = [_line_row(name, found) for name, found in followed.items()]
    sheets.append(
        Sheet("lines", f"Straight lines of the JACO2, {_SAMPLES} samples, {_SECONDS} s", _LINE_HEADINGS, rows)
    )
    reached = [row for row in rows if row["completed"]]
    bounds.append(Promise("lines, error at samples [m]", max(row["error"] for row in reached), 1e-6, at_least=False))
    fastest = max(row["after"] for row in rows)
    bounds.append(Promise("lines, speed over limit after scaling", fastest, 1.0 + ROUNDING, at_least=False))
    unnamed = sum(found.cause.name in ("NONE", "NOT_REACHED") for found in followed.values() if not found.completed)
    bounds.append(Promise("lines that end without a named reason", float(unnamed), 0.0, at_least=False))
    found = compare(targets, seed)
    sheets.append(
        Sheet("task_2b", f"2b: {targets} targets 0.2 to 0.6 m away, from a random start", _2B_HEADINGS, found.rows)
    )
    bounds.append(Promise("2b: lines finished off the line by ≥ 1 cm", float(found.off_line), 0.0, at_least=False))
    endings = [f"{name}: {result.reason}" for name, result in followed.items() if not result.completed]
    conclude(machine, sheets, bounds, [*notes, *endings, "", *_answer(found), "", *_NOTES], format, goals)


_LINE_HEADINGS: Final = (
    Heading("line", "line"),
    Heading("samples", "got", "d"),
    Heading("error", "at [m]", ".0e"),
    Heading("between", "between", ".0e"),
    Heading("move", "move", ".3f"),
    Heading("before", "v/limit", ".2f"),
    Heading("after", "slowed", ".4f"),
    Heading("longer", "longer", ".2f"),
)
_2B_HEADINGS: Final = (
    Heading("how", "how"),
    Heading("reached", "there %", ".0f"),
    Heading("inside", "in range %", ".0f"),
    Heading("jumped", "> 90° %", ".0f"),
    Heading("off", "off [m]", ".1g"),
    Heading("largest", "at most", ".1g"),
)
_NOTES: Final = (
    "Lines: samples that are reached; errors at them and between them, measured by Pinocchio [m]; the largest move "
    "of a joint [rad]; the largest speed over its limit as asked and when slowed; how many times longer it then takes.",
    "2b: the sheet's own iteration (16), 128 times to the end, or 16 times to each point of a line, 1 cm apart; there "
    "within 1 cm; a joint turned by more than 90° from one solution to the next; the tip off the straight line, median "
    "and largest.",
)


def _worst_difference(count: int, seed: int) -> float:
    import numpy as np
    import ruckig

    from nao_kin.trajectory.trapezoid import Trapezoid

    rng, worst = np.random.default_rng(seed), 0.0
    generator, found = ruckig.Ruckig(1), ruckig.Trajectory(1)
    for k in range(count):
        v_max, up, down = rng.uniform(0.1, 2.0), rng.uniform(0.1, 5.0), rng.uniform(0.1, 5.0)
        v_start, v_end = rng.uniform(-v_max, v_max, 2) * (k % 4 > 0, k % 4 > 1)
        distance = 0.0 if k % 7 == 0 else rng.uniform(-3, 3) * 10.0 ** rng.uniform(-6, 0.5)
        ours = Trapezoid(
            0.0,
            distance,
            max_velocity=v_max,
            acceleration=up,
            braking=down,
            start_velocity=v_start,
            end_velocity=v_end,
        )
        forward = distance >= 0.0
        given = ruckig.InputParameter(1)
        given.current_position, given.target_position = [0.0], [distance]
        given.current_velocity, given.target_velocity = [v_start], [v_end]
        given.max_velocity, given.max_jerk = [v_max], [math.inf]
        given.max_acceleration = [up if forward else down]
        given.min_acceleration = [-down if forward else -up]
        generator.calculate(given, found)
        worst = max(worst, abs(found.duration - ours.duration))
    return worst


def _followed(by: tuple[float, float, float]) -> FollowResult:
    import numpy as np
    import pinocchio as pin

    from nao_kin.robot.robot import load
    from nao_kin.trajectory.following import follow
    from nao_kin.trajectory.paths import PoseLine

    arm, q0 = load("jaco2").chain("arm"), np.radians(_START_DEG)
    T = arm.pose(q0)
    line = PoseLine(T, pin.SE3(T.rotation, T.translation + np.array(by)))
    path = [line.target(share) for share in np.linspace(0.0, 1.0, _SAMPLES)]
    return follow(arm, path, q0, times=np.linspace(0.0, _SECONDS, _SAMPLES), scale=True)


def _line_row(name: str, found: FollowResult) -> dict[str, Any]:
    import numpy as np

    assert found.demand is not None  # noqa: S101 - there are times
    limits: Floats = found.demand.max_velocity
    planned = np.abs(np.diff(found.q, axis=0)).max(axis=0, initial=0.0) / (_SECONDS / (_SAMPLES - 1))
    return {
        "line": name,
        "completed": found.completed,
        "samples": len(found.q),
        "error": found.max_position_error,
        "between": found.position_error_between,
        "move": found.largest_move,
        "before": float((planned / limits).max()),
        "after": float((found.demand.speed / limits).max()),
        "longer": found.slowed,
        "cause": found.cause.name,
        "reason": found.reason,
    }


def _answer(found: InterpolationComparison) -> list[str]:
    direct, stepwise = found.rows
    missed = "" if stepwise["reached"] == 100.0 else " The others stop at a point that is known."
    return [
        f"2b: in one go {direct['reached']:.0f} % come to the end, {direct['jumped']:.0f} % by turning a joint more "
        f"than a quarter turn; on the way the tip is off the straight line by {direct['off']:.2g} m in the median "
        f"and {direct['largest']:.2g} m at most. In steps every solution starts next to the one before: "
        f"{stepwise['reached']:.0f} % come to the end, {stepwise['jumped']:.0f} % by such a turn, never more than "
        f"{stepwise['largest']:.2g} m off the line.{missed}"
    ]


_ENOUGH: Final = 0.01  # [m] task 1g
_QUARTER: Final = math.pi / 2.0
_APART: Final = 0.01  # [m] between points of a line
_FINE: Final = 20  # places at which a move between two sets of joints is looked at


@dataclass(frozen=True, slots=True)
class InterpolationComparison:
    """Both ways.

    Attributes:
        rows: Figures of the direct way, and of the way along the line.
        off_line: How many ends were reached along the line although the tip left it by 1 cm or more.
    """

    rows: tuple[dict[str, Any], dict[str, Any]]
    off_line: int


@dataclass(frozen=True, slots=True)
class _Trip:
    reached: bool
    inside: bool
    turned: bool
    off: float


def compare(count: int, seed: int) -> InterpolationComparison:
    """Random starts inside the limits, and positions 0.2 to 0.6 m away that the arm can reach."""
    import numpy as np

    from nao_kin.chain import random_configurations
    from nao_kin.output import progress
    from nao_kin.robot.robot import load

    arm, rng = load("jaco2").chain("arm"), np.random.default_rng(seed)
    problems: list[tuple[Floats, Floats]] = []
    while len(problems) < count:
        q, other = random_configurations(arm, 2, rng)
        end = arm.pose(other).translation.copy()
        if 0.2 <= np.linalg.norm(end - arm.pose(q).translation) <= 0.6:
            problems.append((q, end))
    trips = [(_direct(arm, q, p), _stepwise(arm, q, p)) for q, p in progress(problems, "task 2b", count)]
    direct, stepwise = zip(*trips, strict=True)
    off_line = sum(trip.reached and trip.off >= _ENOUGH for trip in stepwise)
    return InterpolationComparison((_row("in one go", direct), _row("1 cm steps", stepwise)), off_line)


def _direct(arm: Chain, q: Floats, p: Floats) -> _Trip:
    """The sheet's IK to the end, and all joints driven there at once."""
    from nao_kin.documents.practicum.position_ik import ik_pseudo_inverse

    return _trip(arm, [q, ik_pseudo_inverse(q, p, chain=arm).q], p)


def _stepwise(arm: Chain, q: Floats, p: Floats) -> _Trip:
    """The sheet's IK to each point of the line; where a point is missed or a joint leaps, it ends."""
    import numpy as np

    from nao_kin.documents.practicum.position_ik import ik_checked
    from nao_kin.documents.practicum.practicum_tasks import interpolate_position

    start = arm.pose(q).translation.copy()
    points = interpolate_position(start, p, math.ceil(float(np.linalg.norm(p - start)) / _APART) - 1)
    way = [q]
    for point in points[1:]:
        found = ik_checked(way[-1], point, iterations=16, largest_error=1e-3, largest_jump=0.5, chain=arm)
        if found.fault:
            break
        way.append(found.q)
    return _trip(arm, way, p)


def _trip(arm: Chain, way: list[Floats], p: Floats) -> _Trip:
    """What driving from one set of joints to the next does, seen by Pinocchio's forward kinematics."""
    import numpy as np

    from nao_kin.chain import in_limits

    shares = np.linspace(0.0, 1.0, _FINE + 1)[:, None]
    fine = [a + shares * (b - a) for a, b in itertools.pairwise(way)] or [way[0][None]]
    places = arm.poses(np.concatenate(fine))[:, :3, 3] - arm.pose(way[0]).translation
    reached = bool(np.linalg.norm(arm.pose(way[-1]).translation - p) < _ENOUGH)
    line = p - arm.pose(way[0]).translation
    along = np.clip(places @ line / (line @ line), 0.0, 1.0)
    off = float(np.linalg.norm(places - along[:, None] * line, axis=1).max())
    turned = any(bool(np.abs(b - a).max() > _QUARTER) for a, b in itertools.pairwise(way))
    return _Trip(reached, all(in_limits(arm, q) for q in way), turned, off)


def _row(how: str, trips: tuple[_Trip, ...]) -> dict[str, Any]:
    import numpy as np

    there = [trip for trip in trips if trip.reached]
    return {
        "how": how,
        "reached": 100.0 * len(there) / len(trips),
        "inside": 100.0 * sum(trip.inside for trip in there) / len(trips),
        "jumped": 100.0 * sum(trip.turned for trip in there) / len(trips),
        "off": float(np.median([trip.off for trip in there])) if there else 0.0,
        "largest": max((trip.off for trip in there), default=0.0),
    }
