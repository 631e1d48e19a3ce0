"""The geometric methods as sweeps: a pass over the chain that takes the place of an update rule in the loops.

CCD moves one joint at a time to its optimum. FABRIK and follow-the-leader (FTL) move points and have the hinges follow.
Free points always come closer, hinges need not: where they stand against each other, a pass does not bring the tip
closer, or hardly. Such a pass is taken back, and the sweep moves the joints for the tip alone, which is CCD. So no
sweep of any method increases the error, but for one that has a straight chain leave the line of its target.

All three converge linearly, which can be slow near the target. So a sweep is two passes and a try to go on in the
direction from the first to the second: as far again, then twice as far, and so on as long as the error falls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.ik.geometric.ccd import ccd_pass, squared_error
from nao_kin.ik.geometric.fabrik import hinge_memory, hinge_pass, leave_line
from nao_kin.kernels.compiling import leaf_jit
from nao_kin.kernels.joint_limits import move_inside
from nao_kin.kernels.motion import place

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.ik.aim import SweepGoal
    from nao_kin.kernels.joint_path import JointPath
    from nao_kin.kernels.motion import Arm, At

__all__ = ["CCD", "DOUBLINGS", "FABRIK", "FOLLOW_THE_LEADER", "WORTH", "refusal", "sweep", "sweep_memory"]

CCD: Final = 100
FOLLOW_THE_LEADER: Final = 101
FABRIK: Final = 102

WORTH: Final = 0.81
"""A pass over points counts if it takes a tenth off the distance, so that its square falls to this part. Out of reach,
where the distance cannot fall by much, anything counts."""

DOUBLINGS: Final = 20
"""Times that a sweep's own step is doubled at most."""


def sweep_memory(joints: Floats) -> int:
    """Numbers of scratch memory that `sweep` needs for a chain (m + 1, 16)."""
    m = int(joints.shape[0]) - 1
    return m + max(hinge_memory(joints), 7 * m + 12)


def refusal(path: JointPath) -> str:
    """Why FABRIK and follow-the-leader cannot work on a chain; empty if they can. CCD works on any.

    They move points at fixed distances, each joint turning for itself.
    """
    if path.prismatic.any():
        return "a prismatic joint changes the length of a link, and the method keeps lengths"
    if len(set(path.columns.tolist())) < len(path.columns):
        return "one motor moves several joints of this chain, and the method turns each joint for itself"
    return ""


@leaf_jit
def sweep(method: int, arm: Arm, aim: SweepGoal, at: At, memory: Floats) -> None:
    """Two passes and a step on: moves to a new configuration inside its limits, coupled ones included.

    Args:
        method: `CCD`, `FOLLOW_THE_LEADER` or `FABRIK`; the latter two on chains that `refusal` does not name.
        arm: The chain.
        aim: What is wanted; a position for the latter two.
        at: Joints inside the limits, changed in place, their axes and tip with them.
        memory: Scratch (`sweep_memory`,).
    """
    n = at.q.shape[0]
    start, rest = memory[:n], memory[n:]
    if method != CCD:
        leave_line(arm, aim.goal, at, rest)
    _improve(method, arm, aim, start, at, rest)
    _improve(method, arm, aim, start, at, rest)
    _go_on(arm, aim, start, at, rest)


@leaf_jit
def _improve(method: int, arm: Arm, aim: SweepGoal, start: Floats, at: At, memory: Floats) -> None:
    """One pass of the method, or of CCD where that does not bring the tip closer; `start` (n,) receives q before it."""
    q = at.q
    before = squared_error(aim, at.tip)
    for i in range(q.shape[0]):
        start[i] = q[i]
    if method != CCD:
        in_reach = hinge_pass(method == FOLLOW_THE_LEADER, arm, aim.goal, at, memory)
        worth = WORTH if in_reach else 1.0
        if squared_error(aim, at.tip) < worth * before:
            return
        for i in range(q.shape[0]):
            q[i] = start[i]
        place(arm.joints, q, at.axes, at.tip)
    ccd_pass(arm, aim, at, memory)


@leaf_jit
def _go_on(arm: Arm, aim: SweepGoal, start: Floats, at: At, memory: Floats) -> None:
    """Goes on in the direction from `start` to q, each time twice as far, while that brings the error down.

    After a pass, what is left of the error lies mostly along the direction in which the method is slowest; so it is the
    step from one pass to the next that points along it.

    A pattern move after R. Hooke and T. A. Jeeves, "Direct search" solution of numerical problems, 1961.
    """
    q, n, factor = at.q, at.q.shape[0], 1.0
    trial, best = memory[:n], squared_error(aim, at.tip)
    for i in range(n):
        memory[n + i] = q[i] - start[i]
    for _ in range(DOUBLINGS):
        for i in range(n):
            trial[i] = q[i] + factor * memory[n + i]
        move_inside(trial, arm.limits, arm.coupled)
        place(arm.joints, trial, at.axes, at.tip)
        error = squared_error(aim, at.tip)
        if not error < best:
            break
        best, factor = error, 2.0 * factor
        for i in range(n):
            q[i] = trial[i]
    place(arm.joints, q, at.axes, at.tip)
