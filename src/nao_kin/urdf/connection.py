"""Structural rules about how joints connect links into a tree and follow one another."""

from __future__ import annotations

import heapq
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from nao_kin.errors import near_matches
from nao_kin.urdf.outline import MOVING, Defect, Outline, describe, first, line_of, link_named, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from lxml import etree

__all__ = [
    "cycles",
    "link_references",
    "mimic_cycles",
    "mimic_references",
    "near_hint",
    "no_links",
    "rings",
    "several_roots",
    "two_parents",
]

_CLOSELY = 20
_COMPARED = 64  # longer names are not compared: the time that takes grows with the square of their length


def link_references(outline: Outline) -> Iterator[Defect]:
    """Every joint has a parent and a child, both are links of the file, and they differ."""
    for joint in outline.joints:
        where = describe(joint)
        for end in ("parent", "child"):
            element, name = first(joint, end), link_named(joint, end)
            if element is None:
                yield Defect(f"no-{end}", joint, f"The {where} has no <{end}>.", f'Add <{end} link="..."/>.')
            elif not name:
                message = f"The <{end}> of the {where} names no link."
                yield Defect(f"no-{end}", element, message, f'Write <{end} link="..."/>.')
            elif name not in outline.link_by_name:
                message = f"The {end} {shown(name)} of the {where} is not a link of this file."
                yield Defect(f"unknown-{end}", element, message, near_hint(name, outline.link_by_name), "link")
        parent = link_named(joint, "parent")
        if parent and parent == link_named(joint, "child"):
            message = f"The {where} connects the link {shown(parent)} with itself."
            yield Defect("self-joint", joint, message, "Name two different links.")


def mimic_references(outline: Outline) -> Iterator[Defect]:
    """A follower names a moving joint of the file other than itself."""
    for joint in outline.moving:
        mimic = first(joint, "mimic")
        if mimic is None:
            continue
        leader, where = mimic.get("joint", ""), describe(joint)
        if not leader:
            message = f"The <mimic> of the {where} names no joint."
            yield Defect("unknown-leader", mimic, message, 'Write <mimic joint="..."/>.')
        elif leader == joint.get("name"):
            yield Defect("self-mimic", mimic, f"The {where} mimics itself.", "Name another joint.", "joint")
        elif leader not in outline.joint_by_name:
            message = f"The {where} mimics {shown(leader)}, which is not a joint of this file."
            yield Defect("unknown-leader", mimic, message, near_hint(leader, outline.joint_by_name), "joint")
        elif outline.joint_by_name[leader].get("type") not in MOVING:
            message = f"The {where} mimics {shown(leader)}, which does not move."
            yield Defect("fixed-leader", mimic, message, "Name a joint that moves, or make this one fixed.", "joint")
        elif _is_zero(mimic.get("multiplier")):
            message = f"The {where} mimics {shown(leader)} with multiplier 0 or next to it."
            yield Defect("zero-multiplier", mimic, message, "Make the joint fixed if it is not to move.", "multiplier")


def _is_zero(text: str | None) -> bool:
    try:
        return text is not None and abs(float(text)) < 1e-9
    except ValueError:  # another rule's defect
        return False


def no_links(outline: Outline) -> Iterator[Defect]:
    """There is something to move."""
    if not outline.links:
        yield Defect("no-links", outline.root, "The robot has no links.", 'Add at least <link name="base_link"/>.')


def two_parents(outline: Outline) -> Iterator[Defect]:
    """A link is the child of at most one joint."""
    claimed: dict[str, etree._Element] = {}
    for joint in outline.joints:
        child = link_named(joint, "child")
        if child in claimed:
            message = f"The link {shown(child)} is the child of the {describe(claimed[child])} already."
            hint = "A URDF is a tree: close a loop in the program, not in the file."
            yield Defect("two-parents", joint, message, hint)
        claimed.setdefault(child, joint)


def several_roots(outline: Outline) -> Iterator[Defect]:
    """Only one link is not the child of a joint."""
    roots = [link for link in outline.links if not outline.child_counts[link.get("name", "")]]
    for link in roots[1:]:
        message = f"The {describe(link)} hangs on no joint, and neither does the {describe(roots[0])}."
        yield Defect("several-roots", link, message, "Connect them by a joint, or remove one.", "name")


def cycles(outline: Outline) -> Iterator[Defect]:
    """Going from child to parent always ends at the root."""
    joint_above = {link_named(joint, "child"): joint for joint in reversed(outline.joints)}
    above = {child: link_named(joint, "parent") for child, joint in joint_above.items()}
    found: list[Defect] = []
    for ring in rings(above):
        joint = min((joint_above[name] for name in ring), key=line_of)
        message = f"The links {_listed(ring)} form a closed loop, which no root reaches."
        found.append(Defect("cycle", joint, message, "A URDF is a tree: give one of these joints another child."))
    yield from sorted(found, key=lambda defect: defect.line)


def mimic_cycles(outline: Outline) -> Iterator[Defect]:
    """Going from follower to leader always ends at a joint that follows none."""
    mimic_of = {
        joint.get("name", ""): mimic for joint in outline.moving if (mimic := first(joint, "mimic")) is not None
    }
    leaders = {name: mimic.get("joint", "") for name, mimic in mimic_of.items()}
    found: list[Defect] = []
    for ring in rings(leaders):
        if len(ring) == 1:
            continue  # reported as mimicking itself
        mimic = min((mimic_of[name] for name in ring), key=line_of)
        message = f"The joints {_listed(ring)} mimic one another in a circle."
        found.append(Defect("mimic-cycle", mimic, message, "One of them has to lead.", "joint"))
    yield from sorted(found, key=lambda defect: defect.line)


def rings(successor: dict[str, str]) -> list[list[str]]:
    """The closed rings of a map from each name to the next, in time proportional to its size."""
    done: set[str] = set()
    rings: list[list[str]] = []
    for start in successor:
        trail: dict[str, None] = {}
        name = start
        while name in successor and name not in done and name not in trail:
            trail[name] = None
            name = successor[name]
        if name in trail:
            walked = list(trail)
            rings.append(walked[walked.index(name) :])
        done.update(trail)
    return rings


def _listed(names: list[str]) -> str:
    texts = [shown(name) for name in names[:6]]
    return ", ".join(texts) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def near_hint(name: str, known: Iterable[str]) -> str:
    """Which known names a name may be meant to be, as a question; "" where none is near."""
    if len(name) > _COMPARED:
        return ""
    # The names with most pairs of letters in common first: to compare with all takes seconds in a hostile file.
    pairs, short = _pairs(name), (candidate for candidate in known if len(candidate) <= _COMPARED)
    likely = heapq.nlargest(_CLOSELY, short, key=lambda candidate: len(pairs & _pairs(candidate)))
    near = near_matches(name, likely)
    return f"Did you mean {' or '.join(map(repr, near))}?" if near else ""


@lru_cache(maxsize=4096)
def _pairs(name: str) -> frozenset[str]:
    """The pairs of neighbouring letters of a name."""
    folded = name.casefold()
    return frozenset(map("".join, pairwise(folded)))
