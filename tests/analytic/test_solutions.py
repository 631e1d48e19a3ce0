"""Laws of every closed form: nothing is lost, nothing is wrong, and Newton knows no more."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.bench.all_solutions import apart, least_singular_value, multi_start
from nao_kin.chain import random_configurations
from tests.analytic.goals import asked, chain_of, errors, given_of, locked_of, move, targets_of

if TYPE_CHECKING:
    from nao_kin.analytic.form import GoalKind


@pytest.mark.parametrize(("name", "part", "kind"), asked())
def test_joints_within_limits_are_among_the_solutions(
    name: str, part: str, kind: GoalKind, rng: np.random.Generator
) -> None:
    chain = chain_of(name, part)
    Q = random_configurations(chain, 400, rng)
    targets = targets_of(chain, kind, Q, rng)
    found = nk.solve_all_batch(chain, targets, locked=locked_of(chain, kind, Q), audit="all")
    goals = np.array([target.goal for target in targets])
    free = np.ones(Q.shape[1], dtype=np.bool_)
    free[list(given_of(chain, kind))] = False
    regular = least_singular_value(kind, goals, chain, Q, free) > 1e-6
    moves = np.where(found.solved, move(found.q, Q[:, None, :]), np.inf).min(axis=1)
    assert regular.sum() > 390
    assert moves[regular].max() <= 1e-9
    assert found.solved.any(axis=1).all()
    reached = np.fmax(np.nan_to_num(found.position_error), np.nan_to_num(found.rotation_error))[found.found]
    assert reached.max() <= 1e-10
    assert np.isfinite(found.q[found.found]).all()
    assert np.isnan(found.q[~found.found]).all()


@pytest.mark.parametrize(
    ("name", "part", "kind"),
    [case for case in asked() if case[0] in ("nao", "nao_v50_h21") and case[1] in ("left_arm", "CameraTop_frame")],
)
def test_newton_finds_no_solution_that_is_missing(
    name: str, part: str, kind: GoalKind, rng: np.random.Generator
) -> None:
    chain = chain_of(name, part)
    Q = random_configurations(chain, 12, rng)
    targets = targets_of(chain, kind, Q, rng)
    locked = np.full(Q.shape, np.nan)
    given = list(given_of(chain, kind))
    locked[:, given] = Q[:, given]
    found = nk.solve_all_batch(chain, targets, locked=locked_of(chain, kind, Q))
    by_newton = multi_start(chain, kind, np.array([t.goal for t in targets]), locked, 36, rng)
    assert sum(map(len, by_newton)) >= 0.95 * found.found.sum()  # or it would not say much
    for i, solutions in enumerate(by_newton):
        for q in solutions:
            assert apart(found.q[i][found.found[i]], q) < 1e-5


@pytest.mark.parametrize(("name", "part", "kind"), asked()[::3])
def test_one_by_one_and_in_a_batch_alike(name: str, part: str, kind: GoalKind, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    Q = random_configurations(chain, 10, rng)
    targets = targets_of(chain, kind, Q, rng)
    batch = nk.solve_all_batch(chain, targets, locked=locked_of(chain, kind, Q))
    for i, target in enumerate(targets):
        single = nk.solve_all(chain, target, locked=locked_of(chain, kind, Q[i]))
        places = np.flatnonzero(batch.found[i])
        assert {batch.branch(i, k) for k in places} == {result.branch for result in single}
        assert len(places) == len(single)
        for k in places:
            assert min(np.abs(batch.q[i, k] - result.q).max() for result in single) == 0.0


def test_every_solution_is_judged_and_those_within_limits_come_first(rng: np.random.Generator) -> None:
    chain = chain_of("nao", "left_arm")
    for q in random_configurations(chain, 50, rng):
        results = nk.solve_all(chain, chain.pose(q))
        statuses = [result.status for result in results]
        assert statuses == sorted(statuses, key=[nk.Status.SOLVED, nk.Status.OUTSIDE_LIMITS].index)
        assert len({result.branch for result in results}) == 4
        for result in results:
            assert errors(result) <= 1e-12
            assert bool(result.outside) is not result.solved
        assert results.reason == ""
        assert 1 <= len(results.solved) < len(results)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_elbow_yaws_beyond_a_right_angle_are_solved(sign: float, rng: np.random.Generator) -> None:
    for part in ("left_arm", "right_arm"):
        chain = chain_of("nao", part)
        Q = random_configurations(chain, 100, rng)
        Q[:, 2] = sign * rng.uniform(0.51 * np.pi, 2.08, len(Q))
        for q in Q:
            assert move(nk.nearest(nk.solve_all(chain, chain.pose(q)), q).q, q) <= 1e-9


def test_a_mirrored_pose_has_mirrored_solutions(rng: np.random.Generator) -> None:
    left, right = chain_of("nao", "left_arm"), chain_of("nao", "right_arm")
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    signs = np.array([1.0, -1.0, -1.0, -1.0, -1.0])
    for q in random_configurations(left, 20, rng):
        T = left.pose(q).homogeneous
        ours, theirs = nk.solve_all(left, T), nk.solve_all(right, mirror @ T @ mirror)
        assert len(ours) == len(theirs)
        for result in ours:
            assert min(move(other.q, signs * result.q) for other in theirs) <= 1e-9


def test_a_pose_off_the_reachable_set_is_refused_with_its_distance(rng: np.random.Generator) -> None:
    """The elbow point a little farther from the shoulder than the upper arm is long."""
    upper = np.hypot(0.105, 0.015)
    for name in ("nao", "nao_v50_h21"):
        chain = chain_of(name, "left_arm")
        for q in random_configurations(chain, 20, rng):
            T = chain.pose(q)
            at_elbow = T.translation - T.rotation @ [0.05595 + 0.05775, 0.0, -0.01231]
            outwards = (at_elbow - [0.0, 0.098, 0.1]) / upper
            T.translation = T.translation + 3e-6 * outwards
            results = nk.solve_all(chain, T)
            assert len(results) == 0
            assert results.reason.startswith("No joints reach the target")
            assert "3e-06 m" in results.reason
            T.translation = T.translation - 2.5e-6 * outwards  # which is within tolerance
            assert nk.solve_all(chain, T).solved


def test_a_position_beyond_the_reach_by_micrometres_is_refused() -> None:
    chain, locked = chain_of("nao", "left_arm"), {"LElbowYaw": -0.4, "LWristYaw": 0.3}
    wrist = np.array([0.11370, np.sin(0.3) * 0.01231, -np.cos(0.3) * 0.01231])  # the tip seen from the elbow point
    rolls = np.linspace(-2.0, 2.0, 4001)
    q = np.array([[0.2, 0.3, -0.4, roll, 0.3] for roll in rolls])
    far = np.linalg.norm(chain.poses(q)[:, :3, 3] - [0.0, 0.098, 0.1], axis=1)
    best = q[int(far.argmax())]
    assert np.isclose(np.linalg.norm(wrist), np.hypot(0.1137, 0.01231))
    for _ in range(30):  # Newton on the distance's slope
        slope, curve = (_distance(chain, best, 1e-4, order) for order in (1, 2))
        best[3] -= slope / curve
    p = chain.pose(best).translation
    outwards = (p - [0.0, 0.098, 0.1]) / np.linalg.norm(p - [0.0, 0.098, 0.1])
    assert len(nk.solve_all(chain, p - 1e-5 * outwards, locked=locked)) == 4
    assert len(nk.solve_all(chain, p, locked=locked)) >= 2
    assert len(nk.solve_all(chain, p + 3e-6 * outwards, locked=locked)) == 0


def _distance(chain: nk.Chain, q: np.ndarray, step: float, order: int) -> float:
    """First or second difference of the tip's distance from the shoulder, by elbow roll."""
    values = []
    for k in (-1.0, 0.0, 1.0):
        moved = q.copy()
        moved[3] += k * step
        values.append(float(np.linalg.norm(chain.pose(moved).translation - [0.0, 0.098, 0.1])))
    if order == 1:
        return (values[2] - values[0]) / (2.0 * step)
    return (values[2] - 2.0 * values[1] + values[0]) / step**2


def test_a_far_target_is_refused_without_nan() -> None:
    for name in ("nao", "nao_v50_h21"):
        chain = chain_of(name, "left_arm")
        locked = {"LElbowYaw": 0.1} | ({"LWristYaw": 0.2} if name == "nao" else {})
        for size in (1.0, 1e6, 1e150, 1e300):
            T = np.eye(4)
            T[:3, 3] = size
            for target, given in (
                (nk.Target.pose(T), None),
                (nk.Target.position(T[:3, 3]), locked),
                (nk.Target.pointing(T[:3, 3], (1, 2, 3)), None),
            ):
                results = nk.solve_all(chain, target, locked=given)
                assert len(results) == 0
                assert results.reason
        head = chain_of(name, "CameraTop_frame")
        assert len(nk.solve_all(head, [1e150, 0.0, 0.0])) == 0
