"""ROS packages by name: where a file of ours, a given folder or an installed ROS has them."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["PackageRoots", "holds_package", "is_below", "is_private", "own_package", "packages_named"]

PackageRoots: TypeAlias = "Mapping[str, str | os.PathLike[str]] | Sequence[str | os.PathLike[str]]"
"""Package folders by package name, or folders that hold packages."""

_DEPTH = 3  # levels below a folder of ROS_PACKAGE_PATH at which a package is looked for
_MOST_FOLDERS = 2000
_MANIFEST_BYTES = 64 * 1024
_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_.+-]{1,255})\s*</name>")


def packages_named(name: str, directory: Path | None, roots: PackageRoots) -> Iterator[tuple[Path, bool]]:
    """Folders that may be the package of that name, best first, each with whether it was given by the caller.

    Looked at are the given roots, then what is above the document and beside what is above it, then
    ``AMENT_PREFIX_PATH`` and ``ROS_PACKAGE_PATH``.
    """
    for folder in _given(name, roots):
        yield folder, True
    for folder in _above(name, directory):
        yield folder, False
    for folder in _installed(name):
        yield Path(os.path.realpath(folder)), False


def _given(name: str, roots: PackageRoots) -> Iterator[Path]:
    if isinstance(roots, Mapping):
        if name in roots:
            yield Path(roots[name])
        return
    for root in map(Path, roots):
        yield root / name
        if name in {root.absolute().name, _manifest_name(root)}:
            yield root


def _above(name: str, directory: Path | None) -> Iterator[Path]:
    for folder in () if directory is None else (directory, *directory.parents):
        if not is_private(folder) and (folder.name == name or _manifest_name(folder) == name):
            yield Path(os.path.realpath(folder))
        beside = folder / name
        if not _is_folder(beside) or is_private(beside):
            continue
        if is_private(folder) and not holds_package(beside):
            continue
        real = Path(os.path.realpath(beside))
        # A symbolic link that came with the document must not turn a folder elsewhere into a package of it.
        if is_below(real, [Path(os.path.realpath(folder))]):
            yield real


def _installed(name: str) -> Iterator[Path]:
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        folder = Path(prefix) / "share" / name
        if holds_package(folder):
            yield folder
    for root in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        yield from _crawled(Path(root), name)


def _crawled(root: Path, name: str) -> Iterator[Path]:
    """The packages of that name at most a few levels below a folder; nothing is looked for inside a package."""
    level, seen = [root], 0
    for _ in range(_DEPTH + 1):
        below: list[Path] = []
        for folder in level:
            seen += 1
            if seen > _MOST_FOLDERS:
                return
            if holds_package(folder):
                if folder.name == name or _manifest_name(folder) == name:
                    yield folder
                continue
            try:
                below.extend(sorted(Path(entry.path) for entry in os.scandir(folder) if entry.is_dir()))
            except OSError:
                continue
        level = below


def own_package(directory: Path) -> Path | None:
    """The package that a folder is part of: the nearest above it with a ``package.xml``, None where there is none."""
    found = next((folder for folder in (directory, *directory.parents) if holds_package(folder)), None)
    return None if found is None or is_private(found) else found


def _manifest_name(folder: Path) -> str:
    """What a folder's ``package.xml`` calls the package, "" where there is none."""
    if not holds_package(folder):
        return ""
    try:
        with (folder / "package.xml").open("rb") as file:
            found = _NAME.search(file.read(_MANIFEST_BYTES))
    except OSError:
        return ""
    return found[1].decode() if found else ""


def is_private(folder: Path) -> bool:
    """Whether a folder is /, directly below it, or holds the user's home: too much is in there to open it by a name."""
    home = Path(os.path.expanduser("~"))  # noqa: PTH111 (pathlib raises where there is no home)
    return len(folder.parts) <= len(("/", "home")) or home.is_relative_to(folder)


def is_below(real: Path, folders: Sequence[Path]) -> bool:
    """Whether a real path is one of the folders or lies below one."""
    return any(real.is_relative_to(folder) for folder in folders)


def holds_package(folder: Path) -> bool:
    """Whether a folder has a ``package.xml``."""
    return os.path.isfile(folder / "package.xml")  # noqa: PTH113 (pathlib raises where a folder may not be entered)


def _is_folder(path: Path) -> bool:
    return os.path.isdir(path)  # noqa: PTH112 (as above)
