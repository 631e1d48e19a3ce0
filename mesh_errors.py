"""Why a mesh file is not read."""

from __future__ import annotations

__all__ = ["CostlyMeshError", "LargeMeshError", "UnreadableMeshError"]


class UnreadableMeshError(ValueError):
    """A mesh file cannot be read; the text is the reason."""


class LargeMeshError(UnreadableMeshError):
    """A mesh file is larger than is read here, or unfolds to more, which says nothing against it."""


class CostlyMeshError(LargeMeshError):
    """Reading a mesh file was ended at a limit of seconds or memory, which its size does not account for."""
