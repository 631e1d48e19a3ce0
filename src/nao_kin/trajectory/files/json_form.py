"""Trajectories as JSON, one sample a line."""

from __future__ import annotations

import json
import re
from typing import Any, Final

from nao_kin.errors import near_matches
from nao_kin.trajectory.files.columns import FORMAT, Place, columns_of, joint_of_record, number_of, record_of, repeated
from nao_kin.trajectory.trajectory import Trajectory

__all__ = ["format_json", "parse_json"]

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
    data, place = _loaded(text, path), Place(path)
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
        raise Place(path, error.lineno).refused(f"not JSON: {error.msg} at character {error.colno}.") from None
    except _RepeatedKeyError as error:
        raise Place(path).refused(f"the key {str(error)[:60]!r} occurs twice.") from None
    except RecursionError:
        raise Place(path).refused("nested too deeply to be a trajectory.") from None
    except ValueError:  # integers of thousands of digits
        raise Place(path).refused("a number has too many digits.") from None
    if not isinstance(data, dict):
        raise Place(path).refused("expected a JSON object.")
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

    def place(self, index: int) -> Place:
        """Where the sample of that number begins."""
        start = re.search(r'"samples"\s*:\s*\[', self.text)
        if start is None:  # written with escapes
            return Place(self.path)
        decoder, at = json.JSONDecoder(), start.end()
        for _ in range(index):
            at = decoder.raw_decode(self.text, self._next(at))[1]
        return Place(self.path, self.text.count("\n", 0, self._next(at)) + 1)

    def _next(self, at: int) -> int:
        """Where the next value begins, after blanks and a comma."""
        found = re.compile(r"[\s,]*").match(self.text, at)
        return found.end() if found else at
