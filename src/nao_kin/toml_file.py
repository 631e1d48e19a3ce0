"""TOML files that people write, read with suspicion: size, text, keys, and the line of whatever is wrong."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from nao_kin.errors import near_matches

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Mapping

    from nao_kin.errors import NaoKinError

__all__ = ["Refuse", "TomlFile"]

Refuse: TypeAlias = "Callable[[str, int | None, str], NaoKinError]"
"""Makes an error of a path, a line and a reason."""

_TOO_MANY_DIGITS = "a whole number in it has too many digits."
_MOST_BITS = 4096  # of a whole number; Python refuses to print one of four times as many
_LARGEST = 1 << 20  # [byte] a table of a thousand rows is a tenth of this


@dataclass(frozen=True, eq=False, slots=True)
class TomlFile:
    """Parsed TOML with its text, which knows the lines.

    Attributes:
        path: What to call the file in messages.
        text: What is in it.
        data: The same, parsed.
        refusal: Makes an error of a complaint.
        what: What the file should be, for messages: "DH table".
    """

    path: str
    text: str
    data: dict[str, Any]
    refusal: Refuse
    what: str

    @classmethod
    def read(cls, path: str | os.PathLike[str], refusal: Refuse, what: str) -> TomlFile:
        """A file, parsed.

        Raises:
            NaoKinError: As `refusal` makes it: unreadable, too large, no text or no TOML; with a line if there is one.
        """
        name = str(path)
        try:
            file = Path(path)
            if not file.is_file():
                raise refusal(name, None, "no such file." if not file.exists() else "not a regular file.")
            if file.stat().st_size > _LARGEST:
                raise refusal(name, None, f"larger than {_LARGEST} bytes, so it is no {what}.")
            text = file.read_bytes().decode("utf-8-sig")
        except OSError as error:
            raise refusal(name, None, f"cannot be read: {error.strerror}.") from None
        except UnicodeDecodeError as error:
            raise refusal(name, None, f"not UTF-8 text (byte {error.start}).") from None
        return cls.parse(text, name, refusal, what)

    @classmethod
    def parse(cls, text: str, path: str, refusal: Refuse, what: str) -> TomlFile:
        """TOML text, parsed.

        Raises:
            NaoKinError: As `refusal` makes it: no TOML.
        """
        try:
            data = tomllib.loads(text)
        except RecursionError:
            raise refusal(path, None, f"nested too deeply to be a {what}.") from None
        except tomllib.TOMLDecodeError as error:
            found = re.search(r"at line (\d+)", str(error))
            raise refusal(path, int(found[1]) if found else None, f"not TOML: {error}.") from None
        except ValueError:  # a decimal of more digits than Python reads
            raise refusal(path, None, _TOO_MANY_DIGITS) from None
        if _has_huge_number(data):
            raise refusal(path, None, _TOO_MANY_DIGITS)
        return cls(path, text, data, refusal, what)

    def known_keys(self, data: Mapping[str, Any], known: Iterable[str], section: str, number: int) -> None:
        """Refuses a key that is not among the known ones, with near matches."""
        known = tuple(known)
        for key in data:
            if key not in known:
                near = near_matches(key, known)
                hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}."
                raise self.error(section, number, key, f"unknown key {key!r}: {hint}")

    def error(self, section: str, number: int, key: str, reason: str) -> NaoKinError:
        """A complaint about a key of the number-th table of that name, or of the file's own if `section` is empty."""
        return self.refusal(self.path, self.line(section, number, key), reason)

    def line(self, section: str, number: int, key: str) -> int | None:
        """The line of a key in the number-th table of that name, else of the table's heading, else None."""
        start, seen = (0, 0) if not section else (None, 0)
        for index, line in enumerate(self.text.splitlines()):
            heading = re.match(r"\s*\[+\s*([\w.\"'-]+)\s*\]+", line)
            if heading:
                seen += heading[1] == section
                inside = heading[1] == section and seen == number
                if start is not None and not inside:
                    break
                start = index if inside else start
            if start is not None and key and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
                return index + 1
        return None if start is None or not section else start + 1


def _has_huge_number(data: dict[str, Any]) -> bool:
    """Whether a whole number is anywhere that no message could quote."""
    left: list[Any] = [data]
    while left:
        value = left.pop()
        if isinstance(value, dict):
            left += value.values()
        elif isinstance(value, list):
            left += value
        elif isinstance(value, int) and value.bit_length() > _MOST_BITS:
            return True
    return False
