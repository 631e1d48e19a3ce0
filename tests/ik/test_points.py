"""FABRIK on free points."""

from __future__ import annotations

import numpy as np
import pytest

from nao_kin.errors import InvalidInputError
from nao_kin.ik.geometric.free_points import fabrik_points

LINE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]


def _lengths(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.diff(points, axis=0), axis=1)


def _case(rng: np.random.Generator) -> tuple[np.ndarray, float, float, np.ndarray]:
    """Points, the least and greatest distance their links reach, and a direction."""
    points = np.cumsum(rng.normal(size=(int(rng.integers(3, 9)), 3)), axis=0)
    lengths, direction = _lengths(points), rng.normal(size=3)
    hole = max(0.0, 2.0 * lengths.max() - lengths.sum())
    return points, hole, float(lengths.sum()), direction / np.linalg.norm(direction)


def test_reachable_targets_are_reached_with_the_lengths_and_the_base_kept(rng: np.random.Generator) -> None:
    for _ in range(500):
        points, hole, reach, direction = _case(rng)
        given, target = points.copy(), points[0] + (hole + rng.uniform(0.05, 0.9) * (reach - hole)) * direction
        moved, iterations = fabrik_points(points, target)
        assert 0 <= iterations < 1000
        assert np.linalg.norm(moved[-1] - target) <= 1e-6
        np.testing.assert_allclose(_lengths(moved), _lengths(points), rtol=1e-12)
        np.testing.assert_array_equal(moved[0], points[0])
        np.testing.assert_array_equal(points, given)
        np.testing.assert_array_equal(moved, fabrik_points(points, target)[0])


def test_out_of_reach_the_end_is_as_near_as_the_lengths_allow(rng: np.random.Generator) -> None:
    for _ in range(500):
        points, hole, reach, direction = _case(rng)
        for distance in (reach * (1.0 + 1e-12), reach + 1e-6, 10.0 * reach, 0.999 * hole, 0.5 * hole, 0.0):
            if hole <= distance <= reach:  # links that close to a polygon leave no hole
                continue
            target = points[0] + distance * direction
            moved, _ = fabrik_points(points, target)
            missing = np.linalg.norm(moved[-1] - target)
            assert missing == pytest.approx(max(distance - reach, hole - distance), abs=1e-6)
            np.testing.assert_allclose(_lengths(moved), _lengths(points), rtol=1e-12)


@pytest.mark.parametrize("x", [-2.9, -1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 2.9, 2.999])
def test_a_straight_line_is_bent_to_targets_on_it(x: float) -> None:
    moved, _ = fabrik_points(LINE, [x, 0.0, 0.0], iterations=10_000)
    assert np.linalg.norm(moved[-1] - [x, 0.0, 0.0]) <= 1e-6
    np.testing.assert_allclose(_lengths(moved), 1.0, rtol=1e-12)


def test_a_target_on_any_of_the_points_divides_by_nothing(rng: np.random.Generator) -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]])
    for target in points:
        moved, _ = fabrik_points(points, target)
        assert np.linalg.norm(moved[-1] - target) <= 1e-6
        np.testing.assert_allclose(_lengths(moved), _lengths(points), atol=1e-12)


def test_a_reached_target_changes_nothing() -> None:
    moved, iterations = fabrik_points(LINE, LINE[-1])
    assert iterations == 0
    np.testing.assert_array_equal(moved, LINE)


def test_one_iteration_by_hand() -> None:
    """Two links of length 1 at right angles, the target in the middle of the second."""
    points, target = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]), np.array([1.0, 0.5, 0.0])
    middle = target + (points[1] - target) / 0.5  # the reach pass
    middle /= np.linalg.norm(middle)  # and the way back
    tip = middle + (target - middle) / np.linalg.norm(target - middle)
    moved, iterations = fabrik_points(points, target, tolerance=0.0, iterations=1)
    assert iterations == 1
    np.testing.assert_allclose(moved, [points[0], middle, tip], atol=1e-15)


@pytest.mark.parametrize("limit", [0, 1, 7])
def test_it_ends_after_so_many_iterations(limit: int) -> None:
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    assert fabrik_points(points, [1.9, 0.3, 0.1], tolerance=0.0, iterations=limit)[1] == limit


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (([[0.0, 0.0, 0.0]], [1.0, 0.0, 0.0]), "points"),
        (([[0.0, 0.0], [1.0, 0.0]], [1.0, 0.0, 0.0]), "points"),
        (([[0.0, 0.0, np.nan], [1.0, 0.0, 0.0]], [1.0, 0.0, 0.0]), "points"),
        ((LINE, [1.0, 0.0]), "target"),
        ((LINE, [1.0, 0.0, 0.0], -1.0), "tolerance"),
        ((LINE, [1.0, 0.0, 0.0], np.nan), "tolerance"),
        ((LINE, [1.0, 0.0, 0.0], 1e-6, -1), "iterations"),
        ((LINE, [1.0, 0.0, 0.0], 1e-6, 1.5), "iterations"),
    ],
)
def test_bad_input_is_named(arguments: tuple[object, ...], what: str) -> None:
    with pytest.raises(InvalidInputError, match=what):
        fabrik_points(*arguments)
