"""Forward kinematics to twice the digits, and the last digits of joints near a singularity."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from nao_kin.kernels.extended import extended_tip, refine
from nao_kin.kernels.motion import packed_joints
from tests.conftest import robot


def sine_cosine(angle: Fraction) -> tuple[Fraction, Fraction]:
    """Taylor's series in exact arithmetic."""
    s, c, term = Fraction(0), Fraction(0), Fraction(1)
    for n in range(1, 80):
        c, s = (c + term, s) if n % 2 else (c, s + term)
        term *= angle / n * (1 if n % 2 else -1)
        term = term.limit_denominator(10**45)
    return s, c


def exact_tip(joints: np.ndarray, q: np.ndarray) -> list[list[Fraction]]:
    """The product of a chain's transforms in exact arithmetic, rows (3, 4)."""
    rows = [[Fraction(int(a == b)) for b in range(4)] for a in range(3)]
    for k, joint in enumerate(joints):
        R = [[Fraction(joint[3 * a + b]) for b in range(3)] for a in range(3)]
        t = [Fraction(v) for v in joint[9:12]]
        rows = [
            [sum(row[a] * R[a][b] for a in range(3)) for b in range(3)]
            + [sum(row[a] * t[a] for a in range(3)) + row[3]]
            for row in rows
        ]
        if k + 1 < len(joints):
            s, c = sine_cosine(Fraction(joint[14]) * Fraction(q[k]) + Fraction(joint[15]))
            rows = [[c * x + s * y, c * y - s * x, z, p] for x, y, z, p in rows]
        rows = [[v.limit_denominator(10**40) for v in row] for row in rows]
    return rows


@pytest.mark.parametrize("scale", [1e-9, 0.7, np.pi, 6.0])
def test_it_is_the_product_to_thirty_times_the_digits_that_a_float_has_left(
    scale: float, rng: np.random.Generator
) -> None:
    joints, axes, X = packed_joints(robot("jaco2").chain("arm").joint_path), np.empty((6, 6)), np.empty((3, 4, 2))
    for _ in range(5):
        q = rng.uniform(-scale, scale, 6)
        extended_tip(joints, q, axes, X)
        exact = exact_tip(joints, q)
        for a in range(3):
            for b in range(4):
                assert abs(Fraction(X[a, b, 0]) + Fraction(X[a, b, 1]) - exact[a][b]) < 5e-18


def test_joints_near_a_singularity_come_back_to_the_last_digit(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    joints, W, X = packed_joints(chain.joint_path), np.empty((4, 6, 6)), np.empty((3, 4, 2))
    for _ in range(10):
        q = rng.uniform(-np.pi, np.pi, 6)
        value = np.linalg.svd(chain.jacobian(q), compute_uv=False)[-1]
        found = q + 1e-14 / value * rng.uniform(-1.0, 1.0, 6)
        refine(joints, chain.poses(q[None])[0], found, W, X)
        assert np.abs(found - q).max() < 1e-15 + 1e-15 / value
