"""Mesh files to triangles, in memory and without anything they refer to.

A mesh file is as untrusted as the URDF that names it. It is read as bytes, of a known format and a bounded size, and
parsed without a resolver: no texture, no material library, no external entity. Only vertices, faces and one colour a
part come out.
"""

from __future__ import annotations

import io
import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.urdf.limits import LIMITS
from nao_kin.view.crease import Indices, split_creases

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour

__all__ = ["FORMATS", "MAX_FACES", "Part", "UnreadableMeshError", "read_parts"]

FORMATS = ("dae", "obj", "off", "ply", "stl")
"""Formats that carry their geometry in one file and no pictures, by suffix."""

MAX_FACES = 1_000_000


class UnreadableMeshError(ValueError):
    """A mesh file cannot be shown; the text is the reason."""


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """One part of a mesh file: vertices (V, 3) [m], faces (F, 3), and its colour, None where the file names none."""

    vertices: Floats
    faces: Indices
    colour: Colour | None


def read_parts(path: Path) -> tuple[Part, ...]:
    """All parts of a mesh file, each at its place in the file's own frame, in metres.

    COLLADA's `<unit>` is applied and its `<up_axis>` is not, as the common URDF viewers do.

    Raises:
        UnreadableMeshError: Unknown format, too large, damaged, empty, or with numbers that are not finite.
        OSError: The file cannot be opened.
    """
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise UnreadableMeshError(f"meshes of type {path.suffix or '(none)'!r} are not read ({', '.join(FORMATS)} are)")
    with path.open("rb") as file:
        content = file.read(LIMITS.mesh_bytes + 1)
    if len(content) > LIMITS.mesh_bytes:
        raise UnreadableMeshError(f"larger than {LIMITS.mesh_bytes} bytes")
    if kind == "dae":
        content = _harmless_xml(content)
    parts = tuple(part for part in _scene_parts(_load(content, kind)) if len(part.faces))
    if not parts:
        raise UnreadableMeshError("it holds no triangles")
    if sum(len(part.faces) for part in parts) > MAX_FACES:
        raise UnreadableMeshError(f"more than {MAX_FACES} triangles")
    return parts


def _harmless_xml(content: bytes) -> bytes:
    """The same XML without a way out: parsed with entities off, refused with a DOCTYPE, written anew.

    The COLLADA reader's own parser expands entities without a limit, and takes archives for documents.
    """
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False)
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UnreadableMeshError(f"not well-formed XML ({error})") from error
    if root.getroottree().docinfo.internalDTD is not None:
        raise UnreadableMeshError("it has a DOCTYPE, which a mesh does not need")
    return etree.tostring(root)


def _load(content: bytes, kind: str) -> Any:
    """The content as a `trimesh.Scene`."""
    import trimesh

    log = logging.getLogger("trimesh")
    was_disabled, log.disabled = log.disabled, True  # it complains about each texture we do not let it read
    try:
        return trimesh.load_scene(io.BytesIO(content), file_type=kind, resolver=None, allow_remote=False)
    except Exception as error:  # the readers of the formats raise whatever they stumble on
        raise UnreadableMeshError(f"not a readable {kind.upper()} file ({type(error).__name__})") from error
    finally:
        log.disabled = was_disabled


def _scene_parts(scene: Any) -> list[Part]:
    import trimesh

    parts: list[Part] = []
    for node in sorted(scene.graph.nodes_geometry):
        transform, name = scene.graph[node]
        body = scene.geometry[name]
        if not isinstance(body, trimesh.Trimesh) or not len(body.faces):
            continue  # point clouds and drawings have no faces
        body.merge_vertices(merge_tex=True, merge_norm=True)
        scaled = np.asarray(transform, dtype=np.float64).copy()
        scaled[:3] *= _metres(body)
        vertices = np.asarray(body.vertices, dtype=np.float64) @ scaled[:3, :3].T + scaled[:3, 3]
        if not np.isfinite(vertices).all():
            raise UnreadableMeshError("it has coordinates that are not finite numbers")
        faces = np.asarray(body.faces, dtype=np.int64)
        if np.linalg.det(scaled[:3, :3]) < 0.0:
            faces = faces[:, ::-1]  # a mirrored part would otherwise be inside out
        parts.append(Part(*split_creases(vertices, faces), colour=_colour(body)))
    return parts


def _metres(body: Any) -> float:
    """Metres a unit of this part; 1 where the format has no unit, as URDF prescribes."""
    from trimesh.units import unit_conversion

    units = body.units
    return 1.0 if units is None else float(unit_conversion(units, "meters"))


def _colour(body: Any) -> Colour | None:
    """The part's own colour: of its material, else the most frequent one of its faces."""
    visual = body.visual
    if not visual.defined:
        return None
    chosen = visual.material.main_color if visual.kind == "texture" else visual.main_color
    red, green, blue, alpha = (float(channel) / 255.0 for channel in chosen)
    return red, green, blue, alpha or 1.0  # fully transparent is an exporter's slip: nobody draws the invisible
