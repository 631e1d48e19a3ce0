"""What all forms of a trajectory file share: joints as records, column headings, numbers, and places in messages."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, cast

from nao_kin.chain import ChainJoint
from nao_kin.errors import TrajectoryFileError, near_matches

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.chain import MovingKind

__all__ = ["FORMAT", "Place", "columns_of", "joint_of_column", "joint_of_record", "number_of", "record_of", "repeated"]

FORMAT: Final = "nao_kin trajectory, format 1"
"""How a file says what it is."""

_UNITS: Final = {"revolute": "rad", "continuous": "rad", "prismatic": "m"}
_KINDS: Final = {"rad": "revolute", "m": "prismatic"}
_LIMITS: Final = ("lower", "upper", "max_velocity")
_KEYS: Final = ("name", "kind", "unit", *_LIMITS)
# What Python's float() takes beyond this (nan, 1_000, digits of other scripts) no other program would.
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class Place:
    """A file and a line of it, to name in messages.

    Attributes:
        path: The file as named by the caller.
        line: Line number, 1-based; None for the whole file.
    """

    path: str
    line: int | None = None

    def refused(self, reason: str, column: int | None = None, hint: str = "") -> TrajectoryFileError:
        """The error to raise."""
        return TrajectoryFileError(self.path, self.line, reason, hint, column=column)


def columns_of(joints: tuple[ChainJoint, ...]) -> list[str]:
    """The headings of a table: name and unit."""
    return ["time [s]", *(f"{joint.name} [{_UNITS[joint.kind]}]" for joint in joints)]


def joint_of_column(heading: str, place: Place, column: int) -> ChainJoint:
    """A joint from a heading alone: its name, its kind by its unit, no limits."""
    found = re.fullmatch(r"(.+?) ?\[([^\[\]]*)\]", heading.strip())
    if found is None:
        raise place.refused(f"expected NAME [rad] or NAME [m], got {_short(heading)}.", column)
    return ChainJoint(found[1], _kind_of(found[2], found[1], place, column))


def record_of(joint: ChainJoint) -> dict[str, Any]:
    """A joint as it stands in a file; limits that it has not are left out."""
    limits = {key: getattr(joint, key) for key in _LIMITS}
    kept = {key: value for key, value in limits.items() if math.isfinite(value)}
    return {"name": joint.name, "kind": joint.kind, "unit": _UNITS[joint.kind], **kept}


def joint_of_record(record: object, place: Place) -> ChainJoint:
    """A joint from its record."""
    if not isinstance(record, dict):
        raise place.refused(f"joint: expected a record with a name and a kind, got {_short(record)}.")
    for key in record:
        if key not in _KEYS:
            near = near_matches(str(key), _KEYS)
            raise place.refused(f"joint: there is no key {key!r}.", hint=f"Did you mean {near[0]!r}?" if near else "")
    name, kind, unit = (record.get(key) for key in ("name", "kind", "unit"))
    if not isinstance(name, str) or not name:
        raise place.refused(f"joint: expected a name, got {_short(name)}.")
    if not isinstance(kind, str) or kind not in _UNITS:
        raise place.refused(f"joint {name!r}: expected the kind {', '.join(_UNITS)}, got {_short(kind)}.")
    if unit != _UNITS[kind]:
        raise place.refused(f"joint {name!r}: a {kind} joint is in {_UNITS[kind]}, not in {_short(unit)}.")
    limits = {key: number_of(record[key], place, f"joint {name!r}, {key}") for key in _LIMITS if key in record}
    joint = ChainJoint(name, cast("MovingKind", kind), **limits)
    if joint.lower > joint.upper or joint.max_velocity <= 0.0:
        raise place.refused(f"joint {name!r}: expected lower ≤ upper and max_velocity > 0, got {json.dumps(limits)}.")
    return joint


def repeated(names: Sequence[str]) -> str:
    """The first name that occurs again; empty if none does."""
    seen = set[str]()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return ""


def number_of(value: object, place: Place, what: str, column: int | None = None, *, written: bool = False) -> float:
    """A finite number: a JSON value, or, if `written`, the text of one."""
    number = math.nan
    if isinstance(value, str):
        number = float(value) if written and _NUMBER.fullmatch(value) else math.nan
    elif isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if not math.isfinite(number):
        raise place.refused(f"{what}: expected a finite number, got {_short(value)}.", column)
    return number


def _kind_of(unit: str, name: str, place: Place, column: int) -> Literal["revolute", "prismatic"]:
    if unit not in _KINDS:
        hint = "Convert degrees to radians first." if unit.lower() in ("deg", "°", "degrees") else ""
        raise place.refused(f"{name}: expected the unit [rad] or [m], got [{_short(unit)[1:-1]}].", column, hint)
    return cast('Literal["revolute", "prismatic"]', _KINDS[unit])


def _short(value: object) -> str:
    try:
        text = repr(value)
    except ValueError:  # an integer of too many digits
        text = "a huge integer"
    return text if len(text) <= 60 else text[:57] + "..."
