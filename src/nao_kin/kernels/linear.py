"""Small dense linear algebra for compiled loops: nothing is allocated, results go to the caller's arrays.

Six rows, and six joints, have a branch of their own with the same code: a size that the compiler knows lets it unroll
the loops.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from nao_kin.kernels.compiling import leaf_jit

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "add_to_diagonal",
    "dot",
    "orthogonal_rows",
    "solve_positive",
    "times_own_transpose",
    "transpose_times",
]

_SWEEPS: Final = 40  # quadratic convergence needs less than ten; more would be a NaN
_ORTHOGONAL: Final = 1e-15  # cosine of the angle between two rows that count as perpendicular
_NOTHING: Final = 1e-30  # squared length of a row, next to the whole, that is rounding and points anywhere


@leaf_jit
def dot(a: Floats, b: Floats) -> float:
    """Scalar product of two vectors."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    return total


@leaf_jit
def times_own_transpose(J: Floats, A: Floats) -> None:
    """Writes A = J Jᵀ of J (m, n); the lower half of A (m, m) only, which is all that `solve_positive` reads."""
    if J.shape[0] == 6 and J.shape[1] == 6:
        _times_own_transpose(J, A, 6, 6)
    else:
        _times_own_transpose(J, A, J.shape[0], J.shape[1])


@leaf_jit
def _times_own_transpose(J: Floats, A: Floats, m: int, n: int) -> None:
    for i in range(m):
        for j in range(i + 1):
            total = 0.0
            for k in range(n):
                total += J[i, k] * J[j, k]
            A[i, j] = total


@leaf_jit
def add_to_diagonal(A: Floats, value: float) -> None:
    """A += value · 1."""
    for i in range(A.shape[0]):
        A[i, i] += value


@leaf_jit
def solve_positive(A: Floats, b: Floats, x: Floats) -> None:
    """Solves A x = b for a symmetric positive definite A (m, m), whose lower half is overwritten, by A = L D Lᵀ.

    Without square roots, and with one division a row. NaN or infinity in x where A is not definite.
    """
    if A.shape[0] == 6:
        _solve_positive(A, b, x, 6)
    else:
        _solve_positive(A, b, x, A.shape[0])


@leaf_jit
def _solve_positive(A: Floats, b: Floats, x: Floats, m: int) -> None:
    for j in range(m):
        # Row j of A holds L D left of the diagonal until L itself is read off; the diagonal keeps 1/D.
        pivot = A[j, j]
        total = b[j]
        for k in range(j):
            scaled = A[j, k] * A[k, k]
            pivot -= A[j, k] * scaled
            total -= scaled * x[k]
            A[j, k] = scaled
        A[j, j] = 1.0 / pivot
        x[j] = total
        for i in range(j + 1, m):
            entry = A[i, j]
            for k in range(j):
                entry -= A[i, k] * A[j, k]
            A[i, j] = entry
    for j in range(m - 1, -1, -1):
        total = x[j] * A[j, j]
        for i in range(j + 1, m):
            total -= A[i, j] * x[i]
        x[j] = total


@leaf_jit
def transpose_times(J: Floats, y: Floats, x: Floats) -> None:
    """Writes x = Jᵀ y."""
    if J.shape[0] == 6:
        _transpose_times(J, y, x, 6)
    else:
        _transpose_times(J, y, x, J.shape[0])


@leaf_jit
def _transpose_times(J: Floats, y: Floats, x: Floats, m: int) -> None:
    for k in range(J.shape[1]):
        total = 0.0
        for i in range(m):
            total += J[i, k] * y[i]
        x[k] = total


@leaf_jit
def orthogonal_rows(J: Floats, U: Floats) -> None:
    """Singular value decomposition without allocation: turns J (m, n) in place into W = Uᵀ J with perpendicular rows.

    Then J = U W, U is orthogonal (m, m), the length of row i of W is the singular value σ_i, and the row itself is
    σ_i v_iᵀ. The order is none in particular. Rows of length 0 stand for a missing rank.

    Source: M. R. Hestenes, "Inversion of matrices by biorthogonalization and related results", 1958 (one-sided Jacobi).
    """
    m, whole = J.shape[0], 0.0
    for i in range(m):
        whole += dot(J[i], J[i])
        for j in range(m):
            U[i, j] = 1.0 if i == j else 0.0
    for _ in range(_SWEEPS):
        turned = False
        for i in range(m - 1):
            for j in range(i + 1, m):
                turned = _make_perpendicular(J, U, i, j, _NOTHING * whole) or turned
        if not turned:
            return


@leaf_jit
def _make_perpendicular(W: Floats, U: Floats, i: int, j: int, nothing: float) -> bool:
    """Turns rows i and j of W, and columns i and j of U with them, until the rows are perpendicular; whether it did."""
    a, b, c = dot(W[i], W[i]), dot(W[j], W[j]), dot(W[i], W[j])
    if min(a, b) <= nothing or not abs(c) > _ORTHOGONAL * math.sqrt(a) * math.sqrt(b):
        return False
    half = (b - a) / (2.0 * c)
    tangent = math.copysign(1.0, half) / (abs(half) + math.sqrt(1.0 + half * half))
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    sine = cosine * tangent
    for k in range(W.shape[1]):
        W[i, k], W[j, k] = cosine * W[i, k] - sine * W[j, k], sine * W[i, k] + cosine * W[j, k]
    for k in range(U.shape[0]):
        U[k, i], U[k, j] = cosine * U[k, i] - sine * U[k, j], sine * U[k, i] + cosine * U[k, j]
    return True
