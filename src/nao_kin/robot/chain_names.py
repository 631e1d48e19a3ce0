"""Chains that a robot has without being known: the groups of an SRDF beside its file, and its end links."""

from __future__ import annotations

import os
from itertools import pairwise
from typing import TYPE_CHECKING

from nao_kin.errors import UrdfError
from nao_kin.urdf.document import read_bytes
from nao_kin.urdf.outline import children
from nao_kin.urdf.safe_xml import read_tree

if TYPE_CHECKING:
    from lxml import etree

    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["end_chains", "srdf_chains"]

_FOLDERS = (".", "../srdf", "../config")
"""Where an SRDF is looked for, from the folder of the URDF."""

_MOST_FILES = 50


def end_chains(document: UrdfDocument) -> dict[str, tuple[str, str]]:
    """From the root to each link that nothing hangs on and something moves, by the link's name."""
    parents = {joint.parent for joint in document.joints}
    above = {joint.child: joint for joint in document.joints}
    found = {}
    for link in document.links:
        if link.name not in parents and _is_moved(link.name, above):
            found[link.name] = (document.root, link.name)
    return found


def _is_moved(link: str, above: dict[str, UrdfJoint]) -> bool:
    while link in above:
        if above[link].kind != "fixed":
            return True
        link = above[link].parent
    return False


def srdf_chains(document: UrdfDocument) -> dict[str, tuple[str, str]]:
    """The groups of an SRDF of the same robot name beside the file that are one chain; none where there is no SRDF.

    A group is a chain if it says so, or if its joints follow one another down the tree.
    """
    for folder in () if document.directory is None else _FOLDERS:
        place = document.directory / folder if document.directory else None
        try:
            files = sorted(p for p in place.iterdir() if p.suffix == ".srdf")[:_MOST_FILES] if place else []
        except OSError:
            continue
        for path in files:
            try:
                root = read_tree(read_bytes(os.fspath(path)), os.fspath(path))
            except UrdfError:
                continue  # `nao-kin check` says what is wrong with it
            if root.get("name") == document.name:
                return _groups(root, document)
    return {}


def _groups(root: etree._Element, document: UrdfDocument) -> dict[str, tuple[str, str]]:
    links, joints = {link.name for link in document.links}, {joint.name: joint for joint in document.joints}
    found = {}
    for group in children(root, "group"):
        ends: tuple[str, str] | None = None
        chains, named = children(group, "chain"), [each.get("name", "") for each in children(group, "joint")]
        if len(chains) == 1 and not named:
            ends = chains[0].get("base_link", ""), chains[0].get("tip_link", "")
        elif named and not chains and all(name in joints for name in named):
            ends = _in_line([joints[name] for name in named], document)
        if ends and links.issuperset(ends) and ends[0] != ends[1]:
            found[group.get("name", "")] = ends
    return found


def _in_line(joints: list[UrdfJoint], document: UrdfDocument) -> tuple[str, str] | None:
    """Where joints begin and end that follow one another down the tree, with fixed ones between them at most."""
    above = {joint.child: joint for joint in document.joints}
    for upper, lower in pairwise(joints):
        link = lower.parent
        while link != upper.child and link in above and above[link].kind == "fixed":
            link = above[link].parent
        if link != upper.child:
            return None
    return joints[0].parent, joints[-1].child
