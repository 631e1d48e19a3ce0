"""Trajectories in files: TXT, CSV and JSON, exact to the last bit. docs/trajectory-files.md describes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from nao_kin.errors import InvalidInputError, TrajectoryFileError
from nao_kin.replacing import replace_file
from nao_kin.trajectory.files.json_form import format_json, parse_json
from nao_kin.trajectory.files.row_forms import format_rows, parse_rows

if TYPE_CHECKING:
    import os

    from nao_kin.trajectory.trajectory import Trajectory

__all__ = ["LARGEST_FILE", "form_of", "format_trajectory", "parse_trajectory", "read_trajectory", "write_trajectory"]

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
