"""Two feet and one motor for the first hip joints: what is given up, and that no less could be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.chain import into_limits, outside_limits, random_configurations
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.problem import Status
from nao_kin.motion.nao.feet import FeetResult, both_feet
from nao_kin.se3 import from_xyz_rpy
from tests.conftest import robot

if TYPE_CHECKING:
    from nao_kin.chain import Chain

LEFT, RIGHT = "l_sole", "r_sole"


def legs(name: str = "nao") -> tuple[Chain, Chain]:
    return robot(name).chain("torso", LEFT), robot(name).chain("torso", RIGHT)


def bent(chain: Chain, rng: np.random.Generator, count: int) -> np.ndarray:
    """Configurations (count, 6) with bent knees, well inside the limits."""
    middle, Q = 0.5 * (chain.lower + chain.upper), random_configurations(chain, count, rng)
    Q = middle + 0.6 * (Q - middle)
    Q[:, 3] = rng.uniform(0.4, 1.5, count)
    return np.array([into_limits(chain, q) for q in Q])


def measured_cost(result: FeetResult, q: np.ndarray, weights: tuple[float, float] = (1.0, 1.0)) -> float:
    """Weighted squared angles of both feet [rad²] at the eleven joints q: shared, left five, right five."""
    cost = 0.0
    for foot, own, weight in ((result.left, q[1:6], weights[0]), (result.right, q[6:], weights[1])):
        R = foot.problem.chain.pose(np.concatenate([q[:1], own])).rotation
        cost += weight * float(np.linalg.norm(pin.log3(R @ foot.problem.target.goal[:3, :3].T))) ** 2
    return cost


def test_feet_that_agree_are_both_met(rng: np.random.Generator) -> None:
    left, right = legs()
    for q_left, q_right in zip(bent(left, rng, 50), bent(right, rng, 50), strict=True):
        q_right[0] = q_left[0]
        result = both_feet(left, right, left.pose(q_left), right.pose(q_right))
        assert result.solved
        assert max(result.position_errors) < 1e-12
        assert max(result.rotation_errors) < 1e-9
        assert result.shared == pytest.approx(q_left[0], abs=1e-9)
        assert result.left.q == pytest.approx(q_left, abs=1e-8)
        assert result.right.q == pytest.approx(q_right, abs=1e-8)
        posture = result.posture
        assert posture["LHipYawPitch"] == posture["RHipYawPitch"] == result.shared
        for tip, chain, q in ((LEFT, left, q_left), (RIGHT, right, q_right)):  # the whole robot takes the posture
            assert np.abs(robot("nao").pose(posture, tip).translation - chain.pose(q).translation).max() < 1e-9


@pytest.mark.parametrize("weights", [(1.0, 1.0), (3.0, 1.0)])
def test_positions_are_kept_and_no_motion_of_the_joints_does_better(
    weights: tuple[float, float], rng: np.random.Generator
) -> None:
    """Along all directions that keep both positions, the measured cost has no slope: Pinocchio's Jacobians say."""
    left, right = legs()
    compared = 0
    for q_left, q_right in zip(bent(left, rng, 30), bent(right, rng, 30), strict=True):
        q_right[0] = np.clip(q_left[0] + rng.uniform(-0.5, 0.5), right.lower[0], right.upper[0])
        result = both_feet(left, right, left.pose(q_left), right.pose(q_right), weights=weights)
        assert max(result.position_errors) < 1e-12
        assert result.wanted == pytest.approx((q_left[0], q_right[0]), abs=1e-9)
        assert min(result.wanted) <= result.shared <= max(result.wanted)
        assert result.left.q[0] == result.right.q[0] == result.shared
        if result.outside:
            continue
        q = np.concatenate([result.left.q, result.right.q[1:]])
        J_left, J_right = left.jacobian(result.left.q), right.jacobian(result.right.q)
        positions = np.zeros((6, 11))
        positions[:3, :6], positions[3:, 0], positions[3:, 6:] = J_left[:3], J_right[:3, 0], J_right[:3, 1:]
        free = np.linalg.svd(positions)[2][6:]
        for direction in free:
            step = 1e-4 * direction
            slope = (measured_cost(result, q + step, weights) - measured_cost(result, q - step, weights)) / 2e-4
            assert abs(slope) < 1e-5 + 1e-4 * measured_cost(result, q, weights)
        compared += 1
    assert compared >= 20


def test_a_leg_that_is_nearly_straight_keeps_its_position_too(rng: np.random.Generator) -> None:
    """Its ankle cannot go farther from the hip, which leaves fewer orientations to choose from."""
    left, right = legs()
    stretched = 0
    for q_left, q_right in zip(bent(left, rng, 60), bent(right, rng, 60), strict=True):
        q_left[3], q_right[3] = rng.uniform(0.0, 0.3, 2)
        q_left, q_right = into_limits(left, q_left), into_limits(right, q_right)
        result = both_feet(left, right, left.pose(q_left), right.pose(q_right))
        assert max(result.position_errors) < 1e-12
        stretched += min(abs(result.left.q[3]), abs(result.right.q[3])) < 1e-9
    assert stretched > 5


def test_the_foot_that_counts_alone_is_met(rng: np.random.Generator) -> None:
    left, right = legs()
    for q_left, q_right in zip(bent(left, rng, 10), bent(right, rng, 10), strict=True):
        q_right[0] = np.clip(q_left[0] + rng.uniform(-0.1, 0.1), right.lower[0], right.upper[0])
        wanted = left.pose(q_left), right.pose(q_right)
        first = both_feet(left, right, *wanted, weights=(1.0, 0.0))
        second = both_feet(left, right, *wanted, weights=(0.0, 1.0))
        assert first.rotation_errors[0] < 1e-6
        assert second.rotation_errors[1] < 1e-6


def test_left_and_right_may_be_exchanged(rng: np.random.Generator) -> None:
    left, right = legs()
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    for q_left, q_right in zip(bent(left, rng, 10), bent(right, rng, 10), strict=True):
        T_left, T_right = left.pose(q_left).homogeneous, right.pose(q_right).homogeneous
        here = both_feet(left, right, T_left, T_right)
        there = both_feet(left, right, mirror @ T_right @ mirror, mirror @ T_left @ mirror)
        if here.outside or there.outside:
            continue  # the two sides' ranges differ a little
        assert there.shared == pytest.approx(here.shared, abs=1e-6)
        assert there.rotation_errors == pytest.approx(here.rotation_errors[::-1], abs=1e-6)


def test_limits_and_coupled_limits_are_kept_where_they_can_be(rng: np.random.Generator) -> None:
    """The feet want angles at which the ankles are near the ends of their coupled ranges."""
    left, right = legs()
    kept = 0
    for _ in range(40):
        q_left, q_right = (random_configurations(chain, 1, rng)[0] for chain in (left, right))
        q_left[3], q_right[3] = rng.uniform(0.3, 1.8, 2)
        for q, chain in ((q_left, left), (q_right, right)):
            q[4], q[5] = rng.uniform(0.1, 0.9), chain.upper[5] if chain is left else chain.lower[5]
        q_left, q_right = into_limits(left, q_left), into_limits(right, q_right)
        result = both_feet(left, right, left.pose(q_left), right.pose(q_right))
        assert result.left.outside == outside_limits(left, result.left.q, 1e-9)
        assert left.lower[0] - 1e-12 <= result.shared <= left.upper[0] + 1e-12
        kept += not result.outside
        if result.outside:
            assert "is outside" in result.message
            assert not result.solved
    assert kept >= 10


def test_a_shared_angle_beyond_its_range_ends_at_it() -> None:
    left, right = legs()
    q = np.array([left.upper[0] + 0.2, 0.0, -0.6, 1.0, -0.4, 0.0])
    result = both_feet(left, right, left.pose(q), right.pose(q))
    assert result.wanted == pytest.approx((q[0], q[0]), abs=1e-9)
    assert result.shared == pytest.approx(left.upper[0], abs=1e-12)
    assert not result.solved
    assert max(result.position_errors) < 1e-12
    assert 0.01 < max(result.rotation_errors) < 0.3


def test_a_foot_out_of_reach_is_a_value_that_says_so() -> None:
    left, right = legs()
    stand = np.array([0.0, 0.0, -0.4, 0.8, -0.4, 0.0])
    far = from_xyz_rpy((0.0, 0.05, -0.085 - 0.1 - 0.1029 - 0.04511 - 0.03))  # 3 cm below the outstretched leg
    result = both_feet(left, right, far, right.pose(stand))
    assert not result.solved
    assert result.left.status is Status.OUT_OF_REACH
    assert result.left.run.misses_by == pytest.approx(0.03, abs=1e-4)
    assert result.position_errors[0] == pytest.approx(0.03, abs=1e-4)
    assert result.right.solved
    assert "left foot is off by 0.03" in result.message


def test_near_chooses_among_branches() -> None:
    left, right = legs()
    back = np.array([0.0, 0.0, 0.05, -0.06, 0.01, 0.0])  # NAO's knee bends the other way a little
    poses = left.pose(back), right.pose(back)
    ahead = both_feet(left, right, *poses, near={"LKneePitch": 0.3, "RKneePitch": 0.3})
    behind = both_feet(left, right, *poses, near={"LKneePitch": -0.09, "RKneePitch": -0.09})
    assert ahead.solved
    assert behind.solved
    assert (ahead.left.q[3], behind.left.q[3]) == pytest.approx((0.06, -0.06), abs=1e-9)
    assert "knee +" in ahead.left.branch
    assert "knee −" in behind.left.branch


def test_misuse_is_named() -> None:
    left, right = legs()
    T_left, T_right = left.pose(np.zeros(6)), right.pose(np.zeros(6))
    with pytest.raises(InvalidInputError, match="weights"):
        both_feet(left, right, T_left, T_right, weights=(0.0, 0.0))
    with pytest.raises(InvalidInputError, match="weights"):
        both_feet(left, right, T_left, T_right, weights=(-1.0, 1.0))
    with pytest.raises(InvalidInputError, match="left leg"):
        both_feet(robot("nao").chain("left_arm"), right, T_left, T_right)
    with pytest.raises(InvalidInputError, match="right leg"):
        both_feet(left, robot("nao").chain("right_arm"), T_left, T_right)
    with pytest.raises(InvalidInputError, match="runs from the foot to the torso"):
        both_feet(robot("nao").chain("l_sole", "torso"), robot("nao").chain("l_sole", "r_sole"), T_left, T_right)
    with pytest.raises(InvalidInputError, match="bases"):
        both_feet(left, robot("nao").chain("LHip", "RLeg"), T_left, T_right)
    with pytest.raises(InvalidInputError, match="T_base_right"):
        both_feet(left, right, T_left, np.full((4, 4), math.nan))
    with pytest.raises(UnknownNameError, match="LKneePitch"):
        both_feet(left, right, T_left, T_right, near={"LKneePich": 0.0})
    with pytest.raises(TypeError, match=r"result\.solved"):
        bool(both_feet(left, right, T_left, T_right))
