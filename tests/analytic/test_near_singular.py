"""Near singular wrists no branch is lost, and at singular ones the joints stay where they are.

Every answer is measured by the chain's own forward kinematics; what is expected is the posture that made the target.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import Chain, random_configurations

QUARTER = math.pi / 2
PIEPER = ((0, QUARTER, 0.3), (0.4, 0, 0), (0, QUARTER, 0.1), (0, -QUARTER, 0.4), (0, QUARTER, 0), (0, 0, 0.08))
WRIST = 4  # the column of the joint whose zero or half turn makes two axes one
FAMILIES = [("ur5", 0.0), ("ur5", math.pi), ("pieper", 0.0), ("pieper", math.pi), ("jaco2", math.pi)]
OFFSETS = [0.0, *(sign * 10.0**-k for k in range(3, 13) for sign in (1.0, -1.0))]
COUNT = 12


@cache
def chain_named(name: str) -> Chain:
    if name == "pieper":
        return nk.DHChain.from_table([nk.DHRow(a, alpha, d, 0.0) for a, alpha, d in PIEPER], convention="standard")
    return nk.load(name).chain("arm")


def turned(angles: np.ndarray) -> np.ndarray:
    return np.abs(np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi)


def near(name: str, value: float, offset: float, seed: int) -> tuple[Chain, np.ndarray]:
    chain = chain_named(name)
    Q = random_configurations(chain, COUNT, np.random.default_rng(seed))
    Q[:, WRIST] = value + offset
    return chain, Q


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize(("name", "value"), FAMILIES)
def test_the_branch_of_the_posture_is_always_there(name: str, value: float, offset: float) -> None:
    chain, Q = near(name, value, offset, 11)
    for q in Q:
        T = chain.pose(q)
        found = nk.solve_all(chain, T)
        assert found
        assert all(np.abs(chain.pose(r.q).homogeneous - T.homogeneous).max() <= 1e-9 for r in found)
        away = np.array([turned(result.q - q) for result in found])
        assert away[:, 0].min() <= 1e-6  # the shoulder's branch, or its continuum
        if abs(offset) >= 1e-7:
            assert away.max(axis=1).min() <= 1e-6


@pytest.mark.parametrize(("name", "value"), FAMILIES[:4])  # of a bent wrist a rounded double root may be gone
def test_rounded_targets_keep_the_branch_within_tolerance(name: str, value: float) -> None:
    chain, Q = near(name, value, 0.0, 12)
    for q in Q:
        T = chain.pose(q).homogeneous.astype(np.float32).astype(np.float64)
        U, _, Vt = np.linalg.svd(T[:3, :3])
        T[:3, :3] = U @ Vt
        found = nk.solve_all(chain, T)
        assert found
        assert min(turned(result.q - q)[0] for result in found) <= 1e-3
        for result in found:
            assert np.abs(chain.pose(result.q).homogeneous - T).max() <= 1.5e-6


@pytest.mark.parametrize("offset", [0.0, 1e-10, 1e-8, 1e-6])
@pytest.mark.parametrize(("name", "value"), FAMILIES)
def test_a_batch_says_what_single_calls_say(name: str, value: float, offset: float) -> None:
    chain, Q = near(name, value, offset, 13)
    poses = chain.poses(Q)
    many = nk.solve_all_batch(chain, poses)
    assert many.found.sum(axis=1).tolist() == [len(nk.solve_all(chain, T)) for T in poses]


@pytest.mark.parametrize("offset", [0.0, 1e-9, 1e-7])
@pytest.mark.parametrize(("name", "value"), FAMILIES)
def test_an_arm_that_is_there_stays(name: str, value: float, offset: float) -> None:
    chain, Q = near(name, value, offset, 14)
    poses = chain.poses(Q)
    for q, T in zip(Q, poses, strict=True):
        result = nk.solve(chain, T, q, method="closed")
        assert result.solved
        assert np.abs(result.q - q).max() <= 1e-6
    many = nk.solve_batch(chain, poses, Q, method="closed")
    assert many.solved.all()
    assert np.abs(many.q - Q).max() <= 1e-6


def test_a_target_beside_a_singular_wrist_is_not_called_impossible() -> None:
    chain = chain_named("ur5")
    for tip in ("ee_link", "tool0"):
        chain = nk.load("ur5").chain("base_link", tip)
        T = chain.pose([1.2, 0.03, 0.03, -1.06, 3e-8, 0.3])
        assert nk.solve_all(chain, T).solved
        assert nk.solve(chain, T, method="closed").solved


def test_whole_turns_count_where_a_joint_has_to_make_them() -> None:
    chain, rng = chain_named("ur5"), np.random.default_rng(15)
    for q in random_configurations(chain, 40, rng):
        start = np.clip(q + rng.uniform(-0.1, 0.1, 6), chain.lower, chain.upper)
        every = nk.solve_all(chain, chain.pose(q), windings=True)
        assert np.abs(nk.nearest(every, start).q - start).max() <= 0.1 + 1e-9
