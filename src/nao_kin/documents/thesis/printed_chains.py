"""Bischoff 2016, section 3.1: Tables 3 and 4, their end transforms, (3.1.0.1) and (3.1.0.2), as printed."""

from __future__ import annotations

import math
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.dh.dh_row import DHRow, dh_matrix
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.thesis.coordinate_transforms import eq_2_2_1_3
from nao_kin.documents.thesis.denavit_hartenberg import eq_2_2_2_6
from nao_kin.documents.thesis.thesis_arms import arm_configurations, described_arm, nao, robot_arm, shoulder_to_forearm
from nao_kin.se3 import rotation_angle

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.thesis.thesis_arms import Side

    Rows = Sequence[tuple[float, float, float, float]]

__all__ = ["CLAIMS"]

_COUNT, _SEED = 200, 310
_AGAINST: Final = np.array([1.0, 1.0, -1.0, 1.0])
"""θ of the tables from the robot's joints: both tables count θ_3 against the robot's ElbowYaw."""


def table_3(theta: Sequence[float], upper_arm: float) -> Rows:
    """Table 3: a, α, d, θ of the left arm; lengths in the unit of `upper_arm`."""
    return (
        (0, -pi / 2, 0, theta[0]),
        (0, pi / 2, 0, theta[1] - pi / 2),
        (0, -pi / 2, upper_arm, -theta[2]),
        (0, pi / 2, 0, theta[3]),
    )


def table_4(theta: Sequence[float], upper_arm: float) -> Rows:
    """Table 4: the same of the right arm."""
    return (
        (0, -pi / 2, 0, theta[0]),
        (0, pi / 2, 0, theta[1] + pi / 2),
        (0, -pi / 2, -upper_arm, theta[2]),
        (0, pi / 2, 0, theta[3]),
    )


def t_basis(shoulder_y: float, elbow_y: float, shoulder_z: float) -> Floats:
    """T_Basis of the left arm."""
    d_y, d_z = shoulder_y + elbow_y, shoulder_z
    return np.array([[1, 0, 0, 0], [0, 1, 0, d_y], [0, 0, 1, d_z], [0, 0, 0, 1]])


def t_basis_corrected(shoulder_y: float, elbow_y: float, shoulder_z: float) -> Floats:
    """To the shoulder; ElbowOffsetY belongs to the elbow's row."""
    return t_basis(shoulder_y, 0.0 * elbow_y, shoulder_z)


def t_base_right(shoulder_y: float, elbow_y: float, shoulder_z: float) -> Floats:
    """T_Base of the right arm."""
    d_y, d_z = -shoulder_y - elbow_y, shoulder_z
    return np.array([[1, 0, 0, 0], [0, 1, 0, d_y], [0, 0, 1, d_z], [0, 0, 0, 1]])


def t_base_right_corrected(shoulder_y: float, elbow_y: float, shoulder_z: float) -> Floats:
    """To the shoulder; ElbowOffsetY belongs to the elbow's row."""
    return t_base_right(shoulder_y, 0.0 * elbow_y, shoulder_z)


def t_end(hand_x: float, _hand_z: float, lower_arm: float) -> Floats:
    """T_End, of both arms; HandOffsetZ does not occur in it."""
    d_x = hand_x + lower_arm
    return np.array([[1, 0, 0, d_x], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def t_end_corrected(hand_x: float, hand_z: float, lower_arm: float) -> Floats:
    """With the hand's offset below the forearm's axis."""
    return np.array([[1, 0, 0, hand_x + lower_arm], [0, 1, 0, 0], [0, 0, 1, -hand_z], [0, 0, 0, 1]])


def eq_3_1_0_1(T_basis: Floats, A: Sequence[Floats], T_end: Floats) -> Floats:
    """(3.1.0.1): the left arm, out of five factors A."""
    return T_basis @ A[0] @ A[1] @ A[2] @ A[3] @ A[4] @ _r_z(pi / 2) @ T_end


def eq_3_1_0_2(T_basis: Floats, A: Sequence[Floats], T_end: Floats) -> Floats:
    """(3.1.0.2): the right arm."""
    return T_basis @ A[0] @ A[1] @ A[2] @ A[3] @ A[4] @ _r_z(-pi / 2) @ T_end @ _r_z(-pi)


def eq_3_1_0_2_corrected(T_basis: Floats, A: Sequence[Floats], T_end: Floats) -> Floats:
    """Without the last turn."""
    return T_basis @ A[0] @ A[1] @ A[2] @ A[3] @ _r_z(-pi / 2) @ T_end


def _r_z(angle: float) -> Floats:
    R = np.eye(4)
    R[:3, :3] = eq_2_2_1_3(angle)
    return R


def _modified(a: float, alpha: float, d: float, t: float) -> Floats:
    return dh_matrix(DHRow(a, alpha, d, t), 0.0, "modified")


def _product(matrices: Sequence[Floats]) -> Floats:
    T = np.eye(4)
    for matrix in matrices:
        T = T @ matrix
    return T


def _departure(T: Floats, T_wanted: Floats) -> tuple[float, float]:
    """Distance of the origins [m] and angle between the axes [rad]."""
    turned = rotation_angle(np.asarray(T_wanted[:3, :3].T @ T[:3, :3]))
    return float(np.linalg.norm(T[:3, 3] - T_wanted[:3, 3])), turned


def _measured(departures: Sequence[tuple[float, float]], reach: float, found: str = "") -> Measured:
    """The larger of distance in units of the arm's reach and angle in radians."""
    far, turned = (max(d[k] for d in departures) for k in (0, 1))
    told = f"hand off by up to {1000.0 * far:.3g} mm, turned by up to {turned:.3g} rad"
    worst = max(far / reach, turned)
    return Measured(math.inf if math.isnan(worst) else worst, len(departures), found=found or told)


def _rows_check(side: Side, matrix: Callable[..., Floats], count: Floats) -> Check:
    """The four rows between the shoulder and the hand of the described arm."""

    def check(form: Form) -> Measured:
        arm, turn = described_arm(side), _r_z(pi / 2 if side == "left" else -pi / 2)
        hand = np.eye(4)
        hand[0, 3] = arm.l4
        departures = []
        for q in arm_configurations(side, _COUNT, _SEED):
            rows = form(count * q, arm.l3)
            T = _product([matrix(*row) for row in rows]) @ turn @ hand
            departures.append(_departure(T, shoulder_to_forearm(side, q) @ hand))
        return _measured(departures, arm.l3 + arm.l4)

    return check


def _lengths() -> dict[str, float]:
    """The lengths of section 3.1 out of the model [m]."""
    shoulder, elbow = (nao().model.jointPlacements[nao().model.getJointId(n)] for n in ("LShoulderPitch", "LElbowYaw"))
    arm, hand = described_arm("left"), nao().pose({}, "LArm", "torso").translation
    return {
        "shoulder_y": float(shoulder.translation[1]),
        "shoulder_z": float(shoulder.translation[2]),
        "elbow_y": float(elbow.translation[1]),
        "hand": arm.l4,
        "hand_z": float(shoulder.translation[2] - hand[2]),
    }


def _basis_check(side: Side, form: Form) -> Measured:
    is_ = _lengths()
    T = form(is_["shoulder_y"], is_["elbow_y"], is_["shoulder_z"])
    placement = nao().model.jointPlacements[nao().model.getJointId(f"{side[0].upper()}ShoulderPitch")]
    gaps = [
        float(np.linalg.norm(described_arm(side).elbow(q) - _robot_elbow(side, q)))
        for q in arm_configurations(side, _COUNT, _SEED)
    ]
    found = (
        f"Moving ElbowOffsetY to the shoulder puts the elbow up to {1000.0 * max(gaps):.1f} mm off, "
        f"{1000.0 * float(np.median(gaps)):.1f} mm in the median of {_COUNT} postures."
    )
    return Measured.worst([1000.0 * x for x in (T - placement.homogeneous).ravel()], found=found)


def _robot_elbow(side: Side, q: Floats) -> Floats:
    is_ = _lengths()
    T = robot_arm(side).pose(q)
    return np.array(T.act(np.array([-is_["hand"], 0.0, is_["hand_z"]])))


def _end_check(form: Form) -> Measured:
    is_ = _lengths()
    T_forearm_hand = robot_arm("left").pose(np.zeros(4)).homogeneous.copy()
    T_forearm_hand[:3, 3] -= nao().model.jointPlacements[nao().model.getJointId("LShoulderPitch")].translation
    T_forearm_hand[:3, 3] -= nao().model.jointPlacements[nao().model.getJointId("LElbowYaw")].translation
    hand_x = 0.6 * is_["hand"]  # any share: the two lengths enter by their sum
    return Measured.worst(1000.0 * (form(hand_x, is_["hand_z"], is_["hand"] - hand_x) - T_forearm_hand).ravel())


def _exact_parts(side: Side, q: Floats, factors: int) -> tuple[Floats, list[Floats], Floats]:
    """T_Basis, the joints' matrices and T_End that make the robot's arm: Tables 3 and 4 with ElbowOffsetY in row 3."""
    is_ = _lengths()
    theta, s = (_AGAINST * q).tolist(), 1.0 if side == "left" else -1.0
    rows = list(table_3(theta, 0.105) if side == "left" else table_4(theta, 0.105))
    rows[2] = (-is_["elbow_y"], rows[2][1], s * described_arm(side).l3, rows[2][3])
    A = [_modified(*row) for row in rows] + [np.eye(4)] * (factors - 4)
    basis = t_basis(s * is_["shoulder_y"], 0.0, is_["shoulder_z"])
    return basis, A, t_end_corrected(is_["hand"], is_["hand_z"], 0.0)


def _equation_check(side: Side, factors: int) -> Check:
    def check(form: Form) -> Measured:
        departures, as_printed = list[tuple[float, float]](), _as_printed(side, form)
        for q in arm_configurations(side, _COUNT, _SEED):
            try:
                T = form(*_exact_parts(side, q, factors))
            except IndexError:
                return Measured(math.inf, _COUNT, "A_4^5, for which the table has no row", as_printed)
            departures.append(_departure(T, robot_arm(side).pose(q).homogeneous))
        return _measured(departures, 0.22, as_printed)

    return check


def _as_printed(side: Side, form: Form) -> str:
    """What the whole arm of section 3.1 makes of the robot's joint angles, all of it as printed, four rows."""
    is_, lines = _lengths(), list[str]()
    table, basis = (table_3, t_basis) if side == "left" else (table_4, t_base_right)
    for name, matrix, count in (("standard", eq_2_2_2_6, 1.0), ("modified", _modified, _AGAINST)):
        departures = []
        for q in arm_configurations(side, _COUNT, _SEED):
            A = [*(matrix(*row) for row in table(count * q, 0.105)), np.eye(4)]
            T = form(basis(is_["shoulder_y"], is_["elbow_y"], is_["shoulder_z"]), A, t_end(0.05775, 0.01231, 0.05598))
            departures.append(_departure(T, robot_arm(side).pose(q).homogeneous))
        far, turned = (max(d[k] for d in departures) for k in (0, 1))
        lines.append(f"with the {name} matrix, hand off by up to {1000.0 * far:.1f} mm and {turned:.3f} rad")
    return "All of 3.1 as printed against the robot, 200 postures:\n" + ";\n".join(lines) + "."


_LIMITS = "200 postures inside the limits"
_BASIS_WHY = "ElbowOffsetY is behind the shoulder and turns with it: a = −ElbowOffsetY in the row of ElbowYaw."
_MODIFIED_READ = "the table is read in the modified (Craig) convention"
_COUNTED = f"{_MODIFIED_READ} and θ_3 counts against the robot's ElbowYaw"


def _table_claim(number: int, side: Side, table: Form, formula: str) -> Claim:
    return Claim(
        id=f"000:table-{number}",
        place=f"Table {number}, used with (2.2.2.6)",
        said=f"DH parameters of the {side} arm.",
        formula=formula,
        printed=table,
        check=_rows_check(side, eq_2_2_2_6, np.ones(4)),
        reference="the robot's model with ElbowOffsetY at the shoulder, as T_Basis has it (Pinocchio)",
        domain=f"{_LIMITS}; base and end exact",
        conventions={
            "θ_3 counts against the robot's ElbowYaw": _rows_check(side, eq_2_2_2_6, _AGAINST),
            _COUNTED: _rows_check(side, _modified, _AGAINST),
        },
    )


CLAIMS: Final = (
    _table_claim(
        3,
        "left",
        table_3,
        "ShoulderPitch: 0, −π/2, 0, θ_1          (a, α, d, θ)\nShoulderRoll:  0, π/2, 0, θ_2 − π/2\n"
        "ElbowYaw:      0, −π/2, UpperArmLength, −θ_3\nElbowRoll:     0, π/2, 0, θ_4",
    ),
    Claim(
        id="000:3.1-T_Basis",
        place="matrix before (3.1.0.1)",
        said="From the torso to the base of the left arm.",
        formula="T_Basis = translation (0, ShoulderOffsetY + ElbowOffsetY, ShoulderOffsetZ)",
        latex=r"T_{Basis}^0 = \begin{pmatrix}1&0&0&0\\0&1&0&d_y\\0&0&1&d_z\\0&0&0&1\end{pmatrix}",
        printed=t_basis,
        check=partial(_basis_check, "left"),
        reference="placement of LShoulderPitch in the V5 model",
        domain="the robot's lengths",
        unit="mm",
        correction=Correction(
            t_basis_corrected, "T_Basis = translation (0, ShoulderOffsetY, ShoulderOffsetZ)", why=_BASIS_WHY
        ),
    ),
    Claim(
        id="000:3.1-T_End",
        place="matrix before (3.1.0.1)",
        said="From the elbow's last frame to the hand.",
        formula="T_End = translation (HandOffsetX + LowerArmLength, 0, 0)",
        latex=r"T_{End} = \begin{pmatrix}1&0&0&d_x\\0&1&0&0\\0&0&1&0\\0&0&0&1\end{pmatrix}",
        printed=t_end,
        check=_end_check,
        reference="the effector LArm seen from LElbowRoll in the V5 model",
        domain="the robot's lengths",
        unit="mm",
        correction=Correction(
            t_end_corrected,
            "T_End = translation (HandOffsetX + LowerArmLength, 0, −HandOffsetZ)",
            why="Table 2 lists HandOffsetZ, but no matrix uses it.",
        ),
    ),
    Claim(
        id="000:3.1.0.1",
        place="equation (3.1.0.1)",
        said="The left arm from torso to hand.",
        formula="A = T_Basis A_0^1 A_1^2 A_2^3 A_3^4 A_4^5 R_z,π/2 T_End",
        latex=r"A = T_{Basis}^0 A_0^1 A_1^2 A_2^3 A_3^4 A_4^5 R_{z,\pi/2} T_{End}",
        printed=eq_3_1_0_1,
        check=_equation_check("left", 4),
        reference="forward kinematics of the V5 model, torso to LArm (Pinocchio)",
        domain=f"{_LIMITS}; T_Basis, the matrices of the joints and T_End exact",
        conventions={"A_4^5 is the unit matrix: the table has four rows": _equation_check("left", 5)},
    ),
    _table_claim(
        4,
        "right",
        table_4,
        "ShoulderPitch: 0, −π/2, 0, θ_1          (a, α, d, θ)\nShoulderRoll:  0, π/2, 0, θ_2 + π/2\n"
        "ElbowYaw:      0, −π/2, −UpperArmLength, θ_3\nElbowRoll:     0, π/2, 0, θ_4",
    ),
    Claim(
        id="000:3.1-T_Base",
        place="matrix before (3.1.0.2)",
        said="From the torso to the base of the right arm.",
        formula="T_Base = translation (0, −ShoulderOffsetY − ElbowOffsetY, ShoulderOffsetZ)",
        latex=r"T_{Base}^0 = \begin{pmatrix}1&0&0&0\\0&1&0&d_y\\0&0&1&d_z\\0&0&0&1\end{pmatrix}",
        printed=t_base_right,
        check=partial(_basis_check, "right"),
        reference="placement of RShoulderPitch in the V5 model",
        domain="the robot's lengths",
        unit="mm",
        correction=Correction(
            t_base_right_corrected, "T_Base = translation (0, −ShoulderOffsetY, ShoulderOffsetZ)", why=_BASIS_WHY
        ),
    ),
    Claim(
        id="000:3.1.0.2",
        place="equation (3.1.0.2)",
        said="The right arm from torso to hand.",
        formula="A = T_Basis A_0^1 A_1^2 A_2^3 A_3^4 A_4^5 R_z,−π/2 T_End R_z,−π",
        latex=r"A = T_{Basis}^0 A_0^1 A_1^2 A_2^3 A_3^4 A_4^5 R_{z,-\pi/2} T_{End} R_{z,-\pi}",
        printed=eq_3_1_0_2,
        check=_equation_check("right", 5),
        reference="forward kinematics of the V5 model, torso to RArm (Pinocchio)",
        domain=f"{_LIMITS}; T_Basis, the matrices of the joints and T_End exact, A_4^5 the unit matrix",
        correction=Correction(
            eq_3_1_0_2_corrected,
            "A = T_Basis A_0^1 A_1^2 A_2^3 A_3^4 R_z,−π/2 T_End",
            latex=r"A = T_{Basis}^0 A_0^1 A_1^2 A_2^3 A_3^4 R_{z,-\pi/2} T_{End}",
            why="R_z,−π turns the hand backwards: with Table 4 its axes come out as the robot's without it.",
        ),
    ),
)
