"""Fewer triangles: how they are shared out, and that the shape remains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from nao_kin.view.budget import FEWEST, decimated, shares
from nao_kin.view.meshes import Mesh

if TYPE_CHECKING:
    from collections.abc import Sequence

GREY = (0.5, 0.5, 0.5, 1.0)


def mesh(body: trimesh.Trimesh, colour: tuple[float, float, float, float] = GREY) -> Mesh:
    return Mesh(np.asarray(body.vertices, dtype=np.float64), np.asarray(body.faces, dtype=np.int64), colour)


def triangles(meshes: Sequence[Mesh]) -> int:
    return sum(len(one.faces) for one in meshes)


def moved(body: trimesh.Trimesh, *offset: float) -> trimesh.Trimesh:
    body.apply_translation(offset)
    return body


def screws(count: int) -> trimesh.Trimesh:
    """Many small shells side by side, none of which can lose an edge for long."""
    return trimesh.util.concatenate(
        [moved(trimesh.creation.box((0.004, 0.004, 0.008)), 0.01 * (i % 20), 0.01 * (i // 20), 0) for i in range(count)]
    )


def bodies() -> list[trimesh.Trimesh]:
    open_sheet = trimesh.creation.icosphere(5, 0.2).slice_plane((0, 0, 0), (0, 0, 1))
    return [
        trimesh.creation.icosphere(5, 0.3),
        trimesh.creation.torus(0.5, 0.1, major_sections=128, minor_sections=64),
        moved(trimesh.creation.icosphere(4, 0.005), 3.0, 0.0, 0.0),
        open_sheet,
        screws(200),
    ]


@pytest.mark.parametrize("total", [0, 7, 500, 20_000, 10**9])
def test_shares_stay_within_what_there_is_and_what_is_allowed(total: int, rng: np.random.Generator) -> None:
    counts = rng.integers(1, 5000, size=40)
    sizes = rng.uniform(0.0, 1.0, size=40) ** 4
    sizes[:2] = 0.0
    given = shares(counts, sizes, total)
    assert (given <= counts).all()
    assert (given >= np.minimum(counts, 1)).all()
    if total >= 2 * len(counts):
        assert given.sum() <= total
    if total >= counts.sum():
        np.testing.assert_array_equal(given, counts)
    else:
        assert given.sum() >= min(total, counts.sum()) - 2 * len(counts)  # next to nothing is wasted


def test_what_looks_larger_gets_more_and_what_is_small_keeps_the_fewest() -> None:
    counts = np.full(4, 100_000)
    given = shares(counts, np.array([4.0, 2.0, 1.0, 1e-9]), 70_000)
    assert given[0] == pytest.approx(2 * given[1], abs=2)
    assert given[1] == pytest.approx(2 * given[2], abs=2)
    assert given[3] == FEWEST


def test_shares_grow_with_the_total(rng: np.random.Generator) -> None:
    counts, sizes = rng.integers(1, 5000, size=30), rng.uniform(0.0, 1.0, size=30)
    totals = [shares(counts, sizes, total).sum() for total in range(100, 40_000, 1000)]
    assert (np.diff(totals) >= 0).all()


@pytest.mark.parametrize("share", [0.5, 0.1, 0.03])
def test_the_shape_remains(share: float) -> None:
    """No vertex is farther from what is left than a thirtieth of the mesh's size; holes and lost parts would be."""
    before = [mesh(body) for body in bodies()[:4]]
    after = decimated(before, int(share * triangles(before)))
    assert triangles(after) <= 1.1 * share * triangles(before)
    for old, new in zip(before, after, strict=True):
        size = np.linalg.norm(np.ptp(old.vertices, axis=0))
        surface = trimesh.Trimesh(new.vertices, new.faces, process=False)
        near = cKDTree(surface.sample(40_000, seed=1)).query(old.vertices)[0]
        assert near.max() < 0.03 * size
        assert surface.area == pytest.approx(trimesh.Trimesh(old.vertices, old.faces).area, rel=0.05)


def test_many_small_shells_are_brought_down_too() -> None:
    before = mesh(screws(200))
    (after,) = decimated([before], 600)
    assert 0 < len(after.faces) <= 1.1 * 600
    old, new = np.ptp(before.vertices, axis=0), np.ptp(after.vertices, axis=0)
    np.testing.assert_allclose(new, old, atol=0.1 * old.max())


def test_the_same_meshes_give_the_same_bytes() -> None:
    for first, second in zip(*(decimated([mesh(body) for body in bodies()], 9000) for _ in range(2)), strict=True):
        assert first.vertices.tobytes() == second.vertices.tobytes()
        assert first.faces.tobytes() == second.faces.tobytes()


def test_order_and_colours_stay_and_one_object_stays_one() -> None:
    ball, box = mesh(trimesh.creation.icosphere(5), (1, 0, 0, 1)), mesh(trimesh.creation.box(), (0, 1, 0, 0.5))
    first, second, third = decimated([ball, box, ball], 5000)
    assert first is third
    assert second is box  # it has next to nothing to lose
    assert (first.colour, second.colour) == (ball.colour, box.colour)


def test_what_matters_less_gets_less() -> None:
    before = [mesh(trimesh.creation.icosphere(5)) for _ in range(2)]
    shown, hidden = decimated(before, 11_000, [1.0, 0.1])
    assert len(shown.faces) == pytest.approx(10 * len(hidden.faces), rel=0.05)


def test_enough_is_left_alone() -> None:
    before = [mesh(body) for body in bodies()]
    assert all(a is b for a, b in zip(before, decimated(before, triangles(before)), strict=True))
    assert decimated([], 10) == ()


def test_a_mesh_of_one_sliver_is_still_there() -> None:
    sliver = Mesh(np.array([(0, 0, 0), (1, 0, 0), (0, 1e-9, 0)]), np.array([(0, 1, 2)]), GREY)
    (ball, kept) = decimated([mesh(trimesh.creation.icosphere(5)), sliver], 1000)
    assert len(kept.faces) == 1
    assert len(ball.faces) <= 1100
