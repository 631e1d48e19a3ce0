"""Where a compiled search begins again, and what it heads for when the target is out of reach."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.ik.aim import ORIENTATION, POINTING, POSITION
from nao_kin.ik.layout import CENTRE, CLOSENESS, INNER, KIND, OUTER, POSITION_TOLERANCE, TIP, WEIGHTS
from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["measure_starts", "misses_by", "take_nearest", "to_shell"]


@leaf_jit
def measure_starts(settings: Floats, goal: Floats, stored: Floats, distances: Floats) -> None:
    """How far the tip of each stored start (K, n + 12) is from the goal, in what the kind binds."""
    n, kind, closeness = stored.shape[1] - TIP, int(settings[KIND]), settings[CLOSENESS]
    for k in range(stored.shape[0]):
        total = 0.0
        if kind != ORIENTATION:
            for i in range(3):
                total += closeness * (stored[k, n + 9 + i] - goal[i, 3]) ** 2
        if kind not in (POSITION, POINTING):
            for i in range(3):
                for j in range(3):
                    total += (stored[k, n + 3 * i + j] - goal[i, j]) ** 2
        distances[k] = total


@leaf_jit
def take_nearest(stored: Floats, distances: Floats, scratch: Floats) -> None:
    """Puts the nearest start not taken before to the front of the scratch memory."""
    nearest = 0
    for k in range(1, distances.shape[0]):
        if distances[k] < distances[nearest]:
            nearest = k
    distances[nearest] = math.inf
    for k in range(stored.shape[1] - TIP):
        scratch[k] = stored[nearest, k]


@leaf_jit
def to_shell(settings: Floats, goal: Floats, near: Floats) -> None:
    """Writes the goal, its position moved to the nearest point of the reach shell."""
    distance = _from_centre(settings, goal)
    scale = min(max(distance, settings[INNER]), settings[OUTER]) / distance if distance > 0.0 else 0.0
    for i in range(4):
        for j in range(4):
            near[i, j] = goal[i, j]
    for i in range(3):
        near[i, 3] = settings[CENTRE + i] + scale * (goal[i, 3] - settings[CENTRE + i])
    if distance == 0.0:
        near[0, 3] += settings[INNER]


@leaf_jit
def _from_centre(settings: Floats, goal: Floats) -> float:
    """Distance of the goal from the centre of the shell [m], which does not overflow where its square would."""
    x, y, z = goal[0, 3] - settings[CENTRE], goal[1, 3] - settings[CENTRE + 1], goal[2, 3] - settings[CENTRE + 2]
    largest = max(abs(x), abs(y), abs(z))
    if largest == 0.0:
        return 0.0
    x, y, z = x / largest, y / largest, z / largest
    distance: float = largest * math.sqrt(x * x + y * y + z * z)
    return distance


@leaf_jit
def misses_by(settings: Floats, goal: Floats) -> float:
    """A distance by which the goal certainly misses the reach [m]; 0 within tolerance, or where nothing is proven."""
    if settings[KIND] == ORIENTATION:
        return 0.0
    for i in range(3):
        if settings[WEIGHTS + i] == 0.0:
            return 0.0
    distance = _from_centre(settings, goal)
    beyond = max(distance - settings[OUTER], settings[INNER] - distance)
    return beyond if beyond > settings[POSITION_TOLERANCE] else 0.0
