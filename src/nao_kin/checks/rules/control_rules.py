"""Rules about what ROS 2 keeps in a URDF beside the robot: ros2_control, transmissions, references of Gazebo.

These languages are not the reader's; the rules ask only whether they fit the robot that they are about.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.checks.subject import numbers
from nao_kin.errors import near_matches
from nao_kin.urdf.connection import near_hint
from nao_kin.urdf.fields import NumberError, decimal_numbers
from nao_kin.urdf.outline import MOVING, Defect, children, first, line_of, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.checks.subject import Subject

__all__ = ["controlled_joints", "gazebo_references", "transmission_joints"]

_INTERFACES = ("position", "velocity", "acceleration", "effort", "force", "torque")
"""Names that hardware_interface defines or controllers use for a joint; any other is allowed, but nearly one is not."""

_SLACK = 1e-6  # relative; printed limits are rounded
_COMPARED = 64  # longer names are not compared: the time that takes grows with the square of their length


def controlled_joints(subject: Subject) -> Iterator[Defect]:
    """Every joint of <ros2_control> is one of the robot, and its interfaces and ranges fit it."""
    for system in children(subject.outline.root, "ros2_control"):
        seen: dict[str, etree._Element] = {}
        for joint in children(system, "joint"):
            name = joint.get("name", "")
            known = subject.outline.joint_by_name
            if name not in known:
                message = f"The joint {shown(name)} of <ros2_control> is not a joint of this robot."
                yield Defect("control-joint", joint, message, near_hint(name, known), "name")
            elif name in seen:
                message = f"The joint {shown(name)} is in this <ros2_control> already, on line {line_of(seen[name])}."
                yield Defect("control-joint", joint, message, "Name it once, with all its interfaces.", "name")
            seen.setdefault(name, joint)
            yield from _interfaces(subject, joint)


def _interfaces(subject: Subject, joint: etree._Element) -> Iterator[Defect]:
    name = joint.get("name", "")
    for tag in ("command_interface", "state_interface"):
        for interface in children(joint, tag):
            kind = interface.get("name", "")
            near = near_matches(kind[:_COMPARED], _INTERFACES, limit=1)
            if not kind or (near and kind not in _INTERFACES):
                hint = f"Did you mean {near[0]!r}?" if near else f"Interfaces of joints: {', '.join(_INTERFACES)}."
                message = f"The interface {shown(kind)} of the joint {shown(name)} is none that controllers ask for."
                yield Defect("control-interface", interface, message, hint, "name")
            yield from _range(subject, name, interface)


def _range(subject: Subject, joint: str, interface: etree._Element) -> Iterator[Defect]:
    ends: dict[str, tuple[etree._Element, float]] = {}
    for parameter in children(interface, "param"):
        what, text = parameter.get("name", ""), (parameter.text or "").strip()
        if what not in {"min", "max", "initial_value"}:
            continue
        try:
            ends[what] = parameter, decimal_numbers(text, 1)[0]
        except NumberError as fault:
            message = f"The {what} of the {interface.get('name', '')} of the joint {shown(joint)} {fault}."
            yield Defect("control-number", parameter, message, "Write a decimal number such as -3.14, nothing else.")
    if "min" in ends and "max" in ends and ends["min"][1] > ends["max"][1]:
        message = f"The min {ends['min'][1]:g} of the joint {shown(joint)} is above its max {ends['max'][1]:g}."
        yield Defect("control-range", ends["min"][0], message, "Are they swapped?")
        return
    yield from _wider(subject, joint, interface, ends)


def _wider(
    subject: Subject, joint: str, interface: etree._Element, ends: dict[str, tuple[etree._Element, float]]
) -> Iterator[Defect]:
    element = subject.outline.joint_by_name.get(joint)
    limit = None if element is None else first(element, "limit")
    if element is None or limit is None:
        return
    lower, upper = -math.inf, math.inf
    match interface.get("name", ""):
        case "position" if element.get("type") in MOVING - {"continuous"}:
            lower, upper = ((numbers(limit, side) or (0.0,))[0] for side in ("lower", "upper"))
        case "velocity" | "effort" as bound if most := numbers(limit, bound):
            lower, upper = -most[0], most[0]
    slack = _SLACK * max(1.0, *(abs(end) for end in (lower, upper) if math.isfinite(end)), 1.0)
    for what, (parameter, value) in ends.items():
        if what != "initial_value" and not lower - slack <= value <= upper + slack:
            kind = interface.get("name", "")
            message = f"The {what} {value:g} of the {kind} of the joint {shown(joint)} is outside the URDF's "
            message += f"{lower:g} … {upper:g}."
            yield Defect("control-wider", parameter, message, "The URDF's limits are the motor's; give no more.")


def transmission_joints(subject: Subject) -> Iterator[Defect]:
    """Every joint of a <transmission> is one of the robot."""
    systems = [subject.outline.root, *children(subject.outline.root, "ros2_control")]
    for transmission in (found for system in systems for found in children(system, "transmission")):
        for joint in children(transmission, "joint"):
            name = joint.get("name", "")
            if name not in subject.outline.joint_by_name:
                message = f"The joint {shown(name)} of the <transmission> {shown(transmission.get('name', ''))} is not "
                message += "a joint of this robot."
                hint = near_hint(name, subject.outline.joint_by_name)
                yield Defect("transmission-joint", joint, message, hint, "name")


def gazebo_references(subject: Subject) -> Iterator[Defect]:
    """A <gazebo reference> names a link or a joint of the robot."""
    known = {**subject.outline.link_by_name, **subject.outline.joint_by_name}
    for element in children(subject.outline.root, "gazebo"):
        name = element.get("reference")
        if name and name not in known:
            message = f"The reference {shown(name)} of <gazebo> is neither a link nor a joint of this robot."
            yield Defect("gazebo-reference", element, message, near_hint(name, known), "reference")
