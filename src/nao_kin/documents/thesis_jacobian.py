"""Bischoff 2016, section 3.2: Jacobian, transpose and pseudo-inverse, (3.2.0.1) to (3.2.2.3), as printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import dot
from numpy.linalg import inv

from nao_kin.documents.samples import derivative

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats


def eq_3_2_0_1(f: Callable[[Floats], Floats], theta: Floats) -> Floats:
    """(3.2.0.1): J = ∂f/∂θ, by five-point differences."""
    return derivative(f, theta)


def eq_3_2_0_2(J: Floats, delta_theta: Floats) -> Floats:
    """(3.2.0.2): Δr."""
    return J @ delta_theta


def eq_3_2_0_3(J: Floats, e: Floats) -> Floats:
    """(3.2.0.3): Δθ."""
    return inv(J) @ e


def eq_3_2_0_4(a: Floats, q: Floats) -> Floats:
    """(3.2.0.4): ∂f/∂θ_i of a unit vector a_i along the joint's axis and q_i from the joint to the end effector."""
    return np.cross(a, q)


def eq_3_2_1_1(J: Floats, e: Floats, alpha: float) -> Floats:
    """(3.2.1.1): Δθ."""
    return alpha * J.T @ e


def satz_1(J: Floats, e: Floats) -> tuple[float, float, float]:
    """Satz 1 and its proof: three expressions that are equal and not negative."""
    return float(dot(J @ (J.T @ e), e)), float(dot(J.T @ e, J.T @ e)), float(np.linalg.norm(J.T @ e) ** 2)


def eq_3_2_1_2(J: Floats, e: Floats) -> float:
    """(3.2.1.2): α."""
    return float(dot(e, J @ (J.T @ e)) / dot(J @ (J.T @ e), J @ (J.T @ e)))


def eq_3_2_2_1(J: Floats, e: Floats) -> Floats:
    """(3.2.2.1): Δθ by the Moore-Penrose inverse."""
    return np.linalg.pinv(J) @ e


def eq_3_2_2_2(J: Floats, e: Floats, delta_theta: Floats) -> tuple[Floats, Floats]:
    """(3.2.2.2): both sides of the normal equations."""
    return J.T @ (J @ delta_theta), J.T @ e


def eq_3_2_2_3(J: Floats, e: Floats) -> Floats:
    """(3.2.2.3): Δθ."""
    return inv(J.T @ J) @ J.T @ e


def eq_3_2_2_3_corrected(J: Floats, e: Floats) -> Floats:
    """For a J with more columns than rows: the right inverse."""
    return J.T @ inv(J @ J.T) @ e


def size_of_jtj() -> tuple[int, int]:
    """The text below (3.2.2.3): size of JᵀJ, and its rank if it has an inverse."""
    return 5, 5


def size_of_jtj_corrected() -> tuple[int, int]:
    """JᵀJ of a 3 × 4 Jacobian: singular."""
    return 4, 3
