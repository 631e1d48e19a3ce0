"""Batches: rows are single solves, whatever the order and the threads, and nothing is believed."""

from __future__ import annotations

import numba
import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.chain import in_limits, random_configurations
from nao_kin.errors import AuditError, InvalidInputError
from nao_kin.ik import batch
from nao_kin.ik.target import Target
from nao_kin.se3 import position_distance, rotation_distance
from tests.conftest import robot

CASES = [("jaco2", "arm"), ("nao_v50_h25", "left_leg"), ("nao_v50_h25", "right_leg")]


@pytest.mark.parametrize(("name", "chain_name"), CASES)
def test_rows_are_single_solves(name: str, chain_name: str, rng: np.random.Generator) -> None:
    chain = robot(name).chain(chain_name)
    targets = chain.poses(random_configurations(chain, 150, rng))
    result = nk.solve_batch(chain, targets)
    assert result.solved.all(), repr(result)
    for i in range(0, 150, 7):
        single = nk.solve(chain, targets[i])
        np.testing.assert_array_equal(result.q[i], single.q)
        assert result.status[i] is single.status
        assert result.iterations[i] == single.iterations
        assert result.position_error[i] == pytest.approx(single.position_error, abs=1e-14)
        assert result.rotation_error[i] == pytest.approx(single.rotation_error, abs=1e-14)


def test_every_row_holds_by_the_whole_robot(rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("left_leg")
    targets = chain.poses(random_configurations(chain, 60, rng))
    result = nk.solve_batch(chain, targets)
    for q, target in zip(result.q, targets, strict=True):
        pose = chain.robot.pose(dict(zip(chain.joint_names, q, strict=True)), chain.tip, chain.base)
        wanted = pin.SE3(target)
        assert position_distance(pose, wanted) <= 1e-6
        assert rotation_distance(pose, wanted) <= 1e-6
        assert in_limits(chain, q, 1e-14)


def test_order_threads_and_chunks_do_not_matter(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    chain = robot("jaco2").chain("arm")
    targets = chain.poses(random_configurations(chain, 200, rng))
    targets[::9, 0, 3] += 3.0  # some out of reach
    expected = nk.solve_batch(chain, targets)
    order = rng.permutation(len(targets))
    np.testing.assert_array_equal(nk.solve_batch(chain, targets[order]).q, expected.q[order])
    threads = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        alone = nk.solve_batch(chain, targets)
    finally:
        numba.set_num_threads(threads)
    np.testing.assert_array_equal(alone.q, expected.q)
    monkeypatch.setattr(batch, "CHUNK", 17)
    chunked = nk.solve_batch(chain, targets)
    np.testing.assert_array_equal(chunked.q, expected.q)
    np.testing.assert_array_equal(chunked.codes, expected.codes)
    assert expected.counts()[nk.Status.OUT_OF_REACH] == len(targets[::9])


def test_positions_pointing_and_targets_of_one_kind(rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("left_arm")
    poses = chain.poses(random_configurations(chain, 50, rng))
    by_position = nk.solve_batch(chain, poses[:, :3, 3], audit="all")
    assert by_position.solved.all()
    assert np.isnan(by_position.rotation_error).all()
    pointing = [Target.pointing(T[:3, 3], T[:3, 0]) for T in poses]
    assert nk.solve_batch(chain, pointing, audit="all").solved.all()
    with pytest.raises(InvalidInputError, match="2 sorts"):
        nk.solve_batch(chain, [pointing[0], Target.position([0, 0, 0])])


def test_each_row_may_have_its_own_start(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    Q = random_configurations(chain, 40, rng)
    result = nk.solve_batch(chain, chain.poses(Q), Q)
    assert result.solved.all()
    assert result.iterations.max() == 0
    np.testing.assert_array_equal(result.q, Q)
    with pytest.raises(InvalidInputError, match="one for each of the 40"):
        nk.solve_batch(chain, chain.poses(Q), Q[:3])


def test_an_empty_batch_is_one() -> None:
    chain = robot("jaco2").chain("arm")
    for nothing in (np.empty((0, 4, 4)), np.empty((0, 3)), []):
        result = nk.solve_batch(chain, nothing)
        assert len(result) == 0
        assert result.q.shape == (0, 6)
        assert result.counts() == {}


def test_a_lying_kernel_is_caught(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    chain = robot("jaco2").chain("arm")
    targets = chain.poses(random_configurations(chain, 100, rng))
    honest = batch.solve_goals

    def claims_success(*arguments):
        outcomes = honest(*arguments)
        outcomes[:, -6:] += 0.01  # other joints than those that were found
        return outcomes

    monkeypatch.setattr(batch, "solve_goals", claims_success)
    assert not nk.solve_batch(chain, targets).solved.any()
    monkeypatch.setattr(batch, "solve_goals", honest)
    from nao_kin.kernels import audit

    good = audit.tips
    monkeypatch.setattr(audit, "tips", lambda path, q: good(path, q) + 1e-7)
    with pytest.raises(AuditError, match="Please report it"):
        nk.solve_batch(chain, targets)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda T: T[:, :3, :3], r"targets.*shape \(3, 3, 3\)"),
        (lambda _: np.array([[0.3, 0, 0.3], [0, np.nan, 0]]), "target 1: .*not finite"),
        (lambda T: T * np.array([1.0, 1.1, 1.0])[:, None, None], "target 1: .*violation of 0.21"),
        (lambda _: "abc", "targets"),
    ],
)
def test_bad_targets_name_their_row(change, message: str, rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    with pytest.raises(InvalidInputError, match=message):
        nk.solve_batch(chain, change(chain.poses(random_configurations(chain, 3, rng))))


def test_the_callers_arrays_are_untouched(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    targets, q0 = chain.poses(random_configurations(chain, 20, rng)), np.full(6, 9.0)
    kept = targets.copy()
    result = nk.solve_batch(chain, targets, q0)
    np.testing.assert_array_equal(targets, kept)
    np.testing.assert_array_equal(q0, np.full(6, 9.0))
    result.q[:] = 0.0
    np.testing.assert_array_equal(targets, kept)
    with pytest.raises(TypeError, match="solved"):
        bool(result)
    assert "SOLVED" in result._repr_html_()


@pytest.mark.parametrize("tolerance", [0.0, 1e-16, 1e-3])
def test_verdicts_at_the_edge_of_the_tolerance_are_no_disagreement(tolerance: float, rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain("left_arm")
    Q = random_configurations(chain, 100, rng)
    targets = chain.poses(Q)
    targets[:, 2, 3] += tolerance
    tolerances, budget = nk.Tolerances(position=tolerance, rotation=1.0), nk.Budget(iterations=0, restarts=0)
    result = nk.solve_batch(chain, targets, Q, tolerances=tolerances, budget=budget, audit="all")
    assert len(result) == 100


def test_large_numbers_are_no_disagreement(rng: np.random.Generator) -> None:
    table = nk.DHChain.from_table([(0.3, 0, 0, 0.7)], "standard")
    once = nk.Budget(iterations=0, restarts=0)
    for q in (1e8, 1e300):
        nk.solve_batch(table, [[0.3, 0.0, 0.0]], [q], budget=once, audit="all")
    far = nk.DHChain.from_table([(3e7, 0.5, 1e6, 0)] * 3, "standard")
    nk.solve_batch(far, far.poses(rng.uniform(-3, 3, (20, 3))), budget=once, audit="all")
    nk.solve_batch(robot("jaco2").chain("arm"), [[1e300, 0.0, 0.0]], audit="all")


def test_a_mask_is_not_lost() -> None:
    masked = np.ma.masked_array(np.full((2, 3), 0.2), mask=True)
    with pytest.raises(InvalidInputError, match="mask"):
        nk.solve_batch(robot("jaco2").chain("arm"), masked)
