"""The walker that the hexapod article is held against: the PhantomX, with Pinocchio's forward kinematics.

The article prints no dimensions. Lengths are in mm, as it has them; the body's frame has its origin midway between the
two middle hip servos, x forward, y to the left, z along the hip axes. A leg's angles are those the article computes:
the hip's turn ψ from the forward direction about z, the thigh's rise ε above the body's plane, the knee's inner
angle κ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.robot.robot import Robot, load
from nao_kin.se3 import rotation_x, rotation_y, rotation_z

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["LEGS", "Leg", "Stance", "body_poses", "foot_of", "legs_at", "phantomx", "stances", "walker"]

LEGS: Final = ("lf", "lm", "lr", "rf", "rm", "rr")
_MM: Final = 1000.0
_STANDING: Final = np.array([0.0, math.radians(-47.5), math.radians(-67.3)])
"""Joints of a leg with which the robot's file says it stands."""


@dataclass(frozen=True, eq=False, slots=True)
class Leg:
    """A leg at some joint angles, in the body's frame.

    Attributes:
        hip: Hip servo (3,) [mm].
        thigh: Thigh servo (3,) [mm].
        knee: Knee (3,) [mm].
        foot: Foot (3,) [mm].
    """

    hip: Floats
    thigh: Floats
    knee: Floats
    foot: Floats

    @property
    def angles(self) -> Floats:
        """ψ, ε and κ (3,) [rad], from these four points by directed angles."""
        out, femur, tibia = self.thigh - self.hip, self.knee - self.thigh, self.foot - self.knee
        psi = math.atan2(out[1], out[0])
        u = np.array([math.cos(psi), math.sin(psi), 0.0])
        kappa = math.atan2(float(np.linalg.norm(np.cross(femur, tibia))), -float(femur @ tibia))
        return np.array([psi, math.atan2(femur[2], float(femur @ u)), kappa])

    @property
    def below(self) -> float:
        """By which angle the foot is below the body's plane, seen from the thigh servo outwards [rad]."""
        g, out = self.foot - self.thigh, self.thigh - self.hip
        return math.atan2(-g[2], float(g @ out) / float(np.linalg.norm(out)))

    @property
    def at_thigh(self) -> float:
        """Angle between the thigh and the line to the foot [rad]."""
        femur, g = self.knee - self.thigh, self.foot - self.thigh
        return math.atan2(float(np.linalg.norm(np.cross(femur, g))), float(femur @ g))


@dataclass(frozen=True, eq=False, slots=True)
class Stance:
    """A body pose over feet that stay: T_ground_body turned by β about Y, α about X, γ about Z, and moved.

    Attributes:
        turn: α, β, γ [rad].
        moved: Translation (3,) [mm].
        T: The same as `pin.SE3` with its translation in mm.
        legs: The six legs in the body's frame, at Pinocchio's joint angles.
        feet: The feet on the ground (6, 3) [mm].
    """

    turn: Floats
    moved: Floats
    T: pin.SE3
    legs: tuple[Leg, ...]
    feet: Floats


@cache
def phantomx() -> Robot:
    """The robot."""
    return load("phantomx")


@cache
def walker() -> tuple[Floats, float, float, float]:
    """Hip servos (6, 3) and the lengths of hip, thigh and shin [mm]."""
    legs = legs_at(np.zeros((6, 3)))
    one = legs[0]
    lengths = (one.thigh - one.hip, one.knee - one.thigh, one.foot - one.knee)
    hip, thigh, shin = (float(np.linalg.norm(length)) for length in lengths)
    return np.array([leg.hip for leg in legs]), hip, thigh, shin


def legs_at(Q: Floats) -> tuple[Leg, ...]:
    """The six legs at joint angles (6, 3) [rad] of the robot's file, by Pinocchio."""
    names = [f"j_{part}_{leg}" for leg in LEGS for part in ("c1", "thigh", "tibia")]
    T_base_links = phantomx().link_poses(dict(zip(names, Q.ravel(), strict=True)))
    centre = 0.5 * (T_base_links["c1_lm"].translation + T_base_links["c1_rm"].translation)

    def at(link: str) -> Floats:
        return np.asarray(_MM * (T_base_links[link].translation - centre))

    return tuple(Leg(at(f"c1_{n}"), at(f"thigh_{n}"), at(f"tibia_{n}"), at(f"foot_{n}")) for n in LEGS)


@cache
def _directions() -> tuple[Floats, Floats]:
    """Angles at q = 0 (6, 3), and how each turns with its joint (6, 3): +1 or −1."""
    zero, step = np.array([leg.angles for leg in legs_at(np.zeros((6, 3)))]), 0.01
    moved = np.array([leg.angles for leg in legs_at(np.full((6, 3), step))])
    return zero, np.rint((moved - zero) / step)


def foot_of(angles: Floats) -> Floats:
    """Feet (6, 3) in the body's frame [mm] at angles (6, 3) of the article's kind, by Pinocchio."""
    zero, sign = _directions()
    return np.array([leg.foot for leg in legs_at((angles - zero) * sign)])


def body_poses(count: int, seed: int, tilt: float = 0.2) -> list[tuple[Floats, Floats]]:
    """Turns α, β, γ [rad] within the tilt and translations within 15 mm (3,) each."""
    rng = np.random.default_rng(seed)
    return [(rng.uniform(-tilt, tilt, 3), rng.uniform(-15.0, 15.0, 3)) for _ in range(count)]


def placed(turn: Floats, moved: Floats) -> pin.SE3:
    """T_ground_body in mm, turned about Y, then X, then Z."""
    rotation = rotation_z(turn[2]) * rotation_x(turn[0]) * rotation_y(turn[1])
    return pin.SE3(rotation.rotation, moved)


def stances(count: int, seed: int) -> list[Stance]:
    """Body poses, each over feet put on the ground by random joint angles about the standing ones."""
    rng, found = np.random.default_rng(seed), list[Stance]()
    for turn, moved in body_poses(count, seed):
        legs = legs_at(_STANDING + rng.uniform(-0.3, 0.3, (6, 3)))
        T = placed(turn, moved)
        feet = np.array([T.act(leg.foot) for leg in legs])
        found.append(Stance(turn, moved, T, legs, feet))
    return found
