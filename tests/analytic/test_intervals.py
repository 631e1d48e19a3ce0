"""Intervals of the elbow yaw: what solving at many elbow yaws says, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.nao.intervals import elbow_yaw_intervals
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from tests.analytic.goals import chain_of

CASES = (("nao", "left_arm"), ("nao", "right_arm"), ("nao_v32_h25", "left_arm"), ("nao_v50_h21", "right_arm"))


@pytest.mark.parametrize(("name", "part"), CASES)
def test_the_intervals_hold_where_solving_finds_joints_within_limits(
    name: str, part: str, rng: np.random.Generator
) -> None:
    chain = chain_of(name, part)
    yaw, wrist = chain.joint_names[2], chain.joint_names[4:]
    yaws, partly, wrong = np.linspace(chain.lower[2], chain.upper[2], 240), 0, 0
    for i, q in enumerate(random_configurations(chain, 25, rng)):
        locked = {joint: float(q[4]) for joint in wrist}
        p = chain.pose(q).translation * (rng.uniform(0.8, 1.1) if i % 2 else 1.0)
        intervals = elbow_yaw_intervals(chain, p, locked=locked)
        partly += any(v.upper - v.lower < yaws[-1] - yaws[0] for v in intervals)
        found = nk.solve_all_batch(chain, np.tile(p, (len(yaws), 1)), locked={yaw: yaws, **locked})
        for row, value in enumerate(yaws.tolist()):
            solved = {found.branch(row, place) for place in np.flatnonzero(found.solved[row])}
            wrong += solved != {v.branch for v in intervals if v.lower <= value <= v.upper}
        if i % 2 == 0:
            assert any(v.lower - 1e-9 <= q[2] <= v.upper + 1e-9 for v in intervals)
    assert wrong <= 2  # where a target lies beyond the border by less than what counts as reached
    assert partly > 10


@pytest.mark.parametrize(("name", "part"), CASES)
def test_every_end_is_where_something_happens(name: str, part: str, rng: np.random.Generator) -> None:
    """A hair inside, the branch is within limits; a hair outside it is not, but for the elbow yaw's own limits."""
    chain = chain_of(name, part)
    yaw, wrist = chain.joint_names[2], chain.joint_names[4:]
    for q in random_configurations(chain, 20, rng):
        locked = {joint: float(q[4]) for joint in wrist}
        p = chain.pose(q).translation.copy()
        for interval in elbow_yaw_intervals(chain, p, locked=locked):
            for end, outwards in ((interval.lower, -1e-5), (interval.upper, 1e-5)):
                inside = nk.solve_all(chain, p, locked={yaw: end - outwards, **locked}).solved
                assert interval.branch in {result.branch for result in inside}
                if chain.lower[2] < end < chain.upper[2]:
                    strict = nk.Tolerances(position=1e-12)
                    outside = nk.solve_all(chain, p, locked={yaw: end + outwards, **locked}, tolerances=strict)
                    assert interval.branch not in {result.branch for result in outside.solved}


def test_an_unlocked_wrist_or_another_target_is_refused() -> None:
    chain = chain_of("nao", "left_arm")
    with pytest.raises(InvalidInputError, match="every joint locked"):
        elbow_yaw_intervals(chain, [0.1, 0.2, 0.1])
    with pytest.raises(InvalidInputError, match="a position"):
        elbow_yaw_intervals(chain, np.eye(4))
    with pytest.raises(InvalidInputError, match="every joint locked"):
        elbow_yaw_intervals(chain_of("nao", "CameraTop_frame"), [0.1, 0.2, 0.1])
    assert elbow_yaw_intervals(chain, [3.0, 0.0, 0.0], locked={"LWristYaw": 0.0}) == ()
    assert elbow_yaw_intervals(chain, [0.15, 0.15, 0.1], locked={"LWristYaw": 3.0}) == ()  # outside its own limits
