"""Why a mesh file is not read."""

from __future__ import annotations

__all__ = ["LargeMeshError", "UnreadableMeshError"]


class UnreadableMeshError(ValueError):
    """A mesh file cannot be read; the text is the reason."""


class LargeMeshError(UnreadableMeshError):
    """A mesh file is larger than is read here, which says nothing against it."""
