"""Body inverse kinematics: six feet held, and the leg named that cannot hold its own."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.analytic.hexapod.body import BodyResult, body_ik, body_ik_batch
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.problem import Status
from nao_kin.se3 import from_xyz_rpy
from tests.analytic.walkers import HIP, HIPS, LEGS, SHIN, THIGH, phantomx_legs, phantomx_stand, round_feet, round_legs
from tests.conftest import robot


def standing_feet() -> dict[str, np.ndarray]:
    return {name: robot("phantomx").pose(phantomx_stand(), f"foot_{name}").translation for name in LEGS}


def body_poses(rng: np.random.Generator, count: int, shift: float, turn: float) -> np.ndarray:
    """Poses of the body about where it stands (count, 4, 4): shifts [m], turns [rad]."""
    return np.array(
        [from_xyz_rpy(rng.uniform(-shift, shift, 3), rng.uniform(-turn, turn, 3)).homogeneous for _ in range(count)]
    )


def test_standing_as_it_stands() -> None:
    result = body_ik(phantomx_legs(), np.eye(4), standing_feet())
    assert result.solved
    assert not result.missed
    assert list(result.results) == list(LEGS)
    wanted = dict.fromkeys(robot("phantomx").joint_names, 0.0) | phantomx_stand()
    assert set(result.posture) == set(wanted)
    assert max(abs(result.posture[name] - value) for name, value in wanted.items()) < 1e-12
    assert "All 6 feet" in result.message
    with pytest.raises(TypeError, match=r"result\.solved"):
        bool(result)


def test_ten_thousand_body_poses_hold_all_six_feet(rng: np.random.Generator) -> None:
    legs, feet = phantomx_legs(), standing_feet()
    T = body_poses(rng, 10_000, 0.025, 0.15)
    result = body_ik_batch(legs, T, feet)
    assert len(result) == 10_000
    assert result.q.shape == (10_000, 18)
    assert result.solved.mean() > 0.99
    # In reach, measured by the robot itself as a whole, in the ground's frame.
    for i in rng.choice(np.flatnonzero(result.solved.all(axis=1)), 300, replace=False):
        poses = robot("phantomx").link_poses(dict(zip(result.joint_names, result.q[i].tolist(), strict=True)))
        for name in LEGS:
            foot = T[i] @ (poses["base_link"].inverse() * poses[f"foot_{name}"]).homogeneous
            assert np.abs(foot[:3, 3] - feet[name]).max() < 1e-12
    assert result.position_error[result.solved].max() < 1e-9  # what was asked; rounding is far below
    assert result.position_error[result.solved].max() < 1e-14
    limit = 2.6179939  # [rad] of all 18 joints, from the URDF file
    assert np.abs(result.q[result.solved.all(axis=1)]).max() <= limit
    # The rest is out of reach or of limits, and by what it says.
    lost = ~result.solved
    assert (result.position_error[lost] >= np.abs(result.misses_by[lost]) - 1e-12).all()


def test_a_batch_says_what_single_poses_say(rng: np.random.Generator) -> None:
    legs, feet = phantomx_legs(), standing_feet()
    T = body_poses(rng, 60, 0.06, 0.4)
    batch = body_ik_batch(legs, T, feet)
    assert 0.2 < batch.solved.all(axis=1).mean() < 0.9
    for i, T_ground_body in enumerate(T):
        result = body_ik(legs, T_ground_body, feet)
        assert [r.solved for r in result.results.values()] == batch.solved[i].tolist()
        assert list(result.posture.values()) == batch.q[i].tolist()
        errors = [r.position_error for r in result.results.values()]
        assert errors == pytest.approx(batch.position_error[i], abs=1e-12)
        assert [miss.leg for miss in result.missed] == [
            leg for leg, s in zip(LEGS, batch.solved[i], strict=True) if not s
        ]


def test_feet_that_move_with_the_body_are_those_of_single_poses(rng: np.random.Generator) -> None:
    legs, stand = phantomx_legs(), np.array(list(standing_feet().values()))
    T, feet = body_poses(rng, 20, 0.02, 0.1), stand + rng.uniform(-0.02, 0.02, (20, 6, 3))
    batch = body_ik_batch(legs, T, feet)
    for i in range(20):
        single = body_ik(legs, T[i], feet[i])
        assert list(single.posture.values()) == batch.q[i].tolist()
    with pytest.raises(InvalidInputError, match="feet"):
        body_ik_batch(legs, T[:3], feet)
    with pytest.raises(InvalidInputError, match="feet"):
        body_ik_batch(legs, T, np.full((20, 6, 3), math.nan))
    with pytest.raises(InvalidInputError, match="legs"):
        body_ik_batch({}, T, np.zeros((20, 0, 3)))


def test_the_leg_that_cannot_reach_is_named_with_the_distance() -> None:
    legs, feet = round_legs(), round_feet()
    feet[2] = HIPS[2] + np.array([0.0, -(HIP + THIGH + SHIN + 0.0123), 0.0])
    feet[4] = HIPS[4] + np.array([-(SHIN - THIGH - HIP - 0.004), 0.0, 0.0])  # too near even for reaching over
    result = body_ik(legs, np.eye(4), feet)
    assert not result.solved
    assert [(miss.leg, miss.reason) for miss in result.missed] == [("rr", "too far"), ("lm", "too near")]
    assert result.missed[0].misses_by == pytest.approx(0.0123, abs=1e-12)
    assert result.missed[1].misses_by == pytest.approx(0.004, abs=1e-12)
    far, near = result.results["rr"], result.results["lm"]
    assert far.status is near.status is Status.OUT_OF_REACH
    assert far.position_error == pytest.approx(0.0123, abs=1e-12)  # it stretches towards its foot
    assert near.position_error == pytest.approx(0.004, abs=1e-12)
    assert "rr" in result.message
    assert "0.0123 m too far" in result.message
    assert sum(r.solved for r in result.results.values()) == 4


def test_a_leg_that_its_limits_stop_is_named_with_the_joint() -> None:
    legs, feet = round_legs(limit=1.0), round_feet(out=0.05, down=0.07)
    result = body_ik(legs, np.eye(4), feet)
    assert not result.solved
    assert {miss.reason for miss in result.missed} == {"limits"}
    assert all(miss.outside and miss.misses_by == 0.0 for miss in result.missed)
    for miss in result.missed:
        stopped = result.results[miss.leg]
        assert stopped.status is Status.OUTSIDE_LIMITS
        assert stopped.position_error is not None
        assert stopped.position_error < 1e-12
    assert [miss.leg for miss in result.missed] == ["rm", "rr", "lm", "lr"]  # whose hips have to turn too far
    assert "hip_rm" in result.message
    assert "is outside" in result.message


def test_the_solution_near_to_given_joints_is_taken() -> None:
    legs, feet = round_legs(), round_feet()
    up = body_ik(legs, np.eye(4), feet)
    assert {r.branch for r in up.results.values()} == {"coxa forward, knee up"}
    assert body_ik(legs, np.eye(4), feet, near=up.posture).posture == pytest.approx(up.posture)
    for wanted in ("coxa forward, knee down", "coxa reaching over, knee up"):
        near = {}
        for name, chain in legs.items():
            target = up.results[name].problem.target
            each = {r.branch: r for r in nk.solve_all(chain, target)}
            near |= each.get(wanted, each["coxa forward, knee down"]).posture
        found = body_ik(legs, np.eye(4), feet, near=near)
        assert found.posture == pytest.approx(near, abs=1e-9)
        assert found.solved


def test_without_a_knee_up_within_limits_the_next_solution_is_taken() -> None:
    legs, feet = round_legs(knee=(-3.0, 0.0)), round_feet()
    result = body_ik(legs, np.eye(4), feet)
    assert result.solved
    assert {r.branch for r in result.results.values()} == {"coxa forward, knee down"}


def test_the_ground_may_be_anywhere(rng: np.random.Generator) -> None:
    legs, feet = round_legs(), round_feet()
    for _ in range(20):
        T_world_ground = pin.SE3.Random()
        T_ground_body = from_xyz_rpy(rng.uniform(-0.01, 0.01, 3), rng.uniform(-0.1, 0.1, 3))
        here = body_ik(legs, T_ground_body, feet)
        there = body_ik(legs, T_world_ground * T_ground_body, np.array([T_world_ground.act(p) for p in feet]))
        assert there.posture == pytest.approx(here.posture, abs=1e-9)


def test_misuse_is_named() -> None:
    legs, feet = round_legs(), dict(zip(LEGS, round_feet(), strict=True))
    with pytest.raises(UnknownNameError, match="Did you mean 'rf'"):
        body_ik(legs, np.eye(4), {**feet, "rff": np.zeros(3)})
    with pytest.raises(InvalidInputError, match="none for lr"):
        body_ik(legs, np.eye(4), {name: point for name, point in feet.items() if name != "lr"})
    with pytest.raises(InvalidInputError, match="6 rows"):
        body_ik(legs, np.eye(4), np.zeros((5, 3)))
    with pytest.raises(UnknownNameError, match="knee_rf"):
        body_ik(legs, np.eye(4), feet, near={"kne_rf": 0.0})
    with pytest.raises(InvalidInputError, match="T_ground_body"):
        body_ik(legs, 2.0 * np.eye(4), feet)
    with pytest.raises(InvalidInputError, match="foot of rm"):
        body_ik(legs, np.eye(4), {**feet, "rm": [0.0, math.nan, 0.0]})
    with pytest.raises(InvalidInputError, match="row 1"):
        body_ik_batch(legs, np.stack([np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0])]), feet)
    with pytest.raises(InvalidInputError, match="leg left"):
        body_ik({"left": robot("nao").chain("left_arm")}, np.eye(4), np.zeros((1, 3)))
    with pytest.raises(InvalidInputError, match="bases"):
        body_ik({"lf": phantomx_legs()["lf"], "rf": legs["rf"]}, np.eye(4), np.zeros((2, 3)))
    with pytest.raises(InvalidInputError, match="at least one leg"):
        body_ik({}, np.eye(4), np.zeros((0, 3)))


def test_no_poses_at_all() -> None:
    result = body_ik_batch(round_legs(), np.empty((0, 4, 4)), round_feet())
    assert len(result) == 0
    assert isinstance(body_ik(round_legs(), np.eye(4), round_feet()), BodyResult)
