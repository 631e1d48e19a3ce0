"""Tasks 1a, 1b, 2a, 2c, 2d and 2g of the practicum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.documents.practicum.practicum_sheet import CHECK_Q_DEG, CHECK_T_BASE_HAND
from nao_kin.documents.practicum.practicum_tasks import (
    dh_transform,
    forward_kinematics,
    interpolate_position,
    interpolate_with_acceleration,
    joint_transforms,
    run_file,
    save_ik_of_points,
)
from nao_kin.errors import InvalidInputError
from tests.conftest import robot

if TYPE_CHECKING:
    from pathlib import Path

START = np.radians([180, 200, 120, 100, 80, 30])
LINE = {"max_velocity": 0.2, "acceleration": 0.5}


def test_1a_a_dh_transform_is_four_elementary_motions(rng: np.random.Generator) -> None:
    for a, alpha, d, theta in rng.uniform(-2, 2, (50, 4)):
        turn_z = pin.SE3(pin.exp3(np.array([0, 0, theta])), np.array([0, 0, d]))
        turn_x = pin.SE3(pin.exp3(np.array([alpha, 0, 0])), np.array([a, 0, 0]))
        np.testing.assert_allclose(dh_transform(a, alpha, d, theta), (turn_z * turn_x).homogeneous, atol=1e-14)


def test_1b_the_check_pose_to_the_digits_printed() -> None:
    q = np.radians(CHECK_Q_DEG)
    np.testing.assert_allclose(forward_kinematics(q).homogeneous, CHECK_T_BASE_HAND, atol=5.1e-4)
    product = np.linalg.multi_dot(list(joint_transforms(q)))
    np.testing.assert_allclose(product, forward_kinematics(q).homogeneous, atol=1e-14)
    assert joint_transforms(q).shape == (6, 4, 4)


def test_2a_points_of_a_line() -> None:
    P = interpolate_position([0, 0, 1], [1, 2, 3], 3)
    np.testing.assert_allclose(P, [[0, 0, 1], [0.25, 0.5, 1.5], [0.5, 1, 2], [0.75, 1.5, 2.5], [1, 2, 3]])
    assert interpolate_position([0, 0, 1], [1, 2, 3], 0).shape == (2, 3)
    for bad in (-1, 1.5, True):
        with pytest.raises(InvalidInputError, match="intermediate_steps"):
            interpolate_position([0, 0, 1], [1, 2, 3], bad)


@pytest.mark.parametrize("distance", [0.5, 0.03])
def test_2c_speed_and_acceleration_are_kept_at_a_hundred_hertz(distance: float) -> None:
    motion = interpolate_with_acceleration([0.3, 0, 0.5], [0.3, 0, 0.5 + distance], **LINE)
    peak = min(0.2, math.sqrt(0.5 * distance))
    assert motion.profile.duration == pytest.approx(distance / peak + peak / 0.5)
    np.testing.assert_allclose(np.diff(motion.times)[:-1], 0.01, atol=1e-12)
    P = np.array([target.goal[:3, 3] for target in motion.targets])
    np.testing.assert_array_equal(P[[0, -1]], [[0.3, 0, 0.5], [0.3, 0, 0.5 + distance]])
    speeds = np.linalg.norm(np.diff(P, axis=0), axis=1) / np.diff(motion.times)
    assert speeds.max() <= 0.2 * (1 + 1e-9)
    assert np.abs(np.diff(speeds)[:-1]).max() <= 0.5 * 0.01 * (1 + 1e-6)
    assert motion.speeds.max() == pytest.approx(peak, rel=0.05)


def test_2d_and_2g_what_is_saved_runs(tmp_path: Path) -> None:
    arm, file = robot("jaco2").chain("arm"), tmp_path / "line.txt"
    p = arm.pose(START).translation
    motion = interpolate_with_acceleration(p, p - [0, 0, 0.25], **LINE)
    found = save_ik_of_points(file, motion, START)
    assert found.completed, found.reason
    rows = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    assert len(rows) == len(motion.times)
    ran = run_file(file)
    assert ran.possible, ran.faults
    assert ran.trajectory.q.tobytes() == found.q.tobytes()
    assert ran.off_the_line < 0.01
    for tip, target in zip(ran.tips, motion.targets, strict=True):
        assert np.linalg.norm(tip[:3, 3] - target.goal[:3, 3]) < 1e-6


def test_2d_a_line_that_leaves_the_reach_leaves_no_file(tmp_path: Path) -> None:
    p = robot("jaco2").chain("arm").pose(START).translation
    far = interpolate_with_acceleration(p, p + np.array([0, 0, 2.0]), **LINE)
    found = save_ik_of_points(tmp_path / "none.txt", far, START)
    assert not found.completed
    assert f"ample {found.ended_at} " in found.reason
    assert not (tmp_path / "none.txt").exists()
