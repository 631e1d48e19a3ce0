"""The claims of the hexapod article, held against the PhantomX (Pinocchio)."""

from __future__ import annotations

from typing import Final

from nao_kin.documents import hexapod_article as forms
from nao_kin.documents import hexapod_checks as checks
from nao_kin.documents.claim import Claim, Correction

__all__ = ["CLAIMS"]

_POSES: Final = f"{checks.COUNT} body poses, tilts and turns up to 0.2 rad, six legs each"
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
        check=checks.matrix,
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
        check=checks.order,
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
        check=checks.leg_by_leg(checks.hip_forward, checks.signed),
        reference=_LEG,
        domain=f"{_POSES}, exact matrix. Holds for feet on the outer side of their hips; the arc cosine has no sign",
        unit="rad",
        conventions={
            "it is counted from the rear for “along” pointing forward (from the front for “along” pointing back), and"
            " outwards on both sides": checks.leg_by_leg(checks.hip_rearward, checks.outward)
        },
        correction=Correction(
            forms.hip_angle_corrected,
            "α = atan2((b × a) · n, a · b), b = up × along, n the body's normal",
            latex=r"\alpha = \mathrm{atan2}\big((\vec b \times \vec a)\cdot \vec n,\ \vec a \cdot \vec b\big)",
            why="Directed planes tell left from right.",
            check=checks.leg_by_leg(checks.hip_forward, checks.signed),
        ),
    ),
    Claim(
        id="002:virtual-plane",
        place="step 3",
        said="Points shifted by any Δ in Z before the turn make a plane parallel to the body's at that distance.",
        formula="p ↦ p + (0, 0, Δ), then turned and moved",
        latex=r"\vec p \mapsto R\,(\vec p + (0, 0, \Delta)^T) + \vec t",
        printed=forms.virtual_plane,
        check=checks.plane,
        reference="the turned hip servos moved by Δ along the normal of their plane",
        domain=f"{checks.COUNT} body poses, Δ within ±100 mm, exact matrix; holds for all, of use for Δ ≠ 0",
    ),
    Claim(
        id="002:thigh-point",
        place="step 4",
        said="The thigh servo is a hip's length from the hip servo, in the body's plane, in the found direction.",
        formula="thigh = hip + (length cos ψ, length sin ψ, 0)",
        latex=r"\vec p_{thigh} = \vec p_{hip} + l\,(\cos\psi, \sin\psi, 0)^T",
        printed=forms.thigh_point,
        check=checks.thigh,
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
        check=checks.leg_by_leg(checks.triangle, checks.knee),
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
        check=checks.leg_by_leg(checks.triangle, checks.at_thigh),
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
        check=checks.leg_by_leg(checks.h_to_foot, checks.below),
        reference=f"{_LEG}: how far g is below the body's plane",
        domain=f"{_POSES}; holds for feet below the body's plane, since the arc cosine has no sign",
        unit="rad",
        conventions={
            "h runs from hip servo to thigh servo, not to the end effector as the struck words say": checks.leg_by_leg(
                checks.h_to_thigh, checks.below
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
        check=checks.leg_by_leg(checks.difference, checks.rise),
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
        check=checks.struck,
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
        check=checks.count,
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
        check=checks.whole,
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
