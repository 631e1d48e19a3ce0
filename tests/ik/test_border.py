"""Moving targets to the border of the reach."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.ik.target import Target
from tests.conftest import robot


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
    arm = robot("jaco2").chain("arm")
    target = Target.pose(arm.pose(np.radians([180, 200, 120, 100, 80, 30])))
    assert nk.project_to_reach(arm, target) is target
