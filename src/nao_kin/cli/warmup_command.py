"""`nao-kin warmup`: compile ahead what later calls need."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Final

import typer

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.dh.dh_chain import DHChain

__all__ = ["warmup"]

_QUARTER: Final = 1.5707963267948966
_SIX_JOINTS: Final = {
    "three parallel axes": ((0, _QUARTER, 0.09), (-0.4, 0, 0), (-0.4, 0, 0), (0, _QUARTER, 0.1), (0, -_QUARTER, 0.1)),
    "a spherical wrist": ((0, _QUARTER, 0.3), (0.4, 0, 0), (0, _QUARTER, 0.1), (0, -_QUARTER, 0.4), (0, _QUARTER, 0)),
    "no special axes": ((0.1, 1.1, 0.3), (0.4, 0.3, 0.1), (0.2, 1.3, 0.1), (0.1, -1.2, 0.4), (0.1, 0.9, 0.1)),
}
"""(a, α, d) of five rows, in metres and radians, the sixth being a turn: an arm for each closed form of six joints."""


def warmup() -> None:
    """Compile the kernels for this machine and keep them, so that later processes need not."""
    from nao_kin.kernels.compiling import cache_folder
    from nao_kin.output import progress

    started = time.perf_counter()
    for call in progress(_CALLS, "kernels", len(_CALLS)):
        call()
    folder = cache_folder()
    where = "without a folder to keep it in" if folder is None else f"kept in {folder}"
    typer.echo(f"ready after {time.perf_counter() - started:.1f} s, {where}", err=True)


def _forward_and_iterations() -> None:
    from nao_kin.ik.batch import solve_batch
    from nao_kin.ik.single import solve

    for chain, q in _arms():
        chain.jacobians(q[None, :])
        solve(chain, chain.pose(q), q, trace=True)
        solve_batch(chain, chain.poses(q[None, :]), q)


def _other_methods() -> None:
    from nao_kin.ik.batch import solve_batch
    from nao_kin.ik.single import solve

    (arm, q), _ = _arms()
    for method in ("dls", "combination", "ccd", "ftl", "fabrik"):
        solve(arm, arm.pose(q).translation, q, method=method)
    solve_batch(arm, arm.poses(q[None, :])[:, :3, 3], q, method="dls")


def _several_tips() -> None:
    from nao_kin.ik.tips.tree_solver import solve_tree
    from nao_kin.robot.robot import load

    nao = load("nao")
    hands = {name: nao.pose({}, name, base="torso") for name in ("LArm", "RArm")}
    solve_tree(nao.tree("torso", list(hands)), hands)


def _closed_forms() -> None:
    import numpy as np

    from nao_kin.analytic.solution_batch import solve_all_batch
    from nao_kin.analytic.solutions import solve_all
    from nao_kin.robot.robot import load

    nao, phantomx = load("nao"), load("phantomx")
    chains: list[Any] = [nao.chain(name) for name in ("left_arm", "head", "left_leg")]
    chains += [load("jaco2").chain("arm"), *map(_six_joints, _SIX_JOINTS)]
    for chain in chains:
        T = chain.pose(np.full(len(chain.joints), 0.1)).homogeneous
        solve_all(chain, T)
        solve_all_batch(chain, T[None, :, :])
    leg = phantomx.chain("leg_lf")
    p = leg.poses(np.full((1, 3), 0.1))[:, :3, 3]
    solve_all(leg, p[0])
    solve_all_batch(leg, p)


def _six_joints(kind: str) -> DHChain:
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.dh.dh_row import DHRow

    rows = [DHRow(a, alpha, d, 0.0) for a, alpha, d in (*_SIX_JOINTS[kind], (0, 0, 0.08))]
    return DHChain.from_table(rows, convention="standard")


def _maps() -> None:
    from nao_kin.robot.robot import load
    from nao_kin.workspace.mapping import reachability

    reachability(load("nao").chain("left_arm"), 1000)


_CALLS: Final[tuple[Callable[[], None], ...]] = (
    _forward_and_iterations,
    _other_methods,
    _several_tips,
    _closed_forms,
    _maps,
)


def _arms() -> list[tuple[Any, Any]]:
    """A chain of single joints and one with coupled limits, with joints to start from."""
    import numpy as np

    from nao_kin.robot.robot import load

    chains = [load("jaco2").chain("arm"), load("nao").chain("left_leg")]
    return [(chain, np.full(len(chain.joints), 0.1)) for chain in chains]
