"""What two chains may differ in and still be the same arm: base, tool, joint signs and zero positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.crosscheck.wording import angle_text, length_text, transform_text
from nao_kin.dh.joint_lines import JointLines, Normals, joint_lines, normals
from nao_kin.se3 import position_distance, rotation_distance

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.dh.dh_chain import DHChain

__all__ = ["Gauge", "find_gauge", "lines_fit", "settled"]

_NEAR = 1e-8  # [m, rad] normals of nearly meeting lines carry less precision than the poses that decide in the end
_CHECKED = 12
_MOST_SIGNS = 4096  # patterns of joint directions that are tried


@dataclass(frozen=True, eq=False, slots=True)
class Gauge:
    """The second chain is base · (the first chain at sign · q + offset) · tool, at every q.

    Attributes:
        base: Constant transform in front.
        tool: Constant transform behind.
        signs: ±1 for each joint.
        offsets: For each joint [rad or m].
        joint_names: Names of the joints, for messages.
        slides: For each joint, whether it slides.
    """

    base: pin.SE3
    tool: pin.SE3
    signs: tuple[int, ...]
    offsets: tuple[float, ...]
    joint_names: tuple[str, ...]
    slides: tuple[bool, ...]

    def __str__(self) -> str:
        parts = []
        if (base := transform_text(self.base.rotation, self.base.translation)) != "identity":
            parts.append(f"base {base}")
        for k, name in enumerate(self.joint_names):
            words = []
            if self.offsets[k]:
                text = length_text(self.offsets[k]) if self.slides[k] else angle_text(self.offsets[k])
                words.append(f"offset {text}")
            if self.signs[k] < 0:
                words.append("sign -1")
            if words:
                parts.append(f"joint {k + 1} ({name}) {' '.join(words)}")
        if (tool := transform_text(self.tool.rotation, self.tool.translation)) != "identity":
            parts.append(f"tool {tool}")
        return ", ".join(parts) or "nothing"

    @property
    def size(self) -> int:
        """Number of things that differ: ends, signs and offsets."""
        ends = sum(not np.allclose(T.homogeneous, np.eye(4), rtol=0.0, atol=_NEAR) for T in (self.base, self.tool))
        return ends + sum(s < 0 for s in self.signs) + sum(bool(o) for o in self.offsets)

    def applied(self, table: DHChain) -> DHChain:
        """The first chain, as a table, with the difference taken out."""
        rows = []
        for row, sign, offset in zip(table.rows, self.signs, self.offsets, strict=True):
            shift = row.sign * offset
            slides = row.kind == "prismatic"
            d, theta = row.d + shift * slides, row.theta + shift * (not slides)
            rows.append(replace(row, sign=row.sign * sign, d=d, theta=theta))
        base, tool = self.base * table.base, table.tool * self.tool
        return replace(table, rows=tuple(rows), base=base, tool=tool, name=f"{table.name}, corrected")


def find_gauge(a: Chain, b: Chain, position: float, rotation: float) -> Gauge | None:
    """The gauge with the fewest parts that makes the first chain the second, or None if there is none.

    The lines of the two are put on each other for every pattern of directions that their distances and angles allow;
    whatever is returned was confirmed by the poses of both chains at random configurations.

    Args:
        a: The first chain; every joint has a value of its own.
        b: The second chain, likewise.
        position: How near two tips count as the same [m].
        rotation: How near two orientations count as the same [rad].

    Raises:
        InvalidInputError: Coupled joints.
    """
    lines_a, lines_b = settled(joint_lines(a.joint_path, a.name)), settled(joint_lines(b.joint_path, b.name))
    if list(lines_a.slides) != list(lines_b.slides):
        return None
    target = normals(lines_b.points, lines_b.directions)
    found = []
    for signs in islice(_sign_patterns(lines_a, target), _MOST_SIGNS):
        gauge = _gauge_with(a, b, lines_a, lines_b, target, signs)
        if gauge is not None and _confirmed(a, b, gauge, position, rotation):
            found.append(gauge)
    return min(found, key=lambda gauge: gauge.size, default=None)


def settled(lines: JointLines) -> JointLines:
    """The same chain with each sliding joint's line, which only has a direction, put where the previous normal ends."""
    points = lines.points.copy()
    for k in np.flatnonzero(lines.slides):
        if k >= 2:
            points[k] = normals(points[:k], lines.directions[:k]).origins[k - 1]
        elif k == 1:
            points[k] = points[0]
    return replace(lines, points=points)


def _sign_patterns(lines: JointLines, target: Normals) -> Iterator[Floats]:
    """Directions of the lines under which distances and angles of all consecutive lines are those of the target."""
    n = len(lines.points)

    def extended(signs: list[float]) -> Iterator[list[float]]:
        k = len(signs)
        if k == n:
            yield signs
            return
        for sign in (1.0, -1.0):
            pair = slice(k - 1, k + 1)
            directions = lines.directions[pair] * np.array([[signs[-1]], [sign]])
            two = normals(lines.points[pair], directions)
            distance = abs(two.distances[0]) if two.parallel[0] else two.distances[0]
            same = abs(two.angles[0] - target.angles[k - 1]) < _NEAR and bool(two.parallel[0]) == target.parallel[k - 1]
            if same and abs(distance - target.distances[k - 1]) < _NEAR:
                yield from extended([*signs, sign])

    for first in (1.0, -1.0):
        for signs in extended([first]):
            yield np.array(signs)


def lines_fit(lines_a: JointLines, lines_b: JointLines) -> bool:
    """Whether some pattern of directions puts the lines of one chain on those of another."""
    target = normals(lines_b.points, lines_b.directions)
    return any(
        _differences(lines_a, lines_a.directions * signs[:, None], target) is not None
        for signs in islice(_sign_patterns(lines_a, target), _MOST_SIGNS)
    )


def _differences(lines: JointLines, directions: Floats, target: Normals) -> Floats | None:
    """What joint values must be shifted by (n,) [rad or m] to put lines on the target; None if nothing does."""
    own = normals(lines.points, directions)
    # The first and the last joint have a neighbour on one side only: base and tool take what they are off by.
    turns, shifts = target.turns - own.turns, target.offsets - own.offsets
    turns[[0, -1]] = shifts[[0, -1]] = 0.0
    turns = np.array([_tidy(turn) for turn in turns])
    if np.abs(np.where(lines.slides, turns, shifts)).max() > _NEAR:
        return None
    return np.where(lines.slides, shifts, turns)


def _gauge_with(
    a: Chain, b: Chain, lines_a: JointLines, lines_b: JointLines, target: Normals, signs: Floats
) -> Gauge | None:
    directions = lines_a.directions * signs[:, None]
    differences = _differences(lines_a, directions, target)
    if differences is None:
        return None
    own = normals(lines_a.points, directions)
    base = _on_line(target, lines_b.directions, 0) * _on_line(own, directions, 0).inverse()
    # Offsets are those of the first chain's own q, which may run the other way.
    return _with_ends(a, b, base, signs, signs * differences, lines_a)


def _with_ends(a: Chain, b: Chain, base: pin.SE3, signs: Floats, offsets: Floats, lines: JointLines) -> Gauge:
    """The gauge with its tool; what base or tool do along an end joint becomes that joint's offset where it can."""
    n = len(signs)
    zero = np.zeros(n)
    T_b = b.pose(zero)
    if not lines.slides[0]:
        # base = (turn about the first line) alone: then the first joint's offset says the same.
        about = lines.directions[0]
        axis = pin.log3(base.rotation)
        angle = float(np.dot(axis, about))
        R = pin.exp3(angle * about)
        p = lines.points[0]
        turn = pin.SE3(R, p - R @ p)
        if abs(angle) > _NEAR and _is_identity(base * turn.inverse()):
            offsets = offsets.copy()
            offsets[0], base = _tidy(angle), pin.SE3.Identity()
    tool = (base * a.pose(offsets)).inverse() * T_b
    for step in () if lines.slides[-1] else (np.pi / 2, -np.pi / 2, np.pi):
        trial = offsets.copy()
        trial[-1] = _tidy(trial[-1] + step)
        other = (base * a.pose(trial)).inverse() * T_b
        if _is_identity(other) and not _is_identity(tool):
            offsets, tool = trial, other
    return Gauge(
        base=_clean(base),
        tool=_clean(tool),
        signs=tuple(int(s) for s in signs),
        offsets=tuple(0.0 if abs(o) < _NEAR else float(o) for o in offsets),
        joint_names=a.joint_names,
        slides=tuple(bool(s) for s in lines.slides),
    )


def _on_line(found: Normals, directions: Floats, k: int) -> pin.SE3:
    x, z = found.x[k], directions[k]
    return pin.SE3(np.column_stack([x, np.cross(z, x), z]), found.origins[k])


def _confirmed(a: Chain, b: Chain, gauge: Gauge, position: float, rotation: float) -> bool:
    rng = np.random.default_rng(1)
    signs, offsets = np.array(gauge.signs), np.array(gauge.offsets)
    for q in rng.uniform(-2.0, 2.0, (_CHECKED, len(signs))):
        T, wanted = gauge.base * a.pose(signs * q + offsets) * gauge.tool, b.pose(q)
        if position_distance(T, wanted) > position or rotation_distance(T, wanted) > rotation:
            return False
    return True


def _is_identity(T: pin.SE3) -> bool:
    return bool(np.allclose(T.homogeneous, np.eye(4), rtol=0.0, atol=_NEAR))


def _clean(T: pin.SE3) -> pin.SE3:
    """The transform without the rounding of the construction."""
    R = np.where(np.abs(T.rotation - np.round(T.rotation)) < 1e-12, np.round(T.rotation), T.rotation)
    p = np.where(np.abs(T.translation - np.round(T.translation, 9)) < 1e-13, np.round(T.translation, 9), T.translation)
    return pin.SE3(R + 0.0, p + 0.0)


def _tidy(angle: float) -> float:
    """The angle in (−π, π], at the multiple of 15° that it rounds to."""
    turned = float(np.remainder(angle, 2.0 * np.pi))
    turned = turned - 2.0 * np.pi if turned > np.pi + 1e-9 else turned
    nearest = round(turned / (np.pi / 12)) * np.pi / 12
    return nearest if abs(turned - nearest) < 1e-12 else turned
