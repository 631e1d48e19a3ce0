"""Rules about the tree of links beyond those that the reader enforces."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.urdf.connection import rings
from nao_kin.urdf.outline import Defect, describe, link_named

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.subject import Subject

__all__ = ["unreachable_links"]


def unreachable_links(subject: Subject) -> Iterator[Defect]:
    """Going from a link to its parents never ends in a closed loop that the link is not part of."""
    joints = reversed(subject.outline.joints)
    above = {link_named(joint, "child"): link_named(joint, "parent") for joint in joints}
    looped = {name for ring in rings(above) for name in ring}
    lost = set(looped)
    for link in subject.outline.links:
        trail: list[str] = []
        name = link.get("name", "")
        while name in above and name not in lost and len(trail) <= len(above):
            trail.append(name)
            name = above[name]
        if name in lost:
            lost.update(trail)
        if link.get("name", "") in lost - looped:
            message = f"The {describe(link)} hangs below a closed loop, so no root reaches it."
            yield Defect("unreachable-link", link, message, "Open the loop above it.", "name")
