"""Kinds of target and weights, judged with arithmetic of the tests' own."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.measure import errors, measure_many
from nao_kin.ik.target import KINDS, Target
from tests.conftest import robot

ENGINES = ["compiled", "reference"]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_nao_arm_points_where_it_can(engine, rng: np.random.Generator) -> None:
    arm = robot("nao_v50_h25").chain("left_arm")
    for q in random_configurations(arm, 30, rng):
        T = arm.pose(q)
        for tip_axis in ([1.0, 0, 0], [0.6, 0.0, 0.8]):
            wanted = T.rotation @ np.array(tip_axis)
            result = nk.solve(arm, Target.pointing(T.translation, 3.0 * wanted, tip_axis), engine=engine)
            assert result.solved, result.message
            found = arm.pose(result.q)
            assert math.dist(found.translation, T.translation) <= 1e-6
            assert np.linalg.norm(np.cross(found.rotation @ tip_axis, wanted)) <= 1.0001e-6
            assert (found.rotation @ tip_axis) @ wanted > 0.0


@pytest.mark.parametrize("engine", ENGINES)
def test_an_orientation_is_met_anywhere(engine, rng: np.random.Generator) -> None:
    arm = robot("jaco2").chain("arm")
    for q in random_configurations(arm, 20, rng):
        R = arm.pose(q).rotation
        result = nk.solve(arm, Target.orientation(R), engine=engine)
        assert result.solved, result.message
        assert result.position_error is None
        assert np.linalg.norm(pin.log3(R.T @ arm.pose(result.q).rotation)) <= 1.0001e-6


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("free", [("x",), ("z", "rx"), ("rx", "ry", "rz"), ("x", "y", "rz")])
def test_axes_with_weight_0_are_free(engine, free: tuple[str, ...], rng: np.random.Generator) -> None:
    arm, names = robot("jaco2").chain("arm"), ("x", "y", "z", "rx", "ry", "rz")
    bound = np.array([name not in free for name in names])
    for q in random_configurations(arm, 15, rng):
        T = arm.pose(q)
        result = nk.solve(arm, Target.pose(T, weights=dict.fromkeys(free, 0.0)), engine=engine)
        assert result.solved, result.message
        found = arm.pose(result.q)
        missing = np.concatenate([T.translation - found.translation, pin.log3(T.rotation @ found.rotation.T)])
        assert np.linalg.norm(missing[:3][bound[:3]]) <= 1e-6
        assert np.linalg.norm(missing[3:][bound[3:]]) <= 1.0001e-6


def test_weights_choose_the_compromise(rng: np.random.Generator) -> None:
    """Five joints cannot meet six wishes: what weighs less is given up."""
    arm = robot("nao_v50_h25").chain("left_arm")
    turns, places = ("rx", "ry", "rz"), ("x", "y", "z")
    for q in random_configurations(arm, 10, rng):
        T = arm.pose(q)
        T.rotation = pin.exp3(np.array([0.0, 0.0, 0.7])) @ T.rotation
        by_place = nk.solve(arm, Target.pose(T, weights=dict.fromkeys(turns, 1e-3)))
        by_turn = nk.solve(arm, Target.pose(T, weights=dict.fromkeys(places, 1e-3)))
        assert by_place.position_error < 1e-3
        assert by_place.position_error <= by_turn.position_error
        assert by_turn.rotation_error <= by_place.rotation_error


@pytest.mark.parametrize("kind", KINDS)
def test_both_measurements_agree_and_stay_accurate(kind, rng: np.random.Generator) -> None:
    for angle in (0.0, 1e-12, 1e-6, 0.5, math.pi - 1e-6, math.pi):
        T = pin.SE3.Random()
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        tip = pin.SE3(pin.exp3(angle * axis) @ T.rotation, T.translation + rng.normal(size=3))
        if kind == "pointing":
            across = np.cross(axis, [1.0, 0.3, -0.2])
            target = Target.pointing(T.translation, across, T.rotation.T @ across)
        else:
            target = Target(kind, np.array(T.homogeneous, order="C"))
        one = errors(KINDS[kind], target.goal, 63, tip.rotation, tip.translation)
        many = measure_many(KINDS[kind], target.goal[None], 63, tip.homogeneous[None])
        np.testing.assert_allclose(one, [errors[0] for errors in many], atol=1e-14, equal_nan=True)
        distance = math.nan if kind == "orientation" else math.dist(T.translation, tip.translation)
        turn = math.nan if kind == "position" else angle
        np.testing.assert_allclose(one, (distance, turn), atol=1e-14, rtol=1e-12, equal_nan=True)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Target.pointing([0, 0, 0], [0, 0, 0]), "base_axis: expected a direction"),
        (lambda: Target.pointing([0, 0, 0], [1, 0, 0], [0, 0]), "tip_axis: expected 3 numbers"),
        (lambda: Target.orientation(np.eye(3) * 1.1), "violation of 0.21"),
        (lambda: Target.pose(np.eye(4), weights=[1, 1, 1]), "weights: expected 6 numbers"),
        (lambda: Target.pose(np.eye(4), weights=[0] * 6), "not all 0"),
        (lambda: Target.pose(np.eye(4), weights={"x": -1}), "weights"),
    ],
)
def test_bad_targets_are_named(make, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        make()


def test_an_unknown_axis_comes_with_near_matches() -> None:
    with pytest.raises(UnknownNameError, match="'rx'"):
        Target.pose(np.eye(4), weights={"rxx": 0.0})


def test_a_target_shows_and_copies_itself() -> None:
    matrix = np.eye(4)
    target = Target.pose(matrix)
    matrix[0, 3] = 1.0
    target.T_base_target.translation = np.ones(3)
    assert target.T_base_target.translation[0] == 0.0
    assert repr(Target.position([0.1, 0.2, 0.3])) == "<Target position (0.1, 0.2, 0.3)>"
    pointing = Target.pointing([0, 0, 0], [0, 2, 0])
    np.testing.assert_array_equal(pointing.base_axis, [0, 1, 0])
    np.testing.assert_array_equal(pointing.tip_axis, [1, 0, 0])
    assert target.tip_axis is None
    assert target.base_axis is None


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("free", [("rz",), ("rx", "ry", "rz")])
def test_half_a_turn_about_a_free_axis_is_met(engine, free: tuple[str, ...]) -> None:
    head = robot("nao_v50_h25").chain("head")
    goal = head.pose([0.0, 0.0]).homogeneous.copy()
    goal[:3, :3] = np.diag([-1.0, -1.0, 1.0]) @ goal[:3, :3]
    result = nk.solve(head, Target.pose(goal, dict.fromkeys(free, 0.0)), engine=engine)
    assert result.solved, result.message
    assert not nk.solve(head, Target.pose(goal, {"rx": 0.0}), engine=engine).solved
    assert nk.solve_batch(head, [Target.pose(goal, dict.fromkeys(free, 0.0))]).solved.all()


@pytest.mark.parametrize("free", [("rx",), ("ry", "rz")])
def test_masked_rotations_are_parts_of_the_rotation_vector(free: tuple[str, ...], rng: np.random.Generator) -> None:
    counts = sum((name not in free) << i for i, name in enumerate(("x", "y", "z", "rx", "ry", "rz")))
    bound = np.array([name not in free for name in ("rx", "ry", "rz")])
    for angle in (0.0, 1e-9, 1e-3, 1.0, 2.0, math.pi - 1e-3, math.pi - 1e-7):
        for _ in range(20):
            axis = rng.normal(size=3)
            axis /= np.linalg.norm(axis)
            R = pin.SE3.Random().rotation
            goal = np.eye(4)
            goal[:3, :3] = pin.exp3(angle * axis) @ R
            found = errors(KINDS["pose"], goal, counts, R, np.zeros(3))[1]
            assert found == pytest.approx(angle * np.linalg.norm(axis[bound]), abs=1e-7)


def test_pointing_weights_are_of_the_position() -> None:
    with pytest.raises(InvalidInputError, match="x, y and z only"):
        Target.pointing([0, 0, 0], [1, 0, 0], weights={"rz": 0.0})
    assert np.linalg.norm(Target.pointing([0, 0, 0], [1e200, 0, 0]).base_axis) == 1.0
