"""Solvers and the judge: FK∘IK = identity, and nothing says solved that was not measured."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import in_limits, neutral, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.problem import Problem, Run, judge
from nao_kin.se3 import position_distance, rotation_distance
from tests.conftest import needs_examples, robot

if TYPE_CHECKING:
    import pinocchio as pin

POSES = [("jaco2", "arm"), ("nao_v50_h25", "left_leg"), ("nao_v50_h25", "right_leg")]
POSITIONS = [
    ("nao_v50_h21", "left_arm"),
    ("nao_v50_h25", "right_arm"),
    ("phantomx", "leg_rm"),
    ("jaco2", "arm"),
]
ROUNDING = 1e-14  # a coupled limit is interpolated twice, in compiled code and by numpy
OPTIONAL = [("ur5", "arm"), ("panda", "arm"), ("xarm7", "arm"), ("talos", "left_arm"), ("z1", "arm")]


def oracle_errors(result: nk.IKResult, target: pin.SE3) -> tuple[float, float]:
    """Measured by Pinocchio on the whole robot, not by the chain that solved."""
    chain = result.problem.chain
    pose = chain.robot.pose(result.posture, chain.tip, chain.base)
    return position_distance(pose, target), rotation_distance(pose, target)


@pytest.mark.parametrize(("name", "chain_name"), [*POSES, *OPTIONAL])
def test_reachable_poses_are_solved(name: str, chain_name: str, rng: np.random.Generator) -> None:
    if (name, chain_name) in OPTIONAL:
        needs_examples()
    chain = robot(name).chain(chain_name)
    for q in random_configurations(chain, 60, rng):
        target = chain.pose(q)
        result = nk.solve(chain, target)
        assert result.solved, result.message
        assert max(oracle_errors(result, target)) <= 1e-6
        assert in_limits(chain, result.q, ROUNDING)


@pytest.mark.parametrize(("name", "chain_name"), POSITIONS)
def test_reachable_positions_are_solved(name: str, chain_name: str, rng: np.random.Generator) -> None:
    chain = robot(name).chain(chain_name)
    for q in random_configurations(chain, 60, rng):
        target = chain.pose(q)
        result = nk.solve(chain, target.translation)
        assert result.solved, result.message
        assert oracle_errors(result, target)[0] <= 1e-6
        assert result.rotation_error is None
        assert in_limits(chain, result.q)


def test_a_table_is_solved_without_any_file(rng: np.random.Generator) -> None:
    chain = nk.document_chain("practicum_jaco2")
    for q in rng.uniform(-3, 3, (30, 6)):
        result = nk.solve(chain, chain.pose(q))
        assert result.solved, result.message
        assert position_distance(chain.pose(result.q), chain.pose(q)) <= 1e-6


def test_coupled_limits_hold_at_every_iterate(rng: np.random.Generator) -> None:
    for name in ("left_leg", "right_leg"):
        chain = robot("nao_v50_h25").chain(name)
        for q in random_configurations(chain, 20, rng):
            result = nk.solve(chain, chain.pose(q), trace=True)
            assert result.trace is not None
            assert all(in_limits(chain, iterate, ROUNDING) for iterate in result.trace.q)


def test_a_chain_with_coupled_joints_is_solved(rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_sole")
    for q in random_configurations(chain, 20, rng):
        result = nk.solve(chain, chain.pose(q))
        assert result.solved, result.message


def test_a_target_at_the_start_needs_no_iteration() -> None:
    arm = robot("jaco2").chain("arm")
    q0 = neutral(arm)
    result = nk.solve(arm, arm.pose(q0), q0)
    assert result.solved
    assert result.iterations == 0
    np.testing.assert_array_equal(result.q, q0)


def test_a_start_exactly_half_a_turn_away_is_no_trap(rng: np.random.Generator) -> None:
    """Turning the last joint by π turns the tip by exactly π about its own axis, at the same position."""
    arm = robot("jaco2").chain("arm")
    for q in random_configurations(arm, 20, rng):
        target = arm.pose(q)
        start = q + np.array([0, 0, 0, 0, 0, math.pi])
        assert rotation_distance(arm.pose(start), target) == pytest.approx(math.pi, abs=1e-12)
        result = nk.solve(arm, target, start)
        assert result.solved, result.message
        assert max(oracle_errors(result, target)) <= 1e-6


@pytest.mark.parametrize("near", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_poses_at_and_near_singularities_are_solved(near: float, rng: np.random.Generator) -> None:
    """The NAO's leg stretched, its knee at 0, is singular; the knee's range begins at −0.09."""
    leg = robot("nao_v50_h25").chain("left_leg")
    knee = leg.joint_names.index("LKneePitch")
    for q in random_configurations(leg, 10, rng):
        q[knee] = near
        target = leg.pose(q)
        result = nk.solve(leg, target)
        assert result.solved, result.message
        assert max(oracle_errors(result, target)) <= 1e-6


@pytest.mark.parametrize("tolerance", [1e-8, 1e-10, 1e-12])
def test_tight_tolerances_end_in_a_verdict(tolerance: float, rng: np.random.Generator) -> None:
    tolerances = nk.Tolerances(position=tolerance, rotation=tolerance)
    for name, chain_name in (("jaco2", "arm"), ("nao_v50_h25", "left_arm")):
        chain = robot(name).chain(chain_name)
        for q in random_configurations(chain, 15, rng):
            result = nk.solve(chain, chain.pose(q).translation, tolerances=tolerances)
            assert result.solved, result.message
            assert oracle_errors(result, chain.pose(q))[0] <= tolerance + 1e-15


@pytest.mark.parametrize("length", [1.0, 100.0, 1000.0])
def test_a_table_in_the_wrong_unit_raises_nothing(length: float, rng: np.random.Generator) -> None:
    """Millimetres typed as metres: the arithmetic must hold out."""
    table = nk.DHChain.from_table([(0, 0, 0, 0), (length, 0, 0, 0), (length / 2, 0, 0, 0)], "standard")
    for q in rng.uniform(-3, 3, (30, 3)):
        result = nk.solve(table, table.pose(q).translation, tolerances=nk.Tolerances(position=1e-6 * length))
        assert result.solved, result.message


def test_far_away_is_out_of_reach_without_a_warning() -> None:
    result = nk.solve(robot("nao_v50_h25").chain("left_arm"), [1e200, 0, 0])
    assert result.status is nk.Status.OUT_OF_REACH
    assert math.isfinite(result.position_error)


@pytest.mark.parametrize("beyond", [1e-6, 1e-3, 0.5, 10.0])
def test_out_of_reach_is_proven_and_says_by_how_much(beyond: float) -> None:
    """A stretched NAO H21 arm reaches at most its two link lengths from the shoulder."""
    chain = robot("nao_v50_h21").chain("left_arm")
    shoulder = np.array([0.0, 0.098, 0.1])
    longest = math.hypot(0.105, 0.015) + math.hypot(0.05595 + 0.05775, 0.01231)
    target = shoulder + np.array([1.0, 0.0, 0.0]) * (longest + 1e-6 + beyond)
    result = nk.solve(chain, target)
    assert result.status is nk.Status.OUT_OF_REACH
    assert result.run.misses_by == pytest.approx(beyond + 1e-6, abs=1e-9)
    assert result.position_error >= result.run.misses_by
    assert in_limits(chain, result.q)
    assert "misses by at least" in result.message


def test_near_enough_but_behind_the_back_is_never_solved() -> None:
    """Link lengths allow it; a shoulder pitch of at most 119.5° does not."""
    chain = robot("nao_v50_h21").chain("left_arm")
    result = nk.solve(chain, [-0.2, 0.098, 0.1])
    assert result.status in (nk.Status.STALLED, nk.Status.BUDGET_SPENT)
    assert in_limits(chain, result.q)
    assert result.position_error > 0.01


def test_a_start_outside_the_limits_is_moved_inside_and_said_so() -> None:
    arm = robot("nao_v50_h25").chain("left_arm")
    q0 = np.full(5, 9.0)
    result = nk.solve(arm, [0.15, 0.15, 0.1], q0)
    assert result.run.start_moved
    assert "moved inside" in result.message
    assert result.solved
    np.testing.assert_array_equal(q0, np.full(5, 9.0))


def test_a_posture_is_a_start_and_the_result_gives_one_back() -> None:
    model = robot("nao_v50_h25")
    arm = model.chain("left_arm")
    result = nk.solve(arm, [0.15, 0.15, 0.1], {"LElbowRoll": -0.5})
    pose = model.pose(result.posture, "LArm")
    np.testing.assert_allclose(pose.translation, [0.15, 0.15, 0.1], atol=1e-6)


def test_the_posture_of_a_whole_robot_is_a_start() -> None:
    model = robot("nao_v50_h25")
    result = nk.solve(model.chain("right_leg"), model.chain("right_leg").pose(np.zeros(6)), model.neutral)
    assert result.solved
    assert nk.solve(model.chain("left_arm"), [0.15, 0.15, 0.1], model.neutral).solved


@pytest.mark.parametrize(
    "budget", [{"iterations": -1}, {"iterations": 1.5}, {"restarts": -1}, {"patience": 0}, {"largest_step": math.nan}]
)
def test_a_bad_budget_is_named(budget: dict[str, float]) -> None:
    with pytest.raises(InvalidInputError, match=f"budget, {next(iter(budget))}"):
        nk.Budget(**budget)


def test_a_negative_seed_is_named() -> None:
    with pytest.raises(InvalidInputError, match="seed"):
        nk.solve(robot("jaco2").chain("arm"), [0.3, 0.2, 0.3], seed=-1)


def test_the_same_call_gives_the_same_result_and_touches_nothing_global() -> None:
    arm = robot("jaco2").chain("arm")
    target = arm.pose(np.radians([20, 150, 60, 100, 30, 10])).homogeneous
    kept = target.copy()
    np.random.seed(7)  # noqa: NPY002 - the global state is what is tested
    state = np.random.get_state()[1].copy()  # noqa: NPY002
    first, again = nk.solve(arm, target, seed=3), nk.solve(arm, target, seed=3)
    np.testing.assert_array_equal(first.q, again.q)
    np.testing.assert_array_equal(target, kept)
    np.testing.assert_array_equal(np.random.get_state()[1], state)  # noqa: NPY002


BAD = np.eye(4)


@pytest.mark.parametrize(
    ("target", "message"),
    [
        (np.full(3, np.nan), "target position.*finite"),
        (np.eye(3), r"shape \(3, 3\)"),
        ([1.0, 2.0], r"shape \(2,\)"),
        (np.diag([1.001, 1.0, 1.0, 1.0]), r"violation of 0\.002"),
        (np.diag([-1.0, 1.0, 1.0, 1.0]), "violation of 2"),
        (np.eye(4) + np.outer([0, 0, 0, 1], [0, 0, 1, 0]), "last row"),
        (np.full((4, 4), np.inf), "finite"),
        ("left", "got 'left'"),
        ([[1], [2, 3]], "a position"),
    ],
)
def test_bad_targets_are_named(target: object, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        nk.solve(robot("jaco2").chain("arm"), target)


def test_a_printed_matrix_is_refused_with_the_remedy() -> None:
    """Three digits are no rotation to eight; the message names the function that makes it one."""
    from nao_kin.documents.practicum.practicum_sheet import CHECK_T_BASE_HAND
    from nao_kin.se3 import nearest_rotation

    arm = robot("jaco2").chain("arm")
    with pytest.raises(InvalidInputError, match="nearest_rotation"):
        nk.solve(arm, CHECK_T_BASE_HAND)
    target = np.array(CHECK_T_BASE_HAND)
    target[:3, :3] = nearest_rotation(target[:3, :3])
    result = nk.solve(arm, target, np.radians([170, 260, 80, 170, 170, 10]))
    assert result.solved, result.message


def test_a_result_is_no_truth_value() -> None:
    with pytest.raises(TypeError, match=r"result\.solved"):
        bool(nk.solve(robot("jaco2").chain("arm"), [0.3, 0.2, 0.3]))


def test_the_judge_believes_nobody() -> None:
    arm = robot("nao_v50_h25").chain("left_arm")
    q = neutral(arm)
    problem = Problem(arm, nk.Target.position(arm.pose(q).translation))
    assert judge(problem, Run(q, nk.Status.STALLED)).status is nk.Status.SOLVED
    away = Problem(arm, nk.Target.position([0.0, 0.0, 0.0]))
    assert judge(away, Run(q, nk.Status.SOLVED)).status is nk.Status.STALLED
    assert judge(problem, Run(np.full(5, np.nan), nk.Status.SOLVED)).status is nk.Status.NOT_FINITE
    outside = q + np.array([0, 0, 0, 1e-7, 0])  # the elbow at its upper end, one step of rounding is not that much
    just = Problem(arm, nk.Target.position(arm.pose(outside).translation))
    found = judge(just, Run(outside, nk.Status.SOLVED))
    assert found.status is nk.Status.OUTSIDE_LIMITS
    assert found.outside[0].joint == "LElbowRoll"


def test_tolerances_are_checked_and_used() -> None:
    with pytest.raises(InvalidInputError, match="tolerance position"):
        nk.Tolerances(position=-1.0)
    arm = robot("jaco2").chain("arm")
    target = arm.pose(np.radians([20, 150, 60, 100, 30, 10]))
    loose = nk.solve(arm, target, tolerances=nk.Tolerances(position=1e-2, rotation=1e-2))
    tight = nk.solve(arm, target, tolerances=nk.Tolerances(position=1e-11, rotation=1e-11))
    assert loose.solved
    assert tight.solved
    assert tight.position_error < 1e-11
    assert loose.iterations < tight.iterations


def test_results_show_themselves() -> None:
    result = nk.solve(robot("jaco2").chain("arm"), [0.3, 0.2, 0.3])
    assert repr(result).startswith("<IKResult SOLVED: Position error")
    assert "joint_3" in result._repr_html_()
    assert result.q.flags.writeable is False
