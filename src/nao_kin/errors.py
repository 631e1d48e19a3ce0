"""Everything this package raises on purpose, each leaf carrying the data of its message.

Catch `NaoKinError` to catch them all. An inverse kinematics problem without a solution is *not* an error: it is a
result whose status says why.
"""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = [
    "AuditError",
    "FrameError",
    "InvalidInputError",
    "KeyframeFileError",
    "MissingExtraError",
    "NaoKinError",
    "NoPathError",
    "TableFileError",
    "TrajectoryFileError",
    "UnknownNameError",
    "UrdfError",
]


class NaoKinError(Exception):
    """Root of the errors of this package."""

    def __reduce__(self) -> tuple[Any, ...]:
        # An exception pickles as its class called with its message, which is not what the leaves take.
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[NaoKinError], arguments: tuple[Any, ...], data: dict[str, Any]) -> NaoKinError:
    error = kind.__new__(kind, *arguments)
    error.args = arguments
    error.__dict__.update(data)
    return error


class UnknownNameError(NaoKinError, KeyError):
    """A robot, frame, joint, chain or method was asked for by a name that does not exist.

    Attributes:
        kind: What was looked up, for example ``"frame"``.
        name: The name as given.
        owner: Where it was looked up, for example ``"nao_v50_h25"``; may be empty.
        near: Existing names that resemble it, best first.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str], owner: str = "") -> None:
        name, known = str(name), list(known)
        self.kind, self.name, self.owner = kind, name, owner
        self.near = near_matches(name, known)
        where = f" in {owner}" if owner else ""
        if self.near:
            remedy = f"Did you mean {_either(self.near)}?"
        else:
            remedy = f"Known: {', '.join(known[:12])}{', …' if len(known) > 12 else ''}."
        self.message = f"There is no {kind} {name!r}{where}. {remedy}"
        super().__init__(self.message)

    def __str__(self) -> str:
        return self.message  # KeyError would print the repr of its argument


class InvalidInputError(NaoKinError, ValueError):
    """A value has the wrong shape, is not finite, or is not what its name promises.

    Attributes:
        what: Name of the argument or quantity.
        expected: What it should have been.
        got: What it was.
    """

    def __init__(self, what: str, expected: str, got: str) -> None:
        self.what, self.expected, self.got = what, expected, got
        super().__init__(f"{what}: expected {expected}, got {got}.")


class NoPathError(NaoKinError, ValueError):
    """Two frames exist but no joint lies between them, so no chain can be made of them."""

    def __init__(self, base: str, tip: str, robot: str) -> None:
        self.base, self.tip, self.robot = base, tip, robot
        super().__init__(
            f"No moving joint lies between {base!r} and {tip!r} of {robot}: both are fixed to the same link. "
            "Choose a base and a tip with at least one joint between them."
        )


class MissingExtraError(NaoKinError, ImportError):
    """Something needs an optional part of the installation.

    Attributes:
        what: What was asked for.
        extra: The extra that brings it.
    """

    def __init__(self, what: str, extra: str) -> None:
        self.what, self.extra = what, extra
        super().__init__(f"{what} needs the optional extra '{extra}': pip install 'nao_kin[{extra}]'.")


class AuditError(NaoKinError, RuntimeError):
    """Two independent measurements of a result disagree: a defect of this package or of the machine, to be reported.

    Attributes:
        row: Number of the row of a batch.
        by_chain: What the chain's own forward kinematics says.
        by_kernel: What the compiled one says.
    """

    def __init__(self, row: int, by_chain: str, by_kernel: str) -> None:
        self.row, self.by_chain, self.by_kernel = row, by_chain, by_kernel
        super().__init__(
            f"Row {row}: the chain measures {by_chain}, the compiled kernel {by_kernel}. Please report it."
        )


class FrameError(NaoKinError, ValueError):
    """A message of the streaming protocol was refused.

    Attributes:
        reason: What is wrong with it, one sentence without a full stop.
        fatal: Whether the place of the next message is lost too, so that the connection has to end.
    """

    def __init__(self, reason: str, *, fatal: bool = False) -> None:
        self.reason, self.fatal = reason, fatal
        super().__init__(f"Message refused: {reason}.")


class _FileError(NaoKinError, ValueError):
    """A file was refused, with the place in it."""

    def __init__(self, path: str, line: int | None, reason: str, hint: str = "") -> None:
        self.path, self.line, self.reason, self.hint = path, line, reason, hint
        place = path if line is None else f"{path}:{line}"
        super().__init__(f"{place}: {reason}{f' {hint}' if hint else ''}")


class UrdfError(_FileError):
    """A URDF file was refused.

    Attributes:
        path: The file as named by the caller.
        line: Line number, 1-based, or None where the whole file is meant.
        reason: What is wrong, one sentence.
        hint: What to do about it; may be empty.
        code: Name of the broken rule, as `nao-kin explain` takes it; may be empty.
    """

    def __init__(self, path: str, line: int | None, reason: str, hint: str = "", *, code: str = "") -> None:
        super().__init__(path, line, reason, hint)
        self.code = code


class TableFileError(_FileError):
    """A DH table file was refused; the same attributes as `UrdfError`, without a code."""


class TrajectoryFileError(_FileError):
    """A trajectory file was refused; the same attributes as `UrdfError`, without a code, and the column.

    Attributes:
        column: Number of the column, 1-based, or None where the whole line or file is meant.
    """

    def __init__(self, path: str, line: int | None, reason: str, hint: str = "", *, column: int | None = None) -> None:
        super().__init__(path, line, reason if column is None else f"column {column}: {reason}", hint)
        self.column = column


class KeyframeFileError(_FileError):
    """A file of keyframes was refused; the same attributes as `UrdfError`, without a code."""


def near_matches(name: str, known: Iterable[str], limit: int = 3) -> tuple[str, ...]:
    """The names that resemble `name`, best first, upper and lower case alike."""
    by_folded: dict[str, str] = {}
    for candidate in known:
        by_folded.setdefault(candidate.casefold(), candidate)
    found = difflib.get_close_matches(name.casefold(), by_folded, n=limit, cutoff=0.6)
    return tuple(by_folded[key] for key in found)


def _either(names: tuple[str, ...]) -> str:
    quoted = [repr(name) for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"
