"""Rules about a robot running into itself, on its boxes, cylinders, capsules and spheres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.checks.rules.pose_rules import sample_postures
from nao_kin.robot.pinocchio_layout import PinocchioLayout
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.outline import Defect, children, describe, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nao_kin.checks.subject import Subject
    from nao_kin.robot.robot import Robot

__all__ = ["self_collisions"]

_POSTURES = (8, 40)
_PAIRS = 8000  # over all postures: what one file may cost
_OFTEN = 0.5
_MOST_SOLIDS = 120  # the pairs grow with the square of their number


def self_collisions(subject: Subject) -> Iterator[Defect]:
    """No two links that are not neighbours overlap at zero, nor at most random postures within the limits."""
    solids = _Solids.of(subject.robot)
    if solids is None:
        return
    count = min(max(_PAIRS // len(solids.link_pairs), _POSTURES[0]), _POSTURES[1])
    at_zero, _, _, *inside = sample_postures(subject.robot, count)
    overlapping = solids.overlapping(at_zero)
    for above, below in sorted(overlapping):
        message = f"The {describe(subject.link(below))} and the link {shown(above)} overlap with every joint at 0."
        at = children(subject.link(below), "collision")[0]
        yield Defect("self-collision", at, message, "Are the collision shapes too large, or an origin wrong?")
    solids.forget(overlapping)
    hits = sum(map(solids.collides, inside))
    if hits > _OFTEN * count:
        message = f"The robot runs into itself at {hits} of {count} random postures within its limits."
        hint = "Planners will reject most of what they try; are the limits too wide or the shapes too large?"
        yield Defect("often-in-collision", subject.outline.root, message, hint, "name")


@dataclass(frozen=True)
class _Solids:
    """The collision shapes of a robot and the pairs of them that may not touch, as Pinocchio takes them."""

    robot: Robot
    geometry: pin.GeometryModel
    link_pairs: list[tuple[str, str]]

    @classmethod
    def of(cls, robot: Robot) -> _Solids | None:
        """None where there is nothing that could touch, or too much to try."""
        from nao_kin.collision.shapes import coal_shape  # coal takes a moment to load

        model, geometry, links = robot.model, pin.GeometryModel(), list[str]()
        for link in robot.document.links:
            frame = model.frames[model.getFrameId(link.name, pin.FrameType.BODY)]
            for solid in link.collisions:
                shape = coal_shape(solid.shape)
                if shape is not None:
                    T_link_solid = from_xyz_rpy(solid.origin.xyz, solid.origin.rpy)
                    placement = frame.placement * T_link_solid
                    name = f"{link.name}/{len(links)}"
                    geometry.addGeometryObject(pin.GeometryObject(name, frame.parentJoint, placement, shape))
                    links.append(link.name)
        if not 2 <= len(links) <= _MOST_SOLIDS:
            return None
        neighbours = _neighbours(model, geometry)
        pairs = []
        for i, j in zip(*np.triu_indices(len(links), 1), strict=True):
            ends = {geometry.geometryObjects[int(k)].parentJoint for k in (i, j)}
            if len(ends) == 2 and frozenset(ends) not in neighbours:
                geometry.addCollisionPair(pin.CollisionPair(int(i), int(j)))
                pairs.append((links[i], links[j]))
        return cls(robot, geometry, pairs) if pairs else None

    def overlapping(self, posture: Mapping[str, float]) -> set[tuple[str, str]]:
        """The pairs of links that overlap at a posture."""
        data = pin.GeometryData(self.geometry)
        self._collides(posture, data, stop_at_first=False)
        hit = (result.isCollision() for result in data.collisionResults)
        return {links for links, touches in zip(self.link_pairs, hit, strict=True) if touches}

    def forget(self, links: set[tuple[str, str]]) -> None:
        """Do not look at these pairs of links any more."""
        for pair, names in reversed(list(zip(self.geometry.collisionPairs.tolist(), self.link_pairs, strict=True))):
            if names in links:
                self.geometry.removeCollisionPair(pair)
                self.link_pairs.remove(names)

    def collides(self, posture: Mapping[str, float]) -> bool:
        """Whether any pair overlaps at a posture."""
        return self._collides(posture, pin.GeometryData(self.geometry), stop_at_first=True)

    def _collides(self, posture: Mapping[str, float], data: pin.GeometryData, *, stop_at_first: bool) -> bool:
        model, names = self.robot.model, self.robot.joint_names
        values = self.robot.expand(posture)
        q = PinocchioLayout.of(model, names).q(np.array([values[name] for name in names]))
        return bool(pin.computeCollisions(model, model.createData(), self.geometry, data, q, stop_at_first))


def _neighbours(model: pin.Model, geometry: pin.GeometryModel) -> set[frozenset[int]]:
    """Pairs of moving parts with no other part that has a shape between them: they meet in a joint and may overlap."""
    shaped = {body.parentJoint for body in geometry.geometryObjects}
    found: set[frozenset[int]] = set()
    nearest: dict[int, int | None] = {0: 0 if 0 in shaped else None}
    for joint in range(1, model.njoints):
        above = model.parents[joint]
        met = above if above in shaped else nearest[above]
        nearest[joint] = met
        if met is not None:
            found.add(frozenset({joint, met}))
    # Parts that hang on the same one without a shape meet there too.
    hanging: dict[int, list[int]] = {}
    for joint in range(1, model.njoints):
        if joint in shaped and model.parents[joint] not in shaped:
            hanging.setdefault(model.parents[joint], []).append(joint)
    for group in hanging.values():
        found.update(frozenset({a, b}) for a in group for b in group if a != b)
    return found
