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
    from nao_kin.kernels.joint_path import JointPath

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
def sweep(
    method: int,
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    kind: int,
    goal: Floats,
    closeness: float,
    q: Floats,
    axes: Floats,
    tip: Floats,
    memory: Floats,
) -> None:
    """Two passes and a step on: moves q to a new configuration inside its limits, coupled ones included.

    Args:
        method: `CCD`, `FOLLOW_THE_LEADER` or `FABRIK`; the latter two on chains that `refusal` does not name.
        joints: The chain (m + 1, 16), see `nao_kin.kernels.motion`.
        limits: Least and greatest joint values (2, n).
        coupled: Coupled limits (k, 7), see `nao_kin.kernels.joint_limits`.
        kind: What is wanted, see `nao_kin.ik.aim`; a position for the latter two.
        goal: The target (4, 4).
        closeness: Weight of the squared distance [1/m²] against the rotation, see `nao_kin.ik.starts`.
        q: Joints (n,) inside the limits, changed in place.
        axes: Axes (m, 6) at q; left at the new one.
        tip: T_base_tip (12,) at q; left at the new one.
        memory: Scratch (`sweep_memory`,).
    """
    n = q.shape[0]
    start, rest = memory[:n], memory[n:]
    if method != CCD:
        leave_line(joints, limits, coupled, goal, q, axes, tip, rest)
    _improve(method, joints, limits, coupled, kind, goal, closeness, start, q, axes, tip, rest)
    _improve(method, joints, limits, coupled, kind, goal, closeness, start, q, axes, tip, rest)
    _go_on(joints, limits, coupled, kind, goal, closeness, start, q, axes, tip, rest)


@leaf_jit
def _improve(
    method: int,
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    kind: int,
    goal: Floats,
    closeness: float,
    start: Floats,
    q: Floats,
    axes: Floats,
    tip: Floats,
    memory: Floats,
) -> None:
    """One pass of the method, or of CCD where that does not bring the tip closer; `start` (n,) receives q before it."""
    n = q.shape[0]
    before = squared_error(kind, goal, closeness, tip)
    for i in range(n):
        start[i] = q[i]
    if method != CCD:
        in_reach = hinge_pass(method == FOLLOW_THE_LEADER, joints, limits, coupled, goal, q, axes, tip, memory)
        worth = WORTH if in_reach else 1.0
        if squared_error(kind, goal, closeness, tip) < worth * before:
            return
        for i in range(n):
            q[i] = start[i]
        place(joints, q, axes, tip)
    ccd_pass(joints, limits, coupled, kind, goal, closeness, q, axes, tip, memory)


@leaf_jit
def _go_on(
    joints: Floats,
    limits: Floats,
    coupled: Floats,
    kind: int,
    goal: Floats,
    closeness: float,
    start: Floats,
    q: Floats,
    axes: Floats,
    tip: Floats,
    memory: Floats,
) -> None:
    """Goes on in the direction from `start` to q, each time twice as far, while that brings the error down.

    After a pass, what is left of the error lies mostly along the direction in which the method is slowest; so it is the
    step from one pass to the next that points along it.

    A pattern move after R. Hooke and T. A. Jeeves, "Direct search" solution of numerical problems, 1961.
    """
    n, trial, factor = q.shape[0], memory[: q.shape[0]], 1.0
    best = squared_error(kind, goal, closeness, tip)
    for i in range(n):
        memory[n + i] = q[i] - start[i]
    for _ in range(DOUBLINGS):
        for i in range(n):
            trial[i] = q[i] + factor * memory[n + i]
        move_inside(trial, limits, coupled)
        place(joints, trial, axes, tip)
        error = squared_error(kind, goal, closeness, tip)
        if not error < best:
            break
        best, factor = error, 2.0 * factor
        for i in range(n):
            q[i] = trial[i]
    place(joints, q, axes, tip)
