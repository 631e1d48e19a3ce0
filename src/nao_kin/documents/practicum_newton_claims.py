"""Practicum, sections 1.2 and 1.3: Newton's method and the errors it is run on, (1) to (12)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from nao_kin.documents import practicum_newton as printed
from nao_kin.documents import practicum_newton_checks as checks
from nao_kin.documents.claim import Claim, Correction
from nao_kin.documents.practicum_cases import arm, euler_jacobian

if TYPE_CHECKING:
    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS"]

_PINOCCHIO: Final = "Pinocchio on the JACO2's model"
_NEAR: Final = "100 regular configurations of the JACO2, poses 0.05 rad away"
_ROTATIONS: Final = "100 pairs of random orientations"
_FUNCTIONS: Final = "100 functions with known zeros and minima, started 0.05 to 0.3 beside them, ten iterations"
_EULER: Final = "100 pairs of orientations 0.3 rad apart in each angle, pitch away from ±π/2; roll, pitch, yaw"


def _claim(number: str, said: str, formula: str, latex: str, form: Form, check: Check, **more: Any) -> Claim:
    return Claim(
        id=f"001:eq-{number}",
        place=f"equation ({number})",
        said=said,
        formula=formula,
        latex=latex,
        printed=form,
        check=check,
        **more,
    )


CLAIMS: Final = (
    _claim(
        "1",
        "The best arguments are those at which f takes its least value.",
        "f(x_Opt) = f_min",
        r"f(x_{\mathrm{Opt}}) = f_{\min}",
        printed.eq_1,
        checks.minimum,
        reference="convex functions with a known minimum",
        domain="100 quadratic bowls in three variables",
    ),
    _claim(
        "2",
        "Newton's iteration; the text and figure 2 let it search for the least f.",
        "x_{n+1} = x_n − f(x_n)/f′(x_n)",
        r"x_{n+1} = x_n - \frac{f(x_n)}{f'(x_n)}",
        printed.eq_2,
        checks.newton_on(valley=True, derivatives=slice(0, 2)),
        reference="functions with a known zero and a known minimum",
        domain=_FUNCTIONS,
        conventions={
            "f is the error whose zero is sought, as from (9) on": checks.newton_on(
                valley=False, derivatives=slice(0, 2)
            )
        },
    ),
    Claim(
        id="001:1.2-minimum",
        place="section 1.2, text and figure 2",
        said="The iteration (2) finds the minimum of f, by its derivative.",
        formula="x_{n+1} = x_n − f(x_n)/f′(x_n)  →  x_Opt",
        latex=r"x_{n+1} = x_n - \frac{f(x_n)}{f'(x_n)} \;\to\; x_{\mathrm{Opt}}",
        printed=printed.eq_2,
        check=checks.newton_on(valley=True, derivatives=slice(0, 2)),
        reference="functions with a known minimum above zero",
        domain=_FUNCTIONS,
        correction=Correction(
            printed.eq_2_for_minima,
            "x_{n+1} = x_n − f′(x_n)/f″(x_n)",
            r"x_{n+1} = x_n - \frac{f'(x_n)}{f''(x_n)}",
            "(2) is a search for a zero of f; a minimum is a zero of f′.",
            checks.newton_on(valley=True, derivatives=slice(1, 3)),
        ),
    ),
    _claim(
        "3",
        "The error has the position above and the orientation below.",
        "e = (e_P; e_O)",
        r"e = \begin{pmatrix} e_P \\ e_O \end{pmatrix}",
        printed.eq_3,
        checks.stacking,
        reference="the rows of Pinocchio's frame Jacobian, by five-point differences",
        domain=_NEAR,
    ),
    _claim(
        "4",
        "The position error is what is wanted minus what is there.",
        "e_P = p_d − p_a",
        r"e_P = p_d - p_a",
        printed.eq_4,
        checks.position_error,
        reference="moving by the error leads to the wanted position",
        domain="100 pairs of points",
    ),
    _claim(
        "5",
        "The orientation error as a difference of Euler angles, good for small steps.",
        "e_O = (φ_d, θ_d, ψ_d)ᵀ − (φ_a, θ_a, ψ_a)ᵀ",
        r"e_O = (\phi_d, \theta_d, \psi_d)^T - (\phi_a, \theta_a, \psi_a)^T",
        printed.eq_5,
        checks.as_rotation_vector,
        reference="rotation matrices; as it stands e_O is a rotation vector, as for the geometric Jacobian",
        domain=_EULER,
        conventions={"e_O is added to the Euler angles, so that J holds their derivatives": checks.added_to_angles},
    ),
    _claim(
        "6",
        "The difference of two orientations as a quaternion.",
        "ΔQ = Q_d * Q_a⁻¹",
        r"\Delta Q = Q_d * Q_a^{-1}",
        printed.eq_6,
        checks.difference,
        reference="rotation matrices: R(ΔQ) R(Q_a) = R(Q_d)",
        domain=_ROTATIONS,
    ),
    _claim(
        "7",
        "For equal quaternions the difference is one.",
        "ΔQ = (1, 0, 0, 0)ᵀ",
        r"\Delta Q_d = (1, 0, 0, 0)^T",
        printed.eq_7,
        checks.no_difference,
        reference="the product of a quaternion with its inverse",
        domain="100 random orientations with Q_d = Q_a; equal orientations may also have Q_d = −Q_a",
    ),
    _claim(
        "8",
        "The vector part of the difference, as the error of the orientation.",
        "e_O = Δε = η_a ε_d − η_d ε_a − ε_d × ε_a",
        r"e_O = \Delta\epsilon = \eta_a(q)\,\epsilon_d - \eta_d\,\epsilon_a(q) - \epsilon_d \times \epsilon_a(q)",
        printed.eq_8,
        checks.vector_part,
        reference="the vector part of Q_d * Q_a⁻¹ by Pinocchio",
        domain=_ROTATIONS,
    ),
    Claim(
        id="001:1.3-quaternion-step",
        place="section 1.3, (8) put into (9) to (12)",
        said="With the quaternion error, de/dq is minus the Jacobian as well.",
        formula="d Δε/dq = −J",
        latex=r"\frac{d\,\Delta\epsilon}{dq} = -J",
        printed=printed.eq_8,
        check=checks.quaternion_derivative,
        reference="five-point differences of (8) at the solution, and the angular rows of Pinocchio's frame Jacobian",
        domain="100 configurations at the solution; away from it the derivative changes with the error",
        correction=Correction(
            printed.eq_8_for_newton,
            "e_O = 2 sgn(Δη) Δε",
            r"e_O = 2 \operatorname{sgn}(\Delta\eta) \, \Delta\epsilon",
            "Δε is the sine of half the angle: with it alone every step goes half the way. The sign makes it the short "
            "way round.",
        ),
    ),
    _claim(
        "9",
        "Newton's iteration for the joints; e has six rows and de/dq is a matrix.",
        "q_{n+1} = q_n − e(q)/(de(q)/dq)",
        r"q_{n+1} = q_n - \frac{e(q)}{\frac{de(q)}{dq}}",
        printed.eq_9,
        checks.divided(lambda e: e),
        reference="the linear system (de/dq) Δq = −e by Pinocchio's Jacobian",
        domain=_NEAR,
        conventions={"dividing by a matrix means its inverse from the left": checks.divided(checks.Column)},
    ),
    _claim(
        "10",
        "The wanted pose is constant, so only the actual one has a derivative.",
        "de/dq = d(ρ_d − ρ_a(q))/dq = −dρ_a/dq",
        r"\frac{de(q)}{dq} = \frac{d(\rho_d - \rho_a(q))}{dq} = -\frac{d\rho_a(q)}{dq}",
        printed.eq_10,
        checks.error_derivative,
        reference="five-point differences of the error of (4) and (5)",
        domain=_NEAR + "; not for the error of (8), see 001:1.3-quaternion-step",
    ),
    _claim(
        "11",
        "The Jacobian of the arm is the derivative of its pose.",
        "J(q) = dρ_a(q)/dq",
        r"J(q) = \frac{d\rho_a(q)}{dq}",
        printed.eq_11,
        checks.derivative_of_pose(lambda q: arm().jacobian(q)),
        reference=_PINOCCHIO + "; as it stands its geometric frame Jacobian, whose lower rows are angular velocities",
        domain=_NEAR,
        conventions={
            "the orientation is three Euler angles, so that J is the analytic Jacobian": checks.derivative_of_pose(
                euler_jacobian
            )
        },
    ),
    _claim(
        "12",
        "Newton's iteration with (10) and (11) put in.",
        "q_{n+1} = q_n + J⁻¹ e(q)",
        r"q_{n+1} = q_n + J^{-1} e(q)",
        printed.eq_12,
        checks.newton_step,
        reference=_PINOCCHIO + ": J Δq = e",
        domain=_NEAR,
    ),
)
