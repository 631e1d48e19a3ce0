"""Rules about names beyond those that the reader enforces."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.urdf.outline import Defect, children, describe, first, line_of, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.checks.subject import Subject

__all__ = ["duplicate_materials", "shared_names", "similar_names", "undefined_materials"]


def duplicate_materials(subject: Subject) -> Iterator[Defect]:
    """No two materials below <robot> bear the same name."""
    seen: dict[str, etree._Element] = {}
    for material in children(subject.outline.root, "material"):
        name = material.get("name", "")
        if name in seen:
            message = f"The material {shown(name)} exists already on line {line_of(seen[name])}."
            yield Defect("duplicate-material", material, message, "Define it once, or give each its own name.", "name")
        seen.setdefault(name, material)


def undefined_materials(subject: Subject) -> Iterator[Defect]:
    """A material that is only named is defined somewhere in the file."""
    materials = [element for element in subject.outline.described() if tag_of(element) == "material"]
    defined = {m.get("name", "") for m in materials if first(m, "color") is not None or first(m, "texture") is not None}
    for material in materials:
        name = material.get("name", "")
        if name and name not in defined:
            message = f"The material {shown(name)} is defined nowhere in this file."
            yield Defect("undefined-material", material, message, 'Give it a <color rgba="..."/> once.', "name")


def shared_names(subject: Subject) -> Iterator[Defect]:
    """No joint bears the name of a link."""
    for joint in subject.outline.joints:
        name = joint.get("name", "")
        if name and name in subject.outline.link_by_name:
            message = f"The joint {shown(name)} bears the name of a link: readers with one list of both mix them up."
            yield Defect("shared-name", joint, message, f"Call the joint {shown(name + '_joint')}.", "name")


def similar_names(subject: Subject) -> Iterator[Defect]:
    """No two links and no two joints differ only in case or in blanks around the name."""
    for elements in (subject.outline.links, subject.outline.joints):
        seen: dict[str, str] = {}
        for element in elements:
            name = element.get("name", "")
            other = seen.setdefault(name.strip().casefold(), name)
            if other != name:
                message = f"The {describe(element)} differs from {shown(other)} only in case or blanks."
                yield Defect("similar-name", element, message, "Give it a name that cannot be mistaken.", "name")
