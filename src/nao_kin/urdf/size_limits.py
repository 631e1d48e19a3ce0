"""How large and how deep a file may be before it is refused, each bound with its reason."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LIMITS", "ReadLimits"]


@dataclass(frozen=True, slots=True)
class ReadLimits:
    """Bounds on a file from a stranger; real robots stay an order of magnitude below each of them."""

    file_bytes: int = 32 * 1024 * 1024
    """Largest file [bytes]; a URDF is text about meshes, not the meshes themselves."""

    mesh_bytes: int = 128 * 1024 * 1024
    """Largest mesh [bytes] handed to a mesh reader."""

    mesh_markup: int = 2_000_000
    """Most ``<`` in a mesh of XML, which bounds the memory of its tree; a polygon may have an element of its own."""

    mesh_bodies: int = 4096
    """Most bodies that a mesh unfolds to, instances counted each: a robot's part has a handful."""

    mesh_faces: int = 4_000_000
    """Most triangles of a mesh, all bodies together; a fine scan of a part has half a million."""

    material_bytes: int = 1024 * 1024
    """How much of a material library is read [bytes]: it holds a few numbers a material."""

    markup: int = 200_000
    """Most ``<`` in a file, which bounds the elements and so the memory of the tree before it is built."""

    attributes: int = 400_000
    """Most ``=`` in a file, which bounds the attributes in the same way."""

    attributes_per_element: int = 256
    """Most attributes of one element: the time to list them grows with the square of their number."""

    lines: int = 65_534
    """Most line breaks: libxml2 counts lines in 16 bits, and every message must point at the right one."""

    depth: int = 64
    """Deepest nesting of elements, the root counted as 1; deep trees exhaust the stack of recursive readers."""

    links: int = 1000
    """Most links; longer chains have crashed the libraries below."""

    moving_joints: int = 150
    """Most joints that move: Pinocchio's memory grows with a power of their number and then kills the process."""

    name_characters: int = 256
    """Longest name of a robot, link, joint or material; a name has to fit into a message and a table."""

    value_characters: int = 4096
    """Longest attribute value that is read at all."""


LIMITS = ReadLimits()
"""The bounds that every reading obeys."""
