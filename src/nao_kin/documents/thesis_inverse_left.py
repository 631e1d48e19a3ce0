"""The claims of Bischoff 2016, section 3.3, about targets and the left arm, (3.3.0.1) to (3.3.0.8)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.documents import thesis_inverse as forms
from nao_kin.documents.claim import Claim, Correction
from nao_kin.documents.thesis_inverse_checks import (
    either_way,
    gives,
    pipeline,
    shoulder_vector,
    table_counts,
    target_pose,
)
from nao_kin.se3 import translation

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.thesis_arms import DescribedArm, Side
    from nao_kin.documents.thesis_inverse_checks import Call

__all__ = ["CLAIMS"]

DESCRIBED: Final = "joint angles of the described arm (V5 model, ElbowOffsetY at the shoulder, no HandOffsetZ)"
COUNTED: Final = "θ_3 counts against the robot's ElbowYaw, as the table of section 3.1 has it"
SQUARED: Final = "The law of cosines needs the squared distance; a root adds mm to mm²."
_HALF: Final = math.pi / 2
_MM: Final = 1000.0
_CLEAR: Final = 0.05
_LIMITS: Final = "200 postures inside the limits"


def elbow_roll(form: Form, arm: DescribedArm, A: Floats, _theta: Floats) -> float:
    """Calls (3.3.0.2) or (3.3.0.10), s being the shoulder."""
    return float(form(A, _MM * arm.shoulder, _MM * arm.l3, _MM * arm.l4))


def shoulder_roll(form: Form, arm: DescribedArm, A: Floats, theta: Floats) -> tuple[float, float]:
    """Calls (3.3.0.3) or (3.3.0.11)."""
    first, second = form(A, theta[3], _MM * arm.l1, _MM * arm.l3, _MM * arm.l4)
    return first, second


def elbow_yaw(form: Form, _arm: DescribedArm, A: Floats, theta: Floats) -> float:
    """Calls (3.3.0.4), (3.3.0.5) and their like."""
    return float(form(A, theta[1]))


def shoulder_pitch(form: Form, _arm: DescribedArm, A: Floats, theta: Floats) -> tuple[float, float]:
    """Calls (3.3.0.6), (3.3.0.7) and their like."""
    first, second = form(A, theta[1], theta[2])
    return first, second


def upper_arm_pitch(form: Form, arm: DescribedArm, A: Floats, _theta: Floats) -> tuple[float, float]:
    """Calls (3.3.0.8) or (3.3.0.16)."""
    first, second = form(A, translation(_MM * arm.l4, 0.0, 0.0).homogeneous, _MM * arm.l3)
    return first, second


def small_yaw(q: Floats) -> bool:
    """|θ_3| below π/2, and nothing near where the formulas lose digits."""
    return abs(q[0]) > _CLEAR and abs(q[2]) < _HALF - _CLEAR and math.cos(q[1]) > _CLEAR


def large_yaw(q: Floats) -> bool:
    """|θ_3| above π/2."""
    return abs(q[0]) > _CLEAR and abs(q[2]) > _HALF + _CLEAR and math.cos(q[1]) > _CLEAR


def clear_of_quarter(q: Floats) -> bool:
    """θ_3 anywhere but at ±π/2."""
    return small_yaw(q) or large_yaw(q)


def rolled(q: Floats) -> bool:
    """θ_2 not 0."""
    return bool(abs(q[0]) > _CLEAR and abs(q[1]) > _CLEAR)


def at_quarter(q: Floats) -> Floats:
    """The same with θ_3 at ±π/2."""
    return np.array([q[0], q[1], math.copysign(_HALF, q[2]), q[3]])


def straight(q: Floats) -> Floats:
    """The same with θ_3 at ±π/2 and θ_2 at 0."""
    return np.array([q[0], 0.0, math.copysign(_HALF, q[2]), q[3]])


def mirrored(t: float) -> float:
    """The second value of θ_2."""
    return math.pi - t


def opposite(t: float) -> float:
    """The second value of θ_1."""
    return -t


def counted(side: Side, joint: int, call: Call, **options: Any) -> tuple[Check, dict[str, Check]]:
    """The check of a formula with θ_3 in it, as it stands and as the tables count θ_3."""
    tables = gives(side, joint, call, counts=table_counts, **options)
    return either_way(gives(side, joint, call, **options), tables), {COUNTED: tables}


_SMALL = counted("left", 2, elbow_yaw, where=small_yaw)
_LARGE = counted("left", 2, elbow_yaw, where=large_yaw)
_GENERIC = counted("left", 0, shoulder_pitch, both=opposite, where=clear_of_quarter)
_AT_QUARTER = counted("left", 0, shoulder_pitch, both=opposite, where=rolled, place=at_quarter)


CLAIMS: Final = (
    Claim(
        id="000:3.3.0.1",
        place="equation (3.3.0.1)",
        said="The target's matrix out of its position and its angles about x, y and z.",
        formula="A = T_t R_z,r_z R_y,r_y R_x,r_x",
        latex=r"A = T_{\vec t} R_{z,r_z} R_{y,r_y} R_{x,r_x}",
        printed=forms.eq_3_3_0_1,
        check=target_pose,
        reference="turns about the torso's x, then y, then z, then the translation (Pinocchio)",
        domain="200 random targets; holds for all",
    ),
    Claim(
        id="000:3.3.0.2",
        place="equation (3.3.0.2)",
        said="θ_4 of the left arm by the law of cosines.",
        formula="θ_4 = −(π − arccos((l_3² + l_4² − √((s_x − A_(1,4))²\n"
        "      + (s_y − A_(2,4))² + (s_z − A_(3,4))²)) / (2 l_3 l_4)))",
        latex=r"\theta_4 = -\left(\pi - \arccos \frac{l_3^2 + l_4^2 - \sqrt{(s_x - A_{(1,4)})^2 +"
        r" (s_y - A_{(2,4)})^2 + (s_z - A_{(3,4)})^2}}{2 l_3 l_4}\right)",
        printed=forms.eq_3_3_0_2,
        check=gives("left", 3, elbow_roll),
        reference=DESCRIBED,
        domain=f"{_LIMITS}, lengths in mm, s the shoulder",
        unit="rad",
        correction=Correction(
            forms.eq_3_3_0_2_corrected,
            "θ_4 = −(π − arccos((l_3² + l_4² − |s − A_(·,4)|²) / (2 l_3 l_4)))",
            latex=r"\theta_4 = -\left(\pi - \arccos \frac{l_3^2 + l_4^2 - (s_x - A_{(1,4)})^2 -"
            r" (s_y - A_{(2,4)})^2 - (s_z - A_{(3,4)})^2}{2 l_3 l_4}\right)",
            why=SQUARED,
        ),
    ),
    Claim(
        id="000:3.3-s-definition",
        place="list of symbols after (3.3.0.8)",
        said="s is the vector from the shoulder to the target position.",
        formula="s = target − shoulder",
        latex=r"\vec s = \vec t - \vec p_{shoulder}",
        printed=forms.s_definition,
        check=shoulder_vector("left"),
        reference="θ_4 of the described arm, by (3.3.0.2) with the squared distance",
        domain=_LIMITS,
        unit="rad",
        correction=Correction(
            forms.s_definition_corrected,
            "s = position of the shoulder = (0, l_1, l_2), on the right (0, −l_1, l_2)",
            latex=r"\vec s = (0, \pm l_1, l_2)^T",
            why="With the vector to the target the distance in (3.3.0.2) is the same for every target.",
        ),
    ),
    Claim(
        id="000:3.3.0.3",
        place="equation (3.3.0.3)",
        said="θ_2 of the left arm, two solutions.",
        formula="θ_2 = ± arccos((A_(2,4) − l_1 − l_4 sin θ_4 A_(2,2) / cos θ_4)\n"
        "      / (l_3 + l_4 cos θ_4 + l_4 sin² θ_4 / cos θ_4)) + π/2",
        latex=r"\theta_2 = \pm\arccos \frac{A_{(2,4)} - l_1 - \frac{l_4 \sin\theta_4 A_{(2,2)}}{\cos\theta_4}}"
        r"{l_3 + l_4\cos\theta_4 + l_4\frac{\sin^2\theta_4}{\cos\theta_4}} + \frac{\pi}{2}",
        printed=forms.eq_3_3_0_3,
        check=gives("left", 1, shoulder_roll, both=mirrored),
        reference=DESCRIBED,
        domain=f"{_LIMITS}; holds for cos θ_4 ≠ 0. The lower sign gives |θ_2| < π/2, the other π − θ_2",
        unit="rad",
    ),
    Claim(
        id="000:3.3.0.4",
        place="equation (3.3.0.4)",
        said="θ_3 of the left arm, first solution.",
        formula="θ_3 = −arcsin(A_(2,3) / sin(θ_2 − π/2))",
        latex=r"\theta_3 = -\arcsin \frac{A_{(2,3)}}{\sin(\theta_2 - \frac{\pi}{2})}",
        printed=forms.eq_3_3_0_4,
        check=_SMALL[0],
        reference=DESCRIBED,
        domain="200 postures with |θ_3| < π/2; holds there, for cos θ_2 ≠ 0",
        unit="rad",
        conventions=_SMALL[1],
    ),
    Claim(
        id="000:3.3.0.5",
        place="equation (3.3.0.5)",
        said="θ_3 of the left arm, second solution.",
        formula="θ_3 = −(π − arcsin(A_(2,3) / sin(θ_2 − π/2)))",
        latex=r"\theta_3 = -\left(\pi - \arcsin \frac{A_{(2,3)}}{\sin(\theta_2 - \frac{\pi}{2})}\right)",
        printed=forms.eq_3_3_0_5,
        check=_LARGE[0],
        reference=DESCRIBED,
        domain="200 postures with |θ_3| > π/2, to whole turns; holds there, for cos θ_2 ≠ 0",
        unit="rad",
        conventions=_LARGE[1],
    ),
    Claim(
        id="000:3.3.0.6",
        place="equation (3.3.0.6), if θ_3 ≠ |π/2|",
        said="θ_1 of the left arm, two solutions of which one is it.",
        formula="θ_1 = ± arccos((A_(3,3) + A_(1,3) sin(−θ_3) cos(θ_2 − π/2) / cos(−θ_3))\n"
        "      / (cos(−θ_3) + cos²(θ_2 − π/2) sin²(−θ_3) / cos(−θ_3)))",
        latex=r"\theta_1 = \pm\arccos \frac{A_{(3,3)} + \frac{A_{(1,3)} \sin(-\theta_3)"
        r" \cos(\theta_2 - \frac{\pi}{2})}{\cos(-\theta_3)}}{\cos(-\theta_3) + \frac{\cos^2(\theta_2 - \frac{\pi}{2})"
        r" \sin^2(-\theta_3)}{\cos(-\theta_3)}}",
        printed=forms.eq_3_3_0_6,
        check=_GENERIC[0],
        reference=DESCRIBED,
        domain="200 postures with |θ_3| ≠ π/2; holds there. The sign is left to step 7",
        unit="rad",
        conventions=_GENERIC[1],
    ),
    Claim(
        id="000:3.3.0.7",
        place="equation (3.3.0.7), if θ_3 = |π/2| and θ_2 ≠ 0",
        said="θ_1 of the left arm with the elbow turned by a quarter.",
        formula="θ_1 = ± arccos(A_(1,3) / (cos(θ_2 − π/2) sin(−θ_3)))",
        latex=r"\theta_1 = \pm\arccos \frac{A_{(1,3)}}{\cos(\theta_2 - \frac{\pi}{2}) \sin(-\theta_3)}",
        printed=forms.eq_3_3_0_7,
        check=_AT_QUARTER[0],
        reference=DESCRIBED,
        domain="200 postures with θ_3 = ±π/2 and θ_2 ≠ 0; holds there",
        unit="rad",
        conventions=_AT_QUARTER[1],
    ),
    Claim(
        id="000:3.3.0.8",
        place="equation (3.3.0.8), if θ_3 = |π/2| and θ_2 = 0",
        said="θ_1 of the left arm from the elbow's place.",
        formula="Â = A (T_4^End)⁻¹, θ_1 = ± arccos(Â_(1,4) / l_3)",
        latex=r"\hat A = A (T_4^{End})^{-1},\quad \theta_1 = \pm\arccos \frac{\hat A_{(1,4)}}{l_3}",
        printed=forms.eq_3_3_0_8,
        check=gives("left", 0, upper_arm_pitch, both=opposite, place=straight),
        reference=DESCRIBED,
        domain="200 postures with θ_3 = ±π/2 and θ_2 = 0; holds wherever θ_2 = 0",
        unit="rad",
    ),
    Claim(
        id="000:3.3-left-pipeline",
        place="(3.3.0.2) to (3.3.0.8) and steps 1 to 7",
        said="The equations as one procedure solve the left arm.",
        formula="θ_4, θ_2, θ_3, θ_1 in this order; candidates checked by (3.1.0.1)",
        printed=forms.left_pipeline,
        check=pipeline("left"),
        reference="forward kinematics of the described arm (Pinocchio), and of the robot's own arm",
        domain=f"{_LIMITS} as targets; θ_3 read as the table counts it. Corrected it solves the described arm, and"
        " comes as close to the robot's as that arm is like it; at θ_3 = ±π/2 rounding can lift the sine above 1",
        correction=Correction(
            forms.left_pipeline_corrected,
            "θ_4 by the squared distance from s = (0, l_1, l_2); the rest as printed",
            why="θ_4 is wrong, by its root and by s, and everything after it follows.",
        ),
    ),
)
