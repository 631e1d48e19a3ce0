"""Both feet stay where they stand while the torso moves in six axes, as far as eleven motors allow.

Positions of the feet are kept in any case. What the shared first hip joint cannot serve is given up in one of two ways:

* ``give="feet"``: the torso goes exactly where it is wanted, and each foot turns a little in its place, by the rule of
  `nao_kin.motion.nao.feet`;
* ``give="yaw"``: the feet stay as they are, orientation included, and the torso turns a little about its own z axis, to
  where both feet want the same angle of the shared joint. Right for feet that stand flat on the ground.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NoReturn

import numpy as np

from nao_kin.arrays import frozen, vector
from nao_kin.errors import InvalidInputError
from nao_kin.motion.feasible import Attempted, Refusal, refusal_where, refusals, said
from nao_kin.motion.nao.feet import both_feet, wanted_angles
from nao_kin.robot.motors import Motors
from nao_kin.se3 import PoseLike, as_pose, rotation_distance, rotation_z
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pinocchio as pin
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["BENT_KNEES", "TorsoMotion", "torso_motion"]

BENT_KNEES: Final = {
    f"{side}{joint}": value
    for side in "LR"
    for joint, value in (("HipPitch", -0.4), ("KneePitch", 0.8), ("AnklePitch", -0.4))
}
"""Legs with which a NAO's torso has room to move [rad]: soles level, knees bent by 0.8 rad."""

_AGREED: Final = 1e-11  # [rad] between the angles that the two feet want
_STEPS: Final = 30
_FIRST_STEP: Final = 1e-3  # [rad]


@dataclass(frozen=True, eq=False, slots=True)
class TorsoMotion(Attempted):
    """A motion of the torso over feet that stay, measured by the whole robot's forward kinematics.

    Attributes:
        attempt: What the joints would do: every joint of the robot that has a motor.
        position_errors: How far the left and the right foot are from where they stood (N, 2) [m].
        rotation_errors: By which angle they have turned (N, 2) [rad].
        yaw: By how much the torso is turned about its own z axis against what was wanted (N,) [rad].
        refused: What of it cannot be done.
    """

    attempt: Trajectory
    position_errors: Floats
    rotation_errors: Floats
    yaw: Floats
    refused: tuple[Refusal, ...]

    @property
    def message(self) -> str:
        """For people: what was measured, or why it is refused."""
        measured = (
            f"Feet stay within {self.position_errors.max():.2g} m and {self.rotation_errors.max():.2g} rad; "
            f"the torso's yaw gives way by up to {np.abs(self.yaw).max():.2g} rad."
        )
        return f"It cannot be done: {said(self.refused)} {measured}" if self.refused else measured

    def __bool__(self) -> NoReturn:
        raise TypeError("A TorsoMotion is not a truth value: ask whether motion.trajectory is None.")

    def __repr__(self) -> str:
        return f"<TorsoMotion: {self.message}>"


def torso_motion(
    robot: Robot,
    times: ArrayLike,
    T_start_torso: Sequence[PoseLike] | Floats,
    *,
    posture: Mapping[str, float] | None = None,
    give: Literal["feet", "yaw"] = "feet",
    weights: tuple[float, float] = (1.0, 1.0),
    frames: tuple[str, str, str] = ("torso", "l_sole", "r_sole"),
    tolerances: Tolerances = TOLERANCES,
) -> TorsoMotion:
    """Moves the torso over both feet, which stay where the start posture has them.

    Args:
        robot: A NAO, or another robot with such legs.
        times: When (N,) [s], strictly increasing.
        T_start_torso: Wanted poses of the torso (N), each seen from where it is in the start posture: identity is that.
        posture: The start posture; joints not named are at their neutral values. By default with `BENT_KNEES`.
        give: What gives way to the motor that both hips share; see the module.
        weights: With ``give="feet"``, how much the squared errors of the left and the right foot count.
        frames: Torso, left and right foot.
        tolerances: How far a foot may be from its place [m].

    Raises:
        InvalidInputError: Not poses, times that do not fit them or stand still, no such legs, or another `give`.
        UnknownNameError: No such frame or joint; carries near matches.
    """
    if give not in ("feet", "yaw"):
        raise InvalidInputError("give", "'feet' or 'yaw'", repr(give))
    if not isinstance(T_start_torso, Sequence | np.ndarray):
        raise InvalidInputError("T_start_torso", "a sequence of poses", repr(T_start_torso)[:60])
    wanted = [as_pose(T, f"T_start_torso, row {i}") for i, T in enumerate(T_start_torso)]
    instants = vector(times, "times", len(wanted))
    start = robot.complete(BENT_KNEES if posture is None else posture)
    base, *soles = frames
    legs, stood = [robot.chain(base, sole) for sole in soles], [robot.pose(start, sole, base) for sole in soles]
    joints, near = Motors.of(robot).joints, {name: start[name] for leg in legs for name in leg.joint_names}
    q, yaw = np.tile([start[joint.name] for joint in joints], (len(wanted), 1)), np.zeros(len(wanted))
    columns = {joint.name: k for k, joint in enumerate(joints)}
    turned = []
    for i, T in enumerate(wanted):
        yaw[i] = _agreeing_yaw(legs, T, stood, near, yaw[i - 1] if i else 0.0) if give == "yaw" else 0.0
        turned.append(T * rotation_z(yaw[i]))
        left, right = (turned[i].actInv(foot) for foot in stood)
        near = both_feet(legs[0], legs[1], left, right, weights=weights, near=near, tolerances=tolerances).posture
        for name, value in near.items():
            if name in columns:
                q[i, columns[name]] = value
    attempt = Trajectory(joints, instants, q, f"{robot.name} torso")
    far, angle = _measured(robot, attempt, turned, stood, frames)
    missed = [
        refusal
        for k, sole in enumerate(soles)
        for refusal in refusal_where(far[:, k] > tolerances.position, far[:, k], instants, sole, "off its place", "m")
    ]
    refused = (*missed, *refusals(attempt, robot.limit_rules, tolerances))
    return TorsoMotion(attempt, frozen(far), frozen(angle), frozen(yaw), refused)


def _agreeing_yaw(
    legs: list[UrdfChain], T_start_torso: pin.SE3, stood: list[pin.SE3], near: Mapping[str, float], guess: float
) -> float:
    """The turn of the torso about its z axis at which both feet want the same angle, by the secant method [rad].

    Where it does not converge, the last guess: what is left then is seen by the measurement.
    """

    def disagreement(yaw: float) -> float:
        T = T_start_torso * rotation_z(yaw)
        angles = wanted_angles(legs[0], legs[1], T.actInv(stood[0]), T.actInv(stood[1]), near)
        return angles[0] - angles[1]

    before, at = guess, guess + _FIRST_STEP
    value_before, value = disagreement(before), disagreement(at)
    if abs(value_before) < _AGREED:
        return before
    for _ in range(_STEPS):
        if abs(value) < _AGREED or value == value_before:
            return at
        before, at = at, at - value * (at - before) / (value - value_before)
        value_before, value = value, disagreement(at)
    return guess


def _measured(
    robot: Robot, attempt: Trajectory, T_start_torso: list[pin.SE3], stood: list[pin.SE3], frames: tuple[str, ...]
) -> tuple[Floats, Floats]:
    """Distances [m] and angles [rad] of the feet from where they stood (N, 2), by the whole robot."""
    far, angle = np.zeros((len(attempt), 2)), np.zeros((len(attempt), 2))
    for i, T in enumerate(T_start_torso):
        poses = robot.link_poses(attempt.posture(i))
        for k, foot in enumerate(stood):
            T_start_foot = T * poses[frames[0]].actInv(poses[frames[1 + k]])
            far[i, k] = np.linalg.norm(T_start_foot.translation - foot.translation)
            angle[i, k] = rotation_distance(T_start_foot, foot)
    return far, angle
