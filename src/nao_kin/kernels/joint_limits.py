"""Joint limits for compiled loops: moving inside them, coupled ones last, and holding joints that stand at an end.

Limits come as an array (2, n), least values and greatest values. Coupled limits come as one array (k, 7), a row a
breakpoint: number of the rule, limited column, deciding column, whether only the size of the deciding value counts,
that value [rad], least and greatest value of the limited joint there [rad].
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import LimitRule

__all__ = ["column_range", "decides", "hold", "inside_ranges", "move_inside", "packed_rules"]


def packed_rules(rules: Sequence[LimitRule], joint_names: Sequence[str]) -> Floats:
    """Coupled limits as one array (k, 7), columns counted in `joint_names`."""
    column = {name: i for i, name in enumerate(joint_names)}
    rows = [
        (number, column[rule.joint], column[rule.by], rule.even, at, lower, upper)
        for number, rule in enumerate(rules)
        for at, lower, upper in zip(rule.at, rule.lower, rule.upper, strict=True)
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


@leaf_jit
def move_inside(q: Floats, limits: Floats, coupled: Floats) -> bool:
    """Moves every joint of q (n,) to the nearest end of its range, coupled ranges last; whether any moved."""
    moved = False
    for i in range(q.shape[0]):
        inside = min(max(q[i], limits[0, i]), limits[1, i])
        moved = moved or inside != q[i]
        q[i] = inside
    first = 0
    while first < coupled.shape[0]:
        end = first + 1
        while end < coupled.shape[0] and coupled[end, 0] == coupled[first, 0]:
            end += 1
        i, by = int(coupled[first, 1]), int(coupled[first, 2])
        lower, upper = _coupled_range(coupled, first, end, q[by])
        inside = min(max(q[i], lower, limits[0, i]), upper, limits[1, i])
        moved = moved or inside != q[i]
        q[i] = inside
        first = end
    return moved


@leaf_jit
def column_range(limits: Floats, coupled: Floats, q: Floats, i: int) -> tuple[float, float]:
    """Range of column i, its own cut down to what the other columns of q (n,) leave it."""
    lower, upper = limits[0, i], limits[1, i]
    first = 0
    while first < coupled.shape[0]:
        end = first + 1
        while end < coupled.shape[0] and coupled[end, 0] == coupled[first, 0]:
            end += 1
        if int(coupled[first, 1]) == i:
            least, greatest = _coupled_range(coupled, first, end, q[int(coupled[first, 2])])
            lower, upper = max(lower, least), min(upper, greatest)
        first = end
    return min(lower, upper), upper


@leaf_jit
def inside_ranges(limits: Floats, coupled: Floats, q: Floats, tolerance: float) -> bool:
    """Whether every joint of q (n,) is within its own and its coupled range, give or take the tolerance."""
    outside = 0
    for i in range(q.shape[0]):
        outside += not limits[0, i] - tolerance <= q[i] <= limits[1, i] + tolerance
    first = 0
    while first < coupled.shape[0]:
        end = first + 1
        while end < coupled.shape[0] and coupled[end, 0] == coupled[first, 0]:
            end += 1
        least, greatest = _coupled_range(coupled, first, end, q[int(coupled[first, 2])])
        outside += not least - tolerance <= q[int(coupled[first, 1])] <= greatest + tolerance
        first = end
    return outside == 0


@leaf_jit
def decides(coupled: Floats, i: int) -> bool:
    """Whether the range of another column hangs on column i."""
    rows = 0
    for row in range(coupled.shape[0]):
        rows += coupled[row, 2] == i
    return rows > 0


@leaf_jit
def _coupled_range(coupled: Floats, first: int, end: int, by: float) -> tuple[float, float]:
    """Range of the limited joint by the breakpoints first ≤ row < end; constant beyond the ends."""
    value = abs(by) if coupled[first, 3] != 0.0 else by
    if value <= coupled[first, 4]:
        return coupled[first, 5], coupled[first, 6]
    for k in range(first + 1, end):
        if value < coupled[k, 4]:
            part = (value - coupled[k - 1, 4]) / (coupled[k, 4] - coupled[k - 1, 4])
            return (
                coupled[k - 1, 5] + part * (coupled[k, 5] - coupled[k - 1, 5]),
                coupled[k - 1, 6] + part * (coupled[k, 6] - coupled[k - 1, 6]),
            )
    return coupled[end - 1, 5], coupled[end - 1, 6]


@leaf_jit
def hold(limits: Floats, q: Floats, e: Floats, J: Floats) -> None:
    """Gives a joint that stands at an end a zero column in J (m, n) where the error e (m,) pushes it further out."""
    for k in range(q.shape[0]):
        low, high = q[k] <= limits[0, k], q[k] >= limits[1, k]
        if low or high:
            uphill = 0.0
            for i in range(e.shape[0]):
                uphill += J[i, k] * e[i]
            if (low and uphill < 0.0) or (high and uphill > 0.0):
                for i in range(e.shape[0]):
                    J[i, k] = 0.0
