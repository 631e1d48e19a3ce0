"""When no usual error explains a table: the smallest changes of its numbers that bring it nearest to the model."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.crosscheck.edits import COLUMNS
from nao_kin.crosscheck.tables import ALPHA, THETA, A, D, Goal, Motion, Tables, errors_of, motion
from nao_kin.crosscheck.wording import length_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats

__all__ = ["SmallestChanges", "smallest_changes"]

_STEPS: Final = 60
_ARM: Final = 0.1  # [m/rad] how much turning counts as much as how much length, in "smallest"
_CUT: Final = 1e-7  # of the largest singular value: changes that move the tip less than this stay 0
_UNCHANGED: Final = 1e-9


@dataclass(frozen=True, slots=True)
class SmallestChanges:
    """The least change of all numbers together that a least-squares fit found; a description, not a cause.

    Attributes:
        changes: Words for each number that changes, the largest change first.
        table: The changed table, a batch of one.
        position_error: What is left at the tip [m].
        rotation_error: What is left [rad].
    """

    changes: tuple[str, ...]
    table: Tables
    position_error: float
    rotation_error: float


def smallest_changes(printed: Tables, goal: Goal, names: Sequence[str]) -> SmallestChanges:
    """Damped Gauss-Newton from the printed numbers, each step the shortest that serves, 1 rad counting as 100 mm."""
    table, damping = printed, 1e-3
    cost = _cost(table, goal)
    for _ in range(_STEPS):
        trial = _moved(table, _step(table, goal, damping))
        if (new := _cost(trial, goal)) < cost:
            converged = cost - new <= 1e-14 * cost
            table, cost, damping = trial, new, damping * 0.2
            if converged:
                break
        else:
            damping *= 8.0
            if damping > 1e8:
                break
    position, rotation = errors_of(motion(table, goal.Q), goal)
    return SmallestChanges(_changes(printed, table, names), table, float(position[0]), float(rotation[0]))


def _residual(found: Motion, goal: Goal) -> Floats:
    """Positions [m] and turns [rad · arm], one after the other (6·S,)."""
    turns = np.array([pin.log3(R @ R_own.T) for R, R_own in zip(goal.R, found.R[0], strict=True)])
    return np.concatenate([(goal.p - found.p[0]).ravel(), _ARM * turns.ravel()])


def _cost(table: Tables, goal: Goal) -> float:
    r = _residual(motion(table, goal.Q), goal)
    return float(r @ r)


def _step(table: Tables, goal: Goal, damping: float) -> Floats:
    """Changes of a, α, d, θ of all rows and of base and tool (turn, shift) (4n + 12,), lengths in metres."""
    found = motion(table, goal.Q)
    tip, S, n = found.p[0], len(goal.Q), len(table.slides)
    none = np.zeros((S, 3))

    def turning(axis: Floats, at: Floats) -> tuple[Floats, Floats]:
        return np.cross(axis, tip - at), axis

    columns: list[tuple[Floats, Floats]] = []
    for k in range(n):
        x, z = found.x[0, :, k], found.z[0, :, k]
        columns += [(x, none), turning(x, found.at_x[0, :, k]), (z, none), turning(z, found.at_z[0, :, k])]
    axes = [np.tile(axis, (S, 1)) for axis in np.eye(3)]
    columns += [turning(axis, table.base_translation[0]) for axis in axes] + [(axis, none) for axis in axes]
    in_tip = [found.R[0, :, :, c] for c in range(3)]
    columns += [(none, axis) for axis in in_tip] + [(axis, none) for axis in in_tip]
    J = np.array([np.concatenate([linear.ravel(), _ARM * angular.ravel()]) for linear, angular in columns]).T
    scale = np.where(_is_angle(n), 1.0 / _ARM, 1.0)
    U, s, Vt = np.linalg.svd(J * scale, full_matrices=False)
    kept = s > _CUT * s[0]
    gain = np.where(kept, s / (s * s + damping * damping * s[0] * s[0]), 0.0)
    step: Floats = scale * (Vt.T @ (gain * (U.T @ _residual(found, goal))))
    return step


def _is_angle(n: int) -> Floats:
    row, end = [False, True, False, True], [True] * 3 + [False] * 3
    return np.array(row * n + end * 2)


def _moved(table: Tables, step: Floats) -> Tables:
    n = len(table.slides)
    base, tool = step[4 * n : 4 * n + 6], step[4 * n + 6 :]
    tool_rotation = table.tool_rotation[0] @ pin.exp3(tool[:3])
    return replace(
        table,
        numbers=table.numbers + step[: 4 * n].reshape(1, n, 4),
        base_rotation=(pin.exp3(base[:3]) @ table.base_rotation[0])[None],
        base_translation=table.base_translation + base[3:],
        tool_rotation=tool_rotation[None],
        tool_translation=table.tool_translation + table.tool_rotation[0] @ tool[3:],
    )


def _changes(old: Tables, new: Tables, names: Sequence[str]) -> tuple[str, ...]:
    found: list[tuple[float, str]] = []
    difference = new.numbers[0] - old.numbers[0]
    for k, name in enumerate(names):
        for c in (A, ALPHA, D, THETA):
            change, angle = float(difference[k, c]), c in (ALPHA, THETA)
            said = f"{change:+.6g} rad" if angle else f"{'+' if change > 0 else ''}{length_text(change)}"
            found.append((abs(change) * (_ARM if angle else 1.0), f"row {k + 1} ({name}): {COLUMNS[c]} {said}"))
    for end in ("base", "tool"):
        turn = pin.log3(getattr(new, f"{end}_rotation")[0] @ getattr(old, f"{end}_rotation")[0].T)
        shift = getattr(new, f"{end}_translation")[0] - getattr(old, f"{end}_translation")[0]
        found.append((_ARM * float(np.linalg.norm(turn)), f"{end} turned by {np.linalg.norm(turn):.6g} rad"))
        found.append((float(np.linalg.norm(shift)), f"{end} shifted by {length_text(float(np.linalg.norm(shift)))}"))
    return tuple(text for size, text in sorted(found, key=lambda pair: -pair[0]) if size > _UNCHANGED)
