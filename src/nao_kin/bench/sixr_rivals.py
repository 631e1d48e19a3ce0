"""Closed forms of six-joint arms beside those of eaik, ik-geo and ssik, in turns in one run and on one thread."""

from __future__ import annotations

import importlib
import importlib.util
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.analytic.matching import matched
from nao_kin.analytic.solution_batch import solve_all_batch
from nao_kin.bench.measuring import in_turns, one_thread
from nao_kin.bench.peers import product_of_exponentials
from nao_kin.bench.sheet import Goal, Heading, Sheet
from nao_kin.ik.target import Target

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["rivals"]

_BATCH, _FEW, _ROUNDS = 10_000, 50, 5
_OVER_EAIK, _OVER_SSIK = 1.5, 30.0
_HEADINGS = (
    Heading("arm", "arm"),
    Heading("peer", "peer"),
    Heading("theirs", "its µs", ".1f"),
    Heading("kernel", "kernel µs", ".2f"),
    Heading("judged", "judged µs", ".2f"),
    Heading("kernel_ratio", "kernel ×", ".1f"),
    Heading("judged_ratio", "judged ×", ".1f"),
)


def rivals(chains: Mapping[str, UrdfChain], rng: np.random.Generator) -> tuple[Sheet, list[Goal], list[str]]:
    """The sheet, what is demanded of it, and lines about packages that are left out."""
    rows, goals, left_out = list[dict[str, Any]](), list[Goal](), list[str]()
    for arm, peer, setup, bound in _PEERS:
        if importlib.util.find_spec(peer.replace("-", "_")) is None:
            left_out.append(f"Without {peer}: to have it beside, pip install {peer}.")
            continue
        row = _row(chains[arm], setup, rng) | {"arm": arm, "peer": peer}
        rows.append(row)
        if bound is None:
            continue
        for how in ("kernel", "judged"):
            goals.append(Goal(f"{arm}, times faster than {peer}, {how}", row[f"{how}_ratio"], bound))
    return Sheet("peers", "time a pose with all branches, one thread, batches", _HEADINGS, rows), goals, left_out


def _row(
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
