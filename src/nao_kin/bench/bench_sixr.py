"""`nao-kin bench sixr`: closed forms of six-joint arms against random joints, Newton, singular poses and peers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from nao_kin.bench.sheet import Goal, GoalsOption, Heading, Machine, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np

    from nao_kin.analytic.matching import Matched
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["sixr"]

_SAME = 1e-9  # [rad]: joints this near are recovered
_REGULAR = 1e-6  # least singular value from which on a pose says what its joints are to 1e-9
_RESIDUAL = 1e-10  # [m, rad]
_MISSING = 1e-5  # [rad]
_ARMS = ("ur3", "ur5", "ur10", "z1", "kinova", "jaco2")
_SLACK = 1e-6  # [m]: what `solve_all` gives its kernels for poses at the border


class _Arm(NamedTuple):
    name: str
    chain: UrdfChain
    found: Matched


class _Rows(NamedTuple):
    q: Floats
    exists: Any
    counts: Any


def sixr(
    targets: Annotated[int, typer.Option(min=1, help="Random poses of each arm.")] = 10_000,
    newton: Annotated[int, typer.Option(min=1, help="Of these, poses that Newton searches for more branches.")] = 200,
    starts: Annotated[int, typer.Option(min=1, help="Newton's starts for each.")] = 128,
    any_targets: Annotated[int, typer.Option(min=1, help="Random poses, reachable or not, for NaN.")] = 100_000,
    geometries: Annotated[int, typer.Option(min=1, help="Random arms for the general method.")] = 200,
    peers: Annotated[
        bool, typer.Option("--peers", help="Time eaik, ik-geo and ssik beside it; ssik takes minutes.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all random numbers.")] = 9,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Six-joint arms: recovered joints, residuals, missing branches, singular poses, any arm at all, and speed."""
    import numpy as np

    from nao_kin.bench.sixr_bent import dense_and_singular
    from nao_kin.bench.sixr_rivals import rivals

    machine, rng = Machine(), np.random.default_rng(seed)
    arms = list(_arms())
    rows = [_row(arm, targets, newton, starts, any_targets, rng) for arm in progress(arms, "arms", len(arms))]
    hard = [_singular(arm, max(100, targets // 10), rng) for arm in arms if arm.name in ("ur3", "ur5", "ur10")]
    general = _general(geometries, rng)
    jaco2 = next(arm for arm in arms if arm.name == "jaco2")
    bent, demanded = dense_and_singular(jaco2.chain, jaco2.found, targets, rng)
    sheets = [
        Sheet("arms", f"{targets} poses of random joints; mirrored: from tip to base", _HEADINGS, rows),
        Sheet("singular", "exactly stretched elbows and aligned wrists", _HARD_HEADINGS, hard),
        bent,
        Sheet("general", "random arms without structure, one pose each", _GENERAL_HEADINGS, [general]),
    ]
    bounds = [*_bounds(rows), *_general_bounds(general), *demanded]
    bounds.append(Goal("singular poses without solution", sum(row["lost"] for row in hard), 0.0, at_least=False))
    notes = list(_NOTES)
    if peers:
        beside, missed, left_out = rivals({arm.name: arm.chain for arm in arms}, rng)
        sheets.append(beside)
        bounds += missed
        notes += left_out
    conclude(machine, sheets, bounds, notes, format, goals)


_HEADINGS = (
    Heading("arm", "arm"),
    Heading("form", "closed form"),
    Heading("recovered_of", "recovered"),
    Heading("branches", "branches", ".2f"),
    Heading("residual", "residual", ".0e"),
    Heading("missing", "missing", "d"),
    Heading("nan", "NaN", "d"),
    Heading("cost", "µs", ".2f"),
)
_HARD_HEADINGS = (
    Heading("arm", "arm"),
    Heading("targets", "poses", "d"),
    Heading("lost", "without solution", "d"),
    Heading("residual", "residual", ".0e"),
)
_GENERAL_HEADINGS = (
    Heading("targets", "arms", "d"),
    Heading("recovered", "recovered", "d"),
    Heading("missing", "missing", "d"),
    Heading("residual", "residual", ".0e"),
    Heading("branches", "branches", ".2f"),
)
_NOTES = (
    f"Recovered: poses whose joints are among the solutions to {_SAME:g} rad, of those with a least singular value "
    f"above {_REGULAR:g}. "
    "Missing: solutions that Newton found and the closed form did not. NaN: of random poses, reachable or not. "
    "µs: a pose with all its branches on one thread, before judging.",
)


def _arms() -> Iterator[_Arm]:
    """Each arm that is installed, from base to tip and from tip to base."""
    import numpy as np

    from nao_kin.analytic.matching import matched
    from nao_kin.ik.target import Target
    from nao_kin.robot.known import KNOWN_ROBOTS
    from nao_kin.robot.robot import load

    for name in _ARMS:
        robot = load(name)
        chain = robot.chain(next(iter(KNOWN_ROBOTS[name].chains)))
        for label, path in ((name, chain), (f"{name} mirrored", robot.chain(chain.tip, chain.base))):
            yield _Arm(label, path, matched(path, Target.of(np.eye(4))))


def _solved(found: Matched, goals: Floats, slack: float = 0.0) -> _Rows:
    import numpy as np

    rows = np.zeros((len(goals), found.request.branches, 8))
    counts = np.zeros(len(goals), dtype=np.int64)
    found.form.solve_many(found.geometry.parameters, 0, goals, np.zeros((1, 1)), slack, rows, counts)
    return _Rows(rows[:, :, :6], np.arange(rows.shape[1]) < counts[:, None], counts)


def _row(
    arm: _Arm, targets: int, newton: int, starts: int, any_targets: int, rng: np.random.Generator
) -> dict[str, Any]:
    import numpy as np

    from nao_kin.bench.all_solutions import least_singular_value
    from nao_kin.bench.measuring import one_thread, seconds

    Q = rng.uniform(-np.pi, np.pi, (targets, 6))
    goals = arm.chain.poses(Q)
    found = _solved(arm.found, goals)
    values = least_singular_value("pose", goals, arm.chain, Q, np.ones(6, dtype=np.bool_))
    regular = values > _REGULAR
    recovered = int((regular & (_apart(found, Q) <= _SAME)).sum())
    with one_thread():
        cost = min(seconds(lambda: _solved(arm.found, goals)) for _ in range(3)) / targets
    return {
        "arm": arm.name,
        "form": arm.found.form.name,
        "recovered_of": f"{recovered}/{int(regular.sum())}",
        "unrecovered": int(regular.sum()) - recovered,
        "branches": float(found.counts.mean()),
        "residual": _residual(arm.chain, found, goals),
        "missing": _missing(arm.chain, found, goals[:newton], starts, rng),
        "nan": _not_finite(arm, any_targets, rng),
        "cost": cost * 1e6,
    }


def _apart(found: _Rows, Q: Floats) -> Floats:
    """Largest joint move from given joints to the nearest solution, whole turns left out [rad]."""
    import numpy as np

    moves = np.abs((found.q - Q[:, None, :] + np.pi) % (2.0 * np.pi) - np.pi).max(axis=2)
    return np.asarray(np.where(found.exists, moves, np.inf).min(axis=1))


def _residual(chain: UrdfChain, found: _Rows, goals: Floats) -> float:
    import numpy as np

    from nao_kin.kernels.audit import tips

    if not found.counts.any():
        return 0.0
    reached = tips(chain.joint_path, np.ascontiguousarray(found.q[found.exists]))
    return float(np.abs(reached - np.repeat(goals, found.counts, axis=0)).max())


def _missing(chain: Any, found: _Rows, goals: Floats, starts: int, rng: np.random.Generator) -> int:
    import numpy as np

    from nao_kin.bench.all_solutions import apart, least_singular_value, multi_start

    missing, free = 0, np.ones(6, dtype=np.bool_)
    for i, solutions in enumerate(multi_start(chain, "pose", goals, np.full((len(goals), 6), np.nan), starts, rng)):
        if len(solutions):
            values = least_singular_value("pose", goals[[i] * len(solutions)], chain, solutions, free)
            known = found.q[i][found.exists[i]]
            missing += sum(v > 1e-4 and apart(known, q) > _MISSING for v, q in zip(values, solutions, strict=True))
    return missing


def _not_finite(arm: _Arm, count: int, rng: np.random.Generator) -> int:
    """Targets with a solution that is not finite, or misses: random poses in and out of reach, and degenerate ones."""
    import numpy as np

    goals = np.tile(np.eye(4), (count, 1, 1))
    x = rng.normal(size=(count, 4))
    w, a, b, c = (x / np.linalg.norm(x, axis=1, keepdims=True)).T
    goals[:, 0, :3] = np.stack([1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)], axis=1)
    goals[:, 1, :3] = np.stack([2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)], axis=1)
    goals[:, 2, :3] = np.stack([2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)], axis=1)
    goals[:, :3, 3] = rng.uniform(-1.5, 1.5, (count, 3))
    tenth = count // 10
    quarters = rng.integers(-2, 3, (2 * tenth, 6)) * (math.pi / 2.0)  # straight, folded and aligned
    goals[: 2 * tenth] = arm.chain.poses(quarters)
    goals[2 * tenth : 3 * tenth, :3, :3] = np.eye(3)
    goals[3 * tenth : 3 * tenth + tenth // 10, :3, 3] *= 1e12
    found = _solved(arm.found, goals)
    return int((found.exists & ~np.isfinite(found.q).all(axis=2)).any(axis=1).sum())


def _singular(arm: _Arm, count: int, rng: np.random.Generator) -> dict[str, Any]:
    import numpy as np

    Q = rng.uniform(-np.pi, np.pi, (3 * count, 6))
    elbow, wrist = Q[:, 2], Q[:, 4]  # of a UR from base to tip
    elbow[: 2 * count] = 0.0
    wrist[count:] = 0.0
    goals = arm.chain.poses(Q)
    found = _solved(arm.found, goals, _SLACK)
    return {
        "arm": arm.name,
        "targets": len(Q),
        "lost": int((found.counts == 0).sum()),
        "residual": _residual(arm.chain, found, goals),
    }


def _general(geometries: int, rng: np.random.Generator) -> dict[str, Any]:
    """The general method on arms whose axes have random directions and places."""
    import numpy as np

    from nao_kin.analytic.six_r import general as six_r_general
    from nao_kin.dh.dh_chain import DHChain

    recovered = missing = branches = 0
    residual = 0.0
    for i in range(geometries):
        table = np.column_stack([rng.uniform(0.0, 0.4, 6), rng.uniform(-3.0, 3.0, 6), rng.uniform(-0.4, 0.4, 6)])
        rows = [dict(zip(("a", "alpha", "d"), row.tolist(), strict=True)) | {"theta": 0.0} for row in table]
        chain: Any = DHChain.from_table(rows, convention="standard", lengths="m", angles="rad")
        q = rng.uniform(-np.pi, np.pi, (1, 6))
        goals = chain.poses(q)
        geometry: Any = six_r_general.recognise(chain.joint_path)
        written, counts = np.zeros((1, six_r_general.BRANCHES, 8)), np.zeros(1, dtype=np.int64)
        six_r_general.solve_many(geometry.parameters, 0, goals, np.zeros((1, 1)), 0.0, written, counts)
        found = _Rows(written[:, :, :6], np.arange(six_r_general.BRANCHES) < counts[:, None], counts)
        recovered += bool(_apart(found, q)[0] <= _SAME)
        branches += int(counts[0])
        residual = max(residual, _residual(chain, found, goals))
        if i < max(1, geometries // 4):
            missing += _missing(chain, found, goals, 300, rng)
    return {
        "targets": geometries,
        "recovered": recovered,
        "missing": missing,
        "residual": residual,
        "branches": branches / geometries,
    }


def _bounds(rows: list[dict[str, Any]]) -> list[Goal]:
    return [
        Goal("regular poses not recovered", sum(row["unrecovered"] for row in rows), 0.0, at_least=False),
        Goal("largest residual", max(row["residual"] for row in rows), _RESIDUAL, at_least=False),
        Goal("solutions that only Newton found", sum(row["missing"] for row in rows), 0.0, at_least=False),
        Goal("solutions that are not finite", sum(row["nan"] for row in rows), 0.0, at_least=False),
    ]


def _general_bounds(row: dict[str, Any]) -> list[Goal]:
    return [
        Goal("any arm, recovered", row["recovered"] / row["targets"], 0.999),
        Goal("any arm, solutions that only Newton found", row["missing"], 0.0, at_least=False),
        Goal("any arm, largest residual", row["residual"], _RESIDUAL, at_least=False),
    ]
