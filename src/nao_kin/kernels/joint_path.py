"""A chain as flat arrays, every joint turning about or sliding along its own z axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["JointPath", "PathJoint", "along_z", "held", "homogeneous", "joint_path"]


class JointPath(NamedTuple):
    """The one flat form of a chain; a tuple of arrays, so that compiled code takes it as it is.

    T_base_tip(q) = (Π_k P_k · Z_k(v_k)) · tool with v_k = multiplier_k · q[column_k] + offset_k, where P_k is a fixed
    placement and Z_k turns about z by v_k [rad] or, for a prismatic joint, slides along z by v_k [m].

    Attributes:
        rotations: Rotation parts of the placements P_k (m, 3, 3).
        translations: Translation parts of the placements P_k (m, 3) [m].
        tool_rotation: Rotation from the last joint's frame to the tip (3, 3).
        tool_translation: Tip in the last joint's frame (3,) [m].
        prismatic: 1 where joint k slides, 0 where it turns (m,).
        columns: The column of q that moves joint k (m,).
        multipliers: Its factor (m,).
        offsets: Its constant part (m,) [rad or m].
        lower: Least values of q (n,); −inf where there is none.
        upper: Greatest values of q (n,); +inf where there is none.
    """

    rotations: Floats
    translations: Floats
    tool_rotation: Floats
    tool_translation: Floats
    prismatic: NDArray[np.int64]
    columns: NDArray[np.int64]
    multipliers: Floats
    offsets: Floats
    lower: Floats
    upper: Floats


class PathJoint(NamedTuple):
    """One physical joint for `joint_path`: where it is, and how q moves it.

    Attributes:
        placement: Fixed transform (4, 4) from the previous joint's frame (the base, for the first) to this joint's.
        axis: Unit axis in this joint's frame (3,).
        prismatic: Whether it slides along its axis instead of turning about it.
        column: The column of q that moves it.
        multiplier: Its factor.
        offset: Its constant part [rad or m].
    """

    placement: Floats
    axis: Floats
    prismatic: bool
    column: int
    multiplier: float = 1.0
    offset: float = 0.0


def joint_path(joints: Iterable[PathJoint], tool: Floats, lower: Floats, upper: Floats) -> JointPath:
    """Lowers joints with arbitrary axes to a `JointPath`, turning each joint's frame so that its axis is z.

    Args:
        joints: The physical joints, base to tip.
        tool: Fixed transform (4, 4) from the last joint's frame to the tip.
        lower: Least values of q (n,).
        upper: Greatest values of q (n,).
    """
    joints = list(joints)
    undo, placements = np.eye(4), []
    for joint in joints:
        align = np.eye(4)
        align[:3, :3] = _z_to(np.asarray(joint.axis, dtype=np.float64))
        placements.append(undo @ joint.placement @ align)
        undo = align.T
    end = undo @ tool
    return JointPath(
        rotations=np.ascontiguousarray([P[:3, :3] for P in placements]),
        translations=np.ascontiguousarray([P[:3, 3] for P in placements]),
        tool_rotation=np.ascontiguousarray(end[:3, :3]),
        tool_translation=np.ascontiguousarray(end[:3, 3]),
        prismatic=np.array([int(joint.prismatic) for joint in joints], dtype=np.int64),
        columns=np.array([joint.column for joint in joints], dtype=np.int64),
        multipliers=np.array([joint.multiplier for joint in joints], dtype=np.float64),
        offsets=np.array([joint.offset for joint in joints], dtype=np.float64),
        lower=np.array(lower, dtype=np.float64),
        upper=np.array(upper, dtype=np.float64),
    )


def held(path: JointPath, values: Mapping[int, float]) -> JointPath:
    """The path with some columns of q held at a value [rad or m]; the other columns move up.

    Raises:
        ValueError: No column is left.
    """
    kept = [column for column in range(len(path.lower)) if column not in values]
    number = {column: i for i, column in enumerate(kept)}
    moving = [k for k, column in enumerate(path.columns.tolist()) if column in number]
    if not moving:
        raise ValueError(values)
    before, placements = np.eye(4), []
    for k, column in enumerate(path.columns.tolist()):
        here = before @ homogeneous(path.rotations[k], path.translations[k])
        if column in number:
            placements.append(here)
            before = np.eye(4)
        else:
            value = path.multipliers[k] * values[column] + path.offsets[k]
            before = here @ along_z(value, slides=bool(path.prismatic[k]))
    tool = before @ homogeneous(path.tool_rotation, path.tool_translation)
    return JointPath(
        rotations=np.ascontiguousarray([P[:3, :3] for P in placements]),
        translations=np.ascontiguousarray([P[:3, 3] for P in placements]),
        tool_rotation=np.ascontiguousarray(tool[:3, :3]),
        tool_translation=np.ascontiguousarray(tool[:3, 3]),
        prismatic=path.prismatic[moving],
        columns=np.array([number[column] for column in path.columns[moving].tolist()], dtype=np.int64),
        multipliers=path.multipliers[moving],
        offsets=path.offsets[moving],
        lower=path.lower[kept],
        upper=path.upper[kept],
    )


def homogeneous(R: Floats, t: Floats) -> Floats:
    """The matrix (4, 4) of a rotation (3, 3) and a translation (3,)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def along_z(value: float, *, slides: bool) -> Floats:
    """Trans_z(value) or Rot_z(value), (4, 4)."""
    T = np.eye(4)
    if slides:
        T[2, 3] = value
    else:
        c, s = np.cos(value), np.sin(value)
        T[:2, :2] = [[c, -s], [s, c]]
    return T


def _z_to(axis: Floats) -> Floats:
    """A rotation (3, 3) that turns z into the unit axis; exact where the axis is a coordinate axis."""
    # Any frame with this z will do: cross with the coordinate axis that is least parallel to it.
    helper = np.eye(3)[int(np.abs(axis).argmin())]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])
