"""What the checks of the ledger sample and measure with; none of it is out of a document."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.chain import random_configurations

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["derivative", "deviation", "regular_configurations", "relative", "wrapped"]

_STEP = 1e-3  # five-point differences: their error is about step⁴/30, and rounding about 1e-16/step, 1e-13 each


def deviation(found: Any, wanted: Any) -> float:
    """Largest absolute difference of two arrays; infinite where they have different shapes or are not numbers."""
    a, b = np.asarray(found), np.asarray(wanted)
    if a.shape != b.shape:
        return math.inf
    largest = float(np.abs(a - b).max(initial=0.0))
    return math.inf if math.isnan(largest) else largest


def relative(found: Any, wanted: Any) -> float:
    """The same in units of the largest entry of what is wanted."""
    return deviation(found, wanted) / float(np.abs(np.asarray(wanted)).max())


def derivative(f: Callable[[Floats], Any], x: Floats) -> Floats:
    """df/dx (m, n) of a function from (n,) to (m,), or (n,) of one to a number, by five-point differences."""
    columns = []
    for step in _STEP * np.eye(len(x)):
        near, far = np.asarray(f(x + step)) - f(x - step), np.asarray(f(x + 2 * step)) - f(x - 2 * step)
        columns.append((8.0 * near - far) / (12.0 * _STEP))
    return np.array(columns).T


def wrapped(angle: Any) -> Any:
    """An angle [rad], or several, in [−π, π)."""
    return (np.asarray(angle) + math.pi) % (2.0 * math.pi) - math.pi


def regular_configurations(chain: Chain, count: int, seed: int, rows: int = 6, least: float = 0.02) -> Floats:
    """Configurations inside the limits at which the first rows of the Jacobian are far from singular.

    Args:
        chain: The arm.
        count: How many.
        seed: Of the random generator.
        rows: 3 for the position, 6 for the pose.
        least: Smallest singular value that is far from singular [m/rad, or 1].
    """
    rng, found = np.random.default_rng(seed), list[Any]()
    while len(found) < count:
        q = random_configurations(chain, 1, rng)[0]
        if np.linalg.svd(chain.jacobian(q)[:rows], compute_uv=False)[-1] >= least:
            found.append(q)
    return np.array(found)
