"""The claims of the hexapod article, held against the PhantomX (Pinocchio)."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.documents import hexapod_article as forms
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.hexapod_walker import body_poses, foot_of, phantomx, placed, stances, walker
from nao_kin.documents.sampling import deviation, wrapped
from nao_kin.se3 import rotation_x, rotation_y, rotation_z

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.hexapod_walker import Leg, Stance

    Call = Callable[[Form, Stance, int], Any]
    Wanted = Callable[[Leg, Stance, int], float]

_COUNT, _SEED = 40, 200
_FORWARD: Final = np.array([1.0, 0.0, 0.0])
_UP: Final = np.array([0.0, 0.0, 1.0])
_POSES: Final = f"{_COUNT} body poses, tilts and turns up to 0.2 rad, six legs each"


def _turns() -> Iterator[Floats]:
    yield from np.random.default_rng(_SEED).uniform(-1.0, 1.0, (200, 3))


def _matrix(form: Form) -> Measured:
    errors, skew, columns = list[float](), list[float](), list[float]()
    for turn in _turns():
        wanted, M = placed(turn, np.zeros(3)).rotation, form(*turn)
        errors.append(deviation(M, wanted))
        columns.append(deviation(M[:, :2], wanted[:, :2]))
        skew.append(deviation(M.T @ M, np.eye(3)))
    found = (
        f"First two columns: off by up to {max(columns):.2g}, so points with z = 0 come out right; third column by up\n"
        f"to {max(errors):.3g}. MᵀM departs from the unit matrix by up to {max(skew):.3g}."
    )
    turns = list(_turns())
    return Measured.worst(errors, lambda k: "α, β, γ = {:.2f}, {:.2f}, {:.2f} rad".format(*turns[k]), found)


def _order(form: Form) -> Measured:
    """The first two columns of the printed matrix, which are right, tell the order; other orders for comparison."""
    errors, others = list[float](), list[float]()
    hips = walker()[0]
    for turn in _turns():
        parts = [
            rotation(angle).rotation for rotation, angle in zip((rotation_x, rotation_y, rotation_z), turn, strict=True)
        ]
        R = form(*parts)
        errors.append(deviation(R[:, :2], forms.rotation_matrix(*turn)[:, :2]))
        for order in itertools.permutations(range(3)):
            if order != (2, 0, 1):
                other = parts[order[0]] @ parts[order[1]] @ parts[order[2]]
                others.append(float(np.linalg.norm(hips @ (other - R).T, axis=1).max()))
    found = (
        f"Any of the five other orders puts a hip servo elsewhere by up to {max(others):.0f} mm, at turns up to 1 rad."
    )
    return Measured.worst(errors, found=found)


def _plane(form: Form) -> Measured:
    """Parallel to the turned plane of the hip servos and at the distance Δ from it."""
    hips, rng, errors, printed = walker()[0], np.random.default_rng(_SEED), list[float](), list[float]()
    for turn, moved in body_poses(_COUNT, _SEED):
        delta, T = float(rng.uniform(-100.0, 100.0)), placed(turn, moved)
        real = np.array([T.act(p) for p in hips])
        normal = np.cross(real[3] - real[5], real[0] - real[3])
        shift = delta * normal / np.linalg.norm(normal)
        shifted = form(hips, delta)
        errors.append(deviation([T.act(p) for p in shifted], real + shift) / abs(delta))
        M = forms.rotation_matrix(*turn)
        printed.append(float(np.linalg.norm(M @ (shifted - hips)[0] - shift)) / abs(delta))
    found = f"With the printed matrix the plane is up to {100.0 * max(printed):.0f} % of Δ from where it should be."
    return Measured.worst(errors, found=found)


def _leg_by_leg(call: Call, wanted: Wanted, keep: Callable[[Leg], bool] = lambda leg: leg.below > 0.05) -> Check:
    """One angle [rad] of every leg of every stance."""

    def check(form: Form) -> Measured:
        errors = [
            float(wrapped(call(form, stance, k) - wanted(leg, stance, k)))
            for stance in stances(_COUNT, _SEED)
            for k, leg in enumerate(stance.legs)
            if keep(leg)
        ]
        return Measured.worst(errors)

    return check


def _servos(stance: Stance, k: int) -> tuple[Floats, Floats, Floats]:
    """Hip servo, its virtual twin and the foot on the ground."""
    hip = stance.legs[k].hip
    return stance.T.act(hip), stance.T.act(hip + 50.0 * _UP), stance.feet[k]


def _hip_forward(form: Form, stance: Stance, k: int) -> Any:
    return form(*_servos(stance, k), stance.T.rotation @ _FORWARD)


def _hip_rearward(form: Form, stance: Stance, k: int) -> Any:
    return form(*_servos(stance, k), -stance.T.rotation @ _FORWARD)


def _signed(leg: Leg, stance: Stance, k: int) -> float:
    return float(leg.angles[0])


def _outward(leg: Leg, stance: Stance, k: int) -> float:
    return abs(float(leg.angles[0]))


def _thigh(form: Form) -> Measured:
    hip, errors = walker()[1], list[float]()
    for stance in stances(_COUNT, _SEED):
        for leg in stance.legs:
            errors.append(deviation(form(leg.hip, leg.angles[0], hip), leg.thigh) / hip)
    return Measured.worst(errors)


def _g(stance: Stance, k: int) -> Floats:
    return np.asarray(stance.feet[k] - stance.T.act(stance.legs[k].thigh))


def _triangle(form: Form, stance: Stance, k: int) -> Any:
    _, _, thigh, shin = walker()
    return form(thigh, shin, float(np.linalg.norm(_g(stance, k))))


def _h_to_foot(form: Form, stance: Stance, k: int) -> Any:
    return form(stance.feet[k] - stance.T.act(stance.legs[k].hip), _g(stance, k))


def _h_to_thigh(form: Form, stance: Stance, k: int) -> Any:
    return form(stance.T.rotation @ (stance.legs[k].thigh - stance.legs[k].hip), _g(stance, k))


def _difference(form: Form, stance: Stance, k: int) -> Any:
    return form(stance.legs[k].at_thigh, stance.legs[k].below)


def _struck(form: Form) -> Measured:
    """Distance of each angle said to be a joint's from the nearer one of thigh and knee, and of those from it."""
    errors = []
    for stance in stances(_COUNT, _SEED):
        for leg in stance.legs:
            joints = leg.angles[1:]
            said = form(leg.angles[2], leg.at_thigh, leg.angles[1], leg.below)
            errors += [min(abs(angle - joint) for joint in joints) for angle in said]
            errors += [min(abs(angle - joint) for angle in said) for joint in joints]
    return Measured.worst(
        errors, found="a1 is the knee's angle and a3 the thigh's; a leg's third joint is the hip's α."
    )


def _count(form: Form) -> Measured:
    joints = len(phantomx().joint_names)
    return Measured.worst([form() - joints], found=f"Six legs of three joints: {joints}.")


def _whole(form: Form) -> Measured:
    """How far the feet of the computed angles are from where they should stay [mm]."""
    hips, *lengths = walker()
    errors, tilts = list[float](), list[str]()
    alone = {name: list[float]() for name in ("α", "β", "γ")}
    for stance in stances(_COUNT, _SEED):
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
        printed=forms.rotation_matrix,
        check=_matrix,
        reference="Rz(γ) Rx(α) Ry(β) by Pinocchio",
        domain="200 turns within ±1 rad; the third column holds for α = β = 0 only",
        correction=Correction(
            forms.rotation_matrix_corrected,
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
        printed=forms.stated_order,
        check=_order,
        reference="first two columns of the printed matrix",
        domain="200 turns within ±1 rad, about axes that stay",
    ),
    Claim(
        id="002:hip-angle",
        place="step 3",
        said="The hip servo's angle is that of two planes, by the arc cosine of their normals.",
        formula="α = arccos((a · b) / (|a| |b|)), a = up × (foot − hip), b = along × up",
        latex=r"\alpha = \arccos \frac{\vec a \cdot \vec b}{|\vec a| \cdot |\vec b|}",
        printed=forms.hip_angle,
        check=_leg_by_leg(_hip_forward, _signed),
        reference=_LEG,
        domain=f"{_POSES}, exact matrix. Holds for feet on the outer side of their hips; the arc cosine has no sign",
        unit="rad",
        conventions={
            "it is counted from the rear for “along” pointing forward (from the front for “along” pointing back), and"
            " outwards on both sides": _leg_by_leg(_hip_rearward, _outward)
        },
        correction=Correction(
            forms.hip_angle_corrected,
            "α = atan2((b × a) · n, a · b), b = up × along, n the body's normal",
            latex=r"\alpha = \mathrm{atan2}\big((\vec b \times \vec a)\cdot \vec n,\ \vec a \cdot \vec b\big)",
            why="Directed planes tell left from right.",
            check=_leg_by_leg(_hip_forward, _signed),
        ),
    ),
    Claim(
        id="002:virtual-plane",
        place="step 3",
        said="Points shifted by any Δ in Z before the turn make a plane parallel to the body's at that distance.",
        formula="p ↦ p + (0, 0, Δ), then turned and moved",
        latex=r"\vec p \mapsto R\,(\vec p + (0, 0, \Delta)^T) + \vec t",
        printed=forms.virtual_plane,
        check=_plane,
        reference="the turned hip servos moved by Δ along the normal of their plane",
        domain=f"{_COUNT} body poses, Δ within ±100 mm, exact matrix; holds for all, of use for Δ ≠ 0",
    ),
    Claim(
        id="002:thigh-point",
        place="step 4",
        said="The thigh servo is a hip's length from the hip servo, in the body's plane, in the found direction.",
        formula="thigh = hip + (length cos ψ, length sin ψ, 0)",
        latex=r"\vec p_{thigh} = \vec p_{hip} + l\,(\cos\psi, \sin\psi, 0)^T",
        printed=forms.thigh_point,
        check=_thigh,
        reference=_LEG,
        domain=f"{_POSES}, exact ψ from the X axis",
    ),
    Claim(
        id="002:a1",
        place="step 5, a1",
        said="The knee's inner angle by the law of cosines.",
        formula="a1 = arccos((thigh² + shin² − |g|²) / (2 thigh shin))",
        latex=r"a_1 = \arccos \frac{l_{thigh}^2 + l_{shin}^2 - |\vec g|^2}{2\, l_{thigh} l_{shin}}",
        printed=forms.a1,
        check=_leg_by_leg(_triangle, lambda leg, stance, k: float(leg.angles[2])),
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
        printed=forms.a2,
        check=_leg_by_leg(_triangle, lambda leg, stance, k: leg.at_thigh),
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
        printed=forms.a4,
        check=_leg_by_leg(_h_to_foot, lambda leg, stance, k: leg.below),
        reference=f"{_LEG}: how far g is below the body's plane",
        domain=f"{_POSES}; holds for feet below the body's plane, since the arc cosine has no sign",
        unit="rad",
        conventions={
            "h runs from the hip servo to the thigh servo, not to the end effector as the struck sentence says": _leg_by_leg(
                _h_to_thigh, lambda leg, stance, k: leg.below
            )
        },
    ),
    Claim(
        id="002:a3",
        place="step 5, a3",
        said="The thigh's rise above the body's plane.",
        formula="a3 = a2 − a4",
        latex=r"a_3 = a_2 - a_4",
        printed=forms.a3,
        check=_leg_by_leg(_difference, lambda leg, stance, k: float(leg.angles[1])),
        reference=_LEG,
        domain=f"{_POSES}, exact a2 and a4; knees up",
        unit="rad",
    ),
    Claim(
        id="002:struck-sentence",
        place="last sentence, struck through",
        said="a1, a2, a3 and a4 are the angles of the joints.",
        formula="joint angles: a1, a2, a3, a4",
        printed=forms.joint_angles,
        check=_struck,
        reference=_LEG,
        domain=_POSES,
        unit="rad",
        correction=Correction(
            forms.joint_angles_corrected,
            "joint angles: a1 (knee) and a3 (thigh), with the α of step 3 (hip)",
            why="A leg has three joints; a2 and a4 only help to find a3. The author struck the sentence himself.",
        ),
    ),
    Claim(
        id="002:joint-count",
        place="introduction",
        said="The robot has 18 joints.",
        formula="18 joints",
        printed=forms.joint_count,
        check=_count,
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
        printed=forms.whole_procedure,
        check=_whole,
        reference="the feet by Pinocchio's forward kinematics of the PhantomX",
        domain=f"{_POSES}, translations up to 15 mm, knees up, feet below the body and outside; “along” points back,"
        " h to the thigh servo, ψ by side",
        unit="mm",
        correction=Correction(
            forms.whole_procedure_corrected,
            "the third column of the matrix as of Rz(γ) Rx(α) Ry(β); the rest as printed",
            why="The body's plane comes out right, the virtual plane does not, and with it the hips' angles.",
        ),
    ),
)
