"""Shapes as triangles: size, volume, orientation, creases."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

from nao_kin.urdf.elements import Box, Capsule, Cylinder, Sphere
from nao_kin.view.crease import split_creases
from nao_kin.view.meshes import triangulate

if TYPE_CHECKING:
    from nao_kin.view.meshes import Part


def body(part: Part) -> trimesh.Trimesh:
    return trimesh.Trimesh(part.vertices, part.faces)  # merges the split vertices again


@pytest.mark.parametrize(
    ("shape", "extents", "volume", "tolerance"),
    [
        (Box((0.1, 0.2, 0.3)), (0.1, 0.2, 0.3), 0.006, 1e-12),
        (Cylinder(0.05, 0.4), (0.1, 0.1, 0.4), math.pi * 0.05**2 * 0.4, 0.01),
        (Sphere(0.2), (0.4, 0.4, 0.4), 4 / 3 * math.pi * 0.2**3, 0.01),
    ],
)
def test_primitives_have_their_size(
    shape: Box | Cylinder | Sphere, extents: tuple[float, float, float], volume: float, tolerance: float
) -> None:
    solid = body(triangulate(shape))
    assert solid.is_watertight
    np.testing.assert_allclose(solid.bounds, [-np.asarray(extents) / 2, np.asarray(extents) / 2], atol=1e-3)
    assert solid.volume == pytest.approx(volume, rel=tolerance)  # positive: faces look outwards


def distinct_positions(part: Part) -> int:
    return len(np.unique(part.vertices.round(9), axis=0))


def test_a_box_has_every_corner_three_times() -> None:
    part = triangulate(Box((1, 1, 1)))
    assert (len(part.vertices), distinct_positions(part)) == (24, 8)


def test_a_cylinder_is_split_at_its_rims_and_nowhere_else() -> None:
    part = triangulate(Cylinder(0.1, 0.3))
    assert (len(part.vertices), distinct_positions(part)) == (2 * 64 + 2, 66)


def test_a_sphere_is_not_split() -> None:
    part = triangulate(Sphere(0.1))
    assert len(part.vertices) == distinct_positions(part)


def test_splitting_keeps_every_triangle_in_place() -> None:
    source = trimesh.creation.annulus(0.1, 0.2, 0.05)
    vertices, faces = split_creases(np.asarray(source.vertices), np.asarray(source.faces))
    np.testing.assert_array_equal(vertices[faces], source.vertices[source.faces])


def test_faces_without_area_are_dropped() -> None:
    vertices, faces = split_creases(np.eye(3), np.array([[0, 1, 2], [0, 0, 1]]))
    assert (vertices.shape, faces.tolist()) == ((3, 3), [[0, 1, 2]])
    nothing, none = split_creases(np.eye(3), np.array([[1, 1, 1]]))
    assert (len(nothing), len(none)) == (0, 0)


def test_neighbours_of_opposite_orientation_still_meet_at_their_edge() -> None:
    # Two triangles of one square, the second turned over: the turn between their normals is a half turn, a crease.
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    vertices, _ = split_creases(square, np.array([[0, 1, 2], [0, 3, 2]]))
    assert len(vertices) == 6


@pytest.mark.parametrize(("radius", "length"), [(0.05, 0.4), (0.2, 0.01), (0.1, 0.0)])
def test_a_capsule_is_a_cylinder_between_half_balls(radius: float, length: float) -> None:
    part = triangulate(Capsule(radius, length))
    size = np.ptp(part.vertices, axis=0)
    np.testing.assert_allclose(size, (2.0 * radius, 2.0 * radius, length + 2.0 * radius), rtol=2e-3)
    body = trimesh.Trimesh(part.vertices, part.faces)
    body.merge_vertices()
    true = math.pi * radius**2 * (length + 4.0 / 3.0 * radius)
    assert body.is_watertight
    assert 0.99 * true < body.volume < true
