"""Motions in joint space, and slowing motions down."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.demand import demand_of
from nao_kin.trajectory.following import slowed
from nao_kin.trajectory.joint_space import joint_profiles
from tests.conftest import robot

ARM = robot("jaco2").chain("arm")
RATES = np.array([1.0, 1.5, 2.0, 3.0, 3.0, 4.0])


def pairs(count: int, seed: int) -> list[tuple[np.ndarray, np.ndarray]]:
    rng = np.random.default_rng(seed)
    return list(zip(random_configurations(ARM, count, rng), random_configurations(ARM, count, rng), strict=True))


@pytest.mark.parametrize("straight", [False, True])
def test_joints_arrive_together_within_their_limits(straight: bool) -> None:
    for a, b in pairs(30, 1):
        motion = nk.joint_motion(ARM, a, b, acceleration=RATES, braking=RATES / 2, straight=straight)
        np.testing.assert_array_equal(motion.q[0], a)
        np.testing.assert_array_equal(motion.q[-1], b)
        assert motion.joints == ARM.joints
        demand = demand_of(motion, max_acceleration=RATES)
        assert demand.kept, demand.faults
        profiles = joint_profiles(ARM, a, b, acceleration=RATES, braking=RATES / 2, straight=straight)
        assert max(p.duration for p in profiles) == pytest.approx(motion.duration, abs=1e-12)
        share = (motion.q - a) / (b - a)
        if straight:
            np.testing.assert_allclose(share, share[:, :1] * np.ones(6), atol=1e-9)
        else:
            alone = [
                nk.Trapezoid(s, e, max_velocity=v, acceleration=r, braking=r / 2).duration
                for s, e, v, r in zip(a.tolist(), b.tolist(), ARM.max_velocity.tolist(), RATES.tolist(), strict=True)
            ]
            assert motion.duration == pytest.approx(max(alone), abs=1e-9)


def test_a_joint_that_stays_stays() -> None:
    a, b = pairs(1, 2)[0]
    b = b.copy()
    b[2] = a[2]
    for straight in (False, True):
        motion = nk.joint_motion(ARM, a, b, acceleration=1.0, straight=straight)
        assert (motion.q[:, 2] == a[2]).all()
    assert len(nk.joint_motion(ARM, a, a, acceleration=1.0, straight=True)) == 1


def test_what_makes_no_sense_is_named() -> None:
    a, b = pairs(1, 3)[0]
    with pytest.raises(InvalidInputError, match="acceleration of joint_1"):
        nk.joint_motion(ARM, a, b, acceleration=0.0)
    with pytest.raises(InvalidInputError, match="max_velocity of joint_2"):
        nk.joint_motion(ARM, a, b, acceleration=1.0, max_velocity=[1, -1, 1, 1, 1, 1])
    with pytest.raises(InvalidInputError, match="6 numbers"):
        nk.joint_motion(ARM, a[:5], b, acceleration=1.0)
    table = nk.document_chain("practicum_jaco2")
    with pytest.raises(InvalidInputError, match="a speed for joint_1, "):
        nk.joint_motion(table, a, b, acceleration=1.0)


def wavy(seed: int, count: int = 300) -> nk.Trajectory:
    """A smooth motion whose joints turn back and forth."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.008, 0.012, count))
    phases, rates = rng.uniform(0, 6, 6), rng.uniform(0.5, 3.0, 6)
    return nk.Trajectory(ARM.joints, t, rng.uniform(0.2, 1.5, 6) * np.sin(np.outer(t, rates) + phases))


@pytest.mark.parametrize("seed", range(12))
def test_slowing_down_keeps_every_limit_and_every_sample(seed: int) -> None:
    motion = wavy(seed)
    for limits in ((ARM.max_velocity, np.full(6, np.inf)), (ARM.max_velocity, RATES), (np.full(6, np.inf), RATES / 3)):
        found = slowed(motion, *limits)
        speeds = np.abs(np.diff(found.q, axis=0) / np.diff(found.times)[:, None])
        steps = np.diff(found.times)
        changes = (
            np.abs(np.diff(np.diff(found.q, axis=0) / steps[:, None], axis=0)) * 2 / (steps[1:] + steps[:-1])[:, None]
        )
        assert (speeds <= limits[0] * (1 + 1e-8)).all()
        assert (changes <= limits[1] * (1 + 1e-8)).all()
        np.testing.assert_array_equal(found.q, motion.q)
        assert (np.diff(found.times) >= np.diff(motion.times) * (1 - 1e-9)).all()
        assert found.times[0] == motion.times[0]


def test_with_speed_limits_alone_only_the_fast_steps_take_longer() -> None:
    """Then each step takes what its fastest joint needs, or as long as was planned, but for the shared samples."""
    motion = wavy(3)
    found = slowed(motion, ARM.max_velocity, np.full(6, np.inf))
    needed = (np.abs(np.diff(motion.q, axis=0)) / ARM.max_velocity).max(axis=1)
    least = np.maximum(needed, np.diff(motion.times))
    assert found.duration < least.sum() * 1.02
    used = (np.abs(found.velocities) / ARM.max_velocity).max(axis=1)
    assert np.median(used[needed > np.diff(motion.times)]) > 0.98


def test_time_is_not_wasted_on_accelerations() -> None:
    """A straight move in joint space has a known least duration, which slowing a hasty one down must come near."""
    for a, b in pairs(10, 5):
        best = nk.joint_motion(ARM, a, b, acceleration=RATES, straight=True)
        hasty = nk.Trajectory(ARM.joints, best.times * 0.3, best.q)
        found = slowed(hasty, ARM.max_velocity, RATES)
        assert demand_of(found, max_acceleration=RATES).kept
        assert found.duration < best.duration * 1.001


def test_what_is_within_its_limits_is_left_alone() -> None:
    a, b = pairs(1, 6)[0]
    motion = nk.joint_motion(ARM, a, b, acceleration=RATES)
    assert slowed(motion, ARM.max_velocity, RATES) is motion
    single = nk.Trajectory(ARM.joints, [0.0], [a])
    assert slowed(single, ARM.max_velocity, RATES) is single
    assert demand_of(single).kept
