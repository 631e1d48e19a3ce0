"""One solution by closed form: the nearest branch within limits, alone, in a batch and along a path."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import in_limits, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import from_xyz_rpy
from tests.conftest import needs_examples, robot

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

TURN = 2.0 * math.pi
CHAINS = [("jaco2", "arm"), ("nao", "left_arm"), ("nao", "left_leg"), ("nao", "head")]


def turns_within_limits(chain: nk.Chain, q: Floats) -> list[Floats]:
    """Every whole turn of some joints that is within limits, ±2 turns where there are none."""
    choices = [
        [v + k * TURN for k in range(-3, 4) if low - 1e-9 <= v + k * TURN <= high + 1e-9]
        for v, low, high in zip(q.tolist(), chain.lower, chain.upper, strict=True)
    ]
    return [np.array(values) for values in itertools.product(*choices)]


def moves(q: Floats, start: Floats) -> float:
    return float(np.abs(q - start).max())


@pytest.mark.parametrize(("name", "part"), CHAINS)
def test_of_all_branches_and_turns_within_limits_it_is_the_nearest(
    name: str, part: str, rng: np.random.Generator
) -> None:
    chain = robot(name).chain(part)
    starts = random_configurations(chain, 20, rng) + TURN * rng.integers(-1, 2, (20, 1)) * np.isinf(chain.lower)
    for q, start in zip(random_configurations(chain, 20, rng), starts, strict=True):
        result = nk.solve(chain, chain.pose(q), start, method="closed")
        every = [w for s in nk.solve_all(chain, chain.pose(q)).solved for w in turns_within_limits(chain, s.q)]
        assert result.solved
        assert result.branch in {solution.branch for solution in nk.solve_all(chain, chain.pose(q))}
        assert moves(result.q, start) == pytest.approx(min(moves(w, start) for w in every if in_limits(chain, w, 1e-9)))
        assert np.abs(chain.pose(result.q).homogeneous - chain.pose(q).homogeneous).max() < 1e-9


def test_turns_of_a_joint_with_two_turns_of_room_are_chosen_too(rng: np.random.Generator) -> None:
    needs_examples()
    chain = robot("ur5").chain("base_link", "ee_link")
    for q in rng.uniform(chain.lower, chain.upper, (50, 6)):
        start = np.clip(q + rng.uniform(-0.05, 0.05, 6), chain.lower, chain.upper)
        assert moves(nk.solve(chain, chain.pose(q), start, method="closed").q, q) < 1e-6


@pytest.mark.parametrize(("name", "part"), CHAINS)
def test_a_batch_is_its_single_solves(name: str, part: str, rng: np.random.Generator) -> None:
    chain = robot(name).chain(part)
    goals = chain.poses(random_configurations(chain, 40, rng) + rng.uniform(-1.0, 1.0, (40, len(chain.joints))))
    goals[::8, :3, 3] *= 3.0
    goals[1::8, :3, 3] += 1e-3
    goals[2::8, :3, 3] = 0.01
    starts = random_configurations(chain, 40, rng)
    many = nk.solve_batch(chain, goals, starts, method="closed", audit="all")
    single = [nk.solve(chain, T, q0, method="closed") for T, q0 in zip(goals, starts, strict=True)]
    np.testing.assert_array_equal(many.q, [result.q for result in single])
    assert list(many.status) == [result.status for result in single]
    assert {nk.Status.SOLVED, nk.Status.OUT_OF_REACH} <= set(many.status)
    for result in single:
        if result.status in (nk.Status.NO_SOLUTION, nk.Status.OUT_OF_REACH):
            assert result.position_error > 1e-6 or result.rotation_error > 1e-6


def test_without_a_branch_it_says_so_and_by_how_much_the_nearest_misses() -> None:
    chain = robot("jaco2").chain("arm")
    far = nk.solve(chain, from_xyz_rpy([5.0, 0.0, 0.0], [0.0, 0.0, 0.0]), method="closed")
    assert far.status is nk.Status.OUT_OF_REACH
    assert "misses by at least" in far.message
    T = from_xyz_rpy([0.0, 0.0, 0.1], [0.0, 0.0, 0.0])
    inside = nk.solve(chain, T, method="closed")
    assert inside.status is nk.Status.NO_SOLUTION
    assert len(nk.solve_all(chain, T)) == 0
    assert np.isfinite(inside.q).all()
    assert in_limits(chain, inside.q)


def test_a_path_keeps_to_its_branch(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    q0, q1 = np.array([0.3, 2.0, 1.5, 0.4, -1.0, 2.0]), np.array([1.0, 2.5, 1.8, -0.4, -1.4, 2.6])
    Q = q0 + np.linspace(0.0, 1.0, 40)[:, None] * (q1 - q0)
    path = [chain.pose(q) for q in Q]
    found = nk.follow(chain, path, q0, method="closed")
    assert found.completed
    np.testing.assert_allclose(found.q, Q, atol=1e-9)
    jumped = nk.follow(chain, [path[0], path[-1]], q0, method="closed", jump=0.3)
    assert not jumped.completed
    assert "more than 0.3" in jumped.reason


def test_a_jump_is_told() -> None:
    chain = robot("jaco2").chain("arm")
    q = np.array([0.3, 2.0, 1.5, 0.4, -1.0, 2.0])
    assert nk.solve(chain, chain.pose(q), q + 0.2, method="closed", jump=0.1).status is nk.Status.JUMPED
    assert nk.solve(chain, chain.pose(q), q + 0.2, method="closed", jump=0.3).solved


def test_a_chain_without_a_closed_form_is_told_what_works() -> None:
    chain = robot("nao").chain("l_sole", "r_gripper")
    with pytest.raises(InvalidInputError, match=r"methods that take these: lm, .*ccd.*12 joints") as error:
        nk.solve(chain, np.eye(4), method="closed")
    with pytest.raises(InvalidInputError, match="methods that take these: lm"):
        nk.solve_batch(chain, np.eye(4)[None], method="closed")
    for name in str(error.value).split("these: ")[1].split(", got")[0].split(", "):
        nk.solve(chain, chain.pose(np.zeros(12)), method=name, budget=nk.Budget(iterations=2, restarts=0))


@pytest.mark.parametrize(
    ("option", "value"),
    [("budget", nk.Budget()), ("trace", True), ("engine", "reference"), ("parameters", {"gain": 0.5})],
)
def test_options_of_iterations_are_refused(option: str, value: object) -> None:
    chain = robot("jaco2").chain("arm")
    with pytest.raises(InvalidInputError, match=f"{option}: expected nothing for method 'closed'"):
        nk.solve(chain, np.eye(4), method="closed", **{option: value})
