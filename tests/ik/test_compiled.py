"""The compiled loop: the same algorithm as the reference loop, however it is run, and nothing of the caller changed.

Poses are measured by `chain.pose`, which is Pinocchio and not the kernel.
"""

from __future__ import annotations

import dataclasses
import itertools
import math

import numba
import numpy as np
import pytest

from nao_kin.chain import in_limits, into_limits, neutral, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik import aim
from nao_kin.ik import compiled_loop as loop
from nao_kin.ik.compiled import run_of, solve_goal, solve_goals, tables_of
from nao_kin.ik.problem import Status
from nao_kin.ik.reference_loop import Budget
from nao_kin.kernels.joint_limits import move_inside
from nao_kin.kernels.linear import solve_positive, times_own_transpose
from nao_kin.kernels.motion import jacobian, place
from tests.conftest import robot
from tests.ik.solving import (
    CHAINS,
    ONE_STEP,
    OPTIONAL,
    chain_of,
    compiled,
    errors,
    goals_of,
    reference,
    settings,
    smallest_singular_value,
)


@pytest.mark.parametrize(("name", "part", "kind"), [*CHAINS, *OPTIONAL])
def test_a_step_from_regular_configurations_is_the_reference_loops(name, part, kind, rng: np.random.Generator) -> None:
    chain, rows = chain_of(name, part), slice(0, 6 if kind == "pose" else 3)
    checked = 0
    while checked < 1000:
        q0, q_target = random_configurations(chain, 2, rng)
        if smallest_singular_value(chain, q0, rows) < 1e-2:
            continue
        goal = chain.pose(q_target).homogeneous
        ours, theirs = (solve(chain, goal, q0, kind, ONE_STEP) for solve in (compiled, reference))
        np.testing.assert_allclose(ours.trace.q, theirs.trace.q, atol=1e-9, rtol=0)
        np.testing.assert_allclose(ours.trace.position_error, theirs.trace.position_error, atol=1e-9)
        np.testing.assert_allclose(ours.trace.rotation_error, theirs.trace.rotation_error, atol=1e-9)
        checked += 1


@pytest.mark.parametrize(("name", "part", "kind"), [*CHAINS, *OPTIONAL])
def test_whole_runs_end_like_the_reference_loop(name, part, kind, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    for goal in goals_of(chain, 40, rng):
        ours, theirs = (solve(chain, goal, neutral(chain), kind, Budget()) for solve in (compiled, reference))
        assert ours.ended is theirs.ended is Status.SOLVED
        assert (ours.starts, ours.start_moved) == (theirs.starts, theirs.start_moved)
        np.testing.assert_allclose(ours.q, theirs.q, atol=1e-6, rtol=0)


def test_runs_without_success_end_like_the_reference_loop(rng: np.random.Generator) -> None:
    chain = chain_of("jaco2", "arm")
    small = Budget(restarts=2)
    for goal in goals_of(chain, 20, rng):
        goal[:3, 3] *= 1.3
        ours, theirs = (solve(chain, goal, neutral(chain), "pose", small) for solve in (compiled, reference))
        assert ours.ended is theirs.ended
        assert ours.misses_by == pytest.approx(theirs.misses_by, abs=1e-9)
        np.testing.assert_allclose(errors(chain, ours.q, goal), errors(chain, theirs.q, goal), atol=1e-6)


def test_solve_positive_solves(rng: np.random.Generator) -> None:
    for m in (1, 3, 6, 9):
        J, b, A, x = rng.standard_normal((m, m + 2)), rng.standard_normal(m), np.empty((m, m)), np.empty(m)
        times_own_transpose(J, A)
        solve_positive(A, b, x)
        np.testing.assert_allclose(x, np.linalg.solve(J @ J.T, b), rtol=1e-9)


def test_leaf_functions_do_not_count_references() -> None:
    """The compiler's option for it is not public; without it everything still works, half as fast."""
    assert place.targetoptions["_nrt"] is False


def test_place_and_jacobian_are_the_chains(rng: np.random.Generator) -> None:
    model = robot("nao_v50_h25")
    for chain in (*(model.chain(c) for c in model.chain_frames), model.chain("l_sole", "r_sole")):
        joints = tables_of(chain).joints
        axes, tip, J = np.empty((len(joints) - 1, 6)), np.empty(12), np.empty((6, len(chain.joints)))
        for q in random_configurations(chain, 20, rng):
            place(joints, q, axes, tip)
            jacobian(joints, axes, tip, J)
            np.testing.assert_allclose(tip[:9].reshape(3, 3), chain.pose(q).rotation, atol=1e-12)
            np.testing.assert_allclose(tip[9:], chain.pose(q).translation, atol=1e-12)
            np.testing.assert_allclose(J, chain.jacobian(q), atol=1e-12)


@pytest.mark.parametrize(("name", "part", "kind"), CHAINS)
def test_a_batch_is_the_same_to_the_last_bit_however_it_is_run(name, part, kind, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    tables, wanted, goals = tables_of(chain), settings(chain, kind), goals_of(chain, 300, rng)
    q0 = neutral(chain)[None]
    threads = numba.get_num_threads()
    together = solve_goals(tables, wanted, goals, q0)
    try:
        numba.set_num_threads(1)
        np.testing.assert_array_equal(solve_goals(tables, wanted, goals, q0), together)
    finally:
        numba.set_num_threads(threads)
    order = rng.permutation(len(goals))
    np.testing.assert_array_equal(solve_goals(tables, wanted, goals[order], q0), together[order])
    single = [solve_goal(tables, wanted, goal, q0[0]) for goal in goals]
    np.testing.assert_array_equal(single, together)
    each = np.repeat(q0, len(goals), axis=0)
    np.testing.assert_array_equal(solve_goals(tables, wanted, goals, each), together)
    assert (together[:, loop.CODE] == loop.SOLVED).all()


def test_no_targets_give_no_outcomes() -> None:
    chain = chain_of("jaco2", "arm")
    assert len(solve_goals(tables_of(chain), settings(chain), np.empty((0, 4, 4)), neutral(chain)[None])) == 0


@pytest.mark.parametrize(("name", "part", "kind"), [*CHAINS, *OPTIONAL])
@pytest.mark.parametrize("from_stored", [False, True])
def test_reachable_targets_are_solved(name, part, kind, from_stored, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    goals, wanted = goals_of(chain, 1000, rng), settings(chain, kind, from_stored=from_stored)
    outcomes = solve_goals(tables_of(chain), wanted, goals, neutral(chain)[None])
    solved = outcomes[:, loop.CODE] == loop.SOLVED
    assert solved.sum() >= 999
    for outcome, goal in zip(outcomes[solved], goals[solved], strict=True):
        position, rotation = errors(chain, outcome[loop.OUTCOME :], goal)
        assert position <= 1e-6
        assert rotation <= 1e-6 or kind == "position"
        assert in_limits(chain, outcome[loop.OUTCOME :], 1e-12)
        assert outcome[loop.POSITION_ERROR] == pytest.approx(position, abs=1e-12)


# What makes no sense, and what is moved


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused(bad: float) -> None:
    chain = chain_of("jaco2", "arm")
    good = chain.pose(neutral(chain)).homogeneous
    for i, j in itertools.product(range(3), range(4)):
        goal = good.copy()
        goal[i, j] = bad
        outcome = solve_goal(tables_of(chain), settings(chain), goal, neutral(chain))
        assert outcome[loop.CODE] == loop.BAD_GOAL
        assert in_limits(chain, outcome[loop.OUTCOME :])
        with pytest.raises(InvalidInputError, match="finite"):
            run_of(outcome, aim.POSE)
    q0 = neutral(chain)
    q0[3] = bad
    outcome = solve_goal(tables_of(chain), settings(chain), good, q0)
    assert (outcome[loop.CODE], outcome[loop.AMOUNT]) == (loop.BAD_START, 3)
    with pytest.raises(InvalidInputError, match="index 3"):
        run_of(outcome, aim.POSE)


def test_a_rotation_that_is_none_is_refused_with_its_size() -> None:
    chain = chain_of("jaco2", "arm")
    T = chain.pose(neutral(chain)).homogeneous
    for R, size in [(1.01 * T[:3, :3], 0.0201), (T[:3, :3] @ np.diag([1, 1, -1]), 2.0)]:
        goal = T.copy()
        goal[:3, :3] = R
        outcome = solve_goal(tables_of(chain), settings(chain), goal, neutral(chain))
        assert outcome[loop.CODE] == loop.BAD_GOAL
        assert outcome[loop.AMOUNT] == pytest.approx(size)
    goal = np.array([[0.0, 1, 0, 0], [0, 0, 0, 0], [2, 0, 0, 0], [0, 0, 0, 1]])
    assert aim.goal_violation(aim.POINTING, goal) == pytest.approx(1.0)
    assert aim.goal_violation(aim.POSITION, goal) == 0.0


def test_a_start_outside_the_limits_is_moved_inside_and_that_is_said(rng: np.random.Generator) -> None:
    for name, part, kind in CHAINS:
        chain = chain_of(name, part)
        goal = goals_of(chain, 1, rng)[0]
        outside = np.where(np.isfinite(chain.upper), chain.upper, 0.0) + 0.5
        for q0, moved in [(outside, True), (neutral(chain), False)]:
            before = q0.copy()
            run = compiled(chain, goal, q0, kind)
            assert run.start_moved is moved
            np.testing.assert_allclose(run.trace.q[0], into_limits(chain, before), atol=1e-15)
            np.testing.assert_array_equal(q0, before)


def test_the_callers_arrays_stay_as_they_are(rng: np.random.Generator) -> None:
    chain = chain_of("nao_v50_h25", "left_leg")
    goals, q0, tables, wanted = goals_of(chain, 8, rng), neutral(chain)[None] + 9.0, tables_of(chain), settings(chain)
    given = [goals, q0, wanted, *(getattr(tables, f.name) for f in dataclasses.fields(tables))]
    before = [np.copy(array) for array in given]
    state = np.random.get_state()[1].copy()  # noqa: NPY002 (the global state is what is being watched)
    solve_goals(tables, wanted, goals, q0)
    solve_goal(tables, wanted, goals[0], q0[0])
    for array, was in zip(given, before, strict=True):
        np.testing.assert_array_equal(array, was)
    np.testing.assert_array_equal(np.random.get_state()[1], state)  # noqa: NPY002


# Limits


@pytest.mark.parametrize(("name", "part", "kind"), [*CHAINS, ("nao_v50_h25", "head", "orientation")])
def test_every_iterate_is_inside_the_limits(name, part, kind, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    for goal in goals_of(chain, 30, rng):
        run = compiled(chain, goal, neutral(chain), kind)
        assert run.trace is not None
        assert len(run.trace.q) == run.iterations + run.starts
        assert all(in_limits(chain, q, 1e-12) for q in run.trace.q)
        assert np.isfinite(run.trace.position_error).all() == (kind != "orientation")


def test_moving_inside_is_the_chains_rule(rng: np.random.Generator) -> None:
    model = robot("nao_v50_h25")
    for chain in (
        model.chain("head"),
        model.chain("left_leg"),
        model.chain("right_leg"),
        model.chain("l_sole", "Head"),
    ):
        tables = tables_of(chain)
        assert len(tables.coupled) > 0
        for q in rng.uniform(-3.0, 3.0, (500, len(chain.joints))):
            moved = q.copy()
            assert move_inside(moved, tables.limits, tables.coupled) is not np.array_equal(moved, q)
            np.testing.assert_allclose(moved, into_limits(chain, q), atol=1e-15)
