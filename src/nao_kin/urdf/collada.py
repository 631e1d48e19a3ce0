"""COLLADA from a stranger, made harmless for the reader: no entities, no DOCTYPE, no pictures."""

from __future__ import annotations

from typing import Any, Final

from lxml import etree

from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.size_limits import LIMITS

__all__ = ["PICTURED", "harmless_collada"]

PICTURED: Final = -1.0
"""Shininess that marks a material whose colour comes from a picture: of a material the reader passes on numbers only,
and no file means a negative one. The reader turns it into a roughness of sqrt(2), where others are at most 1."""

_CHUNK = 65536  # bytes


def harmless_collada(content: bytes) -> bytes:
    """The same XML without a way out: parsed with entities off, refused with a DOCTYPE, pictures taken out.

    The COLLADA reader's own parser expands entities without a limit, and takes archives for documents.

    Raises:
        UnreadableMeshError: It is not well-formed, or has a DOCTYPE.
        LargeMeshError: It has more tags than are read.
    """
    if content.count(b"<") > LIMITS.mesh_markup:
        raise LargeMeshError(f"more than {LIMITS.mesh_markup} tags")
    try:
        _refuse_doctype(content)
        # Lists of numbers may be long; without a DOCTYPE nothing in the tree is longer than the file.
        parser = etree.XMLParser(resolve_entities=False, load_dtd=False, no_network=True, huge_tree=True)
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UnreadableMeshError(f"not well-formed XML ({error})") from error
    _take_pictures_out(root)
    return etree.tostring(root)


def _refuse_doctype(content: bytes) -> None:
    """Read as far as the root element, before which a DOCTYPE has to stand."""
    parser = etree.XMLPullParser(events=("start",), resolve_entities=False, load_dtd=False, no_network=True)
    for start in range(0, len(content), _CHUNK):
        parser.feed(content[start : start + _CHUNK])
        for _, first in parser.read_events():
            root: Any = first  # an element: no other event was asked for
            if root.getroottree().docinfo.internalDTD is not None:
                raise UnreadableMeshError("it has a DOCTYPE, which a mesh does not need")
            return


def _take_pictures_out(root: etree._Element) -> None:
    """Take the textures out and mark the materials whose colour they were.

    They would not be read anyway, and one whose picture is not declared makes the reader drop all that is painted
    with it.
    """
    for kind in ("surface", "sampler2D"):
        for found in root.findall(f".//{{*}}newparam/{{*}}{kind}"):
            _remove(found.getparent())
    for shading in root.iterfind(".//{*}technique/*"):
        pictured = [place for place in shading if place.find("{*}texture") is not None]
        if any(etree.QName(place).localname == "diffuse" for place in pictured):
            _mark(shading)
        for place in pictured:
            _remove(place)


def _mark(shading: etree._Element) -> None:
    """Give a shading the shininess `PICTURED` in place of its own."""
    for given in shading.findall("{*}shininess"):
        _remove(given)
    space = etree.QName(shading).namespace
    number = etree.SubElement(etree.SubElement(shading, etree.QName(space, "shininess")), etree.QName(space, "float"))
    number.text = str(PICTURED)


def _remove(element: etree._Element | None) -> None:
    parent = None if element is None else element.getparent()
    if element is not None and parent is not None:
        parent.remove(element)
