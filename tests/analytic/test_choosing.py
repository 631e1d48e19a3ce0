"""Choosing among solutions: the nearest, every winding, and what batches refuse."""

from __future__ import annotations

import copy
import dataclasses
import math

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import ChainJoint, random_configurations
from nao_kin.documents.kofinas import arm
from nao_kin.errors import AuditError, InvalidInputError
from tests.analytic.goals import chain_of, move


def test_the_nearest_has_the_least_largest_move(rng: np.random.Generator) -> None:
    chain = arm("left")  # without limits, so that every solution is within them
    for q in rng.uniform(-3, 3, (30, 5)):
        results = nk.solve_all(chain, chain.pose(q))
        start = rng.uniform(-6, 6, 5)
        chosen = nk.nearest(results, start)
        assert move(chosen.q, start) == min(move(result.q, start) for result in results)
        assert move(nk.nearest(results, q + 2.0 * math.pi).q, q) <= 1e-9


def test_the_nearest_is_within_limits_if_one_is() -> None:
    chain = chain_of("nao", "left_arm")
    q = np.array([0.3, 0.4, -0.5, -0.6, 0.7])
    results = nk.solve_all(chain, chain.pose(q))
    outside = next(result for result in results if not result.solved)
    assert nk.nearest(results, outside.q).solved
    assert nk.nearest([outside], outside.q) is outside


def test_the_nearest_of_none_says_why_there_is_none() -> None:
    chain = chain_of("nao", "left_arm")
    T = chain.pose(np.array([0.3, 0.4, -0.5, -0.6, 0.7]))
    T.translation = T.translation + np.array([0.1, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match="No joints reach the target"):
        nk.nearest(nk.solve_all(chain, T), np.zeros(5))
    with pytest.raises(InvalidInputError, match="5 numbers"):
        nk.nearest(nk.solve_all(chain, chain.pose(np.zeros(5))), np.zeros(4))


def wide_arm(ranges: dict[int, tuple[float, float]]) -> nk.DHChain:
    """An arm whose joints turn through the given ranges, the others through ±π."""
    table = arm("left")
    rows = tuple(
        dataclasses.replace(
            row, lower=ranges.get(k, (-math.pi, math.pi))[0], upper=ranges.get(k, (-math.pi, math.pi))[1]
        )
        for k, row in enumerate(table.rows)
    )
    return dataclasses.replace(table, rows=rows)


def test_windings_are_all_whole_turns_within_limits() -> None:
    chain = wide_arm({0: (-3.0 * math.pi, 3.0 * math.pi), 4: (-math.pi, 2.0 * math.pi)})
    q = np.array([0.3, 0.4, -0.5, -0.6, -0.7])
    middle, every = nk.solve_all(chain, chain.pose(q)), nk.solve_all(chain, chain.pose(q), windings=True)
    assert len(middle) == 4
    expected = 0
    for result in middle:
        turns = [
            sum(lower <= value + k * 2.0 * math.pi <= upper for k in range(-3, 4))
            for value, lower, upper in zip(result.q, chain.lower, chain.upper, strict=True)
        ]
        expected += math.prod(turns)
    assert len(every) == expected > 4
    assert all(result.solved for result in every)
    assert len({tuple(np.round(result.q, 9)) for result in every}) == expected


def test_a_range_away_from_zero_gets_the_turn_that_is_within() -> None:
    chain = wide_arm({0: (math.pi, 3.0 * math.pi), 2: (-7.0, -3.2)})
    q = np.array([4.0, 0.4, -5.0, -0.6, -0.7])
    results = nk.solve_all(chain, chain.pose(q)).solved
    assert min(np.abs(result.q - q).max() for result in results) <= 1e-9


def test_joints_know_their_kind() -> None:
    assert all(isinstance(joint, ChainJoint) and joint.kind == "revolute" for joint in wide_arm({}).joints)


def test_solutions_print_and_copy() -> None:
    chain = chain_of("nao", "left_arm")
    results = nk.solve_all(chain, chain.pose(np.array([0.3, 0.4, -0.5, -0.6, 0.7])))
    assert "elbow bent to −" in repr(results)
    assert "<table>" in results._repr_html_()
    assert "OUTSIDE_LIMITS" in results.table("title").note
    again = copy.copy(nk.Solutions((), "why"))
    assert (tuple(again), again.reason) == ((), "why")
    assert "why" in repr(again)


def test_a_batch_gives_each_target_its_own_locked_values(rng: np.random.Generator) -> None:
    chain = chain_of("nao", "left_arm")
    Q = random_configurations(chain, 30, rng)
    points = chain.poses(Q)[:, :3, 3]
    found = nk.solve_all_batch(chain, points, locked={"LElbowYaw": Q[:, 2], "LWristYaw": 0.25})
    present = found.q[found.found]
    rows = np.argwhere(found.found)[:, 0]
    np.testing.assert_allclose(move(present[:, 2:3], Q[rows, 2:3]), 0.0, atol=1e-12)
    np.testing.assert_allclose(present[:, 4], 0.25, atol=1e-12)
    assert len(found) == 30
    assert "30" in repr(found)
    with pytest.raises(TypeError, match="not a truth value"):
        bool(found)


def test_batches_do_not_depend_on_order_or_on_chunks(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    chain = chain_of("nao", "right_arm")
    T = chain.poses(random_configurations(chain, 60, rng))
    whole = nk.solve_all_batch(chain, T)
    order = rng.permutation(60)
    np.testing.assert_array_equal(nk.solve_all_batch(chain, T[order]).q, whole.q[order])
    monkeypatch.setattr("nao_kin.analytic.solution_batch._BLOCK", 7)
    again = nk.solve_all_batch(chain, T)
    for name in ("q", "codes", "branches", "position_error", "rotation_error"):
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))


@pytest.mark.parametrize("row", [0, 7])
def test_a_batch_names_the_row_that_is_no_target(row: int) -> None:
    T = np.tile(np.eye(4), (10, 1, 1))
    for bad, told in ((np.nan, "not finite"), (2.0, "violation of")):
        T[row, 0, 0] = bad
        with pytest.raises(InvalidInputError, match=f"target {row}: .*{told}"):
            nk.solve_all_batch(chain_of("nao", "left_arm"), T)


@pytest.mark.parametrize(
    ("targets", "options", "message"),
    [
        (np.zeros((3, 5)), {}, "targets"),
        (np.zeros((3, 3)), {"locked": {"LElbowYaw": [0.1, 0.2], "LWristYaw": 0.1}}, "each of the 3 targets"),
        (np.zeros((3, 3)), {"locked": {"LElbowYaw": np.zeros((3, 1)), "LWristYaw": 0.1}}, "locked LElbowYaw"),
        (np.tile(np.eye(4), (3, 1, 1)), {"locked": {"LWristYaw": [0.1, 0.2, 0.3]}}, "as the joint is held"),
        (np.tile(np.eye(4), (3, 1, 1)), {"audit": "none"}, "'sample' or 'all'"),
    ],
)
def test_what_a_batch_refuses(targets: np.ndarray, options: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        nk.solve_all_batch(chain_of("nao", "left_arm"), targets, **options)


def test_an_empty_batch_is_empty() -> None:
    assert len(nk.solve_all_batch(chain_of("nao", "left_arm"), np.empty((0, 4, 4)))) == 0


def test_a_forward_kinematics_that_disagrees_fails_the_batch(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = chain_of("nao", "left_arm")
    T = chain.poses(random_configurations(chain, 5, rng))
    whole = chain.tip_at
    monkeypatch.setattr(type(chain), "tip_at", lambda _, q: (whole(q)[0], whole(q)[1] + 1e-7))
    with pytest.raises(AuditError):
        nk.solve_all_batch(chain, T)
