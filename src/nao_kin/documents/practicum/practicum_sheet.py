"""Practicum sheet on numeric inverse kinematics of a 6-axis arm (Kinova JACO2 j2n6s300): chain, check pose, cases."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats
from nao_kin.chain import random_configurations
from nao_kin.dh.dh_chain import DHChain, DHRow
from nao_kin.documents.samples import regular_configurations
from nao_kin.robot.robot import load
from nao_kin.se3 import rpy

if TYPE_CHECKING:
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = [
    "CHECK_Q_DEG",
    "CHECK_T_BASE_HAND",
    "Near",
    "arm",
    "euler_jacobian",
    "euler_pose",
    "jaco2",
    "near_poses",
    "pose_error",
    "singular_configurations",
]

CHECK_Q_DEG: Final = (180.0, 270.0, 90.0, 180.0, 180.0, 0.0)
"""Task 1b: the joint angles of the check [deg]."""

CHECK_T_BASE_HAND: Final = (
    (0.0, 1.0, 0.0, 0.41),
    (-0.5, 0.0, 0.866, 0.2595),
    (0.866, 0.0, 0.5, 0.084),
    (0.0, 0.0, 0.0, 1.0),
)
"""Task 1b: the printed transform of the hand in the base [m], to the digits printed."""

# Kinova's own names: link lengths D1…D6, elbow offset e2 [m], half of the oblique wrist's bend aa.
_D1, _D2, _D3, _D4, _D5, _D6, _E2 = 0.2755, 0.4100, 0.2073, 0.0741, 0.0741, 0.1600, 0.0098
_AA = math.pi / 6
_BENT = math.sin(_AA) / math.sin(2.0 * _AA)
_QUARTER = math.pi / 2


def jaco2() -> DHChain:
    """The arm's DH table, standard convention, from the arm's own joint angles."""
    return DHChain(
        rows=(
            DHRow(0.0, _QUARTER, _D1, 0.0, sign=-1, name="joint_1"),
            DHRow(_D2, math.pi, 0.0, -_QUARTER, name="joint_2"),
            DHRow(0.0, _QUARTER, -_E2, _QUARTER, name="joint_3"),
            DHRow(0.0, 2.0 * _AA, -(_D3 + _D4 * _BENT), 0.0, name="joint_4"),
            DHRow(0.0, 2.0 * _AA, -(_D4 + _D5) * _BENT, -math.pi, name="joint_5"),
            DHRow(0.0, math.pi, -(_D6 + _D5 * _BENT), _QUARTER, name="joint_6"),
        ),
        convention="standard",
        base=pin.SE3(np.eye(4)),
        tool=pin.SE3(np.eye(4)),
        name="practicum_jaco2",
        base_name="link_base",
        tip_name="end_effector",
    )


@cache
def arm() -> UrdfChain:
    """The JACO2 from its base to the end effector."""
    return load("jaco2").chain("arm")


def euler_pose(q: Floats) -> Floats:
    """ρ(q) (6,): position [m], then roll, pitch, yaw [rad]."""
    T_base_tip = arm().pose(q)
    return np.concatenate([T_base_tip.translation, rpy(T_base_tip)])


def euler_jacobian(q: Floats) -> Floats:
    """dρ/dq (6, 6) from Pinocchio's frame Jacobian and its map from angular velocity to the rates of the angles."""
    J, rates = arm().jacobian(q), np.eye(6)
    rates[3:, 3:] = pin.rpy.computeRpyJacobianInverse(euler_pose(q)[3:], pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    return np.asarray(rates @ J)


class Near(NamedTuple):
    """A configuration and a pose within reach of one Newton step.

    Attributes:
        q: Joints (6,) [rad].
        J: dρ/dq there (6, 6).
        e: ρ wanted minus ρ(q) (6,) [m, rad].
        q_d: Joints of the wanted pose (6,) [rad].
    """

    q: Floats
    J: Floats
    e: Floats
    q_d: Floats


@cache
def near_poses(count: int = 100, seed: int = 3) -> tuple[Near, ...]:
    """Regular configurations with their Euler angles away from ±π and from pitch ±π/2, and poses 0.05 rad away."""
    rng, found = np.random.default_rng(seed), list[Near]()
    for q in regular_configurations(arm(), 4 * count, seed):
        roll, pitch, yaw = np.abs(euler_pose(q)[3:])
        if max(roll, yaw) < 3.0 and pitch < 1.3 and len(found) < count:
            q_d = q + rng.uniform(-0.05, 0.05, 6)
            found.append(Near(q, euler_jacobian(q), euler_pose(q_d) - euler_pose(q), q_d))
    return tuple(found)


def pose_error(wanted: pin.SE3, q: Floats) -> Floats:
    """Position error [m] and rotation vector [rad] (6,) that lead from q to the wanted pose, in base axes."""
    there = arm().pose(q)
    turn = pin.log3(wanted.rotation @ there.rotation.T)
    return np.concatenate([wanted.translation - there.translation, turn])


@cache
def singular_configurations(count: int = 50, seed: int = 4) -> tuple[Floats, ...]:
    """Configurations (6,) inside the limits at which det J = 0, found along the fifth joint by bisection."""
    rng, found = np.random.default_rng(seed), list[Floats]()
    angles = np.linspace(-np.pi, np.pi, 25)

    def at(q: Floats, angle: float) -> float:
        q[4] = angle
        return float(np.linalg.det(arm().jacobian(q)))

    while len(found) < count:
        q = random_configurations(arm(), 1, rng)[0]
        signs = np.sign([at(q, angle) for angle in angles])
        change = np.flatnonzero(signs[:-1] * signs[1:] < 0)
        if len(change):
            low, high = float(angles[change[0]]), float(angles[change[0] + 1])
            for _ in range(60):
                middle = (low + high) / 2.0
                low, high = (middle, high) if at(q, middle) * signs[change[0]] > 0 else (low, middle)
            q[4] = low
            found.append(q.copy())
    return tuple(found)
