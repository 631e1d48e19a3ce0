"""Angles of a table that the model's orientations give away: one at a time in closed form, two at a time by steps."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.crosscheck.edits import COLUMNS, Change, Edit, set_number
from nao_kin.crosscheck.tables import ALPHA, THETA, Goal, Motion, Tables, motion
from nao_kin.crosscheck.wording import angle_text, transform_text
from nao_kin.se3 import rotation_angle

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nao_kin.arrays import Floats

__all__ = ["Fit", "fitted_pairs", "fitted_turns"]

Fit = tuple[int, tuple[Edit, ...], str]
"""Index of the table in its batch, the edits, and which end's translation has become free ("base", "tool" or "")."""

_NONE = np.zeros(3)
_GAUSS_NEWTON_STEPS = 12
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
    vee = 0.5 * np.stack(
        [E[..., 2, 1] - E[..., 1, 2], E[..., 0, 2] - E[..., 2, 0], E[..., 1, 0] - E[..., 0, 1]], axis=-1
    )
    cosine = 0.5 * (np.trace(E, axis1=-2, axis2=-1) - 1.0)
    for column, axes in ((ALPHA, found.x), (THETA, found.z)):
        sine = np.einsum("msi,mski->msk", vee, axes)
        angle = np.arctan2(sine.mean(axis=1), cosine.mean(axis=1)[:, None])  # (M, n)
        along = np.abs(vee[:, :, None] - sine[..., None] * axes).max(axis=(1, 3))
        steady = np.abs(sine - np.sin(angle)[:, None]).max(axis=1)
        steady = np.maximum(steady, np.abs(cosine[:, :, None] - np.cos(angle)[:, None]).max(axis=1))
        wrong = np.abs(angle) > goal.rotation
        for m, k in np.argwhere((np.maximum(along, steady) <= max(goal.rotation, 1e-9)) & wrong):
            old = tables.numbers[m, k, column]
            yield int(m), (_angle_edit(int(k), column, old, old + angle[m, k], names),), ""
    yield from _fitted_ends(tables, found, goal, E, bare)


def fitted_pairs(printed: Tables, goal: Goal, names: Sequence[str]) -> Iterator[tuple[Tables, tuple[Edit, ...]]]:
    """Pairs of angles that together turn the tip as the model's, by Gauss-Newton steps from the printed values.

    From far off the steps may not arrive; that is why known slips are tried first.
    """
    n = len(printed.slides)
    places = [(k, column) for k in range(n) for column in (ALPHA, THETA)]
    pairs = list(itertools.combinations(range(2 * n), 2))
    mask = np.zeros((len(pairs), 2 * n))
    for m, pair in enumerate(pairs):
        mask[m, list(pair)] = 1.0
    tables = printed.take(np.zeros(len(pairs), dtype=int))
    columns = np.array([k * 4 + column for k, column in places])
    for _ in range(_GAUSS_NEWTON_STEPS):
        found = motion(tables, goal.Q)
        step = _step(found, goal, mask)
        numbers = tables.numbers.reshape(len(pairs), -1).copy()
        numbers[:, columns] += step
        tables = replace(tables, numbers=numbers.reshape(tables.numbers.shape))
    left = np.linalg.norm(motion(tables, goal.Q).R - goal.R, axis=(-2, -1)).max(axis=1)
    for m in map(int, np.flatnonzero(left <= max(goal.rotation, 1e-9))):
        edits = []
        for index in pairs[m]:
            k, column = places[index]
            old, new = printed.numbers[0, k, column], tables.numbers[m, k, column]
            edits.append(_angle_edit(k, column, old, new, names))
        if len(edits) == 2:
            yield tables.take([m]), tuple(edits)


def _step(found: Motion, goal: Goal, mask: Floats) -> Floats:
    """One least-squares step (M, 2n) of the angles that the mask lets move, from orientations alone."""
    M, S, n = found.x.shape[:3]
    E = goal.R @ np.swapaxes(found.R, -1, -2)
    vee = 0.5 * np.stack(
        [E[..., 2, 1] - E[..., 1, 2], E[..., 0, 2] - E[..., 2, 0], E[..., 1, 0] - E[..., 0, 1]], axis=-1
    )
    axes = np.stack([found.x, found.z], axis=3).reshape(M, S, 2 * n, 3)
    J = np.swapaxes(axes, 2, 3).reshape(M, S * 3, 2 * n) * mask[:, None]
    K = np.einsum("mri,mrj->mij", J, J)
    K += np.eye(2 * n) * (1.0 - mask)[:, None] + 1e-9 * np.eye(2 * n)
    right = np.einsum("mri,mr->mi", J, vee.reshape(M, S * 3))
    step: Floats = np.clip(np.linalg.solve(K, right[..., None])[..., 0], -0.7, 0.7) * mask
    return step


def _fitted_ends(tables: Tables, found: Motion, goal: Goal, E: Floats, bare: Sequence[str]) -> Iterator[Fit]:
    tolerance = max(goal.rotation, 1e-9)
    D = np.swapaxes(found.R, -1, -2) @ goal.R
    for m in np.flatnonzero(np.abs(E - E[:, :1]).max(axis=(1, 2, 3)) <= tolerance):
        turn, R, p = _snapped(E[m, 0]), tables.base_rotation[m], tables.base_translation[m]
        if "base" in bare:
            yield (
                int(m),
                (Edit("missing base", "base", _end_change("base", _snapped(turn @ R), None), weight=2),),
                "base",
            )
        yield from _end_fits(int(m), "base", turn, _snapped(turn @ R), p, turn @ p, tolerance)
    for m in np.flatnonzero(np.abs(D - D[:, :1]).max(axis=(1, 2, 3)) <= tolerance):
        turn, R = _snapped(D[m, 0]), tables.tool_rotation[m]
        turned = _snapped(R @ turn)
        if "tool" in bare:
            yield int(m), (Edit("missing tool", "tool", _end_change("tool", turned, None), weight=2),), "tool"
        yield from _end_fits(
            int(m), "tool", turn, turned, tables.tool_translation[m], turned @ tables.tool_in_tip_axes[m], tolerance
        )


def _end_fits(
    m: int, end: str, turn: Floats, R: Floats, p: Floats, p_turned: Floats, tolerance: float
) -> Iterator[Fit]:
    """The edits that turn an end; its translation stays or turns with it."""
    angle = rotation_angle(turn)
    if angle <= tolerance:
        return
    said = transform_text(turn, _NONE)
    quarters = abs(math.remainder(angle, math.pi / 2)) < 1e-9 and " " not in said  # about one axis
    orders = [(p, "behind" if end == "base" else "last, behind")]
    if p.any():
        orders.append((p_turned, "before"))
    for translation, order in orders:
        text = f"{end}: {said} more, {order} its translation"
        yield m, (Edit(f"{end} rotation", text, _end_change(end, R, translation), weight=0 if quarters else 1),), ""


def _end_change(end: str, R: Floats, p: Floats | None) -> Change:
    def changed(t: Tables) -> Tables:
        changes: dict[str, Any] = {f"{end}_rotation": np.broadcast_to(R, t.base_rotation.shape).copy()}
        if p is not None:
            changes[f"{end}_translation"] = np.broadcast_to(p, t.base_translation.shape).copy()
        return replace(t, **changes)

    return changed


def _angle_edit(k: int, column: int, old: float, new: float, names: Sequence[str]) -> Edit:
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


def _snapped(R: Floats) -> Floats:
    near = np.round(R)
    if np.abs(R - near).max() < 1e-11:
        return near + 0.0
    U, _, Vt = np.linalg.svd(R)
    proper: Floats = U @ Vt
    return proper
