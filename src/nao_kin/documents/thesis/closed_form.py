"""Bischoff 2016, section 3.3: the closed form of the arms, (3.3.0.1) to (3.3.0.16), printed, corrected, measured."""

from __future__ import annotations

import itertools
import math
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy import arccos, arcsin, cos, sin, sqrt
from numpy.linalg import inv

from nao_kin.documents.claim import Measured
from nao_kin.documents.samples import deviation, wrapped
from nao_kin.documents.thesis.coordinate_transforms import eq_2_2_1_1, eq_2_2_1_2, eq_2_2_1_3
from nao_kin.documents.thesis.thesis_arms import arm_configurations, described_arm, robot_arm
from nao_kin.se3 import rotation_angle, rotation_z, translation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from nao_kin.arrays import Floats

    Pair = tuple[Any, Any]
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.thesis.thesis_arms import DescribedArm, Side

    Call = Callable[[Form, DescribedArm, Floats, Floats], Any]

_QUARTER: Final = 1e-7  # |θ_3| this close to π/2 is π/2: an arc sine near 1 is known no better


def _homogeneous(R: Floats, t: Floats) -> Floats:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def eq_3_3_0_1(t: Floats, r: Floats) -> Floats:
    """(3.3.0.1): A, of a target's position and its angles about x, y and z."""
    return _homogeneous(eq_2_2_1_3(r[2]) @ eq_2_2_1_2(r[1]) @ eq_2_2_1_1(r[0]), t)


def s_definition(t: Floats, shoulder: Floats) -> Floats:
    """Text: s is the vector from the shoulder to the target position."""
    return t - shoulder


def s_definition_corrected(_t: Floats, shoulder: Floats) -> Floats:
    """The position of the shoulder, (0, ±l_1, l_2)."""
    return shoulder


# Left arm.


def eq_3_3_0_2(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """(3.3.0.2): θ_4."""
    root = sqrt((s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2)
    return -(pi - arccos((l_3**2 + l_4**2 - root) / (2 * l_3 * l_4)))


def eq_3_3_0_2_corrected(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """With the squared distance, as the law of cosines has it."""
    squared = (s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2
    return -(pi - arccos((l_3**2 + l_4**2 - squared) / (2 * l_3 * l_4)))


def eq_3_3_0_3(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """(3.3.0.3): θ_2."""
    above = A[1, 3] - l_1 - l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle + pi / 2, -angle + pi / 2


def eq_3_3_0_4(A: Floats, t_2: float) -> Any:
    """(3.3.0.4): θ_3."""
    return -arcsin(A[1, 2] / sin(t_2 - pi / 2))


def eq_3_3_0_5(A: Floats, t_2: float) -> Any:
    """(3.3.0.5): θ_3."""
    return -(pi - arcsin(A[1, 2] / sin(t_2 - pi / 2)))


def eq_3_3_0_6(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.6): θ_1 if θ_3 is not ±π/2."""
    above = A[2, 2] + A[0, 2] * sin(-t_3) * cos(t_2 - pi / 2) / cos(-t_3)
    angle = arccos(above / (cos(-t_3) + cos(t_2 - pi / 2) ** 2 * sin(-t_3) ** 2 / cos(-t_3)))
    return angle, -angle


def eq_3_3_0_7(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.7): θ_1 if θ_3 is ±π/2 and θ_2 is not 0."""
    angle = arccos(A[0, 2] / (cos(t_2 - pi / 2) * sin(-t_3)))
    return angle, -angle


def eq_3_3_0_8(A: Floats, T_4_end: Floats, l_3: float) -> Pair:
    """(3.3.0.8): θ_1 if θ_3 is ±π/2 and θ_2 is 0."""
    A_hat = A @ inv(T_4_end)
    angle = arccos(A_hat[0, 3] / l_3)
    return angle, -angle


# Right arm.


def eq_3_3_0_9(A: Floats) -> Floats:
    """(3.3.0.9): A', without the last turn of (3.1.0.2)."""
    return A @ inv(_homogeneous(eq_2_2_1_3(-pi), np.zeros(3)))


def eq_3_3_0_10(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """(3.3.0.10): θ_4."""
    root = sqrt((s[0] - A[0, 3]) ** 2 + (s[1] - A[1, 3]) ** 2 + (s[2] - A[2, 3]) ** 2)
    return pi - arccos((l_3**2 + l_4**2 - root) / (2 * l_3 * l_4))


def eq_3_3_0_10_corrected(A: Floats, s: Floats, l_3: float, l_4: float) -> Any:
    """With the squared distance."""
    return -eq_3_3_0_2_corrected(A, s, l_3, l_4)


def eq_3_3_0_11(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """(3.3.0.11): θ_2."""
    above = -A[1, 3] - l_1 - l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle - pi / 2, -angle - pi / 2


def eq_3_3_0_11_corrected(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Pair:
    """With the sign that A' needs in the last term above the line."""
    above = -A[1, 3] - l_1 + l_4 * sin(t_4) * A[1, 1] / cos(t_4)
    angle = arccos(above / (l_3 + l_4 * cos(t_4) + l_4 * sin(t_4) ** 2 / cos(t_4)))
    return angle - pi / 2, -angle - pi / 2


def eq_3_3_0_12(A: Floats, t_2: float) -> Any:
    """(3.3.0.12): θ_3."""
    return -arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_12_corrected(A: Floats, t_2: float) -> Any:
    """Without the minus, as the other branch of (3.3.0.13)."""
    return arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_13(A: Floats, t_2: float) -> Any:
    """(3.3.0.13): θ_3."""
    return pi - arcsin(A[1, 2] / sin(t_2 + pi / 2))


def eq_3_3_0_14(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.14): θ_1 if θ_3 is not ±π/2."""
    above = A[2, 2] + A[0, 2] * sin(t_3) * cos(t_2 + pi / 2) / cos(t_3)
    angle = arccos(above / (cos(t_3) + cos(t_2 + pi / 2) ** 2 * sin(t_3) ** 2 / cos(t_3)))
    return angle, -angle


def eq_3_3_0_15(A: Floats, t_2: float, t_3: float) -> Pair:
    """(3.3.0.15): θ_1 if θ_3 is ±π/2 and θ_2 is not 0."""
    angle = arccos(A[0, 2] / (cos(t_2 + pi / 2) * sin(t_3)))
    return angle, -angle


def eq_3_3_0_16(A: Floats, T_4_end: Floats, l_3: float) -> Pair:
    """(3.3.0.16): θ_1 if θ_3 is ±π/2 and θ_2 is 0."""
    A_hat = A @ inv(T_4_end)
    angle = arccos(A_hat[0, 3] / l_3)
    return angle, -angle


# The whole procedure: every candidate (θ_1, θ_2, θ_3, θ_4); step 7, the check by forward kinematics, is the caller's.


def left_pipeline(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """(3.3.0.2) to (3.3.0.8) with the text's s."""
    t_4 = eq_3_3_0_2(A, s_definition(A[:3, 3], shoulder), l_3, l_4)
    return _left_after_elbow(A, t_4, l_1, l_3, l_4)


def left_pipeline_corrected(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """With θ_4 and s corrected."""
    return _left_after_elbow(A, eq_3_3_0_2_corrected(A, shoulder, l_3, l_4), l_1, l_3, l_4)


def right_pipeline(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """(3.3.0.10) to (3.3.0.16) with the text's s; A is A'."""
    t_4 = eq_3_3_0_10(A, s_definition(A[:3, 3], shoulder), l_3, l_4)
    return _right_after_elbow(A, t_4, eq_3_3_0_11(A, t_4, l_1, l_3, l_4), eq_3_3_0_12, l_3, l_4)


def right_pipeline_corrected(A: Floats, shoulder: Floats, l_1: float, l_3: float, l_4: float) -> Floats:
    """With θ_4, s, θ_2 and (3.3.0.12) corrected."""
    t_4 = eq_3_3_0_10_corrected(A, shoulder, l_3, l_4)
    return _right_after_elbow(A, t_4, eq_3_3_0_11_corrected(A, t_4, l_1, l_3, l_4), eq_3_3_0_12_corrected, l_3, l_4)


def _left_after_elbow(A: Floats, t_4: float, l_1: float, l_3: float, l_4: float) -> Floats:
    rolls = eq_3_3_0_3(A, t_4, l_1, l_3, l_4)
    elbows = (eq_3_3_0_4, eq_3_3_0_5)
    return _candidates(A, t_4, rolls, elbows, (eq_3_3_0_6, eq_3_3_0_7, eq_3_3_0_8), (l_3, l_4))


def _right_after_elbow(
    A: Floats, t_4: float, rolls: Pair, first_elbow: Callable[[Floats, float], Any], l_3: float, l_4: float
) -> Floats:
    elbows = (first_elbow, eq_3_3_0_13)
    return _candidates(A, t_4, rolls, elbows, (eq_3_3_0_14, eq_3_3_0_15, eq_3_3_0_16), (l_3, l_4))


def _candidates(
    A: Floats,
    t_4: float,
    rolls: Pair,
    elbows: Iterable[Any],
    pitches: tuple[Any, Any, Any],
    lengths: tuple[float, float],
) -> Floats:
    generic, quarter, straight = pitches
    rows, T_end = [], _homogeneous(np.eye(3), np.array([lengths[1], 0.0, 0.0]))
    for t_2, elbow in itertools.product(rolls, elbows):
        t_3 = elbow(A, t_2)
        if not abs(abs(t_3) - pi / 2) <= _QUARTER:
            found = generic(A, t_2, t_3)
        elif abs(math.sin(t_2)) > _QUARTER:
            found = quarter(A, t_2, t_3)
        else:
            found = straight(A, T_end, lengths[0])
        rows += [(t_1, t_2, t_3, t_4) for t_1 in found]
    return np.array(rows)


_COUNT, _SEED = 200, 330
_MM: Final = 1000.0
_CLEAR: Final = 0.05
"""How far angles stay from where an arc cosine or sine loses its digits, or a divisor is 0 [rad]."""


def pose_mm(arm: DescribedArm, q: Floats) -> Floats:
    """T_torso_hand with its translation in mm, the unit of the thesis."""
    T = arm.pose(q)
    T[:3, 3] *= _MM
    return T


def robot_counts(q: Floats) -> Floats:
    """θ as the robot counts its joints."""
    return q


def table_counts(q: Floats) -> Floats:
    """θ as Tables 3 and 4 count: θ_3 against the robot's ElbowYaw."""
    theta: Floats = q * np.array([1.0, 1.0, -1.0, 1.0])
    return theta


def gives(
    side: Side,
    joint: int,
    call: Call,
    *,
    counts: Callable[[Floats], Floats] = robot_counts,
    where: Callable[[Floats], bool] = lambda q: abs(q[0]) > _CLEAR,
    place: Callable[[Floats], Floats] = lambda q: q,
    both: Callable[[float], float] | None = None,
) -> Check:
    """A check that a formula gives one joint.

    Args:
        side: Arm.
        joint: Which joint it gives, from 0.
        call: Calls the form with what it takes, out of the arm, A in mm and θ.
        counts: θ out of the robot's joints.
        where: Which configurations belong to its domain.
        place: Moves a configuration into its domain, where that is too thin to be met by chance.
        both: The second value of a ±, out of the first; the form then gives a pair, in any order.
    """

    def check(form: Form) -> Measured:
        arm, errors, cases = described_arm(side), list[float](), list["Floats"]()
        for drawn in arm_configurations(side, _COUNT, _SEED, where):
            q = place(drawn)
            theta = counts(q)
            found = call(form, arm, pose_mm(arm, q), theta)
            wanted = theta[joint]
            if both is None:
                errors.append(_off(found, wanted))
            else:
                errors.append(min(max(_off(a, wanted), _off(b, both(wanted))) for a, b in (found, found[::-1])))
            cases.append(q)
        return Measured.worst(errors, lambda k: f"joints {np.array2string(cases[k], precision=3)} rad")

    return check


def either_way(robots: Check, tables: Check) -> Check:
    """Both counts of θ_3 at once: what holds without saying which one is meant holds for both."""

    def check(form: Form) -> Measured:
        return max(robots(form), tables(form), key=lambda measured: measured.residual)

    return check


def _off(found: Any, wanted: float) -> float:
    return abs(float(wrapped(found - wanted)))


def shoulder_vector(side: Side) -> Check:
    """The definition of s, put into θ_4 of the squared distance."""

    def check(form: Form) -> Measured:
        arm, errors = described_arm(side), list[float]()
        for q in arm_configurations(side, _COUNT, _SEED):
            A = pose_mm(arm, q)
            s = form(A[:3, 3], _MM * arm.shoulder)
            errors.append(_off(eq_3_3_0_2_corrected(A, s, _MM * arm.l3, _MM * arm.l4), -abs(q[3])))
        lengths = f"|s − A_(·,4)| = |shoulder| = {_MM * float(np.linalg.norm(arm.shoulder)):.1f} mm"
        return Measured.worst(errors, found=f"As defined, {lengths} for every target.")

    return check


def target_pose(form: Form) -> Measured:
    """A against a turn about x, then y, then z of the torso, then the translation, by Pinocchio."""
    import pinocchio as pin

    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        t, r = rng.uniform(-1.0, 1.0, 3), rng.uniform(-math.pi, math.pi, 3)
        turned = pin.SE3.Identity()
        for axis, angle in zip(np.eye(3), r, strict=True):
            turned = pin.SE3(pin.exp3(axis * angle), np.zeros(3)) * turned
        errors.append(deviation(form(t, r), (translation(*t) * turned).homogeneous))
    return Measured.worst(errors)


def hand_turned_back(form: Form) -> Measured:
    """A' of the right hand as (3.1.0.2) has it, against the same without its last turn."""
    arm = described_arm("right")
    cases = arm_configurations("right", _COUNT, _SEED)
    turned = rotation_z(-math.pi).homogeneous
    return Measured.worst(deviation(form(arm.pose(q) @ turned), arm.pose(q)) for q in cases)


def height_of_shoulder(form: Form) -> Measured:
    """l_2 against the model, and whether any printed formula takes it."""
    import inspect

    from nao_kin.documents.thesis import closed_form as thesis_inverse

    names = [name for name in vars(thesis_inverse) if name.startswith("eq_3_3_0_") and "corrected" not in name]
    taking = [n for n in names if "l_2" in inspect.signature(getattr(thesis_inverse, n)).parameters]
    found = f"{len(taking)} of the {len(names)} equations take l_2; (3.3.0.2) needs it, as s_z = l_2."
    return Measured.worst([form(100.0) - _MM * described_arm("left").l2], found=found)


def pipeline(side: Side) -> Check:
    """Every candidate put through forward kinematics, as step 7 asks; the best one counts.

    The residual is that of targets of the described arm; the figures are of the robot's own arm too.
    """

    def check(form: Form) -> Measured:
        arm, lines = described_arm(side), list[str]()
        postures = arm_configurations(side, _COUNT, _SEED)
        targets = {
            "described arm": [arm.pose(q) for q in postures],
            "robot's arm": [robot_arm(side).pose(q).homogeneous for q in postures],
        }
        forward = {"described arm": arm.pose, "robot's arm": lambda q: robot_arm(side).pose(q).homogeneous}
        worst = list[float]()
        for name, poses in targets.items():
            best = [best_candidate(form, arm, T, forward[name]) for T in poses]
            solved = sum(far <= 1e-6 and turned <= 1e-6 for far, turned in best)
            far, turned = (np.array([b[k] for b in best]) for k in (0, 1))
            lines.append(
                f"{name}: {solved} of {len(poses)} solved; best candidate off by {_MM * float(np.median(far)):.3g} mm "
                f"and {float(np.median(turned)):.3g} rad in the median, {_MM * float(far.max()):.3g} mm and "
                f"{float(turned.max()):.3g} rad at most"
            )
            worst = worst or [max(f / (arm.l3 + arm.l4), t) for f, t in best]
        lines.append(_near_a_quarter(form, arm, postures[:50]))
        return Measured.worst(worst, found=";\n".join(lines) + ".")

    return check


def _near_a_quarter(form: Form, arm: DescribedArm, postures: Floats) -> str:
    """What is left of the digits where θ_3 is almost ±π/2: an arc sine near 1, then a division by cos θ_3."""
    told, lost = list[str](), 0
    for off in (1e-3, 1e-6, 0.0):
        moved = [np.array([q[0], q[1], math.copysign(0.5 * math.pi - off, q[2]), q[3]]) for q in postures]
        far = np.array([_MM * best_candidate(form, arm, arm.pose(q), arm.pose)[0] for q in moved])
        lost = int((far > 1e-3).sum())
        told.append(f"{far.max():.1g} mm at {off:g} rad")
    return f"θ_3 near ±π/2: off by up to {told[0]}, {told[1]}; at ±π/2 itself {lost} of {len(postures)} missed"


def best_candidate(
    form: Form, arm: DescribedArm, T: Floats, forward: Callable[[Floats], Floats]
) -> tuple[float, float]:
    """Position [m] and rotation [rad] error of the candidate closest to a target; without any, of the zero posture."""
    A = T.copy()
    A[:3, 3] *= _MM
    candidates = form(A, _MM * arm.shoulder, _MM * arm.l1, _MM * arm.l3, _MM * arm.l4)
    finite = [table_counts(theta) for theta in candidates if np.isfinite(theta).all()] or [np.zeros(4)]
    errors = []
    for q in finite:
        found = forward(q)
        turned = rotation_angle(np.asarray(T[:3, :3].T @ found[:3, :3]))
        errors.append((float(np.linalg.norm(found[:3, 3] - T[:3, 3])), turned))
    return min(errors, key=lambda e: max(e[0] / (arm.l3 + arm.l4), e[1]))
