"""FABRIK for several tips: chains from one base that share their first joints and part at some point.

Each tip has its reach pass. Outwards, a joint that several chains share is turned so that the squared distances of all
their next points add up to the least. Where the chains share the next point as well, that is the point nearest to the
centroid of where they want it, as in the source; where their next points differ, nothing else would be fair.

Source: A. Aristidou and J. Lasenby, "FABRIK: a fast, iterative solver for the inverse kinematics problem", 2011, the
section on multiple end effectors; adapted to hinges like `nao_kin.ik.geometric.fabrik`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.ik.aim import POSITION, SweepGoal
from nao_kin.ik.geometric.best_turn import best_turn, point_wave
from nao_kin.ik.geometric.ccd import squared_error
from nao_kin.ik.geometric.fabrik import CYCLES, STILL, carry, hinge_memory, leave_line, outward_pass, want_points
from nao_kin.ik.geometric.hinge_groups import group_point
from nao_kin.ik.geometric.sweep import DOUBLINGS, WORTH
from nao_kin.kernels.joint_limits import column_range, move_inside
from nao_kin.kernels.motion import COLUMN, MULTIPLIER, Arm, At, place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["tree_pass", "tree_sweep"]


def tree_sweep(
    paths: Sequence[Floats],
    columns: Sequence[NDArray[np.int64]],
    limits: Floats,
    coupled: Floats,
    goals: Sequence[Floats],
    q: Floats,
) -> Floats:
    """One FABRIK iteration on chains that share joints; the sum of squared distances to the targets does not increase.

    It proceeds like `nao_kin.ik.geometric.sweep.sweep`, with one pass instead of two: a straight chain leaves the line
    of its target, which alone may increase the error; a pass that does not bring the tips closer is taken back, and the
    joints are moved for the tips alone; the sweep goes on in its direction as long as that helps.

    Args:
        paths: Each chain's joints (m + 1, 16), see `nao_kin.kernels.motion`, none that `geometric.refusal` names.
            Joints count as shared as long as rows and columns are the same from the base on.
        columns: For each chain, the column of the union that each of its own columns is (n,).
        limits: Least and greatest values of the union's columns (2, N).
        coupled: Coupled limits of the union (k, 7), see `nao_kin.kernels.joint_limits`.
        goals: For each chain its target (4, 4), of which the position counts.
        q: The union's joints (N,) inside the limits.

    Returns:
        The joints after the sweep (N,), inside the limits.
    """
    q = _off_lines(paths, columns, limits, coupled, goals, q)
    before = _missing(_branches(paths, columns, goals, q))
    moved = tree_pass(paths, columns, limits, coupled, goals, q)
    best = _missing(_branches(paths, columns, goals, moved))
    if not best < WORTH * before:
        moved = _for_the_tips(_branches(paths, columns, goals, q), limits, coupled, q)
        best = _missing(_branches(paths, columns, goals, moved))
        if not best < before:
            return q
    way, factor = moved - q, 1.0
    for _ in range(DOUBLINGS):
        trial = moved + factor * way
        move_inside(trial, limits, coupled)
        error = _missing(_branches(paths, columns, goals, trial))
        if not error < best:
            break
        moved, best, factor = trial, error, 2.0 * factor
    return moved


@dataclass(eq=False, slots=True)
class _Branch:
    """One chain of the tree at the present joints; its arrays are those of `nao_kin.ik.geometric.fabrik`.

    Attributes:
        joints: The chain (m + 1, 16), columns counted in the union.
        goal: Its target (4, 4).
        axes: Axes (m, 6).
        tip: T_base_tip (12,).
        first: See `nao_kin.ik.geometric.hinge_groups`.
        slide: See there.
        wanted: Where its points are wanted (m + 3, 3) [m].
        count: Its groups.
    """

    joints: Floats
    goal: Floats
    axes: Floats
    tip: Floats
    first: Floats
    slide: Floats
    wanted: Floats
    count: int = 0

    def group(self, k: int) -> int:
        """The group of joint k; 0 if it moves no point of this chain."""
        return int(np.count_nonzero(self.first[: self.count] > k))

    def point(self, g: int) -> Floats:
        """The point of a group (3,) [m]."""
        x, y, z = self.tip[9:]
        return np.array(group_point(g, self.first, self.slide, self.axes, x, y, z))


def _branches(
    paths: Sequence[Floats], columns: Sequence[NDArray[np.int64]], goals: Sequence[Floats], q: Floats
) -> list[_Branch]:
    made = []
    for packed, own, goal in zip(paths, columns, goals, strict=True):
        joints, m = packed.copy(), len(packed) - 1
        joints[:m, COLUMN] = np.asarray(own)[packed[:m, COLUMN].astype(np.int64)]
        branch = _Branch(
            joints, goal, np.empty((m, 6)), np.empty(12), np.zeros(m + 1), np.zeros(m + 1), np.zeros((m + 3, 3))
        )
        place(joints, q, branch.axes, branch.tip)
        made.append(branch)
    return made


def _missing(branches: Sequence[_Branch]) -> float:
    """Sum of the squared distances of the tips to their targets [m²]."""
    return sum(squared_error(SweepGoal(POSITION, branch.goal, 1.0), branch.tip) for branch in branches)


def tree_pass(
    paths: Sequence[Floats],
    columns: Sequence[NDArray[np.int64]],
    limits: Floats,
    coupled: Floats,
    goals: Sequence[Floats],
    q: Floats,
) -> Floats:
    """The two passes of `tree_sweep`, whatever they do to the error; returns the joints (N,)."""
    q = q.copy()
    branches = _branches(paths, columns, goals, q)
    for b in branches:
        memory = np.empty(6 * len(b.axes) + len(q))
        arm, at = Arm(b.joints, limits, coupled), At(q, b.axes, b.tip)
        b.count = want_points(arm, b.goal, at, b.first, b.slide, b.wanted, memory)
    _outwards(branches, 0, limits, coupled, q)
    move_inside(q, limits, coupled)
    return q


def _off_lines(
    paths: Sequence[Floats],
    columns: Sequence[NDArray[np.int64]],
    limits: Floats,
    coupled: Floats,
    goals: Sequence[Floats],
    q: Floats,
) -> Floats:
    """A copy of the joints (N,), every chain bent that stands in a straight line with its target."""
    q = q.copy()
    for index in range(len(paths)):  # anew for each, because bending one moves the others
        b = _branches(paths, columns, goals, q)[index]
        at = At(q, b.axes, b.tip)
        leave_line(Arm(b.joints, limits, coupled), b.goal, at, np.empty(hinge_memory(b.joints)))
    return q


def _outwards(branches: Sequence[_Branch], begin: int, limits: Floats, coupled: Floats, q: Floats) -> None:
    """The outward pass of chains that share all joints before joint `begin`, from that joint on."""
    if len(branches) == 1:
        (b,) = branches
        arm, at = Arm(b.joints, limits, coupled), At(q, b.axes, b.tip)
        outward_pass(False, begin, arm, b.count, b.first, b.slide, b.wanted, at)
        return
    end = _shared(branches)
    while begin < end:
        # Joints that are of one group for any of the chains take turns, as they do in a chain by itself.
        stop = begin + 1
        while stop < end and any(b.group(stop) == b.group(begin) for b in branches):
            stop += 1
        _turn_shared(branches, begin, stop, limits, coupled, q)
        begin = stop
    for part in _parted(branches, end):
        _outwards(part, end, limits, coupled, q)


def _shared(branches: Sequence[_Branch]) -> int:
    """How many joints all these chains share."""
    one, *others = branches
    shortest = min(len(b.axes) for b in branches)
    return next((k for k in range(shortest) if any((b.joints[k] != one.joints[k]).any() for b in others)), shortest)


def _parted(branches: Sequence[_Branch], k: int) -> list[list[_Branch]]:
    """The chains by their joint k, those that end before it left out."""
    parts: dict[bytes, list[_Branch]] = {}
    for b in branches:
        if k < len(b.axes):
            parts.setdefault(b.joints[k].tobytes(), []).append(b)
    return list(parts.values())


def _turn_shared(
    branches: Sequence[_Branch], begin: int, stop: int, limits: Floats, coupled: Floats, q: Floats
) -> None:
    """Turns the joints begin ≤ k < stop for the next points of all chains, a joint at a time."""
    for _ in range(CYCLES):
        largest = 0.0
        for k in range(stop - 1, begin - 1, -1):
            pairs = [(b.point(b.group(k) - 1), b.wanted[b.group(k) - 1]) for b in branches if b.group(k) > 0]
            largest = max(largest, abs(_turn(branches, k, pairs, limits, coupled, q)))
        if largest <= STILL or stop - begin == 1:
            break


def _turn(
    branches: Sequence[_Branch],
    k: int,
    pairs: Sequence[tuple[Floats, Floats]],
    limits: Floats,
    coupled: Floats,
    q: Floats,
) -> float:
    """Turns joint k of all chains so that points come nearest to where they are wanted, both (3,) [m]; the angle [rad].

    The joint's column of q and what it carries in each chain move along.
    """
    joint, axis = branches[0].joints[k], branches[0].axes[k].copy()
    i, factor = int(joint[COLUMN]), float(joint[MULTIPLIER])
    waves = [point_wave(*axis[:3], *(point - axis[3:]), *(wanted - axis[3:])) for point, wanted in pairs]
    lower, upper = column_range(limits, coupled, q, i)
    ends = sorted((factor * (lower - q[i]), factor * (upper - q[i])))
    A, B = sum(wave[0] for wave in waves), sum(wave[1] for wave in waves)
    delta = best_turn(A, B, min(ends[0], 0.0), max(ends[1], 0.0))
    if delta != 0.0:
        q[i] = min(max(q[i] + delta / factor, lower), upper)
        for b in branches:
            carry(k, len(b.axes), delta, b.axes, np.zeros(3), b.tip[9:12])
    return delta


def _for_the_tips(branches: list[_Branch], limits: Floats, coupled: Floats, q: Floats) -> Floats:
    """Cyclic coordinate descent on all tips: each joint once, from the tips to the base; returns the joints (N,)."""
    q = q.copy()
    for k in range(max(len(b.axes) for b in branches) - 1, -1, -1):
        for sharing in _sharing(branches, k):
            _turn(sharing, k, [(b.tip[9:12], b.goal[:3, 3]) for b in sharing], limits, coupled, q)
    move_inside(q, limits, coupled)
    return q


def _sharing(branches: Sequence[_Branch], k: int) -> list[list[_Branch]]:
    """The chains by their joints up to joint k."""
    parts: dict[bytes, list[_Branch]] = {}
    for b in branches:
        if k < len(b.axes):
            parts.setdefault(b.joints[: k + 1].tobytes(), []).append(b)
    return list(parts.values())
