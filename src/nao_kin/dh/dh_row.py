"""One row of a Denavit-Hartenberg table: its fields, its units and its matrix."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from nao_kin.chain import MovingKind
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = [
    "PER_METRE",
    "PER_RADIAN",
    "Convention",
    "DHRow",
    "RowLike",
    "as_row",
    "dh_matrix",
    "in_si",
    "known_convention",
]

Convention: TypeAlias = Literal["standard", "modified"]
RowLike: TypeAlias = "DHRow | Mapping[str, Any] | Sequence[float]"

PER_METRE = {"m": 1.0, "mm": 1000.0}
PER_RADIAN = {"rad": 1.0, "deg": 180.0 / math.pi}


@dataclass(frozen=True, slots=True)
class DHRow:
    """One row of a table, in metres and radians.

    A revolute joint turns by θ = sign · q + theta, so `theta` is the offset in the table's last column; a prismatic
    one slides by sign · q + d.

    Attributes:
        a: Link length along x [m].
        alpha: Link twist about x [rad].
        d: Link offset along z [m].
        theta: Constant part of the joint angle about z [rad].
        sign: +1, or −1 where the table has the joint turn the other way ("−θ₃").
        name: Joint name; ``joint_1`` … where the table has none.
        kind: ``"revolute"``, ``"continuous"`` or ``"prismatic"``.
        lower: Least joint value [rad or m].
        upper: Greatest joint value [rad or m].
        max_velocity: Greatest joint speed [rad/s or m/s].

    Raises:
        InvalidInputError: A number is not finite (limits may be infinite), the sign is not ±1, the kind is unknown, the
            limits are inverted or those of a continuous joint, or the speed is not positive.
    """

    a: float
    alpha: float
    d: float
    theta: float
    sign: int = 1
    name: str = ""
    kind: MovingKind = "revolute"
    lower: float = -math.inf
    upper: float = math.inf
    max_velocity: float = math.inf

    def __post_init__(self) -> None:
        what = f"row {self.name or '?'}"
        for key in ("a", "alpha", "d", "theta"):
            if not math.isfinite(_number(getattr(self, key), f"{what}, {key}")):
                raise InvalidInputError(f"{what}, {key}", "a finite number", repr(getattr(self, key)))
        if _number(self.sign, f"{what}, sign") not in (1, -1):
            raise InvalidInputError(f"{what}, sign", "+1 or -1", repr(self.sign))
        object.__setattr__(self, "sign", int(self.sign))
        if not isinstance(self.name, str):
            raise InvalidInputError("row, name", "text", repr(self.name))
        if self.kind not in get_args(MovingKind):
            raise InvalidInputError(f"{what}, kind", "'revolute', 'continuous' or 'prismatic'", repr(self.kind))
        lower, upper = _number(self.lower, f"{what}, lower"), _number(self.upper, f"{what}, upper")
        if not lower <= upper:
            raise InvalidInputError(f"{what}, limits", "lower ≤ upper", f"[{lower}, {upper}]")
        if self.kind == "continuous" and (lower, upper) != (-math.inf, math.inf):
            raise InvalidInputError(f"{what}, limits", "none, for the joint is continuous", f"[{lower}, {upper}]")
        if not _number(self.max_velocity, f"{what}, max_velocity") > 0.0:
            raise InvalidInputError(f"{what}, max_velocity", "a number > 0", repr(self.max_velocity))


def _number(value: object, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating, np.integer)):
        raise InvalidInputError(what, "a number", repr(value))
    try:
        return float(value)
    except OverflowError:
        raise InvalidInputError(what, "a number", "one of too many digits") from None


def dh_matrix(row: DHRow, q: float, convention: Convention) -> Floats:
    """The homogeneous matrix (4, 4) of one row at joint value q [rad or m]."""
    theta, d = row.theta, row.d
    if row.kind == "prismatic":
        d += row.sign * q
    else:
        theta += row.sign * q
    ct, st, ca, sa = math.cos(theta), math.sin(theta), math.cos(row.alpha), math.sin(row.alpha)
    if convention == "standard":
        entries = [
            [ct, -st * ca, st * sa, row.a * ct],
            [st, ct * ca, -ct * sa, row.a * st],
            [0.0, sa, ca, d],
        ]
    else:
        entries = [
            [ct, -st, 0.0, row.a],
            [st * ca, ct * ca, -sa, -sa * d],
            [st * sa, ct * sa, ca, ca * d],
        ]
    return np.array([*entries, [0.0, 0.0, 0.0, 1.0]])


def known_convention(convention: Convention) -> Convention:
    """The convention, if it is one.

    Raises:
        InvalidInputError: It is neither ``"standard"`` nor ``"modified"``.
    """
    if convention not in get_args(Convention):
        expected = "'standard' (Rz Tz Tx Rx) or 'modified' (Rx Tx Rz Tz)"
        raise InvalidInputError("convention", expected, repr(convention))
    return convention


def as_row(row: RowLike, number: int) -> DHRow:
    """A row from any of the forms that `DHChain.from_table` takes; `number` counts from 1, for messages.

    Raises:
        InvalidInputError: Missing or unknown fields, or a wrong count of numbers.
    """
    if isinstance(row, DHRow):
        return row
    try:
        return _as_row(row, number)
    except InvalidInputError as error:
        what = error.what.replace("row ?", f"row {number}")
        raise InvalidInputError(what, error.expected, error.got) from None


def _as_row(row: RowLike, number: int) -> DHRow:
    if isinstance(row, Mapping):
        known = {f.name for f in fields(DHRow)}
        missing, extra = {"a", "alpha", "d", "theta"} - set(row), set(row) - known
        if missing or extra:
            got = f"no {', '.join(sorted(missing))}" if missing else f"unknown {', '.join(sorted(map(str, extra)))}"
            raise InvalidInputError(f"row {number}", "a, alpha, d, theta and optional fields of DHRow", got)
        return DHRow(**row)
    if not isinstance(row, list | tuple | np.ndarray) or len(row) not in (4, 5):
        raise InvalidInputError(f"row {number}", "(a, alpha, d, theta) or (a, alpha, d, theta, sign)", repr(row))
    a, alpha, d, theta, sign = (*row, 1)[:5]
    return DHRow(a, alpha, d, theta, sign)  # DHRow checks the sign and makes it an integer


def in_si(row: DHRow, number: int, lengths: str, angles: str) -> DHRow:
    """The row in metres and radians, and named."""
    per_metre, per_radian = PER_METRE[lengths], PER_RADIAN[angles]
    turn = math.radians if angles == "deg" else float  # radians(90) is π/2 to the last bit, 90 / (180 / π) is not
    own = per_metre if row.kind == "prismatic" else per_radian
    return replace(
        row,
        a=row.a / per_metre,
        alpha=turn(row.alpha),
        d=row.d / per_metre,
        theta=turn(row.theta),
        name=row.name or f"joint_{number}",
        lower=row.lower / own,
        upper=row.upper / own,
        max_velocity=row.max_velocity / own,
    )
