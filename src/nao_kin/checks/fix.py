"""Repairs of a URDF that cannot change its kinematics, as edits of its text: comments and formatting stay.

Each repair replaces or inserts a stretch of text. What comes out is read again and held against what went in; a repair
that would move a link, a limit or a mass is a defect of this module, and nothing is handed out then.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from nao_kin.checks.diff import compare_robots
from nao_kin.checks.rules.figure_rules import quaternions_of_other_length
from nao_kin.checks.rules.inertia_rules import moving_without_inertia
from nao_kin.checks.rules.joint_rules import axes_of_other_length
from nao_kin.checks.rules.name_rules import duplicate_materials
from nao_kin.checks.subject import Subject, numbers
from nao_kin.errors import InvalidInputError, UrdfError
from nao_kin.robot.robot import Robot
from nao_kin.urdf.document import parse_urdf
from nao_kin.urdf.foreign import undeclared_prefixes
from nao_kin.urdf.outline import Outline, children, describe, line_of, tag_of
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.safe_xml import read_tree
from nao_kin.urdf.values import swapped_limits

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.urdf.document import UrdfDocument

__all__ = ["Fix", "Repair", "fix_urdf"]

_GAZEBO: Final = "http://playerstage.sourceforge.net/gazebo/xmlschema/#"
_NAMESPACES: Final = {prefix: _GAZEBO + prefix for prefix in ("sensor", "controller", "interface", "body", "geom")}
"""What the prefixes of Gazebo's first versions stand for, of which many files have kept the elements."""

_DIGITS = 15
_INERTIAL: Final = (
    '<inertial><origin xyz=""/><mass value=""/><inertia ixx="" ixy="" ixz="" iyy="" iyz="" izz=""/></inertial>'
)


@dataclass(frozen=True, slots=True)
class Repair:
    """One edit of the text.

    Attributes:
        code: The finding that it mends.
        line: Line of the file as it was.
        what: What is done, one sentence.
        start: First character that is replaced.
        end: The one behind the last; equal to `start` where text is put in only.
        text: What stands there afterwards.
    """

    code: str
    line: int
    what: str
    start: int = field(repr=False)
    end: int = field(repr=False)
    text: str = field(repr=False)


@dataclass(frozen=True, slots=True)
class Fix:
    """A file with its repairs.

    Attributes:
        path: How the file is named.
        before: Its text.
        after: Its text with all repairs.
        repairs: In file order.
        swapped: Lines of limits with their ends swapped, which are exchanged only if that is asked for.
    """

    path: str
    before: str = field(repr=False)
    after: str = field(repr=False)
    repairs: tuple[Repair, ...]
    swapped: tuple[int, ...] = ()

    def diff(self) -> str:
        """What changes, as a unified diff."""
        before, after = (text.splitlines(keepends=True) for text in (self.before, self.after))
        return "".join(difflib.unified_diff(before, after, self.path, f"{self.path} (fixed)"))


def fix_urdf(data: bytes, path: str = "<urdf>", *, swap_limits: bool = False) -> Fix:
    """Repair what can be repaired without a change of kinematics.

    Axes and quaternions get length 1, materials that are defined twice alike lose the second definition, prefixes are
    declared, and links that move without a mass get a comment with an <inertial> to fill in.

    Args:
        data: The file.
        path: How messages name it.
        swap_limits: Exchange the ends of limits that are swapped, which nobody but the robot's maker can confirm.

    Returns:
        The text before and after, and what was done.

    Raises:
        UrdfError: The file cannot be read.
    """
    document = parse_urdf(data, path)
    root = read_tree(data, path)
    subject = Subject(path, data, Outline(root), Positions.of(data, root))
    repairs = [*_units(subject), *_materials(subject), *_prefixes(subject), *_inertials(subject)]
    swapped = list(swapped_limits(subject.outline))
    if swap_limits:
        repairs.extend(repair for defect in swapped for repair in _exchanged(subject, defect.at))
    repairs.sort(key=lambda repair: repair.start)
    text = after = subject.positions.text
    for repair in reversed(repairs):
        after = after[: repair.start] + repair.text + after[repair.end :]
    _require_same(document, after, path)
    lines = () if swap_limits else tuple(subject.positions.place(defect).line for defect in swapped)
    return Fix(path, text, after, tuple(repairs), lines)


def _units(subject: Subject) -> Iterator[Repair]:
    for rule, attribute, count in ((axes_of_other_length, "xyz", 3), (quaternions_of_other_length, "quat_xyzw", 4)):
        for defect in rule(subject):
            values, span = numbers(defect.at, attribute, count), subject.positions.value_span(defect.at, attribute)
            if values and span:
                length = math.hypot(*values)
                text = " ".join(f"{value / length:.{_DIGITS}g}" for value in values)
                what = f"The {attribute} of the {describe(defect.at)} gets length 1."
                yield Repair(defect.code, line_of(defect.at), what, *span, text)


def _materials(subject: Subject) -> Iterator[Repair]:
    """Second definitions that say the same as the first."""
    seen: dict[str, etree._Element] = {}
    for material in children(subject.outline.root, "material"):
        seen.setdefault(material.get("name", ""), material)
    for defect in duplicate_materials(subject):
        first, span = seen[defect.at.get("name", "")], subject.positions.element_span(defect.at)
        if span and _content(first) == _content(defect.at):
            start, end = span
            text = subject.positions.text
            blank = re.search(r"\n?[ \t]*$", text[:start])
            start = start if blank is None else blank.start()
            what = f"The second, equal {describe(defect.at)} {defect.at.get('name', '')!r} is removed."
            yield Repair(defect.code, line_of(defect.at), what, start, end, "")


def _content(element: etree._Element) -> list[tuple[str, list[tuple[str, str]]]]:
    return [(str(e.tag), sorted((str(k), str(v)) for k, v in e.attrib.items())) for e in element.iter("*")]


def _prefixes(subject: Subject) -> Iterator[Repair]:
    span = subject.positions.name_span(subject.outline.root)
    for defect in undeclared_prefixes(subject.outline):
        found = re.match(r"The prefix of '([^:']+):", defect.message)
        if span and found:
            name = _NAMESPACES.get(found[1], f"urn:{found[1]}")
            what = f"The prefix {found[1]!r} is declared."
            line = line_of(subject.outline.root)
            yield Repair(defect.code, line, what, span[1], span[1], f' xmlns:{found[1]}="{name}"')


def _inertials(subject: Subject) -> Iterator[Repair]:
    """Comments that say what is missing; a mass nobody has measured is not made up."""
    for defect in moving_without_inertia(subject):
        span = subject.positions.tag_span(defect.at)
        if defect.code != "missing-inertia" or span is None or tag_of(defect.at) != "link":
            continue
        text = subject.positions.text
        indent = re.search(r"[ \t]*$", text[: span[0]])
        margin = "\n" + ("" if indent is None else indent[0]) + "  "
        what = f"A comment says that the {describe(defect.at)} lacks its inertial."
        comment = f"{margin}<!-- missing, to be measured {_INERTIAL} -->"
        yield Repair(defect.code, line_of(defect.at), what, span[1], span[1], comment)


def _exchanged(subject: Subject, limit: etree._Element) -> Iterator[Repair]:
    spans = [subject.positions.value_span(limit, side) for side in ("lower", "upper")]
    if spans[0] is None or spans[1] is None:
        return  # one of them is absent and counts as 0
    texts = [limit.get(side, "") for side in ("upper", "lower")]
    for span, text, side in zip(spans, texts, ("lower", "upper"), strict=True):
        if span is not None:
            what = f"The {side} of the {describe(limit)} becomes {text}."
            yield Repair("inverted-limit", line_of(limit), what, *span, text)


def _require_same(before: UrdfDocument, text: str, path: str) -> None:
    """What was repaired means the same, but for limits that were swapped.

    Raises:
        InvalidInputError: It does not.
    """
    try:
        after = parse_urdf(text.encode(), path)
    except UrdfError as refusal:
        raise InvalidInputError(f"{path}, repaired", "a file that is read", str(refusal)) from None
    swapped = {joint.name for joint in before.joints if joint.limit is not None and joint.limit.swapped}
    found = compare_robots(Robot.from_document(before), Robot.from_document(after))
    for difference in found.differences:
        if not (difference.kind == "limit" and difference.name in swapped):
            said = f"{difference.kind} of {difference.name}: {difference.said}"
            raise InvalidInputError(f"{path}, repaired", "the same robot as before", said)
