"""Mesh files to triangles: vertices, faces and one colour a part, as `nao_kin.urdf.mesh_scene` reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.urdf.mesh_errors import UnreadableMeshError
from nao_kin.urdf.mesh_scene import FORMATS, material_colour, read_bodies
from nao_kin.view.crease import Indices, split_creases

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour

__all__ = ["FORMATS", "MAX_FACES", "Part", "UnreadableMeshError", "read_parts"]

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
