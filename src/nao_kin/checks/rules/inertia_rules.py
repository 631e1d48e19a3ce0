"""Rules about masses and inertias: what no body can have, and what is far out of scale for its link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.checks.subject import numbers
from nao_kin.urdf.outline import MOVING, Defect, children, describe, first, link_named, tag_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.arrays import Floats
    from nao_kin.checks.subject import Subject

__all__ = [
    "empty_inertials",
    "incomplete_inertials",
    "masses_out_of_scale",
    "moving_without_inertia",
    "principal_moments",
]

_COMPONENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_NOTHING = 1e-13  # [kg m²] the inertia of no part of a robot, but of rounding errors in exported files
_ROUNDING = 1e-3  # of the largest moment: what printed figures lose

_SMALLEST_LINK = 0.05  # [m] a link whose size is not known counts as at least as large
_WIDE = 15.0  # radius of gyration over size: 0.3 for anything solid, 15 for an inertia in the wrong unit
_NARROW = 2e-4
_WIDEST = 5.0  # [m] radius of gyration of no link, whatever its size
_LIGHT = 2e-3  # [kg]
_HEAVY = 30.0  # times all other links together
_HEAVY_FROM = 20.0  # [kg]


@dataclass(frozen=True)
class Body:
    """The inertial of one link, with finite numbers."""

    link: etree._Element
    inertial: etree._Element
    inertia: etree._Element
    mass: float
    matrix: Floats

    @cached_property
    def moments(self) -> tuple[float, float, float]:
        """Principal moments [kg m²], ascending."""
        a, b, c = np.linalg.eigvalsh(self.matrix)
        return float(a), float(b), float(c)


def incomplete_inertials(subject: Subject) -> Iterator[Defect]:
    """An <inertial> holds a mass and an inertia."""
    for link in subject.outline.links:
        inertial = first(link, "inertial")
        if inertial is None:
            continue
        for tag in ("mass", "inertia"):
            if first(inertial, tag) is None:
                message = f"The {describe(inertial)} has no <{tag}>, so readers ignore all of it."
                yield Defect("incomplete-inertial", inertial, message, f"Add <{tag} .../>.")


def empty_inertials(subject: Subject) -> Iterator[Defect]:
    """A moving link does not say that it has no mass and no inertia: simulators divide by both."""
    moved = {link_named(joint, "child") for joint in subject.outline.moving}
    for body in _bodies(subject):
        if body.link.get("name") in moved and body.mass == 0.0 and not body.matrix.any():
            message = f"The {describe(body.link)} is moved by a joint, and its mass and inertia are given as 0."
            hint = "Give it those of the part, or of a gram; a frame that weighs nothing is fixed to what carries it."
            yield Defect("empty-inertial", body.inertial, message, hint)


def principal_moments(subject: Subject) -> Iterator[Defect]:
    """The principal moments are those of a body: none negative, none larger than the sum of the other two."""
    for body in _bodies(subject):
        a, b, c = body.moments
        size = max(abs(a), abs(c))
        moments = f"principal moments {a:.4g}, {b:.4g}, {c:.4g} kg m²"
        if size < _NOTHING:
            if body.mass == 0.0:
                continue  # a massless frame
            message = f"The {describe(body.inertia)} is zero though its mass is {body.mass:g} kg."
            hint = "A point has no inertia, but a link does: dynamics with it divide by zero."
            yield Defect("zero-inertia", body.inertia, message, hint)
        elif a < -_ROUNDING * size:
            message = f"The {describe(body.inertia)} is not positive definite: {moments}."
            yield Defect("inertia-not-positive", body.inertia, message, _sign_hint(body.matrix))
        elif c - a - b > _ROUNDING * size:
            message = f"The {describe(body.inertia)} belongs to no body: {moments}, one above the sum of the others."
            hint = "Is it about the centre of mass, in the axes of <origin>?"
            yield Defect("triangle-inequality", body.inertia, message, hint)


def moving_without_inertia(subject: Subject) -> Iterator[Defect]:
    """What a joint moves has a mass, of its own or of what is fixed to it."""
    outline = subject.outline
    masses = {link.get("name", ""): _mass(link) for link in outline.links}
    if not any(masses.values()):
        inertial = next((link for link in outline.links if first(link, "inertial") is not None), None)
        if outline.moving and inertial is None:
            message = "No link of the robot has a mass, so nothing can be computed about its forces."
            yield Defect("no-masses", outline.root, message, "Add <inertial> to the links that move.")
        return
    # A frame with nothing to see, to hit or to move needs no mass.
    burdened = {link.get("name", ""): float(bool(_parts(link))) for link in outline.links}
    burdened.update({link_named(joint, "parent"): 1.0 for joint in outline.moving})
    fixed: dict[str, list[str]] = {}
    for joint in outline.joints:
        if joint.get("type") not in MOVING:
            fixed.setdefault(link_named(joint, "parent"), []).append(link_named(joint, "child"))
    for joint in outline.moving:
        child = link_named(joint, "child")
        if child in outline.link_by_name and not _carries(child, fixed, masses) and _carries(child, fixed, burdened):
            link = outline.link_by_name[child]
            inertial = first(link, "inertial")
            message = f"The {describe(link)} is moved by the {describe(joint)} and has no mass."
            hint = "Simulators need <inertial> on everything that moves."
            yield Defect("missing-inertia", link if inertial is None else inertial, message, hint)


def _carries(link: str, fixed: dict[str, list[str]], quantity: dict[str, float]) -> bool:
    """Whether a link, or one fixed to it, has some of the quantity."""
    pending, seen = [link], set[str]()
    while pending:
        name = pending.pop()
        if quantity.get(name, 0.0) > 0.0:
            return True
        if name not in seen:
            seen.add(name)
            pending.extend(fixed.get(name, ()))
    return False


def masses_out_of_scale(subject: Subject) -> Iterator[Defect]:
    """Mass and inertia fit the size of their link and the rest of the robot."""
    bodies = [body for body in _bodies(subject) if body.mass > 0.0]
    total = sum(body.mass for body in bodies)
    sizes = _sizes(subject)
    for body in bodies:
        others = total - body.mass
        if len(bodies) >= 3 and body.mass > max(_HEAVY_FROM, _HEAVY * others):
            mass = first(body.inertial, "mass")
            message = f"The {describe(body.link)} weighs {body.mass:g} kg, all others together {others:.4g} kg."
            yield Defect("mass-out-of-scale", body.inertial if mass is None else mass, message, "Is it in grams?")
            continue
        size = max(sizes.get(body.link, 0.0), _SMALLEST_LINK)
        gyration = math.sqrt(max(body.moments[2], 0.0) / body.mass)
        if body.mass < _LIGHT:
            continue  # frames are often given a mass and an inertia of next to nothing, unrelated to each other
        if gyration > min(_WIDE * size, _WIDEST) or 0.0 < gyration < _NARROW * size:
            message = (
                f"The {describe(body.inertia)} is that of {body.mass:g} kg spread {gyration:.3g} m wide, "
                f"but the link measures about {size:.2g} m."
            )
            yield Defect("inertia-out-of-scale", body.inertia, message, "Inertias are kg m², masses kg, lengths m.")


def _bodies(subject: Subject) -> Iterator[Body]:
    for link in subject.outline.links:
        inertial = first(link, "inertial")
        mass = None if inertial is None else numbers(first(inertial, "mass"), "value")
        inertia = None if inertial is None else first(inertial, "inertia")
        values = [numbers(inertia, component) for component in _COMPONENTS]
        if inertial is not None and inertia is not None and mass is not None and None not in values:
            xx, xy, xz, yy, yz, zz = (value[0] for value in values if value)
            matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            if np.abs(matrix).max() < 1e100:  # beyond it the eigenvalues overflow; no body of this world reaches it
                yield Body(link, inertial, inertia, mass[0], matrix)


def _mass(link: etree._Element) -> float:
    inertial = first(link, "inertial")
    mass = None if inertial is None else numbers(first(inertial, "mass"), "value")
    return mass[0] if mass else 0.0


def _sizes(subject: Subject) -> dict[etree._Element, float]:
    """About how large each link is [m]: how far its shapes, its centre of mass and its joints reach."""
    sizes = {link: max(map(_reach, _parts(link)), default=0.0) for link in subject.outline.links}
    for joint in subject.outline.joints:
        parent = subject.outline.link_by_name.get(link_named(joint, "parent"))
        if parent is not None:
            sizes[parent] = max(sizes[parent], _distance(joint))
    return sizes


def _parts(link: etree._Element) -> list[etree._Element]:
    return [part for tag in ("visual", "collision", "inertial") for part in children(link, tag)]


def _reach(part: etree._Element) -> float:
    geometry = first(part, "geometry")
    extent = 0.0
    for shape in () if geometry is None else geometry:
        match tag_of(shape):
            case "box":
                extent = max(numbers(shape, "size", 3) or (0.0,))
            case "cylinder" | "sphere" | "capsule":
                extent = 2.0 * (numbers(shape, "radius") or (0.0,))[0] + (numbers(shape, "length") or (0.0,))[0]
    return _distance(part) + extent


def _distance(owner: etree._Element) -> float:
    xyz = numbers(first(owner, "origin"), "xyz", 3)
    return math.hypot(*xyz) if xyz else 0.0


def _sign_hint(matrix: Floats) -> str:
    if (np.diag(matrix) < 0.0).any():
        return "ixx, iyy and izz are not negative; check their signs."
    return "Check the products ixy, ixz, iyz: each is smaller than the moments beside it."
