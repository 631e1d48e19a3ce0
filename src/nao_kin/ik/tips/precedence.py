"""One joint step for tasks in order of precedence: each task moves only what leaves those before it alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.ik.reference_loop import Update

    Mask = NDArray[np.bool_]

__all__ = ["Task", "prioritised_step"]

RANK: Final = 1e-9
"""A direction of the joints moves a task when it does so by more than this, relative to the one that moves it most."""


@dataclass(frozen=True, eq=False, slots=True)
class Task:
    """What counts alike: J · Δq takes as much off e, to first order.

    Attributes:
        J: Jacobian (m, n).
        e: Error (m,) [m, rad].
    """

    J: Floats
    e: Floats


def prioritised_step(tasks: Sequence[Task], rule: Update, at_lower: Mask, at_upper: Mask) -> Floats:
    """Δq (n,) [rad or m]: Δqₖ = Δqₖ₋₁ + rule(Jₖ Pₖ₋₁, eₖ − Jₖ Δqₖ₋₁), Pₖ₋₁ projecting on the null space of J₁ … Jₖ₋₁.

    The rule's steps lie in the rows of its Jacobian, so no task disturbs those before it, to first order. A joint at an
    end of its range that a task pushes outwards is held for this task, which projects as though it were not there.

    Source: B. Siciliano and J.-J. E. Slotine, "A general framework for managing multiple tasks in highly redundant
    robotic systems", 1991; the projection on the stacked Jacobians of all tasks before.

    Args:
        tasks: In order of precedence.
        rule: One that makes a single proposal.
        at_lower: Joints at the lower ends of their ranges (n,).
        at_upper: Joints at the upper ends (n,).
    """
    step = np.zeros(len(at_lower))
    for k, task in enumerate(tasks):
        step = step + _share(task, [above.J for above in tasks[:k]], step, rule, at_lower, at_upper)
    return step


def _share(task: Task, above: Sequence[Floats], step: Floats, rule: Update, at_lower: Mask, at_upper: Mask) -> Floats:
    """What a task adds to the step of those above it."""
    rest = task.e - task.J @ step
    J = task.J @ _projector(above, np.zeros_like(at_lower))
    held = _outward(J.T @ rest, at_lower, at_upper)
    while True:
        if held.any():
            J = task.J @ _projector(above, held)
        share: Floats = rule.proposals(J, rest)[0]
        # Holding one joint can turn another outwards; each turn holds more of them, so this ends.
        pushed = ~held & _outward(step + share, at_lower, at_upper) & (share != 0.0)
        if not pushed.any():
            return share
        held |= pushed


def _outward(motion: Floats, at_lower: Mask, at_upper: Mask) -> Mask:
    outward: Mask = (at_lower & (motion < 0.0)) | (at_upper & (motion > 0.0))
    return outward


def _projector(above: Sequence[Floats], held: Mask) -> Floats:
    """Projector (n, n) on the motions of the joints that are not held which leave the tasks above alone."""
    P = np.diag((~held).astype(np.float64))
    if above:
        _, sigma, Vt = np.linalg.svd(np.vstack(above) @ P, full_matrices=False)
        rows = Vt[sigma > RANK * sigma.max(initial=0.0)]
        P = P - rows.T @ rows
        P[held], P[:, held] = 0.0, 0.0
    return P
