"""Bischoff 2016, section 3.2: Jacobian, transpose and pseudo-inverse, (3.2.0.1) to (3.2.2.3), as printed."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy import dot
from numpy.linalg import inv

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.samples import derivative, deviation, regular_configurations, relative
from nao_kin.documents.thesis.thesis_arms import nao, robot_arm

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["CLAIMS"]


def eq_3_2_0_1(f: Callable[[Floats], Floats], theta: Floats) -> Floats:
    """(3.2.0.1): J = ∂f/∂θ, by five-point differences."""
    return derivative(f, theta)


def eq_3_2_0_2(J: Floats, delta_theta: Floats) -> Floats:
    """(3.2.0.2): Δr."""
    return J @ delta_theta


def eq_3_2_0_3(J: Floats, e: Floats) -> Floats:
    """(3.2.0.3): Δθ."""
    return inv(J) @ e


def eq_3_2_0_4(a: Floats, q: Floats) -> Floats:
    """(3.2.0.4): ∂f/∂θ_i of a unit vector a_i along the joint's axis and q_i from the joint to the end effector."""
    return np.cross(a, q)


def eq_3_2_1_1(J: Floats, e: Floats, alpha: float) -> Floats:
    """(3.2.1.1): Δθ."""
    return alpha * J.T @ e


def satz_1(J: Floats, e: Floats) -> tuple[float, float, float]:
    """Satz 1 and its proof: three expressions that are equal and not negative."""
    return float(dot(J @ (J.T @ e), e)), float(dot(J.T @ e, J.T @ e)), float(np.linalg.norm(J.T @ e) ** 2)


def eq_3_2_1_2(J: Floats, e: Floats) -> float:
    """(3.2.1.2): α."""
    return float(dot(e, J @ (J.T @ e)) / dot(J @ (J.T @ e), J @ (J.T @ e)))


def eq_3_2_2_1(J: Floats, e: Floats) -> Floats:
    """(3.2.2.1): Δθ by the Moore-Penrose inverse."""
    return np.linalg.pinv(J) @ e


def eq_3_2_2_2(J: Floats, e: Floats, delta_theta: Floats) -> tuple[Floats, Floats]:
    """(3.2.2.2): both sides of the normal equations."""
    return J.T @ (J @ delta_theta), J.T @ e


def eq_3_2_2_3(J: Floats, e: Floats) -> Floats:
    """(3.2.2.3): Δθ."""
    return inv(J.T @ J) @ J.T @ e


def eq_3_2_2_3_corrected(J: Floats, e: Floats) -> Floats:
    """For a J with more columns than rows: the right inverse."""
    return J.T @ inv(J @ J.T) @ e


def size_of_jtj() -> tuple[int, int]:
    """The text below (3.2.2.3): size of JᵀJ, and its rank if it has an inverse."""
    return 5, 5


def size_of_jtj_corrected() -> tuple[int, int]:
    """JᵀJ of a 3 × 4 Jacobian: singular."""
    return 4, 3


_COUNT, _SEED = 100, 320
_DIFFERENCES: Final = 1e-9
_FINITE: Final = 0.1  # [rad] a step of the methods, in one joint


def _arms() -> Iterator[tuple[Floats, Floats, Callable[[Floats], Floats]]]:
    """Configurations of both arms away from singularities, their position Jacobians and forward kinematics."""
    for k, chain in enumerate((robot_arm("left"), robot_arm("right"))):
        for q in regular_configurations(chain, _COUNT // 2, _SEED + k, rows=3):
            yield q, chain.jacobian(q)[:3], partial(_position, chain)


def _position(chain: UrdfChain, q: Floats) -> Floats:
    return np.array(chain.pose(q).translation)


def _cases() -> Iterator[tuple[Floats, Floats]]:
    """Position Jacobians of both arms [m/rad] and random errors [m]."""
    rng = np.random.default_rng(_SEED)
    for _, J, _ in _arms():
        yield J, rng.uniform(-0.1, 0.1, 3)


def _jacobian(form: Form) -> Measured:
    return Measured.worst(relative(form(f, q), J) for q, J, f in _arms())


def _finite_step(form: Form) -> Measured:
    rng, shares, errors = np.random.default_rng(_SEED), list[float](), list[float]()
    for q, J, f in _arms():
        step = rng.uniform(-_FINITE, _FINITE, 4)
        moved = f(q + step) - f(q)
        errors.append(deviation(form(J, step), moved))
        shares.append(errors[-1] / float(np.linalg.norm(moved)))
    found = (
        f"Steps of up to {_FINITE} rad a joint: off by up to {1000.0 * max(errors):.2f} mm, "
        f"{100.0 * float(np.median(shares)):.1f} % of the way in the median."
    )
    return Measured.worst(shares, found=found)


def _differential(form: Form) -> Measured:
    """Δr / h for h → 0, by five-point differences along the step."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for q, J, f in _arms():
        step = rng.uniform(-1.0, 1.0, 4)
        slope = derivative(_along(f, q, step), np.zeros(1))[:, 0]
        errors.append(relative(form(J, step), slope))
    return Measured.worst(errors)


def _along(f: Callable[[Floats], Floats], q: Floats, step: Floats) -> Callable[[Floats], Floats]:
    return lambda h: f(q + h[0] * step)


def _inverse(columns: int) -> Check:
    """Whether J Δθ = e, with so many of the four joints, the others held."""

    def check(form: Form) -> Measured:
        errors = []
        for J, e in _cases():
            if columns == 3 and abs(np.linalg.det(J[:, 1:])) < 1e-6:
                continue
            part = J[:, 4 - columns :]
            try:
                errors.append(relative(part @ form(part, e), e))
            except np.linalg.LinAlgError as error:
                return Measured(math.inf, _COUNT, f"numpy: {error}", f"J is {part.shape[0]} × {part.shape[1]}.")
        return Measured.worst(errors)

    return check


def _columns(form: Form) -> Measured:
    """Axes and places of the joints out of Pinocchio's frames, against differences of the position."""
    errors, robot = list[float](), nao()
    for chain in (robot_arm("left"), robot_arm("right")):
        for q in regular_configurations(chain, _COUNT // 10, _SEED, rows=3):
            J = derivative(partial(_position, chain), q)
            T_torso_links = robot.link_poses(dict(zip(chain.joint_names, q, strict=True)))
            for k, name in enumerate(chain.joint_names):
                joint = next(j for j in robot.document.joints if j.name == name)
                T = T_torso_links[joint.child]
                axis = T.rotation @ np.asarray(joint.axis)
                errors.append(relative(form(axis, T_torso_links[chain.tip_name].translation - T.translation), J[:, k]))
    return Measured.worst(errors)


def _descent(form: Form) -> Measured:
    """α times the direction of steepest descent of |t − f(θ)|²/2, by differences."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for q, J, f in _arms():
        t = f(q) + rng.uniform(-0.1, 0.1, 3)
        slope = derivative(_half_square(f, t), q)
        alpha = float(rng.uniform(1.0, 20.0))
        errors.append(relative(form(J, t - f(q), alpha), -alpha * slope))
    return Measured.worst(errors, found="It turns towards the target; the length of the step is up to α.")


def _half_square(f: Callable[[Floats], Floats], t: Floats) -> Callable[[Floats], float]:
    return lambda q: 0.5 * float((t - f(q)) @ (t - f(q)))


def _never_negative(form: Form) -> Measured:
    """Against a sum of squares, which is not negative."""
    errors = []
    for J, e in _cases():
        squares = sum(float(column @ e) ** 2 for column in J.T)
        errors += [(value - squares) / squares for value in form(J, e)]
    return Measured.worst(errors)


def _best_length(form: Form) -> Measured:
    """The α with the least |e − α J Jᵀ e|, by least squares (LAPACK)."""
    errors, left = list[float](), list[float]()
    for J, e in _cases():
        direction = J @ (J.T @ e)
        best = float(np.linalg.lstsq(direction[:, None], e, rcond=None)[0][0])
        alpha = form(J, e)
        errors.append((alpha - best) / best)
        left.append(float(np.linalg.norm(e - alpha * direction) / np.linalg.norm(e)))
    return Measured.worst(errors, found=f"One step leaves {100.0 * float(np.median(left)):.0f} % of e in the median.")


def _least_squares(form: Form) -> Measured:
    """The shortest of all Δθ with the least |J Δθ − e| (LAPACK); also for J of less than full rank."""
    errors = []
    for k, (J, e) in enumerate(_cases()):
        if k % 4 == 0:
            J = J[[0, 1, 0]]  # a row twice: rank 2
        errors.append(relative(form(J, e), np.linalg.lstsq(J, e, rcond=1e-12)[0]))
    return Measured.worst(errors)


def _normal_equations(form: Form) -> Measured:
    """For every Δθ with the least |J Δθ − e|: any part of the null space may be added."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for J, e in _cases():
        null = np.linalg.svd(J)[2][3]
        delta = np.linalg.lstsq(J, e, rcond=None)[0] + rng.normal() * null
        errors.append(relative(*form(J, e, delta)))
    return Measured.worst(errors)


def _solves(form: Form) -> Measured:
    """Whether J Δθ = e with the NAO's 3 × 4 Jacobian."""
    conditions, errors = list[float](), list[float]()
    for J, e in _cases():
        conditions.append(float(np.linalg.cond(J.T @ J)))
        try:
            errors.append(relative(J @ form(J, e), e))
        except np.linalg.LinAlgError:
            errors.append(math.inf)
    bad = sum(error > _DIFFERENCES for error in errors)
    found = (
        f"JᵀJ has rank 3 of 4, condition {min(conditions):.1g} or worse; J Δθ misses e in {bad} of {len(errors)} cases."
    )
    finite = [error if math.isfinite(error) else 1.0 for error in errors]  # no step leaves all of e
    return Measured.worst(finite, found=found)


def _sizes(form: Form) -> Measured:
    J = next(iter(_cases()))[0]
    wanted = (len(J.T), max(int(np.linalg.matrix_rank(J.T @ J)) for J, _ in _cases()))
    found = f"J is {J.shape[0]} × {J.shape[1]}, as section 3.2 says itself; JᵀJ is {wanted[0]} × {wanted[0]} of rank 3."
    return Measured.worst([a - b for a, b in zip(form(), wanted, strict=True)], found=found)


_POSTURES = f"{_COUNT} postures of both arms away from singularities"
_ERRORS = f"{_POSTURES}, random e within ±0.1 m"

CLAIMS: Final = (
    Claim(
        id="000:3.2.0.1",
        place="equation (3.2.0.1)",
        said="The Jacobian is the derivative of the forward kinematics.",
        formula="J(θ) = ∂f/∂θ",
        latex=r"J(\theta) = \frac{\partial f}{\partial \theta}",
        printed=eq_3_2_0_1,
        check=_jacobian,
        reference="Pinocchio's frame Jacobian, position rows",
        domain=_POSTURES,
        tolerance=_DIFFERENCES,
    ),
    Claim(
        id="000:3.2.0.2",
        place="equation (3.2.0.2)",
        said="The Jacobian takes changes of the joints to changes of the position.",
        formula="Δr = J(θ) Δθ",
        latex=r"\Delta \vec r = J(\theta)\, \Delta\theta",
        printed=eq_3_2_0_2,
        check=_finite_step,
        reference="differences of the forward kinematics (Pinocchio)",
        domain=f"{_POSTURES}; relative to the way",
        tolerance=_DIFFERENCES,
        conventions={"Δ stands for a differential, as the text's “approximation” does": _differential},
    ),
    Claim(
        id="000:3.2.0.3",
        place="equation (3.2.0.3)",
        said="The inverse Jacobian takes the error to the change of the joints.",
        formula="J(θ)⁻¹ e = Δθ",
        latex=r"J(\theta)^{-1}\, \vec e = \Delta\theta",
        printed=eq_3_2_0_3,
        check=_inverse(4),
        reference="J Δθ = e, J by Pinocchio",
        domain=_ERRORS,
        conventions={
            "J is square and regular: three joints, one held. The arm's own 3 × 4 J has no inverse, which the text says"
            " itself": _inverse(3)
        },
    ),
    Claim(
        id="000:3.2.0.4",
        place="equation (3.2.0.4)",
        said="A column of the Jacobian is the axis crossed with the way from the joint to the end effector.",
        formula="∂f/∂θ_i = a_i × q_i",
        latex=r"\frac{\partial f}{\partial \theta_i} = \vec a_i \times \vec q_i",
        printed=eq_3_2_0_4,
        check=_columns,
        reference="five-point differences of the forward kinematics",
        domain="20 postures of both arms, four joints each; holds for hinges",
        tolerance=_DIFFERENCES,
    ),
    Claim(
        id="000:3.2.1.1",
        place="equation (3.2.1.1)",
        said="The transpose in place of the inverse, scaled by α.",
        formula="Δθ = α Jᵀ e",
        latex=r"\Delta\theta = \alpha J^T \vec e",
        printed=eq_3_2_1_1,
        check=_descent,
        reference="α times the steepest descent of |e|²/2, by five-point differences",
        domain=_ERRORS,
        tolerance=_DIFFERENCES,
    ),
    Claim(
        id="000:satz-1",
        place="Satz 1 and its proof",
        said="The transpose never leads away from the target.",
        formula="⟨J Jᵀ e, e⟩ = ⟨Jᵀ e, Jᵀ e⟩ = ‖Jᵀ e‖² ≥ 0",
        latex=r"\langle J J^T \vec e, \vec e \rangle = \langle J^T \vec e, J^T \vec e \rangle ="
        r" \lVert J^T \vec e \rVert^2 \ge 0",
        printed=satz_1,
        check=_never_negative,
        reference="sum of the squares of the columns' products with e",
        domain=_ERRORS + "; it is 0 where e is square to all columns, and the method stands still",
    ),
    Claim(
        id="000:3.2.1.2",
        place="equation (3.2.1.2)",
        said="The α that brings α J Jᵀ e closest to e.",
        formula="α = ⟨e, J Jᵀ e⟩ / ⟨J Jᵀ e, J Jᵀ e⟩",
        latex=r"\alpha = \frac{\langle \vec e, J J^T \vec e \rangle}{\langle J J^T \vec e, J J^T \vec e \rangle}",
        printed=eq_3_2_1_2,
        check=_best_length,
        reference="least squares (LAPACK)",
        domain=_ERRORS,
    ),
    Claim(
        id="000:3.2.2.1",
        place="equation (3.2.2.1)",
        said="The pseudo-inverse brings J Δθ closest to e.",
        formula="Δθ = J⁺ e",
        latex=r"\Delta\theta = J^\dagger \vec e",
        printed=eq_3_2_2_1,
        check=_least_squares,
        reference="shortest least-squares solution (LAPACK gelsd)",
        domain=f"{_ERRORS}, one in four with J of rank 2",
    ),
    Claim(
        id="000:3.2.2.2",
        place="equation (3.2.2.2)",
        said="The normal equations.",
        formula="Jᵀ J Δθ = Jᵀ e",
        latex=r"J^T J\, \Delta\theta = J^T \vec e",
        printed=eq_3_2_2_2,
        check=_normal_equations,
        reference="least-squares solutions (LAPACK) with any part of the null space",
        domain=_ERRORS,
    ),
    Claim(
        id="000:3.2.2.3",
        place="equation (3.2.2.3)",
        said="The normal equations solved for Δθ.",
        formula="Δθ = (Jᵀ J)⁻¹ Jᵀ e",
        latex=r"\Delta\theta = (J^T J)^{-1} J^T \vec e",
        printed=eq_3_2_2_3,
        check=_solves,
        reference="J Δθ = e, J by Pinocchio",
        domain=f"{_ERRORS}. The printed form needs independent columns, so at most three joints",
        correction=Correction(
            eq_3_2_2_3_corrected,
            "Δθ = Jᵀ (J Jᵀ)⁻¹ e",
            latex=r"\Delta\theta = J^T (J J^T)^{-1} \vec e",
            why="With four joints for three coordinates JᵀJ is singular; J Jᵀ has an inverse.",
        ),
    ),
    Claim(
        id="000:3.2.2-JTJ-5x5",
        place="text below (3.2.2.3)",
        said="For the NAO's arm JᵀJ is a 5 × 5 matrix that has to be inverted.",
        formula="JᵀJ is 5 × 5 and has an inverse",
        printed=size_of_jtj,
        check=_sizes,
        reference="size and rank of the position Jacobian (Pinocchio)",
        domain=_POSTURES,
        unit="rows",
        tolerance=0.0,
        correction=Correction(
            size_of_jtj_corrected,
            "JᵀJ is 4 × 4 and has rank 3; the 3 × 3 matrix J Jᵀ is to be inverted",
            why="The arm has four joints, and four columns of length 3 are dependent.",
        ),
    ),
)
