"""Structural rules about the numbers and words inside links and joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.urdf.fields import NumberError, decimal_numbers, fields_of, read_numbers
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import MOVING, Defect, Outline, children, describe, first, shown, tag_of
from nao_kin.urdf.quaternion import SHORTEST_QUATERNION

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.urdf.fields import Field

__all__ = [
    "SHORTEST_AXIS",
    "axes_without_direction",
    "field_defects",
    "idle_limits",
    "incomplete_ranges",
    "inverted_limits",
    "mesh_names",
    "missing_limits",
    "number_fields",
    "rotations",
    "swapped_limits",
    "zero_axes",
]

SHORTEST_AXIS = 1e-12
"""A joint axis shorter than this points nowhere."""


_NEGATIVE = {"mass": "negative-mass", "limit": "negative-limit", "dynamics": "negative-friction"}
_NUMBER_HINTS = {
    "not-a-number": "Write a decimal number such as -0.5 or 1e-3; formulas and units are not evaluated.",
    "missing-number": "Add it.",
    "negative-limit": "Speeds, accelerations and efforts are magnitudes; give them without a sign.",
    "negative-friction": "Friction takes energy; remove the sign.",
    "negative-mass": "A mass is not negative; remove the sign.",
    "negative-size": "Sizes are not negative; turn the shape by its origin instead.",
    "out-of-range": "Lengths are metres and angles radians; is the exponent right?",
}


def number_fields(outline: Outline) -> Iterator[Defect]:
    """Every number is a finite decimal number, none is missing or too many, and sizes and masses are not negative."""
    for element in outline.described():
        for field in fields_of(element, outline.version):
            yield from (d for d in field_defects(element, field) if not _is_idle(d, outline))


def idle_limits(outline: Outline) -> Iterator[Defect]:
    """A joint that does not move has no negative limits either, though before version 1.2 no reader asks."""
    for joint in outline.joints:
        for element in children(joint, "limit"):
            for field in fields_of(element, outline.version):
                yield from (d for d in field_defects(element, field) if _is_idle(d, outline))


def _is_idle(defect: Defect, outline: Outline) -> bool:
    joint = defect.at.getparent()
    idle = defect.code == "negative-limit" and outline.version < FormatVersion.V1_2
    return idle and joint is not None and joint.get("type") not in MOVING


def field_defects(element: etree._Element, field: Field) -> Iterator[Defect]:
    """What is wrong with the numbers of one attribute."""
    code, fault = _field_fault(element, field)
    if code:
        comma = "," in element.get(field.attribute, "")
        hint = "Separate numbers by blanks, without commas." if comma else _NUMBER_HINTS.get(code, "")
        yield Defect(code, element, f"The {field.attribute} of the {describe(element)} {fault}.", hint, field.attribute)


def _field_fault(element: etree._Element, field: Field) -> tuple[str, str]:
    text = element.get(field.attribute)
    if text is None:
        return ("missing-number", "is missing") if field.required else ("", "")
    try:
        values = decimal_numbers(text, field.count)
    except NumberError as error:
        return error.code, str(error)
    if field.minimum is not None and min(values) < field.minimum:
        return _NEGATIVE.get(tag_of(element), "negative-size"), f"is {shown(text)}, which is below {field.minimum:g}"
    if max(map(abs, values)) > field.largest:
        return "out-of-range", f"is {shown(text)}, which is beyond ±{field.largest:g}"
    return "", ""


def zero_axes(outline: Outline) -> Iterator[Defect]:
    """The axis of a moving joint points somewhere."""
    for joint in outline.moving:
        axis = first(joint, "axis")
        try:
            length = math.hypot(*read_numbers(axis, "xyz", (1.0, 0.0, 0.0)))
        except ValueError:
            continue  # reported as a bad number
        if axis is not None and length < SHORTEST_AXIS:
            hint = "Give the direction of the joint, for example 0 0 1."
            yield Defect("zero-axis", axis, f"The axis of the {describe(joint)} has no length.", hint, "xyz")


def missing_limits(outline: Outline) -> Iterator[Defect]:
    """Revolute and prismatic joints have a limit element, as URDF demands."""
    for joint in outline.moving:
        if joint.get("type") != "continuous" and first(joint, "limit") is None:
            hint = 'Add <limit lower="..." upper="..." velocity="..." effort="..."/>'
            hint += " or make it continuous." if joint.get("type") == "revolute" else "."
            yield Defect("missing-limit", joint, f"The {describe(joint)} has no <limit>.", hint)


def incomplete_ranges(outline: Outline) -> Iterator[Defect]:
    """From version 1.2 on, a range has both ends: what is absent no longer counts as 0."""
    if outline.version < FormatVersion.V1_2:
        return
    for joint in outline.moving:
        limit = first(joint, "limit")
        if limit is None or joint.get("type") == "continuous":
            continue
        absent = [side for side in ("lower", "upper") if limit.get(side) is None]
        if absent:
            message = f"The <limit> of the {describe(joint)} has no {' and no '.join(absent)}."
            hint = f"Version {outline.version} of the format demands both; older ones take 0 for what is absent."
            yield Defect("incomplete-limit", limit, message, hint)


def inverted_limits(outline: Outline) -> Iterator[Defect]:
    """From version 1.2 on, the lower limit of a joint of any type is not above its upper one."""
    if outline.version >= FormatVersion.V1_2:
        yield from _limits_with_swapped_ends(outline, outline.joints)


def swapped_limits(outline: Outline) -> Iterator[Defect]:
    """Before version 1.2, the lower limit of a joint is not above the upper one; what is absent counts as 0."""
    if outline.version < FormatVersion.V1_2:
        joints = [joint for joint in outline.moving if joint.get("type") != "continuous"]
        yield from _limits_with_swapped_ends(outline, joints)


def _limits_with_swapped_ends(outline: Outline, joints: list[etree._Element]) -> Iterator[Defect]:
    for joint in joints:
        limit = first(joint, "limit")
        absent = [] if limit is None else [side for side in ("lower", "upper") if limit.get(side) is None]
        if limit is None or (absent and outline.version >= FormatVersion.V1_2):
            continue
        try:
            lower, upper = (read_numbers(limit, side, (0.0,))[0] for side in ("lower", "upper"))
        except ValueError:
            continue  # reported as a bad number
        if lower > upper:
            message = f"The lower limit {lower:g} of the {describe(joint)} is above its upper limit {upper:g}."
            hint = f"The {absent[0]} limit is missing and counts as 0." if absent else "Are they swapped?"
            yield Defect("inverted-limit", limit, message, hint, "upper" if absent == ["lower"] else "lower")


def rotations(outline: Outline) -> Iterator[Defect]:
    """An origin says its rotation once, and a quaternion says one."""
    if outline.version < FormatVersion.V1_1:
        return
    for element in outline.described():
        if tag_of(element) != "origin" or not fields_of(element, outline.version):
            continue
        if element.get("quat_xyzw") is None:
            continue
        if element.get("rpy") is not None:
            message = f"The {describe(element)} gives its rotation twice, by rpy and by quat_xyzw."
            hint = "ROS and Pinocchio refuse the file: keep one."
            yield Defect("two-rotations", element, message, hint, "quat_xyzw")
            continue
        try:
            length = math.hypot(*read_numbers(element, "quat_xyzw", (0.0, 0.0, 0.0, 1.0)))
        except ValueError:
            continue  # reported as a bad number
        if length < SHORTEST_QUATERNION:
            hint = "No rotation is 0 0 0 1: x, y, z, w."
            message = f"The quaternion of the {describe(element)} has no length."
            yield Defect("zero-quaternion", element, message, hint, "quat_xyzw")


def axes_without_direction(outline: Outline) -> Iterator[Defect]:
    """The <axis> of a moving joint says a direction; the default without one is x, but Pinocchio takes none."""
    for joint in outline.moving:
        axis = first(joint, "axis")
        if axis is not None and axis.get("xyz") is None:
            message = f"The <axis> of the {describe(joint)} has no xyz, and x is taken."
            hint = "Pinocchio and ROS take 0 0 0, so that the joint does not move there; write the direction."
            yield Defect("missing-number", axis, message, hint)


def mesh_names(outline: Outline) -> Iterator[Defect]:
    """A mesh of a visual or collision element names a file."""
    for mesh in outline.meshes():
        if not mesh.get("filename", "").strip():
            hint = 'Write <mesh filename="package://..."/>.'
            yield Defect("mesh-without-name", mesh, f"The {describe(mesh)} has no filename.", hint, "filename")
