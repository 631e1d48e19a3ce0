"""Mesh files to triangles: vertices, faces and one colour a part, as `nao_kin.urdf.mesh_scene` reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.urdf.mesh_scene import FORMATS, UnreadableMeshError, read_bodies
from nao_kin.view.crease import Indices, split_creases

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour

__all__ = ["FORMATS", "MAX_FACES", "Part", "UnreadableMeshError", "read_parts"]

MAX_FACES = 1_000_000


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
    parts = tuple(part for body in read_bodies(path) if len((part := _part(*body)).faces))
    if not parts:
        raise UnreadableMeshError("it holds no triangles")
    if sum(len(part.faces) for part in parts) > MAX_FACES:
        raise UnreadableMeshError(f"more than {MAX_FACES} triangles")
    return parts


def _part(body: Any, scaled: Floats) -> Part:
    body.merge_vertices(merge_tex=True, merge_norm=True)
    vertices = np.asarray(body.vertices, dtype=np.float64) @ scaled[:3, :3].T + scaled[:3, 3]
    if not np.isfinite(vertices).all():
        raise UnreadableMeshError("it has coordinates that are not finite numbers")
    faces = np.asarray(body.faces, dtype=np.int64)
    if np.linalg.det(scaled[:3, :3]) < 0.0:
        faces = faces[:, ::-1]  # a mirrored part would otherwise be inside out
    return Part(*split_creases(vertices, faces), colour=_colour(body))


def _colour(body: Any) -> Colour | None:
    """The part's own colour: of its material, else the most frequent one of its faces."""
    visual = body.visual
    if not visual.defined:
        return None
    chosen = visual.material.main_color if visual.kind == "texture" else visual.main_color
    red, green, blue, alpha = (float(channel) / 255.0 for channel in chosen)
    return red, green, blue, alpha or 1.0  # fully transparent is an exporter's slip: nobody draws the invisible
