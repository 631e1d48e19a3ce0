"""Update rules: from the Jacobian and the error to a joint step, one function a method, each written once.

The reference loop and the compiled loop call the same functions. J is (m, n), the error e is (m,) with J · Δq ≈ e
[m, rad], and the step Δq (n,) [rad or m] is written to `step`. A (m, m) and y (m,) are scratch. A held joint has a zero
column in J, and every rule leaves it where it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.linear import add_to_diagonal, dot, solve_positive, times_own_transpose, transpose_times

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["LEVENBERG_MARQUARDT", "levenberg_marquardt", "update"]

LEVENBERG_MARQUARDT: Final = 0

DAMPING: Final = 0.05
"""λ² per squared error, smaller than the source's: steps are bounded otherwise, and less damping converges sooner."""

LEAST_DAMPING: Final = 1e-12
"""Keeps J Jᵀ + λ² 1 definite in double precision at a singularity; joints that move the tip by more do not feel it."""


@leaf_jit
def levenberg_marquardt(J: Floats, e: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Error-damped least squares, Δq = Jᵀ (J Jᵀ + λ² 1)⁻¹ e = (Jᵀ J + λ² 1)⁻¹ Jᵀ e, with λ² proportional to |e|².

    Far away the damping keeps steps small, near the target it vanishes and the step becomes Newton's. The first form
    is the one in the source; it also stays small where joints are many.

    Source: S. K. Chan and P. D. Lawrence, "General inverse kinematics with the error damped pseudoinverse", 1988.
    """
    times_own_transpose(J, A)
    add_to_diagonal(A, DAMPING * dot(e, e) + LEAST_DAMPING)
    solve_positive(A, e, y)
    transpose_times(J, y, step)


@leaf_jit
def update(rule: int, J: Floats, e: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """The rule with this code; codes instead of functions as arguments, which would not survive numba's cache."""
    if rule == LEVENBERG_MARQUARDT:
        levenberg_marquardt(J, e, A, y, step)
