"""Rules about left and right: what the twins of a robot do not have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nao_kin.checks.digits import swapped_digits
from nao_kin.checks.rules.twin_rules import AXIS_NAMES, Symmetry, twins
from nao_kin.checks.subject import numbers
from nao_kin.urdf.outline import Defect, describe, first, line_of, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.arrays import Floats
    from nao_kin.checks.subject import Subject
    from nao_kin.urdf.elements import Inertial, UrdfJoint

__all__ = ["geometry_of_twins", "inertia_of_twins", "limits_of_twins"]

_LIMIT = 1e-4  # [rad or m]
_RELATIVE = 1e-4  # of a speed, an effort, a mass
_MOMENT = 1e-2  # of the largest principal moment
_EITHER = "One of the two is wrong, or the robot is not symmetric here."


def geometry_of_twins(subject: Subject) -> Iterator[Defect]:
    """Twin joints are mirror images in the plane that nearly all of them keep."""
    symmetry = Symmetry.of(subject.robot)
    plane = symmetry.plane
    if plane is None:
        return
    for left, alike in symmetry.verdicts(plane).items():
        if alike:
            continue
        a, b = (subject.joint(joint.name) for joint in symmetry.twin_joints(left))
        if not symmetry.placed_alike(left, plane):
            yield _origin_defect(a, b, "xyz", plane)
        elif _same_size(first(a, "axis"), first(b, "axis")):
            yield _origin_defect(a, b, "rpy", plane)
        else:
            axis = first(b, "axis")
            message = (
                f"The axis of the {describe(b)} is {_text(b, 'axis', 'xyz')}, that of its twin {_twin(a)} "
                f"{_text(a, 'axis', 'xyz')}: not mirror images along {AXIS_NAMES[plane]}."
            )
            yield Defect("mirror-axis", b if axis is None else axis, message, _EITHER, "xyz")


def _origin_defect(a: etree._Element, b: etree._Element, attribute: str, plane: int) -> Defect:
    origin = first(b, "origin")
    ours, theirs = (numbers(first(joint, "origin"), attribute, 3) or (0.0,) * 3 for joint in (a, b))
    swapped = any(swapped_digits(x, y) for x, y in zip(ours, theirs, strict=True))
    message = (
        f"The {attribute} of the {describe(b)} is {_text(b, 'origin', attribute)}, that of its twin {_twin(a)} "
        f"{_text(a, 'origin', attribute)}: not mirror images along {AXIS_NAMES[plane]}."
    )
    code = "mirror-frame" if b.get("type") == "fixed" else "mirror-origin"
    code = "swapped-digits" if swapped else code
    return Defect(code, b if origin is None else origin, message, _EITHER, attribute)


def limits_of_twins(subject: Subject) -> Iterator[Defect]:
    """Twin joints have mirrored ranges and the same speed and effort."""
    symmetry = Symmetry.of(subject.robot)
    plane = symmetry.plane
    verdicts = {} if plane is None else symmetry.verdicts(plane)
    for left in symmetry.pairs:
        a, b = symmetry.twin_joints(left)
        if a.kind != b.kind or a.limit is None or b.limit is None:
            continue
        if a.kind in {"revolute", "prismatic"}:
            sign = symmetry.turned_alike(left, plane) if plane is not None and verdicts.get(left) else None
            yield from _range_defects(subject, symmetry, a, b, sign)
        for what, ours, theirs in (
            ("velocity", a.limit.velocity, b.limit.velocity),
            ("effort", a.limit.effort, b.limit.effort),
        ):
            if ours is not None and theirs is not None and abs(ours - theirs) > _RELATIVE * max(ours, theirs):
                yield _value_defect(subject, f"mirror-{what}", what, (a, b), (ours, theirs))


def _range_defects(
    subject: Subject, symmetry: Symmetry, a: UrdfJoint, b: UrdfJoint, sign: float | None
) -> Iterator[Defect]:
    limit = b.limit
    own = (0.0, 0.0) if limit is None else (limit.lower or 0.0, limit.upper or 0.0)
    expected = [symmetry.mirrored_range(a.name, s) for s in ((-1.0, 1.0) if sign is None else (sign,))]
    best = min(expected, key=lambda ends: abs(ends[0] - own[0]) + abs(ends[1] - own[1]))
    for end, found, wanted in zip(("lower", "upper"), own, best, strict=True):
        if abs(found - wanted) > _LIMIT:
            yield _value_defect(subject, "mirror-limit", end, (a, b), (wanted, found))


def _value_defect(
    subject: Subject, code: str, what: str, joints: tuple[UrdfJoint, UrdfJoint], values: tuple[float, float]
) -> Defect:
    left, right = (subject.joint(joint.name) for joint in joints)
    limit, (wanted, found) = first(right, "limit"), values
    label = f"{what} limit" if what in {"lower", "upper"} else f"largest {what}"
    message = f"The {label} of the {describe(right)} is {found:.9g}, but {wanted:.9g} by its twin {_twin(left)}."
    code = "swapped-digits" if swapped_digits(found, wanted) else code
    return Defect(code, right if limit is None else limit, message, _EITHER, what)


def inertia_of_twins(subject: Subject) -> Iterator[Defect]:
    """Twin links have the same mass and the same principal moments."""
    links = {link.name: link for link in subject.document.links}
    for left, right in twins(links).items():
        a, b = links[left].inertial, links[right].inertial
        if a is None or b is None:
            continue
        ours, theirs = subject.link(left), subject.link(right)
        inertial = first(theirs, "inertial")
        if inertial is None:
            continue
        if abs(a.mass - b.mass) > _RELATIVE * max(a.mass, b.mass):
            code = "swapped-digits" if swapped_digits(a.mass, b.mass) else "mirror-mass"
            message = f"The {describe(theirs)} weighs {b.mass:.9g} kg, its twin {_twin(ours)} {a.mass:.9g} kg."
            mass = first(inertial, "mass")
            yield Defect(code, inertial if mass is None else mass, message, _EITHER, "value")
        else:
            yield from _moment_defects(inertial, ours, a, b)


def _moment_defects(inertial: etree._Element, ours: etree._Element, a: Inertial, b: Inertial) -> Iterator[Defect]:
    moments = [_principal(body) for body in (a, b)]
    apart, largest = np.abs(moments[0] - moments[1]).max(), np.abs(moments).max()
    if largest > 0.0 and apart > _MOMENT * largest:
        texts = [", ".join(f"{moment:.4g}" for moment in body) for body in moments]
        message = (
            f"The principal moments of the {describe(inertial)} are {texts[1]} kg m², "
            f"those of its twin {_twin(ours)} {texts[0]}."
        )
        inertia = first(inertial, "inertia")
        code = "swapped-digits" if any(map(swapped_digits, a.inertia, b.inertia)) else "mirror-inertia"
        yield Defect(code, inertial if inertia is None else inertia, message, _EITHER)


def _principal(body: Inertial) -> Floats:
    xx, xy, xz, yy, yz, zz = body.inertia
    moments: Floats = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return moments


def _same_size(a: etree._Element | None, b: etree._Element | None) -> bool:
    """Whether two axes have the same components but for signs."""
    ours, theirs = (numbers(axis, "xyz", 3) or (1.0, 0.0, 0.0) for axis in (a, b))
    return all(abs(abs(x) - abs(y)) < 1e-6 for x, y in zip(ours, theirs, strict=True))


def _text(joint: etree._Element, tag: str, attribute: str) -> str:
    element = first(joint, tag)
    return shown("absent" if element is None else element.get(attribute, "absent"))


def _twin(element: etree._Element) -> str:
    return f"{shown(element.get('name', ''))} on line {line_of(element)}"
