"""`nao-kin warmup`: compile ahead what later calls need."""

from __future__ import annotations

import time

import typer

__all__ = ["warmup"]


def warmup() -> None:
    """Compile the kernels for this machine and keep them, so that the first solve of later processes is quick."""
    import numpy as np

    from nao_kin.analytic.batch import solve_all_batch
    from nao_kin.analytic.solutions import solve_all
    from nao_kin.ik.batch import solve_batch
    from nao_kin.ik.methods import solve
    from nao_kin.kernels.compiling import cache_folder
    from nao_kin.robot import load

    started = time.perf_counter()
    for name, chain_name in (("jaco2", "arm"), ("nao", "left_leg")):
        chain = load(name).chain(chain_name)
        q = np.full(len(chain.joints), 0.1)
        chain.jacobians(q[None, :])
        solve(chain, chain.pose(q), q, trace=True)
        solve_batch(chain, chain.poses(q[None, :]), q)
    for chain_name in ("left_arm", "head"):
        chain = load("nao").chain(chain_name)
        T = chain.pose(np.full(len(chain.joints), 0.1)).homogeneous
        solve_all(chain, T)
        solve_all_batch(chain, T[None, :, :])
    folder = cache_folder()
    where = "without a folder to keep it in" if folder is None else f"kept in {folder}"
    typer.echo(f"ready after {time.perf_counter() - started:.1f} s, {where}", err=True)
