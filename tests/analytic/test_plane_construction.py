"""The article's construction from planes says what the direct closed form says."""

from __future__ import annotations

import math

import numpy as np

from nao_kin.analytic.hexapod.body import body_ik_batch
from tests.analytic.plane_construction import body_pose, plane_construction
from tests.analytic.walkers import HIP, HIPS, SHIN, THIGH, WALKER, round_feet, round_legs


def difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs(np.remainder(a - b + math.pi, 2.0 * math.pi) - math.pi)


def test_both_ways_agree_on_ten_thousand_body_poses(rng: np.random.Generator) -> None:
    feet, legs = round_feet(), round_legs()
    poses = [body_pose(rng.uniform(-0.02, 0.02, 3), *rng.uniform(-0.25, 0.25, 3)) for _ in range(10_000)]
    by_planes = np.array([plane_construction(WALKER, T, feet) for T in poses])
    direct = body_ik_batch(legs, np.array([T.homogeneous for T in poses]), feet)
    reached = direct.solved
    assert reached.mean() > 0.999
    assert (np.isfinite(by_planes).all(axis=2) == reached).all()
    assert difference(by_planes, direct.q.reshape(-1, 6, 3))[reached].max() < 1e-12


def test_a_foot_at_any_side_of_its_leg_keeps_its_sign() -> None:
    """An arc cosine would mirror the legs of one side, and those whose foot is above their hip."""
    legs = round_legs()
    for turn in np.linspace(-2.5, 2.5, 21):
        for height in (-0.06, 0.0, 0.05):
            outwards = np.column_stack([np.cos(turn + np.arange(6)), np.sin(turn + np.arange(6)), np.zeros(6)])
            feet = HIPS + 0.1 * outwards + (0.0, 0.0, height)
            angles = plane_construction(WALKER, np.eye(4), feet)
            for chain, q, foot in zip(legs.values(), angles, feet, strict=True):
                assert np.abs(chain.pose(q).translation - foot).max() < 1e-15


def test_the_border_is_the_triangle_s(rng: np.random.Generator) -> None:
    for beyond, reached in ((-1e-9, True), (1e-9, False)):
        far = HIPS * (1.0 + (HIP + THIGH + SHIN + beyond) / np.linalg.norm(HIPS, axis=1, keepdims=True))
        near = HIPS * (1.0 + (HIP + SHIN - THIGH - beyond) / np.linalg.norm(HIPS, axis=1, keepdims=True))
        for feet in (far, near):
            angles = plane_construction(WALKER, np.eye(4), feet)
            assert (np.isfinite(angles) == reached).all()


def test_the_body_turns_about_y_first_then_x_then_z() -> None:
    T = body_pose((0.1, 0.2, 0.3), math.pi / 2, math.pi / 2, math.pi / 2)
    # x, turned about y to −z, about x to y, about z to −x.
    assert np.abs(T.rotation @ (1.0, 0.0, 0.0) - (-1.0, 0.0, 0.0)).max() < 1e-15
    assert np.abs(T.translation - (0.1, 0.2, 0.3)).max() == 0.0
