"""Cyclic coordinate descent: what one column's move does to the error."""

from __future__ import annotations

import numpy as np
import pytest

from nao_kin.chain import Chain, in_limits, into_limits, random_configurations
from nao_kin.ik.aim import SweepGoal
from nao_kin.ik.geometric.ccd import move_column, squared_error
from nao_kin.ik.target import KINDS
from nao_kin.kernels.joint_path import PathJoint, joint_path
from nao_kin.kernels.motion import COLUMN, At
from nao_kin.robot.known import KNOWN_ROBOTS
from tests.conftest import BUNDLED, EXAMPLES, needs_examples, robot
from tests.ik.solving import chain_of
from tests.ik.sweeping import Arm, at, near_pairs

NAMED = [(name, part) for name in (*BUNDLED, *EXAMPLES) for part in KNOWN_ROBOTS[name].chains]
COUPLED = [("nao_v50_h25", "l_sole", "r_sole"), ("nao_v50_h25", "r_sole", "LArm"), ("nao_v50_h25", "LLeg", "Head")]


def _goal(kind: str, chain: Chain, rng: np.random.Generator) -> np.ndarray:
    goal = chain.pose(random_configurations(chain, 1, rng)[0]).homogeneous.copy()
    if kind == "pointing":
        axes = rng.normal(size=(3, 2))
        goal[:3, :2] = axes / np.linalg.norm(axes, axis=0)
        goal[:3, 2] = 0.0
    return goal


def _error(kind: str, goal: np.ndarray, closeness: float, chain: Chain, q: np.ndarray) -> float:
    """The error by its definition, from the chain's own forward kinematics."""
    T, error = chain.pose(q), 0.0
    if kind != "orientation":
        weight = 1.0 if kind == "position" else closeness
        error += weight * float(((T.translation - goal[:3, 3]) ** 2).sum())
    if kind == "pointing":
        error += float(((T.rotation @ goal[:3, 0] - goal[:3, 1]) ** 2).sum())
    elif kind != "position":
        error += float(((T.rotation - goal[:3, :3]) ** 2).sum())
    return error


def _moved(arm: Arm, kind: str, goal: np.ndarray, k: int, q: np.ndarray) -> np.ndarray:
    q, (axes, tip) = q.copy(), arm.placed(q)
    memory = np.full(len(q) + axes.size + 12, np.nan)
    move_column(arm.flat, SweepGoal(KINDS[kind], goal, arm.closeness), k, At(q, axes, tip), memory)
    np.testing.assert_allclose(tip, arm.placed(q)[1], atol=1e-13)
    return q


def _check_moves(chain: Chain, kind: str, rng: np.random.Generator, configurations: int) -> None:
    arm = Arm.of(chain)
    for q in random_configurations(chain, configurations, rng):
        goal = _goal(kind, chain, rng)
        before = _error(kind, goal, arm.closeness, chain, q)
        for k in reversed(range(len(arm.joints) - 1)):
            q = _moved(arm, kind, goal, k, q)
            after = _error(kind, goal, arm.closeness, chain, q)
            assert after <= before + 1e-14 * max(1.0, before)
            assert in_limits(chain, q, 1e-15)
            before = after


@pytest.mark.parametrize("kind", KINDS)
def test_no_move_of_a_column_increases_the_error_on_any_chain(kind: str, rng: np.random.Generator) -> None:
    needs_examples()
    for name, part in NAMED:
        _check_moves(robot(name).chain(part), kind, rng, 3)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("name", "base", "tip"), COUPLED)
def test_nor_where_one_motor_moves_two_joints_or_a_range_hangs_on_a_column(
    name: str, base: str, tip: str, kind: str, rng: np.random.Generator
) -> None:
    _check_moves(robot(name).chain(base, tip), kind, rng, 30)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("name", "part"), [("nao_v33_h21", "left_arm"), ("jaco2", "arm"), ("ur5", "arm")])
def test_a_move_is_the_best_of_the_whole_range(name: str, part: str, kind: str, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    arm = Arm.of(chain)
    for q in random_configurations(chain, 5, rng):
        goal = _goal(kind, chain, rng)
        for k, lower, upper in zip(range(len(q)), chain.lower, chain.upper, strict=True):
            moved = _moved(arm, kind, goal, k, q)
            tried = np.tile(q, (721, 1))
            tried[:, k] = np.linspace(max(lower, q[k] - np.pi), min(upper, q[k] + np.pi), 721)
            best = min(_error(kind, goal, arm.closeness, chain, row) for row in tried)
            assert _error(kind, goal, arm.closeness, chain, moved) <= best + 1e-13


def test_a_sliding_joint_goes_to_the_foot_of_the_target_or_to_its_end() -> None:
    for axis, lower, upper in (((1.0, 0.0, 0.0), -1.0, 1.0), ((0.0, -1.0, 0.0), -2.0, 0.1)):
        slide = joint_path([PathJoint(at(0.1, 0.2, 0.3), np.array(axis), True, 0)], np.eye(4), [lower], [upper])
        arm = Arm.along(slide)
        for wanted in (-5.0, -0.5, 0.05, 5.0):
            goal = at(*(np.array([0.1, 0.2, 0.3]) + wanted * np.array(axis) + np.array([0.0, 0.0, 0.7])))
            moved = _moved(arm, "position", goal, 0, np.zeros(1))
            np.testing.assert_allclose(moved, [min(max(wanted, lower), upper)], atol=1e-15)


@pytest.mark.parametrize("kind", ["position", "pose"])
def test_a_column_of_two_joints_comes_to_rest_where_nothing_is_left_to_gain(
    kind: str, rng: np.random.Generator
) -> None:
    """At rest, the parabola through the errors around it promises no gain inside the range above rounding."""
    chain = robot("nao_v50_h25").chain("l_sole", "r_sole")
    arm, column, h = Arm.of(chain), chain.joint_names.index("LHipYawPitch"), 1e-4
    k = int(np.flatnonzero(arm.joints[:-1, COLUMN] == column)[-1])
    for q in random_configurations(chain, 20, rng):
        goal = _goal(kind, chain, rng)
        for _ in range(100):
            q = _moved(arm, kind, goal, k, q)
        step = h * np.eye(len(q))[column]
        less, here, more = (_error(kind, goal, arm.closeness, chain, q + sign * step) for sign in (-1.0, 0.0, 1.0))
        slope, curvature = (more - less) / (2.0 * h), (more - 2.0 * here + less) / h**2
        at_upper, at_lower = q[column] == chain.upper[column], q[column] == chain.lower[column]
        if not ((at_upper and slope < 0.0) or (at_lower and slope > 0.0)):
            assert curvature > 0.0
            assert 0.5 * slope**2 / curvature < 1e-12 * max(1.0, here)


def test_pose_targets_near_the_start_are_mostly_reached(rng: np.random.Generator) -> None:
    """Coordinate descent is slow where position and rotation pull against each other, so not all of them are."""
    chain = chain_of("nao_v50_h25", "left_leg")
    arm, solved = Arm.of(chain), 0
    for q0, q1 in near_pairs(chain, 60, rng):
        goal, q = chain.pose(q1).homogeneous.copy(), into_limits(chain, q0)
        for _ in range(1000):
            if arm.error(goal, q, KINDS["pose"]) < 1e-14:
                break
            q = arm.swept("ccd", goal, q, KINDS["pose"])
        solved += _error("pose", goal, arm.closeness, chain, q) < 1.1e-14
    assert solved >= 57


def test_the_error_is_its_definition(rng: np.random.Generator) -> None:
    chain = chain_of("jaco2", "arm")
    arm = Arm.of(chain)
    for kind, code in KINDS.items():
        for q in random_configurations(chain, 20, rng):
            goal = _goal(kind, chain, rng)
            measured = squared_error(SweepGoal(code, goal, arm.closeness), arm.placed(q)[1])
            assert measured == pytest.approx(_error(kind, goal, arm.closeness, chain, q), abs=1e-12)
