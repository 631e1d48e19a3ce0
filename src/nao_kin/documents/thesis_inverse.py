"""Bischoff 2016, section 3.3: the closed form of the arms, (3.3.0.1) to (3.3.0.16), as printed and corrected.

A and A' are 4 × 4 and counted from 0, so A_(2,4) is A[1, 3]. The l are in one unit, the thesis' is mm. A ± gives both.
"""

from __future__ import annotations

import itertools
import math
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy import arccos, arcsin, cos, sin, sqrt
from numpy.linalg import inv

from nao_kin.documents.thesis_transforms import eq_2_2_1_1, eq_2_2_1_2, eq_2_2_1_3

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from nao_kin.arrays import Floats

    Pair = tuple[Any, Any]

_QUARTER: Final = 1e-7  # |θ_3| this close to π/2 is π/2: an arc sine near 1 is known no better


def _homogeneous(R: Floats, t: Floats) -> Floats:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def eq_3_3_0_1(t: Floats, r: Floats) -> Floats:
    """(3.3.0.1): A, of a target's position and its angles about x, y and z."""
    return _homogeneous(eq_2_2_1_3(r[2]) @ eq_2_2_1_2(r[1]) @ eq_2_2_1_1(r[0]), t)


def s_definition(t: Floats, shoulder: Floats) -> Floats:
    """Text: s is the vector from the shoulder to the target position."""
    return t - shoulder


def s_definition_corrected(_t: Floats, shoulder: Floats) -> Floats:
    """The position of the shoulder, (0, ±l_1, l_2)."""
    return shoulder


# Left arm.


def eq_3_3_0_2(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """(3.3.0.2): θ_4."""
    root = sqrt((s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2)
    return -(pi - arccos((l_3**2 + l_4**2 - root) / (2 * l_3 * l_4)))


def eq_3_3_0_2_corrected(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """With the squared distance, as the law of cosines has it."""
    squared = (s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2
    return -(pi - arccos((l_3**2 + l_4**2 - squared) / (2 * l_3 * l_4)))


def eq_3_3_0_3(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """(3.3.0.3): θ_2."""
    above = A[1, 3] - l_1 - l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle + pi / 2, -angle + pi / 2


def eq_3_3_0_4(A: Floats, t_2: float) -> Any:
    """(3.3.0.4): θ_3."""
    return -arcsin(A[1, 2] / sin(t_2 - pi / 2))


def eq_3_3_0_5(A: Floats, t_2: float) -> Any:
    """(3.3.0.5): θ_3."""
    return -(pi - arcsin(A[1, 2] / sin(t_2 - pi / 2)))


def eq_3_3_0_6(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.6): θ_1 if θ_3 is not ±π/2."""
    above = A[2, 2] + A[0, 2] * sin(-t_3) * cos(t_2 - pi / 2) / cos(-t_3)
    angle = arccos(above / (cos(-t_3) + cos(t_2 - pi / 2) ** 2 * sin(-t_3) ** 2 / cos(-t_3)))
    return angle, -angle


def eq_3_3_0_7(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.7): θ_1 if θ_3 is ±π/2 and θ_2 is not 0."""
    angle = arccos(A[0, 2] / (cos(t_2 - pi / 2) * sin(-t_3)))
    return angle, -angle


def eq_3_3_0_8(A: Floats, T_4_end: Floats, l_3: float) -> Pair:
    """(3.3.0.8): θ_1 if θ_3 is ±π/2 and θ_2 is 0."""
    A_hat = A @ inv(T_4_end)
    angle = arccos(A_hat[0, 3] / l_3)
    return angle, -angle


# Right arm.


def eq_3_3_0_9(A: Floats) -> Floats:
    """(3.3.0.9): A', without the last turn of (3.1.0.2)."""
    return A @ inv(_homogeneous(eq_2_2_1_3(-pi), np.zeros(3)))


def eq_3_3_0_10(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """(3.3.0.10): θ_4."""
    root = sqrt((s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2)
    return pi - arccos((l_3**2 + l_4**2 - root) / (2 * l_3 * l_4))


def eq_3_3_0_10_corrected(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """With the squared distance."""
    return -eq_3_3_0_2_corrected(A, s, l_3, l_4)


def eq_3_3_0_11(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """(3.3.0.11): θ_2."""
    above = -A[1, 3] - l_1 - l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle - pi / 2, -angle - pi / 2


def eq_3_3_0_11_corrected(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """With the sign that A' needs in the last term above the line."""
    above = -A[1, 3] - l_1 + l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle - pi / 2, -angle - pi / 2


def eq_3_3_0_12(A: Floats, t_2: float) -> Any:
    """(3.3.0.12): θ_3."""
    return -arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_12_corrected(A: Floats, t_2: float) -> Any:
    """Without the minus, as the other branch of (3.3.0.13)."""
    return arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_13(A: Floats, t_2: float) -> Any:
    """(3.3.0.13): θ_3."""
    return pi - arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_14(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.14): θ_1 if θ_3 is not ±π/2."""
    above = A[2, 2] + A[0, 2] * sin(t_3) * cos(t_2 + pi / 2) / cos(t_3)
    angle = arccos(above / (cos(t_3) + cos(t_2 + pi / 2) ** 2 * sin(t_3) ** 2 / cos(t_3)))
    return angle, -angle


def eq_3_3_0_15(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.15): θ_1 if θ_3 is ±π/2 and θ_2 is not 0."""
    angle = arccos(A[0, 2] / (cos(t_2 + pi / 2) * sin(t_3)))
    return angle, -angle


def eq_3_3_0_16(A: Floats, T_4_end: Floats, l_3: float) -> Pair:
    """(3.3.0.16): θ_1 if θ_3 is ±π/2 and θ_2 is 0."""
    A_hat = A @ inv(T_4_end)
    angle = arccos(A_hat[0, 3] / l_3)
    return angle, -angle


# The whole procedure: every candidate (θ_1, θ_2, θ_3, θ_4); step 7, the check by forward kinematics, is the caller's.


def left_pipeline(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """(3.3.0.2) to (3.3.0.8) with the text's s."""
    t_4 = eq_3_3_0_2(A, s_definition(A[:3, 3], shoulder), l_3, l_4)
    return _left_after_elbow(A, t_4, l_1, l_3, l_4)


def left_pipeline_corrected(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """With θ_4 and s corrected."""
    return _left_after_elbow(A, eq_3_3_0_2_corrected(A, shoulder, l_3, l_4), l_1, l_3, l_4)


def right_pipeline(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """(3.3.0.10) to (3.3.0.16) with the text's s; A is A'."""
    t_4 = eq_3_3_0_10(A, s_definition(A[:3, 3], shoulder), l_3, l_4)
    return _right_after_elbow(A, t_4, eq_3_3_0_11(A, t_4, l_1, l_3, l_4), eq_3_3_0_12, l_3, l_4)


def right_pipeline_corrected(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """With θ_4, s, θ_2 and (3.3.0.12) corrected."""
    t_4 = eq_3_3_0_10_corrected(A, shoulder, l_3, l_4)
    return _right_after_elbow(A, t_4, eq_3_3_0_11_corrected(A, t_4, l_1, l_3, l_4), eq_3_3_0_12_corrected, l_3, l_4)


def _left_after_elbow(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Floats:
    rolls = eq_3_3_0_3(A, t_4, l_1, l_3, l_4)
    elbows = (eq_3_3_0_4, eq_3_3_0_5)
    return _candidates(A, t_4, rolls, elbows, (eq_3_3_0_6, eq_3_3_0_7, eq_3_3_0_8), (l_3, l_4))


def _right_after_elbow(
    A: Floats, t_4: float, rolls: Pair, first_elbow: Callable[[Floats, float], Any], l_3: float, l_4: float
) -> Floats:
    elbows = (first_elbow, eq_3_3_0_13)
    return _candidates(A, t_4, rolls, elbows, (eq_3_3_0_14, eq_3_3_0_15, eq_3_3_0_16), (l_3, l_4))


def _candidates(
    A: Floats,
    t_4: float,
    rolls: Pair,
    elbows: Iterable[Any],
    pitches: tuple[Any, Any, Any],
    lengths: tuple[float, float],
) -> Floats:
    generic, quarter, straight = pitches
    rows, T_end = [], _homogeneous(np.eye(3), np.array([lengths[1], 0.0, 0.0]))
    for t_2, elbow in itertools.product(rolls, elbows):
        t_3 = elbow(A, t_2)
        if not abs(abs(t_3) - pi / 2) <= _QUARTER:
            found = generic(A, t_2, t_3)
        elif abs(math.sin(t_2)) > _QUARTER:
            found = quarter(A, t_2, t_3)
        else:
            found = straight(A, T_end, lengths[0])
        rows += [(t_1, t_2, t_3, t_4) for t_1 in found]
    return np.array(rows)
