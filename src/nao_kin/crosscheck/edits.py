"""The errors that people make in DH tables, each as the edit that takes it back, on many tables at once."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from nao_kin.crosscheck.tables import ALPHA, THETA, A, D, Tables, motion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from nao_kin.arrays import Floats

__all__ = ["COLUMNS", "Change", "Edit", "known_edits", "set_number"]

Change: TypeAlias = "Callable[[Tables], Tables]"

COLUMNS = ("a", "alpha", "d", "theta")
_DEGREE = math.pi / 180.0
_FULL_TURN = 2.0 * math.pi
_LONGEST, _SHORTEST = 10.0, 0.01  # [m] arms beyond these were probably given in another unit
_QUARTERS = ((math.pi / 2, "+π/2"), (-math.pi / 2, "-π/2"), (math.pi, "+π"))


@dataclass(frozen=True, slots=True)
class Edit:
    """One change of a table that takes a usual error back.

    Attributes:
        kind: What sort of error it takes back, a word for programs.
        text: What to do, for people.
        change: The change, on any number of tables.
        weight: How far-fetched it is: 0 for a known slip, 1 for a number or turn fitted to the model, 2 for more than
            that. Among sets of equally many edits the lightest come first.
    """

    kind: str
    text: str
    change: Change = field(compare=False, repr=False)
    weight: int = 0

    def __str__(self) -> str:
        return self.text


def known_edits(printed: Tables, names: Sequence[str]) -> list[Edit]:
    """Every known slip that could be in a table, without those that would not change it.

    Args:
        printed: The table, a batch of one.
        names: Its joint names.
    """
    edits = [
        *_conventions(printed),
        *_joint_signs(names, printed),
        *_signs_of_angles(names),
        *_quarter_turns(names),
        *_exchanges(names),
        *_units(printed, names),
        *_columns(),
        *_mirrors(),
        *_ends(),
    ]
    after = Tables.joined([edit.change(printed) for edit in edits]).keys()
    seen, kept = {printed.keys()[0]}, []
    for edit, key in zip(edits, after, strict=True):
        if key not in seen:
            seen.add(key)
            kept.append(edit)
    return kept


def set_number(row: int, column: int, value: float) -> Change:
    """The change that writes a number into a place, for all tables alike."""
    return lambda tables: _with_numbers(tables, lambda N: _assign(N, row, column, value))


def _conventions(printed: Tables) -> Iterator[Edit]:
    other = "standard" if printed.modified[0] else "modified"
    yield Edit("convention", f"read the table in the {other} convention", lambda t: replace(t, modified=~t.modified))


def _joint_signs(names: Sequence[str], printed: Tables) -> Iterator[Edit]:
    for k, name in enumerate(names):

        def flipped(t: Tables, k: int = k) -> Tables:
            signs = t.signs.copy()
            signs[:, k] *= -1.0
            return replace(t, signs=signs)

        what = "d" if printed.slides[k] else "θ"
        yield Edit("joint sign", f"row {k + 1} ({name}): the joint value with the other sign in {what}", flipped)


def _signs_of_angles(names: Sequence[str]) -> Iterator[Edit]:
    for k, name in enumerate(names):
        for column, kind in ((ALPHA, "alpha sign"), (THETA, "theta sign")):
            text = f"row {k + 1} ({name}): {COLUMNS[column]} with the other sign"
            yield Edit(kind, text, _scaled(k, column, -1.0))


def _quarter_turns(names: Sequence[str]) -> Iterator[Edit]:
    for (k, name), column in itertools.product(enumerate(names), (THETA, ALPHA)):
        for turn, text in _QUARTERS:

            def turned(t: Tables, k: int = k, column: int = column, turn: float = turn) -> Tables:
                return _with_numbers(t, lambda N: _assign(N, k, column, N[:, k, column] + turn))

            said = f"row {k + 1} ({name}): {COLUMNS[column]} offset {text}"
            yield Edit(f"{COLUMNS[column]} offset", said, turned)


def _exchanges(names: Sequence[str]) -> Iterator[Edit]:
    rows = range(len(names))
    for k, name in enumerate(names):
        yield Edit("a and d exchanged", f"row {k + 1} ({name}): exchange a and d", _permuted(k, k, (A, D), (D, A)))
    for (i, j), c in itertools.product(itertools.combinations(rows, 2), range(4)):
        text = f"rows {i + 1} and {j + 1} ({names[i]}, {names[j]}): exchange their {COLUMNS[c]}"
        yield Edit("value in the wrong row", text, _permuted(i, j, (c,), (c,)))
    for i, j in itertools.combinations(rows, 2):

        def exchanged(t: Tables, i: int = i, j: int = j) -> Tables:
            order = list(rows)
            order[i], order[j] = j, i
            return replace(t, numbers=t.numbers[:, order], signs=t.signs[:, order])

        yield Edit("rows exchanged", f"exchange rows {i + 1} and {j + 1} ({names[i]}, {names[j]})", exchanged)


def _units(printed: Tables, names: Sequence[str]) -> Iterator[Edit]:
    numbers = printed.numbers[0]
    lengths = np.abs(
        np.concatenate([numbers[:, [A, D]].ravel(), printed.base_translation[0], printed.tool_translation[0]])
    )
    for factor, said, likely in (
        (1e-3, "millimetres were given as metres", lengths.max() > _LONGEST),
        (1e3, "metres were given as millimetres", 0.0 < lengths.max() < _SHORTEST),
    ):
        if likely:
            for which, scaled in (
                ("all lengths", _lengths_scaled(factor, rows=True, ends=True)),
                ("lengths of all rows", _lengths_scaled(factor, rows=True, ends=False)),
                ("lengths of base and tool", _lengths_scaled(factor, rows=False, ends=True)),
            ):
                yield Edit("length unit", f"{which} × {factor:g}: {said}", scaled)
    largest = np.abs(numbers[:, [ALPHA, THETA]])
    for factor, said, likely in (
        (_DEGREE, "degrees were given as radians", largest.max() > _FULL_TURN),
        (1.0 / _DEGREE, "radians were given as degrees", 0.0 < largest.max() < _FULL_TURN * _DEGREE),
    ):
        if likely:
            columns = {"": (ALPHA, THETA), "alpha ": (ALPHA,), "theta ": (THETA,)}
            for which, own in columns.items():
                text = f"all {which or 'angles '}× {'π/180' if factor < 1.0 else '180/π'}: {said}"
                yield Edit("angle unit", text, _columns_scaled(own, factor))
    for k, column in itertools.product(range(len(names)), (ALPHA, THETA)):
        for factor, said, likely in (
            (_DEGREE, "given in degrees", abs(numbers[k, column]) > _FULL_TURN),
            (1.0 / _DEGREE, "given in radians, read as degrees", 0.0 < abs(numbers[k, column]) < 0.1),
        ):
            if likely:
                text = f"row {k + 1} ({names[k]}): {COLUMNS[column]} was {said}"
                yield Edit("angle unit", text, _scaled(k, column, factor))


def _columns() -> Iterator[Edit]:
    for column, name in enumerate(COLUMNS):
        yield Edit("column sign", f"{name} of all rows with the other sign", _columns_scaled((column,), -1.0))
    yield Edit("column sign", "all joint values with the other sign", lambda t: replace(t, signs=-t.signs))


def _mirrors() -> Iterator[Edit]:
    for (axis, plane), keep in itertools.product(((1, "xz"), (0, "yz"), (2, "xy")), (True, False)):

        def mirrored(t: Tables, axis: int = axis, keep: bool = keep) -> Tables:
            return _mirrored(t, axis, keep_senses=keep)

        senses = "joints turning about the directions they had" if keep else "and the senses of its joints"
        text = f"mirror the whole chain at the base's {plane} plane, {senses}"
        yield Edit("mirrored side", text, mirrored, weight=1)


def _ends() -> Iterator[Edit]:
    one, none = np.eye(3), np.zeros(3)

    def like(value: Floats, array: Floats) -> Floats:
        return np.broadcast_to(value, array.shape).copy()

    def without_base(t: Tables) -> Tables:
        return replace(t, base_rotation=like(one, t.base_rotation), base_translation=like(none, t.base_translation))

    def without_tool(t: Tables) -> Tables:
        return replace(t, tool_rotation=like(one, t.tool_rotation), tool_translation=like(none, t.tool_translation))

    def unturned_base(t: Tables) -> Tables:
        return replace(t, base_rotation=like(one, t.base_rotation))

    def unturned_tool(t: Tables) -> Tables:
        return replace(t, tool_rotation=like(one, t.tool_rotation))

    def unturned_before(t: Tables) -> Tables:
        return replace(t, tool_rotation=like(one, t.tool_rotation), tool_translation=t.tool_in_tip_axes)

    yield Edit("extra base", "leave out the base transform", without_base)
    yield Edit("extra tool", "leave out the tool transform", without_tool)
    yield Edit("extra base rotation", "leave out the base's rotation", unturned_base)
    yield Edit("extra tool rotation", "leave out the tool's rotation behind its translation", unturned_tool)
    yield Edit("extra tool rotation", "leave out the tool's rotation before its translation", unturned_before)


def _with_numbers(tables: Tables, change: Callable[[Floats], None]) -> Tables:
    numbers = tables.numbers.copy()
    change(numbers)
    return replace(tables, numbers=numbers)


def _assign(numbers: Floats, row: int, column: int, value: Any) -> None:
    numbers[:, row, column] = value


def _scaled(row: int, column: int, factor: float) -> Change:
    return lambda t: _with_numbers(t, lambda N: _assign(N, row, column, factor * N[:, row, column]))


def _columns_scaled(columns: Sequence[int], factor: float) -> Change:
    factors = np.ones(4)
    factors[list(columns)] = factor
    return lambda t: replace(t, numbers=t.numbers * factors)


def _lengths_scaled(factor: float, *, rows: bool, ends: bool) -> Change:
    of_rows, of_ends = _columns_scaled((A, D), factor if rows else 1.0), factor if ends else 1.0
    return lambda t: replace(
        of_rows(t), base_translation=of_ends * t.base_translation, tool_translation=of_ends * t.tool_translation
    )


def _permuted(i: int, j: int, first: Sequence[int], second: Sequence[int]) -> Change:
    """Exchanges places (i, first) and (j, second)."""

    def changed(t: Tables) -> Tables:
        numbers = t.numbers.copy()
        numbers[:, i, list(first)] = t.numbers[:, j, list(second)]
        numbers[:, j, list(second)] = t.numbers[:, i, list(first)]
        return replace(t, numbers=numbers)

    return changed


def _mirrored(t: Tables, axis: int, *, keep_senses: bool) -> Tables:
    """The same arm on the other side: T(q) becomes M T(S q) M.

    M reverses one axis of base and tip. Each inner frame is mirrored at its own xz plane, which turns α and θ round and
    leaves a and d. Where senses are kept, S lets each joint turn about the direction nearest to the one it had, as on
    the two arms of a robot, and a joint half way between turns as its mirror image does; else S is the identity.
    """
    M, inner = np.eye(3), np.diag([1.0, -1.0, 1.0])
    M[axis, axis] = -1.0
    directions = motion(t, np.zeros((1, len(t.slides)))).z[:, 0] * t.signs[:, :, None]
    turned = np.where(t.slides[:, None], 1.0, -1.0) * (directions @ M)  # an axis of rotation mirrors the other way
    against = np.einsum("mki,mki->mk", turned, directions) < -1e-9
    senses = np.where(against & keep_senses, -1.0, 1.0)
    own = np.where(t.slides, 1.0, -1.0)
    return replace(
        t,
        numbers=t.numbers * np.array([1.0, -1.0, 1.0, -1.0]),
        signs=t.signs * own * senses,
        base_rotation=M @ t.base_rotation @ inner,
        base_translation=t.base_translation @ M,
        tool_rotation=inner @ t.tool_rotation @ M,
        tool_translation=t.tool_translation @ inner,
    )
