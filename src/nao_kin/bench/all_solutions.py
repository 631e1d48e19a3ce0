"""All solutions of many goals by multi-start Newton, apart from every closed form: what these are measured against."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.analytic.form import GoalKind
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["apart", "least_singular_value", "multi_start", "task_errors", "task_jacobian"]

_ITERATIONS: Final = 60
_CONVERGED: Final = 1e-11  # [m, rad]
_ONE: Final = 1e-5  # solutions nearer than this are one [rad]


def multi_start(
    chain: Chain, kind: GoalKind, goals: Floats, locked: Floats, starts: int, rng: np.random.Generator
) -> list[Floats]:
    """The solutions that damped Newton steps from random starts find for each goal, limits left out.

    The steps are on the chain's compiled kinematics and treat all starts of all goals at once.

    Args:
        chain: A chain of turning joints.
        kind: What is wanted of the tip.
        goals: Goals (N, 4, 4), see `nao_kin.ik.target.Target`.
        locked: Values of locked joints (N, n), NaN for the others [rad].
        starts: Starts for each goal.
        rng: Where they come from.

    Returns:
        For each goal its solutions (k, n), angles in [−π, π).
    """
    n, fixed = len(chain.joints), ~np.isnan(locked[0])
    every = np.repeat(goals, starts, axis=0)
    Q = rng.uniform(-np.pi, np.pi, (len(every), n))
    Q[:, fixed] = np.repeat(locked[:, fixed], starts, axis=0)
    for _ in range(_ITERATIONS):
        e = task_errors(kind, every, chain.poses(Q))
        J = task_jacobian(kind, every, chain.poses(Q), chain.jacobians(Q))
        J[:, :, fixed] = 0.0
        squared = np.einsum("ni,ni->n", e, e)
        A = np.einsum("nij,nik->njk", J, J) + (0.02 * squared + 1e-15)[:, None, None] * np.eye(n)
        step = np.linalg.solve(A, np.einsum("nij,ni->nj", J, e)[:, :, None])[:, :, 0]
        Q += step / np.maximum(1.0, np.abs(step).max(axis=1, keepdims=True))
    e = task_errors(kind, every, chain.poses(Q))
    converged = (np.abs(e).max(axis=1) <= _CONVERGED) & _right_way(kind, every, chain.poses(Q))
    Q = (Q + np.pi) % (2.0 * np.pi) - np.pi
    groups = zip(Q.reshape(len(goals), starts, n), converged.reshape(len(goals), starts), strict=True)
    return [_distinct(found[good]) for found, good in groups]


def task_errors(kind: GoalKind, goals: Floats, tips: Floats) -> Floats:
    """What is missing of each goal (N, m): positions [m], and turns as sines [rad near 0]."""
    parts = [goals[:, :3, 3] - tips[:, :3, 3]] if kind in ("pose", "position", "pointing") else []
    if kind in ("pose", "orientation"):
        E = goals[:, :3, :3] @ tips[:, :3, :3].transpose(0, 2, 1)
        skew = np.stack([E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]], axis=1)
        # Longer than the sine beyond a right angle, so that half a turn is no solution.
        trace = np.einsum("nii->n", E)
        parts.append(skew / np.sqrt(np.maximum(1.0 + trace, 1e-3))[:, None])
    if kind in ("pointing", "direction"):
        parts.append(np.cross(_axes(goals, tips), goals[:, :3, 1]))
    return np.concatenate(parts, axis=1)


def task_jacobian(kind: GoalKind, goals: Floats, tips: Floats, jacobians: Floats) -> Floats:
    """What the joints do to the tip's part of each goal (N, m, n), turns as rotation vectors."""
    parts = [jacobians[:, :3]] if kind in ("pose", "position", "pointing") else []
    if kind in ("pose", "orientation"):
        parts.append(jacobians[:, 3:])
    if kind in ("pointing", "direction"):
        a = _axes(goals, tips)
        across = np.eye(3) - a[:, :, None] * a[:, None, :]
        parts.append(across @ jacobians[:, 3:])
    return np.concatenate(parts, axis=1)


def least_singular_value(kind: GoalKind, goals: Floats, chain: Chain, Q: Floats, free: NDArray[np.bool_]) -> Floats:
    """Least singular value over the free joints (N,) of what the goals ask."""
    J = task_jacobian(kind, goals, chain.poses(Q), chain.jacobians(Q))[:, :, free]
    return np.asarray(np.linalg.svd(J, compute_uv=False)[:, : int(free.sum())].min(axis=1))


def apart(solutions: Floats, q: Floats) -> float:
    """Largest joint move from q to the nearest of some solutions, whole turns left out [rad]; infinite if none."""
    moves = np.abs((solutions - q + np.pi) % (2.0 * np.pi) - np.pi).max(axis=-1, initial=0.0)
    return float(moves.min(initial=np.inf))


def _axes(goals: Floats, tips: Floats) -> Floats:
    return np.asarray(np.einsum("nij,nj->ni", tips[:, :3, :3], goals[:, :3, 0]))


def _right_way(kind: GoalKind, goals: Floats, tips: Floats) -> NDArray[np.bool_]:
    """Whether an axis points along its direction and not against it."""
    if kind not in ("pointing", "direction"):
        return np.ones(len(goals), dtype=np.bool_)
    return np.asarray(np.einsum("ni,ni->n", _axes(goals, tips), goals[:, :3, 1]) > 0.0)


def _distinct(found: Floats) -> Floats:
    kept: list[Floats] = []
    for q in found:
        if not kept or apart(np.array(kept), q) > _ONE:
            kept.append(q)
    return np.array(kept).reshape(len(kept), found.shape[1])
