"""Rules about axes and limits that load but are nearly certainly not meant."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.checks.digits import swapped_digits
from nao_kin.checks.subject import numbers
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import MOVING, Defect, describe, first
from nao_kin.urdf.values import SHORTEST_AXIS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from nao_kin.checks.subject import Subject

__all__ = [
    "axes_of_other_length",
    "continuous_with_limits",
    "empty_axes",
    "incomplete_limits",
    "limits_in_other_units",
    "mimics_of_fixed_joints",
    "slips_between_limits",
    "zero_ranges",
]

_UNIT = 1e-3  # a printed 0.707 is meant as a unit vector
_TWO_TURNS = 4.0 * math.pi + 0.01  # [rad] the widest limits of real arms are two turns either way
_UNLIMITED = 1500.0  # [rad] beyond it a limit is a way to say "none"
_METRES = 10.0  # [m] no real slide is longer


def axes_of_other_length(subject: Subject) -> Iterator[Defect]:
    """A joint's axis has length 1."""
    for joint in subject.outline.moving:
        axis = first(joint, "axis")
        vector = numbers(axis, "xyz", 3)
        if axis is None or vector is None:
            continue
        length = math.hypot(*vector)
        if length >= SHORTEST_AXIS and abs(length - 1.0) > _UNIT:
            message = f"The axis of the {describe(joint)} has length {length:.6g}, not 1."
            hint = f'Write xyz="{" ".join(f"{x / length:.9g}" for x in vector)}".'
            yield Defect("axis-not-unit", axis, message, hint, "xyz")


def empty_axes(subject: Subject) -> Iterator[Defect]:
    """An <axis> says a direction even where nothing turns about it."""
    for joint in subject.outline.joints:
        axis = first(joint, "axis")
        if axis is not None and axis.get("xyz") is None and joint.get("type") not in MOVING:
            message = f"The <axis> of the {describe(joint)} has no xyz."
            yield Defect("empty-axis", axis, message, "Remove it: the joint does not move.")


def incomplete_limits(subject: Subject) -> Iterator[Defect]:
    """A <limit> says how fast and how strong, as URDF demands before version 1.2."""
    if subject.outline.version >= FormatVersion.V1_2:
        return
    for joint in subject.outline.joints:
        limit = first(joint, "limit")
        missing = [] if limit is None else [name for name in ("velocity", "effort") if limit.get(name) is None]
        if limit is not None and missing:
            message = f"The <limit> of the {describe(joint)} has no {' and no '.join(missing)}."
            hint = "ROS and Pinocchio refuse the file without; write 0 effort or a large number if it is not known."
            yield Defect("incomplete-limit", limit, message, hint)


def zero_ranges(subject: Subject) -> Iterator[Defect]:
    """A joint that may not move is called fixed."""
    for joint in subject.outline.moving:
        limit = first(joint, "limit")
        if limit is None or joint.get("type") == "continuous":
            continue
        lower, upper = _end(limit, "lower"), _end(limit, "upper")
        absent = any(limit.get(side) is None for side in ("lower", "upper"))
        if absent and subject.outline.version >= FormatVersion.V1_2:
            continue  # refused for it
        if lower is not None and lower == upper:
            message = f"The {describe(joint)} may only be at {lower:g}: its limits are equal."
            hint = "An absent limit counts as 0; give both, or make the joint fixed."
            yield Defect("zero-range", limit, message, hint, "lower")


def slips_between_limits(subject: Subject) -> Iterator[Defect]:
    """The two limits of a joint are not the same figure with two neighbouring digits swapped."""
    for joint in subject.outline.moving:
        limit = first(joint, "limit")
        lower, upper = (None if limit is None else numbers(limit, side) for side in ("lower", "upper"))
        if limit is None or lower is None or upper is None or joint.get("type") == "continuous":
            continue
        if lower[0] < 0.0 < upper[0] and swapped_digits(lower[0], upper[0]):
            message = (
                f"The limits of the {describe(joint)} are {lower[0]:.9g} and {upper[0]:.9g}: the same figure with "
            )
            message += "two digits swapped."
            yield Defect("limit-digits", limit, message, "Look up which of the two is right.", "upper")


def continuous_with_limits(subject: Subject) -> Iterator[Defect]:
    """A continuous joint has no range, because readers ignore it."""
    for joint in subject.outline.moving:
        limit = first(joint, "limit")
        if limit is None or joint.get("type") != "continuous":
            continue
        ends = {name: value for name in ("lower", "upper") if (value := numbers(limit, name)) not in (None, (0.0,))}
        if ends:
            texts = " and ".join(f"{name} {value[0]:g}" for name, value in ends.items() if value)
            message = f"The {describe(joint)} is continuous, so its limits ({texts}) are not obeyed."
            hint = "Make it revolute, or remove lower and upper."
            yield Defect("continuous-with-limits", limit, message, hint, next(iter(ends)))


def limits_in_other_units(subject: Subject) -> Iterator[Defect]:
    """Ranges are radians and metres."""
    for joint in subject.outline.moving:
        limit = first(joint, "limit")
        ends = [(name, _end(limit, name)) for name in ("lower", "upper")] if limit is not None else []
        sizes = {name: abs(value) for name, value in ends if value is not None}
        if limit is None or not sizes:
            continue
        name = max(sizes, key=lambda name: sizes[name])
        largest = sizes[name]
        if joint.get("type") == "revolute" and _TWO_TURNS < largest <= _UNLIMITED:
            message = f"The {name} limit of the {describe(joint)} is {largest:g} rad in size, more than two turns."
            hint = f"Is it in degrees? {largest:g}° are {math.radians(largest):.6g} rad."
            yield Defect("limit-in-degrees", limit, message, hint, name)
        elif joint.get("type") == "prismatic" and _METRES < largest <= _UNLIMITED:
            message = f"The {name} limit of the {describe(joint)} is {largest:g} m in size."
            yield Defect("limit-in-millimetres", limit, message, "Is it in millimetres?", name)


def mimics_of_fixed_joints(subject: Subject) -> Iterator[Defect]:
    """A <mimic> names a joint even where it means nothing."""
    for joint in subject.outline.joints:
        mimic = first(joint, "mimic")
        if mimic is not None and joint.get("type") not in MOVING and not mimic.get("joint"):
            message = f"The <mimic> of the {describe(joint)} names no joint."
            yield Defect("unknown-leader", mimic, message, "Remove it: the joint does not move.")


def _end(limit: etree._Element, name: str) -> float | None:
    """One end of a range, 0 where it is absent, None where it is malformed."""
    values = (0.0,) if limit.get(name) is None else numbers(limit, name)
    return None if values is None else values[0]
