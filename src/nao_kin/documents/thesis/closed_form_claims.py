"""The claims of Bischoff 2016, section 3.3, about targets, the left arm and the right arm."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.documents.claim import Claim, Correction
from nao_kin.documents.thesis import closed_form as forms
from nao_kin.documents.thesis.closed_form import (
    either_way,
    gives,
    hand_turned_back,
    height_of_shoulder,
    pipeline,
    shoulder_vector,
    table_counts,
    target_pose,
)
from nao_kin.se3 import rotation_z, translation

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.thesis.closed_form import Call
    from nao_kin.documents.thesis.thesis_arms import DescribedArm, Side

__all__ = [
    "CLAIMS",
]

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


_LEFT: Final = (
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


_TURNED: Final = rotation_z(-math.pi).homogeneous


def _with_last_turn(form: Form, arm: DescribedArm, A: Floats, theta: Floats) -> tuple[float, float]:
    return shoulder_roll(form, arm, A @ _TURNED, theta)


_LARGE_RIGHT = counted("right", 2, elbow_yaw, where=large_yaw)
_GENERIC_RIGHT = counted("right", 0, shoulder_pitch, both=opposite, where=clear_of_quarter)
_AT_QUARTER_RIGHT = counted("right", 0, shoulder_pitch, both=opposite, where=rolled, place=at_quarter)


def l_2(shoulder_offset_z: float) -> float:
    """The symbol l_2."""
    return shoulder_offset_z


_RIGHT: Final = (
    Claim(
        id="000:3.3.0.9",
        place="equation (3.3.0.9)",
        said="A' is A without the last turn of (3.1.0.2).",
        formula="A' = A (R_z,−π)⁻¹",
        latex=r"A' = A (R_{z,-\pi})^{-1}",
        printed=forms.eq_3_3_0_9,
        check=hand_turned_back,
        reference="the described right arm with and without the turn (Pinocchio)",
        domain="200 postures inside the limits; holds for all",
    ),
    Claim(
        id="000:3.3.0.10",
        place="equation (3.3.0.10)",
        said="θ_4 of the right arm by the law of cosines.",
        formula="θ_4 = π − arccos((l_3² + l_4² − √((s_x − A'_(1,4))²\n"
        "      + (s_y − A'_(2,4))² + (s_z − A'_(3,4))²)) / (2 l_3 l_4))",
        latex=r"\theta_4 = \pi - \arccos \frac{l_3^2 + l_4^2 - \sqrt{(s_x - A'_{(1,4)})^2 +"
        r" (s_y - A'_{(2,4)})^2 + (s_z - A'_{(3,4)})^2}}{2 l_3 l_4}",
        printed=forms.eq_3_3_0_10,
        check=gives("right", 3, elbow_roll),
        reference=DESCRIBED,
        domain="200 postures inside the limits, lengths in mm, s the shoulder",
        unit="rad",
        correction=Correction(
            forms.eq_3_3_0_10_corrected,
            "θ_4 = π − arccos((l_3² + l_4² − |s − A'_(·,4)|²) / (2 l_3 l_4))",
            latex=r"\theta_4 = \pi - \arccos \frac{l_3^2 + l_4^2 - (s_x - A'_{(1,4)})^2 -"
            r" (s_y - A'_{(2,4)})^2 - (s_z - A'_{(3,4)})^2}{2 l_3 l_4}",
            why=SQUARED,
        ),
    ),
    Claim(
        id="000:3.3.0.11",
        place="equation (3.3.0.11)",
        said="θ_2 of the right arm, two solutions.",
        formula="θ_2 = ± arccos((−A'_(2,4) − l_1 − l_4 sin θ_4 A'_(2,2) / cos θ_4)\n"
        "      / (l_3 + l_4 cos θ_4 + l_4 sin² θ_4 / cos θ_4)) − π/2",
        latex=r"\theta_2 = \pm\arccos \frac{-A'_{(2,4)} - l_1 - \frac{l_4 \sin\theta_4 A'_{(2,2)}}{\cos\theta_4}}"
        r"{l_3 + l_4\cos\theta_4 + l_4\frac{\sin^2\theta_4}{\cos\theta_4}} - \frac{\pi}{2}",
        printed=forms.eq_3_3_0_11,
        check=gives("right", 1, shoulder_roll, both=mirrored),
        reference=DESCRIBED,
        domain="200 postures inside the limits; cos θ_4 ≠ 0. With A' as (3.3.0.9) has it, the last term above the"
        " line needs a plus: … + l_4 sin θ_4 A'_(2,2) / cos θ_4",
        unit="rad",
        conventions={
            "A stands in place of A': the formula belongs to the arm that ends with R_z,−π": gives(
                "right", 1, _with_last_turn, both=mirrored
            )
        },
        correction=Correction(
            forms.eq_3_3_0_11_corrected,
            "θ_2 = ± arccos((−A'_(2,4) − l_1 + l_4 sin θ_4 A'_(2,2) / cos θ_4)\n"
            "      / (l_3 + l_4 cos θ_4 + l_4 sin² θ_4 / cos θ_4)) − π/2",
            latex=r"\theta_2 = \pm\arccos \frac{-A'_{(2,4)} - l_1 + \frac{l_4 \sin\theta_4 A'_{(2,2)}}"
            r"{\cos\theta_4}}{l_3 + l_4\cos\theta_4 + l_4\frac{\sin^2\theta_4}{\cos\theta_4}} - \frac{\pi}{2}",
            why="A' has the axis y that A has turned over.",
        ),
    ),
    Claim(
        id="000:3.3.0.12",
        place="equation (3.3.0.12)",
        said="θ_3 of the right arm, first solution.",
        formula="θ_3 = −arcsin(A'_(2,3) / sin(θ_2 + π/2))",
        latex=r"\theta_3 = -\arcsin \frac{A'_{(2,3)}}{\sin(\theta_2 + \frac{\pi}{2})}",
        printed=forms.eq_3_3_0_12,
        check=gives("right", 2, elbow_yaw, where=small_yaw, counts=table_counts),
        reference=f"{DESCRIBED}, θ_3 as Table 4 and (3.3.0.13) to (3.3.0.15) count it",
        domain="200 postures with |θ_3| < π/2. It gives the robot's RElbowYaw, which counts the other way",
        unit="rad",
        correction=Correction(
            forms.eq_3_3_0_12_corrected,
            "θ_3 = arcsin(A'_(2,3) / sin(θ_2 + π/2))",
            latex=r"\theta_3 = \arcsin \frac{A'_{(2,3)}}{\sin(\theta_2 + \frac{\pi}{2})}",
            why="−arcsin x and π − arcsin x, (3.3.0.13), are not the two angles of one sine.",
        ),
    ),
    Claim(
        id="000:3.3.0.13",
        place="equation (3.3.0.13)",
        said="θ_3 of the right arm, second solution.",
        formula="θ_3 = π − arcsin(A'_(2,3) / sin(θ_2 + π/2))",
        latex=r"\theta_3 = \pi - \arcsin \frac{A'_{(2,3)}}{\sin(\theta_2 + \frac{\pi}{2})}",
        printed=forms.eq_3_3_0_13,
        check=_LARGE_RIGHT[0],
        reference=DESCRIBED,
        domain="200 postures with |θ_3| > π/2, to whole turns; holds there, for cos θ_2 ≠ 0",
        unit="rad",
        conventions=_LARGE_RIGHT[1],
    ),
    Claim(
        id="000:3.3.0.14",
        place="equation (3.3.0.14), if θ_3 ≠ |π/2|",
        said="θ_1 of the right arm, two solutions of which one is it.",
        formula="θ_1 = ± arccos((A'_(3,3) + A'_(1,3) sin θ_3 cos(θ_2 + π/2) / cos θ_3)\n"
        "      / (cos θ_3 + cos²(θ_2 + π/2) sin² θ_3 / cos θ_3))",
        latex=r"\theta_1 = \pm\arccos \frac{A'_{(3,3)} + \frac{A'_{(1,3)} \sin\theta_3"
        r" \cos(\theta_2 + \frac{\pi}{2})}{\cos\theta_3}}{\cos\theta_3 + \frac{\cos^2(\theta_2 + \frac{\pi}{2})"
        r" \sin^2\theta_3}{\cos\theta_3}}",
        printed=forms.eq_3_3_0_14,
        check=_GENERIC_RIGHT[0],
        reference=DESCRIBED,
        domain="200 postures with |θ_3| ≠ π/2; holds there. The sign is left to step 7",
        unit="rad",
        conventions=_GENERIC_RIGHT[1],
    ),
    Claim(
        id="000:3.3.0.15",
        place="equation (3.3.0.15), if θ_3 = |π/2| and θ_2 ≠ 0",
        said="θ_1 of the right arm with the elbow turned by a quarter.",
        formula="θ_1 = ± arccos(A'_(1,3) / (cos(θ_2 + π/2) sin θ_3))",
        latex=r"\theta_1 = \pm\arccos \frac{A'_{(1,3)}}{\cos(\theta_2 + \frac{\pi}{2}) \sin\theta_3}",
        printed=forms.eq_3_3_0_15,
        check=_AT_QUARTER_RIGHT[0],
        reference=DESCRIBED,
        domain="200 postures with θ_3 = ±π/2 and θ_2 ≠ 0; holds there",
        unit="rad",
        conventions=_AT_QUARTER_RIGHT[1],
    ),
    Claim(
        id="000:3.3.0.16",
        place="equation (3.3.0.16), if θ_3 = |π/2| and θ_2 = 0",
        said="θ_1 of the right arm from the elbow's place.",
        formula="Â = A' (T_4^End)⁻¹, θ_1 = ± arccos(Â_(1,4) / l_3)",
        latex=r"\hat A = A' (T_4^{End})^{-1},\quad \theta_1 = \pm\arccos \frac{\hat A_{(1,4)}}{l_3}",
        printed=forms.eq_3_3_0_16,
        check=gives("right", 0, upper_arm_pitch, place=straight, both=opposite),
        reference=DESCRIBED,
        domain="200 postures with θ_3 = ±π/2 and θ_2 = 0; holds wherever θ_2 = 0",
        unit="rad",
    ),
    Claim(
        id="000:3.3-right-pipeline",
        place="(3.3.0.9) to (3.3.0.16) and steps 1 to 7",
        said="The equations as one procedure solve the right arm.",
        formula="θ_4, θ_2, θ_3, θ_1 in this order; candidates checked by (3.1.0.2)",
        printed=forms.right_pipeline,
        check=pipeline("right"),
        reference="forward kinematics of the described arm (Pinocchio), and of the robot's own arm",
        domain="200 postures inside the limits as targets; A' and the table's θ_3. Corrected as on the left",
        correction=Correction(
            forms.right_pipeline_corrected,
            "(3.3.0.10) with the squared distance from s = (0, −l_1, l_2), "
            "(3.3.0.11) with + l_4 sin θ_4 A'_(2,2) / cos θ_4, (3.3.0.12) without minus",
            why="θ_4 is wrong by its root and by s, θ_2 belongs to A, and one θ_3 has the wrong sign.",
        ),
    ),
    Claim(
        id="000:3.3-l2",
        place="list of symbols after (3.3.0.8)",
        said="l_2 is ShoulderOffsetZ.",
        formula="l_2 = ShoulderOffsetZ",
        latex=r"l_2 = \mathrm{ShoulderOffsetZ}",
        printed=l_2,
        check=height_of_shoulder,
        reference="height of the shoulder in the V5 model, with Table 2's 100 mm",
        domain="the one length",
        unit="mm",
    ),
)

CLAIMS: Final = (*_LEFT, *_RIGHT)
