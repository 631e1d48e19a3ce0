"""Rules about words: elements and attributes that URDF does not know, that stand in the wrong place, or twice."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lxml import etree

from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import Defect, describe, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.checks.subject import Subject

__all__ = ["LATER", "VOCABULARY", "instructions", "later_words", "repeated_elements", "unknown_words"]

LATER = {
    ("origin", "quat_xyzw"): FormatVersion.V1_1,
    ("limit", "acceleration"): FormatVersion.V1_2,
    ("limit", "deceleration"): FormatVersion.V1_2,
    ("limit", "jerk"): FormatVersion.V1_2,
}
"""Attributes that only a later version of the format than 1.0 reads, by element."""

_LIKENESS = 0.72  # "orgin" and "lower_limit" are meant words, "kinematic" and "surface" are words of other programs
_LENGTHS = 2  # characters left out or typed twice; "gear_velocity" is a word of its own
_COMPARED = 64  # longer words are not compared: the time that takes grows with the square of their length


@dataclass(frozen=True, slots=True)
class Words:
    """What may stand inside an element.

    Attributes:
        once: Child elements of which only the first counts.
        many: Child elements that may be repeated.
        attributes: Attributes.
    """

    once: tuple[str, ...] = ()
    many: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


_SOLID = Words(once=("origin", "geometry", "material"), attributes=("name",))

VOCABULARY: dict[str, Words] = {
    "robot": Words(
        many=("link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control", "mujoco"),
        attributes=("name", "version"),
    ),
    "link": Words(once=("inertial",), many=("visual", "collision"), attributes=("name",)),
    "inertial": Words(once=("origin", "mass", "inertia")),
    "mass": Words(attributes=("value",)),
    "inertia": Words(attributes=("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    "origin": Words(attributes=("xyz", "rpy", "quat_xyzw")),
    "visual": _SOLID,
    "collision": _SOLID,
    "geometry": Words(once=("box", "cylinder", "sphere", "mesh", "capsule")),
    "box": Words(attributes=("size",)),
    "cylinder": Words(attributes=("radius", "length")),
    "capsule": Words(attributes=("radius", "length")),
    "sphere": Words(attributes=("radius",)),
    "mesh": Words(attributes=("filename", "scale")),
    "material": Words(once=("color", "texture"), attributes=("name",)),
    "color": Words(attributes=("rgba",)),
    "texture": Words(attributes=("filename",)),
    "joint": Words(
        once=("origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "calibration", "safety_controller"),
        attributes=("name", "type"),
    ),
    "parent": Words(attributes=("link",)),
    "child": Words(attributes=("link",)),
    "axis": Words(attributes=("xyz",)),
    "limit": Words(attributes=("lower", "upper", "velocity", "effort", "acceleration", "deceleration", "jerk")),
    "mimic": Words(attributes=("joint", "multiplier", "offset")),
    "dynamics": Words(attributes=("damping", "friction")),
    "calibration": Words(attributes=("rising", "falling", "reference_position")),
    "safety_controller": Words(attributes=("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity")),
}
"""What URDF allows inside each element that describes the robot."""

_NOT_OURS = {"transmission", "gazebo", "sensor", "ros2_control", "mujoco"}  # other programs' own languages
_PLACES: dict[str, list[str]] = {}
for _parent, _words in VOCABULARY.items():
    for _child in (*_words.once, *_words.many):
        _PLACES.setdefault(_child, []).append(_parent)


def later_words(subject: Subject) -> Iterator[Defect]:
    """No attribute stands there that means something only in a later version of the format than the file's."""
    version = subject.outline.version
    later = {place: since for place, since in LATER.items() if since > version}
    if not later:
        return
    tags = {tag for tag, _ in later}
    for element in subject.outline.described():
        if (tag := tag_of(element)) not in tags:
            continue
        for (owner, attribute), since in later.items():
            if owner == tag and element.get(attribute) is not None:
                message = f"The {attribute} of the {describe(element)} is not read in a file of version {version}."
                hint = f'It came with {since}: write <robot version="{since}">, or remove it.'
                yield Defect("later-version", element, message, hint, attribute)


def instructions(subject: Subject) -> Iterator[Defect]:
    """No processing instruction follows what opens the file."""
    text = subject.positions.text
    if text.count("<?") > text.startswith("<?"):
        for offset in subject.positions.instructions():
            message = "The file holds a processing instruction, for which ROS and Pinocchio refuse it."
            yield Defect("processing-instruction", subject.outline.root, message, "Remove <?…?>.", offset=offset)


def unknown_words(subject: Subject) -> Iterator[Defect]:
    """Every element and attribute is one that URDF knows, in the place where it means something."""
    pending = [subject.outline.root]
    while pending:
        element = pending.pop()
        words = VOCABULARY[tag_of(element)]
        for attribute in map(str, element.attrib):
            if not attribute.startswith("{") and attribute not in words.attributes:
                yield _unknown_attribute(element, attribute, words)
        for child in element.iterchildren(etree.Element):
            tag = tag_of(child)
            if tag in words.once or tag in words.many:
                pending.extend([child] if tag not in _NOT_OURS else [])
            elif tag:  # a prefixed element belongs to another vocabulary
                yield _unknown_element(element, child, words)


def _unknown_attribute(element: etree._Element, attribute: str, words: Words) -> Defect:
    where = describe(element)
    if near := _meant(attribute, words.attributes):
        message = f"The {where} has the attribute {shown(attribute)}, which URDF does not know."
        return Defect("misspelt-attribute", element, message, f"Did you mean {near!r}?", attribute)
    message = f"The attribute {shown(attribute)} of the {where} is not part of URDF and is not read."
    known = ", ".join(words.attributes)
    return Defect("unknown-attribute", element, message, f"Known here: {known}." if known else "", attribute)


def _unknown_element(parent: etree._Element, child: etree._Element, words: Words) -> Defect:
    tag, where = tag_of(child), describe(parent)
    if tag in _PLACES and tag_of(parent) != "robot":
        message = f"A <{tag}> in the {where} means nothing."
        return Defect("misplaced-element", child, message, f"It belongs in {_listed(_PLACES[tag])}.")
    if near := _meant(tag, (*words.once, *words.many)):
        message = f"The {where} holds a <{shown(tag)[1:-1]}>, which URDF does not know."
        return Defect("misspelt-element", child, message, f"Did you mean <{near}>?")
    if tag in _PLACES:
        message = f"A <{tag}> directly in the {where} means nothing."
        return Defect("misplaced-element", child, message, f"It belongs in {_listed(_PLACES[tag])}.")
    message = f"The element <{shown(tag)[1:-1]}> in the {where} is not part of URDF and is not read."
    return Defect("unknown-element", child, message)


def repeated_elements(subject: Subject) -> Iterator[Defect]:
    """No element of which only the first counts is there twice."""
    for element in subject.outline.described():
        words, seen = VOCABULARY.get(tag_of(element)), set[str]()
        if words is None:
            continue
        # A geometry holds one shape, whichever it is.
        one_shape = tag_of(element) == "geometry"
        for child in element.iterchildren(etree.Element):
            tag = tag_of(child)
            if tag not in words.once or tag in {"parent", "child"}:  # the reader refuses those by itself
                continue
            kind = "shape" if one_shape else tag
            if kind in seen:
                what = "second shape" if one_shape else f"second <{tag}>"
                message = f"The {what} of the {describe(element)} is not read: only the first counts."
                yield Defect("repeated-element", child, message, "Remove one of the two.")
            seen.add(kind)


def _meant(word: str, known: Iterable[str]) -> str:
    """The known word that this one is probably meant to be, or ""."""
    if len(word) > _COMPARED:
        return ""
    folded = word.casefold()
    alike = [name for name in known if abs(len(name) - len(folded)) <= _LENGTHS]
    near = max(alike, key=lambda name: _likeness(folded, name), default="")
    return near if near and _likeness(folded, near) >= _LIKENESS else ""


def _likeness(word: str, name: str) -> float:
    if sorted(word) == sorted(name):
        return 1.0  # letters in another order, as xzy
    return difflib.SequenceMatcher(None, word, name).ratio()


def _listed(parents: list[str]) -> str:
    texts = [f"<{parent}>" for parent in parents]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} or {texts[-1]}"
