"""What is kept of a closed form's solutions: what chain.pose confirms, once, and nothing that only claims to be one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from nao_kin.analytic.certifying import ABSENT, SOLVED, Certificate, Ranges, Written, certify, placed
from nao_kin.chain import outside_limits, random_configurations
from nao_kin.ik.problem import Status
from nao_kin.ik.target import KINDS
from nao_kin.tolerances import TOLERANCES
from tests.conftest import robot

if TYPE_CHECKING:
    import nao_kin as nk

TURN = 2.0 * math.pi


def certified(chain: nk.Chain, goals: np.ndarray, rows: np.ndarray, counts: np.ndarray) -> Certificate:
    n = len(chain.joints)
    written = Written(rows, counts, np.arange(n), np.zeros(n))
    certificate = Certificate.blank(len(goals), rows.shape[1], n)
    certify(chain.joint_path, Ranges.of(chain), KINDS["pose"], 63, goals, written, TOLERANCES, certificate)
    return certificate


def claims(chain: nk.Chain, Q: np.ndarray, places: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows (N, B, n + 2) that claim Q (N, n) in every place, and counts (N,) that say so."""
    rows = np.zeros((len(Q), places, Q.shape[1] + 2))
    rows[:, :, :-2] = Q[:, None]
    rows[:, :, -2:] = 3, 2
    return rows, np.full(len(Q), places, dtype=np.int64)


def test_claims_that_miss_are_not_kept(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    Q = random_configurations(chain, 50, rng)
    rows, counts = claims(chain, Q, 6)
    rows[:, 0, 2] += 1e-5  # beyond tolerance
    rows[:, 1, 0] = np.nan
    rows[:, 2, 5] = np.inf
    rows[:, 3, 1] += 1e-8  # within tolerance, yet it just misses where place 4 meets
    rows[:, 5, 3] += 3 * TURN  # of a joint without limits: another solution
    certificate = certified(chain, chain.poses(Q), rows, counts)
    assert (certificate.codes[:, :4] == ABSENT).all()
    assert (certificate.codes[:, 4:] == SOLVED).all()
    np.testing.assert_array_equal(certificate.q[:, 4], Q)
    assert (certificate.branches[:, 4] == (3, 2)).all()
    for values in (certificate.q[:, :4], certificate.position_error[:, :4], certificate.rotation_error[:, :4]):
        assert np.isnan(values).all()


def test_a_solution_is_kept_once(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    Q = random_configurations(chain, 50, rng)
    rows, counts = claims(chain, Q, 3)
    rows[:, 1, 1] += TURN  # of a joint with limits, into which it is brought back
    rows[:, 2] = rows[:, 1]
    counts[:] = 2
    certificate = certified(chain, chain.poses(Q), rows, counts)
    assert certificate.codes.tolist() == [[SOLVED, ABSENT, ABSENT]] * len(Q)


@pytest.mark.parametrize("part", ["head", "left_leg"])
def test_limits_are_those_of_the_chain_coupled_ones_included(part: str, rng: np.random.Generator) -> None:
    chain = robot("nao_v50_h25").chain(part)
    Q = rng.uniform(1.3 * chain.lower, 1.3 * chain.upper, (2000, len(chain.joints)))
    rows, counts = claims(chain, Q, 1)
    codes = certified(chain, chain.poses(Q), rows, counts).codes[:, 0]
    expected = [Status.OUTSIDE_LIMITS.number if outside_limits(chain, q, TOLERANCES.limits) else SOLVED for q in Q]
    assert codes.tolist() == expected
    assert len(set(expected)) == 2


def test_errors_are_what_the_chain_measures(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    Q = random_configurations(chain, 200, rng)
    rows, counts = claims(chain, Q + 2e-7 * rng.standard_normal(Q.shape), 1)
    certificate = certified(chain, chain.poses(Q), rows, counts)
    for i in np.flatnonzero(certificate.codes[:, 0] == SOLVED):
        T, goal = chain.pose(certificate.q[i, 0]), chain.pose(Q[i])
        assert certificate.position_error[i, 0] == pytest.approx(
            np.linalg.norm(T.translation - goal.translation), abs=1e-14
        )
        turn = 0.5 * math.sqrt(2.0) * np.linalg.norm(T.rotation - goal.rotation)  # of a small angle
        assert certificate.rotation_error[i, 0] == pytest.approx(turn, abs=1e-14)
    assert (certificate.codes[:, 0] == SOLVED).sum() > 50


def test_joints_outside_their_limits_move_by_whole_turns_and_sliding_ones_never(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    ranges = Ranges.of(chain)
    for q in random_configurations(chain, 100, rng):
        turns = rng.integers(-3, 4, len(q))
        brought = placed(q + TURN * turns, ranges)
        moved = (brought - q) / TURN
        np.testing.assert_allclose(moved, np.round(moved), atol=1e-12)
        limited = np.isfinite(chain.lower)
        assert (brought[limited] >= chain.lower[limited]).all()
        assert (brought[limited] <= chain.upper[limited]).all()
        np.testing.assert_array_equal(brought[~limited], (q + TURN * turns)[~limited])
    sliding = ranges._replace(winding=np.zeros_like(ranges.winding))
    np.testing.assert_array_equal(placed(q + TURN, sliding), q + TURN)
