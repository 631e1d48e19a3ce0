"""Two wrong angles or end rotations of a table at a time, from the model's orientations."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from nao_kin.crosscheck.tables import ALPHA, THETA, Goal, Motion, Tables, motion
from nao_kin.crosscheck.turns import angle_edit, axial, end_edits, snapped_rotation

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.crosscheck.edits import Edit

__all__ = ["fitted_pairs"]

_STEPS: Final = 14
_LONGEST_STEP: Final = 0.7  # [rad]
_ROUNDING: Final = 1e-9
_COLUMNS: Final = (ALPHA, THETA)

Pair: TypeAlias = "tuple[tuple[Edit, ...], tuple[str, ...]]"


def fitted_pairs(printed: Tables, goal: Goal, names: Sequence[str], bare: Sequence[str]) -> Iterator[Pair]:
    """Pairs of angles and ends' rotations that together turn the tip as the model's.

    Yields the edits, and the ends whose translations they leave open. Two ends come in closed form; with an angle in
    the pair it is Gauss-Newton steps from the printed values, which may not arrive from far off. That is why known
    slips are tried first.
    """
    yield from _both_ends(printed, goal, bare)
    yield from _with_angles(printed, goal, names, bare)


def _both_ends(printed: Tables, goal: Goal, bare: Sequence[str]) -> Iterator[Pair]:
    """X R_table Y = R_model with constant X and Y: X carries the table's relative rotations to the model's."""
    R = motion(printed, goal.Q).R[0]
    own, wanted = axial(R[1:] @ R[0].T), axial(goal.R[1:] @ goal.R[0].T)
    U, _, Vt = np.linalg.svd(wanted.T @ own)
    X = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    Y = R[0].T @ X.T @ goal.R[0]
    tolerance = max(goal.rotation, _ROUNDING)
    if np.abs(X @ R @ Y - goal.R).max() > tolerance:
        return
    bases = end_edits("base", snapped_rotation(X), printed, bare, tolerance)
    tools = end_edits("tool", snapped_rotation(Y), printed, bare, tolerance)
    for (base, free_base), (tool, free_tool) in itertools.product(bases, tools):
        yield _open_last((base, free_base), (tool, free_tool))


def _with_angles(printed: Tables, goal: Goal, names: Sequence[str], bare: Sequence[str]) -> Iterator[Pair]:
    n = len(printed.slides)
    ends = {2 * n: "base", 2 * n + 1: "tool"}
    pairs = [pair for pair in itertools.combinations(range(2 * n + 2), 2) if pair[0] < 2 * n]
    tables = _stepped(printed, goal, pairs)
    tolerance = max(goal.rotation, _ROUNDING)
    left = np.abs(motion(tables, goal.Q).R - goal.R).max(axis=(1, 2, 3))
    for m in map(int, np.flatnonzero(left <= tolerance)):
        edits = []
        for place in pairs[m]:
            if place < 2 * n:
                k, column = place // 2, _COLUMNS[place % 2]
                old, new = printed.numbers[0, k, column], tables.numbers[m, k, column]
                edits.append([(angle_edit(k, column, old, new, names), "")])
                continue
            end = ends[place]
            new_R, old_R = (getattr(t, f"{end}_rotation")[i] for t, i in ((tables, m), (printed, 0)))
            turn = new_R @ old_R.T if end == "base" else old_R.T @ new_R
            edits.append(end_edits(end, snapped_rotation(turn), printed, bare, tolerance))
        for first, second in itertools.product(*edits):
            yield _open_last(first, second)


def _open_last(*edits: tuple[Edit, str]) -> Pair:
    """The edits with those that leave an end open behind the others, and the open ends in the same order."""
    ordered = sorted(edits, key=lambda pair: bool(pair[1]))
    return tuple(edit for edit, _ in ordered), tuple(end for _, end in ordered if end)


def _stepped(printed: Tables, goal: Goal, pairs: Sequence[tuple[int, ...]]) -> Tables:
    """The printed table once for each pair, with that pair's angles moved until orientations are as near as can be."""
    n = len(printed.slides)
    mask = np.zeros((len(pairs), 2 * n + 6))
    for m, pair in enumerate(pairs):
        for place in pair:
            first = place if place < 2 * n else 2 * n + 3 * (place - 2 * n)
            mask[m, first : first + (1 if place < 2 * n else 3)] = 1.0
    tables = printed.take(np.zeros(len(pairs), dtype=int))
    for _ in range(_STEPS):
        step = _step(motion(tables, goal.Q), goal, mask)
        numbers = tables.numbers.copy()
        numbers[:, :, list(_COLUMNS)] += step[:, : 2 * n].reshape(len(pairs), n, 2)
        tables = replace(
            tables,
            numbers=numbers,
            base_rotation=_turns(step[:, 2 * n : 2 * n + 3]) @ tables.base_rotation,
            tool_rotation=tables.tool_rotation @ _turns(step[:, 2 * n + 3 :]),
        )
    return tables


def _step(found: Motion, goal: Goal, mask: Floats) -> Floats:
    """One least-squares step (M, 2n + 6) of the angles that the mask lets move: α, θ of each row, base, tool."""
    M, S, n = found.x.shape[:3]
    vee = axial(goal.R @ np.swapaxes(found.R, -1, -2))
    rows = np.stack([found.x, found.z], axis=3).reshape(M, S, 2 * n, 3)
    base = np.broadcast_to(np.eye(3), (M, S, 3, 3))
    axes = np.concatenate([rows, base, np.swapaxes(found.R, -1, -2)], axis=2)
    J = np.swapaxes(axes, 2, 3).reshape(M, S * 3, -1) * mask[:, None]
    K = np.einsum("mri,mrj->mij", J, J)
    size = K.shape[-1]
    K += np.eye(size) * (1.0 - mask)[:, None] + 1e-9 * np.eye(size)
    right = np.einsum("mri,mr->mi", J, vee.reshape(M, S * 3))
    step: Floats = np.clip(np.linalg.solve(K, right[..., None])[..., 0], -_LONGEST_STEP, _LONGEST_STEP) * mask
    return step


def _turns(vectors: Floats) -> Floats:
    """Rotations (M, 3, 3) by rotation vectors (M, 3) [rad], Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    W = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    turns: Floats = np.eye(3) + np.sinc(angle / np.pi) * W + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * (W @ W)
    return turns
