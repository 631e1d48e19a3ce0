"""Rules about numbers that this package reads past, or that other readers read differently, and about their units."""

from __future__ import annotations

import math
import re
from statistics import median
from typing import TYPE_CHECKING

from nao_kin.checks.subject import numbers
from nao_kin.urdf.fields import Field, fields_of
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import Defect, children, describe, first, shown, tag_of
from nao_kin.urdf.quaternion import SHORTEST_QUATERNION
from nao_kin.urdf.values import field_defects

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.checks.subject import Subject

__all__ = [
    "angles_in_degrees",
    "colours",
    "lengths_in_millimetres",
    "other_readers_numbers",
    "quaternions_of_other_length",
    "stray_blanks",
]

_OTHERS_READ: dict[str, tuple[Field, ...]] = {
    "dynamics": (Field("damping", minimum=0.0), Field("friction", minimum=0.0)),
    "safety_controller": (
        Field("soft_lower_limit"),
        Field("soft_upper_limit"),
        Field("k_position"),
        Field("k_velocity", required=True),
    ),
    "calibration": (Field("rising"), Field("falling")),
}
"""Numbers of a joint that nothing here needs, but for which urdfdom (ROS, Pinocchio) refuses a file."""

# A value that starts or ends with a blank, or holds a line break or a tab. Asked of the whole text before anything is
# located, because hardly any file has one. A character reference may stand for a line break too.
_SUSPECT = re.compile(
    "|".join(rf"=\s*{q}(?:\s[^{q}]*|[^{q}]*[\t\r\n][^{q}]*|[^{q}]*\s){q}" for q in ('"', "'")) + "|&#"
)

_UNIT = 1e-3  # a printed 0.707 is meant as part of a unit quaternion
_FULL_TURN = 2.0 * math.pi + 0.01  # [rad]
_FAR = 10.0  # [m] no robot has neighbouring joints or a shape's centre that far away
_FAR_FOR_IT = 25.0  # times the middle distance between joints
_NOTICEABLE = 2.0  # [m]


def other_readers_numbers(subject: Subject) -> Iterator[Defect]:
    """The numbers that only other readers read are numbers too."""
    for joint in subject.outline.joints:
        for tag, fields in _OTHERS_READ.items():
            element = first(joint, tag)
            if element is None:
                continue
            for field in fields:
                yield from field_defects(element, field)
            if tag == "dynamics" and not any(element.get(field.attribute) is not None for field in fields):
                message = f"The {describe(element)} gives neither damping nor friction."
                yield Defect("missing-number", element, message, "Give one of them, or remove <dynamics>.")


def stray_blanks(subject: Subject) -> Iterator[Defect]:
    """Numbers are separated by plain blanks, and a single one stands alone."""
    if not _SUSPECT.search(subject.positions.text):
        return
    for element in subject.outline.described():
        own = _OTHERS_READ.get(tag_of(element), ()) if _owner_tag(element) == "joint" else ()
        for field in (*fields_of(element, subject.outline.version), *own):
            raw = subject.positions.raw_value(element, field.attribute) or ""
            if numbers(element, field.attribute, field.count) is None:
                continue  # reported as no number
            if re.search(r"[\t\r\n]", raw + element.get(field.attribute, "")) or (
                field.count == 1 and raw != raw.strip()
            ):
                what = "blanks around it" if field.count == 1 else "a line break or tab in it"
                message = f"The {field.attribute} of the {describe(element)} has {what}."
                hint = "ROS and Pinocchio refuse it: write numbers with single blanks between them and none around."
                yield Defect("stray-blank", element, message, hint, field.attribute)


def quaternions_of_other_length(subject: Subject) -> Iterator[Defect]:
    """A quaternion has length 1."""
    if subject.outline.version < FormatVersion.V1_1:
        return
    for element in _origins(subject):
        quaternion = numbers(element, "quat_xyzw", 4)
        length = math.hypot(*quaternion) if quaternion else 1.0
        if quaternion and length >= SHORTEST_QUATERNION and abs(length - 1.0) > _UNIT:
            message = f"The quat_xyzw of the {describe(element)} has length {length:.6g}, not 1."
            hint = f'Write quat_xyzw="{" ".join(f"{part / length:.9g}" for part in quaternion)}".'
            yield Defect("quaternion-not-unit", element, message, hint, "quat_xyzw")


def colours(subject: Subject) -> Iterator[Defect]:
    """The parts of a colour lie between 0 and 1."""
    for element in subject.outline.described():
        rgba = numbers(element, "rgba", 4) if tag_of(element) == "color" else None
        if rgba is not None and not 0.0 <= min(rgba) <= max(rgba) <= 1.0:
            message = f"The rgba of the {describe(element)} is {shown(element.get('rgba', ''))}, not within 0 … 1."
            hint = "Divide by 255." if max(rgba) > 1.0 else ""
            yield Defect("colour-out-of-range", element, message, hint, "rgba")


def lengths_in_millimetres(subject: Subject) -> Iterator[Defect]:
    """Joints and shapes are not kilometres apart."""
    origins = [origin for joint in subject.outline.joints if (origin := first(joint, "origin")) is not None]
    lengths = [length for origin in origins if (length := _length(origin)) > 0.0]
    usual = median(lengths) if lengths else 0.0
    for element in _origins(subject):
        length = _length(element)
        outlier = _owner_tag(element) == "joint" and length > max(_NOTICEABLE, _FAR_FOR_IT * usual)
        if length > _FAR or outlier:
            message = f"The {describe(element)} is {length:.6g} m away from its parent."
            yield Defect("length-in-millimetres", element, message, "Is it in millimetres?", "xyz")


def angles_in_degrees(subject: Subject) -> Iterator[Defect]:
    """No origin is turned by more than a full turn."""
    for element in _origins(subject):
        rpy = numbers(element, "rpy", 3)
        largest = max(map(abs, rpy)) if rpy else 0.0
        if rpy and largest > _FULL_TURN:
            radians = " ".join(f"{math.radians(angle):.9g}" for angle in rpy)
            message = f"The rpy of the {describe(element)} is {shown(element.get('rpy', ''))}, more than a full turn."
            yield Defect("angle-in-degrees", element, message, f'Is it in degrees? In radians: "{radians}".', "rpy")


def _origins(subject: Subject) -> Iterator[etree._Element]:
    """The origins that count, in no particular order."""
    for owner in (*subject.outline.joints, *_parts(subject)):
        if (origin := first(owner, "origin")) is not None:
            yield origin


def _parts(subject: Subject) -> Iterator[etree._Element]:
    for link in subject.outline.links:
        for tag in ("visual", "collision", "inertial"):
            yield from children(link, tag)


def _length(origin: etree._Element) -> float:
    xyz = numbers(origin, "xyz", 3)
    return math.hypot(*xyz) if xyz else 0.0


def _owner_tag(element: etree._Element) -> str:
    owner = element.getparent()
    return "" if owner is None else tag_of(owner)
