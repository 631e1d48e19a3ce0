"""Targets that solvers stumble over: singular ones, half a turn away, at the edge of the reach and beyond."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.chain import in_limits, neutral, random_configurations
from nao_kin.ik.compiled import tables_of
from nao_kin.ik.problem import Status
from nao_kin.se3 import rotation_distance
from tests.ik.solving import (
    CHAINS,
    chain_of,
    compiled,
    errors,
    goals_of,
)


@pytest.mark.parametrize(("joint", "value"), [*itertools.product((2, 4), (0.0, 1e-12, 1e-9, 1e-6, 1e-3))])
def test_singular_targets_are_solved(joint: int, value: float, rng: np.random.Generator) -> None:
    chain = chain_of("ur5", "arm")
    Q = random_configurations(chain, 200, rng)
    Q[:, joint] = value
    for q in Q:
        goal = chain.pose(q).homogeneous
        run = compiled(chain, goal, neutral(chain))
        assert run.ended is Status.SOLVED
        assert max(errors(chain, run.q, goal)) <= 1e-6


def test_99_9_percent_of_the_reach_is_solved(rng: np.random.Generator) -> None:
    chain = chain_of("ur5", "arm")
    upper, fore = 0.425, 0.39225  # the UR5's two long links [m]
    straight = 0.999 * (upper + fore)
    elbow = math.acos((straight**2 - upper**2 - fore**2) / (2.0 * upper * fore))
    for q in random_configurations(chain, 200, rng):
        q[2] = elbow
        assert compiled(chain, chain.pose(q).homogeneous, neutral(chain)).ended is Status.SOLVED


def test_a_target_at_the_start_takes_no_iteration(rng: np.random.Generator) -> None:
    for name, part, kind in CHAINS:
        chain = chain_of(name, part)
        q0 = random_configurations(chain, 1, rng)[0]
        run = compiled(chain, chain.pose(q0).homogeneous, q0, kind)
        assert (run.ended, run.iterations, run.starts) == (Status.SOLVED, 0, 1)
        np.testing.assert_array_equal(run.q, q0)


def test_a_target_half_a_turn_away_is_reached(rng: np.random.Generator) -> None:
    chain = chain_of("ur5", "arm")
    for q0 in random_configurations(chain, 200, rng):
        turned = q0.copy()
        turned[5] += -math.pi if q0[5] > 0.0 else math.pi
        goal = chain.pose(turned).homogeneous
        assert rotation_distance(chain.pose(q0), pin.SE3(goal)) == pytest.approx(math.pi, abs=1e-7)
        assert compiled(chain, goal, q0).ended is Status.SOLVED


@pytest.mark.parametrize("factor", [1.5, 5.0, 1e6, 1e200])
def test_far_targets_give_the_best_found(factor: float, rng: np.random.Generator) -> None:
    for name, part, kind in CHAINS:
        chain = chain_of(name, part)
        for goal in goals_of(chain, 20, rng):
            goal[:3, 3] = tables_of(chain).shell[:3] + factor * tables_of(chain).shell[4] * np.array([0.6, 0.0, 0.8])
            run = compiled(chain, goal, neutral(chain), kind)
            assert run.ended is Status.OUT_OF_REACH
            assert run.misses_by >= (factor - 1.01) * tables_of(chain).shell[4]
            assert run.starts == 1
            assert np.isfinite(run.q).all()
            assert in_limits(chain, run.q, 1e-12)


def test_just_out_of_reach_is_never_called_solved(rng: np.random.Generator) -> None:
    chain = chain_of("ur5", "arm")
    Q = random_configurations(chain, 100, rng)
    Q[:, 2] = 0.0
    for q in Q:
        goal = chain.pose(q).homogeneous
        goal[:3, 3] *= 1.01
        run = compiled(chain, goal, neutral(chain))
        assert in_limits(chain, run.q, 1e-12)
        if run.ended is Status.SOLVED:
            assert max(errors(chain, run.q, goal)) <= 1e-6
