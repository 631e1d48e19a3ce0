"""A chain as the lines its joints turn about, and the common normals between consecutive lines.

Lines are what a chain is made of, whatever frames are drawn on it: two lines have a distance and an angle, and along
each inner line there is the offset between the normals to its two neighbours. Denavit and Hartenberg 1955 describe a
chain by these numbers and the joint angles between the normals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.kernels.joint_path import along_z, homogeneous

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["PARALLEL", "JointLines", "Normals", "joint_lines", "normals"]

PARALLEL = 1e-8
"""Lines whose directions differ by less [rad] count as parallel. Their common normal would lie some 10⁸ lengths away,
where double precision has as little left as the angle itself is worth."""

_COINCIDENT = 1e-12  # [m] parallel lines this near have no normal of their own


@dataclass(frozen=True, eq=False, slots=True)
class JointLines:
    """The joints of a chain at q = 0, in the base frame.

    Attributes:
        points: A point on each joint's line (n, 3) [m].
        directions: Unit direction of each line (n, 3), about which q turns positively or along which it slides.
        slides: Whether the joint slides (n,).
        T_base_tip: Pose of the tip (4, 4).
    """

    points: Floats
    directions: Floats
    slides: Any
    T_base_tip: Floats


def joint_lines(path: JointPath, name: str) -> JointLines:
    """The lines of a chain in which every joint has a column of its own.

    Args:
        path: The flat form of the chain.
        name: What to call the chain in messages.

    Raises:
        InvalidInputError: Coupled joints: one number moves several lines.
    """
    n = len(path.lower)
    if list(path.columns) != list(range(n)) or np.abs(np.abs(path.multipliers) - 1.0).max() > 0.0:
        got = f"coupled joints ({len(path.columns)} joints on {n} columns)"
        raise InvalidInputError(f"{name}", "a chain in which every joint has a value of its own", got)
    T, points, directions = np.eye(4), [], []
    for k in range(n):
        T = T @ homogeneous(path.rotations[k], path.translations[k])
        points.append(T[:3, 3])
        directions.append(path.multipliers[k] * T[:3, 2])
        T = T @ along_z(path.offsets[k], slides=bool(path.prismatic[k]))
    tip = T @ homogeneous(path.tool_rotation, path.tool_translation)
    return JointLines(np.array(points), np.array(directions), path.prismatic.astype(bool), tip)


@dataclass(frozen=True, eq=False, slots=True)
class Normals:
    """The common normals of consecutive lines, numbered from 0; normal k leads from line k to line k + 1.

    A normal's direction is such that the angle between its lines is in [0, π], so the distance has a sign. Parallel
    lines have a normal everywhere; theirs starts where the previous one ends, or, at the beginning of the chain, ends
    where the next one starts.

    Attributes:
        origins: Where normal k leaves line k (n, 3) [m]; for the last line, where the last normal ends.
        ends: Where normal k − 1 arrives on line k (n, 3) [m]; for the first line, the same as its origin.
        x: Direction of normal k (n, 3); the last line inherits that of the last normal.
        distances: Signed distances between lines k and k + 1 along x (n − 1,) [m].
        angles: Angles between their directions (n − 1,) [rad].
        parallel: Whether they are parallel (n − 1,).
        offsets: From end to origin along line k (n,) [m].
        turns: From the previous normal to normal k about line k (n,) [rad]; 0 for the first line.
    """

    origins: Floats
    ends: Floats
    x: Floats
    distances: Floats
    angles: Floats
    parallel: Any
    offsets: Floats
    turns: Floats


def normals(points: Floats, directions: Floats) -> Normals:
    """The common normals of lines given by points (n, 3) [m] and unit directions (n, 3)."""
    n = len(points)
    origins, ends = np.full((n, 3), np.nan), np.full((n, 3), np.nan)
    crossings = [_crossing(points[k : k + 2], directions[k : k + 2]) for k in range(n - 1)]
    for k, crossing in enumerate(crossings):
        if crossing is not None:
            origins[k], ends[k + 1] = crossing
    _settle_parallel(points, directions, origins, ends)
    x = _directions(directions, origins, ends, np.array([c is None for c in crossings]))
    between = ends[1:] - origins[:-1]
    turned = [_angle(x[k - 1], x[k], directions[k]) for k in range(1, n)]
    return Normals(
        origins=origins,
        ends=ends,
        x=x,
        distances=np.einsum("ki,ki->k", between, x[:-1]),
        angles=np.array([abs(_angle(directions[k], directions[k + 1], x[k])) for k in range(n - 1)]),
        parallel=np.array([c is None for c in crossings], dtype=bool),
        offsets=np.einsum("ki,ki->k", origins - ends, directions),
        turns=np.array([0.0, *turned]),
    )


def _crossing(points: Floats, directions: Floats) -> tuple[Floats, Floats] | None:
    """Where the common normal of two lines leaves the first and meets the second; None if they are parallel."""
    across = np.cross(directions[0], directions[1])
    sine = float(np.linalg.norm(across))
    if sine < PARALLEL:
        return None
    between = points[1] - points[0]
    s = float(np.dot(np.cross(between, directions[1]), across)) / sine**2
    t = float(np.dot(np.cross(between, directions[0]), across)) / sine**2
    return points[0] + s * directions[0], points[1] + t * directions[1]


def _settle_parallel(points: Floats, directions: Floats, origins: Floats, ends: Floats) -> None:
    """Fills in the places that parallel lines leave open."""
    n = len(points)
    known = [k for k in range(n - 1) if not np.isnan(origins[k, 0])]
    first = known[0] if known else n - 1
    if not known:
        origins[first] = _foot(points[first], directions[first], np.zeros(3))
    for k in range(first, 0, -1):  # backwards from the first normal that has a place
        ends[k] = origins[k]
        origins[k - 1] = _foot(points[k - 1], directions[k - 1], ends[k])
    ends[0] = origins[0]
    for k in range(first, n):
        if np.isnan(origins[k, 0]):
            origins[k] = ends[k]
        if k + 1 < n and np.isnan(ends[k + 1, 0]):
            ends[k + 1] = _foot(points[k + 1], directions[k + 1], origins[k])


def _directions(directions: Floats, origins: Floats, ends: Floats, parallel: Any) -> Floats:
    """Unit directions of the normals (n, 3)."""
    n = len(directions)
    x = np.full((n, 3), np.nan)
    for k in range(n - 1):
        if not parallel[k]:
            across = np.cross(directions[k], directions[k + 1])
            x[k] = across / np.linalg.norm(across)
            continue
        between = ends[k + 1] - origins[k]
        length = float(np.linalg.norm(between))
        if length > _COINCIDENT:
            x[k] = between / length
        elif k > 0:
            x[k] = x[k - 1]
        else:
            x[k] = _any_across(directions[k])
    x[n - 1] = x[n - 2] if n > 1 else _any_across(directions[0])
    return x


def _foot(point: Floats, direction: Floats, of: Floats) -> Floats:
    foot: Floats = point + np.dot(of - point, direction) * direction
    return foot


def _any_across(direction: Floats) -> Floats:
    """A unit vector across a direction: the coordinate axis least along it, x before y before z, made square."""
    axis = np.eye(3)[int(np.argmin(np.round(np.abs(direction), 9)))]
    across = axis - np.dot(axis, direction) * direction
    unit: Floats = across / np.linalg.norm(across)
    return unit


def _angle(start: Floats, end: Floats, about: Floats) -> float:
    """Angle from start to end [rad], both across `about`, right-handed."""
    return math.atan2(float(np.dot(np.cross(start, end), about)), float(np.dot(start, end)))
