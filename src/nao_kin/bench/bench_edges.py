"""`nao-kin bench edges`: singular poses, the edge of reach, targets that do not exist, input that is none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import pinocchio as pin
import typer

from nao_kin.bench.referee import Referee
from nao_kin.bench.sheet import SOLVED_MEANS, GoalsOption, Heading, Machine, PeersOption, Promise, Sheet, conclude
from nao_kin.chain import random_configurations
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.bench.contest import Contender
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["bad_targets", "beyond_reach", "edges", "farthest", "near_full_reach", "with_joint_at_zero"]

_FAR = (1.01, 1.5, 5.0)  # times the largest distance of the tip from the base that was seen
_PROVEN_FROM = 1.5  # from here on, every target must be proven out of reach
_FAR_PEER_TARGETS = 50  # a peer may need a hundredth of a second for each of them
_RUNS = 3
_BAD_INPUT_PEER = "roboticstoolbox"
_REFUSED = "refused"
_SINGULAR_KEYS = ("solver", "success", "near", "median", "mean")


def edges(
    targets: Annotated[int, typer.Option(min=1, help="Targets of each kind.")] = 1000,
    samples: Annotated[int, typer.Option(min=100, help="Configurations that the reach is seen in.")] = 1_000_000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the targets.")] = 11,
    peers: PeersOption = False,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Singular poses, the edge of reach, unreachable targets and bad input, on a six-axis arm."""
    import numpy as np

    from nao_kin.bench.arms import main_arm
    from nao_kin.bench.bench_edges import beyond_reach, farthest, near_full_reach, with_joint_at_zero

    machine, (arm, notes), rng = Machine(), main_arm(), np.random.default_rng(seed)
    q_far, reach = farthest(arm, samples, rng)
    reachable = {
        "elbow, q3 = 0": with_joint_at_zero(arm, 2, targets, rng),
        "wrist, q5 = 0": with_joint_at_zero(arm, 4, targets, rng),
        "99.9 % reach": near_full_reach(arm, q_far, 0.999 * reach, targets, rng),
    }
    singular, bounds = _singular(arm, reachable, peers, notes)
    far = {factor: beyond_reach(factor * reach, targets, rng) for factor in _FAR}
    unreachable, more = _unreachable(arm, far)
    sheets = [singular, unreachable]
    if peers:
        sheets.append(_far_contest(arm, far))
    cost, cheap = _cost_of_no(arm, far[_PROVEN_FROM], targets, seed)
    refusals, refused = _bad_input(arm, peers)
    notes.append(SOLVED_MEANS)
    notes.append(f"Reach: {reach:.4f} m from base to tip, the largest of {samples} configurations.")
    conclude(machine, [*sheets, cost, refusals], [*bounds, *more, cheap, refused], notes, format, goals)


def _singular(arm: UrdfChain, kinds: dict[str, Floats], peers: bool, notes: list[str]) -> tuple[Sheet, list[Promise]]:
    """Reachable targets where the Jacobian loses rank, or nearly."""
    from nao_kin.bench.contest import CONTEST_HEADINGS, SolverTask, duels
    from nao_kin.bench.peers import installed_peers

    rows, bounds = list[dict[str, Any]](), []
    for kind, targets in kinds.items():
        task = SolverTask(arm, targets)
        others, said = installed_peers(task) if peers else ([], [])
        notes += [line for line in said if line not in notes]
        found = duels(task, others, 1, kind)
        rows += [row | {"kind": kind} for row in found]
        bounds.append(Promise(f"{kind}: solved %", found[0]["success"], 100.0))
    title = f"{arm.name}: reachable targets at singularities [µs]"
    headings = (
        Heading("kind", "target"),
        *(h for h in CONTEST_HEADINGS if h.key in _SINGULAR_KEYS),
    )
    return Sheet("singular", title, headings, rows), bounds


def _unreachable(arm: UrdfChain, far: dict[float, Floats]) -> tuple[Sheet, list[Promise]]:
    """What we say of targets beyond the reach."""
    import nao_kin as nk
    from nao_kin.bench.referee import Referee
    from nao_kin.chain import neutral
    from nao_kin.output import progress

    referee, start, rows, bounds = Referee(arm), neutral(arm), [], []
    for factor, targets in far.items():
        results = [nk.solve(arm, T, start) for T in progress(targets, f"{factor:g} × reach", len(targets))]
        proven = sum(result.status is nk.Status.OUT_OF_REACH for result in results)
        pairs = zip(results, targets, strict=True)
        false = sum(result.solved and not referee.accepts(result.q, T) for result, T in pairs)
        row = {"factor": factor, "targets": len(targets), "proven": proven, "false": false}
        rows.append(row | {"solved": sum(result.solved for result in results)})
        if factor >= _PROVEN_FROM:
            bounds.append(Promise(f"{factor:g} × reach: OUT_OF_REACH %", 100.0 * proven / len(targets), 100.0))
        bounds.append(Promise(f"{factor:g} × reach: falsely solved", float(false), 0.0, at_least=False))
    headings = (
        Heading("factor", "× reach", "g"),
        Heading("targets", "targets", "d"),
        Heading("proven", "OUT_OF_REACH", "d"),
        Heading("solved", "solved", "d"),
        Heading("false", "falsely solved", "d"),
    )
    return Sheet("unreachable", "beyond the reach: what nao_kin says", headings, rows), bounds


def _far_contest(arm: UrdfChain, far: dict[float, Floats]) -> Sheet:
    """What the peers say of the same targets, ours beside them."""
    from nao_kin.bench.contest import SolverTask, duels
    from nao_kin.bench.peers import installed_peers

    rows: list[dict[str, Any]] = []
    for factor, targets in far.items():
        task = SolverTask(arm, targets[:_FAR_PEER_TARGETS])
        others, _ = installed_peers(task)
        rows += [row | {"factor": factor} for row in duels(task, others, 1, f"{factor:g} × reach")]
    headings = (
        Heading("factor", "× reach", "g"),
        Heading("solver", "solver"),
        Heading("claimed", "says solved", "d"),
        Heading("reached", "is", "d"),
        Heading("median", "median", ".1f"),
        Heading("p95", "p95", ".1f"),
    )
    return Sheet(
        "unreachable_peers",
        f"beyond the reach, {rows[0]['targets']} of the targets: what everybody says [µs]",
        headings,
        rows,
    )


def _cost_of_no(arm: UrdfChain, far: Floats, targets: int, seed: int) -> tuple[Sheet, Promise]:
    """A proven "no" against a successful solve, in turns."""
    import numpy as np

    from nao_kin.bench.contest import Contender, SolverTask, contest, ours

    solve = ours(arm)
    yes = SolverTask.reachable(arm, targets, seed)
    no = Contender("proven no", solve.call, solve.joints, lambda _: list(far))
    found, refused = contest(yes, [solve, no], _RUNS, "the cost of a no")
    rows = [
        {
            "what": what,
            "median": float(np.median(score.times) * 1e6),
            "p95": float(np.percentile(score.times, 95) * 1e6),
        }
        for what, score in (("solved", found), ("proven out of reach", refused))
    ]
    headings = (Heading("what", "answer"), Heading("median", "median", ".1f"), Heading("p95", "p95", ".1f"))
    ratio = float(np.median(refused.times) / np.median(found.times))
    return Sheet("cost", "what an answer costs [µs]", headings, rows), Promise(
        "proven no ÷ median solve", ratio, 1.0, at_least=False
    )


def _bad_input(arm: UrdfChain, peers: bool) -> tuple[Sheet, Promise]:
    """Targets that are none."""
    from nao_kin.bench.bench_edges import bad_targets
    from nao_kin.bench.contest import SolverTask, ours
    from nao_kin.bench.peers import installed_peers

    bad = bad_targets(arm)
    task = SolverTask.reachable(arm, 1, 0)
    contenders = [ours(arm), *(installed_peers(task, [_BAD_INPUT_PEER])[0] if peers else [])]
    rows = [{"input": what} | {c.name: _verdict(c, T) for c in contenders} for what, T in bad.items()]
    refused = sum(row["nao_kin"] == _REFUSED for row in rows)
    headings = (Heading("input", "target"), *(Heading(c.name, c.name) for c in contenders))
    goal = Promise("bad targets refused %", 100.0 * refused / len(rows), 100.0)
    return Sheet("bad_input", "targets that are no rigid pose", headings, rows), goal


def _verdict(contender: Contender, T: Floats) -> str:
    from nao_kin.errors import InvalidInputError

    try:
        answer = contender.call(T)
    except (InvalidInputError, ValueError):
        return _REFUSED
    return "no solution" if contender.joints(answer) is None else "says solved"


_CHUNK = 100_000
_BISECTIONS = 60  # enough for the last digit


def farthest(chain: UrdfChain, samples: int, rng: np.random.Generator) -> tuple[Floats, float]:
    """The configuration with the largest distance of the tip from the base among random ones, and that distance [m]."""
    best, q_best = 0.0, np.zeros(len(chain.joints))
    starts = range(0, samples, _CHUNK)
    for start in progress(starts, "looking for the reach", len(starts)):
        Q = random_configurations(chain, min(_CHUNK, samples - start), rng)
        distances = np.linalg.norm(chain.poses(Q)[:, :3, 3], axis=1)
        k = int(distances.argmax())
        if distances[k] > best:
            best, q_best = float(distances[k]), Q[k]
    return q_best, best


def with_joint_at_zero(chain: UrdfChain, joint: int, count: int, rng: np.random.Generator) -> Floats:
    """Poses (count, 4, 4) of random configurations with one joint at exactly 0."""
    Q = random_configurations(chain, count, rng)
    Q[:, joint] = np.clip(0.0, chain.lower[joint], chain.upper[joint])
    referee = Referee(chain)
    return np.array([referee.pose(q) for q in Q])


def near_full_reach(chain: UrdfChain, q_far: Floats, distance: float, count: int, rng: np.random.Generator) -> Floats:
    """Reachable poses (count, 4, 4) whose tip is at exactly that distance from the base, near the largest there is.

    From the farthest configuration, turned about the first joint, a random direction is followed until the tip has
    come that near. So the orientation is one that the arm has there.
    """
    referee, poses, tries = Referee(chain), list["Floats"](), 0
    while len(poses) < count:
        tries += 1
        if tries > 100 * count:
            raise RuntimeError(f"found {len(poses)} of {count} poses of {chain.name} at {distance:.6g} m")
        q, direction = q_far.copy(), rng.normal(size=len(q_far))
        q[0] = random_configurations(chain, 1, rng)[0, 0]
        direction[0] = 0.0
        T = _at_distance(referee, q, direction / np.linalg.norm(direction), distance)
        if T is not None:
            poses.append(T)
    return np.array(poses)


def _at_distance(referee: Referee, q: Floats, direction: Floats, distance: float) -> Floats | None:
    """The pose on the way from q along a direction of the joints where the tip comes within a distance; bisection."""

    def away(step: float) -> float:
        return float(np.linalg.norm(referee.pose(q + step * direction)[:3, 3]))

    near, far = 0.0, 1.0
    if away(near) < distance or away(far) > distance:
        return None
    for _ in range(_BISECTIONS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if away(middle) > distance else (near, middle)
    found = q + far * direction
    return referee.pose(found) if referee.inside(found) else None


def beyond_reach(distance: float, count: int, rng: np.random.Generator) -> Floats:
    """Random poses (count, 4, 4) at a distance from the base."""
    directions = rng.normal(size=(count, 3))
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, 3] = distance * directions / np.linalg.norm(directions, axis=1)[:, None]
    for pose, x in zip(poses, rng.normal(size=(count, 4)), strict=True):
        pose[:3, :3] = pin.Quaternion(*(x / np.linalg.norm(x))).matrix()
    return poses


def bad_targets(chain: UrdfChain) -> dict[str, Floats]:
    """Matrices (4, 4) that are no rigid pose, by what is wrong with them."""
    good = Referee(chain).pose(random_configurations(chain, 1, np.random.default_rng(5))[0])

    def changed(row: slice | int, column: slice | int, factor: float) -> Floats:
        T = good.copy()
        T[row, column] *= factor
        return T

    sheared, last_row = good.copy(), good.copy()
    sheared[:3, 0] += 0.01 * sheared[:3, 1]
    last_row[3] = (0.0, 0.0, 0.1, 1.0)
    return {
        "NaN in the position": changed(0, 3, np.nan),
        "NaN in the rotation": changed(1, 1, np.nan),
        "infinite position": changed(2, 3, np.inf),
        "rotation scaled by 1.001": changed(slice(0, 3), slice(0, 3), 1.001),
        "reflection": changed(slice(0, 3), 0, -1.0),
        "sheared rotation": sheared,
        "last row not 0 0 0 1": last_row,
    }
