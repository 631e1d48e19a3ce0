"""Static balance: where the centre of mass is, and how far inside the polygon of the feet that stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.robot.pinocchio_layout import PinocchioLayout

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.trajectory import Trajectory

__all__ = ["centres_of_mass", "support_margins"]

_EDGE = 1e-12  # [m] what is no farther than this beyond a line through two feet is on it


def centres_of_mass(robot: Robot, trajectory: Trajectory) -> Floats:
    """The centre of mass in the root's frame at every sample (N, 3) [m]; the root's origin if nothing has a mass."""
    model = robot.model
    data, layout = model.createData(), PinocchioLayout.of(model, robot.joint_names)
    # Pinocchio's own centerOfMass leaves out what is fixed to its universe, which is the whole body of a hexapod.
    parts = [(k, inertia.mass, inertia.lever) for k, inertia in enumerate(model.inertias) if inertia.mass > 0.0]
    total = sum(mass for _, mass, _ in parts)
    centres = np.zeros((len(trajectory), 3))
    for i in range(len(trajectory) if total else 0):
        values = robot.expand(trajectory.posture(i))
        pin.forwardKinematics(model, data, layout.q(np.array([values[name] for name in robot.joint_names])))
        centres[i] = sum(mass * data.oMi[k].act(lever) for k, mass, lever in parts) / total
    return centres


def support_margins(feet: Floats, standing: NDArray[np.bool_], centre: Floats) -> Floats:
    """How far a point is inside the convex hull of the feet that stand (N,) [m]; negative outside.

    Inside it is the distance to the nearest edge; outside, to the line through the edge that it is farthest beyond,
    which is never more than the distance to the hull. With fewer than three feet, or all in a line, there is no hull
    and the margin is −inf.

    Args:
        feet: Seen from above (N, L, 2) [m].
        standing: Which of them stand (N, L).
        centre: The point (N, 2) [m].
    """
    count = feet.shape[1]
    margins, edges = np.full(len(feet), np.inf), np.zeros(len(feet), dtype=int)
    for i in range(count):
        for j in range(count):
            edge = feet[:, j] - feet[:, i]
            length = np.linalg.norm(edge, axis=1)
            usable = standing[:, i] & standing[:, j] & (length > _EDGE)
            inward = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / np.where(length > _EDGE, length, 1.0)[:, None]
            beside = np.einsum("nlk,nk->nl", feet - feet[:, i, None], inward)
            beside = np.where(standing, beside, np.nan)
            # An edge of the hull, counter-clockwise: no foot is on its outer side, and one at least is off its line.
            on_hull = usable & ~(beside < -_EDGE).any(axis=1) & (beside > _EDGE).any(axis=1)
            distance = np.einsum("nk,nk->n", centre - feet[:, i], inward)
            margins = np.where(on_hull, np.minimum(margins, distance), margins)
            edges += on_hull
    return np.where(edges >= 3, margins, -np.inf)
