"""The search for the fewest edits that make a table move as a model.

Orientations depend on angles, signs and convention alone, and once they agree, positions are linear in the lengths. So
a set of N edits is d edits that make the orientations agree and N − d lengths, for every d: levels of turned tables
(`_Level`) are built once, all sets of one and two edits in full and larger ones from the most promising tables on, and
the lengths are asked of each table whose orientations agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.crosscheck.edits import Edit, known_edits
from nao_kin.crosscheck.lengths import length_edits
from nao_kin.crosscheck.tables import Goal, Motion, Tables, errors_of, motion
from nao_kin.crosscheck.turns import fitted_pairs, fitted_turns

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from nao_kin.arrays import Floats

__all__ = ["MOST_EDITS", "Candidate", "Search", "applied"]

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
