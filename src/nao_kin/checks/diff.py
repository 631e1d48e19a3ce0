"""Two descriptions of a robot: what differs in meaning, and by how much it moves the tips."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.se3 import from_xyz_rpy, position_distance, rotation_distance
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import Inertial, Limit, Origin, UrdfJoint, UrdfLink

__all__ = ["Difference", "RobotDifferences", "TipShift", "compare_robots"]

_POSTURES = 50
_LENGTH, _ANGLE = 1e-9, 1e-9  # [m, rad] what printed digits leave
_RELATIVE = 1e-9
_WIDE = math.pi


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that is not the same.

    Attributes:
        kind: ``link``, ``joint``, ``placement``, ``axis``, ``limit``, ``coupling``, ``mass`` or ``inertia``.
        name: Name of the link or joint.
        said: What differs, one sentence.
    """

    kind: str
    name: str
    said: str


@dataclass(frozen=True, slots=True)
class TipShift:
    """How far a tip is from where it was, the largest over zero and seeded postures within both ranges.

    Attributes:
        tip: The link, which nothing hangs on in either robot.
        position: [m].
        rotation: [rad].
    """

    tip: str
    position: float
    rotation: float


@dataclass(frozen=True)
class RobotDifferences:
    """What differs between two robots; nothing where they mean the same.

    Attributes:
        before: Name of the one.
        after: Name of the other.
        differences: In the order of the first robot's file.
        tips: Every tip that both have, whether it has moved or not.
    """

    before: str
    after: str
    differences: tuple[Difference, ...]
    tips: tuple[TipShift, ...] = field(default=())

    @property
    def same(self) -> bool:
        """Whether nothing differs in meaning."""
        return not self.differences

    def table(self) -> Table:
        """The differences, one a row."""
        rows = tuple((d.kind, d.name, d.said) for d in self.differences)
        title = f"{self.before} → {self.after}: {len(rows) or 'no'} difference{'' if len(rows) == 1 else 's'}"
        return Table((Column("what"), Column("of"), Column("how")), rows, title=title)

    def tip_table(self) -> Table:
        """How far each tip has moved, one a row."""
        rows = tuple((t.tip, f"{t.position * 1e3:.4g}", f"{t.rotation * 1e3:.4g}") for t in self.tips)
        columns = (Column("tip"), Column("moved by at most [mm]", number=True), Column("turned by [mrad]", number=True))
        return Table(columns, rows)

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def compare_robots(before: Robot, after: Robot) -> RobotDifferences:
    """What differs between two robots: links, joints, placements, axes, limits, couplings, masses and inertias.

    Names decide what is compared with what. Placements are compared as transforms, whatever words the files have for
    them, so that files of different versions or of other formats may be held against each other.
    """
    found = [*_links(before, after), *_joints(before, after)]
    return RobotDifferences(before.name, after.name, tuple(found), _tips(before, after))


def _links(before: Robot, after: Robot) -> Iterator[Difference]:
    ours, theirs = ({link.name: link for link in robot.document.links} for robot in (before, after))
    for name in [*ours, *(name for name in theirs if name not in ours)]:
        if name not in theirs or name not in ours:
            yield Difference("link", name, "is gone" if name not in theirs else "is new")
            continue
        yield from _inertias(ours[name], theirs[name])


def _inertias(ours: UrdfLink, theirs: UrdfLink) -> Iterator[Difference]:
    a, b = (_weight(link) for link in (ours, theirs))
    if not math.isclose(a.mass, b.mass, rel_tol=_RELATIVE, abs_tol=1e-12):
        yield Difference("mass", ours.name, f"{a.mass:.9g} → {b.mass:.9g} kg")
    if a.mass > 0.0 and b.mass > 0.0 and (apart := float(np.linalg.norm(a.lever - b.lever))) > _LENGTH:
        yield Difference("mass", ours.name, f"its centre of mass is {apart * 1e3:.4g} mm elsewhere")
    size = max(float(np.abs(a.inertia).max()), float(np.abs(b.inertia).max()))
    if (apart := float(np.abs(a.inertia - b.inertia).max())) > _RELATIVE * size:
        moments = [" ".join(f"{m:.4g}" for m in np.linalg.eigvalsh(body.inertia)) for body in (a, b)]
        yield Difference("inertia", ours.name, f"principal moments {moments[0]} → {moments[1]} kg m²")


def _weight(link: UrdfLink) -> pin.Inertia:
    """Mass, centre of mass and inertia about it, in the link's axes."""
    inertial: Inertial | None = link.inertial
    if inertial is None:
        return pin.Inertia.Zero()
    xx, xy, xz, yy, yz, zz = inertial.inertia
    about = pin.Inertia(inertial.mass, np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return about.se3Action(_placed(inertial.origin))


def _joints(before: Robot, after: Robot) -> Iterator[Difference]:
    ours, theirs = ({joint.name: joint for joint in robot.document.joints} for robot in (before, after))
    for name in [*ours, *(name for name in theirs if name not in ours)]:
        if name not in theirs or name not in ours:
            yield Difference("joint", name, "is gone" if name not in theirs else "is new")
            continue
        yield from _joint(ours[name], theirs[name])


def _joint(a: UrdfJoint, b: UrdfJoint) -> Iterator[Difference]:
    if a.kind != b.kind:
        yield Difference("joint", a.name, f"{a.kind} → {b.kind}")
    if (a.parent, a.child) != (b.parent, b.child):
        yield Difference("joint", a.name, f"between {a.parent} and {a.child} → between {b.parent} and {b.child}")
    T_parent_ours, T_parent_theirs = _placed(a.origin), _placed(b.origin)
    apart, turned = position_distance(T_parent_ours, T_parent_theirs), rotation_distance(T_parent_ours, T_parent_theirs)
    if apart > _LENGTH or turned > _ANGLE:
        yield Difference("placement", a.name, f"moved by {apart * 1e3:.4g} mm, turned by {turned * 1e3:.4g} mrad")
    moves = a.kind != "fixed" and b.kind != "fixed"
    if moves and (lean := math.acos(max(-1.0, min(1.0, float(np.dot(a.axis, b.axis)))))) > 1e-7:
        yield Difference("axis", a.name, f"leans by {lean * 1e3:.4g} mrad")
    if moves:
        yield from _limits(a.name, a.limit, b.limit)
    ours, theirs = ((m.joint, m.multiplier, m.offset) if (m := j.mimic) else None for j in (a, b))
    if ours != theirs:
        yield Difference("coupling", a.name, f"{_coupled(ours)} → {_coupled(theirs)}")


def _limits(name: str, a: Limit | None, b: Limit | None) -> Iterator[Difference]:
    for what in ("lower", "upper", "velocity", "effort", "acceleration", "deceleration", "jerk"):
        ours, theirs = (None if limit is None else getattr(limit, what) for limit in (a, b))
        if ours is None and theirs is None:
            continue
        if ours is None or theirs is None or not math.isclose(ours, theirs, rel_tol=_RELATIVE, abs_tol=1e-12):
            texts = ["none" if value is None else f"{value:.9g}" for value in (ours, theirs)]
            yield Difference("limit", name, f"{what} {texts[0]} → {texts[1]}")


def _coupled(mimic: tuple[str, float, float] | None) -> str:
    return "free" if mimic is None else f"{mimic[1]:.6g} · {mimic[0]} + {mimic[2]:.6g}"


def _placed(origin: Origin) -> pin.SE3:
    return from_xyz_rpy(origin.xyz, origin.rpy)


def _tips(before: Robot, after: Robot) -> tuple[TipShift, ...]:
    shared = [tip for tip in _ends(before) if tip in _ends(after)]
    worst = dict.fromkeys(shared, (0.0, 0.0))
    for posture in _postures(before, after):
        ours, theirs = before.link_poses(posture), after.link_poses(posture)
        for tip in shared:
            a, b = worst[tip]
            apart = position_distance(ours[tip], theirs[tip]), rotation_distance(ours[tip], theirs[tip])
            worst[tip] = max(a, apart[0]), max(b, apart[1])
    return tuple(TipShift(tip, *apart) for tip, apart in worst.items())


def _ends(robot: Robot) -> list[str]:
    parents = {joint.parent for joint in robot.document.joints}
    return [link.name for link in robot.document.links if link.name not in parents]


def _postures(before: Robot, after: Robot) -> Iterator[Mapping[str, float]]:
    """Zero, and seeded values of the joints that have a motor in both robots, within both ranges."""
    yield {}
    rng = np.random.default_rng(0)
    followers = {c.follower for robot in (before, after) for c in robot.couplings}
    ranges = [{joint.name: (joint.lower, joint.upper) for joint in r.stated_joints} for r in (before, after)]
    motors = [name for name in ranges[0] if name in ranges[1] and name not in followers]
    for _ in range(_POSTURES):
        posture = {}
        for name in motors:
            lower = max(ranges[0][name][0], ranges[1][name][0], -_WIDE)
            upper = min(ranges[0][name][1], ranges[1][name][1], _WIDE)
            if lower <= upper:
                posture[name] = float(rng.uniform(lower, upper))
        yield posture
