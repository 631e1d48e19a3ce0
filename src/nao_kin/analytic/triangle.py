"""Two links and the distance they span, which most closed forms come down to."""

from __future__ import annotations

import math
from typing import Final

from nao_kin.kernels.compiling import leaf_jit

__all__ = ["FAR", "NONE", "ONE", "ROUNDING", "TWO", "bend"]

NONE, ONE, TWO = 0, 1, 2
"""How many bends span a distance."""

ROUNDING: Final = 1e-12
"""Relative to the size of an arm: a direction whose length is below this decides nothing, and a goal that is beyond the
border of the reachable set by less is on it."""

FAR: Final = 1e100
"""Nothing is solved for goals beyond this distance [m], whose squares overflow; not even by the border's solution."""

_SAME: Final = 1e-14  # relative: two links this near to their full length have one bend; rounding has eaten the other


@leaf_jit
def bend(a: float, b: float, distance: float, slack: float) -> tuple[int, float, float, float]:
    """The angle t between two links a and b whose ends are a distance apart: distance² = a² + b² + 2 a b cos t.

    Args:
        a: First link [m].
        b: Second link [m].
        distance: From the first link's root to the second one's end [m].
        slack: How far beyond the border the border itself will do [m].

    Returns:
        How many solutions ±t there are, t in [0, π], its sine and its cosine. At the straight and the folded arm it is
        one, t being exactly 0 or π.
    """
    longest, shortest = a + b, abs(a - b)
    if not (shortest - slack <= distance <= longest + slack and distance < FAR):
        return NONE, 0.0, 0.0, 1.0
    # The law of cosines by half angles, which keep their digits near the straight and the folded arm.
    to_straight = (longest - distance) * (longest + distance)
    from_folded = (distance - shortest) * (distance + shortest)
    if to_straight <= _SAME * longest * longest:
        return ONE, 0.0, 0.0, 1.0
    if from_folded <= _SAME * longest * longest:
        return ONE, math.pi, 0.0, -1.0
    t = 2.0 * math.atan2(math.sqrt(to_straight), math.sqrt(from_folded))
    return TWO, t, math.sqrt(to_straight * from_folded) / (2.0 * a * b), (from_folded - to_straight) / (4.0 * a * b)
