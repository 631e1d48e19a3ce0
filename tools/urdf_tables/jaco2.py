"""Kinova JACO2, six joints, bent (non-spherical) wrist, three fingers: the model j2n6s300.

Source: j2n6s300.xacro and kinova_inertial.xacro of Kinovarobotics/kinova-ros (kinova_description/urdf). Every joint
turns about its own z. The shapes are drawn by us; no vendor mesh is used.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from urdf_tables import jaco2_shapes
from urdf_tables.inertia import cylinder
from urdf_tables.model import Joint, Limit, Link, Pose, Robot, Z

if TYPE_CHECKING:
    from urdf_tables.model import AxisName, Inertial, Triple

NAMES: tuple[str, ...] = ("jaco2",)
_PI = math.pi
_HEADER = (
    "Kinova JACO2, six joints, bent wrist, three fingers (j2n6s300).",
    "Sources: origins, limits, speeds, efforts, masses and centres of mass from j2n6s300.xacro and "
    "kinova_inertial.xacro of Kinovarobotics/kinova-ros. Angles are written to full precision where the source says "
    "pi/2 or pi/3, degrees likewise.",
    "Decisions: the root is link_base, the tool frame end_effector. Joint and link names are the published ones "
    "without the prefix j2n6s300_. Joints 1, 4, 5 and 6 turn without end. The fingers are drawn as part of link_6 and "
    "have no joints. The inertias are those of homogeneous cylinders, computed from the mass and the published "
    "cylinder of each part. The shapes are drawn by us from primitives; no vendor mesh is used.",
)

# Joint origin, lower and upper [deg] or None, speed [deg/s], effort [N m].
_Row = tuple["Triple", "Triple", tuple[float, float] | None, float, float]
_JOINTS: tuple[_Row, ...] = (
    ((0.0, 0.0, 0.15675), (0.0, _PI, 0.0), None, 36, 40.0),
    ((0.0, 0.0016, -0.11875), (-_PI / 2, 0.0, _PI), (47, 313), 36, 80.0),
    ((0.0, -0.41, 0.0), (0.0, _PI, 0.0), (19, 341), 36, 40.0),
    ((0.0, 0.2073, -0.0114), (-_PI / 2, 0.0, _PI), None, 48, 20.0),
    ((0.0, -0.03703, -0.06414), (_PI / 3, 0.0, _PI), None, 48, 20.0),
    ((0.0, -0.03703, -0.06414), (_PI / 3, 0.0, _PI), None, 48, 20.0),
)
_END_EFFECTOR = Pose((0.0, 0.0, -0.16), (_PI, 0.0, _PI / 2))

# Link, mass, centre of mass, then radius, length and axis of the cylinder whose inertia it has.
_Body = tuple[str, float, "Triple", float, float, "AxisName"]
_BODIES: tuple[_Body, ...] = (
    ("link_base", 0.46784, (0.0, 0.0, 0.1255), 0.04, 0.15, "z"),
    ("link_1", 0.7477, (0.0, -0.002, -0.0605), 0.04, 0.15, "z"),
    ("link_2", 0.99, (0.0, -0.2065, -0.01), 0.04, 0.4, "y"),
    ("link_3", 0.6763, (0.0, 0.081, -0.0086), 0.03, 0.2, "y"),
    ("link_4", 0.426367, (0.0, -0.037, -0.0642), 0.03, 0.06, "z"),
    ("link_5", 0.426367, (0.0, -0.037, -0.0642), 0.03, 0.06, "z"),
    ("link_6", 0.99, (0.0, 0.0, -0.06), 0.04, 0.05, "z"),
)


def build(name: str) -> Robot:
    """The arm."""
    bodies = {link: cylinder(*figures) for link, *figures in _BODIES}  # type: ignore[arg-type]
    limbs = []
    for number, row in enumerate(_JOINTS, start=1):
        parent = f"link_{number - 1}" if number > 1 else "link_base"
        limbs.append((_joint(f"joint_{number}", parent, f"link_{number}", row), _link(f"link_{number}", bodies)))
    limbs.append((Joint("joint_end_effector", "fixed", "link_6", "end_effector", _END_EFFECTOR), Link("end_effector")))
    return Robot(name, _HEADER, jaco2_shapes.MATERIALS, _link("link_base", bodies), tuple(limbs))


def _joint(name: str, parent: str, child: str, row: _Row) -> Joint:
    xyz, rpy, span, speed, effort = row
    lower, upper = (None, None) if span is None else (math.radians(span[0]), math.radians(span[1]))
    limit = Limit(lower, upper, math.radians(speed), effort)
    return Joint(name, "continuous" if span is None else "revolute", parent, child, Pose(xyz, rpy), Z, limit)


def _link(name: str, bodies: dict[str, Inertial]) -> Link:
    return Link(name, jaco2_shapes.VISUALS[name], jaco2_shapes.COLLISIONS[name], bodies[name])
