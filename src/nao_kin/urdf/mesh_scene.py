"""Mesh files to trimesh bodies, in memory and without anything they refer to.

A mesh file is as untrusted as the URDF that names it. It is read as bytes, of a known format and a bounded size, and
parsed without a resolver: no texture, no material library, no external entity.
"""

from __future__ import annotations

import io
import logging
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.urdf.limits import LIMITS

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.arrays import Floats

__all__ = ["FORMATS", "LargeMeshError", "UnreadableMeshError", "read_bodies"]

FORMATS = ("dae", "obj", "off", "ply", "stl")
"""Formats that carry their geometry in one file and no pictures, by suffix."""


class UnreadableMeshError(ValueError):
    """A mesh file cannot be read; the text is the reason."""


class LargeMeshError(UnreadableMeshError):
    """A mesh file is larger than is read here, which says nothing against it."""


def read_bodies(path: Path) -> list[tuple[Any, Floats]]:
    """The bodies of a mesh file that have faces, each with the transform (4, 4) from its own units to the file, in [m].

    COLLADA's `<unit>` is applied and its `<up_axis>` is not, as the common URDF viewers do. Bodies are
    `trimesh.Trimesh`; the list is empty where the file holds no triangles.

    Raises:
        UnreadableMeshError: Unknown format, too large, or damaged.
        OSError: The file cannot be opened.
    """
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise UnreadableMeshError(f"meshes of type {path.suffix or '(none)'!r} are not read ({', '.join(FORMATS)} are)")
    with path.open("rb") as file:
        content = file.read(LIMITS.mesh_bytes + 1)
    if len(content) > LIMITS.mesh_bytes:
        raise LargeMeshError(f"larger than {LIMITS.mesh_bytes} bytes")
    if kind == "dae":
        content = _harmless_xml(content)
    return _placed_bodies(_load(content, kind))


def _harmless_xml(content: bytes) -> bytes:
    """The same XML without a way out: parsed with entities off, refused with a DOCTYPE, written anew.

    The COLLADA reader's own parser expands entities without a limit, and takes archives for documents.
    """
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False)
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        if "XML_PARSE_HUGE" in str(error):
            raise LargeMeshError("a list of numbers in it is longer than the XML parser reads") from error
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


def _placed_bodies(scene: Any) -> list[tuple[Any, Floats]]:
    import trimesh

    bodies: list[tuple[Any, Floats]] = []
    for node in sorted(scene.graph.nodes_geometry):
        transform, name = scene.graph[node]
        body = scene.geometry[name]
        if not isinstance(body, trimesh.Trimesh) or not len(body.faces):
            continue  # point clouds and drawings have no faces
        scaled = np.asarray(transform, dtype=np.float64).copy()
        scaled[:3] *= _metres(body)
        bodies.append((body, scaled))
    return bodies


def _metres(body: Any) -> float:
    """Metres a unit of this part; 1 where the format has no unit, as URDF prescribes."""
    from trimesh.units import unit_conversion

    units = body.units
    return 1.0 if units is None else float(unit_conversion(units, "meters"))
