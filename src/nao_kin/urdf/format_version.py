"""The version of the format that a file declares, on which the meaning of some words depends."""

from __future__ import annotations

import re
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lxml import etree

__all__ = ["FormatVersion", "declared_version"]

# urdfdom reads the two numbers with strtol, which passes leading blanks and zeros.
_DECLARED = re.compile(r"[ \t\r\n]*0*1\.0*([0-2])")


class FormatVersion(IntEnum):
    """The versions that urdfdom 6, the reader of ROS and Pinocchio, knows; later ones compare greater."""

    V1_0 = 0
    """What a file without a version is."""

    V1_1 = 1
    """Adds quaternions (``quat_xyzw``) to origins, and capsules."""

    V1_2 = 2
    """Demands both ends of a range, neither speed nor effort, and adds accelerations and jerk to limits."""

    def __str__(self) -> str:
        return f"1.{self.value}"


def declared_version(root: etree._Element) -> FormatVersion | None:
    """The version of a file by its root element: 1.0 where it declares none, None where readers know no such."""
    given = root.get("version")
    if given is None:
        return FormatVersion.V1_0
    found = _DECLARED.fullmatch(given)
    return FormatVersion(int(found[1])) if found else None
