"""FABRIK for several tips that share joints."""

from __future__ import annotations

import numpy as np
import pytest

from nao_kin.ik.geometric.fabrik import hinge_memory, hinge_pass
from nao_kin.ik.geometric.fabrik_tree import tree_pass, tree_sweep
from nao_kin.kernels.joint_limits import move_inside, packed_rules
from nao_kin.kernels.motion import At, packed_joints
from tests.conftest import robot
from tests.ik.sweeping import Arm


class Body:
    """Chains of a NAO from one base, and the union of their joints."""

    def __init__(self, base: str, *tips: str) -> None:
        self.chains = [robot("nao_v50_h25").chain(base, tip) for tip in tips]
        ranges = {j.name: (j.lower, j.upper) for chain in self.chains for j in chain.joints}
        names = list(ranges)
        self.paths = [packed_joints(chain.joint_path) for chain in self.chains]
        self.columns = [np.array([names.index(joint) for joint in chain.joint_names]) for chain in self.chains]
        self.limits = np.array(list(ranges.values())).T.copy()
        self.rules = {(rule.joint, rule.by): rule for chain in self.chains for rule in chain.limit_rules}
        self.names, self.coupled = names, packed_rules(list(self.rules.values()), names)

    def configuration(self, rng: np.random.Generator, around: np.ndarray | None = None) -> np.ndarray:
        q = rng.uniform(*self.limits) if around is None else around + 0.05 * rng.normal(size=len(around))
        move_inside(q, self.limits, self.coupled)
        return q

    def goals(self, q: np.ndarray) -> list[np.ndarray]:
        return [c.pose(q[own]).homogeneous.copy() for c, own in zip(self.chains, self.columns, strict=True)]

    def missing(self, goals: list[np.ndarray], q: np.ndarray) -> float:
        """Root of the sum of squared distances, by the chains' own forward kinematics [m]."""
        at = self.goals(q)
        return float(np.linalg.norm([a[:3, 3] - b[:3, 3] for a, b in zip(at, goals, strict=True)]))

    def swept(self, goals: list[np.ndarray], q: np.ndarray) -> np.ndarray:
        return tree_sweep(self.paths, self.columns, self.limits, self.coupled, goals, q)

    def inside(self, q: np.ndarray) -> bool:
        at = dict(zip(self.names, q, strict=True))
        ranges = [(at[joint], rule.range(at[by])) for (joint, by), rule in self.rules.items()]
        coupled = all(low - 1e-12 <= value <= high + 1e-12 for value, (low, high) in ranges)
        return bool((q >= self.limits[0]).all() and (q <= self.limits[1]).all() and coupled)


def test_arms_that_share_no_joint_are_each_an_arm_by_itself(rng: np.random.Generator) -> None:
    body = Body("torso", "LArm", "RArm")
    for _ in range(20):
        q = body.configuration(rng)
        goals = body.goals(body.configuration(rng))
        expected = q.copy()
        for chain, own, goal in zip(body.chains, body.columns, goals, strict=True):
            arm, part = Arm.of(chain), q[own]
            axes, tip = arm.placed(part)
            memory = np.empty(hinge_memory(arm.joints))
            hinge_pass(False, arm.flat, goal, At(part, axes, tip), memory)
            expected[own] = part
        moved = tree_pass(body.paths, body.columns, body.limits, body.coupled, goals, q)
        np.testing.assert_allclose(moved, expected, atol=1e-12)


def test_two_tips_that_are_one_are_a_chain(rng: np.random.Generator) -> None:
    """Then every joint is shared, and its two next points want the same."""
    double, single = Body("l_sole", "LArm", "LArm"), Body("l_sole", "LArm")
    for _ in range(20):
        q = double.configuration(rng)
        goals = double.goals(double.configuration(rng))
        twice = tree_pass(double.paths, double.columns, double.limits, double.coupled, goals, q)
        once = tree_pass(single.paths, single.columns, single.limits, single.coupled, goals[:1], q)
        np.testing.assert_allclose(twice, once, atol=1e-9)


@pytest.mark.parametrize("tips", [("LArm", "RArm"), ("LArm", "RArm", "Head"), ("RArm",)])
def test_sweeps_of_a_body_on_one_foot_stay_inside_the_limits_and_lose_no_ground(
    tips: tuple[str, ...], rng: np.random.Generator
) -> None:
    body = Body("l_sole", *tips)
    for _ in range(5):
        q, goals = body.configuration(rng), body.goals(body.configuration(rng))
        missing = body.missing(goals, q)
        for _ in range(10):
            given = q.copy()
            again = body.swept(goals, q)
            np.testing.assert_array_equal(q, given)
            q = body.swept(goals, q)
            np.testing.assert_array_equal(q, again)
            before, missing = missing, body.missing(goals, q)
            assert missing <= before + 1e-15
            assert body.inside(q)


@pytest.mark.parametrize("base", ["torso", "l_sole"])
def test_two_hands_reach_their_targets(base: str, rng: np.random.Generator) -> None:
    body, solved = Body(base, "LArm", "RArm"), 0
    for _ in range(20):
        # Ten degrees inside the limits, as far as coupled limits allow.
        wanted = np.clip(body.configuration(rng), body.limits[0] + 0.17, body.limits[1] - 0.17)
        move_inside(wanted, body.limits, body.coupled)
        q, goals = body.configuration(rng, wanted), body.goals(wanted)
        for _ in range(300):
            if body.missing(goals, q) < 1e-6:
                break
            q = body.swept(goals, q)
        solved += body.missing(goals, q) < 1e-6
    assert solved == 20


def test_targets_that_cannot_both_be_reached_give_finite_joints_inside_the_limits(rng: np.random.Generator) -> None:
    body = Body("l_sole", "LArm", "RArm")
    for scale in (1.0, 1e3, 1e6):
        q, goals = body.configuration(rng), body.goals(body.configuration(rng))
        goals[0][:3, 3] += scale
        goals[1][:3, 3] -= scale
        for _ in range(10):
            q = body.swept(goals, q)
            assert np.isfinite(q).all()
            assert body.inside(q)
