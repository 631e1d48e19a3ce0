"""What a COLLADA file unfolds to, told from its tags: instances along the graph of nodes, and polygons that it counts.

A kilobyte of nodes that show each other twice is a million bodies for a reader that follows them, and one number in a
`<vcount>` is an array of that length. Both are bounded here before a reader unfolds them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from lxml import etree

from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["refuse_what_unfolds"]

_PRIMITIVES: Final = {"lines", "linestrips", "polygons", "polylist", "triangles", "trifans", "tristrips"}


def refuse_what_unfolds(root: etree._Element) -> None:
    """Refuses a document that unfolds to more than a file may hold.

    Raises:
        UnreadableMeshError: Polygons with more corners than there are indices, or nodes that show themselves.
        LargeMeshError: More bodies than `ReadLimits.mesh_bodies`, deeper than `ReadLimits.mesh_depth`, or indices that
            all instances together unfold to more text than `ReadLimits.mesh_bytes`.
    """
    for polygons in root.iterfind(".//{*}polylist"):
        _refuse_miscounted(polygons)
    shown = _Graph(root).shown()
    if shown.bodies > LIMITS.mesh_bodies:
        raise LargeMeshError(f"it unfolds to {_many(shown.bodies)} bodies; at most {LIMITS.mesh_bodies} are read")
    if shown.index_bytes > LIMITS.mesh_bytes:
        raise LargeMeshError(f"its instances unfold to more than {LIMITS.mesh_bytes} bytes of indices")


def _many(number: int) -> str:
    return str(number) if number < 10**9 else "more than 1000000000"


def _refuse_miscounted(polygons: etree._Element) -> None:
    """Refuses a polylist whose counts promise more corners than its indices can be: a digit and a blank each."""
    stride = 1 + max((_offset(given) for given in polygons.iterfind("{*}input")), default=0)
    indices = polygons.find("{*}p")
    held = 0 if indices is None else (len(indices.text or "") + 1) // 2
    promised = 0
    for counts in polygons.iterfind("{*}vcount"):
        for word in (counts.text or "").split():
            if not (word.isascii() and word.isdigit() and len(word) < 16):
                raise UnreadableMeshError(f"a polygon has {word[:20]!a} corners")
            promised += int(word)
    if promised * stride > held:
        raise UnreadableMeshError(f"its polygons promise {_many(promised)} corners, more than its indices can be")


def _offset(given: etree._Element) -> int:
    word = (given.get("offset") or "0").strip()
    return int(word) if word.isascii() and word.isdigit() and len(word) < 6 else 0


@dataclass(frozen=True, slots=True)
class _Shown:
    """What something shows: bodies, and bytes of text that holds their indices."""

    bodies: int = 0
    index_bytes: int = 0

    def __add__(self, other: _Shown) -> _Shown:
        return _Shown(self.bodies + other.bodies, self.index_bytes + other.index_bytes)


class _Graph:
    """Nodes by identifier, each weighed once, whatever number of times it is shown."""

    def __init__(self, root: etree._Element) -> None:
        self._root = root
        self._nodes = {node.get("id"): node for node in root.iterfind(".//{*}node") if node.get("id")}
        self._geometries = {part.get("id"): _weight(part) for part in root.iterfind(".//{*}geometry")}
        self._known: dict[etree._Element, _Shown] = {}
        self._open: set[etree._Element] = set()

    def shown(self) -> _Shown:
        """What all scenes show together."""
        nodes = self._root.iterfind(".//{*}visual_scene/{*}node")
        return sum((self._node(node, 1) for node in nodes), start=_Shown())

    def _node(self, node: etree._Element, depth: int) -> _Shown:
        if node in self._known:
            return self._known[node]
        if node in self._open:
            raise UnreadableMeshError(f"node {(node.get('id') or '')[:40]!a} shows itself")
        if depth > LIMITS.mesh_depth:
            raise LargeMeshError(f"nodes nested deeper than {LIMITS.mesh_depth}")
        self._open.add(node)
        weight = sum(self._children(node, depth), start=_Shown())
        self._open.remove(node)
        self._known[node] = weight
        return weight

    def _children(self, node: etree._Element, depth: int) -> Iterator[_Shown]:
        for child in node.iterchildren(tag=etree.Element):
            match etree.QName(child).localname:
                case "node":
                    yield self._node(child, depth + 1)
                case "instance_node":
                    target = self._nodes.get(_target(child))
                    yield _Shown(1) if target is None else self._node(target, depth + 1)
                case "instance_geometry" | "instance_controller":
                    yield self._geometries.get(_target(child), _Shown(1))


def _target(instance: etree._Element) -> str:
    return (instance.get("url") or "").removeprefix("#")


def _weight(geometry: etree._Element) -> _Shown:
    """What one instance of a geometry shows."""
    primitives = [e for e in geometry.iter(tag=etree.Element) if etree.QName(e).localname in _PRIMITIVES]
    indices = sum(len(p.text or "") for primitive in primitives for p in primitive.iter("{*}p"))
    return _Shown(max(1, len(primitives)), indices)
