"""Practicum, sections 1.4 to 1.8: step length, transpose, pseudo-inverse and their combination, (13) to (16)."""

from __future__ import annotations

from typing import Final

from nao_kin.documents import practicum_inverse_checks as checks
from nao_kin.documents import practicum_newton as printed
from nao_kin.documents.claim import Claim, Correction

__all__ = ["CLAIMS"]

_PINOCCHIO: Final = "Pinocchio on the JACO2's model"
_POSITIONS: Final = "60 configurations with a regular positional Jacobian, errors of about 30 mm, K of 1, 0.6 and 0.25"
_MEASURED_TOO: Final = "; on larger samples by nao-kin bench methods"

CLAIMS: Final = (
    Claim(
        id="001:eq-13",
        place="equation (13)",
        said="Newton's iteration with steps scaled by K.",
        formula="q_{n+1} = q_n + K J⁻¹ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^{-1} e(q)",
        printed=printed.eq_13,
        check=checks.scaled_step,
        reference=_PINOCCHIO + ": J Δq = K e",
        domain="100 regular configurations, poses 0.05 rad away, K of 1, 0.6 and 0.25",
    ),
    Claim(
        id="001:1.4-small-K",
        place="section 1.4, text",
        said="A small K makes a jump to another solution less likely, and takes more steps.",
        formula="K ↓  ⇒  jumps ↓, steps ↑",
        latex=r"K \downarrow \;\Rightarrow\; \text{jumps} \downarrow,\; \text{steps} \uparrow",
        printed=printed.eq_13,
        check=checks.small_gain,
        reference=_PINOCCHIO + ", runs of (13) with K = 1 and K = 0.2",
        domain="60 starts up to 0.4 rad from a solution in every joint; the growth of the share that ends at another"
        + _MEASURED_TOO,
    ),
    Claim(
        id="001:eq-14",
        place="equation (14)",
        said="The transpose in place of the inverse, a step of steepest descent.",
        formula="q_{n+1} = q_n + K Jᵀ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^T e(q)",
        printed=printed.eq_14,
        check=checks.descent_step,
        reference=_PINOCCHIO + ": −K times the gradient of ½|e|², by five-point differences",
        domain=_POSITIONS + "; it converges for K below 2/σ², σ the largest singular value of J",
    ),
    Claim(
        id="001:1.6-small-distances",
        place="section 1.6, text",
        said="For small distances the transpose is accurate enough; taken as: a smaller share of the way is left.",
        formula="|e| → 0  ⇒  K Jᵀ e ≈ J⁻¹ e",
        latex=r"|e| \to 0 \;\Rightarrow\; K \, J^T e \approx J^{-1} e",
        printed=printed.eq_14,
        check=checks.transpose_nearby,
        reference=_PINOCCHIO + ", one step",
        domain="60 configurations; share left of 1 mm over share left of 50 mm, of which at most half would be accurate"
        + _MEASURED_TOO,
        tolerance=0.5,
        uncorrectable="The step is linear in e, so the share it leaves does not depend on the distance; (16) is what "
        "is accurate for small ones.",
    ),
    Claim(
        id="001:eq-15",
        place="equation (15)",
        said="The pseudo-inverse.",
        formula="J⁺ = Jᵀ (J Jᵀ)⁻¹",
        latex=r"J^+ = J^T (J J^T)^{-1}",
        printed=printed.eq_15,
        check=checks.penrose,
        reference="the four conditions of Penrose",
        domain="3×6 positional Jacobians at 60 regular configurations; it needs full row rank",
    ),
    Claim(
        id="001:1.7-n-by-m",
        place="section 1.7, text before (15)",
        said="The pseudo-inverse of (15) is valid for matrices of any shape too.",
        formula="J⁺ = Jᵀ (J Jᵀ)⁻¹  for J of n × m",
        latex=r"J^+ = J^T (J J^T)^{-1},\quad J \in \mathbb{R}^{n \times m}",
        printed=printed.eq_15,
        check=checks.shapes,
        reference="the four conditions of Penrose",
        domain="40 random matrices each, wide, square, tall and rank-deficient; it holds for those of full row rank",
        correction=Correction(
            printed.eq_15_any,
            "J⁺ = V Σ⁺ Uᵀ  from  J = U Σ Vᵀ",
            r"J^+ = V \, \Sigma^+ \, U^T, \quad J = U \, \Sigma \, V^T",
            "J Jᵀ has no inverse if J has more rows than columns, or dependent rows.",
        ),
    ),
    Claim(
        id="001:eq-16",
        place="equation (16)",
        said="Newton's iteration with the pseudo-inverse.",
        formula="q_{n+1} = q_n + K J⁺ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^+ e(q)",
        printed=printed.eq_16,
        check=checks.shortest_step,
        reference=_PINOCCHIO + ": J Δq = K e, and nothing of Δq in the null space of J",
        domain=_POSITIONS,
    ),
    Claim(
        id="001:1.7-singularities",
        place="section 1.7, text",
        said="Singularities are positions that the robot cannot take.",
        formula="share of singular configurations that can be taken = 0",
        printed=printed.singularities_taken,
        check=checks.singular_are_taken,
        reference=_PINOCCHIO + " and its limits",
        domain="50 configurations with det J = 0, found along the fifth joint",
        correction=Correction(
            printed.singularities_taken_corrected,
            "share = 1: positions from which the hand cannot move in every direction",
            why="At a singularity J loses rank; the robot can stand there.",
        ),
    ),
    Claim(
        id="001:1.7-unstable",
        place="section 1.7, text after (16)",
        said="Near singularities the pseudo-inverse makes joints jump although the hand hardly moves.",
        formula="|J⁺ e| ≫ |e|",
        latex=r"|J^+ e| \gg |e|",
        printed=printed.eq_15,
        check=checks.wild_near_singularity,
        reference=_PINOCCHIO,
        domain="50 configurations 1e-4 rad beside a singularity, |e| = 1e-3 m, rad along the weakest direction; the "
        "share in which no joint moves by a quarter turn",
    ),
    Claim(
        id="001:1.8-combination",
        place="section 1.8, text",
        said="Taking the better of transpose and pseudo-inverse needs fewer steps and suppresses instabilities.",
        formula="q_{n+1} = the one of q_n + K Jᵀ e and q_n + J⁺ e with the smaller |e(q)|",
        latex=r"q_{n+1} = \underset{q \in \{q_n + K J^T e,\; q_n + J^+ e\}}{\operatorname{argmin}} |e(q)|",
        printed=printed.combination,
        check=checks.combined(pose=True),
        reference=_PINOCCHIO + ", whole runs beside the pseudo-inverse alone",
        domain="40 starts and targets anywhere, at most 128 steps to 1 mm and mrad, K of the best length; how much it "
        "exceeds the pseudo-inverse alone" + _MEASURED_TOO,
        conventions={"only the position is wanted, as in tasks 1d to 1g": checks.combined(pose=False)},
    ),
)
