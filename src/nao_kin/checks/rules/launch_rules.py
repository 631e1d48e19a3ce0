"""Rules about what ROS 2 trips over on the way from a file to its nodes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from nao_kin.urdf.outline import Defect, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.subject import Subject

__all__ = ["blanks_in_names", "colons_in_comments"]

_COMMENT = re.compile(r"<!--(.*?)-->|<!\[CDATA\[.*?\]\]>", re.DOTALL)


def blanks_in_names(subject: Subject) -> Iterator[Defect]:
    """No link and no joint has a blank in its name."""
    for element in (*subject.outline.links, *subject.outline.joints):
        name = element.get("name", "")
        if name.strip() and re.search(r"\s", name):
            message = f"The name {shown(name)} of a {tag_of(element)} has a blank in it."
            hint = f"Call it {shown(re.sub(r'[ ]+', '_', name.strip()))}: tf and controllers split names at blanks."
            yield Defect("blank-in-name", element, message, hint, "name")


def colons_in_comments(subject: Subject) -> Iterator[Defect]:
    """No comment holds a colon and a blank, which make a mapping of the text when launch takes it for YAML.

    One finding a file, at the first: with one way to start the robot all of them matter, with the other none does.
    """
    text = subject.positions.text
    if "<!--" not in text:
        return
    for comment in _COMMENT.finditer(text):
        colon = -1 if comment[1] is None else comment[1].find(": ")
        if colon >= 0:
            message = 'A comment holds ": ", for which launch may take the whole description for YAML and refuse it.'
            hint = "In the launch file write ParameterValue(Command(...), value_type=str), or drop the colon."
            yield Defect("colon-in-comment", subject.outline.root, message, hint, offset=comment.start(1) + colon)
            return
