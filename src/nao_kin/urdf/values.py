"""Structural rules about the numbers and words inside links and joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.urdf.fields import NumberError, decimal_numbers, fields_of, read_numbers
from nao_kin.urdf.outline import Defect, Outline, describe, first, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.urdf.fields import Field

__all__ = [
    "SHORTEST_AXIS",
    "field_defects",
    "inverted_limits",
    "mesh_names",
    "missing_limits",
    "number_fields",
    "zero_axes",
]

SHORTEST_AXIS = 1e-12
"""A joint axis shorter than this points nowhere."""


_NEGATIVE = {"mass": "negative-mass", "limit": "negative-limit", "dynamics": "negative-friction"}
_NUMBER_HINTS = {
    "not-a-number": "Write a decimal number such as -0.5 or 1e-3; formulas and units are not evaluated.",
    "missing-number": "Add it.",
    "negative-limit": "Speeds and efforts are magnitudes; give them without a sign.",
    "negative-friction": "Friction takes energy; remove the sign.",
    "negative-mass": "A mass is not negative; remove the sign.",
    "negative-size": "Sizes are not negative; turn the shape by its origin instead.",
    "out-of-range": "Lengths are metres and angles radians; is the exponent right?",
}


def number_fields(outline: Outline) -> Iterator[Defect]:
    """Every number is a finite decimal number, none is missing or too many, and sizes and masses are not negative."""
    for element in outline.described():
        for field in fields_of(element):
            yield from field_defects(element, field)


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


def inverted_limits(outline: Outline) -> Iterator[Defect]:
    """The lower limit of a joint is not above the upper one; what is absent counts as 0."""
    for joint in outline.moving:
        limit = first(joint, "limit")
        if limit is None or joint.get("type") == "continuous":
            continue
        try:
            lower, upper = (read_numbers(limit, side, (0.0,))[0] for side in ("lower", "upper"))
        except ValueError:
            continue  # reported as a bad number
        if lower > upper:
            absent = [side for side in ("lower", "upper") if limit.get(side) is None]
            message = f"The lower limit {lower:g} of the {describe(joint)} is above its upper limit {upper:g}."
            hint = f"The {absent[0]} limit is missing and counts as 0." if absent else "Are they swapped?"
            yield Defect("inverted-limit", limit, message, hint, "upper" if absent == ["lower"] else "lower")


def mesh_names(outline: Outline) -> Iterator[Defect]:
    """A mesh of a visual or collision element names a file."""
    for mesh in outline.meshes():
        if not mesh.get("filename", "").strip():
            hint = 'Write <mesh filename="package://..."/>.'
            yield Defect("mesh-without-name", mesh, f"The {describe(mesh)} has no filename.", hint, "filename")
