"""Mesh files that a URDF names, found only where the caller allows it to look.

A file name in a URDF is a stranger's wish. It is granted when the file it leads to, with every symbolic link followed,
is a regular file of a mesh format below one of the allowed folders; what it leads to otherwise is never opened.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias
from urllib.parse import unquote

from nao_kin.errors import UrdfError
from nao_kin.urdf.outline import shown
from nao_kin.urdf.packages import PackageRoots, is_below, own_package, packages_named
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["MESH_SUFFIXES", "MeshRoots", "resolve_mesh"]

MeshRoots: TypeAlias = PackageRoots
"""Package folders by package name, or folders that hold packages."""

MESH_SUFFIXES = frozenset({".dae", ".obj", ".off", ".ply", ".stl"})
"""Endings of the formats that are read, in lower case: no wish for a key or a password file gets further than this."""

# At least two letters, so that a Windows drive is no scheme.
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):(?://)?(.*)", re.DOTALL)
_PACKAGE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,254}")
_ROOTS_HINT = "Name the folder that holds it as a mesh root."


class _RefusedError(Exception):
    """Why a wish is not granted; the caller adds the place."""

    def __init__(self, code: str, reason: str, hint: str = "") -> None:
        self.code, self.reason, self.hint = code, reason, hint
        super().__init__(reason)


def resolve_mesh(
    filename: str,
    document_directory: str | os.PathLike[str] | None,
    roots: MeshRoots = (),
    *,
    path: str = "<urdf>",
    line: int | None = None,
) -> Path:
    """Find a mesh that a URDF names.

    ``package://NAME/rest`` and ``model://NAME/rest`` are looked up in the given roots and then upwards from the
    document: a folder called NAME above it, or beside one of the folders above it, then in
    ``AMENT_PREFIX_PATH`` and ``ROS_PACKAGE_PATH``. ``file://`` and absolute names must
    lie below an allowed folder, and relative names start at the document. Allowed are the given roots, the document's
    folder, the package it is part of (the nearest folder above with a ``package.xml``) and the package found by name.

    Args:
        filename: The name as it stands in the file.
        document_directory: Folder of the URDF; None for a document without a file.
        roots: Package folders by name, or folders that hold packages.
        path: How messages name the URDF.
        line: Line of the element that names the mesh.

    Returns:
        The real path of a regular file below an allowed folder, no larger than `ReadLimits.mesh_bytes`.

    Raises:
        UrdfError: There is no such file, it lies elsewhere, is not a mesh by its ending, not a regular file, too large,
            or the name is a web address or not a name at all.
    """
    directory = None if document_directory is None else Path(document_directory).absolute()
    if isinstance(roots, str):  # a sequence too, of letters
        roots = (roots,)
    try:
        return _resolve(filename, directory, roots)
    except _RefusedError as refusal:
        reason = f"The mesh {shown(filename)} {refusal.reason}."
        raise UrdfError(path, line, reason, refusal.hint, code=refusal.code) from None


def _resolve(filename: str, directory: Path | None, roots: MeshRoots) -> Path:
    if "\0" in filename or not filename.strip():
        raise _RefusedError("mesh-name", "is not a file name")
    if len(filename) > LIMITS.value_characters:
        raise _RefusedError("mesh-name", f"has more than {LIMITS.value_characters} characters")
    if Path(filename).suffix.lower() not in MESH_SUFFIXES:
        formats = ", ".join(sorted(MESH_SUFFIXES))
        raise _RefusedError("mesh-format", f"is not of a mesh format that is read ({formats})")
    allowed = _allowed_folders(directory, roots)
    outside = looked = False
    for candidate, package in _candidates(filename, directory, roots):
        looked = True
        try:
            real = Path(os.path.realpath(candidate, strict=True))
        except (OSError, ValueError):
            continue  # missing, unreadable, a circle of symbolic links: not there
        if is_below(real, allowed if package is None else [*allowed, package]):
            return _checked(real)
        outside = True
    if outside:
        raise _RefusedError("mesh-outside", "lies outside the folders that may be read", _ROOTS_HINT)
    if not looked:
        raise _RefusedError("mesh-package", "is not there", _ROOTS_HINT)
    raise _RefusedError("mesh-missing", "is not there", _ROOTS_HINT)


def _candidates(filename: str, directory: Path | None, roots: MeshRoots) -> Iterator[tuple[Path, Path | None]]:
    """Where the file may be, best first, each with the package folder that its name has opened, if any."""
    match = _SCHEME.match(filename)
    scheme, rest = (match[1].lower(), match[2]) if match else ("", filename)
    if scheme in {"package", "model"}:
        # Some exporters write three slashes.
        name, _, inside = rest.lstrip("/").partition("/")
        if not _PACKAGE.fullmatch(name):
            raise _RefusedError("mesh-name", "names no package")
        for folder, given in packages_named(name, directory, roots):
            yield folder / inside.lstrip("/"), None if given else folder
        return
    if scheme == "file":
        rest = unquote(rest.removeprefix("localhost"))
        if "\0" in rest or not rest.startswith("/"):
            raise _RefusedError("mesh-name", "is not an absolute file address")
    elif scheme:
        raise _RefusedError("mesh-name", f"is an address of kind {scheme[:20]!r}; only files are read")
    if directory is None and not rest.startswith("/"):
        raise _RefusedError("mesh-package", "is relative, but the document has no folder")
    yield (directory or Path("/")) / rest, None


def _allowed_folders(directory: Path | None, roots: MeshRoots) -> list[Path]:
    given: Iterable[str | os.PathLike[str]] = roots.values() if isinstance(roots, Mapping) else roots
    folders = [Path(root) for root in given]
    if directory is not None:
        folders.append(directory)
        if (package := own_package(directory)) is not None:
            folders.append(package)
    return [Path(os.path.realpath(folder)) for folder in folders]


def _checked(real: Path) -> Path:
    try:
        status = real.stat()
    except OSError as error:
        raise _RefusedError("mesh-unreadable", f"cannot be read: {error.strerror}") from None
    if not stat.S_ISREG(status.st_mode):
        raise _RefusedError("mesh-unreadable", "is not a regular file")
    if real.suffix.lower() not in MESH_SUFFIXES:  # a symbolic link may end otherwise than what it leads to
        raise _RefusedError("mesh-format", "leads to a file that is not a mesh by its ending")
    if status.st_size > LIMITS.mesh_bytes:
        reason = f"has {status.st_size} bytes; at most {LIMITS.mesh_bytes} are read"
        raise _RefusedError("mesh-unreadable", reason)
    return real
