"""The one way in for a URDF file: nothing else in this package opens one."""

from __future__ import annotations

import hashlib
import os
import stat
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from nao_kin.errors import UnknownNameError, UrdfError
from nao_kin.urdf.outline import Outline
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.reader import read_joints, read_links
from nao_kin.urdf.safe_xml import read_tree
from nao_kin.urdf.size_limits import LIMITS
from nao_kin.urdf.structure import first_defect, tolerated_defects
from nao_kin.urdf.writer import kinematic_xml

if TYPE_CHECKING:
    from nao_kin.urdf.elements import UrdfJoint, UrdfLink

__all__ = ["UNREADABLE", "UrdfDocument", "UrdfWarning", "document_of", "parse_urdf", "read_bytes", "read_urdf"]

UNREADABLE = "unreadable"
"""Code of the refusals that say nothing about a file's content, because there is none to read."""


class UrdfWarning(UserWarning):
    """A URDF file was read though something in it is wrong: all of it, with lines, in one warning a file."""


@dataclass(frozen=True)
class UrdfDocument:
    """A URDF file that has passed every structural rule: one tree of links, finite numbers, resolvable names.

    Attributes:
        path: The file as named by the caller.
        name: Name of the robot.
        sha256: Hexadecimal digest of the bytes that were read.
        links: Links in file order.
        joints: Joints in file order.
        root: Name of the one link that is no joint's child.
        directory: Folder of the file, for its meshes; None for a document that was not read from a file.
        tolerated: What is wrong with it though it was read, a sentence each, with the line.
    """

    path: str
    name: str
    sha256: str
    links: tuple[UrdfLink, ...] = field(repr=False)
    joints: tuple[UrdfJoint, ...] = field(repr=False)
    root: str
    directory: Path | None = None
    tolerated: tuple[str, ...] = ()

    @cached_property
    def _link_by_name(self) -> dict[str, UrdfLink]:
        return {link.name: link for link in self.links}

    @cached_property
    def _joint_by_name(self) -> dict[str, UrdfJoint]:
        return {joint.name: joint for joint in self.joints}

    def link(self, name: str) -> UrdfLink:
        """The link of that name.

        Raises:
            UnknownNameError: There is none; the error carries near matches.
        """
        if name not in self._link_by_name:
            raise UnknownNameError("link", name, self._link_by_name, self.name)
        return self._link_by_name[name]

    def joint(self, name: str) -> UrdfJoint:
        """The joint of that name, fixed ones included.

        Raises:
            UnknownNameError: There is none; the error carries near matches.
        """
        if name not in self._joint_by_name:
            raise UnknownNameError("joint", name, self._joint_by_name, self.name)
        return self._joint_by_name[name]

    def to_xml(self) -> str:
        """The kinematics and inertias as a URDF of our own making, which Pinocchio can be trusted to read.

        It holds links with inertials and joints with origins, axes and limits; neither shapes nor couplings. Axes are
        of unit length; every other number is bit for bit the one that was read. A velocity or effort limit that the
        file does not give is written as the largest finite number.
        """
        return kinematic_xml(self.name, self.links, self.joints)


def read_urdf(path: str | os.PathLike[str]) -> UrdfDocument:
    """Read a URDF file that may come from a stranger.

    Args:
        path: A regular file, or a symbolic link to one.

    Returns:
        Its content, checked.

    Raises:
        UrdfError: The file is missing, unreadable, not a regular file, too large, not UTF-8, not well-formed, declares
            a DOCTYPE, is an unexpanded xacro, or breaks a structural rule; with the line where there is one.
    """
    name = os.fspath(path)
    document = parse_urdf(read_bytes(name), name)
    return replace(document, directory=Path(name).absolute().parent)


def parse_urdf(data: bytes, path: str = "<urdf>") -> UrdfDocument:
    """Read a URDF from bytes that may come from a stranger.

    Args:
        data: The whole file, UTF-8.
        path: How messages name it.

    Returns:
        Its content, checked, without a directory.

    Raises:
        UrdfError: As `read_urdf` raises it for the content of a file.
    """
    tree = read_tree(data, path)
    outline = Outline(tree)
    defect = first_defect(outline)
    if defect is not None:
        line = Positions.of(data, tree).place(defect).line
        raise UrdfError(path, line, defect.message, defect.hint, code=defect.code)
    positions, tolerated = Positions.of(data, tree), tolerated_defects(outline)
    said = tuple(f"line {positions.place(defect).line}: {defect.message}" for defect in tolerated)
    return replace(document_of(outline, data, path), tolerated=said)


def document_of(outline: Outline, data: bytes, path: str) -> UrdfDocument:
    """The content of a tree that has passed every structural rule, and that was read from these bytes."""
    links, joints = read_links(outline), read_joints(outline)
    children = {joint.child for joint in joints}
    return UrdfDocument(
        path=path,
        name=outline.root.get("name", ""),
        sha256=hashlib.sha256(data).hexdigest(),
        links=links,
        joints=joints,
        root=next(link.name for link in links if link.name not in children),
    )


def read_bytes(path: str) -> bytes:
    """The bytes of a file that may come from a stranger, one more than the largest file has if there are more.

    Raises:
        UrdfError: The file is missing, unreadable, not a regular file, or too large.
    """
    try:
        # Looked at before it is opened, because opening alone can disturb a pipe or a device, and again afterwards,
        # because another file may have taken its place. O_NONBLOCK keeps a pipe from holding us up in that case.
        _check_regular(os.stat(path), path)  # noqa: PTH116 (a Path would change the spelling of the path)
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
        with os.fdopen(descriptor, "rb") as file:
            _check_regular(os.fstat(file.fileno()), path)
            return file.read(LIMITS.file_bytes + 1)  # one too many tells parse_urdf that the file has grown
    except UrdfError:  # which is a ValueError too
        raise
    except FileNotFoundError:
        raise UrdfError(path, None, "There is no such file.", code=UNREADABLE) from None
    except (OSError, ValueError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        raise UrdfError(path, None, f"The file cannot be read: {said}.", code=UNREADABLE) from None


def _check_regular(status: os.stat_result, path: str) -> None:
    kinds = {
        stat.S_IFDIR: "a directory",
        stat.S_IFIFO: "a named pipe",
        stat.S_IFSOCK: "a socket",
        stat.S_IFCHR: "a device",
        stat.S_IFBLK: "a device",
    }
    if not stat.S_ISREG(status.st_mode):
        kind = kinds.get(stat.S_IFMT(status.st_mode), "something else")
        raise UrdfError(path, None, f"A URDF is a regular file, but this is {kind}.", code=UNREADABLE)
    if status.st_size > LIMITS.file_bytes:
        reason = f"The file has {status.st_size} bytes; at most {LIMITS.file_bytes} are read."
        raise UrdfError(path, None, reason, code="too-large")
