"""What a URDF file must be before anything is computed from it, one rule a function.

A rule yields its defects in file order. Rules are grouped in stages, because a later stage means something only when
the earlier ones found nothing: an unexpanded xacro has no numbers yet, and a misspelt link name makes two roots.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TypeAlias

from lxml import etree

from nao_kin.errors import near_matches
from nao_kin.urdf import connection, foreign, values
from nao_kin.urdf.format_version import FormatVersion, declared_version
from nao_kin.urdf.outline import Defect, Outline, children, describe, line_of, shown, tag_of
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Rule: TypeAlias = Callable[[Outline], Iterator[Defect]]

__all__ = ["STAGES", "TOLERATED", "Defect", "Outline", "Rule", "defects", "first_defect", "tolerated_defects"]


def root_element(outline: Outline) -> Iterator[Defect]:
    """The root element is <robot>."""
    root, tag = outline.root, tag_of(outline.root)
    if tag == "robot":
        return
    hints = {
        "sdf": "It is an SDF file (Gazebo), for which Pinocchio's wheel has no reader; convert it to URDF first.",
        "mujoco": "It is an MJCF file (MuJoCo): named .xml it loads for kinematics; the rules are for URDF.",
    }
    given = shown(tag or str(root.tag))[1:-1]
    message = f"The root element is <{given}>, but a URDF begins with <robot>."
    yield Defect("not-robot", root, message, hints.get(tag, ""))


def format_version(outline: Outline) -> Iterator[Defect]:
    """The version of the format is one that readers know: of another nobody can say what its words mean."""
    root = outline.root
    if tag_of(root) == "robot" and declared_version(root) is None:
        message = f"The version {shown(root.get('version', ''))} of the format is none that readers know."
        known = ", ".join(map(str, FormatVersion))
        yield Defect("urdf-version", root, message, f"Versions: {known}; without one, 1.0.", "version")


def unexpanded_xacro(outline: Outline) -> Iterator[Defect]:
    """No ${...} or $(...) is left in what describes the robot, nor an element of xacro that it is not whole without."""
    hint = "Expand the file first: xacro file.xacro > file.urdf"
    described = {outline.root, *outline.described()}
    beside = {*foreign.xacro_beside(outline)}
    whole = bool(beside) and bool(outline.joints) and _is_whole(outline)
    for element in outline.root.iter(etree.Element):
        if str(element.tag).startswith("{") and foreign.is_xacro(element):
            if not (whole and element in beside):
                message = f"The element {foreign.xacro_name(element)} shows that the file is an unexpanded xacro."
                yield Defect("unexpanded-xacro", element, message, hint)
            continue
        if element not in described:
            continue  # simulators and controllers have $(...) of their own
        for attribute, value in element.attrib.items():
            text = str(value)
            if "${" in text or "$(" in text:
                message = f"The value {shown(text)} of {describe(element)} is an unexpanded xacro expression."
                yield Defect("unexpanded-xacro", element, message, hint, str(attribute))
                break


def _is_whole(outline: Outline) -> bool:
    """Whether what stands in the file is a tree of links without structural defects, whatever else is in it."""
    return not any(next(rule(outline), None) for stage in STAGES[2:] for rule in stage)


def too_many(outline: Outline) -> Iterator[Defect]:
    """The file stays within the numbers of links and joints that are read."""
    for what, elements, most in (
        ("links", outline.links, LIMITS.links),
        ("joints", outline.joints, LIMITS.links),  # in a tree there is one joint fewer than links
        ("moving joints", outline.moving, LIMITS.moving_joints),
    ):
        if len(elements) > most:
            message = f"The robot has {len(elements)} {what}; at most {most} are read."
            yield Defect("too-many", elements[most], message)


def names(outline: Outline) -> Iterator[Defect]:
    """The robot and every link, joint and named material have a usable name."""
    root = outline.root
    if root.get("name") is None:
        yield Defect("no-name", root, "The robot has no name.", 'Write <robot name="...">.')
    for element in (root, *(part for part in outline.described() if tag_of(part) in {"link", "joint", "material"})):
        name, what = element.get("name"), tag_of(element)
        required = tag_of(element) in {"link", "joint"} and element.getparent() is root
        if name is None or not name.strip():
            if required or (element is root and name is not None):
                yield Defect("no-name", element, f"A {what} has no name.", f'Write <{what} name="...">.', "name")
        elif fault := _name_fault(name):
            hint = "Give it a short name of letters, digits and underscores."
            yield Defect("bad-name", element, f"A {what} has {fault}.", hint, "name")


def _name_fault(name: str) -> str:
    if len(name) > LIMITS.name_characters:
        return f"a name of {len(name)} characters; at most {LIMITS.name_characters} are read"
    # Besides control characters str.isprintable rejects those that are invisible or reverse the writing direction.
    if not name.replace(" ", "").isprintable():
        return f"the name {shown(name)}, which contains control or invisible characters"
    return ""


def reserved_names(outline: Outline) -> Iterator[Defect]:
    """No joint and no moving link is called "universe", as Pinocchio calls the world and its joint 0."""
    for element in (*outline.links, *outline.joints):
        if element.get("name") == "universe" and (tag_of(element) == "joint" or outline.child_counts["universe"]):
            message = f"The name 'universe' of a {tag_of(element)} is reserved for the world."
            yield Defect("reserved-name", element, message, "Give it another name.", "name")


def duplicate_names(outline: Outline) -> Iterator[Defect]:
    """No two links and no two joints bear the same name; a link and a joint may."""
    for elements, firsts in ((outline.links, outline.link_by_name), (outline.joints, outline.joint_by_name)):
        for element in elements:
            name, what = element.get("name", ""), tag_of(element)
            if name and element is not firsts[name]:
                message = f"The {what} {shown(name)} exists already on line {line_of(firsts[name])}."
                yield Defect(f"duplicate-{what}", element, message, "Give each a name of its own.", "name")


def joint_types(outline: Outline) -> Iterator[Defect]:
    """Every joint is of a type with at most one number."""
    known = ("revolute", "continuous", "prismatic", "fixed")
    for joint in outline.joints:
        kind = joint.get("type")
        if kind in known:
            continue
        where = describe(joint)
        if kind is None:
            yield Defect("no-joint-type", joint, f"The {where} has no type.", f"Types: {', '.join(known)}.")
        elif kind in {"floating", "planar"}:
            message = f"The {where} is {kind}; only joints with one number each are supported."
            hint = "Leave it out (its child becomes the root) or replace it by single joints."
            yield Defect("unsupported-joint", joint, message, hint, "type")
        else:
            near = near_matches(kind[:64], known, limit=1)
            hint = f"Did you mean {near[0]!r}?" if near else f"Types: {', '.join(known)}."
            message = f"The {where} has the unknown type {shown(kind)}."
            yield Defect("unknown-joint-type", joint, message, hint, "type")


def single_parts(outline: Outline) -> Iterator[Defect]:
    """A joint has one parent and one child element, so that readers cannot disagree about which counts."""
    for joint in outline.joints:
        counts = Counter(tag_of(part) for part in joint)
        for tag in ("parent", "child"):
            if counts[tag] > 1:
                second = children(joint, tag)[1]
                message = f"The {describe(joint)} has {counts[tag]} <{tag}> elements."
                yield Defect("repeated-end", second, message, "Keep one.")


STAGES: tuple[tuple[Rule, ...], ...] = (
    (root_element, format_version),
    (unexpanded_xacro,),
    (too_many,),
    (
        names,
        reserved_names,
        duplicate_names,
        joint_types,
        single_parts,
        connection.link_references,
        values.number_fields,
        values.zero_axes,
        values.missing_limits,
        values.rotations,
        values.incomplete_ranges,
        values.inverted_limits,
        values.mesh_names,
        connection.mimic_references,
    ),
    (
        connection.no_links,
        connection.two_parents,
        connection.several_roots,
        connection.cycles,
        connection.mimic_cycles,
    ),
)
"""All structural rules; the reader refuses a file for the first defect of the first stage that has one."""


TOLERATED: tuple[Rule, ...] = (
    foreign.undeclared_prefixes,
    foreign.leftover_xacro,
    values.idle_limits,
    values.swapped_limits,
    values.axes_without_direction,
)
"""Rules on what every reader gets past: such a file is read, and whoever reads it is told."""


def defects(root: etree._Element) -> Iterator[Defect]:
    """Every structural defect of a file, rule by rule, up to and including the first stage that has any."""
    outline = Outline(root)
    for stage in STAGES:
        spoilt = False
        for rule in stage:
            for defect in rule(outline):
                spoilt = True
                yield defect
        if spoilt:
            return


def first_defect(outline: Outline) -> Defect | None:
    """The defect that stands first in the file, among those of the first stage that has any; None for a sound file."""
    for stage in STAGES:
        # Rules yield in file order, so the first of each is enough: a file full of defects costs no more than one.
        found = [defect for rule in stage if (defect := next(rule(outline), None)) is not None]
        if found:
            return min(found, key=lambda defect: defect.line)
    return None


def tolerated_defects(outline: Outline) -> list[Defect]:
    """What is wrong with a file that is read all the same, in file order."""
    return sorted((defect for rule in TOLERATED for defect in rule(outline)), key=lambda defect: defect.line)
