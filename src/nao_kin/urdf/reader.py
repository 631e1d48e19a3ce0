"""From an element tree that has passed the structural rules to plain data."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

from nao_kin.urdf.elements import (
    Box,
    Capsule,
    Cylinder,
    Inertial,
    Limit,
    MeshFile,
    Mimic,
    Origin,
    OtherShape,
    Solid,
    Sphere,
    UrdfJoint,
    UrdfLink,
)
from nao_kin.urdf.fields import optional_number, read_numbers
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import MOVING, children, first, line_of, link_named, tag_of
from nao_kin.urdf.quaternion import rpy_of_quaternion

if TYPE_CHECKING:
    from lxml import etree

    from nao_kin.urdf.elements import Colour, JointKind, Shape, Triple
    from nao_kin.urdf.outline import Outline

__all__ = ["read_joints", "read_links", "unit"]

_X_AXIS = (1.0, 0.0, 0.0)
_ZERO = (0.0, 0.0, 0.0)
_COMPONENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read_links(outline: Outline) -> tuple[UrdfLink, ...]:
    """The links in file order."""
    palette = {
        name: colour
        for material in children(outline.root, "material")
        if (name := material.get("name", "")) and (colour := _colour(material)) is not None
    }
    return tuple(_link(element, palette, outline.version) for element in outline.links)


def read_joints(outline: Outline) -> tuple[UrdfJoint, ...]:
    """The joints in file order."""
    return tuple(_joint(element, outline.version) for element in outline.joints)


def unit(vector: Triple) -> Triple:
    """The vector at unit length; one that has it already, up to rounding, stays as it is, bit for bit."""
    # Divided by its largest component first, because the length of a very long or short vector leaves the range.
    largest = max(map(abs, vector))
    if abs(math.hypot(*vector) - 1.0) <= 4.5e-16:
        return vector
    x, y, z = (component / largest for component in vector)
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length)


def _link(element: etree._Element, palette: dict[str, Colour], version: FormatVersion) -> UrdfLink:
    return UrdfLink(
        name=element.get("name", ""),
        visuals=_solids(element, "visual", palette, version),
        collisions=_solids(element, "collision", palette, version),
        inertial=_inertial(first(element, "inertial"), version),
        line=line_of(element),
    )


def _solids(link: etree._Element, tag: str, palette: dict[str, Colour], version: FormatVersion) -> tuple[Solid, ...]:
    solids: list[Solid] = []
    for element in children(link, tag):
        material = first(element, "material")
        colour = None if material is None else _material_colour(material, palette)
        geometry = first(element, "geometry")
        shape = None if geometry is None else _shape(geometry, version)
        if shape is not None:
            solids.append(Solid(shape, _origin(element, version), colour, line_of(element)))
    return tuple(solids)


def _shape(geometry: etree._Element, version: FormatVersion) -> Shape | None:
    """The first shape that URDF defines, else the first that it does not; None where there is none at all."""
    other = None
    for element in geometry:
        match tag_of(element):
            case "box":
                return Box(_triple(element, "size", _ZERO))
            case "cylinder":
                return Cylinder(_number(element, "radius"), _number(element, "length"))
            case "capsule" if version >= FormatVersion.V1_1:
                return Capsule(_number(element, "radius"), _number(element, "length"))
            case "sphere":
                return Sphere(_number(element, "radius"))
            case "mesh":
                return MeshFile(element.get("filename", ""), _triple(element, "scale", (1.0, 1.0, 1.0)))
            case tag:
                other = other or (OtherShape(tag) if tag else None)
    return other


def _material_colour(material: etree._Element, palette: dict[str, Colour]) -> Colour | None:
    """Its own colour, which also names it for the links that follow, or the one its name has so far."""
    name, colour = material.get("name", ""), _colour(material)
    if colour is None:
        return palette.get(name)
    if name:
        palette.setdefault(name, colour)
    return colour


def _colour(material: etree._Element) -> Colour | None:
    element = first(material, "color")
    if element is None:
        return None
    # Values beyond 0…1 (a common 255) are moved to the nearest that can be drawn.
    red, green, blue, alpha = (min(max(value, 0.0), 1.0) for value in read_numbers(element, "rgba", (0.0,) * 4))
    return (red, green, blue, alpha)


def _inertial(element: etree._Element | None, version: FormatVersion) -> Inertial | None:
    """Mass and inertia, or None where one of the two is missing: half of them describe no body."""
    mass = None if element is None else first(element, "mass")
    inertia = None if element is None else first(element, "inertia")
    if element is None or mass is None or inertia is None:
        return None
    ixx, ixy, ixz, iyy, iyz, izz = (_number(inertia, component) for component in _COMPONENTS)
    origin = _origin(element, version)
    return Inertial(_number(mass, "value"), origin, (ixx, ixy, ixz, iyy, iyz, izz), line_of(element))


def _joint(element: etree._Element, version: FormatVersion) -> UrdfJoint:
    kind = cast("JointKind", element.get("type", ""))
    moves = kind in MOVING  # a fixed joint may carry a limit, an axis or a mimic, but they mean nothing
    return UrdfJoint(
        name=element.get("name", ""),
        kind=kind,
        parent=link_named(element, "parent"),
        child=link_named(element, "child"),
        origin=_origin(element, version),
        axis=unit(_triple(first(element, "axis"), "xyz", _X_AXIS)) if moves else _X_AXIS,
        limit=_limit(first(element, "limit"), kind, version) if moves else None,
        mimic=_mimic(first(element, "mimic")) if moves else None,
        line=line_of(element),
    )


def _limit(element: etree._Element | None, kind: JointKind, version: FormatVersion) -> Limit | None:
    if element is None:
        return None
    lower, upper = optional_number(element, "lower"), optional_number(element, "upper")
    if kind != "continuous" and version < FormatVersion.V1_2:  # an absent end of a range is 0
        lower, upper = (0.0 if end is None else end for end in (lower, upper))
    velocity, effort = optional_number(element, "velocity"), optional_number(element, "effort")
    more = ("acceleration", "deceleration", "jerk")
    rates = [optional_number(element, name) if version >= FormatVersion.V1_2 else None for name in more]
    return Limit(lower, upper, velocity, effort, line_of(element), *rates)


def _mimic(element: etree._Element | None) -> Mimic | None:
    if element is None:
        return None
    multiplier, offset = optional_number(element, "multiplier"), optional_number(element, "offset")
    factor = 1.0 if multiplier is None else multiplier
    return Mimic(element.get("joint", ""), factor, 0.0 if offset is None else offset, line_of(element))


def _origin(owner: etree._Element, version: FormatVersion) -> Origin:
    element = first(owner, "origin")
    if element is not None and version >= FormatVersion.V1_1 and element.get("quat_xyzw") is not None:
        x, y, z, w = read_numbers(element, "quat_xyzw", (0.0, 0.0, 0.0, 1.0))
        return Origin(_triple(element, "xyz", _ZERO), rpy_of_quaternion(x, y, z, w))
    return Origin(_triple(element, "xyz", _ZERO), _triple(element, "rpy", _ZERO))


def _triple(element: etree._Element | None, attribute: str, default: Triple) -> Triple:
    x, y, z = read_numbers(element, attribute, default)
    return (x, y, z)


def _number(element: etree._Element, attribute: str) -> float:
    return read_numbers(element, attribute, (0.0,))[0]
