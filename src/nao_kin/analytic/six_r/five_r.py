"""Five turning joints, as six of which the last one is imagined and stays at 0.

Five joints reach few poses; those that they reach are the ones that six joints reach with the imagined one at 0. Its
axis lies beside all others, so that an arm without structure stays one, and no solution of five is lost among a
continuum of six.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, screws
from nao_kin.analytic.six_r import general as six_r_general

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["BRANCHES", "recognise", "solve", "solve_many"]

BRANCHES: Final = six_r_general.BRANCHES
_STILL: Final = 1e-9  # [rad]: an imagined joint this near to 0 is there
# The imagined joint in the tip's frame: its axis is the third column; and where it is, in lengths of the arm.
_TURN: Final = np.array([[0.8, 0.36, 0.48], [-0.6, 0.48, 0.64], [0.0, -0.8, 0.6]])
_BESIDE: Final = np.array([0.21, -0.34, 0.13])


def recognise(path: JointPath) -> Geometry | Mismatch:
    """The numbers of the six joints for `solve`, of any five turning joints."""
    arm = screws(path, 5)
    if isinstance(arm, Mismatch):
        return arm
    size = float(np.linalg.norm(np.diff(arm.points, axis=0), axis=1).sum())
    beside = max(size, 1e-3) * _BESIDE
    R, t = path.tool_rotation, path.tool_translation
    return six_r_general.recognise(
        path._replace(
            rotations=np.concatenate([path.rotations, [R @ _TURN]]),
            translations=np.concatenate([path.translations, [t + R @ beside]]),
            tool_rotation=np.ascontiguousarray(_TURN.T),
            tool_translation=-_TURN.T @ beside,
            prismatic=np.append(path.prismatic, 0),
            columns=np.append(path.columns, 5),
            multipliers=np.append(path.multipliers, 1.0),
            offsets=np.append(path.offsets, 0.0),
            lower=np.append(path.lower, -np.inf),
            upper=np.append(path.upper, np.inf),
        )
    )


def solve_many(
    arm: Floats, kind: int, goals: Floats, given: Floats, slack: float, rows: Floats, counts: NDArray[np.int64]
) -> None:
    """`solve` for goals (N, 4, 4), rows (N, 16, 7) and counts (N,), one after the other."""
    for i in range(len(goals)):
        counts[i] = solve(arm, kind, goals[i], given[0], slack, rows[i])


def solve(arm: Floats, kind: int, goal: Floats, given: Floats, slack: float, rows: Floats) -> int:
    """Every solution of a pose; see `nao_kin.analytic.form.ClosedForm` for the arguments.

    A solution of the six misses by about what the imagined joint turns times the arm's size.
    """
    six = np.empty((BRANCHES, 8))
    count = six_r_general.solve(arm, kind, goal, given, slack, six)
    still = np.abs(six[:count, 5]) <= max(_STILL, slack)
    kept = six[:count][still]
    rows[: len(kept), :5], rows[: len(kept), 5:] = kept[:, :5], kept[:, 6:]
    return len(kept)
