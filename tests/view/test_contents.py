"""What a page is made of, for everything it can show, and what is refused."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from tests.conftest import robot

import nao_kin as nk
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.view.contents import scene_of
from nao_kin.view.page import page, scene_json
from nao_kin.view.robot_scene import legs_of, limbs, main_tip
from nao_kin.view.scene import world_poses

if TYPE_CHECKING:
    from nao_kin.view.scene import Scene

WAVE = {"LShoulderPitch": -1.2, "LShoulderRoll": 0.4, "LElbowRoll": -0.5, "RElbowRoll": 0.5}


def tip_of(scene: Scene, chain: int = 0) -> np.ndarray:
    poses = world_poses(scene)
    return np.linalg.inv(poses[scene.chains[chain].base]) @ poses[scene.chains[chain].tip]


def jaco2_branches() -> nk.Solutions:
    arm = robot("jaco2").chain("arm")
    return nk.solve_all(arm, arm.pose(np.radians([180, 270, 90, 180, 180, 0])))


def test_named_postures_start_with_the_first_and_say_what_is_outside() -> None:
    nao = robot("nao")
    scene = scene_of(nao, {"wave": WAVE, "zero": {}})
    assert [posture.name for posture in scene.postures] == ["wave", "zero"]
    assert {joint.name: joint.value for joint in scene.joints} == nao.expand(WAVE)
    assert scene.postures[1].cells == ("outside: LElbowRoll, RElbowRoll",)
    assert scene.ghosts


def test_a_mixture_of_postures_and_numbers_is_refused() -> None:
    with pytest.raises(InvalidInputError, match="'HeadYaw'"):
        scene_of(robot("nao"), {"wave": WAVE, "HeadYaw": 0.1})
    with pytest.raises(UnknownNameError):
        scene_of(robot("nao"), {"wave": {"HedYaw": 0.1}})


def test_every_branch_is_a_posture_with_its_measured_errors() -> None:
    solutions = jaco2_branches()
    scene = scene_of(solutions)
    assert [posture.name for posture in scene.postures] == [result.branch for result in solutions]
    assert [posture.good for posture in scene.postures] == [result.solved for result in solutions]
    for posture, result in zip(scene.postures, solutions, strict=True):
        assert posture.values == result.posture
        assert posture.cells[0] == f"{1e3 * result.position_error:.0e}"
    np.testing.assert_allclose(tip_of(scene), scene.goals[0].T_base_target, rtol=0, atol=1e-9)
    assert scene.chains[0].name == "arm"


def test_no_solutions_are_nothing_to_show() -> None:
    arm = robot("jaco2").chain("arm")
    far = arm.pose(np.zeros(6))
    far.translation = np.array([3.0, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match="none: "):
        scene_of(nk.solve_all(arm, far))


def test_a_result_of_another_robot_is_refused() -> None:
    with pytest.raises(InvalidInputError, match="jaco2"):
        scene_of(robot("nao"), jaco2_branches())
    assert scene_of(nk.load("jaco2"), jaco2_branches()).postures  # the same file, loaded again
    table = nk.document_chain("practicum_jaco2")
    with pytest.raises(InvalidInputError, match="one of practicum_jaco2"):
        scene_of(robot("jaco2"), nk.solve(table, table.pose([0.3, 2.5, 1.5, 0.4, 0.5, 0.6])))


def test_a_run_ends_at_the_returned_joints_and_keeps_every_iterate() -> None:
    arm = robot("jaco2").chain("arm")
    result = nk.solve(arm, arm.pose([3.5, 2.5, 1.5, 0.4, 0.5, 0.6]), trace=True)
    scene = scene_of(result)
    motion, trace = scene.motion, result.trace
    assert motion is not None
    assert trace is not None
    np.testing.assert_allclose(motion.q[:-1], trace.q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.q[-1], result.q, rtol=0, atol=1e-9)
    assert [curve.name for curve in motion.curves] == ["position error", "rotation error"]
    np.testing.assert_array_equal(motion.curves[0].y[:-1], trace.position_error)
    assert motion.curves[0].y[-1] == result.position_error
    assert scene.panels[-1].lines == (result.message,)
    assert scene_of(nk.solve(arm, [0.3, 0.1, 0.5])).motion is None


def test_a_result_of_several_tips_has_a_target_for_each() -> None:
    hands = robot("nao").tree("torso", ["LArm", "RArm"])
    scene = scene_of(nk.solve(hands, {"LArm": [0.15, 0.12, 0.1], "RArm": [0.15, -0.12, 0.1]}, trace=True))
    assert [scene.chains[goal.chain].name for goal in scene.goals] == ["left_arm", "right_arm"]
    assert scene.motion is not None
    assert [curve.name for curve in scene.motion.curves] == ["LArm, position error", "RArm, position error"]
    for goal in scene.goals:
        assert np.linalg.norm((tip_of(scene, goal.chain) - goal.T_base_target)[:3, 3]) < 1e-6


def test_a_result_on_a_table_is_a_stick_figure() -> None:
    table = nk.document_chain("practicum_jaco2")
    scene = scene_of(nk.solve(table, table.pose([0.3, 2.5, 1.5, 0.4, 0.5, 0.6])))
    assert scene.rods
    np.testing.assert_allclose(tip_of(scene), scene.goals[0].T_base_target, rtol=0, atol=1e-6)


def test_a_trajectory_is_shown_as_it_is() -> None:
    nao = robot("nao")
    arm = nao.chain("left_arm")
    times = np.linspace(0.0, 2.0, 11)
    q = np.array([arm.q_of(WAVE)]) * times[:, None] / 2.0
    scene = scene_of(nao, nk.Trajectory(arm.joints, times, q, "raise"))
    assert scene.motion is not None
    np.testing.assert_allclose(scene.motion.q, q, rtol=0, atol=1e-9)
    assert scene.motion.joints == arm.joint_names


def test_a_trajectory_that_breaks_a_coupling_is_refused() -> None:
    names = ["LHipYawPitch", "RHipYawPitch"]
    with pytest.raises(InvalidInputError, match="RHipYawPitch"):
        scene_of(robot("nao"), nk.Trajectory(names, [0.0, 1.0], [[0.0, 0.0], [-0.1, -0.2]]))
    with pytest.raises(UnknownNameError):
        scene_of(robot("nao"), nk.Trajectory(["HedYaw"], [0.0], [[0.0]]))


@pytest.mark.parametrize("subject", [3, "nao", None])
def test_anything_else_is_refused_with_what_would_do(subject: object) -> None:
    with pytest.raises(InvalidInputError, match="Comparison"):
        scene_of(subject)  # type: ignore[arg-type]


def test_content_goes_with_a_robot_only() -> None:
    with pytest.raises(InvalidInputError, match="robot"):
        scene_of(jaco2_branches(), {"joint_1": 0.0})


def test_limbs_hold_every_joint_once_and_hands_go_with_their_arms() -> None:
    for name in ("nao", "jaco2", "phantomx"):
        groups = dict(limbs(robot(name)))
        joints = [joint for names in groups.values() for joint in names]
        assert sorted(joints) == sorted(robot(name).joint_names)
    assert "LHand" in dict(limbs(robot("nao")))["left arm"]


def test_six_legs_are_legs_and_arms_are_not() -> None:
    index = {link: k for k, link in enumerate(robot("phantomx").frame_names)}
    assert [leg.name for leg in legs_of(robot("phantomx"), index)] == ["LF", "LM", "LR", "RF", "RM", "RR"]
    for name in ("nao", "jaco2"):
        assert legs_of(robot(name), dict.fromkeys(robot(name).frame_names, 0)) == ()


def test_the_main_tip_is_as_far_out_as_any() -> None:
    jaco2 = robot("jaco2")
    assert len(jaco2.chain(jaco2.root, main_tip(jaco2)).path_joint_names) == len(jaco2.joint_names)


def test_the_data_are_json_with_numbers_in_full() -> None:
    scene = scene_of(jaco2_branches())
    data = json.loads(scene_json(scene))
    assert [joint["name"] for joint in data["joints"]] == list(robot("jaco2").joint_names)
    assert data["joints"][0]["lower"] is None  # −∞
    assert data["postures"][0]["values"] == list(scene.postures[0].values.values())
    for node, given in zip(data["nodes"], scene.nodes, strict=True):
        assert np.array_equal(np.array(node["placement"]).reshape(4, 4).T, given.placement)


def test_same_content_same_bytes() -> None:
    assert page(scene_of(jaco2_branches())) == page(scene_of(jaco2_branches()))
