"""What stands for a mesh that cannot be shown: a box with its name, where the link's mass is."""

from __future__ import annotations

from itertools import permutations
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, MeshFile

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Inertial, Solid, Triple

__all__ = ["COLOUR", "label", "placeholder_box", "sign_corners"]

COLOUR: Final = (0.95, 0.66, 0.15, 0.4)
"""Amber, and to be seen through: no robot looks like that."""

EDGE: Final = 0.1
"""Edge of the cube that stands for a link without a usable inertia [m]."""

SMALLEST, LARGEST = 1e-3, 10.0
"""Edges [m] outside of which an inertia is taken for a slip."""

SIGN: Final = 0.9
"""Edge of the square of text on a side, next to the side's shorter edge."""


def placeholder_box(inertial: Inertial | None, solid: Solid) -> tuple[Box, Floats]:
    """The box of even density with a link's mass and inertia, and its pose (4, 4) in the link.

    Where the link states no inertia that a body can have, a small cube at the place of the visual.
    """
    found = None if inertial is None else _inertia_box(inertial)
    if found is not None:
        return found
    return Box((EDGE, EDGE, EDGE)), np.asarray(from_xyz_rpy(solid.origin.xyz, solid.origin.rpy).homogeneous)


def _inertia_box(inertial: Inertial) -> tuple[Box, Floats] | None:
    ixx, ixy, ixz, iyy, iyz, izz = inertial.inertia
    inertia = np.array([(ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)])
    if not (inertial.mass > 0.0 and np.isfinite(inertia).all()):
        return None
    moments, axes = np.linalg.eigh(inertia)
    squares = 6.0 / inertial.mass * (moments.sum() - 2.0 * moments)  # of the edges: I_x = m (b² + c²) / 12, and so on
    if not ((squares >= SMALLEST**2) & (squares <= LARGEST**2)).all():
        return None
    order = _nearest_order(axes)  # so that the text stands upright where the link does
    axes, squares = axes[:, order], squares[order]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    T_link_box = np.asarray(from_xyz_rpy(inertial.origin.xyz, inertial.origin.rpy).homogeneous).copy()
    T_link_box[:3, :3] = T_link_box[:3, :3] @ axes
    a, b, c = np.sqrt(squares).tolist()
    return Box((a, b, c)), T_link_box


def _nearest_order(axes: Floats) -> list[int]:
    """The order of three directions, columns of `axes`, in which they are nearest to x, y and z."""
    return list(max(permutations(range(3)), key=lambda order: float(np.abs(axes)[np.arange(3), list(order)].sum())))


def label(solids: Sequence[Solid]) -> str:
    """The name of the one file that is missing, or how many things are."""
    if len(solids) > 1:
        return f"{len(solids)} missing"
    (solid,) = solids
    shape = solid.shape
    return shape.filename.rsplit("/", 1)[-1][-40:] if isinstance(shape, MeshFile) else "missing"


def sign_corners(size: Triple) -> Floats:
    """Squares (6, 4, 3) that text is drawn on, one on each side of a box around the origin, as close as can be.

    Corners run from the lower left one counter-clockwise, as seen from outside.
    """
    half = np.asarray(size) / 2.0
    squares = []
    for axis, direction in [(axis, direction) for axis in range(3) for direction in (1.0, -1.0)]:
        normal = np.eye(3)[axis] * direction
        up = np.eye(3)[2] if axis < 2 else -np.eye(3)[0]  # a robot is looked at from ahead, where x points
        right = np.cross(up, normal)
        reach = SIGN * min(float(half @ abs(up)), float(half @ abs(right)))
        centre = normal * (half[axis] + 0.002 * half.max())  # in front, or the two surfaces would flicker
        squares.append([centre + reach * (i * right + j * up) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return np.asarray(squares)
