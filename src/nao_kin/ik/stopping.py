"""When a search from one start ends, and how long its steps may be: said once, for compiled loops and Python's."""

from __future__ import annotations

from typing import Final

from nao_kin.kernels.compiling import leaf_jit

__all__ = ["POLISHED", "REACHED", "gives_up", "improved", "is_polished", "step_scale"]

REACHED: Final = 0.99
"""Error in units of its tolerance at which the target counts as reached; a little less than 1, so that it still does
when the judge measures again with another forward kinematics."""

POLISHED: Final = 1e-3
"""Error in units of its tolerance at which a search ends at once; until then it goes on while the error falls. One
more step is cheap, and near a target Newton's convergence makes it a thousandfold gain."""

_PATIENCE_ONCE_REACHED: Final = 5
"""Iterations without halving the error after which polishing ends, however patient the search was until then."""


@leaf_jit
def is_polished(merit: float, previous: float) -> bool:
    """Whether a search that has reached its target need not go on: merits in units of tolerance, now and one before."""
    return merit <= POLISHED or merit >= previous


@leaf_jit
def improved(merit: float, halved: float) -> bool:
    """Whether the error has halved since the last time it had, so that waiting begins anew."""
    return merit < 0.5 * halved


@leaf_jit
def gives_up(waited: int, patience: float, reached: bool) -> bool:
    """Whether so many iterations without halving the error are enough."""
    return waited >= (min(patience, _PATIENCE_ONCE_REACHED) if reached else patience)


@leaf_jit
def step_scale(largest: float, bound: float) -> float:
    """What to scale a step by whose largest entry may not be longer than the bound [rad or m]."""
    return bound / largest if largest > bound else 1.0
