"""What a mesh file unfolds to, bounded before a foreign reader unfolds it, and a fence around that reader.

Bytes bound a file and not what it means: three numbers can ask for a billion corners, and twenty nodes that each stand
twice in the next are a million bodies. So what a format says about itself is held against what the file has.
"""

from __future__ import annotations

import contextlib
import io
import re
import resource
import signal
import threading
import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from lxml import etree

from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.size_limits import LIMITS

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["bound_bodies", "bound_collada", "bound_text", "fenced"]

_SECONDS: Final = 20.0  # a fine mesh of a million triangles takes two
_BYTES: Final = 1 << 30  # beyond what the process has when the reader starts
_PARTS: Final = {
    "obj": re.compile(rb"^[ \t]*(?:o|g|usemtl)\b", re.MULTILINE),
    "stl": re.compile(rb"^[ \t]*solid\b", re.MULTILINE),
}
"""Where a format begins a new body."""

_HEADER: Final = 65536  # bytes in which the header of a PLY file has to end


def bound_text(content: bytes, kind: str) -> None:
    """Refuses a file whose own counts cannot be true, or that holds more bodies than are read.

    Raises:
        LargeMeshError: More bodies than are read.
        UnreadableMeshError: It announces more than it holds.
    """
    if kind in _PARTS:
        _refuse_many(sum(1 for _ in _PARTS[kind].finditer(content)), "bodies")
    if kind == "ply":
        head, end, _ = content[:_HEADER].partition(b"end_header")
        if not end:
            raise UnreadableMeshError("a PLY file without the end of its header")
        for name, number in re.findall(rb"^\s*element\s+(\S+)\s+(\d+)", head, flags=re.MULTILINE):
            _refuse_promise(int(number[:18]), len(content), f"{name.decode(errors='replace')[:40]} elements", "bytes")
    if kind == "off":
        counts = re.match(rb"\s*\S*OFF\S*\s*(?:#[^\n]*\n\s*)*(\d+)\s+(\d+)", content)
        if counts is not None:
            vertices, faces = (int(number[:18]) for number in counts.groups())
            _refuse_promise(vertices + faces, content.count(b"\n") + 1, "vertices and faces", "lines")


def bound_collada(root: etree._Element) -> None:
    """Refuses a tree whose instances or polygons unfold to more than is read, or to more than stands there.

    Raises:
        LargeMeshError: More bodies than are read.
        UnreadableMeshError: Instances that go in a circle; corners that are announced and not listed.
    """
    for polygons in (*root.iter("{*}polylist"), *root.iter("{*}vertex_weights")):
        counts, listed = polygons.find("{*}vcount"), polygons.find("{*}p")
        listed = polygons.find("{*}v") if listed is None else listed
        if counts is not None:
            _refuse_corners(_integers(counts), 0 if listed is None else len((listed.text or "").split()), polygons)
    _refuse_many(_instances(root), "instances of bodies")


def bound_bodies(scene: Any) -> None:
    """Refuses what a reader made that is no list of triangles, or too many.

    Raises:
        LargeMeshError: More bodies or triangles than are read.
        UnreadableMeshError: Vertices that are not three numbers each.
    """
    faces, places = 0, scene.graph.nodes_geometry
    _refuse_many(len(places), "bodies")
    for node in places:
        body = scene.geometry[scene.graph[node][1]]
        vertices, corners = (np.shape(getattr(body, part, ())) for part in ("vertices", "faces"))
        if len(corners) != 2 or not corners[0]:
            continue  # no body of triangles
        if len(vertices) != 2 or vertices[1] != 3 or corners[1] != 3:
            raise UnreadableMeshError(f"vertices of {vertices[-1] if vertices else 0} numbers each, where 3 are wanted")
        faces += corners[0]
    if faces > LIMITS.mesh_faces:
        raise LargeMeshError(f"more than {LIMITS.mesh_faces} triangles")


@contextlib.contextmanager
def fenced() -> Iterator[None]:
    """Runs a foreign reader within a bound of seconds and memory, and lets nothing it prints or warns out.

    Raises:
        LargeMeshError: It took more than its share of either.
    """
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stderr(io.StringIO()),
        contextlib.redirect_stdout(io.StringIO()),
        _memory(),
        _alarm(),
    ):
        warnings.simplefilter("ignore")
        try:
            yield
        except MemoryError:
            raise LargeMeshError(f"reading it takes more than {_BYTES >> 20} MB") from None
        except TimeoutError:
            raise LargeMeshError(f"reading it takes more than {_SECONDS:g} s") from None


@contextlib.contextmanager
def _alarm() -> Iterator[None]:
    """Raises TimeoutError in the main thread, which alone can be interrupted, unless an alarm is set already."""
    if threading.current_thread() is not threading.main_thread() or signal.getitimer(signal.ITIMER_REAL)[0] > 0.0:
        yield
        return

    def give_up(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, _SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def _memory() -> Iterator[None]:
    """Lets the process grow by so much and no more."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    allowed = _in_use() + _BYTES
    if allowed == _BYTES or 0 <= soft <= allowed:
        yield
        return
    resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _in_use() -> int:
    """Address space of this process [bytes]; 0 where the system does not tell."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - no file of anybody's
            return int(file.read().split()[0]) * resource.getpagesize()
    except (OSError, ValueError, IndexError):
        return 0


def _refuse_many(number: int, what: str) -> None:
    if number > LIMITS.mesh_bodies:
        raise LargeMeshError(f"more than {LIMITS.mesh_bodies} {what}")


def _refuse_promise(promised: int, there: int, what: str, unit: str) -> None:
    if promised > there:
        raise UnreadableMeshError(f"it announces {promised} {what} in {there} {unit}")


def _integers(element: etree._Element) -> list[int]:
    try:
        numbers = [int(word[:18]) for word in (element.text or "").split()]
    except ValueError:
        raise UnreadableMeshError("corners of polygons that are no whole numbers") from None
    if any(number < 0 for number in numbers):
        raise UnreadableMeshError("polygons of fewer than no corners")
    return numbers


def _refuse_corners(counts: list[int], listed: int, polygons: etree._Element) -> None:
    offsets = [int(o) for given in polygons.iterfind("{*}input") if (o := given.get("offset", "0")).isdigit()]
    promised = sum(counts) * (max(offsets, default=0) + 1)
    if promised != listed:
        raise UnreadableMeshError(f"it announces {promised} corners of polygons and lists {listed}")


def _instances(root: etree._Element) -> int:
    """How many bodies the scenes unfold to.

    Raises:
        UnreadableMeshError: A node that stands in itself.
    """
    nodes = {name: node for node in root.iter("{*}node") if (name := node.get("id"))}
    known: dict[etree._Element, int] = {}
    # Depth first without recursion: a file may nest as deeply as it likes.
    scenes = list(root.iter("{*}visual_scene"))
    for top in (*scenes, *nodes.values()):
        path: list[tuple[etree._Element, Iterator[etree._Element]]] = [(top, iter(_parts(top, nodes)))]
        on_path = {top}
        while path:
            node, rest = path[-1]
            part = next((p for p in rest if p not in known), None)
            if part is None:
                own = sum(1 for child in node if _tag(child) in ("instance_geometry", "instance_controller"))
                known[node] = own + sum(known[p] for p in _parts(node, nodes))
                path.pop()
                on_path.discard(node)
            elif part in on_path:
                raise UnreadableMeshError("instances of nodes that go in a circle")
            else:
                path.append((part, iter(_parts(part, nodes))))
                on_path.add(part)
    return max((known[scene] for scene in scenes), default=0)


def _parts(node: etree._Element, nodes: dict[str, etree._Element]) -> list[etree._Element]:
    """The nodes that stand in a node: its children, and those that it names."""
    found = []
    for child in node:
        if _tag(child) == "node":
            found.append(child)
        elif _tag(child) == "instance_node" and (named := nodes.get(child.get("url", "").lstrip("#"))) is not None:
            found.append(named)
    return found


def _tag(element: etree._Element) -> str:
    name: Any = element.tag
    return etree.QName(name).localname if isinstance(name, str) else ""
