"""Lines, screws and turns, and the times at which they are walked."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import rotation_distance
from nao_kin.trajectory.instants import sample_times
from nao_kin.trajectory.paths import line_points

RATES = {"speed": 0.2, "acceleration": 0.5, "turn_speed": 1.0, "turn_acceleration": 2.0}


def poses(count: int, seed: int) -> list[tuple[pin.SE3, pin.SE3]]:
    """Pairs of poses; every fifth turn is by exactly π, every seventh pair shares its orientation."""
    rng, found = np.random.default_rng(seed), []
    for k in range(count):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        angle = math.pi if k % 5 == 0 else 0.0 if k % 7 == 0 else rng.uniform(1e-9, math.pi)
        first = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
        found.append((first, pin.SE3(first.rotation @ pin.exp3(angle * axis), rng.normal(size=3))))
    return found


@pytest.mark.parametrize("kind", [nk.PoseLine, nk.Screw])
def test_both_ends_are_met_exactly_and_without_a_step(kind) -> None:
    for first, last in poses(60, 1):
        path = kind(first, last)
        np.testing.assert_array_equal(path.target(0.0).goal, first.homogeneous)
        np.testing.assert_array_equal(path.target(1.0).goal, last.homogeneous)
        near = path.target(1.0 - 1e-12).T_base_target
        assert np.linalg.norm(near.translation - last.translation) < 1e-7
        assert rotation_distance(near, last) < 1e-7


def test_a_pose_line_is_straight_and_turns_evenly() -> None:
    for first, last in poses(60, 2):
        path = nk.PoseLine(first, last)
        for share in (0.25, 0.5, 0.8):
            T = path.target(share).T_base_target
            along = T.translation - first.translation
            np.testing.assert_allclose(along, share * (last.translation - first.translation), atol=1e-14)
            assert rotation_distance(first, T) == pytest.approx(share * path.angle, abs=1e-9)
            assert rotation_distance(T, last) == pytest.approx((1 - share) * path.angle, abs=1e-9)


def test_a_screw_has_a_constant_twist_and_is_pinocchios_interpolation() -> None:
    for first, last in poses(60, 3):
        path = nk.Screw(first, last)
        for share in (0.1, 0.5, 0.9):
            T = path.target(share).T_base_target
            np.testing.assert_allclose(T.homogeneous, pin.SE3.Interpolate(first, last, share).homogeneous, atol=1e-9)
            twist = pin.log6(T.actInv(path.target(share + 1e-3).T_base_target)).vector / 1e-3
            np.testing.assert_allclose(twist, path.twist, atol=1e-8 * (1 + np.abs(path.twist).max()))
        places = np.array([path.target(s).goal[:3, 3] for s in np.linspace(0, 1, 2001)])
        measured = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
        assert measured == pytest.approx(path.length, rel=1e-6)


def test_points_of_a_line() -> None:
    points = line_points([0, 0, 0], [1, 2, -2], 4)
    np.testing.assert_allclose(points, np.outer([0, 1 / 3, 2 / 3, 1], [1, 2, -2]))
    for bad in (1, 2.0, True):
        with pytest.raises(InvalidInputError, match="count"):
            line_points([0, 0, 0], [1, 1, 1], bad)


@pytest.mark.parametrize("kind", [nk.PoseLine, nk.Screw])
def test_a_timed_path_keeps_its_speeds_and_ends_on_time(kind) -> None:
    for first, last in poses(15, 4):
        walked = nk.timed(kind(first, last), **RATES, start_time=2.0)
        steps = np.diff(walked.times)
        assert walked.times[0] == 2.0
        assert walked.times[-1] == pytest.approx(walked.profile.end_time, abs=1e-12)
        np.testing.assert_allclose(steps[:-1], 0.01, atol=1e-12)
        assert 0.0 < steps[-1] <= 0.01 + 1e-9
        placed = [target.T_base_target for target in walked.targets]
        assert walked.shares[-1] == 1.0
        for before, after, step in zip(placed[:-1], placed[1:], steps, strict=True):
            assert np.linalg.norm(after.translation - before.translation) <= 0.2 * step * (1 + 1e-6) + 1e-9
            assert rotation_distance(before, after) <= 1.0 * step * (1 + 1e-6) + 1e-8
        assert walked.speeds.max() <= 0.2 * (1 + 1e-12)
        assert np.abs(walked.accelerations).max() <= 0.5 * (1 + 1e-12)


def test_positions_pure_turns_and_standing_still() -> None:
    line = nk.timed(nk.PositionLine([0, 0, 0], [0.5, 0, 0]), speed=0.25, acceleration=0.5, braking=0.25)
    assert line.profile.phase_times == pytest.approx((0.0, 0.5, 1.75, 2.75))
    assert {target.kind for target in line.targets} == {"position"}
    here = pin.SE3.Identity()
    turn = nk.PoseLine(here, pin.SE3(pin.exp3(np.array([0, 0, 1.0])), np.zeros(3)))
    assert nk.timed(turn, **RATES).profile.duration == pytest.approx(1.0 + 0.5)
    with pytest.raises(InvalidInputError, match="turn_speed"):
        nk.timed(turn, speed=0.2, acceleration=0.5)
    still = nk.timed(nk.PoseLine(here, here), **RATES)
    assert len(still.times) == 1
    assert rotation_distance(still.targets[0].T_base_target, here) == 0.0


def test_speeds_at_the_ends_must_leave_the_path_room() -> None:
    line = nk.PositionLine([0, 0, 0], [0.5, 0, 0])
    flying = nk.timed(line, speed=0.25, acceleration=0.5, start_speed=0.25, end_speed=0.25)
    assert flying.profile.duration == pytest.approx(2.0)
    assert flying.speeds == pytest.approx(0.25)
    with pytest.raises(InvalidInputError, match="leave room"):
        nk.timed(nk.PositionLine([0, 0, 0], [0.01, 0, 0]), speed=0.25, acceleration=0.5, start_speed=0.25)
    with pytest.raises(InvalidInputError, match="backwards"):
        nk.timed(line, speed=0.25, acceleration=0.5, start_speed=-0.1)
    with pytest.raises(InvalidInputError, match="start_velocity"):
        nk.timed(line, speed=0.25, acceleration=0.5, start_speed=0.3)


@pytest.mark.parametrize("duration", [0.0, 1e-9, 0.005, 0.01, 0.015, 0.3, 1.0, math.pi, 0.01 * 3 + 1e-12])
def test_samples_are_full_steps_and_an_exact_end(duration: float) -> None:
    times = sample_times(duration, 0.01, 5.0)
    assert times[-1] == 5.0 + duration
    assert len(times) == 1 or (np.diff(times) <= 0.01 * (1 + 1e-5)).all()
    assert (np.diff(times) > 0.0).all()


def test_samples_that_cannot_be() -> None:
    with pytest.raises(InvalidInputError, match="at most 1000000"):
        sample_times(1e6, 1e-3)
    with pytest.raises(InvalidInputError, match="start_time"):
        sample_times(1.0, 0.01, 1e18)
    for bad in (0.0, -1.0, math.nan):
        with pytest.raises(InvalidInputError, match="sampling"):
            sample_times(1.0, bad)
    with pytest.raises(InvalidInputError, match="share"):
        nk.PositionLine([0, 0, 0], [1, 0, 0]).target(1.5)
