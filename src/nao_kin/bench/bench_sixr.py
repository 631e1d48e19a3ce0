"""`nao-kin bench sixr`: closed forms of six-joint arms against random joints, Newton, singular poses and peers."""

from __future__ import annotations

import importlib
import importlib.util
import math
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple

import numpy as np
import typer

from nao_kin.analytic.matching import matched
from nao_kin.analytic.six_r.six_r_bent_wrist import BRANCHES, SAMPLES, solve_densely
from nao_kin.analytic.solution_batch import solve_all_batch
from nao_kin.bench.measuring import in_turns, one_thread
from nao_kin.bench.peers import product_of_exponentials
from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.ik.target import Target
from nao_kin.kernels.audit import tips
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from nao_kin.analytic.matching import Matched
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["dense_and_singular", "rivals", "sixr"]

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

    from nao_kin.bench.bench_sixr import dense_and_singular, rivals

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
    bounds.append(Promise("singular poses without solution", sum(row["lost"] for row in hard), 0.0, at_least=False))
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


def _bounds(rows: list[dict[str, Any]]) -> list[Promise]:
    return [
        Promise("regular poses not recovered", sum(row["unrecovered"] for row in rows), 0.0, at_least=False),
        Promise("largest residual", max(row["residual"] for row in rows), _RESIDUAL, at_least=False),
        Promise("solutions that only Newton found", sum(row["missing"] for row in rows), 0.0, at_least=False),
        Promise("solutions that are not finite", sum(row["nan"] for row in rows), 0.0, at_least=False),
    ]


def _general_bounds(row: dict[str, Any]) -> list[Promise]:
    return [
        Promise("any arm, recovered", row["recovered"] / row["targets"], 0.999),
        Promise("any arm, solutions that only Newton found", row["missing"], 0.0, at_least=False),
        Promise("any arm, largest residual", row["residual"], _RESIDUAL, at_least=False),
    ]


_DENSER: Final = 20
_BENT_SAME: Final = 1e-5  # [rad]
_BENT_SLACK: Final = 1e-6  # [m]
_BISECTIONS: Final = 70
_ALIGNED: Final = 4  # joint
_BENT_HEADINGS = (
    Heading("poses", "poses"),
    Heading("targets", "number", "d"),
    Heading("branches", "branches", ".3f"),
    Heading("most", "most", "d"),
    Heading("none", "none", "d"),
    Heading("lost", "lost", "d"),
    Heading("denser", "denser", "d"),
    Heading("residual", "residual", ".0e"),
)


def dense_and_singular(
    chain: UrdfChain, found: Matched, targets: int, rng: np.random.Generator
) -> tuple[Sheet, list[Promise]]:
    """The sheet, and what is demanded of it: random poses, and a twentieth as many of each singular family."""
    families = [("random", rng.uniform(-np.pi, np.pi, (targets, 6))), *_families(chain, max(50, targets // 20), rng)]
    rows = [_bent_row(chain, found, name, Q) for name, Q in families]
    demanded = [
        Promise(f"JACO2, poses {words}", sum(row[key] for row in rows), 0.0, at_least=False)
        for key, words in (
            ("none", "without solution"),
            ("lost", "that lose their own joints"),
            ("denser", "with more solutions when sampled more densely"),
        )
    ]
    title = (
        f"every branch of JACO2: poses with none, poses that lose their own joints, and poses of which {_DENSER} times "
        "denser samples find more"
    )
    return Sheet("bent", title, _BENT_HEADINGS, rows), demanded


def _bent_row(chain: UrdfChain, found: Matched, name: str, Q: Floats) -> dict[str, Any]:
    goals, arm = chain.poses(Q), found.geometry.parameters
    rows, counts = np.zeros((len(Q), BRANCHES, 8)), np.zeros(len(Q), dtype=np.int64)
    more, denser = np.zeros_like(rows), np.zeros_like(counts)
    found.form.solve_many(arm, 0, goals, np.zeros((1, 1)), _BENT_SLACK, rows, counts)
    solve_densely(arm, _DENSER * SAMPLES, goals, more, denser)
    known = [q[:count, :6] for q, count in zip(rows, counts, strict=True)]
    reached = tips(chain.joint_path, np.ascontiguousarray(np.concatenate(known)))
    return {
        "poses": name,
        "targets": len(Q),
        "branches": float(counts.mean()),
        "most": int(counts.max()),
        "none": int((counts == 0).sum()),
        "lost": sum(_bent_apart(ours, q) > _BENT_SAME for ours, q in zip(known, Q, strict=True)),
        "denser": sum(
            any(_bent_apart(ours, q) > _BENT_SAME for q in theirs[:count, :6])
            for ours, theirs, count in zip(known, more, denser, strict=True)
        ),
        "residual": float(np.abs(reached - np.repeat(goals, counts, axis=0)).max()),
    }


def _bent_apart(known: Floats, q: Floats) -> float:
    """Largest joint move from q to the nearest of some solutions, whole turns left out [rad]."""
    moves = np.abs((known - q + np.pi) % (2.0 * np.pi) - np.pi).max(axis=1, initial=0.0)
    return float(moves.min(initial=math.inf))


def _families(chain: UrdfChain, count: int, rng: np.random.Generator) -> Iterator[tuple[str, Floats]]:
    """Joints (count, 6) of exactly singular poses, and of others where the arm is straight, aligned or rectangular."""
    for joint in range(1, 5):
        yield f"singular by joint {joint + 1}", _bent_singular(chain, joint, count, rng)
    aligned = rng.uniform(-np.pi, np.pi, (count, 6))
    aligned[:, _ALIGNED] = math.pi * rng.integers(0, 2, count)
    yield "wrist aligned", aligned
    for name, parts in (("quarter turns", 2), ("eighth turns", 4)):
        turns = rng.integers(-parts, parts + 1, (count, 6)).astype(np.float64)
        yield name, turns * (math.pi / parts)


def _bent_singular(chain: UrdfChain, joint: int, count: int, rng: np.random.Generator) -> Floats:
    """Joints (count, 6) at which the determinant of the Jacobian changes its sign as one joint turns."""
    made: list[Floats] = []
    while sum(map(len, made)) < count:
        Q = rng.uniform(-np.pi, np.pi, (1000, 6))
        low = Q[:, joint].copy()
        high = low + 0.2
        start = _determinants(chain, Q, joint, low)
        change = (start < 0.0) != (_determinants(chain, Q, joint, high) < 0.0)
        Q, low, high, start = Q[change], low[change], high[change], start[change]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            same = (_determinants(chain, Q, joint, middle) < 0.0) == (start < 0.0)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        Q[:, joint] = low
        made.append(Q)
    return np.concatenate(made)[:count]


def _determinants(chain: UrdfChain, Q: Floats, joint: int, values: Floats) -> Floats:
    moved = Q.copy()
    moved[:, joint] = values
    return np.asarray(np.linalg.det(chain.jacobians(moved)))


_BATCH, _FEW, _ROUNDS = 10_000, 50, 5
_OVER_EAIK, _OVER_SSIK = 1.5, 30.0
_RIVAL_HEADINGS = (
    Heading("arm", "arm"),
    Heading("peer", "peer"),
    Heading("theirs", "its µs", ".1f"),
    Heading("kernel", "kernel µs", ".2f"),
    Heading("judged", "judged µs", ".2f"),
    Heading("kernel_ratio", "kernel ×", ".1f"),
    Heading("judged_ratio", "judged ×", ".1f"),
)


def rivals(chains: Mapping[str, UrdfChain], rng: np.random.Generator) -> tuple[Sheet, list[Promise], list[str]]:
    """The sheet, what is demanded of it, and lines about packages that are left out."""
    rows, goals, left_out = list[dict[str, Any]](), list[Promise](), list[str]()
    for arm, peer, setup, bound in _PEERS:
        if importlib.util.find_spec(peer.replace("-", "_")) is None:
            left_out.append(f"Without {peer}: to have it beside, pip install {peer}.")
            continue
        row = _rival_row(chains[arm], setup, rng) | {"arm": arm, "peer": peer}
        rows.append(row)
        if bound is None:
            continue
        for how in ("kernel", "judged"):
            goals.append(Promise(f"{arm}, times faster than {peer}, {how}", row[f"{how}_ratio"], bound))
    return Sheet("peers", "time a pose with all branches, one thread, batches", _RIVAL_HEADINGS, rows), goals, left_out


def _rival_row(
    chain: UrdfChain,
    setup: Callable[[UrdfChain, Floats], tuple[Callable[[], object], int]],
    rng: np.random.Generator,
) -> dict[str, Any]:
    poses = chain.poses(rng.uniform(-np.pi, np.pi, (_BATCH, 6)))
    theirs, count = setup(chain, poses)
    found = matched(chain, Target.of(poses[0]))
    rows, counts = np.empty((_BATCH, found.request.branches, 8)), np.zeros(_BATCH, dtype=np.int64)

    def kernel() -> None:
        found.form.solve_many(found.geometry.parameters, 0, poses, np.zeros((1, 1)), 1e-6, rows, counts)

    jobs: dict[str, Callable[[], object]] = {
        "theirs": theirs,
        "kernel": kernel,
        "judged": lambda: solve_all_batch(chain, poses),
    }
    with one_thread():
        kernel()
        times = in_turns(jobs, range(_ROUNDS), {"theirs": 1, "kernel": 1, "judged": 1})
    cost = {name: min(values) / (count if name == "theirs" else _BATCH) * 1e6 for name, values in times.items()}
    return cost | {f"{how}_ratio": cost["theirs"] / cost[how] for how in ("kernel", "judged")}


def _eaik(chain: UrdfChain, poses: Floats) -> tuple[Callable[[], object], int]:
    """Its batched call on one thread; it takes no tool rotation."""
    H, P, R_last_tip = product_of_exponentials(chain)
    robot = importlib.import_module("eaik.IK_HP").HPRobot(H, P)
    wanted = poses.copy()
    wanted[:, :3, :3] = poses[:, :3, :3] @ R_last_tip.T
    return lambda: robot.IK_batched(wanted, 1), len(wanted)


def _ik_geo(chain: UrdfChain, poses: Floats) -> tuple[Callable[[], object], int]:
    """One call a pose, as it has no batched one; it takes rotations column by column and no tool rotation."""
    H, P, R_last_tip = product_of_exponentials(chain)
    robot = importlib.import_module("ik_geo").Robot.three_parallel_two_intersecting(H.tolist(), P.tolist())
    wanted = [((R_last_tip @ T[:3, :3].T).tolist(), T[:3, 3].tolist()) for T in poses]

    def call() -> None:
        for columns, place in wanted:
            robot.get_ik(columns, place)

    return call, len(wanted)


def _ssik(chain: UrdfChain, poses: Floats) -> tuple[Callable[[], object], int]:
    """The arm from its file, derived anew, which takes it a minute; it has no batched call."""
    manipulator = importlib.import_module("ssik").Manipulator
    arm = manipulator.from_urdf(str(chain.robot.document.path), base=chain.base, ee=chain.tip)
    arm.solve(poses[0], respect_limits=False, enumerate_windings=False)

    def call() -> None:
        for T in poses[:_FEW]:
            arm.solve(T, respect_limits=False, enumerate_windings=False)

    return call, _FEW


_PEERS: Final = (
    ("ur5", "eaik", _eaik, _OVER_EAIK),
    ("ur5", "ik-geo", _ik_geo, None),
    ("jaco2", "ssik", _ssik, _OVER_SSIK),
)
