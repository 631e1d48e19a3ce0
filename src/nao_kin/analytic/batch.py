"""Every solution of many targets: the closed form's kernel on all cores, every solution measured again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, NoReturn

import numpy as np

from nao_kin.analytic.form import GOALS, ClosedForm
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.solutions import SAME, in_window, slack_of
from nao_kin.errors import AuditError, InvalidInputError
from nao_kin.ik.aim import goal_violation
from nao_kin.ik.batch import AUDIT_TOLERANCE, AUDITED, CHUNK, Wanted, inside_limits
from nao_kin.ik.measure import measure_many
from nao_kin.ik.problem import Problem, Run, Status, judge
from nao_kin.ik.target import KINDS, Target
from nao_kin.se3 import ROTATION_TOLERANCE
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["BatchSolutions", "solve_all_batch"]

_STATUSES: Final = tuple(Status)
_SOLVED, _OUTSIDE = _STATUSES.index(Status.SOLVED), _STATUSES.index(Status.OUTSIDE_LIMITS)
_ABSENT: Final = -1
_MEETS: Final = 1e-10  # [m, rad], as one by one


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
        return np.asarray(self.codes != _ABSENT)

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Whether a place holds a solution within tolerance and limits (N, B)."""
        return np.asarray(self.codes == _SOLVED)

    def branch(self, row: int, place: int) -> str:
        """The branch of a solution in words; empty where there is none."""
        number, singularity = self.branches[row, place].tolist()
        return self.form.label(number, singularity) if self.codes[row, place] != _ABSENT else ""

    def __len__(self) -> int:
        return len(self.q)

    def __bool__(self) -> NoReturn:
        raise TypeError("BatchSolutions is not a truth value: ask for result.solved.any(axis=1).")

    def __repr__(self) -> str:
        within = int(self.solved.any(axis=1).sum())
        return f"<BatchSolutions of {len(self)}: {int(self.found.sum())} solutions, {within} targets within limits>"


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

    Raises:
        InvalidInputError: Wrong shapes, not finite, not rigid (the row is named), mixed kinds, or no form fits.
        UnknownNameError: A locked joint is not one of the chain; carries near matches.
        AuditError: Two forward kinematics disagree: a defect of this package or of the machine.
    """
    wanted = Wanted.of(targets)
    if audit not in ("sample", "all"):
        raise InvalidInputError("audit", "'sample' or 'all'", repr(audit))
    found = matched(chain, wanted.first, locked)
    N, B, n = len(wanted.given), found.request.branches, len(chain.joints)
    if len(found.given) not in (1, N):
        raise InvalidInputError(
            "locked", f"one value a joint, or one for each of the {N} targets", f"{len(found.given)}"
        )
    result = BatchSolutions(
        chain,
        found.form,
        np.full((N, B, n), np.nan),
        np.full((N, B), _ABSENT, dtype=np.int8),
        np.zeros((N, B, 2), dtype=np.int16),
        np.full((N, B), np.nan),
        np.full((N, B), np.nan),
    )
    for start in range(0, N, CHUNK):
        chunk = slice(start, min(start + CHUNK, N))
        _solve(found, wanted, tolerances, chunk, result)
    _audit(result, wanted, tolerances, np.random.default_rng(seed), everything=audit == "all")
    return result


def _solve(found: Matched, wanted: Wanted, tolerances: Tolerances, chunk: slice, result: BatchSolutions) -> None:
    """Solves a chunk and writes what the measurement confirms."""
    form, goals = found.form, wanted.goals(chunk)
    _check(goals, wanted.first, chunk.start)
    n, N = form.joints, len(goals)
    rows, counts = np.empty((N, found.request.branches, n + 2)), np.zeros(N, dtype=np.int64)
    given = found.given if len(found.given) == 1 else np.ascontiguousarray(found.given[chunk])
    form.solve_many(found.geometry.parameters, GOALS[found.kind], goals, given, slack_of(tolerances), rows, counts)
    written = np.arange(rows.shape[1]) < counts[:, None]
    q = np.tile(found.template, (int(counts.sum()), 1))
    q[:, list(found.columns)] = rows[written][:, :n]
    q = in_window(result.chain, q)
    position, rotation, codes = _measured(result.chain, wanted.first, tolerances, np.repeat(goals, counts, axis=0), q)
    spread = _Spread(written)
    codes_of = spread(codes, _ABSENT)
    errors = spread(np.fmax(np.nan_to_num(position), np.nan_to_num(rotation)), np.inf)
    joints = spread(q, np.nan)
    keep = _kept(codes_of, errors, joints)
    result.codes[chunk] = np.where(keep, codes_of, _ABSENT)
    result.q[chunk] = np.where(keep[:, :, None], joints, np.nan)
    result.branches[chunk] = np.where((keep & written)[:, :, None], np.nan_to_num(rows[:, :, n:]), 0).astype(np.int16)
    result.position_error[chunk] = np.where(keep, spread(position, np.nan), np.nan)
    result.rotation_error[chunk] = np.where(keep, spread(rotation, np.nan), np.nan)


@dataclass(frozen=True, eq=False, slots=True)
class _Spread:
    """Puts values of the written places (M, …) back to their places (N, B, …)."""

    written: NDArray[np.bool_]

    def __call__(self, values: NDArray[Any], fill: float) -> NDArray[Any]:
        spread = np.full((*self.written.shape, *values.shape[1:]), fill, dtype=values.dtype)
        spread[self.written] = values
        return spread


def _measured(
    chain: Chain, first: Target, tolerances: Tolerances, goals: Floats, q: Floats
) -> tuple[Floats, Floats, NDArray[np.int8]]:
    """Errors and status of solutions (M, n), by the second compiled forward kinematics; −1 where they miss."""
    from nao_kin.kernels.audit import tips

    position, rotation = measure_many(KINDS[first.kind], goals, first.counts, tips(chain.joint_path, q))
    missed = (position > tolerances.position) | (rotation > tolerances.rotation) | ~np.isfinite(q).all(axis=1)
    inside = inside_limits(chain, q, tolerances.limits)
    return position, rotation, np.where(missed, _ABSENT, np.where(inside, _SOLVED, _OUTSIDE)).astype(np.int8)


def _kept(codes: NDArray[np.int8], errors: Floats, q: Floats) -> NDArray[np.bool_]:
    """Which places hold a solution of their own, by the rules of `nao_kin.analytic.solutions.sorted_out`."""
    keep = codes != _ABSENT
    best = np.where(keep, errors, np.inf).min(axis=1, keepdims=True, initial=np.inf)
    keep &= errors <= np.maximum(_MEETS, 1e3 * np.where(np.isfinite(best), best, 0.0))
    for later in range(1, keep.shape[1]):
        for earlier in range(later):
            same = np.abs(q[:, later] - q[:, earlier]).max(axis=1) <= SAME
            keep[:, later] &= ~(keep[:, earlier] & same)
    return np.asarray(keep)


def _check(goals: Floats, first: Target, offset: int) -> None:
    """Refuses the first row that is no target."""
    violation = np.array([goal_violation(KINDS[first.kind], goal) for goal in goals])
    bad = np.flatnonzero(~(violation <= ROTATION_TOLERANCE))
    if len(bad):
        amount = violation[bad[0]]
        got = f"a violation of {amount:.2g}" if np.isfinite(amount) else "numbers that are not finite"
        raise InvalidInputError(f"target {offset + int(bad[0])}", "a rigid pose, a position, or unit axes", got)


def _audit(
    result: BatchSolutions, wanted: Wanted, tolerances: Tolerances, rng: np.random.Generator, *, everything: bool
) -> None:
    """Measures solutions by the chain itself; one disagreement fails the call."""
    places = np.argwhere(result.found)
    if not everything and len(places):
        places = places[rng.choice(len(places), min(len(places), max(AUDITED, len(places) // 100)), replace=False)]
    for row, place in places.tolist():
        target = Target(wanted.first.kind, wanted.goals(slice(row, row + 1))[0], wanted.first.weights)
        run = Run(result.q[row, place].copy(), _STATUSES[result.codes[row, place]])
        measured = judge(Problem(result.chain, target, tolerances), run)
        pairs = (
            (measured.position_error, result.position_error[row, place], tolerances.position),
            (measured.rotation_error, result.rotation_error[row, place], tolerances.rotation),
        )
        slack = AUDIT_TOLERANCE + 1e-12 * np.abs(target.goal).max()
        far = any(a is not None and not abs(a - b) <= slack for a, b, _ in pairs)
        close_call = any(a is not None and abs(a - limit) <= slack for a, _, limit in pairs)
        if far or (measured.solved != bool(result.solved[row, place]) and not close_call):
            raise AuditError(row, str(measured), f"position {pairs[0][1]:.3g} m, rotation {pairs[1][1]:.3g} rad")
