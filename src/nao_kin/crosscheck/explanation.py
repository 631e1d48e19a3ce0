"""Why a table and a model disagree: every equally simple set of usual errors that explains it, confirmed by FK."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.chain import random_configurations
from nao_kin.crosscheck.edits import COLUMNS
from nao_kin.crosscheck.search import MOST_EDITS, Candidate, Search, applied
from nao_kin.crosscheck.tables import ALPHA, THETA, A, D, Goal, Motion, Tables, errors_of, goal_of, motion
from nao_kin.crosscheck.wording import length_text, size_text
from nao_kin.se3 import position_distance, rotation_distance
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.tolerances import Tolerances

__all__ = [
    "Alternative",
    "Explanation",
    "Resolution",
    "SmallestChanges",
    "Step",
    "explain",
    "printed_resolution",
    "smallest_changes",
]

_SEARCHED_ON: Final = 6  # configurations: 36 numbers, more than any table has unknowns
_CONFIRMED_ON: Final = 24
_MEASURED_ON: Final = 200
_FEW: Final = 2
_MARGIN: Final = 0.8  # of a tolerance that is not rounding: other configurations may be a little worse than those seen
_SETS_SHOWN: Final = 5
_CHANGES_SHOWN: Final = 12


@dataclass(frozen=True, slots=True)
class Step:
    """One edit, and what it alone is worth.

    Attributes:
        kind: What sort of error it takes back.
        text: What to do.
        position: How far off the tip is, at most, if all of the other edits are made and this one is not [m].
        rotation: The same for its orientation [rad].
    """

    kind: str
    text: str
    position: float
    rotation: float

    def __str__(self) -> str:
        return f"{self.text} ({size_text(self.position, self.rotation)})"


@dataclass(frozen=True, eq=False, slots=True)
class Alternative:
    """One set of edits after which the table agrees with the model.

    Attributes:
        edits: What to do, in order.
        kinds: What sort of error each edit takes back.
        table: The table after them.
        position_error: What is left, at most, at configurations the search has not seen [m].
        rotation_error: The same [rad].
    """

    edits: tuple[str, ...]
    kinds: tuple[str, ...]
    table: DHChain
    position_error: float
    rotation_error: float

    def __str__(self) -> str:
        return "; ".join(self.edits)


@dataclass(frozen=True, eq=False, slots=True)
class Explanation:
    """What was found out about a disagreement. Sets of edits are possibilities, never the cause.

    Attributes:
        table: The table explained: the first chain, or its `to_dh` where it is no table.
        steps: The edits of the first alternative, with what each is worth.
        alternatives: Every set of equally few edits that was found and that both chains' own poses confirm, the least
            far-fetched first; empty if nothing explains the disagreement.
        exact: Whether the alternatives agree to rounding; else they agree as well as the printed digits can say, maybe
            with no edit at all.
        position_tolerance: What "agree" means for them [m].
        rotation_tolerance: The same [rad].
        smallest: The smallest changes of all numbers, where there is no alternative.
        note: Why there is nothing to report, where that is so.
    """

    table: DHChain | None
    steps: tuple[Step, ...]
    alternatives: tuple[Alternative, ...]
    exact: bool
    position_tolerance: float
    rotation_tolerance: float
    smallest: SmallestChanges | None
    note: str = ""

    @classmethod
    def without_search(cls, table: DHChain | None, tolerances: Tolerances, note: str) -> Explanation:
        """What there is to say where nothing was searched."""
        position, rotation = tolerances.agreement_position, tolerances.agreement_rotation
        return cls(table, (), (), True, position, rotation, None, note)

    @property
    def corrected(self) -> DHChain | None:
        """The first alternative's table."""
        return self.alternatives[0].table if self.alternatives else None

    def __str__(self) -> str:
        if self.note:
            return self.note
        if not self.alternatives:
            return self._unexplained()
        first = self.alternatives[0]
        left = size_text(first.position_error, first.rotation_error)
        digits = size_text(self.position_tolerance, self.rotation_tolerance)
        how = "" if self.exact else f", within what the digits printed can say ({digits})"
        if not first.edits:
            return f"Agrees as it stands to {left}{how}."
        lines = [f"Agrees to {left}{how}, after:"]
        lines += [f"  {step}" for step in self.steps]
        others = self.alternatives[1:]
        if others:
            any_of = "the one other set" if len(others) == 1 else f"any of {len(others)} other sets"
            lines.append(f"or after {any_of} of {len(first.edits)}:")
            lines += _listed([str(other) for other in others], _SETS_SHOWN)
        return "\n".join(lines)

    def step_table(self) -> Table:
        """The steps as a table."""
        columns = (Column("edit"), Column("worth"))
        rows = tuple((step.text, size_text(step.position, step.rotation)) for step in self.steps)
        return Table(columns, rows)

    def _unexplained(self) -> str:
        lines = [
            "No set of usual errors was found that explains it: not one, no two of the known slips, and none of up to "
            f"{MOST_EDITS} where the search looked."
        ]
        if self.smallest is not None:
            left = size_text(self.smallest.position_error, self.smallest.rotation_error)
            lines.append(f"The smallest changes that a least-squares fit found leave {left}:")
            lines += _listed(self.smallest.changes, _CHANGES_SHOWN)
        return "\n".join(lines)


def explain(table: DHChain, b: Chain, tolerances: Tolerances) -> Explanation:
    """Searches the usual errors that would account for what a table and a chain disagree in.

    All single edits and pairs are tried, then sets of up to six from the most promising tables on. Fewer edits win; at
    equally many all sets are reported. If no exact set of one or two is found, the same is asked at the precision of
    the printed digits before more edits are tried.

    Args:
        table: The table to correct.
        b: The chain that is taken to be right; as many joints.
        tolerances: What exact agreement means.
    """
    printed, names = Tables.of(table), table.joint_names
    position, rotation = tolerances.agreement_position, tolerances.agreement_rotation
    exact = goal_of(b, _SEARCHED_ON, np.random.default_rng(7), position, rotation)
    poses = [(q, b.pose(q)) for q in np.random.default_rng(8).uniform(-2.0, 2.0, (_CONFIRMED_ON, len(b.joints)))]
    for search, count in _rounds(printed, exact, names):
        goal, margin = search.goal, 1.0 if search.goal is exact else _MARGIN
        found = sorted(search.explanations(count), key=lambda candidate: candidate.rank)
        found = [_as_read(candidate, printed) for candidate in found]
        confirmed = _confirmed(found, table, poses, margin * goal.position, margin * goal.rotation)
        if confirmed:
            steps, alternatives = _steps(printed, confirmed[0][0], b), tuple(one for _, one in confirmed)
            return Explanation(table, steps, alternatives, goal is exact, goal.position, goal.rotation, None)
    many = goal_of(b, 4 * _SEARCHED_ON, np.random.default_rng(9), 0.0, 0.0)
    return Explanation(table, (), (), True, position, rotation, smallest_changes(printed, many, names))


def _rounds(printed: Tables, exact: Goal, names: Sequence[str]) -> Iterator[tuple[Search, int]]:
    """What is asked, in order: few edits exactly, few edits within the printed digits, then more of both."""
    resolution = printed_resolution(printed)
    coarse = replace(
        exact,
        position=max(resolution.position, exact.position),
        rotation=max(resolution.rotation, exact.rotation),
    )
    goals = [exact]
    if coarse.position > exact.position or coarse.rotation > exact.rotation:
        goals.append(coarse)
    searches = [Search(printed, goal, names) for goal in goals]
    for counts in (range(_FEW + 1), range(_FEW + 1, MOST_EDITS + 1)):
        yield from ((search, count) for search in searches for count in counts)


def _listed(texts: Sequence[str], shown: int) -> list[str]:
    more = len(texts) - shown
    return [*(f"  {text}" for text in texts[:shown]), *([f"  … and {more} more"] if more > 0 else [])]


def _as_read(candidate: Candidate, printed: Tables) -> Candidate:
    """The candidate with its convention said first, where the order makes no difference."""
    edits = tuple(sorted(candidate.edits, key=lambda edit: edit.kind != "convention"))
    same = applied(edits, printed).keys() == candidate.table.keys()
    return replace(candidate, edits=edits) if same else candidate


def _confirmed(
    found: Sequence[Candidate],
    like: DHChain,
    poses: Sequence[tuple[Floats, pin.SE3]],
    position_limit: float,
    rotation_limit: float,
) -> list[tuple[Candidate, Alternative]]:
    """Those whose poses, by the table's own matrix product, are the model's at configurations not searched on."""
    confirmed, seen = [], set()
    for candidate in found:
        key = candidate.table.keys()[0]
        if key in seen:
            continue
        seen.add(key)
        table = candidate.table.chain(0, like)
        pairs = [(table.pose(q), wanted) for q, wanted in poses]
        position = max(position_distance(*pair) for pair in pairs)
        rotation = max(rotation_distance(*pair) for pair in pairs)
        if position <= position_limit and rotation <= rotation_limit:
            edits, kinds = tuple(e.text for e in candidate.edits), tuple(e.kind for e in candidate.edits)
            confirmed.append((candidate, Alternative(edits, kinds, table, position, rotation)))
    return confirmed


def _steps(printed: Tables, candidate: Candidate, b: Chain) -> tuple[Step, ...]:
    """Each edit with the error that comes back without it."""
    Q = random_configurations(b, _MEASURED_ON, np.random.default_rng(10))
    poses = np.array([b.pose(q).homogeneous for q in Q])
    goal = Goal(Q, poses[:, :3, :3], poses[:, :3, 3], 0.0, 0.0)
    steps = []
    for left_out in candidate.edits:
        table = applied([edit for edit in candidate.edits if edit is not left_out], printed)
        position, chord = errors_of(motion(table, goal.Q), goal)
        rotation = 2.0 * np.arcsin(min(1.0, float(chord[0]) / 2.0))
        steps.append(Step(left_out.kind, left_out.text, float(position[0]), float(rotation)))
    return tuple(steps)


_FINEST_DIGIT = 6  # decimals of a metre, radian or degree; what needs more was computed, not printed
_EXACT_ANGLES = math.pi / 12
_COARSEST = 0.01  # [m, rad] nobody prints less: such round numbers are round, or in another unit than is said


@dataclass(frozen=True, slots=True)
class Resolution:
    """What the digits of a table can say.

    Attributes:
        length: Unit of the last digit of its lengths [m]; 0 if they have all digits.
        angle: The same for its angles [rad].
        position: How far the tip can be off by rounding alone [m]: half a unit of every number, at full reach.
        rotation: The same for its orientation [rad].
    """

    length: float
    angle: float
    position: float
    rotation: float


def printed_resolution(table: Tables) -> Resolution:
    """The resolution of a table, read off its numbers.

    All lengths are taken to be printed to the decimal of the one with the most. Multiples of 15° are exact; other
    angles were printed in degrees or radians, whichever they have few decimals in. More than six decimals are no print,
    nor are fewer than two: such numbers count as exact.

    Args:
        table: A batch of one.
    """
    numbers = table.numbers[0]
    lengths = [
        x
        for x in (*numbers[:, [A, D]].ravel(), *table.base_translation[0], *table.tool_in_tip_axes[0])
        if abs(x) > 1e-12
    ]
    angles = [x for x in numbers[:, [ALPHA, THETA]].ravel() if not _is_multiple(x, _EXACT_ANGLES)]
    length = _last_digit(lengths)
    angle = max(math.radians(_last_digit(math.degrees(x) for x in angles)), _last_digit(angles))
    length, angle = (unit if unit <= _COARSEST else 0.0 for unit in (length, angle))
    rotation = 0.5 * angle * len(angles)
    position = 0.5 * length * len(lengths) + rotation * float(np.abs(lengths).sum() if lengths else 0.0)
    return Resolution(length, angle, position, rotation)


def _last_digit(values: Iterable[float]) -> float:
    """The largest power of ten, at most 1, of which all values are multiples; 0 if none of the first decimals is."""
    values = list(values)
    for decimals in range(_FINEST_DIGIT + 1):
        unit = 10.0**-decimals
        if values and all(_is_multiple(x, unit) for x in values):
            return unit
    return 0.0


def _is_multiple(value: float, unit: float) -> bool:
    return abs(value / unit - round(value / unit)) * unit < 1e-11


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
