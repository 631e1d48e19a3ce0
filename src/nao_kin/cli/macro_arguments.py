"""What every command takes for files of macros: NAME:=VALUE, as xacro itself does, and --package NAME=DIR."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["for_macros"]

_ARGUMENT = re.compile(r"([A-Za-z_]\w*):=(.*)", re.DOTALL)


def for_macros(words: Sequence[str], *, own_packages: bool) -> tuple[list[str], dict[str, str], dict[str, str]]:
    """The words that are left for the command, the arguments by name, and the package folders by name.

    Args:
        words: The command line.
        own_packages: Whether the command has a --package of its own, which then stays where it is.
    """
    left: list[str] = []
    arguments: dict[str, str] = {}
    packages: dict[str, str] = {}
    pending = list(words)
    while pending:
        word = pending.pop(0)
        option, equals, value = word.partition("=")
        if found := _ARGUMENT.fullmatch(word):
            arguments[found[1]] = found[2]
        elif option == "--package" and not own_packages and (equals or pending):
            name, _, folder = (value if equals else pending.pop(0)).partition("=")
            packages[name] = folder
        else:
            left.append(word)
    return left, arguments, packages
