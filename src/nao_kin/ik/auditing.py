"""The sampled audit: rows that compiled code has measured are measured again by the chain's own forward kinematics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from nao_kin.errors import AuditError
from nao_kin.ik.measure import measure_many
from nao_kin.ik.problem import Status, verdicts
from nao_kin.ik.target import KINDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import Target
    from nao_kin.tolerances import Tolerances

__all__ = ["Claimed", "audit", "audited", "inside_limits"]

_LEAST: Final = 64
"""Rows of a batch that are measured by the chain itself; or a hundredth of them, if that is more."""

_TOLERANCE: Final = 1e-9
"""How far apart two measurements of the same joints may be [m, rad], and more where numbers are large."""


class Claimed(NamedTuple):
    """What compiled code says of some rows.

    Attributes:
        q: Joints (N, n) [rad or m].
        goals: Their targets (N, 4, 4).
        position_error: [m] (N,), NaN where free.
        rotation_error: [rad] (N,), NaN where free.
        solved: Whether they are within tolerance and limits (N,).
    """

    q: Floats
    goals: Floats
    position_error: Floats
    rotation_error: Floats
    solved: NDArray[np.bool_]


def audited(count: int, rng: np.random.Generator, everything: bool) -> NDArray[np.intp]:
    """Which of so many rows are measured again: all, or a seeded sample."""
    if everything or not count:
        return np.arange(count)
    return rng.choice(count, min(count, max(_LEAST, count // 100)), replace=False).astype(np.intp)


def audit(chain: Chain, wanted: Target, claimed: Claimed, rows: NDArray[np.intp], tolerances: Tolerances) -> None:
    """Measures rows by the chain itself and judges them; one disagreement fails the call.

    Args:
        chain: The chain.
        wanted: A target that says kind and weights.
        claimed: What was said of the rows.
        rows: What to call them in a message (N,).
        tolerances: When a target counts as reached.

    Raises:
        AuditError: Two measurements disagree: a defect of this package or of the machine.
    """
    q, goals, ours_position, ours_rotation, ours_solved = claimed
    if not len(q):
        return
    position, rotation = measure_many(KINDS[wanted.kind], goals, wanted.counts, _tips(chain, q))
    # What rounding allows grows with the numbers: an angle of 1e8 rad has lost half its digits.
    slack = _TOLERANCE + 1e-14 * np.abs(q).max(axis=1) + 1e-12 * np.abs(goals).max(axis=(1, 2))
    far, close_call = np.zeros(len(q), dtype=np.bool_), np.zeros(len(q), dtype=np.bool_)
    reached = np.ones(len(q), dtype=np.bool_)
    for error, ours, allowed in (
        (position, ours_position, tolerances.position),
        (rotation, ours_rotation, tolerances.rotation),
    ):
        far |= (np.isnan(error) != np.isnan(ours)) | (np.abs(error - ours) > slack)
        reached &= ~(error > allowed)
        close_call |= np.abs(error - allowed) <= slack
    ended = np.full(len(q), Status.SOLVED.number)
    solved = verdicts(ended, reached, inside_limits(chain, q, tolerances.limits)) == Status.SOLVED.number
    bad = np.flatnonzero(far | ((solved != ours_solved) & ~close_call))
    if len(bad):
        i = int(bad[0])
        told = f"position {position[i]:.3g} m, rotation {rotation[i]:.3g} rad, {'' if solved[i] else 'not '}solved"
        raise AuditError(int(rows[i]), told, f"position {ours_position[i]:.3g} m, rotation {ours_rotation[i]:.3g} rad")


def inside_limits(chain: Chain, q: Floats, tolerance: float) -> NDArray[np.bool_]:
    """Whether every joint of each row (N, n) is within its own and its coupled range, give or take the tolerance."""
    inside = ((q >= chain.lower - tolerance) & (q <= chain.upper + tolerance)).all(axis=1)
    index = {name: i for i, name in enumerate(chain.joint_names)}
    for rule in chain.limit_rules:
        by, limited = q[:, index[rule.by]], q[:, index[rule.joint]]
        value = np.abs(by) if rule.even else by
        lower, upper = np.interp(value, rule.at, rule.lower), np.interp(value, rule.at, rule.upper)
        inside &= (limited >= lower - tolerance) & (limited <= upper + tolerance)
    return np.asarray(inside)


def _tips(chain: Chain, Q: Floats) -> Floats:
    """The chain's own poses (N, 4, 4)."""
    T = np.tile(np.eye(4), (len(Q), 1, 1))
    for pose, q in zip(T, Q, strict=True):
        pose[:3, :3], pose[:3, 3] = chain.tip_at(q)
    return T
