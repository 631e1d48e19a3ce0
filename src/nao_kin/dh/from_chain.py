"""From any chain to a Denavit-Hartenberg table that moves the same way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.chain import random_configurations
from nao_kin.dh.dh_chain import DHChain
from nao_kin.dh.dh_row import Convention, DHRow, known_convention
from nao_kin.dh.joint_lines import Normals, joint_lines, normals
from nao_kin.errors import InvalidInputError
from nao_kin.kernels.joint_path import homogeneous
from nao_kin.se3 import nearest_rotation, position_distance, rotation_distance
from nao_kin.tolerances import TOLERANCES

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["to_dh"]

_CHECKED = 16  # configurations at which the table is held against the chain
_SNAP = 1e-14  # [rad, m] rounding that hides a round number


def to_dh(chain: Chain, convention: Convention = "standard") -> DHChain:
    """A DH table that has the chain's pose at every configuration, with the same joint names, limits and speeds.

    The frames lie on the common normals of consecutive joint lines (Denavit and Hartenberg 1955); lines that are
    parallel leave one length open, which is put at 0. What the two ends need beyond four numbers a row stands in the
    table's base and tool; the base is the identity where the first joint's line is the base frame's z axis. The table
    is held against the chain before it is returned.

    Args:
        chain: Any chain in which every joint has a value of its own.
        convention: ``"standard"`` or ``"modified"``.

    Returns:
        The table, one row a joint; lengths in metres, angles in radians.

    Raises:
        InvalidInputError: Unknown convention; coupled joints, for which a table has no column; or lines so nearly, but
            not quite, parallel that lengths of many kilometres would be needed, which double precision cannot hold.
    """
    known_convention(convention)
    lines = joint_lines(chain.joint_path, chain.name)
    n = len(chain.joints)
    found = normals(lines.points, lines.directions)
    frames = _frames(found, lines.directions)
    base = _base(frames[0])
    places = [base, *frames] if convention == "modified" else [base, *_distal(found, lines.directions, frames)]
    rows = [_row(np.linalg.inv(places[k]) @ places[k + 1], convention) for k in range(n)]
    tool = np.linalg.inv(places[n]) @ lines.T_base_tip
    table = DHChain(
        rows=tuple(
            DHRow(a, alpha, d, theta, 1, j.name, j.kind, j.lower, j.upper, j.max_velocity)
            for (a, alpha, d, theta), j in zip(rows, chain.joints, strict=True)
        ),
        convention=convention,
        base=pin.SE3(base),
        tool=_rigid(tool),
        name=f"{chain.name}, {convention} DH",
        base_name=chain.base_name,
        tip_name=chain.tip_name,
    )
    return _checked(table, chain)


def _frames(found: Normals, directions: Floats) -> list[Floats]:
    """A frame on each line: z along it, x along the normal to the next one, turned so that θ stays within ±π/2."""
    frames, previous = [], found.x[0]
    for k, z in enumerate(directions):
        x = found.x[k]
        if k == 0 and x[int(np.argmax(np.abs(x)))] < 0.0:
            x = -x  # the base's side, where there is a choice
        if k > 0 and np.dot(x, previous) < -1e-9:
            x = -x
        frames.append(_frame(x, z, found.origins[k]))
        previous = x
    return frames


def _frame(x: Floats, z: Floats, origin: Floats) -> Floats:
    return homogeneous(np.column_stack([x, np.cross(z, x), z]), origin)


def _base(first: Floats) -> Floats:
    """The table's base: the base frame itself if the first line is its z axis, else a frame on the first line."""
    on_z = np.abs(first[:2, 3]).max() <= _SNAP and np.abs(first[:2, 2]).max() <= _SNAP and first[2, 2] > 0.0
    return np.eye(4) if on_z else first


def _distal(found: Normals, directions: Floats, frames: list[Floats]) -> list[Floats]:
    """Frames 1…n of a standard table: frame k lies on line k + 1, with the x of normal k; the last one stays."""
    n = len(frames)
    moved = [_frame(frames[k][:3, 0], directions[k + 1], found.ends[k + 1]) for k in range(n - 1)]
    return [*moved, frames[-1]]


def _row(A: Floats, convention: Convention) -> tuple[float, float, float, float]:
    """(a, alpha, d, theta) of a matrix that has the form of a row."""
    if convention == "modified":  # Rx(α) Tx(a) Rz(θ) Tz(d)
        alpha, theta = math.atan2(-A[1, 2], A[2, 2]), math.atan2(-A[0, 1], A[0, 0])
        a, d = A[0, 3], float(np.dot(A[:3, 2], A[:3, 3]))
    else:  # Rz(θ) Tz(d) Tx(a) Rx(α)
        alpha, theta = math.atan2(A[2, 1], A[2, 2]), math.atan2(A[1, 0], A[0, 0])
        a, d = float(np.dot(A[:3, 0], A[:3, 3])), A[2, 3]
    return _snapped(a), _snapped_angle(alpha), _snapped(d), _snapped_angle(theta)


def _snapped(value: float) -> float:
    value = float(value)
    nearest = round(value, 12)
    return nearest + 0.0 if abs(value - nearest) <= _SNAP else value


def _snapped_angle(value: float) -> float:
    """The angle, or the multiple of 15° that it rounds to."""
    nearest = round(value / (math.pi / 12)) * math.pi / 12
    if abs(value - nearest) > _SNAP:
        return float(value)
    return math.pi if nearest <= -math.pi + 1e-9 else nearest + 0.0


def _rigid(T: Floats) -> pin.SE3:
    """A product of rigid matrices without the rounding of its rotation part."""
    rounded = np.round(T[:3, :3])
    R = np.where(np.abs(T[:3, :3] - rounded) <= _SNAP, rounded, nearest_rotation(T[:3, :3]))
    return pin.SE3(R + 0.0, T[:3, 3] + 0.0)


def _checked(table: DHChain, chain: Chain) -> DHChain:
    Q = random_configurations(chain, _CHECKED, np.random.default_rng(0))
    pairs = [(table.pose(q), chain.pose(q)) for q in Q]
    position = max(position_distance(*pair) for pair in pairs)
    rotation = max(rotation_distance(*pair) for pair in pairs)
    if position > TOLERANCES.agreement_position or rotation > TOLERANCES.agreement_rotation:
        got = f"lines so nearly parallel that a table misses by {position:.2g} m and {rotation:.2g} rad"
        raise InvalidInputError(chain.name, "joint lines that are parallel or clearly not", got)
    return table
