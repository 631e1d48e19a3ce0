"""The element tree as rules and reader see it: only what URDF gives a meaning, each element with its line.

Line numbers are those of the end of an element's start tag, as libxml2 counts them; `positions.py` finds the exact
place. libxml2 counts in 16 bits and guesses beyond, which is why `ReadLimits` allows no more lines than that.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from lxml import etree

from nao_kin.urdf.format_version import FormatVersion, declared_version

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["MOVING", "Defect", "Outline", "children", "describe", "first", "line_of", "link_named", "shown", "tag_of"]

MOVING = frozenset({"revolute", "continuous", "prismatic"})
"""The joint types with one number a joint."""


@dataclass(frozen=True, slots=True)
class Defect:
    """One thing wrong with a file.

    Attributes:
        code: Name of the broken rule, for example ``"zero-axis"``.
        at: The element where it shows.
        message: What is wrong, one sentence.
        hint: What to do about it; may be empty.
        attribute: The attribute of `at` where it shows; may be empty.
        offset: The character of the text where it shows, where no element does; negative otherwise.
    """

    code: str
    at: etree._Element
    message: str
    hint: str = ""
    attribute: str = ""
    offset: int = -1

    @property
    def line(self) -> int:
        """Line on which the element's start tag ends, 1-based."""
        return line_of(self.at)


def tag_of(element: etree._Element) -> str:
    """The element's name as URDF knows it: a default namespace does not matter, a prefixed element has none ("")."""
    return "" if element.prefix is not None else str(element.tag).rpartition("}")[2]


def children(element: etree._Element, tag: str) -> list[etree._Element]:
    """The direct children of that name, in file order."""
    return [child for child in element if tag_of(child) == tag]


def first(element: etree._Element, tag: str) -> etree._Element | None:
    """The first direct child of that name, which is the one that counts where URDF allows only one."""
    return next((child for child in element if tag_of(child) == tag), None)


def line_of(element: etree._Element) -> int:
    """The element's line, 1-based."""
    line: object = element.sourceline  # the stubs do not say that it is a number
    return line if isinstance(line, int) else 1


def shown(text: str) -> str:
    """Foreign text for a message: quoted, without control characters, not longer than a line can bear."""
    return repr(text if len(text) <= 60 else text[:57] + "...")


def describe(element: etree._Element) -> str:
    """A name for messages: the link or joint around the element and the element itself."""
    owner: etree._Element | None = element
    while owner is not None and tag_of(owner) not in {"link", "joint"}:
        owner = owner.getparent()
    if owner is None:
        return tag_of(element) or "element"
    name = owner.get("name")
    whole = f"{tag_of(owner)} {shown(name)}" if name else f"{tag_of(owner)} without a name"
    return whole if owner is element else f"{tag_of(element)} of {whole}"


@dataclass(frozen=True)
class Outline:
    """The root element and its links and joints, valid or not."""

    root: etree._Element

    @cached_property
    def version(self) -> FormatVersion:
        """The version by which the file is read; 1.0 for one that no reader knows, which is a defect."""
        return declared_version(self.root) or FormatVersion.V1_0

    @cached_property
    def links(self) -> list[etree._Element]:
        """Link elements in file order."""
        return children(self.root, "link")

    @cached_property
    def joints(self) -> list[etree._Element]:
        """Joint elements in file order."""
        return children(self.root, "joint")

    @cached_property
    def namespaced(self) -> list[etree._Element]:
        """Elements of other languages, by a prefix or a namespace, in file order."""
        return [element for element in self.root.iter(etree.Element) if str(element.tag).startswith("{")]

    @cached_property
    def moving(self) -> list[etree._Element]:
        """Joint elements of a type that moves, in file order."""
        return [joint for joint in self.joints if joint.get("type") in MOVING]

    @cached_property
    def link_by_name(self) -> dict[str, etree._Element]:
        """Links by name; of several the first."""
        return _by_name(self.links)

    @cached_property
    def joint_by_name(self) -> dict[str, etree._Element]:
        """Joints by name; of several the first."""
        return _by_name(self.joints)

    @cached_property
    def child_counts(self) -> Counter[str]:
        """How often each link is the child of a joint."""
        return Counter(child for joint in self.joints if (child := link_named(joint, "child")))

    def meshes(self) -> Iterator[etree._Element]:
        """The mesh elements of visual and collision elements, in file order."""
        for link in self.links:
            for solid in link:
                geometry = first(solid, "geometry") if tag_of(solid) in {"visual", "collision"} else None
                if geometry is not None and (mesh := first(geometry, "mesh")) is not None:
                    yield mesh

    def described(self) -> Iterator[etree._Element]:
        """Every element that describes the robot, in file order: links, joints and materials with all they hold.

        What other programs keep in the file (simulators, controllers) is left out.
        """
        for part in self.root:
            if tag_of(part) in {"link", "joint", "material"}:
                yield from part.iter(etree.Element)


def link_named(joint: etree._Element, end: str) -> str:
    """The link that a joint names as its ``"parent"`` or ``"child"``, "" where it names none."""
    element = first(joint, end)
    return "" if element is None else element.get("link", "")


def _by_name(elements: list[etree._Element]) -> dict[str, etree._Element]:
    found: dict[str, etree._Element] = {}
    for element in elements:
        found.setdefault(element.get("name", ""), element)
    return found
