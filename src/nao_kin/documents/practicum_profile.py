"""Practicum, section 2: a line and its speed profile, (17) to (36), as printed and as they should be.

Positions in metres, times in seconds. Symbols as the sheet has them; where it writes a_2 and a_n for the braking
acceleration, both are given the true one, which is negative.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def eq_17(t: float, p_0: float, p_1: float, t_0: float, t_n: float) -> float:
    """(17)."""
    return p_0 + t * (p_1 - p_0) / (t_n - t_0)


def eq_17_corrected(t: float, p_0: float, p_n: float, t_0: float, t_n: float) -> float:
    """(17) for any start, to the end point."""
    return p_0 + (t - t_0) * (p_n - p_0) / (t_n - t_0)


def eq_18(t: float, p_0: float, p_1: float, t_0: float, t_n: float) -> float:
    """(18)."""
    v = (p_1 - p_0) / (t_n - t_0)
    return p_0 + v * t


def eq_19(a_0: float) -> float:
    """(19): the acceleration of the first phase, at any time of it."""
    return a_0


def eq_20(a_0: float, t: float) -> float:
    """(20)."""
    return a_0 * t


def eq_21(a_0: float, t: float) -> float:
    """(21)."""
    return 1 / 2 * a_0 * t**2


def eq_22() -> float:
    """(22)."""
    return 0


def eq_23(v_0: Callable[[float], float], t_1: float) -> float:
    """(23): the speed of the second phase, at any time of it."""
    return v_0(t_1)


def eq_24(p_0: Callable[[float], float], v_0: Callable[[float], float], t: float, t_1: float) -> float:
    """(24)."""
    return p_0(t_1) + v_0(t_1) * (t - t_1)


def eq_25(a_n: float) -> float:
    """(25): the acceleration of the last phase, at any time of it."""
    return a_n


def eq_26(v_1: Callable[[float], float], a_n: float, t: float, t_2: float) -> float:
    """(26)."""
    return v_1(t_2) + a_n * (t - t_2)


def eq_27(p_1: Callable[[float], float], v_1: Callable[[float], float], a_2: float, t: float, t_2: float) -> float:
    """(27)."""
    return p_1(t_2) + v_1(t_2) * (t - t_2) + 1 / 2 * a_2 * (t - t_2) ** 2


def eq_28(v_max: float, a_0: float) -> float:
    """(28): t_1 − t_0."""
    return v_max / a_0


def eq_29(a_2: float, t_1: float) -> float:
    """(29): p_1 − p_0."""
    return 1 / 2 * a_2 * t_1**2


def eq_29_corrected(a_0: float, t_1: float, t_0: float) -> float:
    """p_1 − p_0 with the acceleration of its own phase, and from any start."""
    return 1 / 2 * a_0 * (t_1 - t_0) ** 2


def eq_30(v_max: float, a_2: float) -> float:
    """(30): t_n − t_2."""
    return -v_max / a_2


def eq_31(a_2: float, t_n: float, t_2: float) -> float:
    """(31): p_n − p_2."""
    return -1 / 2 * a_2 * (t_n - t_2) ** 2


def eq_32(p_0: float, p_1: float, p_2: float, p_n: float, v_max: float, t_1: float, t_2: float) -> tuple[float, float]:
    """(32): both expressions for p_2 − p_1."""
    return v_max * (t_2 - t_1), (p_n - p_0) - (p_1 - p_0) - (p_n - p_2)


def eq_33(p_1: float, p_2: float, v_max: float) -> float:
    """(33): t_2 − t_1."""
    return (p_2 - p_1) / v_max


def eq_34(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """(34): t_1,kurz − t_0."""
    return t_1 + abs(a_0) / (abs(a_0) + abs(a_n)) * (t_2 - t_1)


def eq_34_corrected(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """t_1,kurz − t_0, from the peak v² = v_max² + 2 v_max (t_2 − t_1) |a_0||a_n|/(|a_0| + |a_n|) that is left."""
    return sqrt(t_1**2 + 2 * abs(a_n) / (abs(a_0) + abs(a_n)) * t_1 * (t_2 - t_1))


def eq_35(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """(35): t_n,kurz − t_2."""
    return t_1 + abs(a_n) / (abs(a_0) + abs(a_n)) * (t_2 - t_1)


def eq_35_corrected(t_1: float, t_2: float, t_n: float, a_0: float, a_n: float) -> float:
    """t_n,kurz − t_1,kurz: braking begins where speeding up ends, and has its own length t_n − t_2."""
    down = t_n - t_2
    return sqrt(down**2 + 2 * abs(a_0) / (abs(a_0) + abs(a_n)) * down * (t_2 - t_1))


def eq_36(a_0: float, a_n: float, t_0: float, t_1_short: float) -> tuple[float, float]:
    """(36): both expressions for v_max,kurz."""
    return a_0 * (t_1_short - t_0), a_n * (t_1_short - t_0)


def eq_36_corrected(a_0: float, a_n: float, t_0: float, t_1_short: float, t_n_short: float) -> tuple[float, float]:
    """The second in the braking phase, whose acceleration is negative."""
    return a_0 * (t_1_short - t_0), -a_n * (t_n_short - t_1_short)


def short_distance(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """Section 2.2 as one procedure: where a motion by (34), (35) and the first of (36) ends, from 0 [m]."""
    up, down = eq_34(t_1, t_2, a_0, a_n), eq_35(t_1, t_2, a_0, a_n)
    v_max = eq_36(a_0, a_n, 0.0, up)[0]
    return v_max * up / 2 + v_max * down / 2


def short_distance_corrected(t_1: float, t_2: float, t_n: float, a_0: float, a_n: float) -> float:
    """The same by the corrected equations."""
    up, down = eq_34_corrected(t_1, t_2, a_0, a_n), eq_35_corrected(t_1, t_2, t_n, a_0, a_n)
    v_max = eq_36_corrected(a_0, a_n, 0.0, up, up + down)[0]
    return v_max * up / 2 + v_max * down / 2


def cruise_is_negative(p_1: float, p_2: float, v_max: float) -> bool:
    """Section 2.2: the case is the one in which (33) is negative."""
    return eq_33(p_1, p_2, v_max) < 0
