"""Where two chains stop being the same arm, whatever frames they are written in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.crosscheck.gauge import lines_fit, settled
from nao_kin.crosscheck.wording import angle_text, length_text
from nao_kin.dh.joint_lines import JointLines, Normals, joint_lines, normals

if TYPE_CHECKING:
    from nao_kin.chain import Chain

__all__ = ["AxisPair", "LineFigures", "first_pair"]

_MEETING = 1e-9  # [m] lines that come nearer meet, and their angle has no hand


@dataclass(frozen=True, slots=True)
class LineFigures:
    """How one joint's line lies to the one before; no choice of frames, zero positions or joint senses changes these.

    Attributes:
        distance: Shortest distance of the two lines [m].
        angle: Angle between the lines [rad], in (−π/2, π/2]; its sign is the hand of the screw that leads from one to
            the other, and there is none where lines meet.
        offset: Distance along the first of the two lines between the normals to its two neighbours [m]; over a run of
            parallel lines that ends here, all of the run's distance along it. None where this normal has no place of
            its own because the two lines are parallel, and before any normal that has one.
    """

    distance: float
    angle: float
    offset: float | None

    def __str__(self) -> str:
        offset = "" if self.offset is None else f", offset {length_text(self.offset)}"
        return f"distance {length_text(self.distance)}, angle {angle_text(self.angle)}{offset}"


@dataclass(frozen=True, slots=True)
class AxisPair:
    """The first two consecutive joints that no gauge can make equal.

    The joints before the second one are the same arm in both chains, up to base, senses and zero positions; with it
    they are not.

    Attributes:
        joints: Their names, in the second chain.
        a: The figures of the first chain.
        b: The figures of the second chain.
    """

    joints: tuple[str, str]
    a: LineFigures
    b: LineFigures

    def __str__(self) -> str:
        return f"{self.joints[0]} and {self.joints[1]}: {self.a} | {self.b}"


def first_pair(a: Chain, b: Chain) -> AxisPair | None:
    """The first pair of consecutive joints that no gauge makes equal; None if there is none.

    Two chains without such a pair are the same arm up to base, tool, signs and zero positions.

    Args:
        a: The first chain; every joint has a value of its own.
        b: The second chain, likewise.

    Raises:
        InvalidInputError: Coupled joints.
    """
    lines_a, lines_b = settled(joint_lines(a.joint_path, a.name)), settled(joint_lines(b.joint_path, b.name))
    for count in range(2, len(a.joints) + 1):
        parts = [_first(lines, count) for lines in (lines_a, lines_b)]
        if list(parts[0].slides) != list(parts[1].slides) or not lines_fit(*parts):
            k = count - 2
            figures = [_figures(normals(part.points, part.directions), k) for part in parts]
            return AxisPair((b.joint_names[k], b.joint_names[k + 1]), *figures)
    return None


def _first(lines: JointLines, count: int) -> JointLines:
    return replace(lines, points=lines.points[:count], directions=lines.directions[:count], slides=lines.slides[:count])


def _figures(found: Normals, k: int) -> LineFigures:
    distance, angle = float(found.distances[k]), float(found.angles[k])
    # Turning a line round adds π; turning the normal round changes the signs of distance and angle together.
    angle = math.copysign(1.0, distance) * angle if abs(distance) > _MEETING else angle
    angle = angle - math.pi * np.ceil(angle / math.pi - 0.5 - 1e-12)
    if abs(distance) <= _MEETING or found.parallel[k]:
        angle = abs(angle)
    placed = not found.parallel[k] and not found.parallel[:k].all()
    return LineFigures(abs(distance), float(angle) + 0.0, abs(float(found.offsets[k])) if placed else None)
