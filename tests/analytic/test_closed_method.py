"""`solve(method="closed")`: the nearest branch within limits, judged as any other solution."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import from_xyz_rpy
from tests.conftest import robot


def test_the_branch_nearest_to_the_start_is_taken(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    for _ in range(50):
        q = rng.uniform(np.maximum(chain.lower, -6.0), np.minimum(chain.upper, 6.0))
        q0 = np.clip(q + rng.uniform(-0.02, 0.02, 6), chain.lower, chain.upper)
        result = nk.solve(chain, chain.pose(q), q0, method="closed")
        others = nk.solve_all(chain, chain.pose(q)).solved
        assert result.solved
        assert result.branch
        moves = [np.abs(np.remainder(other.q - q0 + np.pi, 2 * np.pi) - np.pi).max() for other in others]
        assert np.abs(result.q - q0).max() == pytest.approx(min(moves), abs=1e-9)


def test_the_start_may_be_turns_away_or_a_posture() -> None:
    chain = robot("jaco2").chain("arm")
    q = np.array([0.5, 2.5, 1.5, 0.3, -0.7, 1.1])
    far = q + 2 * np.pi * np.array([2, 0, 0, -1, 0, 3])
    assert np.abs(nk.solve(chain, chain.pose(q), far, method="closed").q - far).max() < 1e-9
    posture = dict(zip(chain.joint_names, q.tolist(), strict=True))
    assert np.abs(nk.solve(chain, chain.pose(q), posture, method="closed").q - q).max() < 1e-9


def test_what_is_out_of_reach_is_a_value_that_says_so() -> None:
    chain = robot("jaco2").chain("arm")
    result = nk.solve(chain, from_xyz_rpy([5.0, 0.0, 0.0], [0.0, 0.0, 0.0]), method="closed")
    assert not result.solved
    assert result.status.name == "OUT_OF_REACH"
    q = np.array([0.5, 2.5, 1.5, 0.3, -0.7, 1.1])
    assert nk.solve(chain, chain.pose(q), q - 0.5, method="closed", jump=0.01).status.name == "JUMPED"


@pytest.mark.parametrize("option", [{"trace": True}, {"budget": nk.Budget()}, {"engine": "reference"}])
def test_options_of_iterations_are_refused(option: dict[str, object]) -> None:
    chain = robot("jaco2").chain("arm")
    with pytest.raises(InvalidInputError, match=next(iter(option))):
        nk.solve(chain, np.eye(4), method="closed", **option)  # type: ignore[call-overload]
