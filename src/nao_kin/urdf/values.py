"""Structural rules about the numbers and words inside links and joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.urdf.fields import decimal_numbers, fields_of, read_numbers
from nao_kin.urdf.outline import Defect, Outline, describe, first, line_of, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.urdf.fields import Field

__all__ = ["SHORTEST_AXIS", "inverted_limits", "mesh_names", "missing_limits", "number_fields", "zero_axes"]

SHORTEST_AXIS = 1e-12
"""A joint axis shorter than this points nowhere."""


def number_fields(outline: Outline) -> Iterator[Defect]:
    """Every number is a finite decimal number, none is missing or too many, and sizes and masses are not negative."""
    for element in outline.described():
        for field in fields_of(element):
            fault, hint = _field_fault(element, field)
            if fault:
                where = describe(element)
                yield Defect(line_of(element), where, f"The {field.attribute} of the {where} {fault}.", hint)


def _field_fault(element: etree._Element, field: Field) -> tuple[str, str]:
    text = element.get(field.attribute)
    if text is None:
        return ("is missing", "") if field.required else ("", "")
    try:
        values = decimal_numbers(text, field.count)
    except ValueError as error:
        return str(error), "Separate numbers by blanks, without commas." if "," in text else ""
    if field.minimum is not None and min(values) < field.minimum:
        return f"is {shown(text)}, which is below {field.minimum:g}", ""
    if max(map(abs, values)) > field.largest:
        return f"is {shown(text)}, which is beyond ±{field.largest:g}", ""
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
            where = describe(joint)
            hint = "Give the direction of the joint, for example 0 0 1."
            yield Defect(line_of(axis), where, f"The axis of the {where} has no length.", hint)


def missing_limits(outline: Outline) -> Iterator[Defect]:
    """Revolute and prismatic joints have a limit element, as URDF demands."""
    for joint in outline.moving:
        if joint.get("type") != "continuous" and first(joint, "limit") is None:
            where = describe(joint)
            hint = 'Add <limit lower="..." upper="..." velocity="..." effort="..."/>'
            hint += " or make it continuous." if joint.get("type") == "revolute" else "."
            yield Defect(line_of(joint), where, f"The {where} has no <limit>.", hint)


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
            where = describe(joint)
            message = f"The lower limit {lower:g} of the {where} is above its upper limit {upper:g}."
            hint = f"The {absent[0]} limit is missing and counts as 0." if absent else "Are they swapped?"
            yield Defect(line_of(limit), where, message, hint)


def mesh_names(outline: Outline) -> Iterator[Defect]:
    """A mesh of a visual or collision element names a file."""
    for link in outline.links:
        for solid in link:
            geometry = first(solid, "geometry") if tag_of(solid) in {"visual", "collision"} else None
            mesh = None if geometry is None else first(geometry, "mesh")
            if mesh is not None and not mesh.get("filename", "").strip():
                where = describe(mesh)
                yield Defect(line_of(mesh), where, f"The {where} has no filename.")
