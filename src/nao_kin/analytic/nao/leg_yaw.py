"""Which poses of a foot go with an angle of the hip's first joint: what a robot needs whose legs share that motor.

With that joint decided, five joints are left for the six numbers of a pose. The pitch axis is across the hip's roll
axis x, across the line from hip H to ankle A, and across the ankle's roll axis w, so these three are in one plane:

    f = x · ((A − H) × w) = 0

Positions being kept, that is one equation for the three angles of the orientation; and since the ankle is not where the
tip is, the leg must be long enough for the orientation.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from nao_kin.analytic.form import Mismatch, screws
from nao_kin.analytic.nao.nao_leg import meeting_point, recognise, runs_backwards, segments
from nao_kin.kernels.compiling import jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["Hinges", "hinges", "nearest_orientation"]

_STEPS: Final = 100
_SMALLEST_STEP: Final = 1e-14  # [rad]


class Hinges(NamedTuple):
    """The points and axes that decide which poses of the foot go with an angle of the hip's first joint.

    Attributes:
        hip: Where the hip axes meet, in the leg's base (3,) [m].
        yaw_axis: The first axis, in the leg's base (3,).
        roll_axis: The second axis at q = 0, in the leg's base (3,).
        ankle: Where the ankle axes meet, in the tip's frame (3,) [m].
        foot_axis: The last axis, in the tip's frame (3,).
        beside: How far the ankle is beside the thigh's plane [m].
        thigh: From hip to knee [m].
        shank: From knee to ankle [m].
    """

    hip: Floats
    yaw_axis: Floats
    roll_axis: Floats
    ankle: Floats
    foot_axis: Floats
    beside: float
    thigh: float
    shank: float


def hinges(path: JointPath) -> Hinges | Mismatch:
    """The hinges of a leg whose path runs from the torso to the foot."""
    leg, geometry = screws(path, 6), recognise(path)
    if isinstance(leg, Mismatch):
        return leg
    if isinstance(geometry, Mismatch):
        return geometry
    if runs_backwards(geometry.parameters):
        return Mismatch("it runs from the foot to the torso")
    thigh, shank = segments(geometry.parameters)
    (hip, _), (ankle, _) = meeting_point(leg.axes[:3], leg.points[:3]), meeting_point(leg.axes[4:], leg.points[4:])
    R, p = leg.tip[:3, :3], leg.tip[:3, 3]
    return Hinges(
        hip=hip,
        yaw_axis=leg.axes[0],
        roll_axis=leg.axes[1],
        ankle=R.T @ (ankle - p),
        foot_axis=R.T @ leg.axes[5],
        beside=float(leg.axes[2] @ (hip - ankle)),
        thigh=thigh,
        shank=shank,
    )


@jit
def nearest_orientation(
    x: Floats, hip: Floats, ankle: Floats, foot_axis: Floats, longest: float, goal: Floats
) -> Floats:
    """The orientation (3, 3) nearest to a wanted one that goes with an angle of the hip's first joint.

    It makes the angle |ω| of R = exp(ω) R_wanted least where f(R) = 0 and |A − H| ≤ longest, the position being kept:
    from step to step the least ω on the linearised conditions (sequential quadratic programming with the metric of
    SO(3) as its Hessian).

    Args:
        x: The hip's roll axis at that angle, in base axes (3,).
        hip: See `Hinges` (3,) [m].
        ankle: See `Hinges` (3,) [m].
        foot_axis: See `Hinges` (3,).
        longest: How far the ankle may be from the hip [m].
        goal: The wanted pose of the tip (4, 4).
    """
    wanted, from_hip = goal[:3, :3].copy(), goal[:3, 3] - hip
    omega, R = np.zeros(3), wanted
    for _ in range(_STEPS):
        arm, w = R @ ankle, R @ foot_axis
        leg = from_hip + arm
        f = np.dot(x, np.cross(leg, w))
        gradient = np.cross(arm, np.cross(w, x)) + np.cross(w, np.cross(x, leg))
        squared = np.dot(gradient, gradient)
        if squared < 1e-24:  # to first order, any orientation goes with it
            break
        on_f = np.dot(gradient, omega) - f
        nearer = gradient * (on_f / squared)
        too_long, lengthens = np.dot(leg, leg) - longest * longest, 2.0 * np.cross(arm, leg)
        if too_long + np.dot(lengthens, nearer - omega) > 0.0:  # then the least ω is where the leg is stretched
            across, along = np.dot(gradient, lengthens), np.dot(lengthens, lengthens)
            area = squared * along - across * across
            if area > 1e-12 * squared * along:
                on_length = np.dot(lengthens, omega) - too_long
                nearer = gradient * ((on_f * along - on_length * across) / area)
                nearer += lengthens * ((on_length * squared - on_f * across) / area)
        R = _turn(nearer - omega) @ R
        moved = np.abs(nearer - omega).max()
        omega = _turn_between(wanted, R)
        if moved < _SMALLEST_STEP:
            break
    return R


@jit
def _turn(omega: Floats) -> Floats:
    """exp(ω), Rodrigues' formula (3, 3)."""
    angle = math.sqrt(np.dot(omega, omega))
    half = math.sin(0.5 * angle)
    first, second = (math.sin(angle) / angle, 2.0 * (half / angle) ** 2) if angle > 0.0 else (1.0, 0.5)
    K = np.array([[0.0, -omega[2], omega[1]], [omega[2], 0.0, -omega[0]], [-omega[1], omega[0], 0.0]])
    turn: Floats = np.eye(3) + first * K + second * (K @ K)
    return turn


@jit
def _turn_between(start: Floats, end: Floats) -> Floats:
    """ω (3,) with end = exp(ω) start, for angles below π."""
    E = end @ start.T
    twice_sine = np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    sine = 0.5 * math.sqrt(np.dot(twice_sine, twice_sine))
    angle = math.atan2(sine, 0.5 * (E[0, 0] + E[1, 1] + E[2, 2] - 1.0))
    omega: Floats = twice_sine * (0.5 * angle / sine if sine > 0.0 else 0.5)
    return omega
