"""What other languages have left in a URDF: prefixes that nothing declares, and elements of xacro.

Readers that know no XML namespaces, as those of ROS and Pinocchio, pass over both. A file is read past them where they
stand beside a robot that is whole without them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from lxml import etree

from nao_kin.urdf.outline import Defect, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.urdf.outline import Outline

__all__ = ["declared", "is_xacro", "leftover_xacro", "undeclared_prefixes", "xacro_beside", "xacro_name"]

_MADE_UP = "urn:nao-kin:undeclared:"
"""Namespace of a prefix that the file uses without declaring it."""

_ROOT_TAG = re.compile(rb"<[^\s<>/!?\"'=]+")


def declared(data: bytes, start: int, prefixes: Iterable[str]) -> bytes:
    """The file with prefixes declared in its root element, on the same lines.

    Args:
        data: The file.
        start: Where its root element begins.
        prefixes: The prefixes that nothing declares.
    """
    root = _ROOT_TAG.match(data, start)
    if root is None:
        return data
    words = "".join(f' xmlns:{prefix}="{_MADE_UP}{prefix}"' for prefix in dict.fromkeys(prefixes))
    return data[: root.end()] + words.encode() + data[root.end() :]


def undeclared_prefixes(outline: Outline) -> Iterator[Defect]:
    """Every prefix of a name is declared by an xmlns; each is reported where it is first met."""
    made_up = {prefix for prefix, name in outline.root.nsmap.items() if name == f"{_MADE_UP}{prefix}"}
    made_up.discard("xacro")  # `leftover_xacro` says it
    if not made_up:
        return
    for element in outline.root.iter(etree.Element):  # attributes have prefixes too
        for name in (element.tag, *element.attrib):
            space, _, local = str(name)[1:].partition("}")
            prefix = space.removeprefix(_MADE_UP)
            if space.startswith(_MADE_UP) and prefix in made_up:
                made_up.discard(prefix)
                hint = f'Write xmlns:{prefix}="..." into <robot>.'
                message = f"The prefix of {shown(f'{prefix}:{local}')} is declared nowhere in the file."
                yield Defect("undeclared-prefix", element, message, hint)


def is_xacro(element: etree._Element) -> bool:
    """Whether an element belongs to xacro, by its prefix or by its namespace."""
    namespace = str(element.tag).partition("}")[0]
    return element.prefix == "xacro" or (namespace.startswith("{") and "xacro" in namespace)


def xacro_name(element: etree._Element) -> str:
    """An element of xacro as messages name it."""
    return f"<xacro:{shown(str(element.tag).rpartition('}')[2])[1:-1]}>"


def xacro_beside(outline: Outline) -> list[etree._Element]:
    """The elements of xacro that stand in no link, joint or material, where they would be part of the robot."""
    found = [element for element in outline.namespaced if is_xacro(element)]
    inside = {*outline.described()} if found else set()
    return [element for element in found if element not in inside]


def leftover_xacro(outline: Outline) -> Iterator[Defect]:
    """No element of xacro is left beside a robot that is whole without it."""
    for element in xacro_beside(outline):
        parent = element.getparent()
        if parent is None or is_xacro(parent):
            continue  # said of the one around it
        message = f"The element {xacro_name(element)} has been left in the file and is not read."
        yield Defect("leftover-xacro", element, message, "Remove it, or expand the file with xacro.")
