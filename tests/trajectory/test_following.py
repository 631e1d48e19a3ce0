"""Following paths on one branch and in time, and how it ends where that does not go on."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.causes import Cause
from tests.conftest import robot

ARM = robot("jaco2").chain("arm")
Q0 = np.radians([180, 200, 120, 100, 80, 30])


def line(length: float, samples: int) -> list[pin.SE3]:
    T = ARM.pose(Q0)
    return [pin.SE3(T.rotation, T.translation + np.array([0, 0, -length * s])) for s in np.linspace(0, 1, samples)]


def test_a_straight_line_stays_on_its_branch() -> None:
    path = line(0.1, 101)
    found = nk.follow(ARM, path, Q0)
    assert found.completed, found.reason
    assert found.q.shape == (101, 6)
    assert np.abs(np.diff(found.q, axis=0)).max() == found.largest_move < 0.05
    worst = max(np.linalg.norm(ARM.pose(q).translation - T.translation) for q, T in zip(found.q, path, strict=True))
    assert worst <= found.max_position_error * (1 + 1e-6) + 1e-15 <= 1.1e-6
    back = nk.follow(ARM, path[::-1], found.q[-1])
    np.testing.assert_allclose(back.q[::-1], found.q, atol=1e-6)


def test_a_jump_ends_it_with_joint_and_sample() -> None:
    path = [*line(0.02, 5), ARM.pose(Q0 + 0.9)]
    found = nk.follow(ARM, path, Q0)
    assert not found.completed
    assert len(found.q) == 5
    assert "ample 5" in found.reason
    assert nk.follow(ARM, line(0.05, 3), Q0, jump=1e-3).reason.startswith("At sample 1 joint_")


def test_leaving_the_reach_ends_it_with_the_reason() -> None:
    found = nk.follow(ARM, line(3.0, 601), Q0)
    assert 0 < len(found.q) < 601
    assert found.status in (nk.Status.OUT_OF_REACH, nk.Status.STALLED)
    assert found.cause in (Cause.OUT_OF_REACH, Cause.SINGULARITY, Cause.LIMIT)
    assert found.ended_at == len(found.q)
    assert f"ample {found.ended_at} " in found.reason
    assert found.largest_move_at < 601


def test_bad_paths_are_named() -> None:
    with pytest.raises(InvalidInputError, match="path"):
        nk.follow(ARM, [], Q0)
    with pytest.raises(InvalidInputError, match="jump"):
        nk.follow(ARM, line(0.1, 2), Q0, jump=0.0)
    with pytest.raises(InvalidInputError, match="target"):
        nk.follow(ARM, [np.full((4, 4), np.nan)], Q0)


def straight(T: pin.SE3, by: np.ndarray, turn: np.ndarray | None = None) -> nk.PoseLine:
    turned = T.rotation if turn is None else T.rotation @ pin.exp3(turn)
    return nk.PoseLine(T, pin.SE3(turned, T.translation + by))


@pytest.mark.parametrize("by", [[0, 0, -0.3], [-0.3, 0, 0], [0, 0.1, -0.2], [0.05, -0.1, -0.2]])
def test_five_hundred_samples_of_a_straight_line(by: list[float]) -> None:
    """Errors by Pinocchio's forward kinematics on the whole robot, not by what `follow` reports."""
    line = straight(ARM.pose(Q0), np.array(by))
    seconds = np.linspace(0.0, 4.0, 500)
    found = nk.follow(ARM, [line.target(s) for s in np.linspace(0, 1, 500)], Q0, times=seconds, scale=True)
    assert found.completed, found.reason
    robot_, names = robot("jaco2"), ARM.joint_names
    for q, share in zip(found.q, np.linspace(0, 1, 500), strict=True):
        T = robot_.pose(dict(zip(names, q.tolist(), strict=True)), ARM.tip, ARM.base)
        assert np.linalg.norm(T.translation - (line.start.translation + share * np.array(by))) < 1e-6
        assert np.abs(pin.log3(T.rotation.T @ line.start.rotation)).max() < 1e-6
    assert found.max_position_error < 1e-6
    assert np.abs(np.diff(found.q, axis=0)).max() == found.largest_move < 0.02
    assert found.trajectory is not None
    speeds = np.abs(found.trajectory.velocities)
    assert (speeds <= ARM.max_velocity * (1 + 1e-9)).all()
    assert (ARM.lower <= found.q).all()
    assert (found.q <= ARM.upper).all()


def test_speeds_are_named_and_slowed_on_request() -> None:
    path = nk.timed(straight(ARM.pose(Q0), np.array([0, 0, -0.3])), speed=0.6, acceleration=3.0)
    hasty = nk.follow(ARM, path, Q0)
    assert hasty.completed
    assert hasty.demand is not None
    assert not hasty.demand.kept
    assert "needs a speed of" in hasty.reason
    assert hasty.slowed == 1.0
    slow = nk.follow(ARM, path, Q0, scale=True, max_acceleration=2.0)
    assert slow.demand is not None
    assert slow.demand.kept
    assert slow.reason == f"All {len(path.times)} samples are reached."
    assert slow.slowed > 1.5
    np.testing.assert_array_equal(slow.q, hasty.q)


def test_between_samples_the_tip_stays_near_the_path() -> None:
    """The error between samples falls with the square of their distance; it is measured here by a fine resampling."""
    line = straight(ARM.pose(Q0), np.array([0, 0, -0.2]), np.array([0.0, 0, 0.2]))
    errors = []
    for count in (26, 51):
        shares = np.linspace(0, 1, count)
        found = nk.follow(ARM, [line.target(s) for s in shares], Q0)
        assert found.completed, found.reason
        worst = 0.0
        for share in np.linspace(0, 1, 401):
            q = np.array([np.interp(share, shares, column) for column in found.q.T])
            worst = max(worst, float(np.linalg.norm(ARM.pose(q).translation - line.target(share).goal[:3, 3])))
        assert found.position_error_between == pytest.approx(worst, rel=0.05)
        assert 0 < found.rotation_error_between < 0.01
        errors.append(worst)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)


def test_every_line_to_a_limit_ends_there() -> None:
    """Postures with one joint just inside its limit, and the tip going on as that joint turns outwards."""
    rng, named = np.random.default_rng(3), 0
    for k in range(120):
        joint, upper = 1 + k % 2, k % 4 < 2
        q = np.array([*rng.uniform(-1, 1, 6)]) + np.radians([180, 200, 120, 100, 80, 30])
        end = (ARM.upper if upper else ARM.lower)[joint]
        q[joint] = end - np.sign(upper - 0.5) * 0.02
        singular = np.linalg.svd(ARM.jacobian(q), compute_uv=False)
        if singular[-1] < 0.1:
            continue
        beyond = q.copy()
        beyond[joint] += np.sign(upper - 0.5) * 0.04
        path = nk.PoseLine(ARM.pose(q), ARM.pose(beyond))
        found = nk.follow(ARM, [path.target(s) for s in np.linspace(0, 1, 81)], q)
        assert found.cause is Cause.LIMIT, found.reason
        side = "upper" if upper else "lower"
        assert f"ample {found.ended_at} " in found.reason
        assert f"joint_{joint + 1} is at its {side} limit {end:.6g}" in found.reason
        assert found.ended_at is not None
        assert 30 < found.ended_at < 50
        named += 1
    assert named >= 8


def singular(rng: np.random.Generator) -> np.ndarray:
    """Joints inside the limits at which det J = 0, by bisection along the fifth joint."""
    while True:
        q = rng.uniform(np.maximum(ARM.lower, -3) + 0.6, np.minimum(ARM.upper, 5) - 0.6)
        angles = np.linspace(-3, 3, 61)
        signs = []
        for angle in angles:
            q[4] = angle
            signs.append(np.sign(np.linalg.det(ARM.jacobian(q))))
        change = np.flatnonzero(np.diff(signs))
        if len(change):
            low, high, sign = angles[change[0]], angles[change[0] + 1], signs[change[0]]
            for _ in range(50):
                q[4] = (low + high) / 2
                low, high = (q[4], high) if np.sign(np.linalg.det(ARM.jacobian(q))) == sign else (low, q[4])
            return q


def test_lines_beyond_a_fold_end_at_the_singularity(rng: np.random.Generator) -> None:
    """Where a branch folds, the tip can be on one side of its image only.

    The joints that do not move the tip at the singularity, turned a little either way, bring it to the same side of
    what is lost there. Each path comes from one of them, reaches the fold, and goes on to the other side.
    """
    folds = 0
    for _ in range(30):
        q = singular(rng)
        left, _, right = np.linalg.svd(ARM.jacobian(q))
        T, lost, free = ARM.pose(q), left[:, -1], right[-1]
        bent = [lost @ displacement(T, ARM.pose(q + step * free)) for step in (0.05, -0.05)]
        if min(np.abs(bent)) < 1e-5 or bent[0] * bent[1] < 0.0:
            continue  # no fold, or one too flat to tell
        beyond = -np.sign(bent[0]) * 0.3 * lost
        last = pin.SE3(pin.exp3(beyond[3:]) @ T.rotation, T.translation + beyond[:3])
        there, onward = nk.PoseLine(ARM.pose(q + 0.2 * free), T), nk.PoseLine(T, last)
        shares = np.linspace(0, 1, 100)
        path = [there.target(s) for s in shares] + [onward.target(s) for s in shares[1:]]
        found = nk.follow(ARM, path, q + 0.2 * free)
        assert not found.completed
        assert found.cause in (Cause.SINGULARITY, Cause.LIMIT), found.reason
        assert f"ample {found.ended_at} " in found.reason
        assert found.ended_at is not None
        assert found.ended_at <= 130
        assert np.abs(np.diff(found.q, axis=0)).max(initial=0.0) <= 0.5
        if found.cause is Cause.SINGULARITY:
            assert "smallest singular value" in found.reason
            folds += 1
    assert folds >= 8


def displacement(one: pin.SE3, other: pin.SE3) -> np.ndarray:
    """Shift and rotation vector from one pose to another (6,), base axes."""
    return np.concatenate([other.translation - one.translation, pin.log3(other.rotation @ one.rotation.T)])


def test_coupled_limits_end_a_path_too() -> None:
    head = robot("nao").chain("torso", "Head")
    pitch = [nk.Target.orientation(head.pose([0.9, p]).rotation) for p in np.linspace(0.0, 0.5, 60)]
    found = nk.follow(head, pitch, [0.9, 0.0])
    (rule,) = [rule for rule in head.limit_rules if rule.joint == "HeadPitch"]
    assert found.cause is Cause.LIMIT, found.reason
    assert f"HeadPitch is at its upper limit {rule.range(0.9)[1]:.6g}" in found.reason


def test_other_kinds_of_targets_and_times() -> None:
    arm = robot("nao").chain("left_arm")
    q0 = np.array([0.3, 0.2, -0.5, -0.8, 0.4])
    p = arm.pose(q0).translation
    axis = arm.pose(q0).rotation[:, 0]
    line = nk.PositionLine(p, p + np.array([0.0, 0.02, 0.03]))
    for path in (
        nk.timed(line, speed=0.05, acceleration=0.2, sampling=0.05),
        [nk.Target.pointing(p + np.array([0, 0, s]), axis) for s in np.linspace(0, 0.02, 15)],
    ):
        found = nk.follow(arm, path, q0)
        assert found.completed, found.reason
        assert found.position_error_between < 1e-3
    assert found.trajectory is None
    assert found.demand is None
    single = nk.follow(arm, [p], q0)
    assert single.completed
    assert single.slowed == 1.0


def test_bad_times_and_limits_are_named() -> None:
    path = line(0.02, 3)
    for times in ([0, 1], [0, 1, 1], [0, 2, 1], [0, 1, np.nan]):
        with pytest.raises(InvalidInputError, match="times"):
            nk.follow(ARM, path, Q0, times=times)
    with pytest.raises(InvalidInputError, match="scale"):
        nk.follow(ARM, path, Q0, scale=True)
    with pytest.raises(InvalidInputError, match="max_velocity of joint_1"):
        nk.follow(ARM, path, Q0, times=[0, 1, 2], max_velocity=0.0)
    with pytest.raises(InvalidInputError, match="max_acceleration"):
        nk.follow(ARM, path, Q0, times=[0, 1, 2], max_acceleration=[1.0])
    timed = nk.timed(nk.PositionLine([0.3, 0, 0.5], [0.3, 0, 0.6]), speed=0.1, acceleration=1.0)
    with pytest.raises(InvalidInputError, match="none for a path that has its own"):
        nk.follow(ARM, timed, Q0, times=timed.times)
