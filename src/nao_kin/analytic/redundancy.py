"""Arms with one joint more than a pose needs: the self-motion, sampled over the joint that is chosen to be free."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nao_kin.analytic.solutions import Solutions, solve_all
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.chain import Chain
    from nao_kin.ik.target import TargetLike

__all__ = ["SelfMotionSample", "self_motion"]


class SelfMotionSample(NamedTuple):
    """The solutions of a pose at one value of the free joint.

    Attributes:
        value: The free joint [rad or m].
        solutions: What `nao_kin.solve_all` gives with that joint locked there; may be empty.
    """

    value: float
    solutions: Solutions


def self_motion(
    chain: Chain,
    target: TargetLike,
    *,
    redundancy: str,
    samples: int = 64,
    locked: Mapping[str, float] | None = None,
    tolerances: Tolerances = TOLERANCES,
    windings: bool = False,
) -> tuple[SelfMotionSample, ...]:
    """Every solution of a target at evenly spaced values of one joint, over its range or one turn.

    Args:
        chain: The chain; with `redundancy` and `locked` held, a closed form must fit it.
        target: T_base_target as `nao_kin.solve_all` takes it.
        redundancy: The joint that parametrises the self-motion.
        samples: How many values; for a joint without limits the end of the turn is left out.
        locked: Values of further joints by name [rad or m].
        tolerances: When the target counts as reached.
        windings: See `nao_kin.solve_all`.

    Raises:
        InvalidInputError: Not a target, no closed form fits, fewer than two samples, a sliding joint without limits, or
            a joint both free and locked.
        UnknownNameError: No such joint; carries near matches.
    """
    held = dict(locked or {})
    return tuple(
        SelfMotionSample(
            value,
            solve_all(chain, target, locked=held | {redundancy: value}, tolerances=tolerances, windings=windings),
        )
        for value in _values_of(chain, redundancy, samples, held)
    )


def _values_of(chain: Chain, redundancy: str, samples: int, locked: Mapping[str, float]) -> list[float]:
    """Evenly spaced values over the joint's range, ends included, or over one turn [rad or m].

    Raises:
        InvalidInputError: Fewer than two samples, a sliding joint without limits, or a joint both free and locked.
        UnknownNameError: No such joint; carries near matches.
    """
    if redundancy not in chain.joint_names:
        raise UnknownNameError("joint", redundancy, chain.joint_names, chain.name)
    if isinstance(samples, bool) or not isinstance(samples, int | np.integer) or samples < 2:
        raise InvalidInputError("samples", "an integer ≥ 2", repr(samples))
    if redundancy in locked:
        raise InvalidInputError("redundancy", "a joint that is not locked", redundancy)
    k = chain.joint_names.index(redundancy)
    low, high = chain.lower[k], chain.upper[k]
    if np.isfinite(low) and np.isfinite(high):
        return list(np.linspace(low, high, samples).tolist())
    if chain.joints[k].kind == "prismatic":
        raise InvalidInputError("redundancy", "a joint with limits, or one that turns", redundancy)
    return list(np.linspace(-np.pi, np.pi, samples, endpoint=False).tolist())
