"""The first joint, from the base outwards, from which on two chains move differently."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.se3 import position_distance, rotation_angle, rotation_distance

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.tolerances import Tolerances

__all__ = ["Departure", "first_departure"]


@dataclass(frozen=True, slots=True)
class Departure:
    """The first place, from the base outwards, at which two chains move differently.

    Judged by how the joints up to there *move* the tip point away from its place at q = 0, so that two conventions with
    differently placed link frames are not told apart by those frames. The cause is at this joint or before it: in its
    row, or in the fixed transform that leads to it. A shift along a joint's own axis moves nothing until the next joint
    turns, so it shows there.

    Attributes:
        joint: Name of the first physical joint that moves the tip differently, in the second chain; None if all joints
            move alike and only where the tip sits differs, or if the chains have different numbers of physical joints.
        number: Its place on the path, counted from 1; one more than there are joints for the ends; 0 if not localised.
        position: Largest distance there [m].
        rotation: Largest angle there [rad].
    """

    joint: str | None
    number: int
    position: float
    rotation: float

    def __str__(self) -> str:
        where = self.joint or ("fixed end" if self.number else "not localised")
        return f"{where} ({self.position * 1e3:.4g} mm, {self.rotation:.4g} rad)"


def first_departure(a: Chain, b: Chain, Q: Floats, tolerances: Tolerances) -> Departure:
    """Where two chains that disagree at configurations Q (N, n) part.

    Args:
        a: The first chain.
        b: The second chain, as many columns.
        Q: Configurations at which to look (N, n) [rad, m].
        tolerances: When two motions count as the same.
    """
    zero = np.zeros(len(b.joints))
    tip = b.pose(zero).translation
    links_a, links_b = a.link_poses(zero), b.link_poses(zero)
    if len(links_a) != len(links_b):
        pairs = [(a.pose(q), b.pose(q)) for q in Q]
        position = max(position_distance(*pair) for pair in pairs)
        return Departure(None, 0, position, max(rotation_distance(*pair) for pair in pairs))
    moved = [(_motions(a.link_poses(q), links_a), _motions(b.link_poses(q), links_b)) for q in Q]
    for k in range(len(links_b)):
        position = max(float(np.linalg.norm(_apply(Ma[k], tip) - _apply(Mb[k], tip))) for Ma, Mb in moved)
        rotation = max(rotation_angle(Ma[k, :3, :3].T @ Mb[k, :3, :3]) for Ma, Mb in moved)
        if position > tolerances.agreement_position or rotation > tolerances.agreement_rotation:
            return Departure(b.path_joint_names[k], k + 1, position, rotation)
    T_a, T_b = a.pose(zero), b.pose(zero)
    return Departure(None, len(links_b) + 1, position_distance(T_a, T_b), rotation_distance(T_a, T_b))


def _motions(links: Floats, links_at_zero: Floats) -> Floats:
    """The rigid motions (m, 4, 4) of the base's space that carry each link from its place at q = 0 to where it is."""
    inverses = np.linalg.inv(links_at_zero)
    motions: Floats = links @ inverses
    return motions


def _apply(T: Floats, point: Floats) -> Floats:
    moved: Floats = T[:3, :3] @ point + T[:3, 3]
    return moved
