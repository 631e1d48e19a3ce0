"""Mesh files to trimesh bodies, in memory and without the pictures and files they refer to.

A mesh file is as untrusted as the URDF that names it. It is read as bytes, of a known format and a bounded size, and
parsed without what it refers to: no picture, no external entity. The one exception is the material library of an OBJ
file, which holds its colours, and only where that lies in or below the file's own folder.
"""

from __future__ import annotations

import io
import logging
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from lxml import etree

from nao_kin.urdf.mesh_bounds import bound_bodies, bound_collada, bound_text, fenced
from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.arrays import Floats

__all__ = ["FORMATS", "PICTURED", "harmless_collada", "material_colour", "read_bodies"]

FORMATS = ("dae", "obj", "off", "ply", "stl")
"""Formats that carry their geometry in one file and no pictures, by suffix."""


def read_bodies(path: Path) -> list[tuple[Any, Floats]]:
    """The bodies of a mesh file that have faces, each with the transform (4, 4) from its own units to the file, in [m].

    COLLADA's `<unit>` is applied and its `<up_axis>` is not. A mesh in a URDF counts in the frame of its visual, and
    the consumers that robots are made for take the coordinates as they stand: RViz and MoveIt clear the turn that
    Assimp adds, Gazebo Classic never looks at the element. Robot files depend on it: TIAGo's `Y_UP` collision meshes
    cover its visual STL files only unturned. (What follows the letter of COLLADA, as the loader of newer versions of
    three.js does, turns such robots on their backs.)

    Bodies are `trimesh.Trimesh`; the list is empty where the file holds no triangles. Of their materials,
    `material_colour` tells what the file says.

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
    bound_text(content, kind)
    with fenced():
        if kind == "dae":
            content = harmless_collada(content)
        return _placed_bodies(_load(content, kind, _MaterialLibraries(path.parent) if kind == "obj" else None))


def material_colour(material: Any) -> Any | None:
    """Colour (4,) in 0…255 that a file gives a `trimesh` material; None where it gives none, or a picture."""
    roughness = getattr(material, "roughnessFactor", None)
    if roughness is not None:  # of COLLADA
        return None if roughness > 1.0 else material.main_color  # see `PICTURED`
    return material.main_color if "kd" in getattr(material, "kwargs", {}) else None  # else the reader's own grey


class _MaterialLibraries:
    """Resolver that hands out `.mtl` files of one folder and nothing else, however the name leads there."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()

    def get(self, name: str) -> bytes:
        real = (self._folder / name.strip()).resolve()
        if not real.is_relative_to(self._folder) or real.suffix.lower() != ".mtl" or not real.is_file():
            raise OSError("no material library beside the mesh")
        with real.open("rb") as file:
            return file.read(LIMITS.material_bytes)

    __getitem__ = get


def _load(content: bytes, kind: str, resolver: _MaterialLibraries | None) -> Any:
    """The content as a `trimesh.Scene`."""
    import trimesh

    log = logging.getLogger("trimesh")
    was_disabled, log.disabled = log.disabled, True  # it complains about each texture we do not let it read
    try:
        return trimesh.load_scene(io.BytesIO(content), file_type=kind, resolver=resolver, allow_remote=False)
    except (MemoryError, TimeoutError):
        raise  # the fence's own
    except Exception as error:  # the readers of the formats raise whatever they stumble on
        raise UnreadableMeshError(f"not a readable {kind.upper()} file ({type(error).__name__})") from error
    finally:
        log.disabled = was_disabled


def _placed_bodies(scene: Any) -> list[tuple[Any, Floats]]:
    import trimesh

    bound_bodies(scene)
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


PICTURED: Final = -1.0
"""Shininess that marks a material whose colour comes from a picture: of a material the reader passes on numbers only,
and no file means a negative one. The reader turns it into a roughness of sqrt(2), where others are at most 1."""

_CHUNK = 65536  # bytes


def harmless_collada(content: bytes) -> bytes:
    """The same XML without a way out: parsed with entities off, refused with a DOCTYPE, pictures taken out.

    The COLLADA reader's own parser expands entities without a limit, and takes archives for documents.

    Raises:
        UnreadableMeshError: It is not well-formed, or has a DOCTYPE.
        LargeMeshError: It has more tags than are read.
    """
    if content.count(b"<") > LIMITS.mesh_markup:
        raise LargeMeshError(f"more than {LIMITS.mesh_markup} tags")
    try:
        _refuse_doctype(content)
        # Lists of numbers may be long; without a DOCTYPE nothing in the tree is longer than the file.
        parser = etree.XMLParser(resolve_entities=False, load_dtd=False, no_network=True, huge_tree=True)
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UnreadableMeshError(f"not well-formed XML ({error})") from error
    bound_collada(root)
    _take_pictures_out(root)
    return etree.tostring(root)


def _refuse_doctype(content: bytes) -> None:
    """Read as far as the root element, before which a DOCTYPE has to stand."""
    parser = etree.XMLPullParser(events=("start",), resolve_entities=False, load_dtd=False, no_network=True)
    for start in range(0, len(content), _CHUNK):
        parser.feed(content[start : start + _CHUNK])
        for _, first in parser.read_events():
            root: Any = first  # an element: no other event was asked for
            if root.getroottree().docinfo.internalDTD is not None:
                raise UnreadableMeshError("it has a DOCTYPE, which a mesh does not need")
            return


def _take_pictures_out(root: etree._Element) -> None:
    """Take the textures out and mark the materials whose colour they were.

    They would not be read anyway, and one whose picture is not declared makes the reader drop all that is painted
    with it.
    """
    for kind in ("surface", "sampler2D"):
        for found in root.findall(f".//{{*}}newparam/{{*}}{kind}"):
            _remove(found.getparent())
    for shading in root.iterfind(".//{*}technique/*"):
        pictured = [place for place in shading if place.find("{*}texture") is not None]
        if any(etree.QName(place).localname == "diffuse" for place in pictured):
            _mark(shading)
        for place in pictured:
            _remove(place)


def _mark(shading: etree._Element) -> None:
    """Give a shading the shininess `PICTURED` in place of its own."""
    for given in shading.findall("{*}shininess"):
        _remove(given)
    space = etree.QName(shading).namespace
    number = etree.SubElement(etree.SubElement(shading, etree.QName(space, "shininess")), etree.QName(space, "float"))
    number.text = str(PICTURED)


def _remove(element: etree._Element | None) -> None:
    parent = None if element is None else element.getparent()
    if element is not None and parent is not None:
        parent.remove(element)
