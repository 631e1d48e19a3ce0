"""Practicum sheet, tasks 1a, 1b and 2a to 2g that are motion: what each asks for, under its English name.

Tasks 1d to 1g are in `nao_kin.documents.practicum.position_ik`. Each function here is a few lines on what the package
has anyway: for work, use that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.dh.dh_row import DHRow, dh_matrix
from nao_kin.documents.practicum.practicum_sheet import jaco2
from nao_kin.errors import InvalidInputError
from nao_kin.robot.robot import load
from nao_kin.trajectory.files.reading import read_trajectory, write_trajectory
from nao_kin.trajectory.following import FollowResult, follow
from nao_kin.trajectory.paths import PositionLine, line_points
from nao_kin.trajectory.replaying import Replay, replay
from nao_kin.trajectory.timing import TimedPath, timed

if TYPE_CHECKING:
    import os
    from pathlib import Path

    import pinocchio as pin
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = [
    "SAMPLING",
    "dh_transform",
    "forward_kinematics",
    "interpolate_position",
    "interpolate_with_acceleration",
    "joint_transforms",
    "run_file",
    "save_ik_of_points",
]

SAMPLING: Final = 0.01
"""Task 2c: time between samples [s]."""


def dh_transform(a: float, alpha: float, d: float, theta: float) -> Floats:
    """Task 1a: the transform (4, 4) of one row of a DH table, standard convention.

    Args:
        a: Length along x [m].
        alpha: Twist about x [rad].
        d: Length along z [m].
        theta: Turn about z [rad].
    """
    return dh_matrix(DHRow(a, alpha, d, 0.0), theta, "standard")


def joint_transforms(q: ArrayLike) -> Floats:
    """Task 1b: the transforms (6, 4, 4) of the JACO2's joints at its own joint angles (6,) [rad]."""
    arm = jaco2()
    values = np.asarray(q, dtype=np.float64)
    return np.array([dh_matrix(row, angle, "standard") for row, angle in zip(arm.rows, values, strict=True)])


def forward_kinematics(q: ArrayLike) -> pin.SE3:
    """Task 1b: T_base_hand of the JACO2 at its own joint angles (6,) [rad]."""
    return jaco2().pose(q)


def interpolate_position(p_start: ArrayLike, p_end: ArrayLike, intermediate_steps: int) -> Floats:
    """Task 2a, ``Interpolation``: points (n, 3) [m] of the straight line, the ends and the steps between them.

    Args:
        p_start: Start (3,) [m].
        p_end: End (3,) [m].
        intermediate_steps: Number of points between the ends, so that n is two more.

    Raises:
        InvalidInputError: Not three finite numbers each, or a count that is none.
    """
    if isinstance(intermediate_steps, bool) or not isinstance(intermediate_steps, int) or intermediate_steps < 0:
        raise InvalidInputError("intermediate_steps", "an integer ≥ 0", repr(intermediate_steps))
    return line_points(p_start, p_end, intermediate_steps + 2)


def interpolate_with_acceleration(
    p_start: ArrayLike, p_end: ArrayLike, *, max_velocity: float, acceleration: float, sampling: float = SAMPLING
) -> TimedPath:
    """Task 2c: the same with a speed that rises, stays and falls; braking is as hard as speeding up.

    Args:
        p_start: Start (3,) [m].
        p_end: End (3,) [m].
        max_velocity: v_max [m/s].
        acceleration: a_0 [m/s²]; a_n is its negative.
        sampling: Time between samples [s]; the last one is where the motion ends.

    Raises:
        InvalidInputError: Not three finite numbers each, or a rate that is not positive.
    """
    return timed(PositionLine(p_start, p_end), speed=max_velocity, acceleration=acceleration, sampling=sampling)


def save_ik_of_points(
    path: str | os.PathLike[str], motion: TimedPath, q_start: ArrayLike, chain: Chain | None = None
) -> FollowResult:
    """Task 2d: inverse kinematics of every point, saved in a TXT file if all of them are reached.

    Args:
        path: The file; its ending says in which form.
        motion: The points and their times.
        q_start: Joints at the first point, or near it (n,) [rad].
        chain: The arm; the JACO2's URDF unless given, whose greatest speeds the motion is slowed to.

    Returns:
        What was found; there is no file unless it says `completed`.

    Raises:
        InvalidInputError: Shapes that do not fit, or another ending.
        OSError: The file cannot be written.
    """
    arm = load("jaco2").chain("arm") if chain is None else chain
    found = follow(arm, motion, q_start, scale=True)
    if found.completed and found.trajectory is not None:
        write_trajectory(path, found.trajectory)
    return found


def run_file(path: str | os.PathLike[str] | Path, chain: Chain | None = None) -> Replay:
    """Task 2g: the file read again and run through the arm, with what it cannot do.

    Args:
        path: The file.
        chain: The arm; the JACO2's URDF unless given.

    Raises:
        TrajectoryFileError: The file is malformed; carries line and column.
        UnknownNameError: Its joints are not the arm's.
    """
    return replay(load("jaco2").chain("arm") if chain is None else chain, read_trajectory(path))
