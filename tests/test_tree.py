"""Trees: the single chains' poses and derivatives in the columns of their union, one column a motor."""

from __future__ import annotations

import dataclasses
import pickle
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.chain import Chain, in_limits, into_limits, neutral, outside_limits, random_configurations
from tests.conftest import BUNDLED, robot

if TYPE_CHECKING:
    from pathlib import Path

FEET = [f"foot_{leg}" for leg in ("lf", "lm", "lr", "rf", "rm", "rr")]
NAO_TREES = [
    ("torso", ["LArm", "RArm", "LLeg", "RLeg", "Head"]),
    ("torso", ["RLeg", "LLeg"]),
    ("l_sole", ["LArm", "RArm"]),
    ("r_sole", ["RArm", "Head", "l_sole"]),
    ("LArm", ["RArm", "r_sole"]),
]
TREES = [
    *((name, base, tips) for name in BUNDLED if name.startswith("nao") for base, tips in NAO_TREES),
    ("jaco2", "link_base", ["link_4", "end_effector"]),
    ("jaco2", "link_3", ["link_base", "end_effector"]),
    ("phantomx", "base_link", FEET),
    ("phantomx", "foot_lf", [*FEET[1:], "base_link"]),
]
# lead turns by the value of its motor; twice goes −2 times as far from 0.3 on, back −0.5 times as far, on other limbs.
COUPLED = """<robot name="coupled"><link name="root"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="own" type="revolute"><parent link="root"/><child link="a"/><axis xyz="0 0 1"/><origin xyz="0 0 1"/>
  <limit lower="-2" upper="2" effort="1" velocity="3"/></joint>
<joint name="lead" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><origin xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="2"/></joint>
<joint name="twice" type="revolute"><parent link="a"/><child link="c"/><axis xyz="1 0 0"/><origin xyz="0 1 0"/>
  <limit lower="-1" upper="3" effort="1" velocity="1"/><mimic joint="lead" multiplier="-2" offset="0.3"/></joint>
<joint name="back" type="prismatic"><parent link="root"/><child link="d"/><axis xyz="0 0 1"/><origin xyz="0 0 2"/>
  <limit lower="-9" upper="9" effort="1" velocity="9"/><mimic joint="lead" multiplier="-0.5"/></joint></robot>"""


@pytest.fixture
def coupled(tmp_path: Path) -> nk.Robot:
    path = tmp_path / "coupled.urdf"
    path.write_text(COUPLED)
    return nk.load(path)


def posture_of(tree: nk.Tree, q: np.ndarray) -> dict[str, float]:
    return dict(zip(tree.joint_names, q.tolist(), strict=True))


@pytest.mark.parametrize(("name", "base", "tips"), TREES)
def test_poses_equal_pinocchio_on_the_whole_robot(name: str, base: str, tips: list[str], rng) -> None:
    model = robot(name)
    tree = model.tree(base, tips)
    assert (tree.base_name, tree.tip_names) == (base, tuple(tips))
    for q in random_configurations(tree, 50, rng):
        posture, poses = posture_of(tree, q), tree.poses(q)
        assert list(poses) == tips
        for tip in tips:
            expected = model.pose(posture, tip, base=base).homogeneous
            np.testing.assert_allclose(poses[tip].homogeneous, expected, atol=1e-12, rtol=0)
        np.testing.assert_array_equal(tree.q_of(posture), q)


@pytest.mark.parametrize(("name", "base", "tips"), TREES)
def test_jacobians_equal_finite_differences(name: str, base: str, tips: list[str], rng) -> None:
    model = robot(name)
    tree = model.tree(base, tips)
    for q in random_configurations(tree, 2, rng):
        found = tree.jacobians(q)
        for tip in tips:
            np.testing.assert_allclose(found[tip], differences(model, tree, tip, q), atol=1e-7, rtol=0)


def differences(model: nk.Robot, tree: nk.Tree, tip: str, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """Central differences of the whole robot's pose, not of the tree's."""

    def pose(at: np.ndarray) -> pin.SE3:
        return model.pose(posture_of(tree, at), tip, base=tree.base_name)

    R, columns = pose(q).rotation, []
    for e in np.eye(len(q)) * step:
        plus, minus = pose(q + e), pose(q - e)
        W = (plus.rotation - minus.rotation) @ R.T
        turn = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
        columns.append(np.concatenate([plus.translation - minus.translation, turn]) / (2.0 * step))
    return np.array(columns).T


@pytest.mark.parametrize(("name", "base", "tips"), TREES)
def test_a_chain_of_the_tree_is_the_robots_own(name: str, base: str, tips: list[str], rng) -> None:
    model = robot(name)
    tree = model.tree(base, tips)
    assert set(tree.joint_names) >= {n for t in tips for n in model.chain(base, t).joint_names} - {"RHipYawPitch"}
    Q = random_configurations(tree, 20, rng)
    for tip in tips:
        chain = model.chain(base, tip)
        for q, chain_q in zip(Q, tree.chain_q(tip, Q), strict=True):
            np.testing.assert_array_equal(chain_q, tree.chain_q(tip, q))
            np.testing.assert_array_equal(chain_q, chain.q_of(posture_of(tree, q)))
            np.testing.assert_array_equal(chain_q, q[tree.columns[tip]])
            assert in_limits(chain, chain_q)


def test_both_hip_joints_are_one_column_named_by_the_leader() -> None:
    model = robot("nao")
    for tips in (["LLeg", "RLeg"], ["RLeg", "LLeg"]):
        tree = model.tree("torso", tips)
        assert len(tree.joints) == 11
        assert tree.joint_names[0] == "LHipYawPitch"
        assert "RHipYawPitch" not in tree.joint_names
        assert tree.columns["LLeg"][0] == tree.columns["RLeg"][0] == 0
    assert model.tree("torso", ["RLeg"]).joint_names[0] == "RHipYawPitch"
    assert model.tree("torso", ["RLeg", "Head"]).joint_names[0] == "RHipYawPitch"


def test_multipliers_and_offsets_are_respected(coupled: nk.Robot, rng: np.random.Generator) -> None:
    tree = coupled.tree("root", ["c", "b", "d"])
    assert tree.joint_names == ("own", "lead")
    # twice stays in [−1, 3] while lead is in [−1.35, 0.65], and turns twice as fast; lead itself is in [−1, 1].
    assert (tree.lower.tolist(), tree.upper.tolist()) == ([-2.0, -1.0], [2.0, pytest.approx(0.65)])
    assert tree.max_velocity.tolist() == [3.0, 0.5]
    for own, lead in random_configurations(tree, 20, rng):
        assert tree.chain_q("c", [own, lead]) == pytest.approx([own, 0.3 - 2.0 * lead])
        assert tree.chain_q("d", [own, lead]) == pytest.approx([-0.5 * lead])
        poses = tree.poses([own, lead])
        for tip, T in poses.items():
            expected = coupled.pose({"own": own, "lead": lead}, tip).homogeneous
            np.testing.assert_allclose(T.homogeneous, expected, atol=1e-15)
        for tip, J in tree.jacobians([own, lead]).items():
            np.testing.assert_allclose(J, differences(coupled, tree, tip, np.array([own, lead])), atol=1e-9)


def test_without_the_leader_the_first_follower_names_the_motor(coupled: nk.Robot) -> None:
    tree = coupled.tree("root", ["d", "c"])
    assert tree.joint_names == ("back", "own")
    for back in (-0.3, 0.0, 0.4):
        posture = coupled.expand({"back": back, "own": 0.7})
        assert tree.chain_q("c", [back, 0.7]) == pytest.approx([0.7, posture["twice"]])
        assert tree.q_of(posture) == pytest.approx([back, 0.7])
    assert (tree.lower[0], tree.upper[0]) == (pytest.approx(-0.325), pytest.approx(0.5))


def test_limits_are_those_of_the_robot_and_rules_hold_across_chains() -> None:
    rule = nk.LimitRule("LShoulderPitch", "RShoulderPitch", (-1.0, 1.0), (-0.5, 0.5), (0.0, 1.0))
    model = dataclasses.replace(robot("nao"), limit_rules=(*robot("nao").limit_rules, rule))
    tree = model.tree("torso", ["LArm", "RArm", "Head"])
    assert set(tree.limit_rules) == {rule, *model.chain("head").limit_rules}
    assert model.tree("torso", ["LArm", "Head"]).limit_rules == model.chain("head").limit_rules
    for tip, columns in tree.columns.items():
        chain = model.chain("torso", tip)
        for both in ("lower", "upper", "max_velocity"):
            np.testing.assert_array_equal(getattr(tree, both)[columns], getattr(chain, both))
    q = neutral(tree)
    q[tree.joint_names.index("RShoulderPitch")] = 1.0
    (outside,) = outside_limits(tree, q)
    assert (outside.joint, outside.lower, outside.upper) == ("LShoulderPitch", 0.5, 1.0)
    assert in_limits(tree, into_limits(tree, q))


def test_hand_written_chains_share_joints_by_name(rng: np.random.Generator) -> None:
    table = nk.document_chain("practicum_jaco2")
    elbow = dataclasses.replace(table, rows=table.rows[:3], tool=pin.SE3.Identity(), tip_name="elbow")
    narrow = dataclasses.replace(table.rows[0], lower=-1.0, upper=5.0)
    camera = dataclasses.replace(table, rows=(narrow, *table.rows[1:4]), tool=pin.SE3.Random(), tip_name="camera")
    tree = nk.Tree.of_chains([elbow, table, camera])
    assert tree.joint_names == table.joint_names
    assert tree.lower[0] == max(-1.0, table.lower[0])
    assert tree.upper[0] == min(5.0, table.upper[0])
    for q in rng.uniform(-1, 1, (20, 6)):
        poses, jacobians = tree.poses(q), tree.jacobians(q)
        for chain in (elbow, table, camera):
            n = len(chain.joints)
            np.testing.assert_array_equal(poses[chain.tip_name].homogeneous, chain.pose(q[:n]).homogeneous)
            np.testing.assert_array_equal(jacobians[chain.tip_name][:, :n], chain.jacobian(q[:n]))
            assert not jacobians[chain.tip_name][:, n:].any()
        np.testing.assert_array_equal(tree.q_of(posture_of(tree, q)), q)
    with pytest.raises(nk.NaoKinError, match="joint"):
        tree.q_of({"no_such_joint": 0.0})


def test_misuse_is_named() -> None:
    model = robot("nao")
    with pytest.raises(KeyError, match="Did you mean 'LArm'"):
        model.tree("torso", ["Larm"])
    with pytest.raises(KeyError, match="no_such_frame"):
        model.tree("no_such_frame", ["LArm"])
    with pytest.raises(ValueError, match="'LArm' twice"):
        model.tree("torso", ["LArm", "RArm", "LArm"])
    with pytest.raises(ValueError, match="at least one"):
        model.tree("torso", [])
    with pytest.raises(ValueError, match="a list of frames"):
        model.tree("torso", "LArm")
    with pytest.raises(ValueError, match="No moving joint"):
        model.tree("torso", ["LArm", "torso"])
    tree = model.tree("torso", ["LArm", "RArm"])
    with pytest.raises(KeyError, match="Did you mean 'RArm'"):
        tree.chain_q("Rarm", np.zeros(10))
    for bad in (np.zeros(9), np.full(10, np.nan), "q"):
        with pytest.raises(ValueError, match="10 numbers"):
            tree.poses(bad)
    with pytest.raises(KeyError, match="HeadYaww"):
        tree.q_of({"HeadYaww": 0.0})


def test_chains_that_do_not_belong_together_are_refused() -> None:
    nao, table = robot("nao"), nk.document_chain("practicum_jaco2")
    left, leg = nao.chain("torso", "LArm"), nao.chain("l_sole", "RLeg")
    of_another = robot("nao_v33_h21").chain("torso", "RArm")
    moved = dataclasses.replace(table, tip_name="camera")
    names: list[tuple[list[Chain], str]] = [
        ([left, leg], "'torso' and 'l_sole'"),
        ([left, of_another], "robot nao_v50_h25 and of robot nao_v33_h21"),
        ([left, dataclasses.replace(table, base_name="torso")], "a table of its own"),
        ([table, with_first(moved, kind="prismatic")], "one kind"),
        ([with_first(table, lower=0.0, upper=1.0), with_first(moved, lower=2.0, upper=3.0)], "in common"),
    ]
    for chains, words in names:
        with pytest.raises(ValueError, match=words):
            nk.Tree.of_chains(chains)
    for bad in (left, [left, None], "LArm"):
        with pytest.raises(ValueError, match="chains of a tree"):
            nk.Tree.of_chains(bad)  # type: ignore[arg-type]
    for tips in (5, None, ["LArm", None], "LArm"):
        with pytest.raises(ValueError, match="a list of frames"):
            nao.tree("torso", tips)  # type: ignore[arg-type]


def with_first(table: nk.DHChain, **changes: object) -> nk.DHChain:
    return dataclasses.replace(table, rows=(dataclasses.replace(table.rows[0], **changes), *table.rows[1:]))


def test_a_tree_survives_pickling_and_says_what_it_is() -> None:
    tree = robot("nao").tree("l_sole", ["LArm", "RArm"])
    again = pickle.loads(pickle.dumps(tree))  # noqa: S301 - our own bytes
    q = neutral(tree)
    for tip, T in tree.poses(q).items():
        np.testing.assert_array_equal(again.poses(q)[tip].homogeneous, T.homogeneous)
    assert tree.name == "nao_v50_h25 l_sole→LArm+RArm"
    assert repr(tree).startswith("<Tree nao_v50_h25 l_sole→LArm+RArm: LAnkleRoll, ")
