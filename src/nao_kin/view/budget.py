"""Pages of a bounded size: as many triangles as fit."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any, Final

from nao_kin.errors import InvalidInputError
from nao_kin.view.decimate import decimated

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nao_kin.view.meshes import Mesh
    from nao_kin.view.scene import Node, Scene

__all__ = ["DEFAULT_MAX_MB", "fitted"]

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
