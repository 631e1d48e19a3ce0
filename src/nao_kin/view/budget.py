"""Pages of a bounded size: as many triangles as fit."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.view.crease import Indices, split_creases

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.view.meshes import Mesh
    from nao_kin.view.scene import Node, Scene

__all__ = ["DEFAULT_MAX_MB", "decimated", "fitted", "shares"]

DEFAULT_MAX_MB: Final = 5.0
"""Largest page [MB, of a million bytes] unless somebody asks for another."""

SHAPES: Final = {"meshes": 1.0, "collisions": 0.1}
"""Fields of a node that hold meshes, all of which take room, and what a square metre of them counts: collision shapes
are hidden until somebody asks for them."""

FEWEST_EACH: Final = 12
"""Triangles of a mesh below which a page is not made smaller: it would show boxes."""

MARGIN: Final = 0.97
"""Share of the room for triangles that an attempt aims at: fewer triangles compress a little worse."""


def fitted(scene: Scene, max_mb: float, render: Callable[[Scene], str]) -> str:
    """The page of a scene, with its meshes simplified if it would be larger than `max_mb`.

    A page that is small enough shows every triangle. The same scene and limit give the same text.

    Args:
        scene: What to show.
        max_mb: Largest page [MB]: a million bytes of UTF-8.
        render: Turns a scene into a page.

    Raises:
        InvalidInputError: The limit is not a positive number, or too small even for the fewest triangles; it says what
            the page would need.
    """
    if not (math.isfinite(max_mb) and max_mb > 0.0):
        raise InvalidInputError("max_mb", "a positive number of megabytes", str(max_mb))
    limit = int(max_mb * 1e6)
    page = render(scene)
    if _size(page) <= limit:
        return page
    meshes = [mesh for node in scene.nodes for field in SHAPES for mesh in getattr(node, field)]
    importance = [SHAPES[field] for node in scene.nodes for field in SHAPES for _ in getattr(node, field)]
    bare = _size(render(_refilled(scene, [])))
    whole, fewest = _triangles(meshes), FEWEST_EACH * len(meshes)
    triangles, size = whole, _size(page)
    while triangles > fewest:
        triangles = max(fewest, int(MARGIN * triangles * max(limit - bare, 0) / (size - bare)))
        simpler = decimated(meshes, triangles, importance)
        note = f"Simplified, so that the page stays below {max_mb:g} MB: {_triangles(simpler)} of {whole} triangles."
        page = render(replace(_refilled(scene, simpler), notes=(*scene.notes, note)))
        size = _size(page)
        if size <= limit:
            return page
    raise InvalidInputError("max_mb", f"more than {size / 1e6:.2f}, as small as this page gets", f"{max_mb:g}")


def _size(page: str) -> int:
    return len(page.encode("utf-8"))


def _triangles(meshes: Sequence[Mesh]) -> int:
    return sum(len(mesh.faces) for mesh in meshes)


def _refilled(scene: Scene, meshes: Sequence[Mesh]) -> Scene:
    """The scene with other meshes in place of its own, in the same order, as long as there are any."""
    rest = iter(meshes)

    def refilled(node: Node) -> Node:
        fields: dict[str, Any] = {field: tuple(islice(rest, len(getattr(node, field)))) for field in SHAPES}
        return replace(node, **fields)

    return replace(scene, nodes=tuple(map(refilled, scene.nodes)))


FEWEST: Final = 100
"""Triangles that a mesh keeps however small it is, as far as it has them and the number allows: a screw stays one."""

WORKING_SIZE: Final = 1000.0
"""Diagonal to which a mesh is scaled while edges are collapsed. The library's error thresholds, by which the least
important edges go first, are absolute: they rise from 1e-6 to 1e5, and so pass through the squared errors of a mesh of
this size one after the other."""

TOLERATED: Final = 1.1
"""How far above its share a mesh may stay before its vertices are lumped together."""


def decimated(meshes: Sequence[Mesh], triangles: int, importance: Sequence[float] | None = None) -> tuple[Mesh, ...]:
    """The same meshes with at most about `triangles` triangles in all, in the same order and colours.

    Edges are collapsed where the surface moves least (quadric error metric, Garland and Heckbert 1997), open borders
    excepted. What that cannot bring down, bodies of many small shells for the most part, has the vertices of one cell
    of a cubic grid lumped together (Rossignac and Borrel 1993). Nothing vanishes, and the same meshes give the same
    result, bit by bit; a mesh that keeps all its triangles is returned as it is.

    Args:
        meshes: The meshes; one object that occurs twice counts twice and comes back as one object.
        triangles: How many they may have together.
        importance: What a visible square metre of each counts next to others; 1 by default.
    """
    counts = np.array([len(mesh.faces) for mesh in meshes], dtype=np.int64)
    sizes = np.array([_visible_size(mesh) for mesh in meshes])
    allowed = shares(counts, sizes if importance is None else sizes * importance, triangles)
    done: dict[int, Mesh] = {}
    for mesh, most in zip(meshes, allowed.tolist(), strict=True):
        if id(mesh) not in done:
            done[id(mesh)] = mesh if most >= len(mesh.faces) else _simplified(mesh, most)
    return tuple(done[id(mesh)] for mesh in meshes)


def shares(counts: Indices, sizes: Floats, total: int) -> Indices:
    """Distribute `total` triangles over meshes in proportion to their sizes, none getting more than it has.

    Args:
        counts: (M,) triangles of each mesh.
        sizes: (M,) how much of it can be seen; any unit.
        total: Triangles to distribute.

    Returns:
        (M,) triangles for each, `FEWEST` at least where it has as many, or half an even share if that is less. Their
        sum is at most `total` as long as that is at least twice the number of meshes.
    """
    if counts.sum() <= total or not len(counts):
        return counts
    least = np.minimum(counts, max(1, min(FEWEST, total // (2 * len(counts)))))
    weights = np.maximum(sizes, 1e-12 * max(float(sizes.max()), 1e-300))
    low, high = 0.0, float((counts / weights).max())  # triangles a unit of size: the sum grows with it
    for _ in range(64):
        middle = (low + high) / 2.0
        fits = np.clip(np.floor(middle * weights), least, counts).sum() <= total
        low, high = (middle, high) if fits else (low, middle)
    return np.clip(np.floor(low * weights), least, counts).astype(np.int64)


def _visible_size(mesh: Mesh) -> float:
    """Surface of its bounding box [m²]: what is inside a casing, however detailed, does not count."""
    if not len(mesh.vertices):
        return 0.0
    x, y, z = np.ptp(mesh.vertices, axis=0).tolist()
    return float(x * y + y * z + z * x)


def _simplified(mesh: Mesh, triangles: int) -> Mesh:
    vertices, faces = _collapsed(*_merged(mesh), triangles)
    if len(faces) > TOLERATED * triangles:
        vertices, faces = _lumped(vertices, faces, triangles)
    vertices, faces = split_creases(vertices, faces)
    return replace(mesh, vertices=vertices, faces=faces) if len(faces) else _box_of(mesh)


def _collapsed(vertices: Floats, faces: Indices, triangles: int) -> tuple[Floats, Indices]:
    from fast_simplification import simplify

    low = vertices.min(axis=0)
    scale = WORKING_SIZE / max(float(np.linalg.norm(np.ptp(vertices, axis=0))), 1e-12)
    target = min(triangles, len(faces))
    points, kept = simplify((vertices - low) * scale, faces, target_count=target, preserve_border=True)
    return points / scale + low, kept.astype(np.int64)


def _lumped(vertices: Floats, faces: Indices, triangles: int) -> tuple[Floats, Indices]:
    """Vertices replaced by the mean of those in the same cell, on the finest grid that leaves `triangles` or fewer."""
    coarse, fine = 1, 4096  # cells along the longest edge; one cell leaves nothing
    while fine - coarse > 1:
        middle = (coarse + fine) // 2
        if len(_distinct(_cells(vertices, middle)[faces])) <= triangles:
            coarse = middle
        else:
            fine = middle
    cell = _cells(vertices, coarse)
    sums = np.stack([np.bincount(cell, weights=column) for column in vertices.T], axis=1)
    return sums / np.bincount(cell)[:, None], _distinct(cell[faces])


def _cells(vertices: Floats, cells: int) -> Indices:
    """Number (V,) of the cell each vertex lies in, counted over those that are occupied."""
    low, size = vertices.min(axis=0), max(float(np.ptp(vertices, axis=0).max()), 1e-300)
    x, y, z = np.floor((vertices - low) * (cells / size)).astype(np.int64).T
    return np.unique(x + (cells + 1) * (y + (cells + 1) * z), return_inverse=True)[1].reshape(-1)


def _distinct(faces: Indices) -> Indices:
    """The faces with three different corners, each once, in their order; one seen from the other side is another."""
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    from_smallest = (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3
    _, first = np.unique(np.take_along_axis(faces, from_smallest, axis=1), axis=0, return_index=True)
    return faces[np.sort(first)]


def _merged(mesh: Mesh) -> tuple[Floats, Indices]:
    """Vertices that creases have split are one again, so that no collapse tears the surface there."""
    vertices, index = np.unique(mesh.vertices, axis=0, return_inverse=True)
    return vertices, np.ascontiguousarray(_distinct(index.reshape(-1)[mesh.faces]))


def _box_of(mesh: Mesh) -> Mesh:
    """Its bounding box, for a mesh of which collapses leave nothing."""
    import trimesh.creation

    box = trimesh.creation.box(bounds=[mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    vertices, faces = split_creases(np.asarray(box.vertices), np.asarray(box.faces))
    return replace(mesh, vertices=vertices, faces=faces)
