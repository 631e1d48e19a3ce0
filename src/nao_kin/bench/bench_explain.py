"""`nao-kin bench explain`: tables with planted errors, and how many of them `compare()` explains."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.bench.planted import Planted
    from nao_kin.chain import Chain
    from nao_kin.crosscheck import Alternative, Explanation
    from nao_kin.dh.dh_chain import DHChain

__all__ = ["ExplanationVerdict", "explain", "verdict_of"]

_FRESH = 32  # configurations at which every reported set is measured again
_SAME = 1e-7  # [m, rad] of numbers of two tables


@dataclass(frozen=True, slots=True)
class ExplanationVerdict:
    """What an explanation of a planted error is worth.

    Attributes:
        kinds: What was planted.
        explained: Whether a set was reported that agrees exactly.
        refuted: Number of reported sets that the poses refute.
        named: Whether the planted errors are among the sets reported; only asked if as few edits were reported.
        fewer: Whether fewer edits explain as much.
        sets: Number of sets reported.
        seconds: How long it took.
    """

    kinds: tuple[str, ...]
    explained: bool
    refuted: int
    named: bool
    fewer: bool
    sets: int
    seconds: float


def explain(
    singles: Annotated[int, typer.Option(min=1, help="Tables with one error.")] = 500,
    doubles: Annotated[int, typer.Option(min=0, help="Tables with two errors.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the tables.")] = 5,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Tables with planted errors: how many are explained, whether the planted error is named, and how long it takes."""
    from nao_kin.bench.planted import planted_tables
    from nao_kin.output import progress

    machine, (chains, notes) = Machine(), _chains()
    sheets, bounds = list[Sheet](), list[Promise]()
    for errors, count, least in ((1, singles, 95.0), (2, doubles, 80.0)):
        if count == 0:
            continue
        tables = planted_tables(chains, count, errors, seed + errors)
        verdicts = [verdict_of(planted) for planted in progress(tables, f"{errors} errors", count)]
        word = "one error" if errors == 1 else "two errors"
        sheets.append(_sheet(word, verdicts))
        asked = [v for v in verdicts if not v.fewer]
        bounds += [
            Promise(f"{word}: explained %", 100.0 * sum(v.explained for v in verdicts) / count, least),
            Promise(
                f"{word}: sets that the poses refute", float(sum(v.refuted for v in verdicts)), 0.0, at_least=False
            ),
            Promise(f"{word}: planted edits named %", 100.0 * sum(v.named for v in asked) / max(len(asked), 1), least),
        ]
        if errors == 1:
            bounds.append(Promise("one error: slowest [s]", max(v.seconds for v in verdicts), 0.5, at_least=False))
    notes.append("Named is asked of tables that no smaller set of edits explains.")
    conclude(machine, sheets, bounds, notes, format, goals)


def verdict_of(planted: Planted) -> ExplanationVerdict:
    """Explains a planted table and judges what is said by the poses of both chains."""
    import nao_kin as nk

    found = nk.compare(planted.wrong, planted.chain, samples=20)
    start = time.perf_counter()
    explanation = found.explanation
    seconds = time.perf_counter() - start
    sets = explanation.alternatives
    return ExplanationVerdict(
        kinds=planted.kinds,
        explained=bool(sets) and explanation.exact,
        refuted=_refuted(explanation, planted.chain),
        named=any(_is_planted(one, planted) for one in sets),
        fewer=bool(sets) and len(sets[0].edits) < len(planted.kinds),
        sets=len(sets),
        seconds=seconds,
    )


def _refuted(explanation: Explanation, chain: Chain) -> int:
    """How many of the reported tables do not agree with the model at new configurations."""
    import numpy as np

    from nao_kin.se3 import position_distance, rotation_distance

    Q = np.random.default_rng(99).uniform(-math.pi, math.pi, (_FRESH, len(chain.joints)))
    poses = [chain.pose(q) for q in Q]
    refuted = 0
    for one in explanation.alternatives:
        pairs = [(one.table.pose(q), T) for q, T in zip(Q, poses, strict=True)]
        far = max(position_distance(*pair) for pair in pairs) > explanation.position_tolerance
        refuted += far or max(rotation_distance(*pair) for pair in pairs) > explanation.rotation_tolerance
    return refuted


def _is_planted(one: Alternative, planted: Planted) -> bool:
    """Whether a set leads back to the table without errors; a mirror leads to another table of the same arm."""
    if "mirrored side" in planted.kinds:
        return "mirrored side" in one.kinds
    return _same_table(one.table, planted.right)


def _same_table(a: DHChain, b: DHChain) -> bool:
    import numpy as np

    def numbers(table: DHChain) -> Any:
        rows = [
            (r.a, r.d, math.cos(r.alpha), math.sin(r.alpha), math.cos(r.theta), math.sin(r.theta), r.sign)
            for r in table.rows
        ]
        return np.concatenate([np.ravel(rows), table.base.homogeneous.ravel(), table.tool.homogeneous.ravel()])

    return a.convention == b.convention and bool(np.allclose(numbers(a), numbers(b), rtol=0.0, atol=_SAME))


def _chains() -> tuple[list[Chain], list[str]]:
    from nao_kin.bench.planted import PLANTED_CHAINS
    from nao_kin.errors import MissingExtraError
    from nao_kin.robot.robot import load

    chains, notes = list[Any](), list[str]()
    for robot, chain in PLANTED_CHAINS:
        try:
            chains.append(load(robot).chain(chain))
        except MissingExtraError as error:
            notes.append(f"Left out: {error}")
    return chains, notes


def _sheet(word: str, verdicts: Sequence[ExplanationVerdict]) -> Sheet:
    import numpy as np

    rows = []
    for kind in sorted({kind for verdict in verdicts for kind in verdict.kinds}):
        own = [v for v in verdicts if kind in v.kinds]
        rows.append(
            {
                "kind": kind,
                "tables": len(own),
                "explained": sum(v.explained for v in own),
                "named": sum(v.named for v in own),
                "fewer": sum(v.fewer for v in own),
                "sets": float(np.median([v.sets for v in own])),
                "most": max(v.sets for v in own),
                "slowest": max(v.seconds for v in own),
            }
        )
    headings = (
        Heading("kind", "planted"),
        Heading("tables", "tables", "d"),
        Heading("explained", "explained", "d"),
        Heading("named", "named", "d"),
        Heading("fewer", "by fewer", "d"),
        Heading("sets", "sets", ".0f"),
        Heading("slowest", "slowest", ".3f"),
    )
    return Sheet(word.replace(" ", "_"), f"tables with {word} [s]", headings, rows)
