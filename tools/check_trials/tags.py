"""The start tags of a file with their places, by expat: another parser than the one under trial."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Tag", "tags_of"]

_TAG = re.compile(r"<[^\s/>]+(?:[^\"'>]|\"[^\"]*\"|'[^']*')*>")


@dataclass(slots=True)
class Tag:
    """One element of a text.

    Attributes:
        text: The text, one character a byte.
        path: Its element names below the root, with slashes; "" for the root.
        start: Where its start tag begins.
        end: Where its start tag ends.
        stop: Where the element ends.
        attributes: Its attributes.
        owner: The link or joint that it is part of or is.
    """

    text: str
    path: str
    start: int
    end: int
    stop: int
    attributes: dict[str, str]
    owner: Tag | None = None

    @property
    def tag(self) -> str:
        """The start tag."""
        return self.text[self.start : self.end]

    @property
    def name(self) -> str:
        """Name of the link or joint around it."""
        return self.owner.attributes.get("name", "") if self.owner else ""

    @property
    def kind(self) -> str:
        """Type of the joint around it."""
        return self.owner.attributes.get("type", "") if self.owner else ""

    def numbers(self, attribute: str) -> list[float]:
        """An attribute's numbers; none where it is missing."""
        return [float(word) for word in self.attributes.get(attribute, "").split()]

    def replaced(self, tag: str) -> str:
        """The text with another start tag here."""
        return self.text[: self.start] + tag + self.text[self.end :]

    def removed(self) -> str:
        """The text without the element."""
        return self.text[: self.start] + self.text[self.stop :]

    def with_values(self, **values: str) -> str:
        """The text with other values of attributes that are there."""
        tag = self.tag
        for attribute, value in values.items():
            quoted = f'="{value}"'
            tag = re.sub(rf"(?<=\s){attribute}\s*=\s*(\"[^\"]*\"|'[^']*')", attribute + quoted, tag, count=1)
        return self.replaced(tag)


def tags_of(data: bytes) -> list[Tag]:
    """Every element of a well-formed file, in file order."""
    text, parser = data.decode("latin-1"), expat.ParserCreate()
    found: list[Tag] = []
    open_tags: list[Tag] = []

    def begin(name: str, attributes: dict[str, str]) -> None:
        start = parser.CurrentByteIndex
        match = _TAG.match(text, start)
        path = "/".join([*open_tags[-1].path.split("/"), name]).lstrip("/") if open_tags else ""
        tag = Tag(text, path, start, match.end() if match else start, 0, attributes)
        around = open_tags[-1].owner if open_tags else None
        tag.owner = tag if path in {"link", "joint"} else around
        found.append(tag)
        open_tags.append(tag)

    def close(_name: str) -> None:
        tag = open_tags.pop()
        empty = tag.tag.endswith("/>")
        tag.stop = tag.end if empty else text.index(">", parser.CurrentByteIndex) + 1

    parser.StartElementHandler, parser.EndElementHandler = begin, close
    parser.Parse(data, True)
    return found


def line_at(text: str, offset: int) -> int:
    """The line of a place in a text, 1-based."""
    return text.count("\n", 0, offset) + 1


def with_path(tags: list[Tag], path: str) -> Iterator[Tag]:
    """The elements of that path."""
    return (tag for tag in tags if tag.path == path)
