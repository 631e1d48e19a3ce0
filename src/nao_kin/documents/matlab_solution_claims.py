"""MATLAB example, steps 3 and 4: the equations of the head, their solutions, and the table of the verification run."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Final

from nao_kin.documents import matlab_solution_checks as checks
from nao_kin.documents import matlab_solutions as printed
from nao_kin.documents.claim import Claim, Correction

if TYPE_CHECKING:
    from nao_kin.documents.claim import Form, Measured

__all__ = ["CLAIMS"]

_CAMERA: Final = "the position of a camera on a yaw and a pitch joint, by Pinocchio's rotations"
_ANY: Final = "300 random cameras, necks and angles in ±π, 0.05 rad away from double solutions"
_BACK: Final = "θ_2 = π, where tan(θ_2/2) has no value: the branch that these rows are for"


def _rows_7_8(form: Form) -> Measured:
    check = checks.rows_meet(lambda c: (c.x, c.z, c.t2), lambda: checks.cases(xc=0.0))
    return check(lambda *lengths: form(*lengths)[1:3])


_EQUATIONS: Final = (
    Claim(
        id="004:eqns",
        place="step 3",
        said="Three equations that vanish where the head has the angles.",
        formula="eq1 = x_c cos θ_1 − CameraZ sin θ_2 − CameraX cos θ_2 + y_c sin θ_1\n"
        "eq2 = y_c cos θ_1 − x_c sin θ_1\n"
        "eq3 = z_c − NeckOffsetZ − CameraZ cos θ_2 + CameraX sin θ_2",
        latex=r"\begin{pmatrix} x_c \cos\theta_1 - CameraZ \sin\theta_2 - CameraX \cos\theta_2 + y_c \sin\theta_1 \\ "
        r"y_c \cos\theta_1 - x_c \sin\theta_1 \\ z_c - NeckOffsetZ - CameraZ \cos\theta_2 + CameraX \sin\theta_2 "
        r"\end{pmatrix}",
        printed=printed.eqns,
        check=checks.equations,
        reference=_CAMERA,
        domain=_ANY,
    ),
    Claim(
        id="004:3-free-coordinates",
        place="step 3, text",
        said="Of x_c, y_c and z_c two can be chosen; the third follows.",
        formula="2 of 3",
        printed=printed.free_coordinates,
        check=checks.rank,
        reference="the rank of the position's derivative by the two angles",
        domain=_ANY,
    ),
    Claim(
        id="004:theta_2_sol",
        place="step 3, theta_2_sol",
        said="The two pitches for a height z_c.",
        formula="θ_2 = −2 atan((CameraX ∓ √(CameraX² + CameraZ² − NeckOffsetZ²\n"
        "      + 2 NeckOffsetZ z_c − z_c²))/(CameraZ − NeckOffsetZ + z_c))",
        latex=r"\theta_2 = -2 \arctan \frac{CameraX \mp \sqrt{CameraX^2 + CameraZ^2 - NeckOffsetZ^2 + "
        r"2\,NeckOffsetZ\,z_c - z_c^2}}{CameraZ - NeckOffsetZ + z_c}",
        printed=printed.theta_2_sol,
        check=checks.theta_2,
        reference=_CAMERA,
        domain=_ANY + "; where CameraZ + z_c = NeckOffsetZ see 004:theta_2-lost",
        unit="rad",
    ),
    Claim(
        id="004:theta_2_conds",
        place="step 3, theta_2_conds",
        said="When the two rows of theta_2_sol are real numbers.",
        formula="CameraZ + z_c ≠ NeckOffsetZ  and  (NeckOffsetZ − z_c)² ≤ CameraX² + CameraZ²",
        latex=r"CameraZ + z_c \neq NeckOffsetZ \;\wedge\; (NeckOffsetZ - z_c)^2 \leq CameraX^2 + CameraZ^2",
        printed=printed.theta_2_conds,
        check=checks.conditions,
        reference="the roots of the quadratic equation of tan(θ_2/2)",
        domain="300 heights in and out of reach; exactly at its end, 1e-6 beyond it, at the excluded one",
    ),
    Claim(
        id="004:theta_2-lost",
        place="step 3, theta_2_sol with theta_2_conds",
        said="Under their condition the rows are all solutions of eq3, k being set to 0.",
        formula="θ_2 = theta_2_sol  if  theta_2_conds",
        printed=printed.theta_2_all,
        check=checks.every_theta_2,
        reference=_CAMERA,
        domain="300 cameras at the excluded height, CameraZ + z_c = NeckOffsetZ",
        unit="rad",
        correction=Correction(
            printed.theta_2_all_corrected,
            "θ_2 = ±arccos((z_c − NeckOffsetZ)/√(CameraX² + CameraZ²)) − atan2(CameraX, CameraZ)",
            r"\theta_2 = \pm\arccos \frac{z_c - NeckOffsetZ}{\sqrt{CameraX^2 + CameraZ^2}} - "
            r"\operatorname{atan2}(CameraX, CameraZ)",
            "The half angle has no tangent at θ_2 = π, and takes the other solution of that height with it.",
        ),
    ),
)

_ROWS: Final = (
    Claim(
        id="004:theta_1_sol",
        place="step 3, theta_1_sol, rows 2 and 3",
        said="The two yaws for x_c, once the pitch is known.",
        formula="θ_1 = ±2 atan(√(ρ − x_c) √(x_c + ρ)/(x_c + ρ)),\nρ = CameraX cos θ_2 + CameraZ sin θ_2",
        latex=r"\theta_1 = \pm 2 \arctan \frac{\sqrt{\rho - x_c} \sqrt{x_c + \rho}}{x_c + \rho},\quad "
        r"\rho = CameraX \cos\theta_2 + CameraZ \sin\theta_2",
        printed=printed.theta_1_sol,
        check=checks.theta_1,
        reference=_CAMERA,
        domain=_ANY + ", complex roots",
        unit="rad",
    ),
    Claim(
        id="004:theta_1-unsimplified",
        place="step 3, theta_1_sol before the substitution, rows 2 and 3",
        said="The same before it is simplified; its roots and fraction bars are not legible and read as they must be.",
        formula="θ_1 = ±2 atan((σ_3/(σ_5 + 1) + σ_5 σ_3/(σ_5 + 1))/σ_4),\n"
        "σ_3 = √(−x_c + CameraX − CameraX σ_5 − x_c σ_5 + 2 CameraZ tan(θ_2/2)) √σ_4,\n"
        "σ_4 = CameraX + x_c − CameraX σ_5 + x_c σ_5 + 2 CameraZ tan(θ_2/2),\nσ_5 = tan²(θ_2/2)",
        printed=printed.theta_1_unsimplified,
        check=checks.theta_1,
        reference=_CAMERA,
        domain=_ANY + ", complex roots",
        unit="rad",
    ),
    Claim(
        id="004:yc_sol",
        place="step 3, yc_sol, rows 2, 3, 7 and 8",
        said="The y_c that goes with each yaw.",
        formula="y_c = ±√(−(x_c − CameraX + CameraX T² + x_c T² − 2 CameraZ T))\n"
        "      √(CameraX + x_c − CameraX T² + x_c T² + 2 CameraZ T)/(T² + 1)\n"
        "y_c = ±(−CameraX T² + 2 CameraZ T + CameraX)/(T² + 1),  T = tan(θ_2/2)",
        latex=r"y_c = \pm\frac{\sqrt{-(x_c - CameraX + CameraX T^2 + x_c T^2 - 2 CameraZ T)} \sqrt{CameraX + x_c - "
        r"CameraX T^2 + x_c T^2 + 2 CameraZ T}}{T^2 + 1},\quad y_c = \pm\frac{-CameraX T^2 + 2 CameraZ T + CameraX}"
        r"{T^2 + 1}",
        printed=printed.yc_sol,
        check=checks.yc,
        reference=_CAMERA,
        domain=_ANY + ", rows 2 and 3 at the yaws of 004:theta_1_sol, rows 7 and 8 at ±π/2; complex roots",
    ),
    Claim(
        id="004:theta_1-rows-1-5",
        place="step 3, theta_1_sol and yc_sol, rows 1 and 5",
        said="Two more yaws, without the pitch.",
        formula="θ_1 = ∓2 atan(w),  y_c = ±√(CameraX + x_c) √(CameraX − x_c),\n"
        "w = √(CameraX + x_c) √(CameraX − x_c)/(CameraX − x_c)",
        latex=r"\theta_1 = \mp 2 \arctan \frac{\sqrt{CameraX + x_c} \sqrt{CameraX - x_c}}{CameraX - x_c},\quad "
        r"y_c = \pm\sqrt{CameraX + x_c} \sqrt{CameraX - x_c}",
        printed=printed.rows_1_5,
        check=checks.rows_meet(lambda c: (c.x, c.at[0]), checks.cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={_BACK: checks.rows_meet(lambda c: (c.x, c.at[0]), lambda: checks.cases(t2=pi))},
    ),
    Claim(
        id="004:theta_1-rows-4-7-8-9",
        place="step 3, theta_1_sol and yc_sol, rows 4, 7, 8 and 9",
        said="The yaws ±π/2.",
        formula="(θ_1, y_c) = (−π/2, CameraX), (π/2, y_2), (−π/2, −y_2), (π/2, −CameraX)",
        latex=r"(\theta_1, y_c) = (-\tfrac{\pi}{2}, CameraX),\; (\tfrac{\pi}{2}, y_2),\; (-\tfrac{\pi}{2}, -y_2),\; "
        r"(\tfrac{\pi}{2}, -CameraX)",
        printed=printed.rows_4_7_8_9,
        check=checks.rows_meet(lambda c: (c.x, c.z, c.t2), checks.cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={
            "x_c = 0, and for rows 4 and 9 also θ_2 = π": checks.both(
                checks.rows_meet(lambda c: (c.x, c.z, c.t2), lambda: checks.cases(t2=pi, xc=0.0)),
                _rows_7_8,
            )
        },
    ),
    Claim(
        id="004:theta_1-row-6",
        place="step 3, theta_1_sol and yc_sol, row 6",
        said="A yaw of 0; before the parameter x was set to 0, any yaw.",
        formula="(θ_1, y_c) = (0, 0)",
        latex=r"(\theta_1, y_c) = (0, 0)",
        printed=printed.row_6,
        check=checks.rows_meet(lambda _: (), checks.cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={
            "the camera is on the yaw axis, where every yaw is a solution": checks.rows_meet(
                lambda _: (), checks.on_the_axis
            )
        },
    ),
)

_RUN: Final = (
    Claim(
        id="004:result-table",
        place="step 4, table T",
        said="Eight rows: four pairs of angles, and the two pairs that the inverse finds for each.",
        formula="θ_1 known  θ_2 known  θ_1 derived  θ_2 derived  (8 rows)",
        printed=printed.result_table,
        check=checks.table,
        reference="the true pairs that bring the camera to the same position",
        domain="the four pairs of the run, CameraX = 53.9, CameraZ = 67.9, NeckOffsetZ = −5",
        unit="rad",
        tolerance=5e-5,
    ),
    Claim(
        id="004:4-two-solutions",
        place="step 4, text and listing",
        said="For every pair of angles the run finds two pairs, one of them the one that it began with.",
        formula="|y_known − y_derived| < max(100 eps, 1e-6 |y_known|)",
        latex=r"|y_{known} - y_{derived}| < \max(100\,\mathrm{eps},\; 10^{-6} |y_{known}|)",
        printed=printed.verification,
        check=checks.two_solutions,
        reference="the true pairs that bring the camera to the same position",
        domain="300 poses inside the head's limits, lengths of the run; the share of poses for which it does not",
    ),
)

CLAIMS: Final = (*_EQUATIONS, *_ROWS, *_RUN)
