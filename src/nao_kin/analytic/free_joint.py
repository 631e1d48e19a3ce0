"""Values of a joint that a target leaves free, spread over its range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nao_kin.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.chain import Chain

__all__ = ["values_of"]


def values_of(chain: Chain, redundancy: str, samples: int, locked: Mapping[str, float]) -> list[float]:
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
