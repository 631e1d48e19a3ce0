"""Arms that point and heads that look, measured by Pinocchio on the whole robot; and what cannot be pointed at."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.nao.pointing import Pointing, point_at
from tests.conftest import robot

SHOULDERS = {"left": np.array([0.0, 0.098, 0.1]), "right": np.array([0.0, -0.098, 0.1])}
TIPS = {"left": "LArm", "right": "RArm"}


def axis_of(name: str, found: Pointing, frame: str) -> tuple[np.ndarray, np.ndarray]:
    """Origin and x axis of a frame in the torso, at the end of the motion: the whole model, as Pinocchio read it."""
    model = robot(name).model
    data, q = model.createData(), pin.neutral(model)
    for joint, value in robot(name).expand(found.attempt.posture(-1)).items():
        q[model.joints[model.getJointId(joint)].idx_q] = value
    pin.framesForwardKinematics(model, data, q)
    T = data.oMf[model.getFrameId("torso")].actInv(data.oMf[model.getFrameId(frame)])
    return T.translation, T.rotation[:, 0]


def miss(origin: np.ndarray, axis: np.ndarray, point: np.ndarray) -> float:
    """Distance of a point from a ray [m]."""
    along = float((point - origin) @ axis)
    return float(np.linalg.norm(point - origin - max(along, 0.0) * axis))


def points(rng: np.random.Generator, count: int, near: float, far: float) -> np.ndarray:
    """Points in all directions from the middle of the shoulders (count, 3) [m]."""
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.array([0.0, 0.0, 0.1]) + rng.uniform(near, far, (count, 1)) * directions


@pytest.mark.parametrize("name", ["nao", "nao_v33_h21"])
def test_what_says_that_it_points_does(name: str, rng: np.random.Generator) -> None:
    looked = 0
    for p in [*points(rng, 40, 0.5, 5.0), *points(rng, 20, 0.1, 0.4)]:
        found = point_at(robot(name), p)
        origin, axis = axis_of(name, found, TIPS[found.arm])
        if found.points:
            assert miss(origin, axis, p) < 1e-6 * math.dist(p, origin) + 1e-12
        assert found.miss == pytest.approx(miss(origin, axis, p), abs=1e-9)
        assert (found.trajectory is not None) <= found.points
        if found.looks:
            looked += 1
            assert miss(*axis_of(name, found, "CameraTop_frame"), p) < 1e-6 * np.linalg.norm(p)
        if found.trajectory is not None:
            for i in (0, len(found.attempt) // 3, len(found.attempt) // 2, -1):
                assert not robot(name).outside_limits(found.attempt.posture(i))
            limits = np.array([joint.max_velocity for joint in found.attempt.joints])
            assert (np.abs(found.attempt.velocities) <= limits).all()
    assert looked >= 5


def test_points_ahead_can_all_be_pointed_at(rng: np.random.Generator) -> None:
    for p in points(rng, 40, 0.5, 5.0):
        p[0] = abs(p[0]) + 0.3
        found = point_at(robot("nao"), p)
        assert found.trajectory is not None, found.message
        assert found.arm == ("left" if p[1] >= 0.0 else "right")


def test_the_gesture_is_a_stretched_arm_and_leaves_the_rest_alone() -> None:
    found = point_at(robot("nao"), (1.0, 0.4, 0.3))
    posture = found.attempt.posture(-1)
    assert abs(posture["LElbowRoll"]) < 0.1
    origin, _ = axis_of("nao", found, "LArm")
    assert math.dist(origin, SHOULDERS["left"]) > 0.2
    moved = {n for n, v in posture.items() if abs(v - found.attempt.posture(0)[n]) > 1e-12}
    assert moved <= {*robot("nao").chain("left_arm").joint_names, "HeadYaw", "HeadPitch"}
    assert point_at(robot("nao"), (1.0, 0.4, 0.3), look=False).head is None


def test_it_starts_where_it_is_told_and_at_rest() -> None:
    start = {"LShoulderPitch": 1.5, "LElbowRoll": -1.0, "HeadYaw": 0.4}
    found = point_at(robot("nao"), (1.0, 0.4, 0.3), posture=start, duration=2.0, sample_time=0.013)
    assert found.attempt.posture(0) == pytest.approx(
        {n: robot("nao").complete(start)[n] for n in found.attempt.joint_names}
    )
    assert found.attempt.duration == 2.0
    assert np.abs(found.attempt.velocities[[0, -1]]).max() < 0.01
    assert found.trajectory is not None


def test_a_mirrored_point_is_pointed_at_by_the_other_arm_in_the_mirrored_way() -> None:
    left, right = point_at(robot("nao"), (0.8, 0.5, 0.2)), point_at(robot("nao"), (0.8, -0.5, 0.2))
    assert (left.arm, right.arm) == ("left", "right")
    here, there = left.attempt.posture(-1), right.attempt.posture(-1)
    for joint, sign in (("ShoulderPitch", 1), ("ShoulderRoll", -1), ("ElbowYaw", -1), ("ElbowRoll", -1)):
        assert there[f"R{joint}"] == pytest.approx(sign * here[f"L{joint}"], abs=1e-6)
    assert there["HeadYaw"] == pytest.approx(-here["HeadYaw"], abs=1e-9)


def test_the_point_may_be_given_in_another_frame() -> None:
    start = {"HeadYaw": 0.7}
    p = robot("nao").pose(robot("nao").complete(start), "CameraTop_frame", "torso").act(np.array([1.0, 0.1, 0.0]))
    seen = point_at(robot("nao"), (1.0, 0.1, 0.0), frame="CameraTop_frame", posture=start)
    given = point_at(robot("nao"), p, posture=start)
    assert seen.attempt.q == pytest.approx(given.attempt.q, abs=1e-12)


def test_what_cannot_be_pointed_at_is_refused_and_what_cannot_be_looked_at_is_said() -> None:
    inside = point_at(robot("nao"), (0.0, 0.0, 0.1))
    assert not inside.points
    assert inside.trajectory is None
    assert inside.refused[0].reason == "off its aim"
    assert inside.refused[0].amount == pytest.approx(inside.hand.rotation_error)
    assert not robot("nao").outside_limits(inside.attempt.posture(-1))
    above = point_at(robot("nao"), (1.0, 0.0, 5.0))
    assert above.points
    assert not above.looks
    assert "cannot look" in above.message
    with pytest.raises(TypeError, match="points"):
        bool(above)


def test_too_little_time_is_refused() -> None:
    found = point_at(robot("nao"), (1.0, 0.4, 0.3), posture={"LShoulderPitch": 1.5}, duration=0.1)
    assert found.points
    assert found.trajectory is None
    assert {refusal.reason for refusal in found.refused} == {"too fast"}


def test_misuse_is_named() -> None:
    with pytest.raises(InvalidInputError, match="arm"):
        point_at(robot("nao"), (1, 0, 0), arm="middle")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="point"):
        point_at(robot("nao"), (1, 0, math.nan))
    with pytest.raises(InvalidInputError, match="left_arm"):
        point_at(robot("phantomx"), (1, 0, 0), arm="left")
    with pytest.raises(InvalidInputError, match="duration"):
        point_at(robot("nao"), (1, 0, 0), duration=-1.0)
    with pytest.raises(InvalidInputError, match="samples"):
        point_at(robot("nao"), (1, 0, 0), sample_time=1e-9)
    with pytest.raises(UnknownNameError, match="CameraTop_frame"):
        point_at(robot("nao"), (1, 0, 0), camera="CameraTop")
    with pytest.raises(UnknownNameError, match="torso"):
        point_at(robot("nao"), (1, 0, 0), frame="torsoo")
