"""Several tips at once: what a tree solves, what it must leave alone, and that nothing is called solved that is not."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import neutral, outside_limits, random_configurations
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.tips.precedence import Task, prioritised_step
from nao_kin.ik.tips.tree_aim import apart
from nao_kin.ik.tips.tree_problem import TreeProblem, TreeResult, TreeRun, judge_tree
from nao_kin.ik.tips.tree_solver import USUAL, solve_tree
from nao_kin.se3 import rotation_angle
from tests.conftest import robot

HANDS = ["LArm", "RArm"]
FEET = [f"foot_{leg}" for leg in ("lf", "lm", "lr", "rf", "rm", "rr")]
FEW = nk.Budget(restarts=3)


def wish_of(tree: nk.Tree, q: np.ndarray, kind: str) -> dict[str, nk.Target]:
    """Targets at the tips of a posture, measured on the whole robot."""
    assert tree.robot is not None
    posture = dict(zip(tree.joint_names, q.tolist(), strict=True))
    poses = {tip: tree.robot.pose(posture, tip, base=tree.base_name) for tip in tree.tip_names}
    return {tip: make(kind, T) for tip, T in poses.items()}


def make(kind: str, T: object) -> nk.Target:
    p, R = T.translation, T.rotation  # type: ignore[attr-defined]
    if kind == "pointing":
        return nk.Target.pointing(p, R[:, 0])
    if kind == "orientation":
        return nk.Target.orientation(R)
    return nk.Target.pose(T) if kind == "pose" else nk.Target.position(p)  # type: ignore[arg-type]


def verified(result: TreeResult) -> bool:
    """Whether the whole robot's own kinematics confirms every tip and every limit; expanding checks the couplings."""
    tree, tolerances = result.problem.tree, result.problem.tolerances
    posture = tree.robot.complete(result.posture)
    if any(max(o.lower - o.value, o.value - o.upper) > 1e-9 for o in tree.robot.outside_limits(posture)):
        return False
    for tip, target in result.problem.targets.items():
        T = tree.robot.pose(posture, tip, base=tree.base_name)
        far = np.linalg.norm((T.translation - target.goal[:3, 3]) * (np.array(target.weights[:3]) > 0))
        turned = rotation_angle(T.rotation.T @ target.goal[:3, :3])
        if target.kind == "pointing":
            axis = T.rotation @ target.tip_axis
            turned = np.arctan2(np.linalg.norm(np.cross(axis, target.base_axis)), axis @ target.base_axis)
        if target.kind != "orientation" and far > tolerances.position:
            return False
        if target.kind != "position" and turned > tolerances.rotation:
            return False
    return True


@pytest.mark.parametrize("priority", [None, HANDS])
@pytest.mark.parametrize("kind", ["position", "pose", "pointing"])
@pytest.mark.parametrize(("name", "base"), [("nao", "torso"), ("nao", "l_sole"), ("nao_v33_h21", "r_sole")])
def test_both_hands_reach_what_a_posture_reaches(name: str, base: str, kind: str, priority, rng) -> None:
    tree = robot(name).tree(base, HANDS)
    for q in random_configurations(tree, 15, rng):
        result = solve_tree(tree, wish_of(tree, q, kind), priority=priority)
        assert result.solved, result.message
        assert verified(result)


def test_hands_head_and_feet_at_once(rng: np.random.Generator) -> None:
    """From the torso, both legs share a motor; targets of every kind side by side."""
    tree = robot("nao").tree("torso", ["LArm", "RArm", "LLeg", "RLeg", "Head"])
    kinds = {"LArm": "pointing", "RArm": "position", "LLeg": "pose", "RLeg": "pose", "Head": "orientation"}
    for q in random_configurations(tree, 20, rng):
        poses = wish_of(tree, q, "pose")
        wish = {tip: make(kind, poses[tip].T_base_target) for tip, kind in kinds.items()}
        result = solve_tree(tree, wish)
        assert result.solved, result.message
        assert verified(result)
        posture = tree.robot.expand(result.posture)
        assert posture["RHipYawPitch"] == posture["LHipYawPitch"] == result.posture["LHipYawPitch"]


@pytest.mark.parametrize("base", ["base_link", "foot_lf"])
def test_a_hexapod_puts_its_feet_down(base: str, rng: np.random.Generator) -> None:
    tree = robot("phantomx").tree(base, [foot for foot in FEET if foot != base])
    for q in random_configurations(tree, 10, rng):
        result = solve_tree(tree, wish_of(tree, q, "position"))
        assert result.solved, result.message
        assert verified(result)


@pytest.mark.parametrize(
    ("name", "base", "tip", "kind"),
    [
        ("jaco2", "link_base", "end_effector", "pose"),
        ("nao", "torso", "RLeg", "pose"),
        ("nao", "l_sole", "RArm", "position"),
    ],
)
def test_a_tree_of_one_tip_is_solved_as_its_chain_is(name: str, base: str, tip: str, kind: str, rng) -> None:
    tree, chain = robot(name).tree(base, [tip]), robot(name).chain(base, tip)
    for q in random_configurations(tree, 15, rng):
        for away in (0.0, 5.0):
            (target,) = wish_of(tree, q, kind).values()
            target = target.moved_to(target.goal[:3, 3] + away)
            one, other = solve_tree(tree, {tip: target}), nk.solve(chain, target)
            assert one.status is other.status
            assert one.solved is verified(one) is (away == 0.0)
            if kind == "pose" and one.solved and one.run.starts == other.run.starts == 1:
                np.testing.assert_allclose(one.q, other.q, atol=1e-5)


@pytest.mark.parametrize("base", ["torso", "l_sole"])
@pytest.mark.parametrize("away", [0.02, 0.2, 3.0])
def test_a_tip_that_cannot_be_served_does_not_disturb_those_before_it(base: str, away: float, rng) -> None:
    tree = robot("nao").tree(base, HANDS)
    for q in random_configurations(tree, 6, rng):
        wish = wish_of(tree, q, "position")
        p = wish["RArm"].goal[:3, 3]
        wish["RArm"] = wish["RArm"].moved_to(p + away * p / np.linalg.norm(p))
        result = solve_tree(tree, wish, priority=HANDS, budget=nk.Budget(restarts=10))
        assert result.position_error["LArm"] <= 1e-6, result.message
        assert result.solved is verified(result)
        if not result.solved:
            assert result.missed == ("RArm",)


def test_second_place_gets_what_freedom_is_left(rng: np.random.Generator) -> None:
    """No small motion that keeps the first hand takes the second much nearer to the place that it heads for."""
    tree = robot("nao").tree("l_sole", HANDS)
    far = np.array([0.1, -0.1, 1.5])  # twice as high as it stands
    nearest = reach_shell(tree.chains["RArm"]).nearest(far)
    for q in random_configurations(tree, 6, rng):
        wish = wish_of(tree, q, "position")
        wish["RArm"] = nk.Target.position(far)
        result = solve_tree(tree, wish, priority=HANDS)
        assert result.misses_by["RArm"] > 0.3
        J, poses = tree.jacobians(result.q), tree.poses(result.q)
        at_end = (result.q <= tree.lower + 1e-6) | (result.q >= tree.upper - 1e-6)
        free = J["LArm"][:3] * ~at_end
        null = np.eye(len(result.q)) - np.linalg.pinv(free, rcond=1e-9) @ free
        away = poses["RArm"].translation - nearest
        slope = (away / np.linalg.norm(away)) @ (J["RArm"][:3] * ~at_end) @ null
        assert np.linalg.norm(slope) < 0.1  # [m/rad]; 0.2 to 0.8 where the search just stalls


def test_more_weight_brings_a_tip_nearer() -> None:
    """Both hands wanted apart by more than they can spread: the heavier one has the smaller error."""
    tree, errors = robot("nao").tree("l_sole", HANDS), []
    wish = {"LArm": [0.0, 0.45, 0.35], "RArm": [0.0, -0.45, 0.35]}
    for weight in (0.1, 0.5, 1.0, 2.0, 10.0):
        result = solve_tree(tree, wish, weights={"LArm": weight}, budget=FEW)
        assert not result.solved
        errors.append((result.position_error["LArm"], result.position_error["RArm"]))
    left, right = np.array(errors).T
    assert (np.diff(left) < 0.0).all()
    assert (np.diff(right) > 0.0).all()


def test_nothing_is_called_solved_that_is_not(rng: np.random.Generator) -> None:
    for base in ("torso", "l_sole"):
        tree = robot("nao").tree(base, HANDS)
        for q in random_configurations(tree, 30, rng):
            wish = wish_of(tree, q, "position")
            moved = {tip: t.moved_to(t.goal[:3, 3] + rng.normal(scale=0.1, size=3)) for tip, t in wish.items()}
            result = solve_tree(tree, moved, budget=FEW)
            assert result.solved is verified(result)
            assert not outside_limits(tree, result.q)
            tree.robot.expand(result.posture)


def test_the_judge_believes_no_claim(rng: np.random.Generator) -> None:
    tree = robot("nao").tree("l_sole", HANDS)
    q = random_configurations(tree, 1, rng)[0]
    wish = wish_of(tree, q, "pose")
    problem = TreeProblem(tree, wish, dict.fromkeys(wish, 1.0), (tuple(wish),))
    assert judge_tree(problem, TreeRun(q.copy(), nk.Status.STALLED)).status is nk.Status.SOLVED
    off = q.copy()
    off[0] += 1e-4
    assert judge_tree(problem, TreeRun(off, nk.Status.SOLVED)).status is nk.Status.STALLED
    broken = judge_tree(problem, TreeRun(np.full_like(q, np.nan), nk.Status.SOLVED))
    assert broken.status is nk.Status.NOT_FINITE
    assert np.isfinite(broken.q).all()
    out = tree.upper + 0.1
    beyond = dataclasses.replace(problem, targets=wish_of(tree, out, "position"))
    result = judge_tree(beyond, TreeRun(out.copy(), nk.Status.SOLVED))
    assert result.status is nk.Status.OUTSIDE_LIMITS
    assert {o.joint for o in result.outside} == set(tree.joint_names)


def test_an_unreachable_tip_is_named_and_the_others_are_served(rng: np.random.Generator) -> None:
    tree = robot("nao").tree("l_sole", ["LArm", "RArm", "Head"])
    for q in random_configurations(tree, 8, rng):
        wish = wish_of(tree, q, "position") | {"Head": wish_of(tree, q, "orientation")["Head"]}
        wish["LArm"] = nk.Target.position([0.0, 0.0, 3.0])
        result = solve_tree(tree, wish)
        assert result.status is nk.Status.OUT_OF_REACH
        assert result.missed == tuple(result.misses_by) == ("LArm",)
        assert 1.5 < result.misses_by["LArm"] <= result.position_error["LArm"]
        assert "LArm misses by at least" in result.message


def test_tips_that_share_nothing_are_solved_apart() -> None:
    nao = robot("nao")
    arms = nao.tree("torso", ["LArm", "RArm", "Head"])
    assert apart(arms, arms.tip_names) == [("LArm",), ("RArm",), ("Head",)]
    assert apart(nao.tree("torso", ["RLeg", "Head", "LLeg"]), ["RLeg", "Head", "LLeg"]) == [("Head",), ("RLeg", "LLeg")]
    rule = nk.LimitRule("LShoulderPitch", "RShoulderPitch", (-1.0, 1.0), (-0.5, 0.5), (0.0, 1.0))
    ruled = dataclasses.replace(nao, limit_rules=(rule,)).tree("torso", ["LArm", "RArm", "Head"])
    assert sorted(map(sorted, apart(ruled, ruled.tip_names))) == [["Head"], ["LArm", "RArm"]]
    # A tip without a target does not move.
    result = solve_tree(arms, {"RArm": [0.15, -0.2, 0.1]})
    assert result.solved
    np.testing.assert_array_equal(result.q[:5], neutral(arms)[:5])
    np.testing.assert_array_equal(result.q[-2:], neutral(arms)[-2:])


def test_a_limit_across_two_arms_is_kept(rng: np.random.Generator) -> None:
    rule = nk.LimitRule("LShoulderPitch", "RShoulderPitch", (-2.0, 2.0), (-1.0, 0.5), (0.0, 2.0))
    tree = dataclasses.replace(robot("nao"), limit_rules=(rule,)).tree("torso", HANDS)
    for q in random_configurations(tree, 20, rng):
        result = solve_tree(tree, wish_of(tree, q, "position"))
        assert result.solved, result.message
        assert verified(result)


def test_the_same_call_gives_the_same_result(rng: np.random.Generator) -> None:
    tree = robot("nao").tree("l_sole", HANDS)
    for q in random_configurations(tree, 5, rng):
        wish = wish_of(tree, q, "pose")
        for seed in (0, 7):
            one, again = (solve_tree(tree, wish, seed=seed) for _ in range(2))
            np.testing.assert_array_equal(one.q, again.q)
            assert one.iterations == again.iterations


def test_a_start_at_the_target_is_kept_and_one_outside_is_moved(rng: np.random.Generator) -> None:
    tree = robot("nao").tree("l_sole", HANDS)
    q = random_configurations(tree, 1, rng)[0]
    wish = wish_of(tree, q, "pose")
    result = solve_tree(tree, wish, q, trace=True)
    np.testing.assert_array_equal(result.q, q)
    assert (result.iterations, result.run.starts, len(result.trace.q)) == (0, 1, 1)
    by_name = solve_tree(tree, wish, dict(zip(tree.joint_names, q.tolist(), strict=True)))
    np.testing.assert_array_equal(by_name.q, q)
    moved = solve_tree(tree, wish, tree.upper + 1.0)
    assert moved.run.start_moved
    assert "moved inside" in moved.message


def test_a_trace_has_a_column_for_every_target(rng: np.random.Generator) -> None:
    tree = robot("nao").tree("torso", ["LArm", "RArm", "Head"])
    wish = wish_of(tree, random_configurations(tree, 1, rng)[0], "position")
    wish["Head"] = nk.Target.orientation(np.eye(3))
    trace = solve_tree(tree, wish, trace=True).trace
    rows = len(trace.q)
    assert not any(
        array.flags.writeable for array in (trace.q, trace.position_error, trace.rotation_error, trace.start)
    )
    assert trace.position_error.shape == trace.rotation_error.shape == (rows, 3)
    assert np.isnan(trace.position_error[:, 2]).all()
    assert np.isnan(trace.rotation_error[:, :2]).all()
    for q, errors in zip(trace.q, trace.position_error, strict=True):
        for tip, error in zip(HANDS, errors[:2], strict=True):
            expected = np.linalg.norm(tree.poses(q)[tip].translation - wish[tip].goal[:3, 3])
            assert error == pytest.approx(expected, abs=1e-12)


def test_hand_written_chains_are_solved_too(rng: np.random.Generator) -> None:
    table = nk.document_chain("practicum_jaco2")
    wrist = dataclasses.replace(table, rows=table.rows[:4], tool=table.tool.Identity(), tip_name="wrist")
    tree = nk.Tree.of_chains([wrist, table])
    for q in rng.uniform(-2, 2, (10, 6)):
        poses = tree.poses(q)
        result = solve_tree(tree, {"wrist": poses["wrist"].translation, table.tip_name: poses[table.tip_name]})
        assert result.solved, result.message
        for tip, chain in tree.chains.items():
            assert np.linalg.norm(chain.pose(result.q[: len(chain.joints)]).translation - poses[tip].translation) < 1e-6


def test_no_task_moves_those_before_it(rng: np.random.Generator) -> None:
    """To first order, and no joint at an end of its range leaves it."""
    for _ in range(50):
        tasks = [Task(rng.normal(size=(m, 9)), rng.normal(size=m)) for m in (2, 3, 3)]
        ends = rng.integers(0, 4, 9)
        steps = [prioritised_step(tasks[:k], USUAL, ends == 1, ends == 2) for k in (1, 2, 3)]
        for k in (1, 2):
            for task in tasks[:k]:
                np.testing.assert_allclose(task.J @ steps[k], task.J @ steps[k - 1], atol=1e-9)
        for step in steps:
            assert (step[ends == 1] >= 0.0).all()
            assert (step[ends == 2] <= 0.0).all()


def test_an_error_whose_square_is_infinite_does_not_disturb_the_other_hand() -> None:
    tree = robot("nao").tree("l_sole", HANDS)
    wish = {"LArm": nk.Target.position([1e200, 1e200, 0.0], {"z": 0.0}), "RArm": [0.15, -0.15, 0.45]}
    result = solve_tree(tree, wish, priority=["RArm"], budget=FEW)
    assert not result.solved
    assert result.missed == ("LArm",)


def test_bad_questions_are_refused() -> None:
    tree = robot("nao").tree("torso", HANDS)
    p = [0.1, 0.1, 0.1]
    with pytest.raises(KeyError, match="Did you mean 'LArm'"):
        solve_tree(tree, {"Larm": p})
    with pytest.raises(KeyError, match="no tip"):
        solve_tree(tree, {"LArm": p}, priority=[["LArm"]])  # type: ignore[list-item]
    with pytest.raises(KeyError, match="method 'ml'"):
        solve_tree(tree, {"LArm": p}, method="ml")
    bad: list[tuple[object, dict[str, object], str]] = [
        ({}, {}, "targets by tip name"),
        ([p], {}, "targets by tip name"),
        ({"LArm": [1.0, 2.0]}, {}, "target of LArm"),
        ({"LArm": [0.0, np.nan, 0.0]}, {}, "of LArm"),
        ({"LArm": p}, {"q0": np.zeros(9)}, "10 numbers"),
        ({"LArm": p}, {"priority": ["RArm"]}, "tips that have a target"),
        ({"LArm": p}, {"priority": "LArm"}, "a list of tips"),
        ({"LArm": p}, {"priority": ["LArm", "LArm"]}, "each tip once"),
        ({"LArm": p}, {"weights": {"LArm": 0.0}}, "weight of LArm"),
        ({"LArm": p}, {"weights": {"LArm": 10**400}}, "weight of LArm"),
        ({"LArm": p}, {"parameters": 5}, "numbers by name"),
        ({"LArm": p}, {"weights": {"RArm": 1.0}}, "tips that have a target"),
        ({"LArm": p}, {"seed": -1}, "seed"),
    ]
    for targets, options, words in bad:
        with pytest.raises(ValueError, match=words):
            solve_tree(tree, targets, **options)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"a tree, as robot\.tree"):
        solve_tree(robot("nao").chain("left_arm"), {"LArm": p})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"result\.solved"):
        bool(solve_tree(tree, {"LArm": p}))
