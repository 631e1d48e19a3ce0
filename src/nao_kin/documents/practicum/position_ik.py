"""Practicum sheet, tasks 1a to 1g: position inverse kinematics with the transpose and the pseudo-inverse, as printed.

As printed means: a fixed number of iterations, no stop, no restarts, no joint limits, and (J Jᵀ)⁻¹ without damping. For
work, use `nao_kin.solve`; this is for comparing with what one's own solution of the sheet prints.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import positive, vector
from nao_kin.chain import configuration
from nao_kin.documents.practicum.practicum_sheet import jaco2
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

    Step = Callable[[Floats, Floats], Floats]

__all__ = ["ITERATIONS", "TaskResult", "ik_checked", "ik_pseudo_inverse", "ik_transpose", "position_jacobian"]

ITERATIONS: Final = 128
"""Task 1e."""

LARGEST_ERROR: Final = 0.01
"""Task 1g: the position error must stay below this [m]."""

LARGEST_JUMP: Final = math.pi / 2.0
"""Task 1g asks to detect large jumps and leaves the bound open; a quarter turn of a joint here [rad]."""


@dataclass(frozen=True, eq=False, slots=True)
class TaskResult:
    """What tasks 1e to 1g return.

    Attributes:
        q: Joints after the last iteration (n,) [rad].
        errors: Position errors (iterations + 1,) [m] before the first and after each iteration.
        jump: Largest move of a joint from the start, q_soll − q_ist [rad].
        fault: Task 1g: what is wrong with the result, empty if nothing is.
    """

    q: Floats
    errors: Floats
    jump: float
    fault: str = ""

    @property
    def error(self) -> float:
        """Position error at the end [m]."""
        return float(self.errors[-1])


def position_jacobian(chain: Chain, q: ArrayLike) -> Floats:
    """Task 1d: the Jacobian of the position alone (3, n) [m/rad], from the transforms of the chain."""
    return np.asarray(chain.jacobian(q)[:3])


def ik_transpose(
    q: ArrayLike, p_base: ArrayLike, *, gain: float, iterations: int = ITERATIONS, chain: Chain | None = None
) -> TaskResult:
    """Task 1e, ``IK_Transp``: q ← q + K Jᵀ e, equation (14).

    Args:
        q: Joints at the start (n,) [rad].
        p_base: Wanted position of the hand in the base frame (3,) [m].
        gain: K [1/m²]; the sheet leaves it open. It converges for K below 2/σ², σ the largest singular value of J.
        iterations: How many.
        chain: The arm; the sheet's JACO2 unless given.

    Raises:
        InvalidInputError: Wrong shapes, not finite, a gain or count that is not positive.
    """
    K = positive(gain, "gain", "[1/m²]")
    return _iterate(lambda J, e: K * (J.T @ e), q, p_base, iterations, chain)


def ik_pseudo_inverse(
    q: ArrayLike, p_base: ArrayLike, *, gain: float = 1.0, iterations: int = ITERATIONS, chain: Chain | None = None
) -> TaskResult:
    """Task 1e, ``IK_Pseudo``: q ← q + K J⁺ e with J⁺ = Jᵀ (J Jᵀ)⁻¹, equations (15) and (16).

    Near a singularity its steps are huge, which is what task 1g is about. Exactly at one J Jᵀ has no inverse; the
    iteration then stays where it is.

    Args:
        q: Joints at the start (n,) [rad].
        p_base: Wanted position of the hand in the base frame (3,) [m].
        gain: K, 1 for Newton's step.
        iterations: How many.
        chain: The arm; the sheet's JACO2 unless given.

    Raises:
        InvalidInputError: Wrong shapes, not finite, a gain or count that is not positive.
    """
    K = positive(gain, "gain")
    return _iterate(lambda J, e: K * _printed_pseudo_inverse_step(J, e), q, p_base, iterations, chain)


def ik_checked(
    q: ArrayLike,
    p_base: ArrayLike,
    *,
    iterations: int = ITERATIONS,
    largest_error: float = LARGEST_ERROR,
    largest_jump: float = LARGEST_JUMP,
    chain: Chain | None = None,
) -> TaskResult:
    """Task 1g: ``IK_Pseudo`` that detects large jumps and errors, and says so in `fault`.

    Args:
        q: Joints at the start (n,) [rad].
        p_base: Wanted position of the hand in the base frame (3,) [m].
        iterations: How many.
        largest_error: From here on the position error is a fault [m].
        largest_jump: Largest move of a joint that is none [rad].
        chain: The arm; the sheet's JACO2 unless given.

    Raises:
        InvalidInputError: Wrong shapes, not finite, or a count that is not positive.
    """
    result = ik_pseudo_inverse(q, p_base, iterations=iterations, chain=chain)
    faults = []
    if not result.error < largest_error:
        faults.append(f"The position error is {result.error:.3g} m, not below {largest_error:g} m.")
    if result.jump > largest_jump:
        faults.append(f"A joint jumps by {result.jump:.3g} rad, more than {largest_jump:.3g} rad.")
    return TaskResult(result.q, result.errors, result.jump, " ".join(faults))


def _printed_pseudo_inverse_step(J: Floats, e: Floats) -> Floats:
    try:
        return np.asarray(J.T @ np.linalg.solve(J @ J.T, e))
    except np.linalg.LinAlgError:
        return np.zeros(J.shape[1])


def _iterate(step: Step, q: ArrayLike, p_base: ArrayLike, iterations: int, chain: Chain | None) -> TaskResult:
    arm = jaco2() if chain is None else chain
    if isinstance(iterations, bool) or not isinstance(iterations, int) or iterations < 1:
        raise InvalidInputError("iterations", "an integer ≥ 1", repr(iterations))
    start, wanted = configuration(arm, q), vector(p_base, "target position", 3)
    reached, errors = start.copy(), np.empty(iterations + 1)
    for k in range(iterations + 1):
        e = wanted - arm.pose(reached).translation
        errors[k] = np.linalg.norm(e)
        if k < iterations:
            reached = reached + step(position_jacobian(arm, reached), e)
    return TaskResult(reached, errors, float(np.abs(reached - start).max()))
