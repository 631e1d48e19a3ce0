"""Kinds of target, weights and masks of the compiled loop, with `chain.pose` as the oracle."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.chain import neutral, random_configurations
from nao_kin.ik import aim
from nao_kin.ik.compiled import tables_of
from nao_kin.ik.problem import Status
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import Target
from nao_kin.kernels.motion import jacobian, place
from nao_kin.tolerances import Tolerances
from tests.ik.solving import (
    chain_of,
    compiled,
    errors,
    goals_of,
)


@pytest.mark.parametrize("short", [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1.0, math.pi - 1e-3, math.pi - 1e-9, math.pi])
def test_the_rotation_vector_is_exact_at_every_angle(short: float, rng: np.random.Generator) -> None:
    for axis in (*np.eye(3), *-np.eye(3), *rng.standard_normal((50, 3))):
        vector = short * axis / np.linalg.norm(axis)
        goal, R = np.eye(4), pin.exp3(rng.standard_normal(3))
        goal[:3, :3] = pin.exp3(vector) @ R
        found = np.array(aim.rotation_vector(goal, np.concatenate([R.ravel(), np.zeros(3)])))
        if short > 3.0 and found @ vector < 0.0:
            found *= 2.0 - 2.0 * math.pi / np.linalg.norm(found) - 1.0  # the same rotation, the other way round
        np.testing.assert_allclose(found, vector, atol=2e-15 if short < 1.0 else 1e-14)


def test_orientations_are_reached(rng: np.random.Generator) -> None:
    for name, part in [("jaco2", "arm"), ("nao_v50_h25", "left_leg")]:
        chain = chain_of(name, part)
        for goal in goals_of(chain, 100, rng):
            goal[:3, 3] = 1e3  # what does not count may be anywhere
            run = compiled(chain, goal, neutral(chain), "orientation")
            assert run.ended is Status.SOLVED
            assert errors(chain, run.q, goal)[1] <= 1e-6


def test_pointing_targets_are_reached(rng: np.random.Generator) -> None:
    for name, part in [("jaco2", "arm"), ("nao_v50_h25", "left_arm"), ("nao_v50_h25", "left_leg")]:
        chain = chain_of(name, part)
        solved = 0
        for q in random_configurations(chain, 200, rng):
            T, tip_axis = chain.pose(q), rng.standard_normal(3)
            tip_axis /= np.linalg.norm(tip_axis)
            goal = Target.pointing(T.translation, T.rotation @ tip_axis, tip_axis).goal
            run = compiled(chain, goal, neutral(chain), "pointing")
            solved += run.ended is Status.SOLVED
            if run.ended is Status.SOLVED:
                found = chain.pose(run.q)
                assert np.linalg.norm(found.translation - T.translation) <= 1e-6
                assert np.linalg.norm(np.cross(found.rotation @ tip_axis, T.rotation @ tip_axis)) <= 1e-6
                assert (found.rotation @ tip_axis) @ (T.rotation @ tip_axis) > 0.0
        assert solved >= 199


def test_pointing_the_opposite_way_is_an_error_of_pi(rng: np.random.Generator) -> None:
    for axis in (*np.eye(3), *rng.standard_normal((20, 3))):
        axis = axis / np.linalg.norm(axis)
        R, e = pin.exp3(rng.standard_normal(3)), np.empty(6)
        goal = Target.pointing(np.zeros(3), -R @ axis, axis).goal
        aim.raw_error(aim.POINTING, goal, np.concatenate([R.ravel(), np.zeros(3)]), e)
        assert np.linalg.norm(e[3:]) == pytest.approx(math.pi, abs=1e-7)
        np.testing.assert_allclose(pin.exp3(e[3:]) @ R @ axis, -R @ axis, atol=1e-7)


@pytest.mark.parametrize("free", [0, 2, 3, 5])
def test_a_masked_axis_is_free_and_the_others_are_met(free: int, rng: np.random.Generator) -> None:
    chain = chain_of("jaco2", "arm")
    weights = np.ones(6)
    weights[free] = 0.0
    solved = 0
    for goal in goals_of(chain, 200, rng):
        goal[:3, :3] = (
            pin.exp3(rng.uniform(-2.0, 2.0) * np.eye(3)[free - 3]) @ goal[:3, :3] if free > 2 else goal[:3, :3]
        )
        run = compiled(chain, goal, neutral(chain), weights=weights)
        T = chain.pose(run.q)
        missing = np.concatenate([goal[:3, 3] - T.translation, pin.log3(goal[:3, :3] @ T.rotation.T)])
        if run.ended is Status.SOLVED:
            solved += 1
            assert np.abs(np.delete(missing, free)).max() <= 1e-6
    assert solved >= 198


def test_the_rows_are_the_slope_of_the_weighted_error(rng: np.random.Generator) -> None:
    chain = chain_of("jaco2", "arm")
    joints, weights = tables_of(chain).joints, rng.uniform(0.2, 2.0, 6)
    axes, tip, J, e, h = np.empty((6, 6)), np.empty(12), np.empty((6, 6)), np.empty(6), 1e-6

    def weighted(q: np.ndarray, goal: np.ndarray) -> np.ndarray:
        raw = np.empty(6)
        place(joints, q, axes, tip)
        aim.raw_error(aim.POSE, goal, tip, raw)
        return weights * raw

    for q, goal in zip(random_configurations(chain, 50, rng), goals_of(chain, 50, rng), strict=True):
        if errors(chain, q, goal)[1] > 3.0:  # the rotation vector jumps at π
            continue
        slope = np.array([weighted(q - h * d, goal) - weighted(q + h * d, goal) for d in np.eye(6)]).T / (2.0 * h)
        place(joints, q, axes, tip)
        jacobian(joints, axes, tip, J)
        aim.raw_error(aim.POSE, goal, tip, e)
        aim.shape_rows(aim.POSE, goal, weights, tip, e, J)
        np.testing.assert_allclose(J, slope, atol=1e-7 / (math.pi - 3.0))
        np.testing.assert_allclose(e, weighted(q, goal), atol=1e-14)


def test_weights_choose_the_compromise(rng: np.random.Generator) -> None:
    """A target just beyond reach: the heavier part is met better, on the whole."""
    chain, budget = chain_of("jaco2", "arm"), Budget(patience=50, restarts=0)
    met = []
    for q in random_configurations(chain, 50, rng):
        goal = chain.pose(q).homogeneous
        goal[:3, 3] *= 1.1 / np.linalg.norm(goal[:3, 3])
        for heavy in (np.repeat([3.0, 1.0], 3), np.repeat([0.3, 1.0], 3)):
            run = compiled(chain, goal, q, budget=budget, weights=heavy)
            met.append(errors(chain, run.q, goal))
    far, turned = np.mean(met[::2], axis=0), np.mean(met[1::2], axis=0)
    assert far[0] < turned[0]
    assert far[1] > turned[1]


def test_tolerances_of_zero_and_tight_ones_end(rng: np.random.Generator) -> None:
    chain = chain_of("jaco2", "arm")
    for tolerance, solved in [(1e-12, True), (0.0, False)]:
        tolerances = Tolerances(position=tolerance, rotation=tolerance)
        for goal in goals_of(chain, 10, rng):
            run = compiled(chain, goal, neutral(chain), tolerances=tolerances)
            assert (run.ended is Status.SOLVED) is solved
