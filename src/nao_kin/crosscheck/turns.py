"""Angles of a table that the model's orientations give away, one at a time, in closed form."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from nao_kin.crosscheck.edits import COLUMNS, Change, Edit, set_number
from nao_kin.crosscheck.tables import ALPHA, THETA, Goal, Motion, Tables, motion
from nao_kin.crosscheck.wording import angle_text, transform_text
from nao_kin.se3 import rotation_angle

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nao_kin.arrays import Floats

__all__ = ["EndEdit", "Fit", "angle_edit", "axial", "end_edits", "fitted_pairs", "fitted_turns", "snapped_rotation"]

EndEdit: TypeAlias = tuple[Edit, str]
"""An edit, and which end's translation it leaves open ("base", "tool" or "")."""

Fit: TypeAlias = tuple[int, Edit, str]
"""Index of a table in its batch, the edit, and which end's translation it leaves open."""

_NONE = np.zeros(3)
_ROUNDING = 1e-9
_SNAP = 1e-11


def fitted_turns(tables: Tables, found: Motion, goal: Goal, names: Sequence[str], bare: Sequence[str]) -> Iterator[Fit]:
    """The edits of one angle or one end's rotation that turn a table's tip as the model's at every configuration.

    With E = R_model R_table^T at each configuration: a wrong α or θ shows as E being a turn by the same angle about
    that row's own x or z everywhere; a wrong base as the same E everywhere; a wrong tool as the same R_table^T R_model.

    Args:
        tables: The tables.
        found: Their motion.
        goal: What they should do.
        names: Joint names.
        bare: The ends ("base", "tool") that the printed table does not have; only they can be missing as a whole.
    """
    E = goal.R @ np.swapaxes(found.R, -1, -2)
    vee = axial(E)
    cosine = 0.5 * (np.trace(E, axis1=-2, axis2=-1) - 1.0)
    for column, axes in ((ALPHA, found.x), (THETA, found.z)):
        sine = np.einsum("msi,mski->msk", vee, axes)
        angle = np.arctan2(sine.mean(axis=1), cosine.mean(axis=1)[:, None])  # (M, n)
        along = np.abs(vee[:, :, None] - sine[..., None] * axes).max(axis=(1, 3))
        steady = np.abs(sine - np.sin(angle)[:, None]).max(axis=1)
        steady = np.maximum(steady, np.abs(cosine[:, :, None] - np.cos(angle)[:, None]).max(axis=1))
        wrong = np.abs(angle) > goal.rotation
        for m, k in np.argwhere((np.maximum(along, steady) <= max(goal.rotation, _ROUNDING)) & wrong):
            old = tables.numbers[m, k, column]
            yield int(m), angle_edit(int(k), column, old, old + angle[m, k], names), ""
    yield from _fitted_ends(tables, found, goal, E, bare)


def axial(R: Floats) -> Floats:
    """Axis times sine of the angle (…, 3) of rotations (…, 3, 3)."""
    return 0.5 * np.stack(
        [R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], axis=-1
    )


def end_edits(end: str, turn: Floats, table: Tables, bare: Sequence[str], tolerance: float) -> list[EndEdit]:
    """The edits that turn an end of a table; its translation stays, turns with it, or is open.

    Args:
        end: "base", which turns in front, or "tool", which turns behind.
        turn: By what (3, 3).
        table: A batch of one.
        bare: The ends that the printed table does not have.
        tolerance: A smaller angle is none [rad].
    """
    if end == "base":
        R, p, words = turn @ table.base_rotation[0], table.base_translation[0], "behind"
        p_turned = turn @ p
    else:
        R, p, words = table.tool_rotation[0] @ turn, table.tool_translation[0], "last, behind"
        p_turned = R @ table.tool_in_tip_axes[0]
    edits: list[EndEdit] = []
    if end in bare:
        edits.append((Edit(f"missing {end}", end, _end_change(end, R, None), weight=2), end))
    angle = rotation_angle(turn)
    if angle <= tolerance:
        return edits
    said = transform_text(turn, _NONE)
    quarters = abs(math.remainder(angle, math.pi / 2)) < 1e-9 and " " not in said  # about one axis
    weight = 0 if quarters else 1
    for translation, order in ((p, words), (p_turned, "before"))[: 2 if p.any() else 1]:
        text = f"{end}: {said} more, {order} its translation"
        edits.append((Edit(f"{end} rotation", text, _end_change(end, R, translation), weight=weight), ""))
    return edits


def _fitted_ends(tables: Tables, found: Motion, goal: Goal, E: Floats, bare: Sequence[str]) -> Iterator[Fit]:
    tolerance = max(goal.rotation, _ROUNDING)
    D = np.swapaxes(found.R, -1, -2) @ goal.R
    for end, constant in (("base", E), ("tool", D)):
        for m in map(int, np.flatnonzero(np.abs(constant - constant[:, :1]).max(axis=(1, 2, 3)) <= tolerance)):
            for edit, free in end_edits(end, snapped_rotation(constant[m, 0]), tables.take([m]), bare, tolerance):
                yield m, edit, free


def _end_change(end: str, R: Floats, p: Floats | None) -> Change:
    def changed(t: Tables) -> Tables:
        changes: dict[str, Any] = {f"{end}_rotation": np.broadcast_to(R, t.base_rotation.shape).copy()}
        if p is not None:
            changes[f"{end}_translation"] = np.broadcast_to(p, t.base_translation.shape).copy()
        return replace(t, **changes)

    return changed


def angle_edit(k: int, column: int, old: float, new: float, names: Sequence[str]) -> Edit:
    """The edit that writes an angle into a row, at the round number it is next to."""
    value = _snapped_angle(new)
    text = f"row {k + 1} ({names[k]}): {COLUMNS[column]} {angle_text(old)} → {angle_text(value)}"
    return Edit(f"{COLUMNS[column]} number", text, set_number(k, column, value), weight=1)


def _snapped_angle(angle: float) -> float:
    """The angle within ±π, at the multiple of 15° or the short decimal that it rounds to."""
    within = math.remainder(angle, math.tau)
    for nearest in (round(within / (math.pi / 12)) * math.pi / 12, round(within, 6)):
        if abs(within - nearest) < _SNAP:
            return nearest
    return within


def snapped_rotation(R: Floats) -> Floats:
    """The rotation without rounding, with entries of 0 and ±1 where all are that."""
    near = np.round(R)
    if np.abs(R - near).max() < 1e-11:
        return near + 0.0
    U, _, Vt = np.linalg.svd(R)
    proper: Floats = U @ Vt
    return proper


_STEPS: Final = 14
_LONGEST_STEP: Final = 0.7  # [rad]
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
