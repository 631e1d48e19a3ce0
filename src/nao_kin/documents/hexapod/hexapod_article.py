"""Hexapod article (M. Fauth, "Inverse Kinematik", 2010): body inverse kinematics, steps 1 to 5, as printed.

Angles α about X, β about Y, γ about Z; lengths in mm. The article's figures are not at hand, so what only they show is
named where it matters: which vector h is, and from where the hip's angle is counted.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cache
from math import cos, sin
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pinocchio as pin
from numpy import arccos, arctan2, cross, dot
from numpy.linalg import norm

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.samples import deviation, wrapped
from nao_kin.robot.robot import Robot, load
from nao_kin.se3 import rotation_x, rotation_y, rotation_z

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats

    Matrix = Callable[[float, float, float], Floats]
    from collections.abc import Iterator

    from nao_kin.documents.claim import Check, Form

    Call = Callable[[Form, "Stance", int], Any]
    Wanted = Callable[["Leg"], float]

__all__ = [
    "CLAIMS",
    "LEGS",
    "Leg",
    "Stance",
    "a1",
    "a2",
    "a3",
    "a4",
    "a4_corrected",
    "body_poses",
    "foot_of",
    "hip_angle",
    "hip_angle_corrected",
    "joint_angles",
    "joint_angles_corrected",
    "joint_count",
    "legs_at",
    "phantomx",
    "rotation_matrix",
    "rotation_matrix_corrected",
    "stances",
    "stated_order",
    "thigh_point",
    "virtual_plane",
    "walker",
    "whole_procedure",
    "whole_procedure_corrected",
]


def rotation_matrix(a: float, b: float, g: float) -> Floats:
    """Step 2: the matrix, term for term."""
    return np.array(
        [
            [
                cos(g) * cos(b) + (-sin(g)) * (-sin(a)) * (-sin(b)),
                (-sin(g)) * cos(a),
                cos(g) * sin(b) + (-sin(a)) * sin(b),
            ],
            [
                sin(g) * cos(b) + cos(g) * (-sin(a)) * (-sin(b)),
                cos(g) * cos(a),
                sin(g) * sin(b) + cos(a) * sin(b),
            ],
            [cos(a) * (-sin(b)), sin(a), cos(b)],
        ]
    )


def rotation_matrix_corrected(a: float, b: float, g: float) -> Floats:
    """Rz(γ) Rx(α) Ry(β): the first two columns as printed, and the third."""
    third = [
        cos(g) * sin(b) + sin(g) * sin(a) * cos(b),
        sin(g) * sin(b) - cos(g) * sin(a) * cos(b),
        cos(a) * cos(b),
    ]
    return np.column_stack([rotation_matrix(a, b, g)[:, :2], third])


def stated_order(about_x: Floats, about_y: Floats, about_z: Floats) -> Floats:
    """Step 2, text: turned about Y, then X, and finally Z, as a product of the three matrices."""
    return about_z @ about_x @ about_y


def virtual_plane(points: Floats, delta: float) -> Floats:
    """Step 3: the plane of hip servos shifted in Z, before it is turned."""
    shifted: Floats = points + np.array([0.0, 0.0, 1.0]) * delta
    return shifted


def hip_angle(hip: Floats, virtual_hip: Floats, foot: Floats, along: Floats) -> Any:
    """Step 3: angle of the normals of plane 1 (hip, virtual hip, foot) and plane 2 (along the body, up)."""
    up = virtual_hip - hip
    a, b = cross(up, foot - hip), cross(along, up)
    return arccos(dot(a, b) / (norm(a) * norm(b)))


def hip_angle_corrected(hip: Floats, virtual_hip: Floats, foot: Floats, along: Floats) -> Any:
    """Of directed planes, counted about the body's normal, so that left and right differ."""
    up = virtual_hip - hip
    a, b = cross(up, foot - hip), cross(up, along)
    return arctan2(cross(b, a) @ up / norm(up), a @ b)


def thigh_point(hip: Floats, psi: float, length: float) -> Floats:
    """Step 4: the thigh servo in the unturned body, seen from above; ψ from the X axis."""
    thigh: Floats = hip + np.array([length * cos(psi), length * sin(psi), 0.0])
    return thigh


def a1(thigh: float, shin: float, g: float) -> Any:
    """Step 5."""
    return arccos((thigh**2 + shin**2 - g**2) / (2 * thigh * shin))


def a2(thigh: float, shin: float, g: float) -> Any:
    """Step 5."""
    return arccos((thigh**2 + g**2 - shin**2) / (2 * thigh * g))


def a4(h: Floats, g: Floats) -> Any:
    """Step 5."""
    return arccos(dot(h, g) / (norm(h) * norm(g)))


def a4_corrected(h: Floats, g: Floats, up: Floats) -> Any:
    """Directed: how far g is below h, negative where it is above; h from hip servo to thigh servo."""
    return arctan2(-(g @ up) / norm(up), g @ h / norm(h))


def a3(angle_2: float, angle_4: float) -> float:
    """Step 5."""
    return angle_2 - angle_4


def joint_angles(angle_1: float, angle_2: float, angle_3: float, angle_4: float) -> tuple[float, ...]:
    """The struck sentence: a1, a2, a3, a4 are the angles of the joints."""
    return angle_1, angle_2, angle_3, angle_4


def joint_angles_corrected(angle_1: float, _angle_2: float, angle_3: float, _angle_4: float) -> tuple[float, ...]:
    """The knee's and the thigh's; a2 and a4 only help to find a3."""
    return angle_1, angle_3


def joint_count() -> int:
    """The introduction: joints of the robot."""
    return 18


def whole_procedure(
    hips: Floats, lengths: tuple[float, float, float], turn: Floats, moved: Floats, feet: Floats
) -> Floats:
    """Steps 1 to 5 with the printed matrix; what is left open is chosen so that the rest comes out right.

    Args:
        hips: Hip servos in the body (6, 3): left front, middle, rear, then right.
        lengths: Of hip, thigh and shin.
        turn: α, β, γ.
        moved: Translation (3,).
        feet: Feet on the ground (6, 3).

    Returns:
        ψ, a3 and a1 of each leg (6, 3) [rad]; ψ counted from the forward direction, positive on the left.
    """
    M = rotation_matrix(*turn)
    return _legs(M, hips, lengths, moved, feet)


def whole_procedure_corrected(
    hips: Floats, lengths: tuple[float, float, float], turn: Floats, moved: Floats, feet: Floats
) -> Floats:
    """The same with the matrix of the stated order."""
    return _legs(rotation_matrix_corrected(*turn), hips, lengths, moved, feet)


def _legs(M: Floats, hips: Floats, lengths: tuple[float, float, float], moved: Floats, feet: Floats) -> Floats:
    hip, thigh, shin = lengths
    real, virtual = (points @ M.T + moved for points in (hips, virtual_plane(hips, 50.0)))
    rows = []
    for k, foot in enumerate(feet):
        side = 1.0 if hips[k, 1] > 0.0 else -1.0
        psi = side * hip_angle(real[k], virtual[k], foot, real[2] - real[0])
        thigh_servo = M @ thigh_point(hips[k], psi, hip) + moved
        g, h = foot - thigh_servo, thigh_servo - real[k]
        distance = float(norm(g))
        rows.append((psi, a3(a2(thigh, shin, distance), a4(h, g)), a1(thigh, shin, distance)))
    return np.array(rows)


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


COUNT, _SEED = 40, 200
_FORWARD: Final = np.array([1.0, 0.0, 0.0])
_UP: Final = np.array([0.0, 0.0, 1.0])


def _turns() -> Iterator[Floats]:
    yield from np.random.default_rng(_SEED).uniform(-1.0, 1.0, (200, 3))


def matrix(form: Form) -> Measured:
    """The rotation matrix, and what is wrong with it column by column."""
    errors, skew, columns = list[float](), list[float](), list[float]()
    for turn in _turns():
        wanted, M = placed(turn, np.zeros(3)).rotation, form(*turn)
        errors.append(deviation(M, wanted))
        columns.append(deviation(M[:, :2], wanted[:, :2]))
        skew.append(deviation(M.T @ M, np.eye(3)))
    found = (
        f"First two columns: off by up to {max(columns):.2g}, so points with z = 0 come out right; third column by "
        f"up to {max(errors):.3g}. MᵀM departs from the unit matrix by up to {max(skew):.3g}."
    )
    turns = list(_turns())
    return Measured.worst(errors, lambda k: "α, β, γ = {:.2f}, {:.2f}, {:.2f} rad".format(*turns[k]), found)


def order(form: Form) -> Measured:
    """The first two columns of the printed matrix, which are right, tell the order; other orders for comparison."""
    errors, others = list[float](), list[float]()
    hips = walker()[0]
    for turn in _turns():
        parts = [
            rotation(angle).rotation for rotation, angle in zip((rotation_x, rotation_y, rotation_z), turn, strict=True)
        ]
        R = form(*parts)
        errors.append(deviation(R[:, :2], rotation_matrix(*turn)[:, :2]))
        for order in itertools.permutations(range(3)):
            if order != (2, 0, 1):
                other = parts[order[0]] @ parts[order[1]] @ parts[order[2]]
                others.append(float(np.linalg.norm(hips @ (other - R).T, axis=1).max()))
    found = (
        f"Any of the five other orders puts a hip servo elsewhere by up to {max(others):.0f} mm, at turns up to 1 rad."
    )
    return Measured.worst(errors, found=found)


def plane(form: Form) -> Measured:
    """Parallel to the turned plane of the hip servos and at the distance Δ from it."""
    hips, rng, errors, printed = walker()[0], np.random.default_rng(_SEED), list[float](), list[float]()
    for turn, moved in body_poses(COUNT, _SEED):
        delta, T = float(rng.uniform(-100.0, 100.0)), placed(turn, moved)
        real = np.array([T.act(p) for p in hips])
        normal = np.cross(real[3] - real[5], real[0] - real[3])
        shift = delta * normal / np.linalg.norm(normal)
        shifted = form(hips, delta)
        errors.append(deviation([T.act(p) for p in shifted], real + shift) / abs(delta))
        M = rotation_matrix(*turn)
        printed.append(float(np.linalg.norm(M @ (shifted - hips)[0] - shift)) / abs(delta))
    found = f"With the printed matrix the plane is up to {100.0 * max(printed):.0f} % of Δ from where it should be."
    return Measured.worst(errors, found=found)


def leg_by_leg(call: Call, wanted: Wanted, keep: Callable[[Leg], bool] = lambda leg: leg.below > 0.05) -> Check:
    """One angle [rad] of every leg of every stance."""

    def check(form: Form) -> Measured:
        errors = [
            float(wrapped(call(form, stance, k) - wanted(leg)))
            for stance in stances(COUNT, _SEED)
            for k, leg in enumerate(stance.legs)
            if keep(leg)
        ]
        return Measured.worst(errors)

    return check


def _servos(stance: Stance, k: int) -> tuple[Floats, Floats, Floats]:
    """Hip servo, its virtual twin and the foot on the ground."""
    hip = stance.legs[k].hip
    return stance.T.act(hip), stance.T.act(hip + 50.0 * _UP), stance.feet[k]


def hip_forward(form: Form, stance: Stance, k: int) -> Any:
    """Calls a hip angle with “along” pointing forward."""
    return form(*_servos(stance, k), stance.T.rotation @ _FORWARD)


def hip_rearward(form: Form, stance: Stance, k: int) -> Any:
    """Calls it with “along” pointing back."""
    return form(*_servos(stance, k), -stance.T.rotation @ _FORWARD)


def signed(leg: Leg) -> float:
    """Of the hip, from the forward direction."""
    return float(leg.angles[0])


def outward(leg: Leg) -> float:
    """Of the hip, outwards on both sides."""
    return abs(float(leg.angles[0]))


def rise(leg: Leg) -> float:
    """Of the thigh, above the body's plane."""
    return float(leg.angles[1])


def knee(leg: Leg) -> float:
    """Inner angle of the knee."""
    return float(leg.angles[2])


def at_thigh(leg: Leg) -> float:
    """Between thigh and g."""
    return leg.at_thigh


def below(leg: Leg) -> float:
    """From the body's plane down to g."""
    return leg.below


def thigh(form: Form) -> Measured:
    """The thigh servo in the body, in units of the hip."""
    hip, errors = walker()[1], list[float]()
    for stance in stances(COUNT, _SEED):
        for leg in stance.legs:
            errors.append(deviation(form(leg.hip, leg.angles[0], hip), leg.thigh) / hip)
    return Measured.worst(errors)


def _g(stance: Stance, k: int) -> Floats:
    return np.asarray(stance.feet[k] - stance.T.act(stance.legs[k].thigh))


def triangle(form: Form, stance: Stance, k: int) -> Any:
    """Calls a1 or a2."""
    _, _, thigh, shin = walker()
    return form(thigh, shin, float(np.linalg.norm(_g(stance, k))))


def h_to_foot(form: Form, stance: Stance, k: int) -> Any:
    """Calls a4 with h from the hip servo to the foot."""
    return form(stance.feet[k] - stance.T.act(stance.legs[k].hip), _g(stance, k))


def h_to_thigh(form: Form, stance: Stance, k: int) -> Any:
    """Calls a4 with h from the hip servo to the thigh servo."""
    return form(stance.T.rotation @ (stance.legs[k].thigh - stance.legs[k].hip), _g(stance, k))


def difference(form: Form, stance: Stance, k: int) -> Any:
    """Calls a3."""
    return form(stance.legs[k].at_thigh, stance.legs[k].below)


def struck(form: Form) -> Measured:
    """Distance of each angle said to be a joint's from the nearer one of thigh and knee, and of those from it."""
    errors = []
    for stance in stances(COUNT, _SEED):
        for leg in stance.legs:
            joints = leg.angles[1:]
            said = form(leg.angles[2], leg.at_thigh, leg.angles[1], leg.below)
            errors += [min(abs(angle - joint) for joint in joints) for angle in said]
            errors += [min(abs(angle - joint) for angle in said) for joint in joints]
    return Measured.worst(
        errors, found="a1 is the knee's angle and a3 the thigh's; a leg's third joint is the hip's α."
    )


def count(form: Form) -> Measured:
    """Moving joints of the robot."""
    joints = len(phantomx().joint_names)
    return Measured.worst([form() - joints], found=f"Six legs of three joints: {joints}.")


def whole(form: Form) -> Measured:
    """How far the feet of the computed angles are from where they should stay [mm]."""
    hips, *lengths = walker()
    errors, tilts = list[float](), list[str]()
    alone = {name: list[float]() for name in ("α", "β", "γ")}
    for stance in stances(COUNT, _SEED):
        errors += _foot_errors(form, hips, tuple(lengths), stance.turn, stance.moved, stance.legs)
        for k, name in enumerate(alone):
            turn = np.where(np.arange(3) == k, stance.turn, 0.0)
            alone[name] += _foot_errors(form, hips, tuple(lengths), turn, stance.moved, stance.legs)
    tilts = [f"{name} alone {max(found):.3g} mm" for name, found in alone.items()]
    near = sum(error <= 0.1 for error in errors)
    found = (
        f"{near} of {len(errors)} feet within 0.1 mm; {float(np.median(errors)):.3g} mm off in the median, "
        f"{max(errors):.3g} mm at most.\nWith one turn only, at most: {', '.join(tilts)}."
    )
    return Measured.worst(errors, lambda k: f"pose {k // 6 + 1}, leg {k % 6 + 1}", found)


def _foot_errors(
    form: Form, hips: Floats, lengths: tuple[float, ...], turn: Floats, moved: Floats, legs: tuple[Leg, ...]
) -> list[float]:
    """Distances of six feet [mm]; a leg without angles leaves its foot a thigh's length away at least."""
    T = placed(turn, moved)
    feet = np.array([T.act(leg.foot) for leg in legs])
    angles = form(hips, lengths, turn, moved, feet)
    reached = foot_of(np.nan_to_num(angles))
    errors = [math.dist(T.act(p), foot) for p, foot in zip(reached, feet, strict=True)]
    return [e if np.isfinite(row).all() else max(e, lengths[1]) for e, row in zip(errors, angles, strict=True)]


_POSES: Final = f"{COUNT} body poses, tilts and turns up to 0.2 rad, six legs each"
_LEG: Final = "the leg's joints as Pinocchio places them, angles by arc tangent"

CLAIMS: Final = (
    Claim(
        id="002:rotation-matrix",
        place="matrix of step 2",
        said="The matrix that turns a point about Y, X and Z.",
        formula="[[cγ cβ − sγ sα sβ, −sγ cα, cγ sβ − sα sβ],\n [sγ cβ + cγ sα sβ, cγ cα, sγ sβ + cα sβ],\n"
        " [−cα sβ, sα, cβ]]",
        latex=r"\begin{pmatrix} c_\gamma c_\beta - s_\gamma s_\alpha s_\beta & -s_\gamma c_\alpha &"
        r" c_\gamma s_\beta - s_\alpha s_\beta \\ s_\gamma c_\beta + c_\gamma s_\alpha s_\beta & c_\gamma c_\alpha &"
        r" s_\gamma s_\beta + c_\alpha s_\beta \\ -c_\alpha s_\beta & s_\alpha & c_\beta \end{pmatrix}",
        printed=rotation_matrix,
        check=matrix,
        reference="Rz(γ) Rx(α) Ry(β) by Pinocchio",
        domain="200 turns within ±1 rad; the third column holds for α = β = 0 only",
        correction=Correction(
            rotation_matrix_corrected,
            "third column: cγ sβ + sγ sα cβ, sγ sβ − cγ sα cβ, cα cβ",
            latex=r"\begin{pmatrix} c_\gamma s_\beta + s_\gamma s_\alpha c_\beta \\"
            r" s_\gamma s_\beta - c_\gamma s_\alpha c_\beta \\ c_\alpha c_\beta \end{pmatrix}",
            why="Factors are missing in all three entries of the third column.",
        ),
    ),
    Claim(
        id="002:rotation-order",
        place="text of step 2",
        said="Points are turned about Y, then X, and finally Z; another order gives other results.",
        formula="R = Rz(γ) Rx(α) Ry(β)",
        latex=r"R = R_z(\gamma) R_x(\alpha) R_y(\beta)",
        printed=stated_order,
        check=order,
        reference="first two columns of the printed matrix",
        domain="200 turns within ±1 rad, about axes that stay",
    ),
    Claim(
        id="002:hip-angle",
        place="step 3",
        said="The hip servo's angle is that of two planes, by the arc cosine of their normals.",
        formula="α = arccos((a · b) / (|a| |b|)), a = up × (foot − hip), b = along × up",
        latex=r"\alpha = \arccos \frac{\vec a \cdot \vec b}{|\vec a| \cdot |\vec b|}",
        printed=hip_angle,
        check=leg_by_leg(hip_forward, signed),
        reference=_LEG,
        domain=f"{_POSES}, exact matrix. Holds for feet on the outer side of their hips; the arc cosine has no sign",
        unit="rad",
        conventions={
            "it is counted from the rear for “along” pointing forward (from the front for “along” pointing back), and"
            " outwards on both sides": leg_by_leg(hip_rearward, outward)
        },
        correction=Correction(
            hip_angle_corrected,
            "α = atan2((b × a) · n, a · b), b = up × along, n the body's normal",
            latex=r"\alpha = \mathrm{atan2}\big((\vec b \times \vec a)\cdot \vec n,\ \vec a \cdot \vec b\big)",
            why="Directed planes tell left from right.",
            check=leg_by_leg(hip_forward, signed),
        ),
    ),
    Claim(
        id="002:virtual-plane",
        place="step 3",
        said="Points shifted by any Δ in Z before the turn make a plane parallel to the body's at that distance.",
        formula="p ↦ p + (0, 0, Δ), then turned and moved",
        latex=r"\vec p \mapsto R\,(\vec p + (0, 0, \Delta)^T) + \vec t",
        printed=virtual_plane,
        check=plane,
        reference="the turned hip servos moved by Δ along the normal of their plane",
        domain=f"{COUNT} body poses, Δ within ±100 mm, exact matrix; holds for all, of use for Δ ≠ 0",
    ),
    Claim(
        id="002:thigh-point",
        place="step 4",
        said="The thigh servo is a hip's length from the hip servo, in the body's plane, in the found direction.",
        formula="thigh = hip + (length cos ψ, length sin ψ, 0)",
        latex=r"\vec p_{thigh} = \vec p_{hip} + l\,(\cos\psi, \sin\psi, 0)^T",
        printed=thigh_point,
        check=thigh,
        reference=_LEG,
        domain=f"{_POSES}, exact ψ from the X axis",
    ),
    Claim(
        id="002:a1",
        place="step 5, a1",
        said="The knee's inner angle by the law of cosines.",
        formula="a1 = arccos((thigh² + shin² − |g|²) / (2 thigh shin))",
        latex=r"a_1 = \arccos \frac{l_{thigh}^2 + l_{shin}^2 - |\vec g|^2}{2\, l_{thigh} l_{shin}}",
        printed=a1,
        check=leg_by_leg(triangle, knee),
        reference=_LEG,
        domain=f"{_POSES}, g from the thigh servo to the foot; holds wherever the triangle exists",
        unit="rad",
    ),
    Claim(
        id="002:a2",
        place="step 5, a2",
        said="The angle between thigh and g by the law of cosines.",
        formula="a2 = arccos((thigh² + |g|² − shin²) / (2 thigh |g|))",
        latex=r"a_2 = \arccos \frac{l_{thigh}^2 + |\vec g|^2 - l_{shin}^2}{2\, l_{thigh} |\vec g|}",
        printed=a2,
        check=leg_by_leg(triangle, at_thigh),
        reference=_LEG,
        domain=f"{_POSES}, g from the thigh servo to the foot; holds wherever the triangle exists",
        unit="rad",
    ),
    Claim(
        id="002:a4",
        place="step 5, a4",
        said="The angle between h and g, which a3 is counted from.",
        formula="a4 = arccos((h · g) / (|h| |g|))",
        latex=r"a_4 = \arccos \frac{\vec h \cdot \vec g}{|\vec h| \cdot |\vec g|}",
        printed=a4,
        check=leg_by_leg(h_to_foot, below),
        reference=f"{_LEG}: how far g is below the body's plane",
        domain=f"{_POSES}; holds for feet below the body's plane, since the arc cosine has no sign",
        unit="rad",
        conventions={
            "h runs from hip servo to thigh servo, not to the end effector as the struck words say": leg_by_leg(
                h_to_thigh, below
            )
        },
    ),
    Claim(
        id="002:a3",
        place="step 5, a3",
        said="The thigh's rise above the body's plane.",
        formula="a3 = a2 − a4",
        latex=r"a_3 = a_2 - a_4",
        printed=a3,
        check=leg_by_leg(difference, rise),
        reference=_LEG,
        domain=f"{_POSES}, exact a2 and a4; knees up",
        unit="rad",
    ),
    Claim(
        id="002:struck-sentence",
        place="last sentence, struck through",
        said="a1, a2, a3 and a4 are the angles of the joints.",
        formula="joint angles: a1, a2, a3, a4",
        printed=joint_angles,
        check=struck,
        reference=_LEG,
        domain=_POSES,
        unit="rad",
        correction=Correction(
            joint_angles_corrected,
            "joint angles: a1 (knee) and a3 (thigh), with the α of step 3 (hip)",
            why="A leg has three joints; a2 and a4 only help to find a3. The author struck the sentence himself.",
        ),
    ),
    Claim(
        id="002:joint-count",
        place="introduction",
        said="The robot has 18 joints.",
        formula="18 joints",
        printed=joint_count,
        check=count,
        reference="moving joints of the PhantomX, six legs of three servos",
        domain="the one number",
        unit="joints",
        tolerance=0.0,
    ),
    Claim(
        id="002:whole-procedure",
        place="steps 1 to 5",
        said="The steps together keep the feet where they are.",
        formula="hip by two planes, thigh servo, a1 to a4; everything with the printed matrix",
        printed=whole_procedure,
        check=whole,
        reference="the feet by Pinocchio's forward kinematics of the PhantomX",
        domain=f"{_POSES}, translations up to 15 mm, knees up, feet below the body and outside; “along” points back,"
        " h to the thigh servo, ψ by side",
        unit="mm",
        correction=Correction(
            whole_procedure_corrected,
            "the third column of the matrix as of Rz(γ) Rx(α) Ry(β); the rest as printed",
            why="The body's plane comes out right, the virtual plane does not, and with it the hips' angles.",
        ),
    ),
)
