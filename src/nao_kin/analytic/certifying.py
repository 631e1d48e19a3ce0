"""Compiled certification of what closed forms wrote for many targets: placed, measured, and kept once.

Solutions are measured by `nao_kin.kernels.forward`, which no closed form shares anything with but sine and cosine. The
rules are those of `nao_kin.analytic.solutions` for one target; a sample is measured a third time, by the chain itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from nao_kin.ik.aim import goal_violation
from nao_kin.ik.measure import errors
from nao_kin.ik.problem import Status, verdicts
from nao_kin.ik.target import POINTING
from nao_kin.kernels.compiling import leaf_jit, parallel_jit, prange
from nao_kin.kernels.forward import poses
from nao_kin.kernels.joint_limits import inside_ranges, packed_rules

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.kernels.joint_path import JointPath
    from nao_kin.tolerances import Tolerances

__all__ = [
    "ABSENT",
    "BESIDE",
    "MEETS",
    "SAME",
    "SOLVED",
    "Certificate",
    "Ranges",
    "Written",
    "certify",
    "placed",
    "violations",
]

SAME: Final = 1e-9
"""Solutions of one goal whose joints are all this near, up to whole turns, are one [rad or m]."""

BESIDE: Final = 1e-5
"""A solution that just misses and is this near [rad or m] to one that meets is that one, with lost digits."""

MEETS: Final = 1e-10
"""A solution that misses by more than this [m, rad] and a thousand times what the best one does is none."""

SOLVED: Final = Status.SOLVED.number
ABSENT: Final = -1
_INSIDE, _OUTSIDE = 1, 0  # what compiled code writes where a target is reached; the verdict is not its own

_TURN: Final = 2.0 * math.pi
_MOST_TURNS: Final = 1000.0  # a range wider than this is a file's way to say that there is no limit
_FEWER: Final = 1e3


class Ranges(NamedTuple):
    """What a chain's joints may be, as compiled code reads it.

    Attributes:
        limits: Least and greatest values (2, n) [rad or m].
        coupled: Coupled limits (k, 7), see `nao_kin.kernels.joint_limits`.
        winding: 1 where whole turns bring a joint back that is outside its limits (n,).
    """

    limits: Floats
    coupled: Floats
    winding: NDArray[np.int64]

    @classmethod
    def of(cls, chain: Chain) -> Ranges:
        """The ranges of a chain."""
        limits = np.stack([chain.lower, chain.upper])
        turning = np.array([joint.kind != "prismatic" for joint in chain.joints])
        with np.errstate(invalid="ignore"):  # ∞ − ∞ of an empty chain's ends
            narrow = limits[1] - limits[0] < _MOST_TURNS * _TURN
        return cls(limits, packed_rules(chain.limit_rules, chain.joint_names), (turning & narrow).astype(np.int64))


class Written(NamedTuple):
    """What a closed form wrote for N goals.

    Attributes:
        rows: Its joints and two labels (N, B, m + 2).
        counts: How many of the B it wrote (N,).
        columns: The chain's columns that its joints are (m,).
        template: The chain's joints (n,) where others are held.
    """

    rows: Floats
    counts: NDArray[np.int64]
    columns: NDArray[np.int64]
    template: Floats


class Certificate(NamedTuple):
    """What is kept of it; see `nao_kin.analytic.solution_batch.BatchSolutions`.

    Attributes:
        q: Joints (N, B, n), NaN where there is no solution.
        codes: Numbers of `Status` members, or `ABSENT` (N, B).
        branches: Numbers of branch and singularity (N, B, 2).
        position_error: [m] (N, B), NaN where free or absent.
        rotation_error: [rad] (N, B), NaN where free or absent.
    """

    q: Floats
    codes: NDArray[np.int8]
    branches: NDArray[np.int16]
    position_error: Floats
    rotation_error: Floats

    @classmethod
    def blank(cls, targets: int, branches: int, joints: int) -> Certificate:
        """Room for so many, not yet written."""
        shape = (targets, branches)
        return cls(
            np.empty((*shape, joints)),
            np.empty(shape, dtype=np.int8),
            np.empty((*shape, 2), dtype=np.int16),
            np.empty(shape),
            np.empty(shape),
        )

    def part(self, chunk: slice) -> Certificate:
        """The same memory for some of the targets."""
        q, codes, branches, position, rotation = self
        return Certificate(q[chunk], codes[chunk], branches[chunk], position[chunk], rotation[chunk])


class Wish(NamedTuple):
    """What is wanted of every goal, inside compiled code.

    Attributes:
        kind: A value of `nao_kin.ik.target.KINDS`.
        counted: Bits of the axes that count, see `nao_kin.ik.measure.errors`.
        allowed: Tolerances (3,): position [m], rotation [rad], limits [rad or m].
        over: Whether a goal binds more than there are joints.
    """

    kind: int
    counted: int
    allowed: Floats
    over: bool


class Placed(NamedTuple):
    """Every solution that was written, one after the other.

    Attributes:
        Q: The chain's joints (M, n).
        T: Its tip's poses there (M, 4, 4).
    """

    Q: Floats
    T: Floats


@parallel_jit
def violations(kind: int, goals: Floats, found: Floats) -> None:
    """Writes by how much each goal (N, 4, 4) is none of its kind, (N,); see `nao_kin.ik.aim.goal_violation`."""
    for i in prange(goals.shape[0]):
        found[i] = goal_violation(kind, goals[i])


def placed(q: Floats, ranges: Ranges) -> Floats:
    """Joints (n,), those outside their limits moved by whole turns to as near to the limits' middle as they go."""
    moved = q.copy()
    _place(moved, ranges)
    return moved


def certify(
    path: JointPath,
    ranges: Ranges,
    kind: int,
    counted: int,
    goals: Floats,
    written: Written,
    tolerances: Tolerances,
    certificate: Certificate,
) -> None:
    """Measures what was written for goals (N, 4, 4), and writes what holds to the certificate.

    Args:
        path: The chain.
        ranges: Its limits.
        kind: What is wanted, a value of `nao_kin.ik.target.KINDS`.
        counted: Bits of the axes that count, see `nao_kin.ik.measure.errors`.
        goals: The goals.
        written: What the closed form wrote.
        tolerances: When a goal counts as reached.
        certificate: Written.
    """
    ends = np.cumsum(written.counts)
    Q = np.empty((int(ends[-1]) if len(ends) else 0, len(written.template)))
    _gather(written, ends, ranges, Q)
    allowed = np.array([tolerances.position, tolerances.rotation, tolerances.limits])
    conditions = counted.bit_count() - (kind == POINTING)
    _keep(
        Wish(kind, counted, allowed, conditions > Q.shape[1]),
        goals,
        written,
        ends,
        Placed(Q, poses(path, Q)),
        ranges,
        certificate,
    )
    reached = certificate.codes != ABSENT
    ended = np.full(certificate.codes.shape, SOLVED)
    certificate.codes[reached] = verdicts(ended, reached, certificate.codes == _INSIDE)[reached]


@leaf_jit
def _place(q: Floats, ranges: Ranges) -> None:
    for k in range(q.shape[0]):
        lower, upper = ranges.limits[0, k], ranges.limits[1, k]
        if ranges.winding[k] and not lower <= q[k] <= upper:
            q[k] += np.rint((0.5 * (lower + upper) - q[k]) / _TURN) * _TURN


@parallel_jit
def _gather(written: Written, ends: NDArray[np.int64], ranges: Ranges, Q: Floats) -> None:
    """Writes the chain's joints of every solution, one after the other."""
    for i in prange(ends.shape[0]):
        for b in range(written.counts[i]):
            m = ends[i] - written.counts[i] + b
            for k in range(Q.shape[1]):
                Q[m, k] = written.template[k]
            for k in range(written.columns.shape[0]):
                Q[m, written.columns[k]] = written.rows[i, b, k]
            _place(Q[m], ranges)


@parallel_jit
def _keep(
    asked: Wish,
    goals: Floats,
    written: Written,
    ends: NDArray[np.int64],
    every: Placed,
    ranges: Ranges,
    certificate: Certificate,
) -> None:
    """Writes what was measured of every place, and whether it is inside the limits."""
    for i in prange(goals.shape[0]):
        first = ends[i] - written.counts[i]
        _measure(asked, goals[i], i, first, written, every, ranges, certificate)
        _drop(i, asked.over, certificate)


@leaf_jit
def _measure(
    asked: Wish,
    goal: Floats,
    i: int,
    first: int,
    written: Written,
    every: Placed,
    ranges: Ranges,
    certificate: Certificate,
) -> None:
    Q, T, allowed = every.Q, every.T, asked.allowed
    n, labels = Q.shape[1], written.columns.shape[0]
    for b in range(written.rows.shape[1]):
        m = first + b
        certificate.codes[i, b] = ABSENT
        certificate.branches[i, b, 0], certificate.branches[i, b, 1] = 0, 0
        if b >= written.counts[i]:
            continue
        position, rotation = errors(asked.kind, goal, asked.counted, T[m, :3, :3], T[m, :3, 3])
        # Comparisons with NaN, which stands for an error that the target leaves free, are false.
        if position > allowed[0] or rotation > allowed[1] or not _finite(Q[m]):
            continue
        inside = inside_ranges(ranges.limits, ranges.coupled, Q[m], allowed[2])
        certificate.codes[i, b] = _INSIDE if inside else _OUTSIDE
        certificate.position_error[i, b], certificate.rotation_error[i, b] = position, rotation
        certificate.branches[i, b, 0] = int(written.rows[i, b, labels])
        certificate.branches[i, b, 1] = int(written.rows[i, b, labels + 1])
        for k in range(n):
            certificate.q[i, b, k] = Q[m, k]


@leaf_jit
def _finite(q: Floats) -> bool:
    nothing = 0.0
    for k in range(q.shape[0]):
        nothing += 0.0 * q[k]  # NaN of NaN and of infinity
    return nothing == 0.0


@leaf_jit
def _drop(i: int, over: bool, certificate: Certificate) -> None:
    """Empties the places of a target whose solutions just miss where another meets, or repeat an earlier one."""
    codes, B = certificate.codes, certificate.codes.shape[1]
    best = math.inf
    for b in range(B):
        if codes[i, b] != ABSENT:
            best = min(best, _error(i, b, certificate))
    for b in range(B):
        bound = max(MEETS, _FEWER * best)
        misses = codes[i, b] != ABSENT and _error(i, b, certificate) > bound
        if misses and certificate.branches[i, b, 1] != 0 and not over:
            misses = _is_beside(i, b, bound, certificate)
        if codes[i, b] != ABSENT and (misses or _repeats(i, b, certificate)):
            codes[i, b] = ABSENT
        if codes[i, b] == ABSENT:
            certificate.branches[i, b, 0], certificate.branches[i, b, 1] = 0, 0
            certificate.position_error[i, b], certificate.rotation_error[i, b] = math.nan, math.nan
            for k in range(certificate.q.shape[2]):
                certificate.q[i, b, k] = math.nan


@leaf_jit
def _is_beside(i: int, b: int, bound: float, certificate: Certificate) -> bool:
    """Whether a solution that just misses is next to one that meets."""
    for other in range(certificate.codes.shape[1]):
        if certificate.codes[i, other] != ABSENT and _error(i, other, certificate) <= bound:
            away = 0.0
            for k in range(certificate.q.shape[2]):
                away = max(away, abs(certificate.q[i, b, k] - certificate.q[i, other, k]))
            if away <= BESIDE:
                return True
    return False


@leaf_jit
def _error(i: int, b: int, certificate: Certificate) -> float:
    """The larger of the errors that the target does not leave free [m, rad]."""
    position, rotation = certificate.position_error[i, b], certificate.rotation_error[i, b]
    return max(position if position == position else 0.0, rotation if rotation == rotation else 0.0)


@leaf_jit
def _repeats(i: int, b: int, certificate: Certificate) -> bool:
    for earlier in range(b):
        if certificate.codes[i, earlier] != ABSENT and _same(certificate.q[i, b], certificate.q[i, earlier]):
            return True
    return False


@leaf_jit
def _same(q: Floats, other: Floats) -> bool:
    k = 0
    while k < q.shape[0] and abs(q[k] - other[k]) <= SAME:
        k += 1
    return bool(k == q.shape[0])
