"""Where in the text of a file an element and its attributes stand, for messages that point at them.

libxml2 keeps one line number an element, that of the end of its start tag. Here the start tags of the text are matched
with the elements of the tree by their order, which is the same for both.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from lxml import etree

from nao_kin.urdf.outline import line_of

if TYPE_CHECKING:
    from nao_kin.urdf.outline import Defect

__all__ = ["Place", "Positions"]

# Comments, character data and processing instructions are matched too, so that no tag is seen inside them. The text is
# known to be well-formed; the possessive quantifiers keep the pattern linear all the same.
_START_TAG = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>"
    r"|<(?P<name>[^\s<>/!?\"'=]+)(?P<inside>(?:[^<>\"']|\"[^\"]*\"|'[^']*')*+)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"(?P<name>[^\s<>/\"'=]+)\s*=\s*(?P<value>\"[^\"]*\"|'[^']*')")


@dataclass(frozen=True, slots=True)
class Place:
    """A stretch of one line, counted from 1 in characters; column and width are 0 where only the line is known."""

    line: int
    column: int = 0
    width: int = 0


@dataclass(frozen=True)
class Positions:
    """The places of the elements of a tree in the text that it was read from.

    Attributes:
        text: The text, without a byte order mark.
        root: Root of the tree.
    """

    text: str
    root: etree._Element

    @classmethod
    def of(cls, data: bytes, root: etree._Element) -> Positions:
        """The places in bytes that the safe reader has passed."""
        return cls(data.decode("utf-8-sig", "replace"), root)

    def place(self, defect: Defect) -> Place:
        """Where a defect shows: the value of its attribute if it has one there, else the element's tag."""
        if defect.offset >= 0:
            return self._place(defect.offset, defect.offset + 1)
        tag = self._tags.get(defect.at)
        if tag is None:
            return Place(line_of(defect.at))
        if defect.attribute and (span := self._attribute_span(tag, defect.attribute)):
            return self._place(*span)
        return self._place(tag.start() + 1, tag.end("name"))

    def raw_value(self, element: etree._Element, attribute: str) -> str | None:
        """An attribute's value as it stands in the text, before XML has made blanks of its line breaks and tabs."""
        tag = self._tags.get(element)
        span = None if tag is None else self._attribute_span(tag, attribute)
        return None if span is None else self.text[span[0] : span[1]]

    def value_span(self, element: etree._Element, attribute: str) -> tuple[int, int] | None:
        """First character of an attribute's value and the one behind its last; None where the text has none."""
        tag = self._tags.get(element)
        return None if tag is None else self._attribute_span(tag, attribute)

    def name_span(self, element: etree._Element) -> tuple[int, int] | None:
        """The same of an element's name in its start tag."""
        tag = self._tags.get(element)
        return None if tag is None else tag.span("name")

    def tag_span(self, element: etree._Element) -> tuple[int, int] | None:
        """The same of an element's start tag."""
        tag = self._tags.get(element)
        return None if tag is None else tag.span()

    def element_span(self, element: etree._Element) -> tuple[int, int] | None:
        """The same of a whole element, which holds no other element of its own name."""
        tag = self._tags.get(element)
        if tag is None or tag[0].endswith("/>"):
            return None if tag is None else tag.span()
        closing = re.compile(rf"</{re.escape(tag['name'])}\s*>").search(self.text, tag.end())
        return None if closing is None else (tag.start(), closing.end())

    def instructions(self) -> list[int]:
        """Where processing instructions begin that do not open the file, as the XML declaration does, in file order."""
        starts, opening = [], True
        for token in _START_TAG.finditer(self.text):
            instruction = token[0].startswith("<?")
            opening = opening and instruction
            if instruction and not opening:
                starts.append(token.start())
        return starts

    def line_text(self, line: int) -> str:
        """The text of a line, "" beyond the end."""
        lines = self._line_starts
        if not 1 <= line <= len(lines):
            return ""
        end = lines[line] - 1 if line < len(lines) else len(self.text)
        return self.text[lines[line - 1] : end].rstrip("\r")

    def _attribute_span(self, tag: re.Match[str], attribute: str) -> tuple[int, int] | None:
        for found in _ATTRIBUTE.finditer(self.text, *tag.span("inside")):
            if found["name"] == attribute:
                return found.start("value") + 1, found.end("value") - 1
        return None

    def _place(self, start: int, end: int) -> Place:
        line = bisect_right(self._line_starts, start)
        first = self._line_starts[line - 1]
        stop = self.text.find("\n", start, end)
        return Place(line, start - first + 1, max((end if stop < 0 else stop) - start, 1))

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0, *(found.end() for found in re.finditer("\n", self.text))]

    @cached_property
    def _tags(self) -> dict[etree._Element, re.Match[str]]:
        tags = [found for found in _START_TAG.finditer(self.text) if found["name"]]
        elements = list(self.root.iter(etree.Element))
        return dict(zip(elements, tags, strict=True)) if len(tags) == len(elements) else {}
