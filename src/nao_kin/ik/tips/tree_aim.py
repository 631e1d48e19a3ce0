"""What each tip of a tree heads for, how far it is from there, and which tips have to do with each other."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.ik import aim
from nao_kin.ik.measure import errors
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.starts import distances, starts_at
from nao_kin.ik.target import KINDS
from nao_kin.ik.tips.precedence import Task

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import Target
    from nao_kin.ik.tips.tree_problem import TreeProblem
    from nao_kin.robot.tree import Tree
    from nao_kin.tolerances import Tolerances

__all__ = ["Aim", "Levels", "Seen", "aims_of", "apart", "stacked", "unreachable_last"]

Levels = tuple[tuple[str, ...], ...]
"""Tips in order of precedence, those that count alike together."""


@dataclass(frozen=True, eq=False, slots=True)
class Seen:
    """Where a tip is, and how far from its target.

    Attributes:
        tip: T_base_tip (12,): rotation row by row, translation [m].
        e: Raw error (6,) as `nao_kin.ik.aim.raw_error` gives it.
        position: Position error [m], NaN where it is free.
        rotation: Rotation error [rad], NaN where it is free.
    """

    tip: Floats
    e: Floats
    position: float
    rotation: float

    def merit(self, tolerances: Tolerances) -> float:
        """The larger error in units of its tolerance; one that is free does not count."""
        return max(_ratio(self.position, tolerances.position), _ratio(self.rotation, tolerances.rotation))


@dataclass(frozen=True, eq=False, slots=True)
class Aim:
    """One tip and what it heads for.

    Attributes:
        chain: Its chain.
        spread: The chain's q is spread · q + shift, with q of the tree.
        shift: See there.
        target: The target, moved into reach where it is proven to be outside.
        weight: Weight of its error against those of the tips of its level.
        misses_by: Lower bound of the distance by which the target as given is out of reach [m]; 0 without a proof.
    """

    chain: Chain
    spread: Floats
    shift: Floats
    target: Target
    weight: float
    misses_by: float

    def look(self, q: Floats) -> Seen:
        """Where the tip is at the tree's q (n,)."""
        T = self.chain.pose(self.spread @ q + self.shift)
        tip, e = np.concatenate([T.rotation.ravel(), T.translation]), np.empty(6)
        kind, goal = KINDS[self.target.kind], self.target.goal
        aim.raw_error(kind, goal, tip, e)
        return Seen(tip, e, *errors(kind, goal, self.target.counts, T.rotation, T.translation))

    def cost(self, seen: Seen) -> float:
        """Squared weighted error [m², rad²]: what is made small where the target cannot be met."""
        weighted = self.weight * np.array(self.target.weights) * seen.e
        return float(weighted @ weighted)

    def task(self, q: Floats, seen: Seen) -> Task:
        """The weighted error, and its Jacobian in the tree's columns."""
        kind, goal, e = KINDS[self.target.kind], self.target.goal, seen.e.copy()
        J = np.ascontiguousarray(self.chain.jacobian(self.spread @ q + self.shift))
        aim.shape_rows(kind, goal, np.array(self.target.weights), seen.tip, e, J)
        bound = {"position": slice(0, 3), "orientation": slice(3, 6)}.get(self.target.kind, slice(0, 6))
        return Task(self.weight * (J[bound] @ self.spread), self.weight * e[bound])

    def distances(self, Q: Floats) -> Floats:
        """How far the tip is from the target at each of the tree's configurations (N, n), in one number (N,)."""
        return distances(starts_at(self.chain, Q @ self.spread.T + self.shift), self.target)


def stacked(tasks: Iterable[Task]) -> Task:
    """Several tasks that count alike as one."""
    rows = list(tasks)
    return Task(np.vstack([task.J for task in rows]), np.concatenate([task.e for task in rows]))


def aims_of(problem: TreeProblem) -> dict[str, Aim]:
    """Tip name to aim; a target that is proven out of reach becomes the nearest place that the links allow."""
    tree, aims = problem.tree, dict[str, Aim]()
    for tip, target in problem.targets.items():
        chain, heading, misses_by = tree.chains[tip], target, 0.0
        if target.kind != "orientation" and min(target.weights[:3]) > 0.0:
            shell, wanted = reach_shell(chain), target.goal[:3, 3]
            if shell.misses_by(wanted) > problem.tolerances.position:
                heading, misses_by = target.moved_to(shell.nearest(wanted)), shell.misses_by(wanted)
        aims[tip] = Aim(chain, tree.spreads[tip], tree.shifts[tip], heading, problem.weights[tip], misses_by)
    return aims


def apart(tree: Tree, tips: Iterable[str]) -> list[tuple[str, ...]]:
    """The tips in groups that share no joint and no coupled limit."""
    index = {name: column for column, name in enumerate(tree.joint_names)}
    groups: list[tuple[tuple[str, ...], set[int]]] = []
    linked = [((tip,), set(tree.columns[tip].tolist())) for tip in tips]
    for names, columns in [*linked, *(((), {index[r.joint], index[r.by]}) for r in tree.limit_rules)]:
        touching = [group for group in groups if group[1] & columns]
        groups = [group for group in groups if not group[1] & columns]
        together = tuple(itertools.chain(*(group[0] for group in touching), names))
        groups.append((together, columns.union(*(group[1] for group in touching))))
    return [names for names, _ in groups if names]


def unreachable_last(levels: Levels, group: Sequence[str], aims: Mapping[str, Aim]) -> Levels:
    """The levels of a group, each split in two where some of its targets are proven out of reach: those come second."""
    split = (
        tuple(tip for tip in level if tip in group and (aims[tip].misses_by > 0.0) is unreachable)
        for level in levels
        for unreachable in (False, True)
    )
    return tuple(level for level in split if level)


def _ratio(error: float, tolerance: float) -> float:
    if error != error or error == 0.0:  # NaN, which stands for free
        return 0.0
    return error / tolerance if tolerance > 0.0 else math.inf
