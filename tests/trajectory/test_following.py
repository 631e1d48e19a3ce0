"""Following a path on one branch, and moving targets to the border."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.errors import InvalidInputError
from nao_kin.ik.target import Target
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
    assert f"ample {len(found.q)} " in found.reason
    assert found.largest_move_at < 601


def test_bad_paths_are_named() -> None:
    with pytest.raises(InvalidInputError, match="path"):
        nk.follow(ARM, [], Q0)
    with pytest.raises(InvalidInputError, match="jump"):
        nk.follow(ARM, line(0.1, 2), Q0, jump=0.0)
    with pytest.raises(InvalidInputError, match="target"):
        nk.follow(ARM, [np.full((4, 4), np.nan)], Q0)


@pytest.mark.parametrize("away", [1e-3, 0.3, 100.0])
def test_a_target_is_moved_to_the_border(away: float) -> None:
    arm = robot("nao_v50_h21").chain("left_arm")
    shoulder, direction = np.array([0.0, 0.098, 0.1]), np.array([0.8, 0.36, -0.48])
    longest = np.hypot(0.105, 0.015) + np.hypot(0.05595 + 0.05775, 0.01231)
    moved = nk.project_to_reach(arm, shoulder + direction / np.linalg.norm(direction) * (longest + away))
    assert nk.solve(arm, moved).solved
    # The elbow's range ends 2° before stretched, so the border is a little inside the link lengths' sum.
    assert longest * 0.995 < np.linalg.norm(moved.goal[:3, 3] - shoulder) < longest


def test_every_kind_is_moved_to_where_the_arm_can_be() -> None:
    arm = robot("nao_v50_h25").chain("left_arm")
    far = np.array([0.5, 0.5, 0.5])
    for target in (
        Target.pose(pin.SE3(np.eye(3), far)),
        Target.pointing(far, [0, 0, 1]),
        Target.orientation(pin.exp3(np.array([0.0, 0.0, 3.0]))),
    ):
        moved = nk.project_to_reach(arm, target)
        assert moved.kind == target.kind
        near = nk.solve(arm, target)
        assert nk.solve(arm, moved, near.q.copy()).solved


def test_a_reachable_target_stays_as_it_is() -> None:
    target = Target.pose(ARM.pose(Q0))
    assert nk.project_to_reach(ARM, target) is target
