"""Pages of a bounded size: as many triangles as fit."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from nao_kin.errors import InvalidInputError
from nao_kin.view.decimate import decimated

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.view.scene import Scene

__all__ = ["DEFAULT_MAX_MB", "fitted"]

DEFAULT_MAX_MB: Final = 5.0
"""Largest page [MB, of a million bytes] unless somebody asks for another."""

ATTEMPTS: Final = 6
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
    bare = _size(render(_with_triangles(scene, 0)))
    whole = triangles = _triangles(scene)
    size = _size(page)
    for _ in range(ATTEMPTS if bare < limit else 0):
        triangles = int(triangles * MARGIN * (limit - bare) / (size - bare))
        simpler = _with_triangles(scene, triangles)
        shown = _triangles(simpler)
        note = f"Simplified to keep the page below {max_mb:g} MB: {shown} of {whole} triangles are drawn."
        page = render(replace(simpler, notes=(*scene.notes, note)))
        size = _size(page)
        if size <= limit:
            return page
    expected = f"at least {math.ceil(size / 1e4) / 1e2:g} for this scene"
    raise InvalidInputError("max_mb", expected, f"{max_mb:g}")
