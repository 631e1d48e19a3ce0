"""Sharp edges for a viewer that averages normals: vertices are split where neighbouring faces meet at an angle.

The viewer computes one normal a vertex, the mean over the faces that share it. Left alone, a box looks like a pillow;
with every face on its own, a cylinder shows its facets. Splitting exactly at creases gives both their look.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["split_creases"]

Indices: TypeAlias = NDArray[np.int64]


def split_creases(vertices: Floats, faces: Indices, angle: float = math.radians(38.0)) -> tuple[Floats, Indices]:
    """The same surface with vertices duplicated along edges sharper than `angle`.

    Args:
        vertices: (V, 3), any unit; coinciding vertices should be merged already.
        faces: (F, 3) indices into them.
        angle: Largest turn between the normals of two faces [rad] that still counts as smooth.

    Returns:
        Vertices (W, 3) and faces (G, 3). Faces without area are dropped; the others keep their order and orientation.
    """
    normals = np.cross(
        vertices[faces[:, 1]] - vertices[faces[:, 0]],
        vertices[faces[:, 2]] - vertices[faces[:, 0]],
    )
    doubled_area = np.linalg.norm(normals, axis=1)
    solid = doubled_area > 0.0
    faces, normals = faces[solid], normals[solid] / doubled_area[solid, None]
    if not len(faces):
        return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    labels = _components(3 * len(faces), _smooth_pairs(faces, normals, math.cos(angle)))
    kept, corner_to_vertex = np.unique(labels, return_inverse=True)
    return vertices[faces.reshape(-1)[kept]], corner_to_vertex.reshape(-1, 3).astype(np.int64)


def _smooth_pairs(faces: Indices, normals: Floats, least_cosine: float) -> Indices:
    """Pairs (P, 2) of face corners at one vertex whose faces share a smooth edge; corner 3 f + k is faces[f, k]."""
    start = np.arange(3 * len(faces), dtype=np.int64)
    end = start - start % 3 + (start + 1) % 3  # the next corner of the same face
    flat = faces.reshape(-1)
    low, high = np.minimum(flat[start], flat[end]), np.maximum(flat[start], flat[end])
    order = np.lexsort((high, low))
    first, second = order[:-1], order[1:]  # edges that join the same two vertices are neighbours in this order
    same = (low[first] == low[second]) & (high[first] == high[second])
    first, second = first[same], second[same]
    smooth = np.einsum("ij,ij->i", normals[first // 3], normals[second // 3]) >= least_cosine
    first, second = first[smooth], second[smooth]
    # Neighbours that are oriented alike run along their edge in opposite directions; a soup of faces may not be.
    alike = flat[start[first]] == flat[start[second]]
    partner_of_start = np.where(alike, start[second], end[second])
    partner_of_end = np.where(alike, end[second], start[second])
    return np.concatenate(
        [np.stack([start[first], partner_of_start], axis=1), np.stack([end[first], partner_of_end], axis=1)]
    )


def _components(size: int, pairs: Indices) -> Indices:
    """Smallest member of the connected component of each of `size` items, (size,)."""
    labels = np.arange(size, dtype=np.int64)
    while True:
        lower = np.minimum(labels[pairs[:, 0]], labels[pairs[:, 1]])
        reached = labels.copy()
        np.minimum.at(reached, pairs[:, 0], lower)
        np.minimum.at(reached, pairs[:, 1], lower)
        reached = reached[reached]  # jump along labels: a fan of n faces takes about log n rounds, not n
        if np.array_equal(reached, labels):
            return labels
        labels = reached
