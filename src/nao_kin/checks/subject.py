"""The file under examination, as the rules see it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

from nao_kin.errors import UrdfError
from nao_kin.urdf.document import document_of
from nao_kin.urdf.fields import NumberError, decimal_numbers
from nao_kin.urdf.resources import resolve_mesh

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from lxml import etree

    from nao_kin.robot.known import KnownRobot
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.outline import Defect, Outline
    from nao_kin.urdf.positions import Positions
    from nao_kin.urdf.resources import MeshRoots
    from nao_kin.urdf.xacro import Expansion

    Rule: TypeAlias = Callable[["Subject"], Iterator[Defect]]

__all__ = ["Rule", "Subject", "numbers"]


@dataclass(frozen=True)
class Subject:
    """One file: its text, its tree, where its meshes may be, and, where the structure is sound, its model.

    Attributes:
        path: How messages name it.
        data: Its bytes.
        outline: Its tree.
        positions: Where in the text the elements stand.
        folder: Folder of the file; None for a text that was not read from one.
        packages: Mesh roots, see `nao_kin.urdf.resolve_mesh`.
        thorough: Whether rules that take seconds are wanted.
        known: What is known about the robot beyond the file, if anything.
        expansion: The macros that the text was expanded from, if it was.
    """

    path: str
    data: bytes = field(repr=False)
    outline: Outline
    positions: Positions = field(repr=False)
    folder: Path | None = None
    packages: MeshRoots = ()
    thorough: bool = False
    known: KnownRobot | None = None
    expansion: Expansion | None = None

    @cached_property
    def document(self) -> UrdfDocument:
        """The file's content; only for a file without structural defects."""
        return document_of(self.outline, self.data, self.path)

    @cached_property
    def robot(self) -> Robot:
        """The model; only for a file without structural defects."""
        from nao_kin.robot.robot import Robot  # Pinocchio: only when there is a model to compute with

        return Robot.from_document(self.document, self.known)

    def mesh_path(self, filename: str) -> Path:
        """Where a mesh is that the file names.

        Raises:
            UrdfError: See `nao_kin.urdf.resolve_mesh`.
        """
        if filename not in self._mesh_paths:
            try:
                self._mesh_paths[filename] = resolve_mesh(filename, self.folder, self.packages)
            except UrdfError as refusal:
                self._mesh_paths[filename] = refusal
        found = self._mesh_paths[filename]
        if isinstance(found, UrdfError):
            raise found
        return found

    @cached_property
    def _mesh_paths(self) -> dict[str, Path | UrdfError]:
        return {}

    def joint(self, name: str) -> etree._Element:
        """The element of a joint that is known to be there."""
        return self.outline.joint_by_name[name]

    def link(self, name: str) -> etree._Element:
        """The element of a link that is known to be there."""
        return self.outline.link_by_name[name]


def numbers(element: etree._Element | None, attribute: str, count: int = 1) -> tuple[float, ...] | None:
    """The numbers of an attribute; None where it is missing or malformed, which other rules report."""
    text = None if element is None else element.get(attribute)
    if text is None:
        return None
    try:
        return decimal_numbers(text, count)
    except NumberError:
        return None
