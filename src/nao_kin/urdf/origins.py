"""New placements of joints in a URDF, as edits of its own text: comments, formatting and everything else stay."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from nao_kin.errors import InvalidInputError
from nao_kin.urdf.document import read_bytes
from nao_kin.urdf.outline import Outline, first
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.safe_xml import read_tree

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nao_kin.urdf.document import UrdfDocument

__all__ = ["with_origins"]


def with_origins(document: UrdfDocument, origins: Mapping[str, tuple[Iterable[float], Iterable[float]]]) -> str:
    """The text of a document's file with the origins of some joints written anew.

    Args:
        document: A document that was read from a file.
        origins: By joint: translation [m], and roll, pitch, yaw [rad], of its frame in its parent link.

    Raises:
        InvalidInputError: The file is another one than was read.
        UrdfError: It cannot be read any more.
    """
    data = read_bytes(document.path)
    if hashlib.sha256(data).hexdigest() != document.sha256:
        raise InvalidInputError(document.path, "the file that the robot was read from", "a file that has changed since")
    root = read_tree(data, document.path)
    outline, places = Outline(root), Positions.of(data, root)
    edits: list[tuple[int, int, str]] = []
    for name, (xyz, rpy) in origins.items():
        joint = outline.joint_by_name[name]
        given = {"xyz": _numbers(xyz), "rpy": _numbers(rpy)}
        whole = "<origin " + " ".join(f'{key}="{value}"' for key, value in given.items()) + "/>"
        origin = first(joint, "origin")
        if origin is None:
            tag = places.tag_span(joint)
            edits += [] if tag is None else [(tag[1], tag[1], whole)]
            continue
        spans = {key: places.value_span(origin, key) for key in given}
        if origin.get("quat_xyzw") is None and all(spans.values()):
            edits += [(*span, given[key]) for key, span in spans.items() if span is not None]
        elif (span := places.element_span(origin)) is not None:
            edits.append((*span, whole))
    text = places.text
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
