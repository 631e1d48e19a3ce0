"""Exact singularities, their neighbourhood and joint limits: no NaN, nothing reachable lost, continua named."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from tests.analytic.goals import ARMS, CAMERAS, REQUESTS, chain_of, errors, locked_of, move, targets_of

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

ELBOW_OFFSET = {"nao_v32_h25": 0.0}  # [m], 0.015 on every later robot
UPPER_ARM = {"nao_v32_h25": 0.090}


def bend(name: str, part: str) -> float:
    """Angle of the elbow point beside the upper arm's axis [rad]."""
    offset = ELBOW_OFFSET.get(name, 0.015) * (1.0 if part == "left_arm" else -1.0)
    return math.atan2(offset, UPPER_ARM.get(name, 0.105))


def reached(chain: nk.Chain, Q: Floats, rng: np.random.Generator, within: float = 1e-10) -> None:
    for kind, _ in REQUESTS[len(chain.joints)]:
        for target, q in zip(targets_of(chain, kind, Q, rng), Q, strict=True):
            results = nk.solve_all(chain, target, locked=locked_of(chain, kind, q))
            assert len(results) > 0, (kind, q)
            assert all(errors(result) <= within for result in results)
            assert all(np.isfinite(result.q).all() for result in results)


@pytest.mark.parametrize(("name", "part"), ARMS)
@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-11, 1e-10, -1e-9, 1e-8, 1e-6, -1e-3])
def test_near_and_on_the_singularities_of_an_arm(name: str, part: str, off: float, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    on_axis = 0.5 * math.pi - bend(name, part)
    for column, value in ((3, 0.0), (1, on_axis), (1, -math.pi + on_axis)):
        Q = random_configurations(chain, 3, rng)
        Q[:, column] = value + off
        reached(chain, Q, rng)
    Q[:, 1], Q[:, 3] = on_axis + off, off
    reached(chain, Q, rng)


@pytest.mark.parametrize(("name", "part"), ARMS)
def test_joints_at_their_limits(name: str, part: str, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    ends = np.array([chain.lower, chain.upper])
    Q = np.take_along_axis(ends, rng.integers(0, 2, (20, len(chain.joints))), axis=0)
    for kind, _ in REQUESTS[len(chain.joints)]:
        for target, q in zip(targets_of(chain, kind, Q, rng), Q, strict=True):
            assert nk.solve_all(chain, target, locked=locked_of(chain, kind, q)).solved


@pytest.mark.parametrize(("name", "part"), CAMERAS)
@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-10, 1e-8, 1e-4])
def test_a_camera_above_the_neck(name: str, part: str, off: float, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    x, _, z = chain.pose([0.0, 0.0]).translation - [0.0, 0.0, 0.1265]
    reached(chain, np.array([[0.7, math.atan2(-x, z) + off], [-1.0, math.atan2(x, -z) + off]]), rng)


def test_a_continuum_is_named_and_represented_within_limits(rng: np.random.Generator) -> None:
    """On V3.2, whose elbow has no offset, the roll can lay the upper arm along the pitch axis within its limits."""
    chain = chain_of("nao_v32_h25", "left_arm")
    Q = random_configurations(chain, 50, rng)
    Q[:, 1] = 0.5 * math.pi
    for q in Q:
        results = nk.solve_all(chain, chain.pose(q)).solved
        assert results
        assert all("any shoulder pitch with the elbow yaw against it" in result.branch for result in results)
        other = results[0].q.copy()
        other[0], other[2] = other[0] + 0.3, other[2] - 0.3
        assert np.abs(chain.pose(other).homogeneous - chain.pose(q).homogeneous).max() <= 1e-12


def test_a_straight_elbow_leaves_the_yaws_to_each_other(rng: np.random.Generator) -> None:
    chain = chain_of("nao", "right_arm")
    Q = random_configurations(chain, 20, rng)
    Q[:, 3] = 0.0
    for q in Q:
        results = nk.solve_all(chain, chain.pose(q))
        straight = [r for r in results if "any elbow yaw with the wrist yaw against it" in r.branch]
        assert len(straight) == 1
        assert len(results) == 3  # turned over, the shoulder has its two elbows
        turned = straight[0].q
        assert turned[2] == turned[4]
        assert np.remainder(turned[2] + turned[4] - q[2] - q[4] + 1.0, 2.0 * np.pi) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("part", ["left_arm", "right_arm"])
def test_pointing_along_the_line_through_the_elbow_point(part: str, rng: np.random.Generator) -> None:
    """A turn about such an axis moves the hand only, so one solution within limits stands for many."""
    chain = chain_of("nao", part)
    axis = np.array([0.05595 + 0.05775, 0.0, -0.01231])
    for q in random_configurations(chain, 50, rng):
        T = chain.pose(q)
        results = nk.solve_all(chain, nk.Target.pointing(T.translation, T.rotation @ axis, axis))
        assert results.solved
        assert all("any turn about the pointing axis" in result.branch for result in results)


@pytest.mark.parametrize("off", [0.0, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5])
@pytest.mark.parametrize(
    ("name", "part"), [("nao", "left_arm"), ("nao_v32_h25", "right_arm"), ("nao_v50_h21", "left_arm")]
)
def test_pointing_along_a_line_through_the_shoulder(name: str, part: str, off: float, rng: np.random.Generator) -> None:
    """The whole arm may turn about such a line: five joints have a continuum, four a solution here and there."""
    chain = chain_of(name, part)
    shoulder = np.array([0.0, 0.098 if part == "left_arm" else -0.098, 0.1])
    for q in random_configurations(chain, 20, rng):
        T = chain.pose(q)
        line = T.translation - shoulder + off * rng.normal(size=3)
        axis = T.rotation.T @ line
        results = nk.solve_all(chain, nk.Target.pointing(T.translation, line, axis))
        assert results.solved
        assert all(errors(result) <= 1e-10 for result in results)
        if off == 0.0 and len(q) == 5:
            assert all("any turn about the pointing axis" in result.branch for result in results)
        elif off == 0.0:
            assert min(move(result.q, q) for result in results) <= 1e-6


def test_the_head_frame_itself_is_at_the_neck() -> None:
    chain = chain_of("nao", "head")
    results = nk.solve_all(chain, [0.0, 0.0, 0.1265])
    assert [(result.branch, result.solved) for result in results] == [("before the neck, any yaw and pitch", True)]
    assert len(nk.solve_all(chain, [0.0, 0.0, 0.1266])) == 0
