"""`nao-kin bench explain`: tables with planted errors, and how many of them `compare()` explains."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

import numpy as np
import pinocchio as pin
import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat
from nao_kin.se3 import rotation_x, rotation_y, rotation_z, translation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from nao_kin.chain import Chain
    from nao_kin.crosscheck import Alternative, Explanation
    from nao_kin.dh.dh_chain import DHChain

__all__ = ["KINDS", "PLANTED_CHAINS", "ExplanationVerdict", "Planted", "explain", "planted_tables", "verdict_of"]

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
    from nao_kin.bench.bench_explain import planted_tables
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
    from nao_kin.bench.bench_explain import PLANTED_CHAINS
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


PLANTED_CHAINS: Final = (
    ("ur5", "arm"),
    ("z1", "arm"),
    ("panda", "arm"),
    ("jaco2", "arm"),
    ("nao", "left_arm"),
    ("nao", "right_arm"),
    ("nao", "left_leg"),
    ("nao", "right_leg"),
)
_LENGTHS, _ANGLES = ("a", "d"), ("alpha", "theta")
_EFFECT = 1e-6  # [m, rad] an error that shows less than this has no effect
_TRIES = 200

Planter: TypeAlias = "Callable[[DHChain, np.random.Generator], DHChain | None]"


@dataclass(frozen=True, eq=False)
class Planted:
    """A table with known errors.

    Attributes:
        chain: The model.
        right: The table without errors.
        wrong: The table with them.
        kinds: What was planted.
    """

    chain: Chain
    right: DHChain
    wrong: DHChain
    kinds: tuple[str, ...]


def planted_tables(chains: Sequence[Chain], count: int, errors: int, seed: int) -> Iterator[Planted]:
    """Tables with so many errors each, the kinds, chains and conventions in turn, the places at random.

    Errors that do not change the poses are not drawn.
    """
    from nao_kin.dh.from_chain import to_dh

    rng = np.random.default_rng(seed)
    right = [(chain, to_dh(chain, convention)) for chain in chains for convention in ("standard", "modified")]
    names = list(KINDS)
    made = turn = 0
    while made < count:
        first = names[turn % len(names)]
        chain, table = right[int(rng.integers(len(right)))]
        turn += 1
        others = rng.choice([name for name in names if name != first], size=errors - 1, replace=False)
        kinds = (first, *map(str, others))
        for end in ("base", "tool"):
            if f"extra {end}" in kinds:  # then the right arm, a table itself, has none
                chain = table = replace(table, **{end: pin.SE3.Identity()})
        wrong = _with_errors(table, kinds, rng)
        if wrong is not None:
            made += 1
            yield Planted(chain, table, wrong, kinds)


def _with_errors(table: DHChain, kinds: Sequence[str], rng: np.random.Generator) -> DHChain | None:
    """The table with one error of each kind; None if a kind has no place in it."""
    wrong = table
    for kind in kinds:
        for _ in range(_TRIES):
            tried = KINDS[kind](wrong, rng)
            if tried is not None and _differ(tried, wrong) and _differ(tried, table):
                wrong = tried
                break
        else:
            return None
    return replace(wrong, name="planted")


def _differ(a: DHChain, b: DHChain) -> bool:
    Q = np.random.default_rng(0).uniform(-2.0, 2.0, (4, len(a.rows)))
    return max(float(np.abs(a.pose(q).homogeneous - b.pose(q).homogeneous).max()) for q in Q) > _EFFECT


def _changed(table: DHChain, k: int, **fields: Any) -> DHChain:
    rows = list(table.rows)
    rows[k] = replace(rows[k], **fields)
    return replace(table, rows=tuple(rows))


def _row(table: DHChain, rng: np.random.Generator) -> int:
    return int(rng.integers(len(table.rows)))


def _place(table: DHChain, rng: np.random.Generator, columns: Sequence[str]) -> tuple[int, str, float] | None:
    """A number of the table that is not 0."""
    places = [
        (k, c, getattr(row, c)) for k, row in enumerate(table.rows) for c in columns if abs(getattr(row, c)) > 1e-9
    ]
    return places[int(rng.integers(len(places)))] if places else None


def _convention(table: DHChain, _: np.random.Generator) -> DHChain:
    return table.read_as("standard" if table.convention == "modified" else "modified")


def _number_sign(columns: Sequence[str]) -> Planter:
    def plant(table: DHChain, rng: np.random.Generator) -> DHChain | None:
        place = _place(table, rng, columns)
        return None if place is None else _changed(table, place[0], **{place[1]: -place[2]})

    return plant


def _joint_sign(table: DHChain, rng: np.random.Generator) -> DHChain:
    k = _row(table, rng)
    return _changed(table, k, sign=-table.rows[k].sign)


def _offset(table: DHChain, rng: np.random.Generator) -> DHChain:
    k, turn = _row(table, rng), float(rng.choice([math.pi / 2, -math.pi / 2, math.pi]))
    return _changed(table, k, theta=table.rows[k].theta + turn)


def _a_and_d(table: DHChain, rng: np.random.Generator) -> DHChain:
    k = _row(table, rng)
    return _changed(table, k, a=table.rows[k].d, d=table.rows[k].a)


def _wrong_row(table: DHChain, rng: np.random.Generator) -> DHChain:
    k, column = int(rng.integers(len(table.rows) - 1)), str(rng.choice(["a", "alpha", "d", "theta"]))
    here, there = getattr(table.rows[k], column), getattr(table.rows[k + 1], column)
    return _changed(_changed(table, k, **{column: there}), k + 1, **{column: here})


def _rows(table: DHChain, rng: np.random.Generator) -> DHChain:
    i, j = map(int, rng.choice(len(table.rows), size=2, replace=False))
    names = [row.name for row in table.rows]
    rows = list(table.rows)
    rows[i], rows[j] = replace(rows[j], name=names[i]), replace(rows[i], name=names[j])
    return replace(table, rows=tuple(rows))


def _all_lengths(table: DHChain, _: np.random.Generator) -> DHChain:
    rows = tuple(replace(row, a=1e3 * row.a, d=1e3 * row.d) for row in table.rows)
    ends = [pin.SE3(T.rotation, 1e3 * T.translation) for T in (table.base, table.tool)]
    return replace(table, rows=rows, base=ends[0], tool=ends[1])


def _one_length(table: DHChain, rng: np.random.Generator) -> DHChain | None:
    place = _place(table, rng, _LENGTHS)
    return None if place is None else _changed(table, place[0], **{place[1]: 1e3 * place[2]})


def _all_angles(table: DHChain, _: np.random.Generator) -> DHChain:
    rows = (replace(row, alpha=math.degrees(row.alpha), theta=math.degrees(row.theta)) for row in table.rows)
    return replace(table, rows=tuple(rows))


def _one_angle(table: DHChain, rng: np.random.Generator) -> DHChain | None:
    place = _place(table, rng, _ANGLES)
    return None if place is None else _changed(table, place[0], **{place[1]: math.degrees(place[2])})


def _mirrored(table: DHChain, _: np.random.Generator) -> DHChain:
    """The arm of the other side, y turned round; joints along y turn as before, those across it keep their direction.

    F = diag(1, 1, −1) turns d and α of a row round: F A(a, α, d, θ) F = A(a, −α, −d, θ).
    """
    M, F = np.diag([1.0, -1.0, 1.0, 1.0]), np.diag([1.0, 1.0, -1.0, 1.0])
    axes = table.jacobian(np.zeros(len(table.rows)))[3:].T  # the tables drawn from have turning joints only
    mirrored = -(axes @ M[:3, :3])
    signs = np.where(np.einsum("ki,ki->k", mirrored, axes) < -1e-9, -1, 1)
    rows = tuple(
        replace(row, alpha=-row.alpha, d=-row.d, sign=row.sign * int(sign))
        for row, sign in zip(table.rows, signs, strict=True)
    )
    base, tool = M @ table.base.homogeneous @ F, F @ table.tool.homogeneous @ M
    return replace(table, rows=rows, base=pin.SE3(base), tool=pin.SE3(tool))


def _without(end: str) -> Planter:
    def plant(table: DHChain, _: np.random.Generator) -> DHChain:
        identity = pin.SE3.Identity()
        return replace(table, base=identity) if end == "base" else replace(table, tool=identity)

    return plant


def _unturned_tool(table: DHChain, _: np.random.Generator) -> DHChain:
    return replace(table, tool=pin.SE3(np.eye(3), table.tool.translation))


def _extra(end: str) -> Planter:
    def plant(table: DHChain, rng: np.random.Generator) -> DHChain | None:
        """A transform where there is none; one that stood there before is another error."""
        T = getattr(table, end)
        if not T.isIdentity(1e-9):
            return None
        shift = translation(*np.round(rng.uniform(-0.2, 0.2, 3), 3).tolist())
        turn = _quarter(rng) if rng.uniform() < 0.5 else pin.SE3.Identity()
        return replace(table, base=shift * turn) if end == "base" else replace(table, tool=shift * turn)

    return plant


def _extra_turn(table: DHChain, rng: np.random.Generator) -> DHChain:
    return replace(table, tool=table.tool * _quarter(rng))


def _quarter(rng: np.random.Generator) -> pin.SE3:
    make = (rotation_x, rotation_y, rotation_z)[int(rng.integers(3))]
    return make(float(rng.choice([math.pi / 2, -math.pi / 2, math.pi])))


def _typo(table: DHChain, rng: np.random.Generator) -> DHChain | None:
    """One decimal of a length in millimetres or of an odd angle mistyped, or a length rounded to centimetres."""
    place = _place(table, rng, ("a", "d", "theta"))
    if place is None or (place[1] == "theta" and abs(math.remainder(place[2], math.pi / 12)) < 1e-9):
        return None
    k, column, value = place
    if column in _LENGTHS and rng.uniform() < 0.3:
        return _changed(table, k, **{column: round(value, 2)})
    digit = 10.0 ** -int(rng.integers(2, 6))
    return _changed(table, k, **{column: round(value + digit * int(rng.integers(1, 9)), 9)})


def _folded(table: DHChain, rng: np.random.Generator) -> DHChain | None:
    """A length added to the base's translation instead."""
    place = _place(table, rng, _LENGTHS)
    if place is None:
        return None
    k, column, value = place
    shift = np.zeros(3)
    shift[int(rng.integers(3))] = value * float(rng.choice([1.0, -1.0]))
    base = pin.SE3(table.base.rotation, table.base.translation + shift)
    return replace(_changed(table, k, **{column: 0.0}), base=base)


def _dropped(table: DHChain, rng: np.random.Generator) -> DHChain | None:
    place = _place(table, rng, ("a", "d", "theta"))
    return None if place is None else _changed(table, place[0], **{place[1]: 0.0})


KINDS: Final[dict[str, Planter]] = {
    "convention": _convention,
    "sign of alpha": _number_sign(("alpha",)),
    "sign of theta's offset": _number_sign(("theta",)),
    "sign of the joint": _joint_sign,
    "sign of a length": _number_sign(_LENGTHS),
    "offset by a quarter or half turn": _offset,
    "a and d exchanged": _a_and_d,
    "value in the wrong row": _wrong_row,
    "rows exchanged": _rows,
    "millimetres, all": _all_lengths,
    "millimetres, one": _one_length,
    "degrees, all": _all_angles,
    "degrees, one": _one_angle,
    "mirrored side": _mirrored,
    "missing base": _without("base"),
    "missing tool": _without("tool"),
    "missing tool rotation": _unturned_tool,
    "extra base": _extra("base"),
    "extra tool": _extra("tool"),
    "extra tool rotation": _extra_turn,
    "mistyped or rounded number": _typo,
    "offset folded into the base": _folded,
    "dropped offset": _dropped,
}
"""What is planted, by the words of the report; a planter gives None where its error has no place in the table."""
