"""Chains of robots: what they refuse, batches, and what they share with nobody."""

from __future__ import annotations

import pickle
import threading

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from tests.conftest import robot


@pytest.mark.parametrize("q", [[0.0] * 4, [0.0] * 6, [0, 0, float("nan"), 0, 0], [[0.0] * 5], "abc", [0, 0, 0, 0, 1j]])
def test_a_bad_configuration_names_the_joints_and_what_came(q: object) -> None:
    arm = robot("nao_v50_h25").chain("left_arm")
    for method in (arm.pose, arm.jacobian, arm.link_poses):
        with pytest.raises(InvalidInputError, match=r"left_arm.*LShoulderPitch.*got"):
            method(q)


def test_an_unknown_jacobian_frame_is_refused() -> None:
    with pytest.raises(InvalidInputError, match="'base' or 'tip'"):
        robot("jaco2").chain("arm").jacobian(np.zeros(6), frame="world")


def test_batches_are_the_single_calls_stacked(rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_gripper")
    Q = random_configurations(chain, 7, rng)
    np.testing.assert_allclose(chain.poses(Q), [chain.pose(q).homogeneous for q in Q], atol=1e-14, rtol=0)
    np.testing.assert_allclose(chain.jacobians(Q), [chain.jacobian(q) for q in Q], atol=1e-14, rtol=0)
    assert chain.poses(np.empty((0, 12))).shape == (0, 4, 4)
    assert chain.jacobians(np.empty((0, 12))).shape == (0, 6, 12)
    with pytest.raises(InvalidInputError, match=r"\(N, 12\)"):
        chain.poses(Q[:, :3])


def test_results_do_not_share_memory_with_pinocchio() -> None:
    chain = robot("jaco2").chain("arm")
    first = chain.pose(np.zeros(6))
    before = first.homogeneous.copy()
    chain.pose(np.ones(6))
    np.testing.assert_array_equal(first.homogeneous, before)
    J = chain.jacobian(np.zeros(6))
    kept = J.copy()
    chain.jacobian(np.ones(6))
    np.testing.assert_array_equal(J, kept)
    with pytest.raises(ValueError, match="read-only"):
        chain.lower[0] = 0.0


def test_a_chain_may_be_shared_between_threads(rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_gripper")
    Q = random_configurations(chain, 400, rng)
    expected = chain.poses(Q)
    found: list[np.ndarray] = []
    threads = [threading.Thread(target=lambda: found.append(chain.poses(Q))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(poses, expected) for poses in found)
    assert len(found) == 4


def test_robots_and_chains_survive_pickling() -> None:
    chain = pickle.loads(pickle.dumps(robot("nao_v50_h25").chain("left_arm")))  # noqa: S301 - our own bytes
    np.testing.assert_array_equal(
        chain.pose(np.full(5, 0.1)).homogeneous,
        robot("nao_v50_h25").chain("left_arm").pose(np.full(5, 0.1)).homogeneous,
    )


def test_half_open_and_huge_ranges_are_sampled(rng: np.random.Generator) -> None:
    rows = [
        {"a": 1, "alpha": 0, "d": 0, "theta": 0} | limits
        for limits in ({"lower": 4.0}, {"upper": -4.0}, {"upper": 1e308, "lower": -1e308})
    ]
    Q = random_configurations(nk.DHChain.from_table(rows, "standard"), 500, rng)
    assert (Q[:, 0].min(), Q[:, 0].max()) == (pytest.approx(4.0, abs=0.1), pytest.approx(4.0 + 2 * np.pi, abs=0.1))
    assert (Q[:, 1].min(), Q[:, 1].max()) == (pytest.approx(-4.0 - 2 * np.pi, abs=0.1), pytest.approx(-4.0, abs=0.1))
    assert np.abs(Q[:, 2]).max() == pytest.approx(np.pi, abs=0.1)
