"""Sweeps of CCD, FABRIK and follow-the-leader on real hinge chains."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from nao_kin.chain import in_limits, into_limits, random_configurations
from nao_kin.ik.geometric.fabrik import hinge_memory, hinge_pass
from nao_kin.ik.geometric.free_points import fabrik_points
from nao_kin.ik.geometric.hinge_groups import chain_length, find_groups, group_point
from nao_kin.ik.geometric.sweep import refusal
from nao_kin.ik.reach import reach_shell
from nao_kin.kernels.joint_path import JointPath, PathJoint, joint_path
from nao_kin.kernels.motion import At
from tests.conftest import robot
from tests.ik.solving import chain_of
from tests.ik.sweeping import METHODS, Arm, at, goals_of, near_pairs, planar, random_hinges

ROUNDING = 1e-15  # the same coupled range computed twice, by compiled code and by numpy
CHAINS = [
    ("nao_v33_h21", "left_arm"),
    ("nao_v50_h25", "right_arm"),
    ("nao_v50_h25", "left_leg"),
    ("nao_v50_h25", "head"),
    ("jaco2", "arm"),
    ("phantomx", "leg_rm"),
    ("ur5", "arm"),
    ("panda", "arm"),
]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("name", "part"), CHAINS)
def test_every_sweep_stays_inside_the_limits_and_never_loses_ground(
    name: str, part: str, method: str, rng: np.random.Generator
) -> None:
    chain = chain_of(name, part)
    arm = Arm.of(chain)
    for q, goal in zip(random_configurations(chain, 30, rng), goals_of(chain, 30, rng), strict=True):
        missing = np.linalg.norm(chain.pose(q).translation - goal[:3, 3])
        for _ in range(10):
            again = arm.swept(method, goal, q)
            q = arm.swept(method, goal, q)
            np.testing.assert_array_equal(q, again)
            assert in_limits(chain, q, ROUNDING)
            before, missing = missing, np.linalg.norm(chain.pose(q).translation - goal[:3, 3])
            assert missing <= before + 1e-15


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("name", "part"), [("nao_v33_h21", "left_arm"), ("ur5", "arm"), ("jaco2", "arm")])
def test_targets_near_the_start_are_reached(name: str, part: str, method: str, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    arm, solved = Arm.of(chain), 0
    pairs = near_pairs(chain, 300, rng)
    for q0, q1 in pairs:
        q = arm.solve(method, chain.pose(q1).homogeneous.copy(), q0, 5000)
        solved += np.linalg.norm(chain.pose(q).translation - chain.pose(q1).translation) <= 1.001e-6
    assert solved >= 0.99 * len(pairs)


@pytest.mark.parametrize("method", METHODS)
def test_any_target_of_an_arm_is_reached_from_one_of_many_starts(method: str, rng: np.random.Generator) -> None:
    chain = chain_of("nao_v33_h21", "left_arm")
    arm, solved, goals = Arm.of(chain), 0, goals_of(chain, 200, rng)
    for goal in goals:
        for q0 in random_configurations(chain, 100, rng):
            q = arm.solve(method, goal, q0, 200)
            if np.linalg.norm(chain.pose(q).translation - goal[:3, 3]) <= 1.001e-6:
                solved += 1
                break
    assert solved >= 0.99 * len(goals)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("name", "part"), CHAINS)
def test_awkward_targets_leave_a_configuration_inside_the_limits(
    name: str, part: str, method: str, rng: np.random.Generator
) -> None:
    chain = chain_of(name, part)
    arm, shell = Arm.of(chain), reach_shell(chain)
    for q0 in random_configurations(chain, 5, rng):
        axes, tip = arm.placed(q0)
        direction = np.array([0.6, 0.0, 0.8])
        places = [shell.centre, tip[9:], *axes[:, 3:], np.zeros(3), 0.5 * (shell.centre + tip[9:])]
        places += [shell.centre + factor * max(shell.outer, 0.1) * direction for factor in (1.0, 10.0, 1e6)]
        places += [shell.centre + factor * shell.inner * direction for factor in (0.5, 1.0)]
        for place in places:
            q = q0
            for _ in range(5):
                q = arm.swept(method, at(*place), q)
                assert np.isfinite(q).all()
                assert in_limits(chain, q, ROUNDING)


@pytest.mark.parametrize("method", METHODS)
def test_two_thousand_chains_and_targets_of_any_kind_give_finite_joints_inside_the_limits(
    method: str, rng: np.random.Generator
) -> None:
    for case in range(2000):
        path = random_hinges(rng, int(rng.integers(1, 8)))
        arm, n = Arm.along(path), len(path.lower)
        q = np.clip(rng.normal(size=n) * (case % 3), path.lower, path.upper)
        axes, tip = arm.placed(q)
        places = [rng.normal(size=3), axes[rng.integers(n), 3:], tip[9:], 10.0 * tip[9:], np.zeros(3)]
        goal, missing = at(*places[case % 5]), arm.missing(at(*places[case % 5]), q)
        for _ in range(3):
            may_leave = method != "ccd" and _stands_in_line(arm, goal, q)
            q = arm.swept(method, goal, q)
            assert np.isfinite(q).all()
            assert (q >= path.lower).all()
            assert (q <= path.upper).all()
            before, missing = missing, arm.missing(goal, q)
            assert may_leave or missing <= before + 1e-14


def _stands_in_line(arm: Arm, goal: np.ndarray, q: np.ndarray) -> bool:
    points = np.vstack([_points(arm, q), goal[:3, 3]])
    return bool(np.linalg.svd(points - points[0], compute_uv=False)[1:].max() < 1e-8)


LINKS = [(1.0, 1.0), (1.0, 1.0, 1.0), (3.0, 1.0), (1.0, 3.0, 1.0, 0.5), (0.2, 0.3, 3.0, 0.1)]


@pytest.mark.parametrize("method", ["ftl", "fabrik"])
@pytest.mark.parametrize("links", LINKS)
def test_a_straight_chain_reaches_targets_on_its_own_line(links: tuple[float, ...], method: str) -> None:
    arm, total, hole = planar(*links), sum(links), max(0.0, 2.0 * max(links) - sum(links))
    for share, side in itertools.product((0.05, 0.5, 0.95, 0.9999), (-1.0, 1.0)):
        goal = at(side * (hole + share * (total - hole)), 0.0, 0.0)
        assert arm.missing(goal, arm.solve(method, goal, np.zeros(len(links)), 1000)) < 1e-6


@pytest.mark.parametrize("method", ["ftl", "fabrik"])
@pytest.mark.parametrize("links", LINKS)
def test_out_of_reach_the_nearest_point_is_found(
    links: tuple[float, ...], method: str, rng: np.random.Generator
) -> None:
    """The nearest point of the ring that the links allow, which is known without any solver."""
    arm, total, hole = planar(*links), sum(links), max(0.0, 2.0 * max(links) - sum(links))
    for distance in (total + 1e-6, 1.5 * total, 10.0 * total, 0.5 * hole, 0.999 * hole, 0.0):
        angle, q0 = rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0, size=len(links))
        goal = at(distance * np.cos(angle), distance * np.sin(angle), 0.0)
        expected = max(distance - total, hole - distance, 0.0)
        assert arm.missing(goal, arm.solve(method, goal, q0, 1000)) == pytest.approx(expected, abs=2e-6)


def _ball_chain(rng: np.random.Generator, links: int) -> Arm:
    """Ball joints without limits: three axes at right angles in each point, none near the next point."""
    joints = []
    for k in range(3 * links):
        offset = _slanted(rng) if k and k % 3 == 0 else np.zeros(3)
        joints.append(PathJoint(at(*offset), np.eye(3)[k % 3], False, k))
    free = np.full(3 * links, np.inf)
    return Arm.along(joint_path(joints, at(*_slanted(rng)), -free, free))


def _slanted(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(0.3, 1.0, size=3) * rng.choice([-1.0, 1.0], size=3)


def _points(arm: Arm, q: np.ndarray) -> np.ndarray:
    """The points of the groups, base to tip."""
    (axes, tip), m = arm.placed(q), len(arm.joints) - 1
    first, slide = np.zeros(m + 1), np.zeros(m + 1)
    count = find_groups(chain_length(arm.joints), axes, tip, first, slide)
    return np.array([group_point(g, first, slide, axes, tip[9], tip[10], tip[11]) for g in range(count, -1, -1)])


def _passed(arm: Arm, goal: np.ndarray, q: np.ndarray, follow: bool) -> np.ndarray:
    q, (axes, tip) = q.copy(), arm.placed(q)
    hinge_pass(follow, arm.flat, goal, At(q, axes, tip), np.empty(hinge_memory(arm.joints)))
    return q


def _dragged(points: np.ndarray, target: np.ndarray) -> np.ndarray:
    """A rope whose end is dragged to the target, hung up again at its other end."""
    rope = points.copy()
    rope[-1] = target
    for i in range(len(rope) - 2, -1, -1):
        line = points[i] - rope[i + 1]
        rope[i] = rope[i + 1] + line * (np.linalg.norm(points[i + 1] - points[i]) / np.linalg.norm(line))
    return rope + points[0] - rope[0]


@pytest.mark.parametrize("links", [2, 3, 5])
def test_on_ball_joints_a_pass_is_that_of_the_published_algorithm(links: int, rng: np.random.Generator) -> None:
    """For targets near the tip: far turns may pass near a gimbal lock, where joints that take turns are slow."""
    for _ in range(20):
        arm = _ball_chain(rng, links)
        q = np.zeros(3 * links)
        points = _points(arm, q)
        assert len(points) == links + 1
        target = _points(arm, 0.05 * rng.normal(size=3 * links))[-1]
        expected, done = fabrik_points(points, target, tolerance=0.0, iterations=1)
        assert done == 1
        np.testing.assert_allclose(_points(arm, _passed(arm, at(*target), q, follow=False)), expected, atol=1e-6)
        dragged = _dragged(points, target)
        np.testing.assert_allclose(_points(arm, _passed(arm, at(*target), q, follow=True)), dragged, atol=1e-6)


def _slid(path: JointPath, by: np.ndarray) -> JointPath:
    """The same chain, each joint's origin slid along its axis."""
    places = [
        np.block([[R, t[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
        for R, t in zip(path.rotations, path.translations, strict=True)
    ]
    tool = np.block([[path.tool_rotation, path.tool_translation[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
    z, back, joints = np.array([0.0, 0.0, 1.0]), np.eye(4), []
    for place, distance, column in zip(places, by, path.columns, strict=True):
        joints.append(PathJoint(back @ place @ at(0.0, 0.0, distance), z, False, int(column)))
        back = at(0.0, 0.0, -distance)
    return joint_path(joints, back @ tool, path.lower, path.upper)


@pytest.mark.parametrize("method", METHODS)
def test_where_a_description_puts_an_origin_along_an_axis_does_not_matter(
    method: str, rng: np.random.Generator
) -> None:
    for name, part in (("nao_v33_h21", "left_arm"), ("jaco2", "arm"), ("phantomx", "leg_rm")):
        chain = chain_of(name, part)
        one, q0 = Arm.along(chain.joint_path), random_configurations(chain, 1, rng)[0]
        # The length of a chain, by which it is decided what meets, does depend on origins, so slide by little.
        other = Arm.along(_slid(chain.joint_path, 1e-3 * rng.normal(size=len(q0))))
        for goal in goals_of(chain, 20, rng):
            np.testing.assert_allclose(one.swept(method, goal, q0), other.swept(method, goal, q0), atol=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_the_unit_of_length_does_not_matter(method: str, rng: np.random.Generator) -> None:
    for name, part in (("nao_v33_h21", "left_arm"), ("jaco2", "arm"), ("phantomx", "leg_rm")):
        chain = chain_of(name, part)
        metres, millimetres = Arm.of(chain), Arm.of(chain)
        millimetres.joints[:, 9:12] *= 1000.0
        for q0, goal in zip(random_configurations(chain, 20, rng), goals_of(chain, 20, rng), strict=True):
            scaled = goal.copy()
            scaled[:3, 3] *= 1000.0
            np.testing.assert_allclose(metres.swept(method, goal, q0), millimetres.swept(method, scaled, q0), atol=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_a_joint_that_does_not_move_the_tip_stays(method: str, rng: np.random.Generator) -> None:
    """Without its tool the tip of a NAO's arm is at the elbow, which neither elbow joint moves."""
    chain = chain_of("nao_v33_h21", "left_arm")
    path = chain.joint_path._replace(tool_translation=np.zeros(3))
    arm = Arm.along(path)
    for q0, q1 in itertools.pairwise(random_configurations(chain, 30, rng)):
        q = arm.swept(method, at(*arm.placed(q1)[1][9:]), q0)
        np.testing.assert_array_equal(q[2:], q0[2:])


def test_refusals_say_why() -> None:
    assert refusal(chain_of("nao_v33_h21", "left_arm").joint_path) == ""
    assert "several joints" in refusal(robot("nao_v50_h25").chain("l_sole", "r_sole").joint_path)
    slide = PathJoint(np.eye(4), np.array([0.0, 0.0, 1.0]), True, 0)
    assert "prismatic" in refusal(joint_path([slide], np.eye(4), [0.0], [1.0]))


def test_coupled_limits_hold_where_they_bind(rng: np.random.Generator) -> None:
    chain = chain_of("nao_v50_h25", "left_leg")
    arm, bound = Arm.of(chain), 0
    for q0, method in itertools.product(random_configurations(chain, 40, rng), METHODS):
        goal = chain.pose(q0).homogeneous.copy()
        goal[:3, 3] += 0.1 * rng.normal(size=3)
        q = into_limits(chain, q0)
        for _ in range(10):
            q = arm.swept(method, goal, q)
            assert in_limits(chain, q, ROUNDING)
        (rule,) = chain.limit_rules
        roll, pitch = (chain.joint_names.index(joint) for joint in (rule.joint, rule.by))
        bound += q[roll] in rule.range(q[pitch])
    assert bound > 0
