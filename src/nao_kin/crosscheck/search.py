"""The search for the fewest edits that make a table move as a model.

Orientations depend on angles, signs and convention alone, and once they agree, positions are linear in the lengths. So
a set of N edits is d edits that make the orientations agree and N − d lengths, for every d: levels of turned tables
(`_Level`) are built once, all sets of one and two edits in full and larger ones from the most promising tables on, and
the lengths are asked of each table whose orientations agree.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.crosscheck.edits import COLUMNS, Edit, known_edits
from nao_kin.crosscheck.tables import A, D, Goal, Motion, Tables, errors_of, motion
from nao_kin.crosscheck.turns import fitted_pairs, fitted_turns
from nao_kin.crosscheck.wording import length_text, transform_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from nao_kin.arrays import Floats

__all__ = ["MOST_EDITS", "Candidate", "Search", "applied", "length_edits"]

MOST_EDITS: Final = 6
_BEAM: Final = 120  # tables of a level from which the next one is built, from the third level on
_FIRST_LOOK: Final = 2  # configurations that rule out most tables
_ASKED: Final = {0: 100_000, 1: 4000, 2: 200, 3: 60, 4: 4}
"""How many tables of a level are asked for sets of so many lengths: the larger the sets, the dearer the question."""


@dataclass(frozen=True, eq=False, slots=True)
class Candidate:
    """A table out of the search.

    Attributes:
        table: A batch of one.
        edits: What turns the printed table into it, in the order of application.
        free: The ends ("base", "tool") whose translations are still open, of the last edits in their order.
    """

    table: Tables
    edits: tuple[Edit, ...]
    free: tuple[str, ...] = ()

    @property
    def rank(self) -> tuple[int, int, int]:
        """Fewest edits first, then the least far-fetched, then wrong numbers before missing ones."""
        dropped = sum(edit.kind == "dropped offset" for edit in self.edits)
        return len(self.edits), sum(edit.weight for edit in self.edits), dropped


@dataclass(frozen=True, eq=False, slots=True)
class _Level:
    """Tables after d edits: those whose orientations agree, and the best of the others to go on from."""

    turned: tuple[Candidate, ...]
    open: tuple[Candidate, ...]


class Search:
    """The search on one table and one goal; levels are built when they are asked for."""

    def __init__(self, printed: Tables, goal: Goal, names: Sequence[str]) -> None:
        self.goal, self.names = goal, names
        self.known = known_edits(printed, names)
        ends = (
            ("base", printed.base_rotation, printed.base_translation),
            ("tool", printed.tool_rotation, printed.tool_translation),
        )
        self.bare = tuple(end for end, R, p in ends if not p.any() and np.allclose(R, np.eye(3), rtol=0.0, atol=1e-12))
        start = Candidate(printed, ())
        turned = self._is_turned(printed)[0]
        self.levels = [_Level((start,) if turned else (), (start,))]
        self._seen = set(printed.keys())

    def explanations(self, count: int) -> Iterator[Candidate]:
        """Every set of exactly `count` edits that was found to bring the table to the goal."""
        for d in range(count + 1):
            lengths = count - d
            if lengths not in _ASKED:
                continue
            level = self._level(d)
            yield from self._with_lengths(level.turned[: _ASKED[lengths]], lengths)

    def _with_lengths(self, candidates: Sequence[Candidate], count: int) -> Iterator[Candidate]:
        if not candidates:
            return
        found = motion(Tables.joined([c.table for c in candidates]), self.goal.Q)
        position, _ = errors_of(found, self.goal)
        for m, candidate in enumerate(candidates):
            if count == 0 and not candidate.free:
                if position[m] <= self.goal.position:
                    yield candidate
                continue
            for edits in length_edits(candidate.table, found.take([m]), self.goal, count, candidate.free, self.names):
                # An open end's rotation and translation are one edit.
                before = candidate.edits[: len(candidate.edits) - len(candidate.free)]
                yield Candidate(applied(edits, candidate.table), (*before, *edits))

    def _level(self, d: int) -> _Level:
        while len(self.levels) <= d:
            self.levels.append(self._next_level(len(self.levels)))
        return self.levels[d]

    def _next_level(self, d: int) -> _Level:
        before = self.levels[d - 1]
        parents = [*before.turned, *before.open] if d <= 2 else [*before.turned[:_BEAM], *before.open[:_BEAM]]
        parents = list({id(c): c for c in parents if not c.free}.values())
        if not parents:
            return _Level((), ())
        tables = Tables.joined([c.table for c in parents])
        fitted = self._fitted(parents, tables)
        if d == 2:
            start = self.levels[0].open[0]
            for edits, free in fitted_pairs(start.table, self.goal, self.names, self.bare):
                fitted.append(Candidate(applied(edits, start.table), edits, free))
        turned, open_ = self._known_on(parents, tables, d)
        turned += self._new(fitted)
        turned.sort(key=lambda c: c.rank)
        return _Level(tuple(turned), tuple(open_))

    def _known_on(
        self, parents: Sequence[Candidate], tables: Tables, d: int
    ) -> tuple[list[Candidate], list[Candidate]]:
        """All known edits on all parents, and from the third level on only the most promising of the rest."""
        batch = Tables.joined([edit.change(tables) for edit in self.known])
        few = self.goal.first(_FIRST_LOOK)
        found = motion(batch, few.Q)
        near = np.flatnonzero(errors_of(found, few)[1] <= self.goal.rotation)
        kept = near[self._is_turned(batch.take(near))] if len(near) else near
        turned = self._new(self._candidate(batch, int(i), parents) for i in kept)
        if d == 1:
            return turned, self._new(self._candidate(batch, i, parents) for i in range(len(batch)))
        best = np.argsort(_unsteadiness(found, few), kind="stable")[: 8 * _BEAM]
        order = np.argsort(_unsteadiness(motion(batch.take(best), self.goal.Q), self.goal), kind="stable")
        open_ = self._new(self._candidate(batch, int(i), parents) for i in best[order[: 2 * _BEAM]])
        return turned, open_[:_BEAM]

    def _candidate(self, batch: Tables, i: int, parents: Sequence[Candidate]) -> Candidate:
        edit, parent = self.known[i // len(parents)], parents[i % len(parents)]
        return Candidate(batch.take([i]), (*parent.edits, edit))

    def _fitted(self, parents: Sequence[Candidate], tables: Tables) -> list[Candidate]:
        found = motion(tables, self.goal.Q)
        fitted = []
        for m, edit, free in fitted_turns(tables, found, self.goal, self.names, self.bare):
            table = edit.change(tables.take([m]))
            fitted.append(Candidate(table, (*parents[m].edits, edit), (free,) if free else ()))
        return fitted

    def _new(self, candidates: Iterator[Candidate] | Sequence[Candidate]) -> list[Candidate]:
        """Those that are no table met before."""
        new = []
        for candidate in candidates:
            key = candidate.table.keys()[0] + "".join(candidate.free).encode()
            if key not in self._seen:
                self._seen.add(key)
                new.append(candidate)
        return new

    def _is_turned(self, tables: Tables) -> np.ndarray:
        return np.asarray(errors_of(motion(tables, self.goal.Q), self.goal)[1] <= self.goal.rotation)


def applied(edits: Iterable[Edit], table: Tables) -> Tables:
    """The table after the edits, in their order."""
    for edit in edits:
        table = edit.change(table)
    return table


def _unsteadiness(found: Motion, goal: Goal) -> Floats:
    """How much the rotation between tables and goal varies with the configuration, seen from base or tip (M,).

    A constant rotation at either end takes a single edit, so it is the change that says how far from right a table is.
    """
    from_base = goal.R @ np.swapaxes(found.R, -1, -2)
    from_tip = np.swapaxes(found.R, -1, -2) @ goal.R
    spread = [np.linalg.norm(E - E[:, :1], axis=(-2, -1)).mean(axis=1) for E in (from_base, from_tip)]
    unsteadiness: Floats = np.minimum(*spread)
    return unsteadiness


_BEST_PAIRS: Final = 300  # kept on the way to sets of four
_SINGULAR: Final = 1e-9  # of two directions that move the tip alike
_SNAP: Final = 1e-12  # [m] rounding that hides a round number
_SAME: Final = 1e-9


@dataclass(frozen=True, slots=True)
class _Place:
    """A length of a table: of a row (a, d), of the base (base axes) or of the tool (tip axes)."""

    where: str
    row: int
    column: int

    def value(self, tables: Tables) -> float:
        match self.where:
            case "row":
                return float(tables.numbers[0, self.row, self.column])
            case "base":
                return float(tables.base_translation[0, self.column])
        return float(tables.tool_in_tip_axes[0, self.column])

    def written(self, tables: Tables, value: float) -> Tables:
        """The tables with this length set to the value."""
        if self.where == "row":
            numbers = tables.numbers.copy()
            numbers[:, self.row, self.column] = value
            return replace(tables, numbers=numbers)
        if self.where == "base":
            base_translation = tables.base_translation.copy()
            base_translation[:, self.column] = value
            return replace(tables, base_translation=base_translation)
        t = tables.tool_in_tip_axes
        t[:, self.column] = value
        return replace(tables, tool_translation=np.einsum("mij,mj->mi", tables.tool_rotation, t))

    def text(self, names: Sequence[str]) -> str:
        if self.where == "row":
            return f"row {self.row + 1} ({names[self.row]}): {COLUMNS[self.column]}"
        return f"{self.where} {'xyz'[self.column]}"


_Direction = tuple[tuple[_Place, float], ...]
"""Lengths that change together, each with its factor: one number, or an amount that moves from one to the other."""


def length_edits(
    tables: Tables, found: Motion, goal: Goal, count: int, free: Sequence[str], names: Sequence[str]
) -> Iterator[tuple[Edit, ...]]:
    """Every set of `count` length edits that puts the tip of a table where the model's is.

    Args:
        tables: A batch of one, whose orientations agree with the goal's.
        found: Its motion.
        goal: What it should do.
        count: Number of edits.
        free: The ends ("base", "tool") whose translations are open anyway; they come first in what is yielded.
        names: Joint names.
    """
    directions = _directions(tables)
    columns, r = _columns(found, directions), (goal.p - found.p[0]).ravel()
    if free:
        loose = np.concatenate([_loose_columns(found, end) for end in free], axis=1)
        basis, _ = np.linalg.qr(loose)
        columns, r_left = columns - basis @ (basis.T @ columns), r - basis @ (basis.T @ r)
    else:
        loose, r_left = np.zeros((len(r), 0)), r
    for chosen in _sets(columns, r_left, count, goal.position):
        parts = np.concatenate([loose, _columns(found, [directions[i] for i in chosen])], axis=1)
        amounts = np.linalg.lstsq(parts, r, rcond=None)[0]
        far = np.linalg.norm((r - parts @ amounts).reshape(-1, 3), axis=1).max()
        changes = [(directions[i], float(c)) for i, c in zip(chosen, amounts[loose.shape[1] :], strict=True)]
        if far > goal.position or any(abs(c) < _SAME or _splits(way, c, tables, found) for way, c in changes):
            continue
        own = [_edit(way, c, tables, names) for way, c in changes]
        ends = [_end_edit(end, tables, amounts[3 * i : 3 * i + 3]) for i, end in enumerate(free)]
        yield (*ends, *own)


def _directions(tables: Tables) -> list[_Direction]:
    n = len(tables.slides)
    rows = [_Place("row", k, c) for k in range(n) for c in (A, D)]
    ends = [_Place(end, -1, c) for end in ("base", "tool") for c in range(3)]
    singles: list[_Direction] = [((place, 1.0),) for place in (*ends, *rows)]
    empty = [place for place in rows if abs(place.value(tables)) < _SAME]
    full = [place for place in ends[:3] if abs(place.value(tables)) > _SAME]
    folds: list[_Direction] = [
        ((base, -sign), (row, 1.0)) for base, row, sign in itertools.product(full, empty, (1.0, -1.0))
    ]
    return [*singles, *folds]


def _splits(direction: _Direction, amount: float, tables: Tables, found: Motion) -> bool:
    """Whether an amount is shared out between two places that move the tip alike, which no error looks like."""
    if len(direction) == 1:
        return False
    (base, factor), (row, _) = direction
    if abs(base.value(tables) + factor * amount) < _SAME:
        return False  # all of it went from one to the other
    along = (found.x if row.column == A else found.z)[0, :, row.row, base.column]
    return bool(np.abs(along).min() > 1.0 - _SAME)


def _columns(found: Motion, directions: Sequence[_Direction]) -> Floats:
    """How the tip moves with each direction (3·S, g)."""
    S = found.p.shape[1]

    def column(place: _Place) -> Floats:
        if place.where == "row":
            return (found.x if place.column == A else found.z)[0, :, place.row].ravel()
        if place.where == "base":
            return np.tile(np.eye(3)[place.column], S)
        return np.ascontiguousarray(found.R[0, :, :, place.column]).ravel()

    known: dict[_Place, Floats] = {}
    for place, _ in itertools.chain.from_iterable(directions):
        if place not in known:
            known[place] = column(place)
    summed = [sum(factor * known[place] for place, factor in direction) for direction in directions]
    moved: Floats = np.array(summed).T.reshape(3 * S, len(directions))
    return moved


def _loose_columns(found: Motion, end: str) -> Floats:
    if end == "base":
        return np.tile(np.eye(3), (found.p.shape[1], 1))
    axes: Floats = found.R[0].reshape(-1, 3)
    return axes


def _sets(columns: Floats, r: Floats, count: int, tolerance: float) -> Iterator[tuple[int, ...]]:
    """Sets of `count` columns, ascending, that take the residual below the tolerance."""
    if count == 0:
        if np.linalg.norm(r.reshape(-1, 3), axis=1).max() <= tolerance:
            yield ()
        return
    squares = np.einsum("rg,rg->g", columns, columns)
    # 1e-8 is where the difference of two squares has lost all its digits; what passes is measured again.
    enough = len(r) * tolerance**2 + 1e-15 * float(r @ r) + 1e-16
    if count == 1:
        b = columns.T @ r
        with np.errstate(divide="ignore", invalid="ignore"):
            left = float(r @ r) - b * b / squares
        yield from ((int(i),) for i in np.flatnonzero((squares > _SINGULAR) & (left <= enough)))
    elif count == 2:
        left = _left_by_pairs(columns, r, squares)
        yield from ((int(i), int(j)) for i, j in np.argwhere(left <= enough))
    else:
        yield from _larger_sets(columns, r, count, tolerance, squares)


def _larger_sets(
    columns: Floats, r: Floats, count: int, tolerance: float, squares: Floats
) -> Iterator[tuple[int, ...]]:
    """Sets of three by taking one column out of the problem in turn, of four and more from the best pairs."""
    if count == 3:
        firsts: list[tuple[int, ...]] = [(int(i),) for i in np.flatnonzero(squares > _SINGULAR)]
    else:
        left = _left_by_pairs(columns, r, squares)
        best = np.argsort(left, axis=None)[:_BEST_PAIRS]
        firsts = [tuple(map(int, np.unravel_index(i, left.shape))) for i in best if np.isfinite(left.flat[i])]
    seen = set()
    for first in firsts:
        basis, _ = np.linalg.qr(columns[:, list(first)])
        rest, r_left = columns - basis @ (basis.T @ columns), r - basis @ (basis.T @ r)
        if count == 3:
            rest[:, : first[0] + 1] = 0.0  # each set once
        for more in _sets(rest, r_left, count - len(first), tolerance):
            chosen = tuple(sorted((*first, *more)))
            if chosen not in seen:
                seen.add(chosen)
                yield chosen


def _left_by_pairs(columns: Floats, r: Floats, squares: Floats) -> Floats:
    """What each pair of columns leaves of |r|², above the diagonal; infinity where two columns are one direction."""
    K, b = columns.T @ columns, columns.T @ r
    product = np.multiply.outer(squares, squares)
    determinant = product - K * K
    with np.errstate(divide="ignore", invalid="ignore"):
        taken = (
            np.multiply.outer(b * b, squares) + np.multiply.outer(squares, b * b) - 2.0 * K * np.multiply.outer(b, b)
        )
        left = float(r @ r) - taken / determinant
    regular = (determinant > _SINGULAR * product) & (product > _SINGULAR**2)
    upper: Any = np.triu(np.ones_like(K, dtype=bool), 1)
    return np.where(regular & upper, left, np.inf)


def _edit(direction: _Direction, amount: float, tables: Tables, names: Sequence[str]) -> Edit:
    values = [
        (place, place.value(tables), _snapped(place.value(tables) + factor * amount)) for place, factor in direction
    ]

    def changed(t: Tables) -> Tables:
        for place, _, new in values:
            t = place.written(t, new)
        return t

    if len(values) == 2:
        (base, base_old, base_new), (row, _, row_new) = values
        text = (
            f"{row.text(names)} = {length_text(row_new)}, taken out of {base.text(names)} "
            f"({length_text(base_old)} → {length_text(base_new)})"
        )
        return Edit("folded offset", text, changed)
    ((place, old, new),) = values
    kind, reading, weight = _reading(old, new)
    if kind == "dropped offset" and place.where == "row":
        weight += 1  # a row has two lengths, and either can often stand in for one that is missing elsewhere
    text = f"{place.text(names)} {length_text(old)} → {length_text(new)}{reading}"
    return Edit(kind, text, changed, weight=weight)


def _reading(old: float, new: float) -> tuple[str, str, int]:
    """What sort of slip a wrong number looks like: kind, words, weight."""
    if abs(old) < _SAME:
        return "dropped offset", " (dropped)", 1
    if abs(new) < _SAME:
        return "extra offset", " (not in the model)", 1
    if abs(new + old) < _SAME:
        return "length sign", " (sign)", 0
    for factor in (1e3, 1e-3):
        if abs(new - factor * old) < _SAME * factor:
            return "length unit", f" (unit, × {factor:g})", 0
    return "number", "", 1 if old * new > 0.0 else 2


def _end_edit(end: str, tables: Tables, amounts: Floats) -> Edit:
    """The whole transform of an end that had none."""
    R = getattr(tables, f"{end}_rotation")[0]
    old = (tables.base_translation if end == "base" else tables.tool_in_tip_axes)[0]
    new = np.array([_snapped(value) for value in old + amounts])
    p = new if end == "base" else R @ new

    def changed(t: Tables) -> Tables:
        ends = {
            f"{end}_rotation": np.broadcast_to(R, t.base_rotation.shape).copy(),
            f"{end}_translation": np.broadcast_to(p, t.base_translation.shape).copy(),
        }
        return replace(t, **ends)

    return Edit(f"missing {end}", f"{end} {transform_text(R, p)} (missing)", changed, weight=2)


def _snapped(value: float) -> float:
    """The length, or the short decimal that it rounds to."""
    nearest = round(value, 9)
    return nearest + 0.0 if abs(value - nearest) < _SNAP else float(value)
