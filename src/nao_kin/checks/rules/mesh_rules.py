"""Rules about shapes and mesh files."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.checks.subject import numbers
from nao_kin.errors import UrdfError, near_matches
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.outline import Defect, children, describe, first, link_named, shown, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.checks.subject import Subject

__all__ = ["mesh_contents", "mesh_files", "missing_collisions", "shapes"]

_SHAPES = {"box", "cylinder", "sphere", "mesh"}
_ABSOLUTE = re.compile(r"file:|/|[A-Za-z]:[\\/]", re.IGNORECASE)
_LARGEST = 20.0  # [m] of a link; a mesh in millimetres is a hundred times larger
_SMALLEST = 1e-4  # [m]
_LISTED = 500  # files of a folder that a hint is looked for among
_BYTES = 64 * 1024 * 1024
"""How much mesh is opened for one file unless more is asked for, which bounds the time that takes."""


def shapes(subject: Subject) -> Iterator[Defect]:
    """Every visual and collision element has a shape that URDF defines."""
    version = subject.outline.version
    known = _SHAPES | {"capsule"} if version >= FormatVersion.V1_1 else _SHAPES
    for link in subject.outline.links:
        for solid in (*children(link, "visual"), *children(link, "collision")):
            geometry = first(solid, "geometry")
            tags = [] if geometry is None else [tag_of(shape) for shape in geometry]
            if not tags or tags[0] not in known:  # other readers look at the first one only
                what = (
                    f"as its shape a <{tags[0][:40]}>, which URDF {version} does not define"
                    if any(tags[:1])
                    else "no shape"
                )
                message = f"The {describe(solid)} has {what}."
                hint = "Shapes: <box>, <cylinder>, <sphere>, <mesh>, inside <geometry>."
                if tags[:1] == ["capsule"]:
                    hint = 'Capsules came with 1.1: write <robot version="1.1">, or a cylinder and two spheres.'
                yield Defect("no-shape", solid if geometry is None else geometry, message, hint)


def missing_collisions(subject: Subject) -> Iterator[Defect]:
    """What moves and can be seen can be hit too, on a robot whose other links can."""
    outline = subject.outline
    solid = {link.get("name", "") for link in outline.links if first(link, "collision") is not None}
    if not solid:
        return  # a robot without any is meant to be looked at
    for joint in outline.moving:
        link = outline.link_by_name.get(link_named(joint, "child"))
        if link is not None and first(link, "visual") is not None and first(link, "collision") is None:
            message = f"The {describe(link)} moves and is drawn, but has no <collision>."
            hint = "Planners and simulators let everything pass through it."
            yield Defect("no-collision", link, message, hint, "name")


def mesh_files(subject: Subject) -> Iterator[Defect]:
    """Every mesh is named so that it is found on other machines, and is found where it may be looked for."""
    for mesh in subject.outline.meshes():
        filename = mesh.get("filename", "")
        if not filename.strip():
            continue  # the reader refuses it by itself
        if _ABSOLUTE.match(filename):
            message = f"The mesh {shown(filename)} is named by its place on one machine."
            hint = "Name it relative to the URDF, or as package://PACKAGE/path."
            yield Defect("mesh-absolute", mesh, message, hint, "filename")
        try:
            subject.mesh_path(filename)
        except UrdfError as refusal:
            yield Defect(refusal.code, mesh, refusal.reason, _remedy(refusal, filename, subject), "filename")


def _remedy(refusal: UrdfError, filename: str, subject: Subject) -> str:
    if refusal.code == "mesh-package":
        name = re.sub(r"^\w+:/*", "", filename).partition("/")[0]
        return f"Say where the package is: --package {name[:40]}=DIR." if "://" in filename else ""
    if refusal.code == "mesh-missing":
        name = filename.replace("\\", "/").rpartition("/")[2]
        near = near_matches(name[:64], _beside(filename, subject))
        return f"Did you mean {near[0]!r}?" if near else "Is the path right, in upper and lower case too?"
    return refusal.hint


def _beside(filename: str, subject: Subject) -> list[str]:
    """Names of some files in the folder where a relative mesh should be, if that is below the document's."""
    if subject.folder is None or "://" in filename or _ABSOLUTE.match(filename) or "\0" in filename:
        return []
    home = Path(os.path.realpath(subject.folder))
    folder = Path(os.path.realpath(home / filename.rpartition("/")[0]))
    if not folder.is_relative_to(home):
        return []
    try:
        return sorted(path.name for path in islice(folder.iterdir(), _LISTED))
    except OSError:
        return []


def mesh_contents(subject: Subject) -> Iterator[Defect]:
    """Every mesh that is found can be read, is not empty, and has the size of a robot's part."""
    read: dict[Path, _Content] = {}
    opened = 0
    for mesh in subject.outline.meshes():
        try:
            path = subject.mesh_path(mesh.get("filename", ""))
            size = path.stat().st_size
        except (UrdfError, OSError):
            continue  # reported as not found, or gone since
        if path not in read:
            opened += size
            if opened > _BYTES and not subject.thorough:
                message = f"From here on meshes were not opened: they have more than {_BYTES // 1024**2} MB together."
                yield Defect("meshes-not-opened", mesh, message, "Open them all with --thorough.", "filename")
                return
            read[path] = _content(path)
        yield from _content_defects(mesh, read[path])


@dataclass(frozen=True, slots=True)
class _Content:
    """What a mesh file holds: its largest coordinate [m], or the code and the reason why it cannot be told."""

    largest: float = 0.0
    code: str = ""
    reason: str = ""


def _content_defects(mesh: etree._Element, content: _Content) -> Iterator[Defect]:
    where = shown(mesh.get("filename", ""))
    if content.code:
        hint = "Export it again." if content.code != "meshes-not-opened" else ""
        yield Defect(content.code, mesh, f"The mesh {where} was not read: {content.reason}.", hint, "filename")
        return
    largest = content.largest * max(map(abs, numbers(mesh, "scale", 3) or (1.0,)))
    if not _SMALLEST <= largest <= _LARGEST:
        message = f"The mesh {where} reaches {largest:.4g} m from its origin."
        hint = "Is it in millimetres? Then scale it by 0.001." if largest > 1.0 else "Is its scale right?"
        yield Defect("mesh-unit", mesh, message, hint, "scale" if mesh.get("scale") else "filename")


def _content(path: Path) -> _Content:
    from nao_kin.urdf.mesh_scene import read_bodies  # trimesh takes a second

    try:
        bodies = read_bodies(path)
    except LargeMeshError as error:
        return _Content(code="meshes-not-opened", reason=str(error))
    except UnreadableMeshError as error:
        return _Content(code="mesh-unreadable", reason=str(error))
    except OSError as error:
        return _Content(code="mesh-unreadable", reason=f"it cannot be opened ({error.strerror})")
    corners = [np.asarray(body.bounds) @ T[:3, :3].T + T[:3, 3] for body, T in bodies]
    if not corners and _claims_triangles(path):
        return _Content(code="mesh-unreadable", reason="it ends before the triangles that it announces")
    if not corners:
        return _Content(code="mesh-empty", reason="no triangles were found in it")
    largest = float(np.abs(corners).max())
    if not np.isfinite(largest):
        return _Content(code="mesh-unreadable", reason="it has coordinates that are not finite numbers")
    return _Content(largest)


def _claims_triangles(path: Path) -> bool:
    """Whether a file is a binary STL that announces triangles; the reader takes a truncated one for an empty one."""
    with path.open("rb") as file:
        head = file.read(84)
    return path.suffix.lower() == ".stl" and len(head) == 84 and not head.startswith(b"solid") and any(head[80:])
