"""URDF shapes to triangles, and nothing but triangles: no text of a mesh file reaches a page."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.errors import UrdfError
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, Capsule, Cylinder, MeshFile, OtherShape, Solid, Sphere
from nao_kin.urdf.outline import shown
from nao_kin.urdf.resources import resolve_mesh
from nao_kin.view.crease import Indices, split_creases
from nao_kin.view.mesh_files import Part, UnreadableMeshError, read_parts
from nao_kin.view.placeholder import COLOUR, label, placeholder_box, sign_corners

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour, UrdfLink

__all__ = ["DEFAULT_COLOUR", "Mesh", "Sign", "Triangulator", "triangulate"]

DEFAULT_COLOUR = (0.72, 0.75, 0.79, 1.0)
"""Light grey with a hint of blue, for a shape whose file names no colour."""

LARGEST = 100_000.0
"""Greatest size of a primitive [m]: beyond it the numbers of a viewer's picture run out."""

CYLINDER_SECTIONS = 32
SPHERE_SUBDIVISIONS = 3


@dataclass(frozen=True, eq=False, slots=True)
class Sign:
    """A text to be drawn on squares: corners (N, 4, 3) [m], counter-clockwise from the lower left one."""

    text: str
    corners: Floats


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Triangles of one colour: vertices (V, 3) [m], faces (F, 3) indices, colour (r, g, b, a) in 0…1.

    A `sign` is on the box that stands for something that cannot be shown.
    """

    vertices: Floats
    faces: Indices
    colour: Colour
    sign: Sign | None = None


class Triangulator:
    """Turns the visuals of links into triangles, reads each mesh file once and remembers what it could not show.

    Args:
        directory: Directory of the URDF file, against which relative names count; None where there is no file.
        roots: Directories below which mesh files may lie.
    """

    def __init__(self, directory: Path | None, roots: Sequence[Path]) -> None:
        self._directory, self._roots = directory, tuple(roots)
        self._files: dict[Path, tuple[Part, ...]] = {}
        self._notes: dict[str, None] = {}  # a set that keeps the order

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence a visual that could not be shown, in the order they were met, each once."""
        return tuple(self._notes)

    def link(self, link: UrdfLink) -> tuple[Mesh, ...]:
        """All visuals of a link, in the link's frame, and one labelled box for those that cannot be shown.

        A mesh file's own colours win over the colour the URDF names, as in RViz: they tell its parts apart.
        """
        shown_meshes: list[Mesh] = []
        missing: list[Solid] = []
        for solid in link.visuals:
            try:
                shown_meshes.extend(self._solid(solid))
            except (UrdfError, UnreadableMeshError, OSError) as error:
                self._notes[_note(link.name, solid, error)] = None
                missing.append(solid)
        return (*shown_meshes, *([_placeholder(link, missing)] if missing else []))

    def _solid(self, solid: Solid) -> list[Mesh]:
        match solid.shape:
            case MeshFile():
                parts = self._file(solid.shape)
            case OtherShape(tag):
                raise UnreadableMeshError(f"URDF defines no shape {shown(tag)}")
            case _:
                parts = (_primitive(solid.shape),)
        T_link_solid = np.asarray(from_xyz_rpy(solid.origin.xyz, solid.origin.rpy).homogeneous)
        colour = solid.colour or DEFAULT_COLOUR
        return [_placed(part, T_link_solid, part.colour or colour) for part in parts if len(part.faces)]

    def _file(self, shape: MeshFile) -> tuple[Part, ...]:
        path = resolve_mesh(shape.filename, self._directory, self._roots)
        if path not in self._files:
            self._files[path] = read_parts(path)
        return tuple(_scaled(part, shape.scale) for part in self._files[path])


@functools.lru_cache(maxsize=512)  # a robot repeats its shapes, and a notebook its robot
def triangulate(shape: Box | Cylinder | Capsule | Sphere) -> Part:
    """A primitive as triangles around its own origin, faces outwards.

    Cylinders and capsules have 32 sections and spheres 1280 faces, all inscribed: the volume is at most
    1 % below the true one.
    """
    import trimesh.creation

    match shape:
        case Box():
            body = trimesh.creation.box(extents=shape.size)
        case Cylinder():
            body = trimesh.creation.cylinder(shape.radius, shape.length, sections=CYLINDER_SECTIONS)
        case Capsule():
            count = [CYLINDER_SECTIONS, CYLINDER_SECTIONS]
            body = trimesh.creation.capsule(shape.length, shape.radius, count=count)
        case Sphere():
            body = trimesh.creation.icosphere(subdivisions=SPHERE_SUBDIVISIONS, radius=shape.radius)
    vertices, faces = split_creases(np.asarray(body.vertices), np.asarray(body.faces))
    vertices.flags.writeable = faces.flags.writeable = False  # many scenes share them
    return Part(vertices, faces, colour=None)


def _primitive(shape: Box | Cylinder | Capsule | Sphere) -> Part:
    match shape:
        case Box():
            largest = max(shape.size)
        case Cylinder() | Capsule():
            largest = max(shape.radius, shape.length)
        case Sphere():
            largest = shape.radius
    if largest > LARGEST:
        raise UnreadableMeshError(f"it is larger than {LARGEST / 1000:g} km")
    return triangulate(shape)


def _placed(part: Part, pose: Floats, colour: Colour) -> Mesh:
    return Mesh(part.vertices @ pose[:3, :3].T + pose[:3, 3], part.faces, colour)


def _placeholder(link: UrdfLink, missing: Sequence[Solid]) -> Mesh:
    box, T_link_box = placeholder_box(link.inertial, missing[0])
    corners = sign_corners(box.size) @ T_link_box[:3, :3].T + T_link_box[:3, 3]
    return replace(_placed(triangulate(box), T_link_box, COLOUR), sign=Sign(label(missing), corners))


def _scaled(part: Part, scale: tuple[float, float, float]) -> Part:
    if scale == (1.0, 1.0, 1.0):
        return part
    mirrored = scale[0] * scale[1] * scale[2] < 0.0
    faces = part.faces[:, ::-1] if mirrored else part.faces
    return Part(part.vertices * np.asarray(scale), faces, part.colour)


def _note(link: str, solid: Solid, error: Exception) -> str:
    if isinstance(error, UrdfError):
        reason = error.reason.rstrip(".")  # names the mesh; where the URDF lies is not the page's business
    else:
        # An operating system's message would print the full path.
        told = error.strerror if isinstance(error, OSError) else str(error)
        reason = f"The {_title(solid)} is not shown: {told}"
    return f"Link {link}, line {solid.line}: {reason}."


def _title(solid: Solid) -> str:
    if isinstance(solid.shape, OtherShape):
        return "visual"
    if isinstance(solid.shape, MeshFile):
        return f"mesh {shown(solid.shape.filename.rsplit('/', 1)[-1])}"
    return type(solid.shape).__name__.lower()
