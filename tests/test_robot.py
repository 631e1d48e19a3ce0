"""Names, couplings, paths and limits of robots and their chains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import (
    in_limits,
    into_limits,
    neutral,
    outside_limits,
    random_configurations,
)
from nao_kin.errors import InvalidInputError, MissingExtraError, NoPathError, UnknownNameError, UrdfError
from tests.conftest import BUNDLED, EXAMPLES, MIMIC, needs_examples, robot

if TYPE_CHECKING:
    from pathlib import Path


def test_every_bundled_robot_loads_with_all_its_chains() -> None:
    for name in BUNDLED:
        model = robot(name)
        for chain_name, (base, tip) in model.chain_frames.items():
            chain = model.chain(chain_name)
            assert (chain.base, chain.tip) == (base, tip)
            assert isinstance(chain, nk.Chain)
        for effector in model.effectors:
            assert effector in model.frame_names


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_optional_robot_loads_with_all_its_chains(name: str) -> None:
    needs_examples()
    model = robot(name)
    for chain_name in model.chain_frames:
        assert len(model.chain(chain_name).joints) >= 2


def test_nao_means_v5_with_hands() -> None:
    assert nk.load("nao").name == "nao_v50_h25"
    assert nk.robot_names()[0] == "nao"
    assert list(nk.load("nao").chain("left_arm").joint_names) == [
        "LShoulderPitch",
        "LShoulderRoll",
        "LElbowYaw",
        "LElbowRoll",
        "LWristYaw",
    ]


@pytest.mark.parametrize(
    ("ask", "kind", "near"),
    [
        (lambda: nk.load("nao_v50h25"), "robot", "nao_v50_h25"),
        (lambda: robot("nao_v50_h25").chain("larm"), "chain", "left_arm"),
        (lambda: robot("nao_v50_h25").chain("torso", "larm"), "frame", "LArm"),
        (lambda: robot("nao_v50_h25").pose({}, "l_sol"), "frame", "l_sole"),
        (lambda: robot("nao_v50_h25").pose({"LElbowRol": 0.0}, "LArm"), "moving joint", "LElbowRoll"),
        (lambda: nk.document_chain("thesis_leftarm"), "document chain", "thesis_left_arm"),
        (lambda: nk.solve(robot("jaco2").chain("arm"), np.eye(4), method="lmm"), "method", "lm"),
        (lambda: nk.solve(robot("jaco2").chain("arm"), np.eye(4), {"joint1": 0.0}), "moving joint", "joint_1"),
    ],
)
def test_an_unknown_name_comes_with_near_matches(ask, kind: str, near: str) -> None:
    with pytest.raises(UnknownNameError) as caught:
        ask()
    assert caught.value.kind == kind
    assert near in caught.value.near
    assert near in str(caught.value)


def test_without_the_extra_the_error_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nao_kin.robot.known.example_robot_data_share", lambda: None)
    with pytest.raises(MissingExtraError, match=r"pip install 'nao_kin\[robots\]'") as caught:
        nk.load("ur5")
    assert caught.value.extra == "robots"


def test_a_path_that_is_no_file_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="no such file"):
        nk.load(tmp_path / "nothing.urdf")


def test_frames_without_a_joint_between_them_make_no_chain() -> None:
    with pytest.raises(NoPathError, match="fixed to the same link"):
        robot("nao_v50_h25").chain("l_sole", "LLeg")


def test_hip_yaw_pitch_is_one_motor() -> None:
    model = robot("nao_v50_h25")
    assert [(c.follower, c.leader, c.multiplier, c.offset) for c in model.couplings] == [
        ("RHipYawPitch", "LHipYawPitch", 1.0, 0.0)
    ]
    assert model.expand({"LHipYawPitch": -0.4})["RHipYawPitch"] == -0.4
    assert model.expand({"RHipYawPitch": -0.4})["LHipYawPitch"] == -0.4
    with pytest.raises(InvalidInputError, match=r"RHipYawPitch.*follows LHipYawPitch"):
        model.expand({"RHipYawPitch": -0.4, "LHipYawPitch": 0.1})


def test_a_follower_stands_for_itself_when_its_leader_is_off_the_path() -> None:
    assert "RHipYawPitch" in robot("nao_v50_h25").chain("right_leg").joint_names
    both = robot("nao_v50_h25").chain("l_sole", "r_sole")
    assert len(both.joints) == 11
    assert both.joint_names.count("LHipYawPitch") == 1
    assert "RHipYawPitch" not in both.joint_names
    assert len(both.link_poses(np.zeros(11))) == 12


def test_followers_add_to_their_leaders_column(mimic: nk.Robot, rng: np.random.Generator) -> None:
    """m_follow = 0.5 − 2 z_lead and a_follow = 0.1 m_follow; a follower sorts before its leader in both."""
    chain = mimic.chain("a", "d")
    assert chain.joint_names == ("z_lead",)
    for z in rng.uniform(-1, 1, 20):
        m = 0.5 - 2.0 * z
        x, y = np.cos(z) + 0.1 * m * np.cos(z + m), np.sin(z) + 0.1 * m * np.sin(z + m)
        np.testing.assert_allclose(chain.pose([z]).translation, (x, y, 0.0), atol=1e-15)
        expanded = mimic.expand({"z_lead": z})
        assert expanded["m_follow"] == pytest.approx(m)
        assert expanded["a_follow"] == pytest.approx(0.1 * m)
    # m_follow ≥ −0.5 allows z_lead ≤ 0.5; its speed of 2 allows 1; a_follow's 1 allows 5.
    assert (chain.lower[0], chain.upper[0]) == (-1.0, 0.5)
    assert chain.max_velocity[0] == 1.0
    # Its leader off the path, the first follower stands for the motor, with the range that all of them leave.
    behind = mimic.chain("b", "d")
    assert behind.joint_names == ("m_follow",)
    assert (behind.lower[0], behind.upper[0]) == (-0.5, 2.5)
    for m in rng.uniform(-0.5, 2.5, 20):
        posture = mimic.expand({"m_follow": m})
        assert posture["a_follow"] == pytest.approx(0.1 * m)
        expected = mimic.pose(posture, "d", base="b").homogeneous
        np.testing.assert_allclose(behind.pose([m]).homogeneous, expected, atol=1e-15)
    assert mimic.neutral == {"z_lead": 0.0, "m_follow": 0.5, "a_follow": 0.05}


def test_a_solution_is_always_a_posture_of_the_robot(mimic: nk.Robot) -> None:
    for base, tip in (("a", "d"), ("b", "d"), ("a", "c")):
        chain = mimic.chain(base, tip)
        result = nk.solve(chain, chain.pose([0.3]).translation)
        assert result.solved, result.message
        posture = mimic.expand(result.posture)
        assert not mimic.outside_limits(posture)


def test_a_posture_is_completed_with_neutral_values() -> None:
    model = robot("nao_v50_h25")
    whole = model.complete({"RHipYawPitch": -0.2, "LElbowRoll": -1.0})
    assert whole["LHipYawPitch"] == whole["RHipYawPitch"] == -0.2
    assert whole["RElbowRoll"] == model.neutral["RElbowRoll"] > 0.0
    assert not model.outside_limits(whole)
    (found,) = model.outside_limits({**whole, "HeadYaw": 1.5, "HeadPitch": 0.4})
    assert found.joint == "HeadPitch"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('multiplier="-2"', 'multiplier="0"'), r"m.urdf:6: .*multiplier 0"),
        (('lower="-0.5" upper="3"', 'lower="5" upper="6"'), "z_lead that its follower m_follow allows"),
        (('<origin xyz="1 0 0"/>', '<origin xyz="1e300 0 0"/>'), r"m.urdf:5: .*beyond ±1e\+09"),
    ],
)
def test_impossible_couplings_and_numbers_are_named(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    assert change[0] in MIMIC
    path = tmp_path / "m.urdf"
    path.write_text(MIMIC.replace(*change))
    with pytest.raises((UrdfError, InvalidInputError), match=message):
        nk.load(path).chain("a", "d")


def test_continuous_joints_take_one_number_and_no_limits() -> None:
    arm = robot("jaco2").chain("arm")
    assert [joint.kind for joint in arm.joints] == ["continuous", *["revolute"] * 2, *["continuous"] * 3]
    assert arm.lower[0] == -np.inf
    assert arm.upper[0] == np.inf
    np.testing.assert_allclose(
        arm.pose([0.3, 2, 2, 0, 0, 0]).homogeneous, arm.pose([0.3 + 2 * np.pi, 2, 2, 0, 0, 0]).homogeneous, atol=1e-14
    )


def test_coupled_limits_belong_to_the_chains_that_have_both_joints() -> None:
    model = robot("nao_v50_h25")
    assert [rule.joint for rule in model.chain("head").limit_rules] == ["HeadPitch"]
    assert [rule.joint for rule in model.chain("left_leg").limit_rules] == ["LAnkleRoll"]
    assert {rule.joint for rule in model.chain("l_sole", "r_sole").limit_rules} == {"LAnkleRoll", "RAnkleRoll"}
    assert not model.chain("left_arm").limit_rules
    assert not model.chain("Neck", "Head").limit_rules


@pytest.mark.parametrize(
    ("yaw_deg", "low_deg", "high_deg"),
    # The documentation's rows, one between two of them, and the same to the other side.
    [(0.0, -38.50, 29.51), (62.45, -24.64, 17.19), (-87.49, -18.91, 11.46), (35.585, -34.95, 22.69)],
)
def test_head_pitch_range_depends_on_head_yaw(yaw_deg: float, low_deg: float, high_deg: float) -> None:
    (rule,) = robot("nao_v50_h25").chain("head").limit_rules
    np.testing.assert_allclose(rule.range(np.radians(yaw_deg)), np.radians([low_deg, high_deg]), atol=2e-5)


def test_right_ankle_mirrors_the_left() -> None:
    model = robot("nao_v50_h25")
    (left,), (right,) = model.chain("left_leg").limit_rules, model.chain("right_leg").limit_rules
    for pitch in np.linspace(-1.2, 0.95, 50):
        low, high = left.range(pitch)
        assert right.range(pitch) == (-high, -low)


def test_limits_are_found_and_met(rng: np.random.Generator) -> None:
    head = robot("nao_v50_h25").chain("head")
    (found,) = outside_limits(head, [np.radians(87.49), 0.3])
    assert found.joint == "HeadPitch"
    assert found.upper == pytest.approx(0.200015, abs=1e-6)
    assert "HeadPitch = 0.3 is outside" in str(found)
    for name in ("head", "left_leg", "left_arm"):
        chain = robot("nao_v50_h25").chain(name)
        for q in rng.uniform(-4, 4, (200, len(chain.joints))):
            moved = into_limits(chain, q)
            assert in_limits(chain, moved)
            np.testing.assert_array_equal(into_limits(chain, moved), moved)
        assert all(in_limits(chain, q) for q in random_configurations(chain, 200, rng))


@pytest.mark.parametrize("name", [*BUNDLED, *EXAMPLES])
def test_neutral_is_inside_all_limits(name: str) -> None:
    if name in EXAMPLES:
        needs_examples()
    model = robot(name)
    assert set(model.neutral) == set(model.joint_names)
    for chain_name in model.chain_frames:
        assert in_limits(model.chain(chain_name), neutral(model.chain(chain_name)), tolerance=1e-12)


def test_reprs_say_what_it_is() -> None:
    assert repr(robot("jaco2")) == "<Robot jaco2: 6 moving joints, 8 frames>"
    assert "jaco2 arm" in repr(robot("jaco2").chain("arm"))
    assert "follows LHipYawPitch" in robot("nao_v50_h25")._repr_html_()


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "0.1", None, True])
def test_a_bad_posture_names_the_joint(value: object) -> None:
    with pytest.raises(InvalidInputError, match="LElbowRoll"):
        robot("nao_v50_h25").expand({"LElbowRoll": value})
