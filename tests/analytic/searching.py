"""What tests of closed forms share: calling a kernel for many goals, and an independent search for all solutions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.analytic.form import Geometry
from nao_kin.kernels.audit import tips

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

POSE, POSITION = 0, 1


@dataclass(frozen=True, eq=False)
class Branches:
    """Solutions of N goals: joints (N, B, n), label and singularity (N, B), and which of them exist (N, B)."""

    q: Floats
    label: NDArray[np.int64]
    singularity: NDArray[np.int64]
    exists: NDArray[np.bool_]

    @property
    def counts(self) -> NDArray[np.int64]:
        return self.exists.sum(axis=1)

    def distance(self, Q: Floats) -> Floats:
        """How far the nearest branch is from given joints (N, n), by the largest move up to whole turns (N,)."""
        return np.where(self.exists, np.abs(wrapped(self.q - Q[:, None])).max(axis=2), np.inf).min(axis=1)

    def errors(self, path: JointPath, goals: Floats, rows: int = 3) -> Floats:
        """Largest entry by which the pose of any solution departs from its goal, as plain matrix products say."""
        reached = tips(path, np.ascontiguousarray(self.q[self.exists]))
        wanted = np.repeat(goals, self.counts, axis=0)
        columns = slice(0, 4) if rows == 3 else slice(3, 4)
        return np.abs(reached - wanted)[:, :3, columns].max(axis=(1, 2))


def branches(form: Any, kernel: Any, path: JointPath, goals: Floats, kind: int, slack: float = 0.0) -> Branches:
    """Every solution of goals (N, 4, 4), by a form's module and its kernel's."""
    geometry = form.recognise(path)
    assert isinstance(geometry, Geometry), geometry
    n = len(path.lower)
    rows = np.full((len(goals), kernel.BRANCHES, n + 2), np.nan)
    counts = np.zeros(len(goals), dtype=np.int64)
    kernel.solve_many(geometry.parameters, kind, goals, np.zeros((1, 1)), slack, rows, counts)
    exists = np.arange(kernel.BRANCHES) < counts[:, None]
    assert np.isfinite(rows[exists]).all()
    numbers = np.where(exists[:, :, None], rows[:, :, n:], -1).astype(np.int64)
    return Branches(rows[:, :, :n], numbers[:, :, 0], numbers[:, :, 1], exists)


def wrapped(angles: Floats) -> Floats:
    return np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi


def newton(
    residual: Callable[[Floats], Floats], jacobian: Callable[[Floats], Floats], starts: Floats, steps: int = 50
) -> Floats:
    """Roots that Levenberg's method finds from many starts (N, n): an oracle that knows no closed form.

    `residual` maps (N, n) to (N, m), `jacobian` to (N, m, n), both of the goal's error; only roots are returned.
    """
    Q = starts.copy()
    for _ in range(steps):
        r, J = residual(Q), jacobian(Q)
        damping = 1e-3 * (r * r).sum(axis=1)[:, None, None] + 1e-14
        JT = J.transpose(0, 2, 1)
        step = np.linalg.solve(JT @ J + damping * np.eye(Q.shape[1]), JT @ r[:, :, None])[:, :, 0]
        Q -= step * np.minimum(1.0, 1.0 / (np.abs(step).max(axis=1, keepdims=True) + 1e-300))
    return Q[np.abs(residual(Q)).max(axis=1) < 1e-9]


def moved(path: JointPath, base: Floats, tool: Floats) -> JointPath:
    """The path with a transform before it and one behind it."""
    rotations, translations = path.rotations.copy(), path.translations.copy()
    rotations[0], translations[0] = base[:3, :3] @ rotations[0], base[:3, :3] @ translations[0] + base[:3, 3]
    return replace_path(
        path,
        rotations=rotations,
        translations=translations,
        tool_rotation=np.ascontiguousarray(path.tool_rotation @ tool[:3, :3]),
        tool_translation=path.tool_rotation @ tool[:3, 3] + path.tool_translation,
    )


def replace_path(path: JointPath, **changes: Floats) -> JointPath:
    return path._replace(**changes)


def without_limits(path: JointPath) -> JointPath:
    n = len(path.lower)
    return replace_path(path, lower=np.full(n, -np.inf), upper=np.full(n, np.inf))


def random_poses(rng: np.random.Generator, count: int, size: float) -> Floats:
    """Poses of arbitrary orientation, positions uniform in a cube of half this size [m]."""
    x = rng.normal(size=(count, 4))
    w, a, b, c = (x / np.linalg.norm(x, axis=1, keepdims=True)).T
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, 0, :3] = np.stack([1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)], axis=1)
    T[:, 1, :3] = np.stack([2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)], axis=1)
    T[:, 2, :3] = np.stack([2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)], axis=1)
    T[:, :3, 3] = rng.uniform(-size, size, (count, 3))
    return T
