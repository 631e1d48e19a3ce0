"""An SRDF, the file in which MoveIt keeps groups, states and allowed collisions, held against the URDF it is about."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from nao_kin.checks.subject import numbers
from nao_kin.errors import UrdfError
from nao_kin.urdf.connection import near_hint
from nao_kin.urdf.document import parse_urdf, read_bytes
from nao_kin.urdf.outline import Defect, children, describe, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from lxml import etree

    from nao_kin.urdf.document import UrdfDocument

__all__ = ["RULES", "Semantics", "urdf_of"]

_ROUNDING = 1e-4  # [rad or m] states are printed to four digits
_FOLDERS = (".", "../urdf", "../robots", "..")
"""Where the URDF of an SRDF is looked for, from the SRDF's own folder."""


def urdf_of(root: etree._Element, folder: Path | None) -> UrdfDocument | None:
    """The URDF of the same robot name, in the SRDF's folder or one of its neighbours; None where there is none."""
    name = root.get("name", "")
    for place in () if folder is None else _FOLDERS:
        try:
            found = sorted(path for path in (folder / place).iterdir() if path.suffix == ".urdf") if folder else []
        except OSError:
            continue
        for path in found[:50]:
            try:
                document = parse_urdf(read_bytes(os.fspath(path)), os.fspath(path))
            except UrdfError:
                continue  # its own check says what is wrong
            if document.name == name:
                return document
    return None


@dataclass(frozen=True)
class Semantics:
    """An SRDF's tree and the robot that it is about, None where no URDF of it was found."""

    root: etree._Element
    urdf: UrdfDocument | None

    @cached_property
    def links(self) -> frozenset[str]:
        """Names of the robot's links."""
        return frozenset(link.name for link in self.urdf.links) if self.urdf else frozenset()

    @cached_property
    def joints(self) -> frozenset[str]:
        """Names of the robot's joints and of the SRDF's own virtual ones."""
        virtual = {joint.get("name", "") for joint in children(self.root, "virtual_joint")}
        return frozenset(joint.name for joint in self.urdf.joints) | virtual if self.urdf else frozenset()

    @cached_property
    def groups(self) -> frozenset[str]:
        """Names of the groups."""
        return frozenset(group.get("name", "") for group in children(self.root, "group"))


def root_element(semantics: Semantics) -> Iterator[Defect]:
    """The root element is <robot>, with the name of a robot whose URDF is there."""
    root = semantics.root
    if tag_of(root) != "robot":
        message = f"The root element is <{shown(tag_of(root))[1:-1]}>, but an SRDF begins with <robot>."
        yield Defect("not-robot", root, message)
    elif semantics.urdf is None:
        message = f"No URDF of the robot {shown(root.get('name', ''))} was found, so names were not compared."
        yield Defect("srdf-without-urdf", root, message, "Name it by --urdf FILE, or put it beside the SRDF.", "name")


def links_and_joints(semantics: Semantics) -> Iterator[Defect]:
    """Every link and joint that is named is one of the robot."""
    if semantics.urdf is None:
        return
    named = (
        ("group", "link", "name", "link"),
        ("group", "joint", "name", "joint"),
        ("group", "passive_joint", "name", "joint"),
        ("group", "chain", "base_link", "link"),
        ("group", "chain", "tip_link", "link"),
        ("group_state", "joint", "name", "joint"),
    )
    for owner, tag, attribute, what in named:
        for parent in children(semantics.root, owner):
            for element in children(parent, tag):
                yield from _unknown(semantics, element, attribute, what)
    top = (
        ("disable_collisions", ("link1", "link2"), "link"),
        ("enable_collisions", ("link1", "link2"), "link"),
        ("disable_default_collisions", ("link",), "link"),
        ("end_effector", ("parent_link",), "link"),
        ("virtual_joint", ("child_link",), "link"),
        ("passive_joint", ("name",), "joint"),
        ("link_sphere_approximation", ("link",), "link"),
        ("joint_property", ("joint_name",), "joint"),
    )
    for tag, attributes, what in top:
        for element in children(semantics.root, tag):
            for attribute in attributes:
                yield from _unknown(semantics, element, attribute, what)


def _unknown(semantics: Semantics, element: etree._Element, attribute: str, what: str) -> Iterator[Defect]:
    name, known = element.get(attribute), semantics.links if what == "link" else semantics.joints
    if name is not None and name not in known and not (attribute == "parent_link" and not name):
        message = f"The {what} {shown(name)} of <{tag_of(element)}> is not a {what} of the robot."
        yield Defect(f"srdf-unknown-{what}", element, message, near_hint(name, known), attribute)


def groups(semantics: Semantics) -> Iterator[Defect]:
    """Every group that is named exists, and none is in itself."""
    uses = [(sub, "name") for group in children(semantics.root, "group") for sub in children(group, "group")]
    uses += [(state, "group") for state in children(semantics.root, "group_state")]
    effectors = children(semantics.root, "end_effector")
    uses += [(effector, attribute) for effector in effectors for attribute in ("group", "parent_group")]
    for element, attribute in uses:
        name = element.get(attribute)
        if name is not None and name not in semantics.groups:
            message = f"The group {shown(name)} of <{tag_of(element)}> is not defined."
            yield Defect("srdf-unknown-group", element, message, near_hint(name, semantics.groups), attribute)
    for group in children(semantics.root, "group"):
        if any(sub.get("name") == group.get("name") for sub in children(group, "group")):
            message = f"The group {shown(group.get('name', ''))} holds itself."
            yield Defect("srdf-unknown-group", group, message, "Name another group.", "name")


def chains(semantics: Semantics) -> Iterator[Defect]:
    """The base of a chain is above its tip in the tree."""
    if semantics.urdf is None:
        return
    above = {joint.child: joint.parent for joint in semantics.urdf.joints}
    for group in children(semantics.root, "group"):
        for chain in children(group, "chain"):
            base, tip = chain.get("base_link", ""), chain.get("tip_link", "")
            if base not in semantics.links or tip not in semantics.links:
                continue
            link = tip
            while link in above and link != base:
                link = above[link]
            if link != base:
                message = f"The base {shown(base)} of a chain of the group {shown(group.get('name', ''))} is not above "
                message += f"its tip {shown(tip)}."
                yield Defect("srdf-no-chain", chain, message, "Swap them, or start where both hang on.", "base_link")


def states(semantics: Semantics) -> Iterator[Defect]:
    """The values of a group state are numbers within the joints' limits."""
    limits = {joint.name: joint for joint in semantics.urdf.joints} if semantics.urdf else {}
    for state in children(semantics.root, "group_state"):
        for element in children(state, "joint"):
            name, where = element.get("name", ""), shown(state.get("name", ""))
            words = element.get("value", "").split()
            value = numbers(element, "value", max(len(words), 1))
            if value is None:
                message = f"The value of the joint {shown(name)} of the state {where} is no number."
                yield Defect("srdf-state", element, message, "Write radians or metres.", "value")
                continue
            joint = limits.get(name)
            limit = None if joint is None or joint.kind in {"continuous", "fixed"} else joint.limit
            if limit is None or limit.lower is None or limit.upper is None or limit.swapped or len(value) != 1:
                continue
            if not limit.lower - _ROUNDING <= value[0] <= limit.upper + _ROUNDING:
                message = f"The state {where} puts the joint {shown(name)} at {value[0]:g}, outside its limits "
                message += f"{limit.lower:g} … {limit.upper:g}."
                yield Defect("srdf-state-outside", element, message, "MoveIt refuses to plan from there.", "value")


def virtual_joints(semantics: Semantics) -> Iterator[Defect]:
    """A virtual joint says how the robot is fixed to the world."""
    if tag_of(semantics.root) == "robot" and not children(semantics.root, "virtual_joint"):
        message = f"The {describe(semantics.root)} has no <virtual_joint>, so MoveIt takes its root to be the world."
        hint = 'Write <virtual_joint name="fixed_base" type="fixed" parent_frame="world" child_link="…"/>.'
        yield Defect("srdf-virtual-joint", semantics.root, message, hint)


RULES: tuple[Callable[[Semantics], Iterator[Defect]], ...] = (
    root_element,
    links_and_joints,
    groups,
    chains,
    states,
    virtual_joints,
)
"""All rules on an SRDF."""
