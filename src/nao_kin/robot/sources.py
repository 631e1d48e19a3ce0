"""What a name or a path stands for: the file behind it, read, and what is known about the robot beyond it."""

from __future__ import annotations

import os
import warnings
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.robot.known import KnownRobot, find_known, robot_file
from nao_kin.urdf import UrdfWarning, read_urdf
from nao_kin.urdf.xacro import is_xacro_file, read_xacro

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nao_kin.robot.descriptions import Description
    from nao_kin.urdf import UrdfDocument
    from nao_kin.urdf.packages import PackageRoots

__all__ = ["SUFFIXES", "Reading", "given_arguments", "is_path", "read_source", "reading", "tell"]

SUFFIXES = (".urdf", ".xacro", ".srdf", ".xml", ".mjcf")
"""Endings by which text is a path, not a name."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What files of macros are expanded with.

    Attributes:
        arguments: Values of their ``<xacro:arg>``.
        packages: Package folders by name, or folders that hold packages.
    """

    arguments: Mapping[str, object] = field(default_factory=dict)
    packages: PackageRoots = ()


_READING: ContextVar[Reading] = ContextVar("reading")


@contextmanager
def reading(arguments: Mapping[str, object], packages: PackageRoots) -> Iterator[None]:
    """While it lasts, files of macros are expanded with these unless a caller says otherwise, as one command does."""
    token = _READING.set(Reading(arguments, packages))
    try:
        yield
    finally:
        _READING.reset(token)


def given_arguments() -> Mapping[str, object]:
    """The arguments that files of macros are expanded with unless a caller says otherwise."""
    return _READING.get(Reading()).arguments


def is_path(robot: str | os.PathLike[str]) -> bool:
    """Whether a path is meant and not a name, by the rule of `nao_kin.load`."""
    return not isinstance(robot, str) or robot.endswith(SUFFIXES) or os.sep in robot


def read_source(
    robot: str | os.PathLike[str], arguments: Mapping[str, object] | None = None, packages: PackageRoots = ()
) -> tuple[UrdfDocument, KnownRobot | None]:
    """The content of the file that is meant, and the known robot that it belongs to, if it is one.

    Raises:
        UnknownNameError, MissingExtraError, UrdfError, InvalidInputError: See `nao_kin.load`.
    """
    path, known, usual = robot, None, _READING.get(Reading())
    given = usual.arguments if arguments is None else arguments
    packages = packages or usual.packages
    if not is_path(robot):
        try:
            known = find_known(os.fspath(robot))
            path = robot_file(known)
        except UnknownNameError as unknown:
            if not os.path.isfile(robot):  # noqa: PTH113 - false, where Path would raise, for a name too long
                described = _described(os.fspath(robot), unknown)
                path, given = described.path, {**described.arguments, **given}
                packages = packages or described.packages
                title = f"{described.name} of robot_descriptions.py"
                file = os.fspath(described.path)
                known = KnownRobot(described.name, title, file, "robot_descriptions", described.chains)
    if is_xacro_file(path):
        return read_xacro(path, given, packages), known
    if is_mjcf_file(path):
        from nao_kin.robot.mjcf import read_mjcf

        return read_mjcf(path), known
    if arguments:
        raise InvalidInputError("arguments", "a file of macros (.xacro) that takes them", os.fspath(robot))
    return read_urdf(path), known


def _described(name: str, unknown: UnknownNameError) -> Description:
    """The description of that name; the error that no robot has it, where none has."""
    from nao_kin.robot.descriptions import find_description

    try:
        return find_description(name)
    except UnknownNameError as error:
        raise (unknown if unknown.near or not error.near else error) from None


def is_mjcf_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file is one of MuJoCo, by its name."""
    return os.fspath(path).endswith((".xml", ".mjcf"))


def tell(document: UrdfDocument, stacklevel: int = 2) -> None:
    """Warn, once for a file, about what it was read in spite of."""
    if document.tolerated:
        told = "; ".join(text.rstrip(".") for text in document.tolerated)
        said = f"{document.path} was read, but {told}. `nao-kin check` says what to do."
        warnings.warn(said, UrdfWarning, stacklevel=stacklevel + 1)
