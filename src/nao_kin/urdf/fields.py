"""Every number that is read from a URDF file: where it stands, how many there are, what it may be.

The rules check the file against this table and the reader takes its numbers from it, so the two cannot part.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import tag_of

if TYPE_CHECKING:
    from lxml import etree

__all__ = ["FIELDS", "Field", "NumberError", "decimal_numbers", "fields_of", "optional_number", "read_numbers"]


@dataclass(frozen=True, slots=True)
class Field:
    """One attribute that holds numbers.

    Attributes:
        attribute: Its name.
        count: How many numbers it holds.
        required: Whether the element means nothing without it.
        minimum: Smallest value allowed, or None.
        largest: Largest magnitude allowed.
        since: The version of the format that gave it a meaning.
    """

    attribute: str
    count: int = 1
    required: bool = False
    minimum: float | None = None
    largest: float = math.inf
    since: FormatVersion = FormatVersion.V1_0


_FAR = 1e9  # [m, rad, ratio] beyond it products of transforms lose every digit, or overflow
_ORIGIN = (
    Field("xyz", 3, largest=_FAR),
    Field("rpy", 3, largest=_FAR),
    Field("quat_xyzw", 4, largest=_FAR, since=FormatVersion.V1_1),
)
_ROUND = (Field("radius", required=True, minimum=0.0),)
_INERTIA = tuple(Field(name, required=True) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
_COLOUR = (Field("rgba", 4, required=True),)


def _solid_fields(tag: str) -> dict[tuple[str, ...], tuple[Field, ...]]:
    geometry = ("link", tag, "geometry")
    return {
        ("link", tag, "origin"): _ORIGIN,
        (*geometry, "box"): (Field("size", 3, required=True, minimum=0.0),),
        (*geometry, "cylinder"): (*_ROUND, Field("length", required=True, minimum=0.0)),
        (*geometry, "capsule"): (
            Field("radius", required=True, minimum=0.0, since=FormatVersion.V1_1),
            Field("length", required=True, minimum=0.0, since=FormatVersion.V1_1),
        ),
        (*geometry, "sphere"): _ROUND,
        (*geometry, "mesh"): (Field("scale", 3),),
        ("link", tag, "material", "color"): _COLOUR,
    }


FIELDS: dict[tuple[str, ...], tuple[Field, ...]] = {
    ("link", "inertial", "origin"): _ORIGIN,
    ("link", "inertial", "mass"): (Field("value", required=True, minimum=0.0),),
    ("link", "inertial", "inertia"): _INERTIA,
    **_solid_fields("visual"),
    **_solid_fields("collision"),
    ("material", "color"): _COLOUR,
    ("joint", "origin"): _ORIGIN,
    ("joint", "axis"): (Field("xyz", 3),),
    ("joint", "limit"): (
        Field("lower"),
        Field("upper"),
        Field("velocity", minimum=0.0),
        Field("effort", minimum=0.0),
        *(Field(name, minimum=0.0, since=FormatVersion.V1_2) for name in ("acceleration", "deceleration", "jerk")),
    ),
    ("joint", "mimic"): (Field("multiplier", largest=_FAR), Field("offset", largest=_FAR)),
}
"""Fields by the path of their element below the root."""

_BY_VERSION = {
    version: {path: tuple(field for field in fields if field.since <= version) for path, fields in FIELDS.items()}
    for version in FormatVersion
}
_LONGEST_PATH = max(map(len, FIELDS))
_LEAVES = frozenset(path[-1] for path in FIELDS)

# float() would also take hexadecimal-looking words, "nan", "infinity", "1_000" and digits of other scripts.
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_WORD = re.compile(r"[^ \t\r\n]+")  # the blanks of XML; str.split() knows many more


def fields_of(element: etree._Element, version: FormatVersion) -> tuple[Field, ...]:
    """The number fields that a version gives an element, by where it stands; empty for every other element."""
    if tag_of(element) not in _LEAVES:
        return ()
    path: list[str] = []
    node = element
    while (parent := node.getparent()) is not None:
        path.insert(0, tag_of(node))
        if len(path) > _LONGEST_PATH:
            return ()
        node = parent
    return _BY_VERSION[version].get(tuple(path), ())


class NumberError(ValueError):
    """A text does not hold the numbers it should; the message is a predicate, the code names the broken rule."""

    def __init__(self, code: str, predicate: str) -> None:
        self.code = code
        super().__init__(predicate)


def decimal_numbers(text: str, count: int) -> tuple[float, ...]:
    """Read exactly `count` finite decimal numbers separated by blanks.

    Raises:
        NumberError: There are more or fewer, or one is not a finite decimal number; the message is a predicate such as
            "holds 2 numbers instead of 3".
    """
    words = _WORD.findall(text)
    if len(words) != count:
        numbers = "1 number" if len(words) == 1 else f"{len(words)} numbers"
        raise NumberError("wrong-count", f"holds {numbers if words else 'no number'} instead of {count}")
    for word in words:
        if not _DECIMAL.fullmatch(word):
            code = "not-finite" if _NOT_FINITE.fullmatch(word) else "not-a-number"
            raise NumberError(code, f"holds {word[:40]!r}, which is not a finite decimal number")
    values = tuple(map(float, words))
    for word, value in zip(words, values, strict=True):
        if not math.isfinite(value):
            predicate = f"holds {word[:40]!r}, which is beyond the largest number a computer can hold"
            raise NumberError("not-finite", predicate)
    return values


def read_numbers(element: etree._Element | None, attribute: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """The numbers of an attribute that the rules have passed, `default` where element or attribute is missing."""
    text = None if element is None else element.get(attribute)
    return default if text is None else decimal_numbers(text, len(default))


def optional_number(element: etree._Element, attribute: str) -> float | None:
    """One number of an attribute that the rules have passed, None where it is missing."""
    text = element.get(attribute)
    return None if text is None else decimal_numbers(text, 1)[0]
