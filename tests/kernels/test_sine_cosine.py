"""Sine and cosine of the kernels against extended precision, where it counts and where it goes wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nao_kin.kernels import forward
from nao_kin.kernels.joint_path import JointPath, PathJoint, joint_path
from nao_kin.kernels.trigonometry import sine_cosine

STRATA = {
    "zero": np.array([0.0, -0.0]),
    "tiny": np.concatenate([s * np.logspace(-320, -5, 500) for s in (1.0, -1.0)]),
    "quarter turns": np.arange(-2000, 2001) * (math.pi / 2),
    "odd eighths, where the reduction changes sides": np.arange(-2001, 2002, 2) * (math.pi / 4),
    "next to multiples": np.concatenate([np.nextafter(np.arange(-200, 201) * math.pi / 4, e) for e in (-1e9, 1e9)]),
    "joints": np.random.default_rng(1).uniform(-2 * math.pi, 2 * math.pi, 200_000),
    "within 50 rad": np.random.default_rng(2).uniform(-50.0, 50.0, 200_000),
    "around a thousand": np.random.default_rng(3).uniform(900.0, 1100.0, 100_000),
    "up to the switch": np.concatenate([[1e5, -1e5], np.random.default_rng(4).uniform(-1e5, 1e5, 200_000)]),
    "beyond the switch": np.array([np.nextafter(1e5, 2e5), 100_001.0, 1e6, -1e8, 1e8, 2.0**53, 1e17, -1e17, 1e300]),
}
BOUND = 2.3e-16


def by_kernel(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sine and cosine as the block kernel computes them: the pose of one joint is nothing else."""
    T = forward.poses(one_joint(), np.ascontiguousarray(angles.reshape(-1, 1)))
    return T[:, 1, 0], T[:, 0, 0]


def one_joint() -> JointPath:
    joint = PathJoint(np.eye(4), np.array([0.0, 0.0, 1.0]), prismatic=False, column=0)
    path = joint_path([joint], np.eye(4), np.array([-np.inf]), np.array([np.inf]))
    return path._replace(rotations=np.eye(3)[None], tool_rotation=np.eye(3))  # whatever x the lowering chose


def reference(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if np.finfo(np.longdouble).eps > 1e-18:
        pytest.skip("long double has no more digits than double here")
    with np.errstate(under="ignore"):
        return np.sin(angles.astype(np.longdouble)), np.cos(angles.astype(np.longdouble))


@pytest.mark.parametrize("stratum", STRATA)
def test_blocks(stratum: str) -> None:
    angles = STRATA[stratum]
    for got, exact in zip(by_kernel(angles), reference(angles), strict=True):
        assert float(np.abs(got - exact).max()) <= BOUND


@pytest.mark.parametrize("stratum", STRATA)
def test_single_angles(stratum: str) -> None:
    angles = STRATA[stratum][:5000]
    got = np.array([sine_cosine(angle) for angle in angles]).T
    for value, exact in zip(got, reference(angles), strict=True):
        assert float(np.abs(value - exact).max()) <= BOUND


def test_small_angles_keep_their_digits() -> None:
    angles = STRATA["tiny"]
    with np.errstate(under="ignore"):
        np.testing.assert_allclose(by_kernel(angles)[0], np.sin(angles), rtol=4e-16, atol=0)


def test_angles_that_are_not_finite_give_nan_and_harm_no_neighbour() -> None:
    angles = np.linspace(-3.0, 3.0, 64)
    clean = np.array(by_kernel(angles))
    spoilt = angles.copy()
    spoilt[[0, 20, 63]] = np.inf, np.nan, -np.inf
    got = np.array(by_kernel(spoilt))
    assert np.isnan(got[:, [0, 20, 63]]).all()
    np.testing.assert_array_equal(np.delete(got, [0, 20, 63], axis=1), np.delete(clean, [0, 20, 63], axis=1))
    assert np.isnan(sine_cosine(np.nan)).all()
