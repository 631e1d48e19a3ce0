"""The TOML format of DH tables: text in, keyword arguments of `DHChain.from_table` out, and back.

docs/dh-table.md describes it. A message names the line and what was expected.
"""

from __future__ import annotations

import ast
import math
import operator
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from nao_kin.arrays import vector
from nao_kin.chain import MovingKind
from nao_kin.dh.dh_row import PER_METRE, PER_RADIAN, Convention, as_row
from nao_kin.errors import InvalidInputError, TableFileError
from nao_kin.se3 import as_pose, from_xyz_rpy
from nao_kin.toml_file import TomlFile

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    from nao_kin.arrays import Floats

__all__ = ["format_table_file", "parse_table_file", "read_table_file"]

_HUGE = 1e300  # TOML has integers that no float holds
_TOP_KEYS = ("name", "convention", "lengths", "angles", "base_name", "tip_name", "base", "tool", "joint")
_NUMBERS = ("a", "alpha", "d", "theta")
_ROW_KEYS = ("name", *_NUMBERS, "sign", "kind", "limits", "max_velocity")
_CHOICES = {"lengths": tuple(PER_METRE), "angles": tuple(PER_RADIAN), "convention": get_args(Convention)}


def read_table_file(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Keyword arguments of `DHChain.from_table` out of a file.

    Raises:
        TableFileError: Unreadable or malformed.
    """
    return _Reader(TomlFile.read(path, TableFileError, "DH table")).table()


def parse_table_file(text: str, path: str = "<table>") -> dict[str, Any]:
    """Keyword arguments of `DHChain.from_table` out of TOML text.

    Raises:
        TableFileError: Malformed; carries the line and what was expected.
    """
    return _Reader(TomlFile.parse(text, path, TableFileError, "DH table")).table()


class _Reader:
    """Checks parsed TOML against the format, finding lines in the text for its messages."""

    def __init__(self, file: TomlFile) -> None:
        self.file, self.error, self.known_keys = file, file.error, file.known_keys

    def table(self) -> dict[str, Any]:
        data = self.file.data
        self.known_keys(data, _TOP_KEYS, "", 0)
        if "convention" not in data:
            raise self.error("", 0, "", "convention is missing: 'standard' (Rz Tz Tx Rx) or 'modified' (Rx Tx Rz Tz).")
        for key, allowed in _CHOICES.items():
            if key in data and data[key] not in allowed:
                raise self.error("", 0, key, f"{key}: expected {' or '.join(allowed)}, got {data[key]!r}.")
        texts: dict[str, Any] = {key: self.text(data, key) for key in ("name", "base_name", "tip_name") if key in data}
        angles = data.get("angles", "rad")
        joints = data.get("joint", [])
        if not isinstance(joints, list) or not joints:
            raise self.error("", 0, "joint", "expected at least one [[joint]] table.")
        return {
            **texts,
            **{key: data[key] for key in _CHOICES if key in data},
            **{key: self.pose(data[key], key, angles) for key in ("base", "tool") if key in data},
            "rows": [self.row(joint, number, angles == "deg") for number, joint in enumerate(joints, start=1)],
        }

    def row(self, joint: object, number: int, degrees: bool) -> dict[str, Any]:
        if not isinstance(joint, dict):
            raise self.error("joint", number, "", f"[[joint]] {number}: expected a table, got {joint!r}.")
        self.known_keys(joint, _ROW_KEYS, "joint", number)
        if missing := [key for key in _NUMBERS if key not in joint]:
            raise self.error("joint", number, "", f"[[joint]] {number}: {', '.join(missing)} missing.")
        row = {key: self.number(joint[key], "joint", number, key) for key in _NUMBERS}
        if degrees and (key := next((k for k in ("alpha", "theta") if "pi" in str(joint[k])), "")):
            reason = f"{key}: {joint[key]!r} is in radians, but this table says angles = 'deg'."
            raise self.error("joint", number, key, reason)
        if "limits" in joint:
            limits = joint["limits"]
            if not isinstance(limits, list) or len(limits) != 2:
                raise self.error("joint", number, "limits", f"limits: expected [lower, upper], got {limits!r}.")
            row["lower"], row["upper"] = (self.number(end, "joint", number, "limits", infinite=True) for end in limits)
            if row["lower"] > row["upper"]:
                raise self.error("joint", number, "limits", f"limits: lower is above upper in {limits!r}.")
        if "max_velocity" in joint:
            row["max_velocity"] = self.number(joint["max_velocity"], "joint", number, "max_velocity")
        if joint.get("sign", 1) not in (1, -1):
            raise self.error("joint", number, "sign", f"sign: expected 1 or -1, got {joint['sign']!r}.")
        kinds = get_args(MovingKind)
        if joint.get("kind", "revolute") not in kinds:
            raise self.error("joint", number, "kind", f"kind: expected {' or '.join(kinds)}, got {joint['kind']!r}.")
        if not isinstance(joint.get("name", ""), str):
            raise self.error("joint", number, "name", f"name: expected text, got {joint['name']!r}.")
        checked = {**row, **{key: joint[key] for key in ("name", "sign", "kind") if key in joint}}
        try:
            as_row(checked, number)
        except InvalidInputError as error:  # what only the row as a whole can tell, as limits of a continuous joint
            raise self.error("joint", number, "", f"[[joint]] {number}: {error}") from None
        return checked

    def pose(self, value: object, section: str, angles: str) -> Floats:
        if not isinstance(value, dict):
            raise self.error("", 0, section, f"{section}: expected a table with xyz and rpy, or with matrix.")
        self.known_keys(value, ("xyz", "rpy", "matrix"), section, 1)
        if "matrix" in value and len(value) > 1:
            raise self.error(section, 1, "matrix", f"{section}: matrix says it all; give either it or xyz and rpy.")
        try:
            if "matrix" in value:
                entries = [[self.number(x, section, 1, "matrix") for x in row] for row in value["matrix"]]
                # A length unit does not matter to whether it is rigid; it is applied with the table's own.
                matrix: Floats = as_pose(entries, "matrix").homogeneous
                return matrix
            xyz, rpy = (
                vector([self.number(x, section, 1, key) for x in value.get(key, (0, 0, 0))], f"{section}.{key}", 3)
                for key in ("xyz", "rpy")
            )
        except (InvalidInputError, TypeError, ValueError) as error:
            if isinstance(error, TableFileError):
                raise
            at = "matrix" if "matrix" in value else ""
            raise self.error(section, 1, at, f"{section}: {error}") from None
        pose: Floats = from_xyz_rpy(xyz, np.radians(rpy) if angles == "deg" else rpy).homogeneous
        return pose

    def number(self, value: object, section: str, number: int, key: str, infinite: bool = False) -> float:
        result = math.nan
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            result = float(value) if abs(value) < _HUGE else math.nan
        elif isinstance(value, str):
            result = _arithmetic(value)
        if infinite and isinstance(value, float) and math.isinf(value):
            return value
        if not math.isfinite(result):
            expected = "a finite number, or arithmetic with pi such as '-pi/2'"
            raise self.error(section, number, key, f"{key}: expected {expected}, got {value!r}.")
        return result

    def text(self, data: dict[str, Any], key: str) -> str:
        if not isinstance(data[key], str):
            raise self.error("", 0, key, f"{key}: expected text, got {data[key]!r}.")
        return str(data[key])


_OPERATORS: dict[type, Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def _arithmetic(text: str) -> float:
    """The value of sums, products and quotients of numbers and pi; NaN for anything else."""

    def value(node: ast.expr) -> float:
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return float(number)
            case ast.Name(id="pi" | "π"):
                return math.pi
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -value(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return value(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](value(left), value(right))
        return math.nan

    if len(text) > 80:  # deep nesting would exhaust the parser's stack
        return math.nan
    try:
        return value(ast.parse(text.strip(), mode="eval").body)
    except (SyntaxError, ValueError, ZeroDivisionError, OverflowError):
        return math.nan


def format_table_file(heading: Mapping[str, str], base: Floats, tool: Floats, rows: Sequence[Mapping[str, Any]]) -> str:
    """TOML text of a table in metres and radians; numbers are written so that they read back bit for bit."""
    lines = [f"{key} = {_quoted(value)}" for key, value in heading.items()]
    lines += ['lengths = "m"', 'angles = "rad"']
    for section, T in (("base", base), ("tool", tool)):
        if not np.array_equal(T, np.eye(4)):
            matrix = ",\n    ".join(str([float(x) for x in row]) for row in T)
            lines += ["", f"[{section}]", f"matrix = [\n    {matrix},\n]"]
    for row in rows:
        lines += ["", "[[joint]]", f"name = {_quoted(row['name'])}"]
        lines += [f"{key} = {float(row[key])!r}" for key in _NUMBERS]
        if row["sign"] != 1:
            lines.append(f"sign = {row['sign']}")
        if row["kind"] != "revolute":
            lines.append(f"kind = {_quoted(row['kind'])}")
        if math.isfinite(row["lower"]) or math.isfinite(row["upper"]):
            lines.append(f"limits = [{row['lower']!r}, {row['upper']!r}]")
        if math.isfinite(row["max_velocity"]):
            lines.append(f"max_velocity = {row['max_velocity']!r}")
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'
