"""Feet that stay while the torso moves, measured by Pinocchio on the whole robot."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.nao.feet import BENT_KNEES, TorsoMotion, torso_motion
from nao_kin.se3 import from_xyz_rpy
from tests.conftest import robot

TIMES = np.linspace(0.0, 4.0, 25)
SIZES = np.array([0.015, 0.015, 0.012, 0.08, 0.08, 0.08])  # [m, rad]


def paths(rng: np.random.Generator, count: int) -> list[list[pin.SE3]]:
    """Random smooth paths of the torso that begin where it stands: three harmonics in each of the six axes."""
    found = []
    for _ in range(count):
        amplitudes = rng.uniform(-1.0, 1.0, (6, 3)) * SIZES[:, None] / 2.0
        waves = np.sin(np.outer(np.arange(1, 4), np.pi * TIMES / 4.0))
        found.append([from_xyz_rpy(six[:3], six[3:]) for six in (amplitudes @ waves).T])
    return found


def feet_by_pinocchio(name: str, motion: TorsoMotion, path: list[pin.SE3]) -> np.ndarray:
    """T_start_foot (N, 2, 4, 4) at the joints of the motion, the torso being where the path and its yaw have it."""
    model = robot(name).model
    data, found = model.createData(), []
    torso, *soles = (model.getFrameId(frame) for frame in ("torso", "l_sole", "r_sole"))
    for i, T in enumerate(path):
        q = pin.neutral(model)
        for joint, value in robot(name).expand(motion.attempt.posture(i)).items():
            q[model.joints[model.getJointId(joint)].idx_q] = value
        pin.framesForwardKinematics(model, data, q)
        yaw = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, motion.yaw[i]), np.zeros(3))
        found.append([(T * yaw * data.oMf[torso].actInv(data.oMf[sole])).homogeneous for sole in soles])
    return np.array(found)


@pytest.mark.parametrize("name", ["nao", "nao_v33_h21"])
@pytest.mark.parametrize("give", ["feet", "yaw"])
def test_both_feet_stay_on_random_paths_of_the_torso(name: str, give: str, rng: np.random.Generator) -> None:
    for path in paths(rng, 4):
        motion = torso_motion(robot(name), TIMES, path, give=give)  # type: ignore[arg-type]
        assert motion.trajectory is not None, motion.message
        feet = feet_by_pinocchio(name, motion, path)
        start = [robot(name).pose(robot(name).complete(BENT_KNEES), sole, "torso") for sole in ("l_sole", "r_sole")]
        for k, foot in enumerate(start):
            assert np.linalg.norm(feet[:, k, :3, 3] - foot.translation, axis=1).max() < 1e-9  # asked: 1e-6
            turned = [np.linalg.norm(pin.log3(T[:3, :3] @ foot.rotation.T)) for T in feet[:, k]]
            assert turned == pytest.approx(motion.rotation_errors[:, k], abs=1e-8)
        assert motion.position_errors.max() < 1e-9
        if give == "yaw":
            assert motion.rotation_errors.max() < 1e-7
            assert 0.0 < np.abs(motion.yaw).max() < 0.3
        else:
            assert not motion.yaw.any()
            assert 0.0 < motion.rotation_errors.max() < 0.3
        assert motion.attempt.velocities.max() < 10.0  # one branch all along


def test_straight_down_and_up_needs_nothing_to_give_way() -> None:
    path = [from_xyz_rpy((0.0, 0.0, -0.02 * np.sin(t))) for t in TIMES]
    for give in ("feet", "yaw"):
        motion = torso_motion(robot("nao"), TIMES, path, give=give)  # type: ignore[arg-type]
        assert motion.trajectory is not None
        assert motion.rotation_errors.max() < 1e-7
        assert np.abs(motion.yaw).max() < 1e-9


def test_the_other_joints_stay_as_they_are() -> None:
    posture = BENT_KNEES | {"LElbowRoll": -1.0, "HeadYaw": 0.3}
    motion = torso_motion(robot("nao"), [0.0, 1.0], [pin.SE3.Identity()] * 2, posture=posture)
    assert motion.attempt.posture(1) == pytest.approx(
        {name: robot("nao").complete(posture)[name] for name in motion.attempt.joint_names}, abs=1e-9
    )
    assert "RHipYawPitch" not in motion.attempt.joint_names


def test_what_the_legs_cannot_do_is_refused_with_time_and_amount() -> None:
    up = [from_xyz_rpy((0.0, 0.0, 0.002 * i)) for i in range(len(TIMES))]
    motion = torso_motion(robot("nao"), TIMES, up)
    assert motion.trajectory is None
    missed = {refusal.what: refusal for refusal in motion.refused if refusal.reason == "off its place"}
    assert set(missed) == {"l_sole", "r_sole"}
    # The torso can rise until thigh and shank are straight, which the start posture bends.
    straight, bent = 0.1 + 0.1029, np.sqrt(0.1**2 + 0.1029**2 + 2 * 0.1 * 0.1029 * np.cos(0.8))
    assert missed["l_sole"].amount == pytest.approx(0.048 - (straight - bent), abs=2e-4)
    assert missed["l_sole"].worst == TIMES[-1]
    assert "off its place" in motion.message
    quick = torso_motion(robot("nao"), TIMES / 100.0, paths(np.random.default_rng(1), 1)[0])
    assert {refusal.reason for refusal in quick.refused} == {"too fast"}
    with pytest.raises(TypeError, match="trajectory"):
        bool(quick)


def test_misuse_is_named() -> None:
    path = [pin.SE3.Identity()] * 2
    with pytest.raises(InvalidInputError, match="give"):
        torso_motion(robot("nao"), [0.0, 1.0], path, give="all")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="times"):
        torso_motion(robot("nao"), [0.0, 1.0, 2.0], path)
    with pytest.raises(InvalidInputError, match="increasing"):
        torso_motion(robot("nao"), [1.0, 0.0], path)
    with pytest.raises(InvalidInputError, match="T_start_torso, row 1"):
        torso_motion(robot("nao"), [0.0, 1.0], [np.eye(4), np.zeros((4, 4))])
    with pytest.raises(InvalidInputError, match="T_start_torso"):
        torso_motion(robot("nao"), [0.0], 5)  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="l_sole"):
        torso_motion(robot("nao"), [0.0, 1.0], path, frames=("torso", "lsole", "r_sole"))
    with pytest.raises(InvalidInputError, match="left leg"):
        torso_motion(robot("nao"), [0.0, 1.0], path, frames=("torso", "l_gripper", "r_sole"))
