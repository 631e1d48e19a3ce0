"""Trajectories as rows of text: TXT (practicum, task 2d), numbers apart by blanks, and CSV, apart by commas."""

from __future__ import annotations

import csv
import json
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.files.columns import (
    FORMAT,
    Place,
    columns_of,
    joint_of_column,
    joint_of_record,
    number_of,
    record_of,
    repeated,
)
from nao_kin.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.chain import ChainJoint

__all__ = ["format_rows", "parse_rows"]

RowForm: TypeAlias = Literal["txt", "csv"]
_KEYS: Final = ("name", "joint")


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
            raise Place(path, number).refused(reason, 1)
        samples.append(row)
        last = number
    if not samples:
        raise Place(path).refused("expected at least one sample, got none.")
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
            place = Place(self.path, number)
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

    def take_comment(self, said: str, place: Place) -> ChainJoint | None:
        """A line of the head: the format, the name, or a joint."""
        if said.startswith("nao_kin trajectory") and said != FORMAT:
            raise place.refused(f"expected {FORMAT!r}, got {said[:60]!r}.")
        key, _, value = said.partition(":")
        if key not in _KEYS:
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

    def take_columns(self, found: list[str], said: str, joints: tuple[ChainJoint, ...], place: Place) -> None:
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
        place = Place(self.path, number)
        words = line.split() if self.form == "txt" else [word.strip() for word in line.split(",")]
        if len(words) != len(self.columns):
            missing = f" {self.columns[len(words)]} is missing." if len(words) < len(self.columns) else ""
            raise place.refused(f"expected {len(self.columns)} numbers, got {len(words)}.{missing}")
        return [
            number_of(word, place, name, column, written=True)
            for column, (word, name) in enumerate(zip(words, self.columns, strict=True), start=1)
        ]


def _csv_cells(line: str, place: Place) -> list[str]:
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise place.refused(f"column headings: {error}.") from None


def _csv_line(columns: list[str]) -> str:
    return ",".join(
        f'"{column.replace(chr(34), 2 * chr(34))}"' if set(column) & set(',"') else column for column in columns
    )
