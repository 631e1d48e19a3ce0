"""The closed forms beside the iterative methods: batches on one thread, judging included, on the same targets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import nao_kin as nk
from nao_kin.bench.measuring import in_turns, one_thread, seconds
from nao_kin.bench.sheet import Heading, Sheet
from nao_kin.chain import random_configurations
from nao_kin.ik.methods import METHODS
from nao_kin.ik.target import Target
from nao_kin.output import progress

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["CLOSED", "Beside", "measured", "sheet"]

CLOSED = "closed form"
_ROUNDS = 3
_SLOW = 1.0  # [s] a job that takes longer is timed once
_TARGETS = 100


@dataclass(frozen=True, eq=False, slots=True)
class Beside:
    """What a method and the closed form made of the same targets.

    Attributes:
        what: The targets, for a column.
        success: Targets solved [%], by method.
        micro: Time of a target in a batch [µs], by method.
    """

    what: str
    success: Mapping[str, float]
    micro: Mapping[str, float]


def measured(seed: int) -> list[Beside]:
    """Positions of a NAO's arm, whose elbow yaw the closed form is told, and poses of its leg; random postures."""
    robot, rng = nk.load("nao_v33_h21"), np.random.default_rng(seed)
    arm, leg = robot.chain("left_arm"), robot.chain("left_leg")
    Q = random_configurations(arm, _TARGETS, rng)
    positions = np.ascontiguousarray(arm.poses(Q)[:, :3, 3])
    poses = leg.poses(random_configurations(leg, _TARGETS, rng))
    yaw = {"LElbowYaw": Q[:, arm.joint_names.index("LElbowYaw")]}
    return [_beside("arm", arm, positions, yaw), _beside("leg", leg, poses, None)]


def sheet(found: list[Beside]) -> Sheet:
    """One row a method, the closed form first."""
    rows: dict[str, dict[str, Any]] = {}
    for k, beside in enumerate(found):
        for name, micro in beside.micro.items():
            row = rows.setdefault(name, {"method": name})
            row[f"success_{k}"], row[f"micro_{k}"] = beside.success[name], micro
            row[f"ratio_{k}"] = micro / beside.micro[CLOSED]
    headings = [Heading("method", "method")]
    for k, beside in enumerate(found):
        headings += [
            Heading(f"success_{k}", f"{beside.what} %", ".1f"),
            Heading(f"micro_{k}", "µs", ".1f"),
            Heading(f"ratio_{k}", "÷ closed", ".1f"),
        ]
    title = f"batches of {_TARGETS} on one thread, judged: NAO arm (positions), leg (poses)"
    return Sheet("beside_closed", title, tuple(headings), list(rows.values()))


def _beside(what: str, chain: UrdfChain, targets: Floats, locked: Mapping[str, Any] | None) -> Beside:
    target = Target.of(targets[0])
    able = [name for name, method in METHODS.items() if method.refusal(chain, target) is None]
    jobs: dict[str, Callable[[], Any]] = {CLOSED: lambda: nk.solve_all_batch(chain, targets, locked=locked)}
    for name in able:
        jobs[name] = lambda name=name: nk.solve_batch(chain, targets, method=name)  # type: ignore[misc]
    success, times = dict[str, float](), dict[str, list[float]]()
    with one_thread():
        for name, job in progress(jobs.items(), f"closed form beside, {what}", len(jobs)):
            answer = job()  # compiles, too
            solved = answer.solved.any(axis=1) if name == CLOSED else answer.solved
            success[name], times[name] = 100.0 * float(solved.mean()), [seconds(job)]
        quick = {name: job for name, job in jobs.items() if times[name][0] < _SLOW}
        for name, more in in_turns(quick, range(_ROUNDS), {}).items():
            times[name] = more
    return Beside(what, success, {name: 1e6 * float(np.median(t)) / len(targets) for name, t in times.items()})
