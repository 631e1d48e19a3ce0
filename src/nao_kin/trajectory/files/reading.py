"""Trajectories in files: TXT, CSV and JSON, exact to the last bit. docs/trajectory-files.md describes them."""

from __future__ import annotations

import csv
import json
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, cast

from nao_kin.chain import ChainJoint
from nao_kin.errors import InvalidInputError, TrajectoryFileError, near_matches
from nao_kin.replacing import replace_file
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Sequence

    from nao_kin.chain import MovingKind

__all__ = [
    "FORMAT",
    "LARGEST_FILE",
    "FilePlace",
    "columns_of",
    "form_of",
    "format_json",
    "format_rows",
    "format_trajectory",
    "joint_of_column",
    "joint_of_record",
    "number_of",
    "parse_json",
    "parse_rows",
    "parse_trajectory",
    "read_trajectory",
    "record_of",
    "repeated",
    "write_trajectory",
]

FORMAT: Final = "nao_kin trajectory, format 1"
"""How a file says what it is."""

_UNITS: Final = {"revolute": "rad", "continuous": "rad", "prismatic": "m"}
_KINDS: Final = {"rad": "revolute", "m": "prismatic"}
_LIMITS: Final = ("lower", "upper", "max_velocity")
_JOINT_KEYS: Final = ("name", "kind", "unit", *_LIMITS)
# What Python's float() takes beyond this (nan, 1_000, digits of other scripts) no other program would.
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class FilePlace:
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


def joint_of_column(heading: str, place: FilePlace, column: int) -> ChainJoint:
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


def joint_of_record(record: object, place: FilePlace) -> ChainJoint:
    """A joint from its record."""
    if not isinstance(record, dict):
        raise place.refused(f"joint: expected a record with a name and a kind, got {_short(record)}.")
    for key in record:
        if key not in _JOINT_KEYS:
            near = near_matches(str(key), _JOINT_KEYS)
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


def number_of(value: object, place: FilePlace, what: str, column: int | None = None, *, written: bool = False) -> float:
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


def _kind_of(unit: str, name: str, place: FilePlace, column: int) -> Literal["revolute", "prismatic"]:
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


LARGEST_FILE: Final = 1 << 26
"""A file of more bytes is refused; this is an hour of six joints at the usual sampling time."""

_FORMS: Final = ("txt", "csv", "json")


def write_trajectory(path: str | os.PathLike[str], trajectory: Trajectory) -> Path:
    """Writes a trajectory; reading it back gives the same times, joint values, names and limits, bit for bit.

    Args:
        path: Where to; its ending, .txt, .csv or .json, says in which form. An existing file is replaced.
        trajectory: The motion.

    Returns:
        The path written to.

    Raises:
        InvalidInputError: Another ending, or a name with a line break in a form that has one line a thing.
        OSError: The file cannot be written.
    """
    target = Path(path)
    text = format_trajectory(trajectory, form_of(target))
    return replace_file(target, text.encode("utf-8"))


def read_trajectory(path: str | os.PathLike[str]) -> Trajectory:
    """Reads a trajectory.

    Args:
        path: A file whose name ends in .txt, .csv or .json.

    Returns:
        The trajectory, the same to the last bit as the one that was written.

    Raises:
        InvalidInputError: Another ending.
        TrajectoryFileError: Unreadable, too large, or malformed: not a finite number, a missing column, a time that
            does not increase, a unit that does not fit; carries the line and the column.
    """
    file = Path(path)
    name, form = str(path), form_of(file)
    try:
        if not file.is_file():
            raise TrajectoryFileError(name, None, "no such file." if not file.exists() else "not a regular file.")
        if file.stat().st_size > LARGEST_FILE:
            raise TrajectoryFileError(name, None, f"larger than {LARGEST_FILE} bytes.", "Cut it into several motions.")
        text = file.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise TrajectoryFileError(name, None, f"cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError as error:
        raise TrajectoryFileError(name, None, f"not UTF-8 text (byte {error.start}).") from None
    return parse_trajectory(text, form, name)


def format_trajectory(trajectory: Trajectory, form: str) -> str:
    """The text of a file.

    Raises:
        InvalidInputError: There is no such form.
    """
    if form == "json":
        return format_json(trajectory)
    return format_rows(trajectory, "csv" if _known(form) == "csv" else "txt")


def parse_trajectory(text: str, form: str, path: str = "<trajectory>") -> Trajectory:
    """The trajectory in the text of a file.

    Args:
        text: The text.
        form: ``"txt"``, ``"csv"`` or ``"json"``.
        path: What to call it in messages.

    Raises:
        InvalidInputError: There is no such form.
        TrajectoryFileError: Malformed; see `read_trajectory`.
    """
    if form == "json":
        return parse_json(text, path)
    return parse_rows(text, path, "csv" if _known(form) == "csv" else "txt")


def form_of(path: str | os.PathLike[str]) -> str:
    """The form that a file's name asks for: ``"txt"``, ``"csv"`` or ``"json"``.

    Raises:
        InvalidInputError: Another ending.
    """
    return _known(Path(path).suffix.lower().removeprefix("."), str(path))


def _known(form: str, path: str = "") -> str:
    if form not in _FORMS:
        expected = "a name that ends in .txt, .csv or .json" if path else "txt, csv or json"
        raise InvalidInputError("path" if path else "form", expected, repr(path or form))
    return form


_KEYS: Final = ("format", "name", "columns", "joints", "samples")


def format_json(trajectory: Trajectory) -> str:
    """The text of a file; every number to its last bit."""
    head = {
        "format": FORMAT,
        "name": trajectory.name,
        "columns": columns_of(trajectory.joints),
        "joints": [record_of(joint) for joint in trajectory.joints],
    }
    samples = zip(trajectory.times.tolist(), trajectory.q.tolist(), strict=True)
    rows = ",\n".join(f"    {json.dumps([time, *values])}" for time, values in samples)
    return json.dumps(head, indent=2)[:-2] + ',\n  "samples": [\n' + rows + "\n  ]\n}\n"


def parse_json(text: str, path: str) -> Trajectory:
    """The trajectory in the text of a file.

    Raises:
        TrajectoryFileError: Malformed; carries the line and, within a sample, the column.
    """
    data, place = _loaded(text, path), FilePlace(path)
    for key in data:
        if key not in _KEYS:
            near = near_matches(key, _KEYS)
            raise place.refused(f"there is no key {key[:60]!r}.", hint=f"Did you mean {near[0]!r}?" if near else "")
    if data.get("format") != FORMAT:
        raise place.refused(f"format: expected {FORMAT!r}, got {str(data.get('format'))[:60]!r}.")
    if not isinstance(data.get("name", ""), str):
        raise place.refused("name: expected text.")
    if not isinstance(data.get("joints"), list) or not data["joints"]:
        raise place.refused("joints: expected a list of joints.")
    joints = tuple(joint_of_record(record, place) for record in data["joints"])
    if twice := repeated([joint.name for joint in joints]):
        raise place.refused(f"joint {twice!r} occurs twice.")
    columns = columns_of(joints)
    if data.get("columns", columns) != columns:
        raise place.refused(f"columns: expected {columns} as the joints say.")
    if not isinstance(data.get("samples"), list) or not data["samples"]:
        raise place.refused("samples: expected a list of at least one sample.")
    samples = _Samples(text, path, columns).read(data["samples"])
    return Trajectory(joints, [row[0] for row in samples], [row[1:] for row in samples], data.get("name", ""))


def _loaded(text: str, path: str) -> dict[str, Any]:
    try:
        data = json.loads(text, object_pairs_hook=_without_repeats)
    except json.JSONDecodeError as error:
        raise FilePlace(path, error.lineno).refused(f"not JSON: {error.msg} at character {error.colno}.") from None
    except _RepeatedKeyError as error:
        raise FilePlace(path).refused(f"the key {str(error)[:60]!r} occurs twice.") from None
    except RecursionError:
        raise FilePlace(path).refused("nested too deeply to be a trajectory.") from None
    except ValueError:  # integers of thousands of digits
        raise FilePlace(path).refused("a number has too many digits.") from None
    if not isinstance(data, dict):
        raise FilePlace(path).refused("expected a JSON object.")
    return data


class _RepeatedKeyError(Exception):
    pass


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise _RepeatedKeyError(key)
        found[key] = value
    return found


class _Samples:
    """Checks samples one by one, and finds their lines only for a message: JSON does not keep them."""

    def __init__(self, text: str, path: str, columns: list[str]) -> None:
        self.text, self.path, self.columns = text, path, columns

    def read(self, samples: list[Any]) -> list[list[float]]:
        rows: list[list[float]] = []
        for index, sample in enumerate(samples):
            if not isinstance(sample, list) or len(sample) != len(self.columns):
                got = f"{len(sample)}" if isinstance(sample, list) else repr(sample)[:60]
                missing = isinstance(sample, list) and len(sample) < len(self.columns)
                said = f" {self.columns[len(sample)]} is missing." if missing else ""
                reason = f"sample {index}: expected {len(self.columns)} numbers, got {got}.{said}"
                raise self.place(index).refused(reason)
            if all(type(value) is float and value - value == 0.0 for value in sample):
                row = sample
            else:
                place = self.place(index)
                row = [number_of(value, place, name, k + 1) for k, (value, name) in enumerate(self.named(sample))]
            if rows and row[0] <= rows[-1][0]:
                reason = f"time: expected more than {rows[-1][0]!r} s, that of the sample before, got {row[0]!r} s."
                raise self.place(index).refused(reason, 1)
            rows.append(row)
        return rows

    def named(self, sample: list[Any]) -> list[tuple[Any, str]]:
        return list(zip(sample, self.columns, strict=True))

    def place(self, index: int) -> FilePlace:
        """Where the sample of that number begins."""
        start = re.search(r'"samples"\s*:\s*\[', self.text)
        if start is None:  # written with escapes
            return FilePlace(self.path)
        decoder, at = json.JSONDecoder(), start.end()
        for _ in range(index):
            at = decoder.raw_decode(self.text, self._next(at))[1]
        return FilePlace(self.path, self.text.count("\n", 0, self._next(at)) + 1)

    def _next(self, at: int) -> int:
        """Where the next value begins, after blanks and a comma."""
        found = re.compile(r"[\s,]*").match(self.text, at)
        return found.end() if found else at


RowForm: TypeAlias = Literal["txt", "csv"]
_HEAD_KEYS: Final = ("name", "joint")


def format_rows(trajectory: Trajectory, form: RowForm) -> str:
    """The text of a file: comments with the joints, the headings, one row a sample; every number to its last bit.

    Raises:
        InvalidInputError: A joint's name does not fit on a line.
    """
    for joint in trajectory.joints:
        if joint.name != joint.name.strip() or not joint.name.isprintable():
            raise InvalidInputError("joint", "a name that fits on a line; JSON takes any", repr(joint.name)[:60])
    head = [f"# {FORMAT}", f"# name: {json.dumps(trajectory.name)}"]
    head += [f"# joint: {json.dumps(record_of(joint))}" for joint in trajectory.joints]
    columns = columns_of(trajectory.joints)
    head.append(f"# {', '.join(columns)}" if form == "txt" else _csv_line(columns))
    between = " " if form == "txt" else ","
    samples = zip(trajectory.times.tolist(), trajectory.q.tolist(), strict=True)
    rows = [between.join(map(repr, (time, *values))) for time, values in samples]
    return "\n".join([*head, *rows, ""])


def parse_rows(text: str, path: str, form: RowForm) -> Trajectory:
    """The trajectory in the text of a file.

    Raises:
        TrajectoryFileError: Malformed; carries line and column.
    """
    numbered = [(number, line.strip()) for number, line in enumerate(text.split("\n"), start=1)]
    lines = iter([(number, line) for number, line in numbered if line])
    reader = _Reader(path, form)
    samples, last = list[list[float]](), None
    for number, line in reader.after_the_head(lines):
        row = reader.sample(number, line)
        if samples and row[0] <= samples[-1][0]:
            reason = f"time: expected more than {samples[-1][0]!r} s, the time of line {last}, got {row[0]!r} s."
            raise FilePlace(path, number).refused(reason, 1)
        samples.append(row)
        last = number
    if not samples:
        raise FilePlace(path).refused("expected at least one sample, got none.")
    return Trajectory(reader.joints, [row[0] for row in samples], [row[1:] for row in samples], reader.name)


class _Reader:
    """Knows the joints and the name once the head is read."""

    def __init__(self, path: str, form: RowForm) -> None:
        self.path, self.form = path, form
        self.name = ""
        self.joints: tuple[ChainJoint, ...] = ()
        self.columns: list[str] = []

    def after_the_head(self, lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, str]]:
        """Reads the head, and gives the rows below."""
        records: dict[str, ChainJoint] = {}
        for number, line in lines:
            place = FilePlace(self.path, number)
            if line.startswith("#"):
                said = line[1:].strip()
                if said.startswith("time"):
                    self.take_columns(said.split(", "), said, tuple(records.values()), place)
                elif self.columns:
                    continue
                elif (joint := self.take_comment(said, place)) is not None:
                    if joint.name in records:
                        raise place.refused(f"joint {joint.name!r} occurs twice.")
                    records[joint.name] = joint
            elif self.columns:
                yield number, line
            elif self.form == "csv":
                self.take_columns(_csv_cells(line, place), line, tuple(records.values()), place)
            else:
                hint = "The first comment lines name the columns, as '# time [s], joint_1 [rad]'."
                raise place.refused("expected column headings before the first row, got none.", hint=hint)

    def take_comment(self, said: str, place: FilePlace) -> ChainJoint | None:
        """A line of the head: the format, the name, or a joint."""
        if said.startswith("nao_kin trajectory") and said != FORMAT:
            raise place.refused(f"expected {FORMAT!r}, got {said[:60]!r}.")
        key, _, value = said.partition(":")
        if key not in _HEAD_KEYS:
            return None
        try:
            record = json.loads(value)
        except (ValueError, RecursionError):
            raise place.refused(f"{key}: expected JSON, got {value.strip()[:60]!r}.") from None
        if key == "joint":
            return joint_of_record(record, place)
        if not isinstance(record, str):
            raise place.refused(f"name: expected text in quotes, got {value.strip()[:60]!r}.")
        self.name = record
        return None

    def take_columns(self, found: list[str], said: str, joints: tuple[ChainJoint, ...], place: FilePlace) -> None:
        """The headings: of the joints of the head, or, without those, joints without limits."""
        if self.columns:
            raise place.refused("the column headings are there already.")
        if found[0].strip() != "time [s]":
            raise place.refused(f"expected 'time [s]', got {found[0][:60]!r}.", 1)
        recorded = bool(joints)
        if not recorded:
            joints = tuple(joint_of_column(text, place, 2 + i) for i, text in enumerate(found[1:]))
        if not joints:
            raise place.refused("expected at least one joint beside the time, got none.")
        names = [joint.name for joint in joints]
        if twice := repeated(names):
            raise place.refused(f"{twice!r} occurs twice.", 2 + names.index(twice))
        expected = columns_of(joints)
        # A name may hold a comma, so the whole line is what decides; the columns are for the message.
        if recorded and said != (", ".join(expected) if self.form == "txt" else _csv_line(expected)):
            pairs = enumerate(zip([*expected, "no more"], [*found, "no more"], strict=False), start=1)
            at, (wanted, got) = next((pair for pair in pairs if pair[1][0] != pair[1][1]), (1, (expected[0], said)))
            raise place.refused(f"expected {wanted!r} as the joints above say, got {got[:60]!r}.", at)
        self.joints, self.columns = joints, expected

    def sample(self, number: int, line: str) -> list[float]:
        """One row."""
        place = FilePlace(self.path, number)
        words = line.split() if self.form == "txt" else [word.strip() for word in line.split(",")]
        if len(words) != len(self.columns):
            missing = f" {self.columns[len(words)]} is missing." if len(words) < len(self.columns) else ""
            raise place.refused(f"expected {len(self.columns)} numbers, got {len(words)}.{missing}")
        return [
            number_of(word, place, name, column, written=True)
            for column, (word, name) in enumerate(zip(words, self.columns, strict=True), start=1)
        ]


def _csv_cells(line: str, place: FilePlace) -> list[str]:
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise place.refused(f"column headings: {error}.") from None


def _csv_line(columns: list[str]) -> str:
    return ",".join(
        f'"{column.replace(chr(34), 2 * chr(34))}"' if set(column) & set(',"') else column for column in columns
    )
