"""Mutants of URDF files: what editors, scripts, transfers and attackers do to them, by a seeded generator."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Final, TypeVar

from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

__all__ = ["mutant"]

T = TypeVar("T")

WORDS: Final = (
    *("", " ", "0", "-0", "1", "-1", "1e-320", "1e308", "-1e308", "1e400", "nan", "inf", "-inf", "0x10", "1,5", "1_0"),
    *(" 1 ", "1\t2\n3", "1 2", "1 2 3 4", "90 0 0", "0 0 0", "9" * 400, "٣", "1e", "+", ".", "1..2", "infinity"),
    *("base_link", "torso", "universe", "fixed", "revolute", "floating", "planar", "prismatic", "continuous"),
    *("<script>alert(1)</script>", "__proto__", "../../../etc/passwd.stl", "package://../x.stl", "file:///dev/zero"),
    *("${pi}", "$(find x)", "'\"", "a\u202eb", "\U0001f916", "x" * 300, "http://localhost/x.dae", "%00", "\\..\\x.stl"),
)
"""Values that have broken readers."""

TAGS: Final = (
    *("link", "joint", "origin", "axis", "limit", "mimic", "inertial", "mass", "inertia", "visual", "collision"),
    *("geometry", "mesh", "box", "sphere", "cylinder", "parent", "child", "material", "dynamics", "safety_controller"),
    *("inerta", "orign", "Link", "gazebo", "transmission", "robot"),
)
ATTRIBUTES: Final = ("name", "type", "xyz", "rpy", "link", "lower", "upper", "value", "joint", "multiplier", "version")
ENCODINGS: Final = ("utf-16", "utf-32", "latin-1", "utf-8-sig")
MARKS: Final = (b"<!--", b"<![CDATA[", b"&amp;", b"<?x ?>", b"\0", b"]]>", b"<a>")
FACTORS: Final = (-1.0, 0.0, 1e-6, 1e-3, 0.5, 57.29578, 1e3, 1e6, 1e12, 1e300)


def mutant(source: bytes, rng: np.random.Generator) -> bytes:
    """The file with one to three things done to it."""
    data = source
    for _ in range(int(rng.integers(1, 4))):
        if rng.random() < 0.15:
            data = _on_bytes(data, rng)
            continue
        try:
            root = etree.fromstring(data)
        except (etree.XMLSyntaxError, ValueError):
            return data  # spoilt already
        _on_tree(list(root.iter(etree.Element)), rng)
        data = etree.tostring(root)
    return data


def _on_tree(elements: list[etree._Element], rng: np.random.Generator) -> None:
    element, other = pick(elements, rng), pick(elements, rng)
    kind = int(rng.integers(8))
    if kind < 3:
        _on_number(element, rng)
    elif kind < 5:
        _on_attribute(element, other, rng)
    else:
        _on_structure(element, other, rng)


def _on_number(element: etree._Element, rng: np.random.Generator) -> None:
    names = list(element.attrib)
    if not names:
        return
    name = pick(names, rng)
    words = str(element.get(name, "")).split()
    place = int(rng.integers(max(len(words), 1)))
    try:
        number = f"{float(words[place]) * pick(FACTORS, rng)!r}"
    except (ValueError, IndexError):
        number = pick(WORDS, rng)
    if rng.random() < 0.3:
        number = pick(WORDS, rng)
    words[place : place + 1] = [number]
    _set(element, str(name), " ".join(words))


def _on_attribute(element: etree._Element, other: etree._Element, rng: np.random.Generator) -> None:
    names = list(element.attrib)
    name = str(pick(names, rng)) if names else "name"
    match int(rng.integers(5)):
        case 0:
            element.attrib.pop(name, "")
        case 1:
            _set(element, name, pick(WORDS, rng))
        case 2:
            _set(element, pick(ATTRIBUTES, rng), str(element.attrib.pop(name, "x")))
        case 3:
            _set(element, name, str(other.get(name, pick(WORDS, rng))))
        case _:
            _set(element, pick(ATTRIBUTES, rng), pick(WORDS, rng))


def _on_structure(element: etree._Element, other: etree._Element, rng: np.random.Generator) -> None:
    parent = element.getparent()
    if parent is None:
        return
    match int(rng.integers(7)):
        case 0:
            parent.remove(element)
        case 1:
            parent.append(copy.deepcopy(element))
        case 2:
            if len(list(element.iter())) < 200:
                other.append(copy.deepcopy(element))
        case 3:
            element.tag = pick(TAGS, rng)
        case 4:
            parent.insert(0, element)
        case 5:
            etree.SubElement(element, pick(TAGS, rng))
        case _:
            for _ in range(int(rng.integers(1, 80))):
                element = etree.SubElement(element, "a")


def _on_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    start = int(rng.integers(len(data) + 1))
    end = min(len(data), start + int(rng.integers(1, 200)))
    match int(rng.integers(8)):
        case 0:
            return data[:start]
        case 1:
            return data[:start] + data[end:]
        case 2:
            return data[:start] + bytes(rng.integers(0, 256, 3, dtype="uint8")) + data[start:]
        case 3:
            return data[:start] + data[start:end] * 3 + data[end:]
        case 4:
            return data.decode("utf-8", "replace").encode(pick(ENCODINGS, rng), "replace")
        case 5:
            return b'<!DOCTYPE robot [<!ENTITY a SYSTEM "/dev/zero"><!ENTITY b "&a;&a;">]>' + data
        case 6:
            return data.replace(b'"', b"'")
        case _:
            return data[:start] + pick(MARKS, rng) + data[start:]


def _set(element: etree._Element, name: str, value: str) -> None:
    try:
        element.set(name, value)
    except ValueError:  # what XML has no way to write
        element.set(name, "x")


def pick(options: Sequence[T], rng: np.random.Generator) -> T:
    """One of the options."""
    return options[int(rng.integers(len(options)))]
