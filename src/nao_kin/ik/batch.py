"""Many targets at once: the compiled loop on all cores, chunk by chunk, every row measured again."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, NoReturn

import numpy as np

from nao_kin.arrays import rows
from nao_kin.errors import InvalidInputError
from nao_kin.ik import compiled_loop as loop
from nao_kin.ik.auditing import Claimed, audited, inside_limits
from nao_kin.ik.auditing import audit as audit_rows
from nao_kin.ik.compiled import solve_goals
from nao_kin.ik.measure import measure_many
from nao_kin.ik.problem import STATUSES, Problem, Status, verdicts
from nao_kin.ik.single import prepared, start_of
from nao_kin.ik.target import KINDS, Target
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.reference_loop import Budget

__all__ = [
    "CHUNK",
    "BatchResult",
    "Wanted",
    "audit_batch",
    "judge_rows",
    "solve_batch",
    "starts_of",
]

CHUNK: Final = 1 << 16
"""Targets worked on at a time: scratch memory does not grow with the batch."""

_LONG: Final = 500_000  # targets from which on a bar shows the progress on a terminal


@dataclass(eq=False, slots=True)
class BatchResult:
    """Joints for many targets, each row measured again; rows are in the order of the targets.

    Attributes:
        chain: The chain.
        q: Joints (N, n) [rad or m]; the best found where unsolved, always finite.
        codes: Why each row ended (N,), numbers of `Status` members in their order.
        position_error: Distances of the tips to the targets [m] (N,), measured at `q`; NaN where free.
        rotation_error: Angles to the wanted orientations [rad] (N,), measured at `q`; NaN where free.
        iterations: Iterations over all starts of a row (N,).
    """

    chain: Chain
    q: Floats
    codes: NDArray[np.int8]
    position_error: Floats
    rotation_error: Floats
    iterations: NDArray[np.int32]

    @classmethod
    def blank(cls, chain: Chain, count: int) -> BatchResult:
        """Room for a count of rows of a chain, not yet written."""
        return cls(
            chain,
            np.empty((count, len(chain.joints))),
            np.empty(count, dtype=np.int8),
            np.empty(count),
            np.empty(count),
            np.empty(count, dtype=np.int32),
        )

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Whether each row is within tolerance and limits (N,)."""
        return np.asarray(self.codes == Status.SOLVED.number)

    @property
    def status(self) -> NDArray[np.object_]:
        """Why each row ended (N,), `Status` members."""
        return np.array(STATUSES, dtype=object)[self.codes]

    def __len__(self) -> int:
        return len(self.q)

    def __bool__(self) -> NoReturn:
        raise TypeError("A BatchResult is not a truth value: ask for result.solved.all().")

    def counts(self) -> dict[Status, int]:
        """How many rows ended for which reason."""
        found = np.bincount(self.codes, minlength=len(STATUSES))
        return {status: int(count) for status, count in zip(STATUSES, found, strict=True) if count}

    def __repr__(self) -> str:
        told = ", ".join(f"{count} {status.name}" for status, count in self.counts().items())
        return f"<BatchResult of {len(self)}: {told or 'nothing'}>"

    def _repr_html_(self) -> str:
        cells = tuple((status.name, str(count), status.value) for status, count in self.counts().items())
        columns = (Column("status"), Column("rows", number=True), Column("meaning"))
        return Table(columns, cells, title=f"{len(self)} targets of {self.chain.name}")._repr_html_()


def solve_batch(
    chain: Chain,
    targets: ArrayLike | Sequence[Target],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    audit: Literal["sample", "all"] = "sample",
    parameters: Mapping[str, float] | None = None,
) -> BatchResult:
    """`nao_kin.solve_batch`, which says what the arguments are, by a method that iterates."""
    wanted = Wanted.of(targets)
    if audit not in ("sample", "all"):
        raise InvalidInputError("audit", "'sample' or 'all'", repr(audit))
    ready = prepared(Problem(chain, wanted.first, tolerances), method, budget, seed, parameters)
    N = len(wanted.given)
    starts = starts_of(chain, q0, N, ready.neutral)
    result = BatchResult.blank(chain, N)
    for chunk in _chunks(N):
        own = starts[chunk] if len(starts) > 1 else starts
        goals = wanted.goals(chunk)
        outcomes = solve_goals(ready.tables, ready.settings, goals, np.ascontiguousarray(own))
        _refuse(outcomes, chunk.start)
        judge_rows(wanted.first, tolerances, goals, outcomes, result, chunk)
    audit_batch(result, wanted, tolerances, seed, everything=audit == "all")
    return result


@dataclass(frozen=True, eq=False, slots=True)
class Wanted:
    """The targets as they came, made into what solvers take chunk by chunk.

    Attributes:
        first: A target that says kind and weights.
        given: Poses (N, 4, 4), positions (N, 3), or goals (N, 4, 4) of `Target` objects.
    """

    first: Target
    given: NDArray[Any]

    @classmethod
    def of(cls, targets: ArrayLike | Sequence[Target]) -> Wanted:
        """The targets as callers give them.

        Raises:
            InvalidInputError: None of the forms that `solve_batch` takes, or mixed kinds.
        """
        if isinstance(targets, Sequence) and len(targets) and all(isinstance(t, Target) for t in targets):
            wanted: list[Any] = list(targets)
            if len(sorts := {(t.kind, t.weights) for t in wanted}) > 1:
                raise InvalidInputError("targets", "targets of one kind with the same weights", f"{len(sorts)} sorts")
            return cls(wanted[0], np.array([t.goal for t in wanted]))
        expected = "(N, 4, 4) poses, (N, 3) positions or Target objects"
        try:
            given = np.empty((0, 4, 4)) if isinstance(targets, Sequence) and not len(targets) else np.asarray(targets)
        except ValueError:
            raise InvalidInputError("targets", expected, "rows of different shapes") from None
        if hasattr(targets, "mask"):
            raise InvalidInputError("targets", expected, "a masked array, whose mask would be lost")
        if given.dtype.kind in "iuf" and given.ndim == 3 and given.shape[1:] == (4, 4):
            return cls(Target("pose", np.eye(4)), given)
        if given.dtype.kind in "iuf" and given.ndim == 2 and given.shape[1] == 3:
            return cls(Target("position", np.eye(4)), given)
        raise InvalidInputError("targets", expected, f"shape {given.shape} of type {given.dtype}")

    def goals(self, chunk: slice | NDArray[np.int64]) -> Floats:
        """The goals (k, 4, 4) of a chunk or of some rows, a copy; compiled code checks the numbers."""
        part = np.array(self.given[chunk], dtype=np.float64, order="C")
        if part.ndim == 3:
            return part
        goals = np.tile(np.eye(4), (len(part), 1, 1))
        goals[:, :3, 3] = part
        return goals


def starts_of(chain: Chain, q0: ArrayLike | Mapping[str, float] | None, count: int, neutral: Floats) -> Floats:
    """Starts (1, n) or (count, n) from what callers give; the neutral one (n,) by default."""
    if q0 is None:
        return neutral[None, :]
    if not isinstance(q0, Mapping) and np.ndim(q0) == 2:
        starts = rows(q0, "q0", len(chain.joints))
        if len(starts) not in (1, count):
            raise InvalidInputError("q0", f"one start, or one for each of the {count} targets", f"{len(starts)}")
        return starts
    return np.array(start_of(chain, q0), dtype=np.float64)[None, :]


def _chunks(count: int) -> Iterator[slice]:
    chunks = [slice(i, min(i + CHUNK, count)) for i in range(0, count, CHUNK)]
    if count < _LONG or not sys.stderr.isatty():
        yield from chunks
        return
    from rich.console import Console
    from rich.progress import track

    yield from track(chunks, description=f"{count} targets", console=Console(stderr=True), transient=True)


def _refuse(outcomes: Floats, offset: int) -> None:
    """Raises for the first row whose target or start made no sense."""
    bad = np.flatnonzero(outcomes[:, loop.CODE] < 0.0)
    if not len(bad):
        return
    row, amount = offset + int(bad[0]), float(outcomes[bad[0], loop.AMOUNT])
    if outcomes[bad[0], loop.CODE] == loop.BAD_START:
        raise InvalidInputError(f"q0 of row {row}", "finite numbers", f"another at index {int(amount)}")
    got = f"a violation of {amount:.2g}" if np.isfinite(amount) else "numbers that are not finite"
    raise InvalidInputError(f"target {row}", "a rigid pose, a position, or unit axes", got)


def judge_rows(
    first: Target, tolerances: Tolerances, goals: Floats, outcomes: Floats, result: BatchResult, chunk: slice
) -> None:
    """Measures a chunk again and writes its verdicts, by the same rules as `nao_kin.ik.problem.judge`."""
    from nao_kin.kernels.audit import tips

    chain, q = result.chain, np.ascontiguousarray(outcomes[:, loop.OUTCOME :])
    position, rotation = measure_many(KINDS[first.kind], goals, first.counts, tips(chain.joint_path, q))
    reached = ~((position > tolerances.position) | (rotation > tolerances.rotation)) & np.isfinite(q).all(axis=1)
    inside = inside_limits(chain, q, tolerances.limits)
    result.q[chunk], result.codes[chunk] = q, verdicts(outcomes[:, loop.CODE].astype(np.intp), reached, inside)
    result.position_error[chunk], result.rotation_error[chunk] = position, rotation
    result.iterations[chunk] = outcomes[:, loop.ITERATIONS]


def audit_batch(result: BatchResult, wanted: Wanted, tolerances: Tolerances, seed: int, *, everything: bool) -> None:
    """Measures rows by the chain itself, see `nao_kin.ik.auditing`."""
    rows = audited(len(result), np.random.default_rng(seed), everything)
    errors = result.position_error[rows], result.rotation_error[rows]
    claimed = Claimed(result.q[rows], wanted.goals(rows), *errors, result.solved[rows])
    audit_rows(result.chain, wanted.first, claimed, rows, tolerances)
