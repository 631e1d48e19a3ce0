"""Update rules: from the Jacobian and the error to a joint step, one function a method, each written once.

The reference loop and the compiled loop call the same functions. J is (m, n), the error e is (m,) with J · Δq ≈ e
[m, rad], and the step Δq (n,) [rad or m] is written to `step`. p holds the method's parameters in the order of its row
in `nao_kin.ik.single.METHODS`; p[0] is always the gain K that scales the whole step. A (m, m) and y (m,) are scratch,
and so is J: what is in it afterwards is of no use. A held joint has a zero column in J, and every rule leaves it where
it is.

J = U Σ Vᵀ; u_i, σ_i and v_i are its singular vectors and values.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.linear import (
    add_to_diagonal,
    dot,
    orthogonal_rows,
    solve_positive,
    times_own_transpose,
    transpose_times,
)

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["LEVENBERG_MARQUARDT", "PARAMETERS", "levenberg_marquardt", "update"]

LEVENBERG_MARQUARDT: Final = 0
TRANSPOSE: Final = 1
TRANSPOSE_BUSS: Final = 2
NEWTON: Final = 3
PSEUDO_INVERSE: Final = 4
TRUNCATED: Final = 5
DAMPED: Final = 6
DAMPED_ADAPTIVE: Final = 7
SELECTIVELY_DAMPED: Final = 8
COMBINATION: Final = 9

PARAMETERS: Final = 3
"""Room for the parameters of any rule."""

LEAST_DAMPING: Final = 1e-12
"""Keeps J Jᵀ + λ² 1 definite in double precision at a singularity; joints that move the tip by more do not feel it."""

RANK: Final = 1e-10
"""Singular values below this part of the largest one are rounding: the direction is lost."""


@leaf_jit
def levenberg_marquardt(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Error-damped least squares, Δq = K Jᵀ (J Jᵀ + λ² 1)⁻¹ e with λ² = p[1] · |e|².

    Far away the damping keeps steps small, near the target it vanishes and the step becomes Newton's. The form is the
    one in the source; it also stays small where joints are many.

    Source: S. K. Chan and P. D. Lawrence, "General inverse kinematics with the error damped pseudoinverse", 1988.
    """
    _damped(J, e, p[0], p[1] * dot(e, e), A, y, step)


@leaf_jit
def transpose(J: Floats, e: Floats, p: Floats, y: Floats, step: Floats) -> None:
    """Jacobian transpose, Δq = K Jᵀ e.

    Source: practicum (14); Bischoff 2016, (3.2.1.1).
    """
    for i in range(e.shape[0]):
        y[i] = p[0] * e[i]
    transpose_times(J, y, step)


@leaf_jit
def transpose_buss(J: Floats, e: Floats, p: Floats, y: Floats, step: Floats) -> None:
    """Jacobian transpose, Δq = K α Jᵀ e with α = ⟨e, g⟩ / ⟨g, g⟩ and g = J Jᵀ e, which makes |e − J Δq| least.

    Source: Bischoff 2016, (3.2.1.2); S. R. Buss, "Introduction to inverse kinematics with Jacobian transpose,
    pseudoinverse and damped least squares methods", 2004.
    """
    transpose_times(J, e, step)
    for i in range(e.shape[0]):
        y[i] = dot(J[i], step)
    squared = dot(y, y)
    alpha = p[0] * dot(e, y) / squared if squared > 0.0 else 0.0
    for k in range(step.shape[0]):
        step[k] *= alpha


@leaf_jit
def newton(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Newton's step Δq = K Jᵀ (J Jᵀ)⁻¹ e, which is K J⁻¹ e for a square J: undamped, so it is huge near a singularity.

    With fewer joints than rows K (Jᵀ J)⁻¹ Jᵀ e, the joints that come closest.

    Source: practicum (12), (13) and (15); Bischoff 2016, (3.2.2.3).
    """
    if J.shape[1] >= J.shape[0]:
        _damped(J, e, p[0], 0.0, A, y, step)
    else:
        _closest(J, e, p[0], A, y, step)


@leaf_jit
def pseudo_inverse(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Moore-Penrose pseudo-inverse Δq = K J⁺ e = K Σ v_i u_iᵀ e / σ_i over the σ_i that are not 0, up to rounding.

    Source: Bischoff 2016, (3.2.2.1); practicum (16).
    """
    _truncated(J, e, p[0], RANK, A, y, step)


@leaf_jit
def truncated(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Truncated singular value decomposition: the pseudo-inverse without the σ_i below p[1] times the largest one.

    Source: A. A. Maciejewski and C. A. Klein, "The singular value decomposition: computation and applications to
    robotics", 1989.
    """
    _truncated(J, e, p[0], p[1], A, y, step)


@leaf_jit
def damped(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Damped least squares with a fixed λ = p[1], Δq = K Jᵀ (J Jᵀ + λ² 1)⁻¹ e.

    Source: C. W. Wampler, "Manipulator inverse kinematic solutions based on vector formulations and damped
    least-squares methods", 1986.
    """
    _damped(J, e, p[0], p[1] * p[1], A, y, step)


@leaf_jit
def damped_adaptive(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Damped least squares with λ² = p[1]² (1 − w / p[2])² where the manipulability w is below p[2], else undamped.

    w = √det(J Jᵀ), or √det(Jᵀ J) where joints are fewer than what is wanted: the product of the singular values.

    Source: Y. Nakamura and H. Hanafusa, "Inverse kinematic solutions with singularity robustness", 1986.
    """
    orthogonal_rows(J, A)
    part = max(0.0, 1.0 - _manipulability(J, y) / p[2])
    squared_damping = (p[1] * part) ** 2 + LEAST_DAMPING
    smallest = RANK * _largest_row(J)
    for i in range(e.shape[0]):
        squared = dot(J[i], J[i])
        y[i] = p[0] * _along(A, e, i) / (squared + squared_damping) if squared > smallest * smallest else 0.0
    transpose_times(J, y, step)


@leaf_jit
def selectively_damped(J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, step: Floats) -> None:
    """Selectively damped least squares: each singular direction's step is bounded by how far it throws the tip.

    φ_i = v_i u_iᵀ e / σ_i, cut to γ_i = γ · min(1, N_i / M_i), with N_i the sum of the lengths of u_i's parts,
    M_i = Σ_k |v_ik| ρ_k / σ_i, and ρ_k the sum of the lengths of the parts of J's column k; then the sum is cut to γ,
    which is p[1]. A part is three rows: a position, or a rotation. Cuts scale to the largest joint move.

    Source: S. R. Buss and J.-S. Kim, "Selectively damped least squares for inverse kinematics", 2005.
    """
    for k in range(step.shape[0]):
        step[k] = _parts(J, k)  # ρ, until the step itself is known
    orthogonal_rows(J, A)
    smallest = RANK * _largest_row(J)
    for i in range(e.shape[0]):
        squared, thrown, farthest = dot(J[i], J[i]), 0.0, 0.0
        y[i] = _along(A, e, i) / squared if squared > smallest * smallest else 0.0
        for k in range(step.shape[0]):
            thrown += abs(J[i, k]) * step[k]
            farthest = max(farthest, abs(y[i] * J[i, k]))
        bound = p[1] * min(1.0, _parts(A, i) * squared / thrown) if thrown > 0.0 else 0.0
        if farthest > bound:
            y[i] *= bound / farthest
    transpose_times(J, y, step)
    _cut(step, p[1])
    for k in range(step.shape[0]):
        step[k] *= p[0]


@leaf_jit
def update(rule: int, J: Floats, e: Floats, p: Floats, A: Floats, y: Floats, steps: Floats) -> int:
    """Writes the rule's step to row 0 of `steps` (2, n), and a second proposal to row 1 where it makes two; how many.

    Codes instead of functions as arguments, which would not survive numba's cache. `COMBINATION` proposes the steps of
    the pseudo-inverse, with gain p[0], and of the transpose, with gain p[1]; the loop keeps the one that comes closer.

    Source: practicum, section 1.8.
    """
    if rule == LEVENBERG_MARQUARDT:
        levenberg_marquardt(J, e, p, A, y, steps[0])
    elif rule == TRANSPOSE:
        transpose(J, e, p, y, steps[0])
    elif rule == TRANSPOSE_BUSS:
        transpose_buss(J, e, p, y, steps[0])
    elif rule == NEWTON:
        newton(J, e, p, A, y, steps[0])
    elif rule == PSEUDO_INVERSE:
        pseudo_inverse(J, e, p, A, y, steps[0])
    elif rule == TRUNCATED:
        truncated(J, e, p, A, y, steps[0])
    elif rule == DAMPED:
        damped(J, e, p, A, y, steps[0])
    elif rule == DAMPED_ADAPTIVE:
        damped_adaptive(J, e, p, A, y, steps[0])
    elif rule == SELECTIVELY_DAMPED:
        selectively_damped(J, e, p, A, y, steps[0])
    elif rule == COMBINATION:
        transpose(J, e, p[1:], y, steps[1])
        pseudo_inverse(J, e, p, A, y, steps[0])
        return 2
    return 1


@leaf_jit
def _damped(J: Floats, e: Floats, gain: float, squared_damping: float, A: Floats, y: Floats, step: Floats) -> None:
    times_own_transpose(J, A)
    add_to_diagonal(A, squared_damping + LEAST_DAMPING)
    solve_positive(A, e, y)
    if gain != 1.0:
        for i in range(y.shape[0]):
            y[i] *= gain
    transpose_times(J, y, step)


@leaf_jit
def _closest(J: Floats, e: Floats, gain: float, A: Floats, y: Floats, step: Floats) -> None:
    """K (Jᵀ J)⁻¹ Jᵀ e, for n < m: there J Jᵀ has no inverse, and what stands in for it would cost half the digits."""
    n = J.shape[1]
    N = A.reshape(A.size)[: n * n].reshape(n, n)
    for i in range(n):
        y[i] = 0.0
        for row in range(e.shape[0]):
            y[i] += gain * J[row, i] * e[row]
        for j in range(i + 1):
            N[i, j] = LEAST_DAMPING if i == j else 0.0
            for row in range(e.shape[0]):
                N[i, j] += J[row, i] * J[row, j]
    solve_positive(N, y[:n], step)


@leaf_jit
def _truncated(J: Floats, e: Floats, gain: float, least: float, A: Floats, y: Floats, step: Floats) -> None:
    """Singular values below `least` times the largest one are left out."""
    orthogonal_rows(J, A)
    smallest = max(least, RANK) * _largest_row(J)
    for i in range(J.shape[0]):
        squared = dot(J[i], J[i])
        y[i] = gain * _along(A, e, i) / squared if squared > smallest * smallest else 0.0
    transpose_times(J, y, step)


@leaf_jit
def _along(U: Floats, e: Floats, i: int) -> float:
    """u_iᵀ e."""
    total = 0.0
    for k in range(e.shape[0]):
        total += U[k, i] * e[k]
    return total


@leaf_jit
def _largest_row(W: Floats) -> float:
    """The largest singular value."""
    largest = 0.0
    for i in range(W.shape[0]):
        largest = max(largest, dot(W[i], W[i]))
    return math.sqrt(largest)


@leaf_jit
def _manipulability(W: Floats, y: Floats) -> float:
    """Product of the min(m, n) largest singular values; of more rows than joints the rest is 0 anyway."""
    for i in range(W.shape[0]):
        y[i] = dot(W[i], W[i])
    product = 1.0
    for _ in range(min(W.shape[0], W.shape[1])):
        largest = 0
        for i in range(1, W.shape[0]):
            if y[i] > y[largest]:
                largest = i
        product, y[largest] = product * math.sqrt(y[largest]), -1.0
    return product


@leaf_jit
def _parts(M: Floats, k: int) -> float:
    """Sum of the lengths of the parts, three rows each, of column k."""
    total = 0.0
    for first in range(0, M.shape[0], 3):
        total += math.sqrt(M[first, k] ** 2 + M[first + 1, k] ** 2 + M[first + 2, k] ** 2)
    return total


@leaf_jit
def _cut(step: Floats, bound: float) -> None:
    """Scales a step down until no joint moves by more than the bound."""
    largest = 0.0
    for k in range(step.shape[0]):
        largest = max(largest, abs(step[k]))
    if largest > bound:
        for k in range(step.shape[0]):
            step[k] *= bound / largest
