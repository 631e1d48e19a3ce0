"""URDF shapes to triangles, and nothing but triangles: no text of a mesh file reaches a page."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from itertools import permutations
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.errors import UrdfError
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, Capsule, Cylinder, MeshFile, OtherShape, Solid, Sphere
from nao_kin.urdf.mesh_errors import UnreadableMeshError
from nao_kin.urdf.mesh_scene import FORMATS, material_colour, read_bodies
from nao_kin.urdf.outline import shown
from nao_kin.urdf.resources import resolve_mesh
from nao_kin.view.crease import Indices, split_creases

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour, Inertial, Triple, UrdfLink

__all__ = [
    "COLOUR",
    "DEFAULT_COLOUR",
    "FORMATS",
    "MAX_FACES",
    "Mesh",
    "Part",
    "Sign",
    "Triangulator",
    "UnreadableMeshError",
    "label",
    "placeholder_box",
    "read_parts",
    "sign_corners",
    "triangulate",
]

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


MAX_FACES = 1_000_000

MAX_COLOURS = 16
"""Most colours of faces that a body is taken apart for; with more of them it is a painting, and has its commonest."""


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """One part of a mesh file: vertices (V, 3) [m], faces (F, 3), and its colour, None where the file names none."""

    vertices: Floats
    faces: Indices
    colour: Colour | None


def read_parts(path: Path) -> tuple[Part, ...]:
    """All parts of a mesh file, each at its place in the file's own frame, in metres.

    COLLADA's `<unit>` is applied and its `<up_axis>` is not, as `nao_kin.urdf.mesh_scene.read_bodies` explains. A body
    whose faces have colours of their own becomes one part a colour, up to `MAX_COLOURS`.

    Raises:
        UnreadableMeshError: Unknown format, too large, damaged, empty, or with numbers that are not finite.
        OSError: The file cannot be opened.
    """
    parts = tuple(
        part
        for body, T in read_bodies(path)
        for piece, colour in _pieces(body)
        if len((part := _part(piece, T, colour)).faces)
    )
    if not parts:
        raise UnreadableMeshError("it holds no triangles")
    if sum(len(part.faces) for part in parts) > MAX_FACES:
        raise UnreadableMeshError(f"more than {MAX_FACES} triangles")
    return parts


def _pieces(body: Any) -> list[tuple[Any, Colour | None]]:
    """A body as its pieces of one colour each, None where the file names none."""
    visual = body.visual
    if not visual.defined:
        return [(body, None)]
    if visual.kind == "texture":
        return [(body, _colour(material_colour(visual.material)))]
    colours, of_face = np.unique(visual.face_colors, axis=0, return_inverse=True)
    if not 1 < len(colours) <= MAX_COLOURS:
        return [(body, _colour(visual.main_color))]
    of_face = of_face.reshape(-1)
    faces = [np.flatnonzero(of_face == index) for index in range(len(colours))]
    return [(body.submesh([chosen], append=True), _colour(c)) for chosen, c in zip(faces, colours, strict=True)]


def _part(body: Any, scaled: Floats, colour: Colour | None) -> Part:
    body.merge_vertices(merge_tex=True, merge_norm=True)
    vertices = np.asarray(body.vertices, dtype=np.float64) @ scaled[:3, :3].T + scaled[:3, 3]
    if not np.isfinite(vertices).all():
        raise UnreadableMeshError("it has coordinates that are not finite numbers")
    faces = np.asarray(body.faces, dtype=np.int64)
    if np.linalg.det(scaled[:3, :3]) < 0.0:
        faces = faces[:, ::-1]  # a mirrored part would otherwise be inside out
    return Part(*split_creases(vertices, faces), colour)


def _colour(channels: Any | None) -> Colour | None:
    if channels is None:
        return None
    red, green, blue, alpha = (float(channel) / 255.0 for channel in channels)
    return red, green, blue, alpha or 1.0  # fully transparent is an exporter's slip: nobody draws the invisible


COLOUR: Final = (0.95, 0.66, 0.15, 0.4)
"""Amber, and to be seen through: no robot looks like that."""

EDGE: Final = 0.1
"""Edge of the cube that stands for a link without a usable inertia [m]."""

SMALLEST_BOX, LARGEST_BOX = 1e-3, 10.0
"""Edges [m] outside of which an inertia is taken for a slip."""

SIGN: Final = 0.9
"""Edge of the square of text on a side, next to the side's shorter edge."""


def placeholder_box(inertial: Inertial | None, solid: Solid) -> tuple[Box, Floats]:
    """The box of even density with a link's mass and inertia, and its pose (4, 4) in the link.

    Where the link states no inertia that a body can have, a small cube at the place of the visual.
    """
    found = None if inertial is None else _inertia_box(inertial)
    if found is not None:
        return found
    return Box((EDGE, EDGE, EDGE)), np.asarray(from_xyz_rpy(solid.origin.xyz, solid.origin.rpy).homogeneous)


def _inertia_box(inertial: Inertial) -> tuple[Box, Floats] | None:
    ixx, ixy, ixz, iyy, iyz, izz = inertial.inertia
    inertia = np.array([(ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)])
    if not (inertial.mass > 0.0 and np.isfinite(inertia).all()):
        return None
    moments, axes = np.linalg.eigh(inertia)
    squares = 6.0 / inertial.mass * (moments.sum() - 2.0 * moments)  # of the edges: I_x = m (b² + c²) / 12, and so on
    if not ((squares >= SMALLEST_BOX**2) & (squares <= LARGEST_BOX**2)).all():
        return None
    order = _nearest_order(axes)  # so that the text stands upright where the link does
    axes, squares = axes[:, order], squares[order]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    T_link_box = np.asarray(from_xyz_rpy(inertial.origin.xyz, inertial.origin.rpy).homogeneous).copy()
    T_link_box[:3, :3] = T_link_box[:3, :3] @ axes
    a, b, c = np.sqrt(squares).tolist()
    return Box((a, b, c)), T_link_box


def _nearest_order(axes: Floats) -> list[int]:
    """The order of three directions, columns of `axes`, in which they are nearest to x, y and z."""
    return list(max(permutations(range(3)), key=lambda order: float(np.abs(axes)[np.arange(3), list(order)].sum())))


def label(solids: Sequence[Solid]) -> str:
    """The name of the one file that is missing, or how many things are."""
    if len(solids) > 1:
        return f"{len(solids)} missing"
    (solid,) = solids
    shape = solid.shape
    return shape.filename.rsplit("/", 1)[-1][-40:] if isinstance(shape, MeshFile) else "missing"


def sign_corners(size: Triple) -> Floats:
    """Squares (6, 4, 3) that text is drawn on, one on each side of a box around the origin, as close as can be.

    Corners run from the lower left one counter-clockwise, as seen from outside.
    """
    half = np.asarray(size) / 2.0
    squares = []
    for axis, direction in [(axis, direction) for axis in range(3) for direction in (1.0, -1.0)]:
        normal = np.eye(3)[axis] * direction
        up = np.eye(3)[2] if axis < 2 else -np.eye(3)[0]  # a robot is looked at from ahead, where x points
        right = np.cross(up, normal)
        reach = SIGN * min(float(half @ abs(up)), float(half @ abs(right)))
        centre = normal * (half[axis] + 0.002 * half.max())  # in front, or the two surfaces would flicker
        squares.append([centre + reach * (i * right + j * up) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return np.asarray(squares)
