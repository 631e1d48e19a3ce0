"""Several tips wanted somewhere at once: the problem, its result, and the judge that alone may say "solved"."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from nao_kin.chain import OutsideLimit, joint_table, outside_limits
from nao_kin.ik.measure import errors
from nao_kin.ik.problem import Status, verdict
from nao_kin.ik.target import KINDS
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.ik.target import Target
    from nao_kin.robot.tree import Tree

__all__ = ["TreeProblem", "TreeResult", "TreeRun", "TreeTrace", "judge_tree"]


@dataclass(frozen=True, eq=False, slots=True)
class TreeProblem:
    """What is wanted of a tree.

    Attributes:
        tree: The tree.
        targets: Tip name to what that tip is to do, in the tree's base frame; other tips are free.
        weights: Tip name to how much its error counts where not all targets can be met.
        levels: The tips in order of precedence, those that count alike together.
        tolerances: When a target counts as reached.
    """

    tree: Tree
    targets: Mapping[str, Target]
    weights: Mapping[str, float]
    levels: tuple[tuple[str, ...], ...]
    tolerances: Tolerances = TOLERANCES


@dataclass(frozen=True, eq=False, slots=True)
class TreeTrace:
    """What an iteration went through, one row an iterate, and one column a tip that has a target.

    Tips that share no joint are solved one after the other, so a part of the rows moves one of them only.

    Attributes:
        q: Joints (k, n) [rad or m].
        position_error: Position errors (k, tips) [m]; NaN where the target leaves the position free.
        rotation_error: Rotation errors (k, tips) [rad]; NaN where the target leaves the orientation free.
        start: Number of the start that the iterate belongs to (k,); 0 is the caller's.
    """

    q: Floats
    position_error: Floats
    rotation_error: Floats
    start: NDArray[np.int64]

    def __post_init__(self) -> None:
        for array in (self.q, self.position_error, self.rotation_error, self.start):
            array.flags.writeable = False


@dataclass(frozen=True, eq=False, slots=True)
class TreeRun:
    """What the solver hands to the judge.

    Attributes:
        q: The best joints found (n,).
        ended: Why it stopped; a claim of success is checked, every other reason is kept.
        iterations: Iterations over all starts.
        starts: Starts tried, the caller's included.
        start_moved: True if the caller's q0 was outside the limits and was moved inside.
        misses_by: Tips whose targets are proven out of reach, with a lower bound of the distance they miss by [m].
        trace: The iterates, where they were asked for.
    """

    q: Floats
    ended: Status
    iterations: int = 0
    starts: int = 1
    start_moved: bool = False
    misses_by: Mapping[str, float] = field(default_factory=dict)
    trace: TreeTrace | None = None


@dataclass(frozen=True, eq=False, slots=True)
class TreeResult:
    """A set of joints that the judge measured, tip by tip.

    Attributes:
        problem: What was wanted.
        q: The joints of the tree (n,) [rad or m], read-only; the best found if unsolved, always finite.
        status: Why the solver ended; solved means that every tip is at its target.
        position_error: Tip name to its distance from the target [m], measured at `q`; None where that is free.
        rotation_error: Tip name to the angle to the wanted orientation [rad], measured at `q`; None where that is free.
        outside: Joints outside their own or their coupled ranges.
        run: What the solver reported.
    """

    problem: TreeProblem
    q: Floats
    status: Status
    position_error: Mapping[str, float | None]
    rotation_error: Mapping[str, float | None]
    outside: tuple[OutsideLimit, ...]
    run: TreeRun = field(repr=False)

    @property
    def solved(self) -> bool:
        """Whether every tip is measured within tolerance and every joint within its limits."""
        return self.status is Status.SOLVED

    @property
    def missed(self) -> tuple[str, ...]:
        """The tips that are not at their targets."""
        tolerances = self.problem.tolerances
        return tuple(
            tip
            for tip in self.problem.targets
            if (self.position_error[tip] or 0.0) > tolerances.position
            or (self.rotation_error[tip] or 0.0) > tolerances.rotation
        )

    @property
    def posture(self) -> dict[str, float]:
        """The joints by name [rad or m]."""
        return dict(zip(self.problem.tree.joint_names, self.q.tolist(), strict=True))

    @property
    def misses_by(self) -> Mapping[str, float]:
        """Tips whose targets are proven out of reach, with a lower bound of the distance they miss by [m]."""
        return self.run.misses_by

    @property
    def trace(self) -> TreeTrace | None:
        """The iterates, where they were asked for."""
        return self.run.trace

    @property
    def iterations(self) -> int:
        """Iterations over all starts."""
        return self.run.iterations

    @property
    def message(self) -> str:
        """The status with the measured errors of every tip, for people."""
        parts = [self.status.value, *(f"{tip}: {self._errors(tip)}." for tip in self.problem.targets)]
        parts += [f"{tip} misses by at least {distance:.3g} m." for tip, distance in self.misses_by.items()]
        parts += [f"{outside}." for outside in self.outside]
        if self.run.start_moved:
            parts.append("The start was outside the limits and was moved inside.")
        return " ".join(parts)

    def _errors(self, tip: str) -> str:
        position, rotation = self.position_error[tip], self.rotation_error[tip]
        errors = [] if position is None else [f"position error {position:.3g} m"]
        errors += [] if rotation is None else [f"rotation error {rotation:.3g} rad"]
        return ", ".join(errors)

    def __bool__(self) -> NoReturn:
        raise TypeError(
            "A TreeResult is not a truth value: ask for result.solved, and read result.status if it is not."
        )

    def __repr__(self) -> str:
        return f"<TreeResult {self.status.name}: {self.message.removeprefix(self.status.value).strip()}>"

    def _repr_html_(self) -> str:
        return joint_table(self.problem.tree, self.q, self.status.name, self.message)._repr_html_()


def judge_tree(problem: TreeProblem, run: TreeRun) -> TreeResult:
    """Measures every tip with its chain's own forward kinematics, and the limits of the tree and of each chain."""
    if not np.isfinite(run.q).all():
        finite = np.nan_to_num(run.q, nan=0.0, posinf=0.0, neginf=0.0)
        return judge_tree(problem, replace(run, q=finite, ended=Status.NOT_FINITE))
    tree, tolerances = problem.tree, problem.tolerances
    position, rotation = dict[str, float | None](), dict[str, float | None]()
    outside = list(outside_limits(tree, run.q, tolerances.limits))
    for tip, chain in tree.chains.items():
        q = tree.chain_q(tip, run.q)
        outside += outside_limits(chain, q, tolerances.limits)
        if tip in problem.targets:
            target, T = problem.targets[tip], chain.pose(q)
            measured = errors(KINDS[target.kind], target.goal, target.counts, T.rotation, T.translation)
            position[tip], rotation[tip] = (None if math.isnan(error) else error for error in measured)
    run.q.flags.writeable = False
    found = TreeResult(problem, run.q, run.ended, position, rotation, tuple(dict.fromkeys(outside)), run)
    return replace(found, status=verdict(run.ended, not found.missed, not found.outside))
