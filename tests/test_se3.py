"""Poses: the way in, distances accurate at both ends, and rpy."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

from nao_kin import se3
from nao_kin.errors import InvalidInputError


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-12, 1e-8, 1e-3, 1.0, math.pi - 1e-3, math.pi - 1e-9, math.pi])
def test_rotation_distance_keeps_its_digits(angle: float, rng: np.random.Generator) -> None:
    for _ in range(20):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        A = pin.SE3.Random()
        B = A * pin.SE3(pin.exp3(angle * axis), np.zeros(3))
        assert se3.rotation_distance(A, B) == pytest.approx(angle, abs=2e-15, rel=1e-12)
        assert se3.rotation_distance(B, A) == pytest.approx(angle, abs=2e-15, rel=1e-12)


def test_rpy_is_urdfs_convention(rng: np.random.Generator) -> None:
    for _ in range(100):
        xyz, rpy = rng.normal(size=3), rng.uniform([-3, -1.5, -3], [3, 1.5, 3])
        T = se3.from_xyz_rpy(xyz, rpy)
        expected = (
            pin.exp3(np.array([0, 0, rpy[2]])) @ pin.exp3(np.array([0, rpy[1], 0])) @ pin.exp3(np.array([rpy[0], 0, 0]))
        )
        np.testing.assert_allclose(T.rotation, expected, atol=1e-15)
        np.testing.assert_allclose(se3.rpy(T), rpy, atol=1e-13)
        np.testing.assert_array_equal(T.translation, xyz)


def test_a_pose_is_copied_on_its_way_in() -> None:
    matrix = np.eye(4)
    pose = se3.as_pose(matrix)
    matrix[0, 3] = 1.0
    assert pose.translation[0] == 0.0
    again = se3.as_pose(pose)
    again.translation = np.ones(3)
    assert pose.translation[0] == 0.0


def test_the_nearest_rotation_is_nearest(rng: np.random.Generator) -> None:
    for _ in range(50):
        R = pin.exp3(rng.normal(size=3))
        almost = R + rng.normal(scale=1e-3, size=(3, 3))
        found = se3.nearest_rotation(almost)
        assert se3.rotation_violation(found) < 1e-14
        best = np.linalg.norm(found - almost)
        for _ in range(20):
            other = pin.exp3(rng.normal(scale=1e-3, size=3)) @ found
            assert np.linalg.norm(other - almost) >= best - 1e-12
    with pytest.raises(InvalidInputError, match="near a rotation"):
        se3.nearest_rotation(np.zeros((3, 3)))
    assert se3.rotation_violation(np.diag([1.0, 1.0, -1.0])) == 2.0
