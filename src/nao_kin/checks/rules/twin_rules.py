"""Left and right: which names are twins, and how the twins of a robot lie with every joint at 0."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    import pinocchio as pin

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["AXIS_NAMES", "Symmetry", "twins"]

AXIS_NAMES = ("x", "y", "z")

_POSITION = 5e-5  # [m] figures printed to a tenth of a millimetre are the same
_DIRECTION = 2e-3  # [rad]
_MAJORITY = 0.66  # of the twins are mirror images, or the robot is not meant to be symmetric
_FEWEST = 2
_WORDS_IN_A_NAME = 3

_SIDES = {
    "left": "right",
    "l": "r",
    "lf": "rf",
    "lm": "rm",
    "lr": "rr",
    "lh": "rh",
    "lb": "rb",  # left front, middle, rear, hind, back
    "fl": "fr",
    "ml": "mr",
    "rl": "rr",
    "hl": "hr",
    "bl": "br",
}
_OTHER: dict[str, tuple[str, ...]] = {left: (right,) for left, right in _SIDES.items()}
for _left, _right in _SIDES.items():
    _OTHER[_right] = (*_OTHER.get(_right, ()), _left)  # rear right is the twin of rl in one habit, of lr in another
_WORDS = "|".join(sorted(_OTHER, key=len, reverse=True))
# A word between other signs, or a capital before a capitalised word, or a capitalised word among others.
_SIDE = re.compile(
    rf"(?<![A-Za-z])(?:(?i:{_WORDS})(?![A-Za-z])|left(?=[A-Z])|right(?=[A-Z]))"
    r"|(?<![A-Z])[LR](?=[A-Z][a-z])|(?<![A-Za-z])[LR](?=[A-Z]{2})"
    r"|(?<=[a-z0-9])(?:[FMRHB][LR]|[LR][FMRHB])(?![A-Za-z])"
    r"|(?<![A-Z])(?:Left|Right)(?![a-z])"
)


def twins(names: Iterable[str]) -> dict[str, str]:
    """Right name by left name, for names that differ in their words for a side: LHand, left_hand, leg_lf, FL_hip.

    Where a name has several such words they change together, if there is such a name: in a mirror the front left
    sensor of the left foot is the front right one of the right foot.
    """
    known = list(names)
    there, found = set(known), dict[str, str]()
    for name in known:
        words = list(_SIDE.finditer(name))[:_WORDS_IN_A_NAME]
        if not words or words[0][0].lower() not in _SIDES:
            continue
        candidates = [*_changed(name, words), *(other for word in words for other in _changed(name, [word]))]
        other = next((candidate for candidate in candidates if candidate in there), "")
        if other:
            found[name] = other
    return found


def _changed(name: str, words: list[re.Match[str]]) -> Iterator[str]:
    """The name with these words for a side turned into their opposites, in every way there is."""
    for sides in product(*(_OTHER[word[0].lower()] for word in words)):
        other = name
        for match, side in reversed(list(zip(words, sides, strict=True))):
            word = match[0]
            cased = side.upper() if word.isupper() else side.capitalize() if word[0].isupper() else side
            other = other[: match.start()] + cased + other[match.end() :]
        yield other


@dataclass(frozen=True)
class Symmetry:
    """How the twin joints of a robot lie with every joint at 0.

    Attributes:
        robot: The robot.
        pairs: Right joint by left joint, fixed ones included.
    """

    robot: Robot
    pairs: Mapping[str, str]

    @classmethod
    def of(cls, robot: Robot) -> Symmetry:
        """The symmetry of the joints that are twins by name."""
        return cls(robot, twins(joint.name for joint in robot.document.joints))

    @cached_property
    def plane(self) -> int | None:
        """The axis of the root frame that changes sign; None where the robot is not meant to be symmetric."""
        fits = []
        for axis in range(3):
            # Sensors and other fixed frames may sit where there is room for them; what moves decides.
            moving = [alike for left, alike in self.verdicts(axis).items() if self._moves(left)]
            fits.append((moving.count(True), axis, len(moving)))
        good, axis, judged = max(fits)
        return axis if good >= _FEWEST and good >= _MAJORITY * judged else None

    def verdicts(self, axis: int) -> dict[str, bool]:
        """Whether the twin of each left joint lies where it should; what is behind one that does not is not judged."""
        found: dict[str, bool] = {}
        spoilt: set[str] = set()
        for left in self._from_the_root:
            a, b = self.twin_joints(left)
            if a.parent in spoilt or not self._same_place(a.parent, b.parent):
                spoilt.add(a.child)
                continue
            found[left] = self.placed_alike(left, axis) and self.turned_alike(left, axis) is not None
            if not found[left]:
                spoilt.add(a.child)
        return found

    def twin_joints(self, left: str) -> tuple[UrdfJoint, UrdfJoint]:
        """A left joint and its twin."""
        return self.robot.document.joint(left), self.robot.document.joint(self.pairs[left])

    def placed_alike(self, left: str, axis: int) -> bool:
        """Whether the steps from the parents' origins to the two joints are mirror images."""
        a, b = self.twin_joints(left)
        return bool(np.abs(_mirror(axis) @ self._step(a) - self._step(b)).max() <= _POSITION)

    def turned_alike(self, left: str, axis: int) -> float | None:
        """+1 or -1: the right axis is that times the mirror image of the left one; None if it is neither."""
        a, b = self.twin_joints(left)
        if a.kind == "fixed" and b.kind == "fixed":
            return 1.0
        image = _mirror(axis) @ self._poses[a.child].rotation @ np.array(a.axis)
        other = self._poses[b.child].rotation @ np.array(b.axis)
        sign = 1.0 if image @ other >= 0.0 else -1.0
        return sign if a.kind == b.kind and np.abs(image - sign * other).max() <= _DIRECTION else None

    def mirrored_range(self, left: str, sign: float) -> tuple[float, float]:
        """The range that the twin of a moving left joint has in a mirror, for a sign of `turned_alike`."""
        joint = self.robot.document.joint(left)
        limit = joint.limit
        lower, upper = (0.0, 0.0) if limit is None else (limit.lower or 0.0, limit.upper or 0.0)
        # A mirror turns rotations round, but not displacements.
        keeps = sign < 0.0 if joint.kind != "prismatic" else sign > 0.0
        return (lower, upper) if keeps else (0.0 - upper, 0.0 - lower)

    def _moves(self, left: str) -> bool:
        return self.robot.document.joint(left).kind != "fixed"

    def _step(self, joint: UrdfJoint) -> Floats:
        """From the parent's origin to the joint's, in the axes of the root."""
        step: Floats = self._poses[joint.child].translation - self._poses[joint.parent].translation
        return step

    def _same_place(self, left: str, right: str) -> bool:
        return left == right or (left, right) in self._twin_links

    @cached_property
    def _twin_links(self) -> set[tuple[str, str]]:
        return {(a.child, b.child) for a, b in map(self.twin_joints, self.pairs)}

    @cached_property
    def _poses(self) -> dict[str, pin.SE3]:
        return self.robot.link_poses({})

    @cached_property
    def _from_the_root(self) -> list[str]:
        """The left joints, each after those above it."""
        above = {joint.child: joint.parent for joint in self.robot.document.joints}

        def depth(link: str) -> int:
            steps = 0
            while link in above:
                link, steps = above[link], steps + 1
            return steps

        return sorted(self.pairs, key=lambda left: depth(self.robot.document.joint(left).child))


def _mirror(axis: int) -> Floats:
    mirror = np.eye(3)
    mirror[axis, axis] = -1.0
    return mirror
