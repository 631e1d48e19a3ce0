"""Update rules: from the Jacobian's rows and the error to a joint step, one function a method.

J is (m, n), the error e is (m,) with J · Δq ≈ e [m, rad], and the step Δq is (n,) [rad or m].
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["levenberg_marquardt"]

DAMPING = 0.05
"""λ² per squared error. Chan's usual 0.5 needs half as many iterations again on a UR5; 0.02 to 0.1 do equally well."""


def levenberg_marquardt(J: Floats, e: Floats) -> Floats:
    """Error-damped least squares, Δq = Jᵀ (J Jᵀ + λ² 1)⁻¹ e = (Jᵀ J + λ² 1)⁻¹ Jᵀ e, with λ² proportional to |e|².

    Far away the damping keeps steps small, near the target it vanishes and the step becomes Newton's.

    Source: S. K. Chan and P. D. Lawrence, "General inverse kinematics with the error damped pseudoinverse", 1988.
    """
    A = J @ J.T
    # The second term is rounding's size: it keeps A definite at a singularity.
    A[np.diag_indices_from(A)] += DAMPING * (e @ e) + 1e-15 * np.trace(A) + 1e-300
    return (J.T @ np.linalg.solve(A, e)).astype(np.float64, copy=False)
