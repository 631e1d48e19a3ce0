"""MATLAB example: its equations, the solutions of its solver and the table of its verification run, as printed.

Rows are counted from 1 as the example counts them. Roots are complex where MATLAB's are: a product of two imaginary
ones is a real number, and for a camera that looks backwards the solutions need it.
"""

from __future__ import annotations

from math import acos, atan2, hypot
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy import arctan as atan
from numpy import cos, pi, sin, tan
from numpy.lib.scimath import sqrt

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "eqns",
    "free_coordinates",
    "result_table",
    "row_6",
    "rows_1_5",
    "rows_4_7_8_9",
    "theta_1_sol",
    "theta_1_unsimplified",
    "theta_2_all",
    "theta_2_all_corrected",
    "theta_2_conds",
    "theta_2_sol",
    "verification",
    "yc_sol",
]

Pair: TypeAlias = "tuple[Any, Any]"
"""θ_1 [rad] and y_c of a row."""


def eqns(
    t1: float, t2: float, xc: float, yc: float, zc: float, CameraX: float, CameraZ: float, NeckOffsetZ: float
) -> tuple[float, float, float]:
    """eq1, eq2 and eq3, all of which are to be zero."""
    return (
        xc * cos(t1) - CameraZ * sin(t2) - CameraX * cos(t2) + yc * sin(t1),
        yc * cos(t1) - xc * sin(t1),
        zc - NeckOffsetZ - CameraZ * cos(t2) + CameraX * sin(t2),
    )


def free_coordinates() -> int:
    """How many of x_c, y_c, z_c can be chosen: x_c and z_c, and y_c follows."""
    return 2


def theta_2_sol(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[Any, Any]:
    """Both rows with k = 0 [rad]."""
    root = sqrt(CameraX**2 + CameraZ**2 - NeckOffsetZ**2 + 2 * NeckOffsetZ * zc - zc**2)
    return (
        -2 * atan((CameraX - root) / (CameraZ - NeckOffsetZ + zc)),
        -2 * atan((CameraX + root) / (CameraZ - NeckOffsetZ + zc)),
    )


def theta_2_conds(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> bool:
    """The condition of both rows."""
    return CameraZ + zc != NeckOffsetZ and (NeckOffsetZ - zc) ** 2 <= CameraX**2 + CameraZ**2


def theta_2_all(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[Any, ...]:
    """Every θ_2 that the example finds [rad]: both rows where their condition holds."""
    holds = theta_2_conds(CameraX, CameraZ, NeckOffsetZ, zc)
    return theta_2_sol(CameraX, CameraZ, NeckOffsetZ, zc) if holds else ()


def theta_2_all_corrected(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[float, ...]:
    """θ_2 [rad] from z_c − NeckOffsetZ = r cos(θ_2 + φ), without the half angle, which has no tangent at π."""
    r, phi = hypot(CameraX, CameraZ), atan2(CameraX, CameraZ)
    between = acos((zc - NeckOffsetZ) / r)
    return between - phi, -between - phi


def theta_1_sol(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any]:
    """Rows 2 and 3 of the simplified theta_1_sol [rad]."""
    s1 = 2 * atan(
        sqrt(CameraX * cos(t2) - xc + CameraZ * sin(t2))
        * sqrt(xc + CameraX * cos(t2) + CameraZ * sin(t2))
        / (xc + CameraX * cos(t2) + CameraZ * sin(t2))
    )
    return s1, -s1


def theta_1_unsimplified(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any]:
    """The same before the substitution [rad]; its fraction bars and roots are lost in print and read so."""
    sigma_5 = tan(t2 / 2) ** 2
    sigma_4 = CameraX + xc - CameraX * sigma_5 + xc * sigma_5 + 2 * CameraZ * tan(t2 / 2)
    sigma_3 = sqrt(-(xc - CameraX + CameraX * sigma_5 + xc * sigma_5 - 2 * CameraZ * tan(t2 / 2))) * sqrt(sigma_4)
    s2 = 2 * atan((sigma_3 / (sigma_5 + 1) + sigma_5 * sigma_3 / (sigma_5 + 1)) / sigma_4)
    return s2, -s2


def yc_sol(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any, Any, Any]:
    """Rows 2, 3, 7 and 8 of yc_sol."""
    T = tan(t2 / 2)
    y1 = (
        sqrt(-(xc - CameraX + CameraX * T**2 + xc * T**2 - 2 * CameraZ * T))
        * sqrt(CameraX + xc - CameraX * T**2 + xc * T**2 + 2 * CameraZ * T)
        / (T**2 + 1)
    )
    y2 = (-CameraX * T**2 + 2 * CameraZ * T + CameraX) / (T**2 + 1)
    return y1, -y1, y2, -y2


def rows_1_5(CameraX: float, xc: float) -> tuple[Pair, Pair]:
    """Rows 1 and 5 of theta_1_sol and yc_sol."""
    w = sqrt(CameraX + xc) * sqrt(CameraX - xc) / (CameraX - xc)
    y = sqrt(CameraX + xc) * sqrt(CameraX - xc)
    return (-2 * atan(w), y), (2 * atan(w), -y)


def rows_4_7_8_9(CameraX: float, CameraZ: float, t2: float) -> tuple[Pair, Pair, Pair, Pair]:
    """Rows 4, 7, 8 and 9 of theta_1_sol and yc_sol."""
    T = tan(t2 / 2)
    y2 = (-CameraX * T**2 + 2 * CameraZ * T + CameraX) / (T**2 + 1)
    return (-pi / 2, CameraX), (pi / 2, y2), (-pi / 2, -y2), (pi / 2, -CameraX)


def row_6() -> tuple[Pair]:
    """Row 6 of theta_1_sol and yc_sol, after the parameter x is set to 0."""
    return ((0, 0),)


def verification(
    known: tuple[float, float, float], CameraX: float, CameraZ: float, NeckOffsetZ: float
) -> list[tuple[float, float]]:
    """The verification run for one position (x, y, z): the pairs (θ_1, θ_2) [rad] that it accepts.

    The conditions of theta_1_sol are not printed; a row counts here if it is a real number.
    """
    x_known, y_known, z_known = known
    pairs = []
    for t2 in theta_2_all(CameraX, CameraZ, NeckOffsetZ, z_known):
        for t1, y_derived in _nine_rows(CameraX, CameraZ, x_known, t2):
            if np.isreal(t1) and abs(y_known - y_derived) < max(100 * 2.2e-16, 1e-6 * abs(y_known)):
                pairs.append((float(np.real(t1)), float(t2)))
    return pairs


def _nine_rows(CameraX: float, CameraZ: float, xc: float, t2: float) -> Iterator[Pair]:
    first, fifth = rows_1_5(CameraX, xc)
    second, third = zip(theta_1_sol(CameraX, CameraZ, xc, t2), yc_sol(CameraX, CameraZ, xc, t2)[:2], strict=True)
    fourth, *others = rows_4_7_8_9(CameraX, CameraZ, t2)
    yield from (first, second, third, fourth, fifth, *row_6(), *others)


def result_table() -> tuple[tuple[float, float, float, float], ...]:
    """θ_1 and θ_2 known, θ_1 and θ_2 derived [rad]."""
    return (
        (0.7854, 0.3927, 0.7854, 0.3927),
        (0.7854, 0.3927, -2.3562, -1.7346),
        (0.5236, -0.2618, 0.5236, -0.2618),
        (0.5236, -0.2618, -2.618, -1.0801),
        (0.3927, 0.19635, 0.3927, 0.19635),
        (0.3927, 0.19635, -2.7489, -1.5383),
        (0.31416, -0.31416, 0.31416, -0.31416),
        (0.31416, -0.31416, -2.8274, -1.0278),
    )
