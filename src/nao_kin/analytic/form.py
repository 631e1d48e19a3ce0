"""What a closed form is: how it recognises its geometry in a chain, and how its compiled code is called.

A closed form lives in a module of its own and has five parts.

* `recognise` measures a flat chain at q = 0 and returns the numbers that the formulas need, or what departs. It reads
  axes and points only, so base, tool, axis signs, joint offsets and names may be anything.
* `solve`, a `leaf_jit` kernel, writes every solution of one goal.
* `solve_many`, a `parallel_jit` kernel, does so for many goals.
* Labels say in words which branch a solution belongs to, and which joint is free where the arm is singular.
* A row `ClosedForm` in the table of `nao_kin.analytic.forms` makes it known.

Joint angles in rows are those of the chain, wrapped to (−π, π]; limits, windings and locked joints are the business of
`nao_kin.analytic.solutions`, and what a solution is worth is measured by the judge.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NamedTuple, TypeAlias

import numpy as np

from nao_kin.ik.target import KINDS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = [
    "GOALS",
    "STRUCTURE_TOLERANCE",
    "ClosedForm",
    "Geometry",
    "GoalKind",
    "Mismatch",
    "Request",
    "Screws",
    "largest",
    "screws",
]

GoalKind: TypeAlias = Literal["pose", "position", "pointing", "orientation", "direction"]

GOALS: Final[dict[GoalKind, int]] = dict[GoalKind, int](KINDS.items()) | {"direction": len(KINDS)}
"""The kinds of goals by the numbers that compiled code knows them by: those of `nao_kin.ik.target.KINDS`, and the
direction of an axis alone, which is a pointing target whose position has weight 0."""

STRUCTURE_TOLERANCE: Final = 1e-10
"""How far a chain may depart from the structure that a closed form assumes [m, rad]. The pose of a solution is then as
near to its target; files printed with nine digits or less are for iterative methods."""

SolveKernel: TypeAlias = "Callable[[Floats, int, Floats, Floats, float, Floats], int]"
ManyKernel: TypeAlias = "Callable[[Floats, int, Floats, Floats, float, Floats, NDArray[np.int64]], None]"


@dataclass(frozen=True, eq=False, slots=True)
class Geometry:
    """A chain as a closed form reads it.

    Attributes:
        parameters: All numbers that the kernels need (P,) [m, rad]; what they are is the form's own business.
        residual: Largest departure of the chain from the form's structure [m, rad].
    """

    parameters: Floats
    residual: float


@dataclass(frozen=True, slots=True)
class Mismatch:
    """Why a chain does not have a form's geometry.

    Attributes:
        reason: What was measured and what it should have been, as the end of a sentence.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class Request:
    """What a form can be asked.

    Attributes:
        branches: Largest number of solutions of one goal, isolated ones and representatives.
        given: Columns of q whose values the caller chooses, because the goal leaves them free.
    """

    branches: int
    given: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class ClosedForm:
    """One closed form.

    `solve(parameters, goal_kind, goal, given, slack, rows)` returns the number of solutions that it wrote into the
    first of `rows` (branches, n + 2): the joints (n,) [rad or m], the label's number, the number of the singularity.
    `goal` (4, 4) has the form of `nao_kin.ik.target.Target.goal`, `given` (k,) are the values of the given columns in
    their order. A solution that misses by more than `slack` [m] need not be written; where the goal lies a little
    beyond the border, the one at the border is, and the judge decides.

    `solve_many(parameters, goal_kind, goals, given, slack, rows, counts)` does so for goals (N, 4, 4), rows
    (N, branches, n + 2) and counts (N,); `given` is (N, k), or (1, k) for all.

    Attributes:
        name: Its name.
        title: What it is for, for people.
        source: Document and equation, or paper.
        joints: Number of joints.
        requests: What it can be asked.
        labels: The branch in words, by number.
        singularities: What is free at a singularity, by number; 0 is regular and has no words.
        recognise: Measures a flat chain.
        solve: The kernel for one goal.
        solve_many: The kernel for many.
    """

    name: str
    title: str
    source: str
    joints: int
    requests: Mapping[GoalKind, Request]
    labels: tuple[str, ...]
    singularities: tuple[str, ...]
    recognise: Callable[[JointPath], Geometry | Mismatch]
    solve: SolveKernel
    solve_many: ManyKernel

    def label(self, branch: int, singularity: int) -> str:
        """The words for the last two numbers of a solution's row."""
        words = (self.labels[branch], self.singularities[singularity])
        return ", ".join(word for word in words if word)


class Screws(NamedTuple):
    """A chain of turning joints at q = 0, in base axes: T_base_tip(q) = Π_k exp(axis_k through point_k, q_k) · tip.

    Attributes:
        axes: Unit axis of each joint, in the sense in which q turns (n, 3).
        points: A point on each axis (n, 3) [m].
        tip: T_base_tip at q = 0 (4, 4).
    """

    axes: Floats
    points: Floats
    tip: Floats


def screws(path: JointPath, joints: int) -> Screws | Mismatch:
    """The axes of a flat chain that has this many turning joints, one column of q each, ungeared."""
    if len(path.columns) != joints or len(path.lower) != joints:
        return Mismatch(f"it has {len(path.columns)} joints and not {joints}")
    if path.prismatic.any():
        return Mismatch(f"joint {int(np.flatnonzero(path.prismatic)[0]) + 1} slides")
    if not np.array_equal(path.columns, np.arange(joints)):
        return Mismatch("its joints do not have one column of q each, in their order")
    if not (np.abs(path.multipliers) == 1.0).all():
        return Mismatch(f"joint {int(np.flatnonzero(np.abs(path.multipliers) != 1.0)[0]) + 1} is geared")
    here, axes, points = np.eye(4), np.empty((joints, 3)), np.empty((joints, 3))
    for k in range(joints):
        here = here @ _transform(path.rotations[k], path.translations[k])
        axes[k], points[k] = path.multipliers[k] * here[:3, 2], here[:3, 3]
        c, s = np.cos(path.offsets[k]), np.sin(path.offsets[k])
        here[:3, :2] = here[:3, :2] @ np.array([[c, -s], [s, c]])
    return Screws(axes, points, here @ _transform(path.tool_rotation, path.tool_translation))


def largest(measured: Mapping[str, float]) -> float | Mismatch:
    """The largest of the measured departures [m, rad], or what departs by more than `STRUCTURE_TOLERANCE`."""
    worst = max(measured, key=lambda what: abs(measured[what]))
    departure = abs(measured[worst])
    if departure <= STRUCTURE_TOLERANCE:
        return departure
    return Mismatch(f"{worst} by {departure:.3g} where {STRUCTURE_TOLERANCE:g} is allowed")


def _transform(R: Floats, t: Floats) -> Floats:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T
