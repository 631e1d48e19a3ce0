"""Every solution of many targets: the closed form's kernel on all cores, every solution measured again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NoReturn

import numpy as np

from nao_kin.analytic.certifying import ABSENT, SOLVED, Certificate, Written, certify, violations
from nao_kin.analytic.form import GOALS, ClosedForm
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.solutions import slack_of
from nao_kin.errors import InvalidInputError
from nao_kin.ik.auditing import Claimed, audited
from nao_kin.ik.auditing import audit as audit_rows
from nao_kin.ik.batch import Wanted
from nao_kin.ik.target import KINDS, Target
from nao_kin.se3 import ROTATION_TOLERANCE
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["BatchSolutions", "certified", "solve_all_batch"]

_BLOCK: Final = 1024  # targets at a time: what lies between the kernels stays in the processor's cache


@dataclass(eq=False, slots=True)
class BatchSolutions:
    """Every solution of many targets, each measured again; rows are in the order of the targets.

    A target has up to B solutions, in the order of the kernel; places that no solution fills hold NaN.

    Attributes:
        chain: The chain.
        form: The closed form.
        q: Joints (N, B, n) [rad or m].
        codes: Status of each (N, B), numbers of `Status` members in their order; −1 where there is none.
        branches: Numbers of branch and singularity (N, B, 2), which `branch` puts in words.
        position_error: Distances of the tips to the targets [m] (N, B), measured at `q`; NaN where free.
        rotation_error: Angles to the wanted orientations [rad] (N, B), measured at `q`; NaN where free.
    """

    chain: Chain
    form: ClosedForm
    q: Floats
    codes: NDArray[np.int8]
    branches: NDArray[np.int16]
    position_error: Floats
    rotation_error: Floats

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether a place holds a solution, in or out of limits (N, B)."""
        return np.asarray(self.codes != ABSENT)

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Whether a place holds a solution within tolerance and limits (N, B)."""
        return np.asarray(self.codes == SOLVED)

    def branch(self, row: int, place: int) -> str:
        """The branch of the solution at a row and a place in it, in words; empty where there is none."""
        number, singularity = self.branches[row, place].tolist()
        return self.form.label(number, singularity) if self.codes[row, place] != ABSENT else ""

    def __len__(self) -> int:
        return len(self.q)

    def __bool__(self) -> NoReturn:
        raise TypeError("BatchSolutions is not a truth value: ask for result.solved.any(axis=1).")

    def __repr__(self) -> str:
        within = int(self.solved.any(axis=1).sum())
        return f"<BatchSolutions of {len(self)}: {int(self.found.sum())} solutions, {within} targets within limits>"

    def _repr_html_(self) -> str:
        found, within = self.found.sum(axis=1), np.asarray(self.solved.any(axis=1))
        rows = tuple(
            (str(count), str(int((found == count).sum())), str(int((within & (found == count)).sum())))
            for count in np.unique(found).tolist()
        )
        headings = ("solutions of a target", "targets", "of these with one within limits")
        title = f"{len(self)} targets of {self.chain.name}: {int(found.sum())} solutions"
        return Table(tuple(Column(heading, number=True) for heading in headings), rows, title=title)._repr_html_()


def solve_all_batch(
    chain: Chain,
    targets: ArrayLike | Sequence[Target],
    *,
    locked: Mapping[str, ArrayLike] | None = None,
    tolerances: Tolerances = TOLERANCES,
    seed: int = 0,
    audit: Literal["sample", "all"] = "sample",
) -> BatchSolutions:
    """Every solution of many targets by closed form; a row has the solutions that `nao_kin.solve_all` gives.

    Every solution is measured again by a second compiled forward kinematics, and a seeded sample (``audit="all"``:
    every one) by `chain.pose` too.

    Args:
        chain: The chain.
        targets: Poses (N, 4, 4), positions (N, 3) [m], or `Target` objects of one kind with the same weights.
        locked: Values of joints by name [rad or m]; an array (N,) gives each target its own, of a joint that the target
            leaves free.
        tolerances: When a target counts as reached.
        seed: For the sample.
        audit: ``"sample"`` or ``"all"``.

    Returns:
        A row of solutions a target, those within limits first.

    Raises:
        InvalidInputError: Wrong shapes, not finite, not rigid (the row is named), mixed kinds, or no form fits.
        UnknownNameError: A locked joint is not one of the chain; carries near matches.
        AuditError: Two forward kinematics disagree: a defect of this package or of the machine.
    """
    wanted = Wanted.of(targets)
    if audit not in ("sample", "all"):
        raise InvalidInputError("audit", "'sample' or 'all'", repr(audit))
    found = matched(chain, wanted.first, locked)
    N = len(wanted.given)
    if len(found.given) not in (1, N):
        raise InvalidInputError(
            "locked", f"one value a joint, or one for each of the {N} targets", f"{len(found.given)}"
        )
    certificate = certified(chain, found, wanted, slice(0, N), tolerances, slack_of(tolerances))
    result = BatchSolutions(chain, found.form, *certificate)
    _audit(result, wanted, tolerances, seed, everything=audit == "all")
    return result


def certified(
    chain: Chain, found: Matched, wanted: Wanted, rows: slice, tolerances: Tolerances, slack: float
) -> Certificate:
    """What a closed form finds for some rows of the targets, measured; a slack [m] for branches at the border.

    Raises:
        InvalidInputError: A row that is no target.
    """
    certificate = Certificate.blank(rows.stop - rows.start, found.request.branches, len(chain.joints))
    counted, kind = wanted.first.counts, KINDS[wanted.first.kind]
    for start in range(rows.start, rows.stop, _BLOCK):
        block = slice(start, min(start + _BLOCK, rows.stop))
        goals = wanted.goals(block)
        _check(goals, wanted.first, start)
        written = _written(found, goals, block, slack)
        part = certificate.part(slice(start - rows.start, block.stop - rows.start))
        certify(chain.joint_path, found.ranges, kind, counted, goals, written, tolerances, part)
    return certificate


def _written(found: Matched, goals: Floats, block: slice, slack: float) -> Written:
    """What the closed form writes for a block of goals."""
    form, N = found.form, len(goals)
    rows, counts = np.empty((N, found.request.branches, form.joints + 2)), np.zeros(N, dtype=np.int64)
    given = found.given if len(found.given) == 1 else np.ascontiguousarray(found.given[block])
    form.solve_many(found.geometry.parameters, GOALS[found.kind], goals, given, slack, rows, counts)
    return Written(rows, counts, np.array(found.columns), found.template)


def _check(goals: Floats, first: Target, offset: int) -> None:
    """Refuses the first row that is no target."""
    violation = np.empty(len(goals))
    violations(KINDS[first.kind], goals, violation)
    bad = np.flatnonzero(~(violation <= ROTATION_TOLERANCE))
    if len(bad):
        amount = violation[bad[0]]
        got = f"a violation of {amount:.2g}" if np.isfinite(amount) else "numbers that are not finite"
        raise InvalidInputError(f"target {offset + int(bad[0])}", "a rigid pose, a position, or unit axes", got)


def _audit(result: BatchSolutions, wanted: Wanted, tolerances: Tolerances, seed: int, *, everything: bool) -> None:
    """Measures solutions by the chain itself, see `nao_kin.ik.auditing`."""
    places = np.flatnonzero(result.codes != ABSENT)
    places = places[audited(len(places), np.random.default_rng(seed), everything)]
    at = row, _ = np.unravel_index(places, result.codes.shape)
    errors = result.position_error[at], result.rotation_error[at]
    claimed = Claimed(result.q[at], wanted.goals(row), *errors, result.solved[at])
    audit_rows(result.chain, wanted.first, claimed, row, tolerances)
