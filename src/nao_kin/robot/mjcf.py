"""MJCF, the format of MuJoCo, as input for kinematics: read by Pinocchio, turned into the same plain data as a URDF.

Pinocchio gives the tree, the placements, the joints, the inertias and the primitive shapes. What it loses or reads
otherwise than MuJoCo is said with the line: names of all but the first of several joints of a body and ranges of slides
are taken from the file; equality constraints, tendons, actuators and meshes are not read.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from lxml import etree

from nao_kin.errors import UrdfError
from nao_kin.urdf.document import UrdfDocument, parse_urdf, read_bytes
from nao_kin.urdf.elements import Box, Capsule, Cylinder, Inertial, Limit, Origin, Solid, Sphere, UrdfJoint, UrdfLink
from nao_kin.urdf.fields import NumberError, decimal_numbers
from nao_kin.urdf.outline import line_of, shown, tag_of
from nao_kin.urdf.quaternion import rpy_of_quaternion
from nao_kin.urdf.safe_xml import read_tree
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from nao_kin.urdf.elements import JointKind, Shape

__all__ = ["read_mjcf"]

_SECONDS = 60.0
_LOST = {
    "equality": "constraints, such as joints that follow another,",
    "tendon": "tendons",
    "actuator": "motors, and so speeds and efforts,",
    "contact": "pairs that may or may not touch",
    "keyframe": "postures",
}
"""Sections that Pinocchio's reader or this one passes over, and what is in them."""

_NUMBERS = {
    **dict.fromkeys(("pos", "euler", "axis", "zaxis", "diaginertia"), 3),
    **dict.fromkeys(("quat", "axisangle"), 4),
    **dict.fromkeys(("xyaxes", "fromto", "fullinertia"), 6),
    "range": 2,
    "mass": 1,
}
"""How many numbers an attribute holds."""

_KINDS: dict[str, JointKind] = {"R": "revolute", "P": "prismatic"}


def read_mjcf(path: str | os.PathLike[str]) -> UrdfDocument:
    """Read the robot of an MJCF file that may come from a stranger.

    Links are the bodies, and one more for each joint but the last of a body with several, or for one that is not at its
    body's origin. A free joint is taken as fixed, with its body at the origin, because a base
    is fixed anyway.

    Raises:
        UrdfError: The file is unreadable or no MJCF, includes other files, has a ball joint, or Pinocchio refuses it.
    """
    name = os.fspath(path)
    data = read_bytes(name)
    root = read_tree(data, name)
    if tag_of(root) != "mujoco":
        reason = f"The root element is <{shown(tag_of(root))[1:-1]}>, but an MJCF file begins with <mujoco>."
        raise UrdfError(name, line_of(root), reason, code="not-robot")
    told = _unread(root, name)
    answer = _asked(root, name)
    if "refused" in answer:
        raise UrdfError(name, None, f"Pinocchio does not read it: {answer['refused']}.", code="not-robot")
    robot = _Reading(name, root, told).build(answer)
    directory = Path(name).absolute().parent
    links, joints = tuple(robot.links.values()), tuple(robot.joints)
    title = root.get("model") or Path(name).stem
    digest = hashlib.sha256(data).hexdigest()
    document = UrdfDocument(name, title, digest, links, joints, robot.root, directory, tuple(told))
    try:
        parse_urdf(document.to_xml().encode())  # names once, finite numbers, one tree, as for any robot
    except UrdfError as refusal:
        raise UrdfError(name, None, refusal.reason, refusal.hint, code=refusal.code) from None
    return document


def _unread(root: etree._Element, name: str) -> list[str]:
    """What is passed over, with lines; meshes are taken out of the tree, so that nobody opens them."""
    for element in root.iter("include"):
        reason = "It includes another file, which is not followed."
        raise UrdfError(name, line_of(element), reason, "Give the file that has the bodies.", code="not-robot")
    bodies = max(sum(1 for _ in root.iter(tag)) for tag in ("body", "joint"))
    if bodies > LIMITS.moving_joints:
        raise UrdfError(
            name, None, f"It has {bodies} bodies or joints; at most {LIMITS.moving_joints} are read.", code="too-many"
        )
    _require_numbers(root, name)
    _give_names(root)
    told = []
    for section, what in _LOST.items():
        found = root.find(section)
        if found is not None and len(found):
            told.append(f"line {line_of(found)}: <{section}> is not read: {what} are lost.")
    meshes = [element for element in root.iter("geom", "mesh", "hfield", "skin") if _is_mesh(element)]
    if meshes:
        told.append(f"line {line_of(meshes[0])}: Meshes are not read; bodies of meshes alone are not drawn or weighed.")
    for element in meshes:
        parent = element.getparent()
        if parent is not None:
            parent.remove(element)
    return told


def _require_numbers(root: etree._Element, name: str) -> None:
    """Pinocchio takes what it can read of a list of numbers, and says nothing about the rest."""
    for element in root.iter("body", "joint", "inertial", "geom", "freejoint", "site", "frame"):
        for attribute, wanted in _NUMBERS.items():
            text = element.get(attribute)
            try:
                if text is not None and text.strip():
                    decimal_numbers(text, wanted)
            except NumberError as fault:
                reason = f"The {attribute} of a <{tag_of(element)}> {fault}."
                raise UrdfError(name, line_of(element), reason, code=fault.code) from None


def _give_names(root: etree._Element) -> None:
    """Pinocchio leaves out bodies without a name, and all that hangs on them."""
    taken = {str(element.get("name")) for element in root.iter("body", "joint", "freejoint")}
    world = root.find("worldbody")
    numbers = count(1)
    for element in () if world is None else world.iter("body", "joint", "freejoint"):
        if element.get("name") is None:
            names = (f"{tag_of(element)}_{number}" for number in numbers)
            element.set("name", next(name for name in names if name not in taken))


def _is_mesh(element: etree._Element) -> bool:
    return tag_of(element) != "geom" or element.get("mesh") is not None or element.get("type") in {"mesh", "hfield"}


def _asked(root: etree._Element, name: str) -> dict[str, Any]:
    """What Pinocchio makes of the tree, in a process of its own: files from elsewhere have crashed readers of C++."""
    program = Path(__file__).with_name("mjcf_process.py")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "robot.xml"
        place.write_bytes(etree.tostring(root))
        command = [sys.executable, "-I", "-B", str(program), str(place)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)  # noqa: S603
            answer = json.loads(done.stdout)
        except (subprocess.TimeoutExpired, ValueError):
            reason = "Pinocchio's reader of MJCF crashed or did not come to an end on it."
            raise UrdfError(name, None, reason, code="not-robot") from None
    return cast("dict[str, Any]", answer)


@dataclass
class _Reading:
    """Links and joints as they come out of Pinocchio's model."""

    path: str
    tree: etree._Element
    told: list[str]
    links: dict[str, UrdfLink] = field(default_factory=dict)
    joints: list[UrdfJoint] = field(default_factory=list)
    root: str = ""

    def build(self, answer: dict[str, Any]) -> _Reading:
        """Joint by joint, then the bodies that sit on them."""
        bodies = {frame["name"] for frame in answer["bodies"]}
        self.root = _free_name("world", bodies)
        self._add_link(self.root, answer["inertias"][0], answer["shapes"].get("0", []))
        carriers = {0: self.root}
        for number, joint in enumerate(answer["joints"], start=1):
            own = [frame for frame in answer["bodies"] if frame["joint"] == number]
            shapes = answer["shapes"].get(str(number), [])
            carriers[number] = self._add_joint(
                carriers[joint["parent"]], joint, own, answer["inertias"][number], shapes
            )
        for frame in answer["bodies"]:
            if frame["name"] not in self.links:
                self._add_link(frame["name"])
                self._add_fixed(carriers[frame["joint"]], frame["name"], _origin(frame["placement"]))
        return self

    def _add_joint(
        self, parent: str, joint: dict[str, Any], own: list[dict[str, Any]], inertia: Any, shapes: list[Any]
    ) -> str:
        """The links and joints of one of Pinocchio's; the name of the link that sits in its frame."""
        elements = self._elements(joint["name"])
        steps = joint["steps"]
        sits = next((frame["name"] for frame in own if _is_identity(frame["placement"])), None)
        for number, step in enumerate(steps):
            element = elements[number] if number < len(elements) else None
            given = None if element is None else element.get("name")
            name = given or joint["name"] + (f"_{number + 1}" if len(steps) > 1 else "")
            line = 1 if element is None else line_of(element)
            last = number == len(steps) - 1
            child = sits if last and sits is not None else _free_name(f"{name}_frame", self.links.keys() | set())
            self._add_link(child, inertia if last else None, shapes if last else [])
            self.joints.append(self._moving(name, parent, child, step, element, line))
            parent = child
        return parent

    def _elements(self, name: str) -> list[etree._Element]:
        """The joint elements of the body whose first joint is of that name, which Pinocchio keeps of several."""
        plain = name.removeprefix("Composite_")
        for element in self.tree.iter("joint", "freejoint"):
            body = element.getparent()
            if body is not None and tag_of(body) == "body" and element.get("name") == plain:
                return [child for child in body if tag_of(child) in {"joint", "freejoint"}]
        return []

    def _moving(
        self, name: str, parent: str, child: str, step: dict[str, Any], element: etree._Element | None, line: int
    ) -> UrdfJoint:
        origin = _origin(step["placement"])
        if step["kind"] == "free":
            self.told.append(f"line {line}: The free joint {shown(name)} is taken as fixed, its body at the origin.")
            return UrdfJoint(name, "fixed", parent, child, origin, (1.0, 0.0, 0.0), None, None, line)
        if step["kind"] not in _KINDS:
            reason = (
                f"The joint {shown(name)} is of the kind {step['kind']}; only joints with one number are supported."
            )
            raise UrdfError(self.path, line, reason, "Replace a ball by three hinges.", code="unsupported-joint")
        kind = _KINDS[step["kind"]]
        lower, upper = step["lower"], step["upper"]
        if kind == "prismatic" and lower is not None:
            lower, upper = self._slide(element, lower, upper)
        if lower is None or upper is None:
            if kind == "revolute":
                kind = "continuous"
            lower = upper = None
        limit = Limit(lower, upper, None, None, line)
        return UrdfJoint(name, kind, parent, child, origin, tuple(step["axis"]), limit, None, line)

    def _slide(self, element: etree._Element | None, lower: float, upper: float) -> tuple[float, float]:
        """The range of a slide [m], which Pinocchio 4.1 converts as if it were an angle where angles are degrees."""
        try:
            if element is not None and element.get("range") is not None:
                a, b = decimal_numbers(str(element.get("range")), 2)
                return a, b
        except NumberError:
            pass  # Pinocchio has read something, and it is told below how
        compiler = self.tree.find("compiler")
        if compiler is not None and compiler.get("angle") == "radian":
            return lower, upper
        return math.degrees(lower), math.degrees(upper)

    def _add_fixed(self, parent: str, child: str, origin: Origin) -> None:
        name = _free_name(f"{child}_fixed", {joint.name for joint in self.joints})
        self.joints.append(UrdfJoint(name, "fixed", parent, child, origin, (1.0, 0.0, 0.0), None, None, 1))

    def _add_link(self, name: str, inertia: Any = None, shapes: list[Any] | None = None) -> None:
        solids = tuple(_solid(shape) for shape in shapes or [])
        self.links[name] = UrdfLink(name, solids, solids, _inertial(inertia), 1)


def _solid(shape: dict[str, Any]) -> Solid:
    size, kind = shape["size"], shape["kind"]
    made: Shape
    match kind:
        case "Box":
            made = Box((size[0], size[1], size[2]))
        case "Sphere":
            made = Sphere(size[0])
        case "Capsule":
            made = Capsule(size[0], size[1])
        case _:
            made = Cylinder(size[0], size[1])
    return Solid(made, _origin(shape["placement"]), tuple(shape["colour"]), 1)


def _inertial(inertia: Any) -> Inertial | None:
    if inertia is None or inertia["mass"] <= 0.0:
        return None
    xx, xy, xz, yy, yz, zz = inertia["about_centre"]
    lever = inertia["lever"]
    return Inertial(inertia["mass"], Origin((lever[0], lever[1], lever[2])), (xx, xy, xz, yy, yz, zz), 1)


def _origin(placement: list[float]) -> Origin:
    x, y, z, *quaternion = placement
    return Origin((x, y, z), rpy_of_quaternion(*quaternion))


def _is_identity(placement: list[float]) -> bool:
    return all(abs(part) < 1e-15 for part in placement[:6])


def _free_name(wanted: str, taken: Any) -> str:
    while wanted in taken:
        wanted += "_"
    return wanted
