"""Tasks 1d to 1g of the practicum, against the formulas as the sheet prints them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nao_kin.documents.practicum.position_ik import ik_checked, ik_pseudo_inverse, ik_transpose, position_jacobian
from nao_kin.documents.practicum.practicum_sheet import jaco2
from nao_kin.errors import InvalidInputError

START = np.radians([180.0, 200.0, 120.0, 90.0, 150.0, 10.0])


def by_hand(q: np.ndarray, p: np.ndarray, iterations: int, inverse) -> np.ndarray:
    """The sheet's iteration with a Jacobian by central differences."""
    arm, h = jaco2(), 1e-6
    for _ in range(iterations):
        columns = [(arm.pose(q + h * d).translation - arm.pose(q - h * d).translation) / (2 * h) for d in np.eye(6)]
        q = q + inverse(np.array(columns).T) @ (p - arm.pose(q).translation)
    return q


def test_the_sixth_column_is_zero_because_the_last_axis_passes_through_the_hand(rng: np.random.Generator) -> None:
    for q in rng.uniform(-math.pi, math.pi, (50, 6)):
        J = position_jacobian(jaco2(), q)
        assert J.shape == (3, 6)
        np.testing.assert_allclose(J[:, 5], 0.0, atol=1e-15)


def test_both_methods_are_the_printed_iterations() -> None:
    p = jaco2().pose(START + 0.1).translation
    pseudo, transpose = ik_pseudo_inverse(START, p, iterations=3), ik_transpose(START, p, gain=0.7, iterations=3)
    np.testing.assert_allclose(pseudo.q, by_hand(START, p, 3, lambda J: J.T @ np.linalg.inv(J @ J.T)), atol=1e-7)
    np.testing.assert_allclose(transpose.q, by_hand(START, p, 3, lambda J: 0.7 * J.T), atol=1e-7)
    for result in (pseudo, transpose):
        assert len(result.errors) == 4
        assert result.error == pytest.approx(np.linalg.norm(jaco2().pose(result.q).translation - p))
        assert result.jump == pytest.approx(np.abs(result.q - START).max())
        assert not result.fault


def test_the_check_names_what_is_wrong() -> None:
    near, far = jaco2().pose(START + 0.05).translation, np.array([0.0, 0.0, 5.0])
    assert not ik_checked(START, near).fault
    assert "position error" in ik_checked(START, far).fault
    assert "jumps by" in ik_checked(START, near, largest_jump=1e-3).fault
    assert "position error" in ik_checked(START, near, largest_error=0.0).fault


def test_at_a_singularity_the_iteration_stays_finite() -> None:
    """All joints at 180 degrees: the arm is stretched upwards, and the target is straight above."""
    q = np.full(6, math.pi)
    above = np.add(jaco2().pose(q).translation, (0.0, 0.0, 0.1))
    assert np.isfinite(ik_pseudo_inverse(q, above).q).all()
    assert "position error" in ik_checked(q, above).fault


def test_what_makes_no_sense_is_refused() -> None:
    p = np.zeros(3)
    for bad in (0, -1, 1.5, True):
        with pytest.raises(InvalidInputError, match="iterations"):
            ik_pseudo_inverse(START, p, iterations=bad)
    for bad in (0.0, -1.0, math.nan, math.inf, "much"):
        with pytest.raises(InvalidInputError, match="gain"):
            ik_transpose(START, p, gain=bad)
        with pytest.raises(InvalidInputError, match="gain"):
            ik_pseudo_inverse(START, p, gain=bad)
    with pytest.raises(InvalidInputError, match="target position"):
        ik_transpose(START, [0.0, 1.0], gain=1.0)
    with pytest.raises(InvalidInputError, match="6 numbers"):
        ik_transpose(START[:5], p, gain=1.0)
