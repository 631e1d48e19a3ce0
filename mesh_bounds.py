"""What a mesh file of another format than COLLADA announces, held against what is in it before a reader believes it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["bounded"]

_PLY_SIZES: Final = {
    **dict.fromkeys((b"char", b"uchar", b"int8", b"uint8"), 1),
    **dict.fromkeys((b"short", b"ushort", b"int16", b"uint16"), 2),
    **dict.fromkeys((b"int", b"uint", b"float", b"int32", b"uint32", b"float32"), 4),
    **dict.fromkeys((b"double", b"float64", b"int64", b"uint64"), 8),
}
_PLY_HEADER: Final = 65_536  # bytes; a header of ten lines has 300
_PLY_END: Final = re.compile(rb"^end_header[ \t]*\r?\n", re.MULTILINE)
_PARTS_OF_OBJ: Final = re.compile(rb"^[ \t]*(?:o|g|usemtl)\b", re.MULTILINE)
_SOLIDS: Final = re.compile(rb"endsolid", re.IGNORECASE)
_DIGITS: Final = 15  # of a count; more of them is no count of anything


def bounded(content: bytes, kind: str) -> bytes:
    """The content of a mesh file without names of pictures, where it keeps what it announces.

    Args:
        content: The file.
        kind: Its suffix: obj, off, ply or stl.

    Raises:
        UnreadableMeshError: It announces what is not in it.
        LargeMeshError: It has more bodies than `ReadLimits.mesh_bodies`.
    """
    return _BOUNDS[kind](content)


def _obj(content: bytes) -> bytes:
    _refuse_many(len(_PARTS_OF_OBJ.findall(content)), "groups, objects and changes of material")
    return content


def _stl(content: bytes) -> bytes:
    if content[:512].lstrip()[:5].lower() == b"solid":
        _refuse_many(len(_SOLIDS.findall(content)), "solids")
    return content


def _refuse_many(bodies: int, what: str) -> None:
    if bodies > LIMITS.mesh_bodies:
        raise LargeMeshError(f"it has {bodies} {what}; at most {LIMITS.mesh_bodies} are read")


def _off(content: bytes) -> bytes:
    """Counts in the head are those of the rows, and each face has the corners that it counts."""
    text = re.sub(rb"#[^\n]*", b"", content) if b"#" in content else content
    _, keyword, body = text.partition(b"OFF")
    rows = [row for row in body.splitlines() if row.strip()]
    if not keyword or not rows:
        raise UnreadableMeshError("no counts of vertices and faces")
    head = rows[0].split()
    if len(head) < 2:
        raise UnreadableMeshError("no counts of vertices and faces")
    vertices, faces = (_count(word, "OFF") for word in head[:2])
    if len(rows) - 1 != vertices + faces:
        raise UnreadableMeshError(
            f"it announces {vertices} vertices and {faces} faces, and has {len(rows) - 1} rows, not {vertices + faces}"
        )
    for number, row in enumerate(rows[1 + vertices :]):
        words = row.split()
        if len(words) <= _count(words[0], "OFF"):
            raise UnreadableMeshError(f"face {number} counts {words[0].decode()} corners and has {len(words) - 1}")
    return content


def _ply(content: bytes) -> bytes:
    """Elements announced fit into what follows the head; comments, which name pictures, are taken out."""
    end = _PLY_END.search(content[:_PLY_HEADER])
    if end is None:
        raise UnreadableMeshError(f"not a readable PLY file: no end of its head within {_PLY_HEADER} bytes")
    head = [line for line in content[: end.start()].splitlines() if line.split()[:1] not in ([b"comment"], [b"obj_info"])]
    text = any(line.split()[:2] == [b"format", b"ascii"] for line in head)
    left = len(content) - end.end() + 1  # the last row of a text may end without a line break
    needed = 0
    for count, row in _ply_elements(head, text=text):
        needed += count * row
        if needed > left:
            raise UnreadableMeshError(f"it announces rows of {needed} bytes at least, and has {left - 1} after its head")
    return b"\n".join([*head, content[end.start() :]])


def _ply_elements(head: list[bytes], *, text: bool) -> list[tuple[int, int]]:
    """Of each element how many there are, and the fewest bytes of one."""
    elements: list[tuple[int, int]] = []
    for line in head:
        words = line.split()
        if words[:1] == [b"element"] and len(words) == 3:
            elements.append((_count(words[2], "PLY"), 0))
        elif words[:1] == [b"property"] and len(words) > 2 and elements:
            count, row = elements[-1]
            size = _PLY_SIZES.get(words[2] if words[1] == b"list" else words[1], 1)
            elements[-1] = (count, row + (2 if text else size))
    return [(count, max(row, 1)) for count, row in elements]


def _count(word: bytes, kind: str) -> int:
    if not word.isdigit() or len(word) > _DIGITS:
        raise UnreadableMeshError(f"not a readable {kind} file: {ascii(word[:20].decode('latin-1'))} is no count")
    return int(word)


_BOUNDS: Final[dict[str, Callable[[bytes], bytes]]] = {"obj": _obj, "off": _off, "ply": _ply, "stl": _stl}
