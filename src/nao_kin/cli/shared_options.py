"""What many commands take beside their own options.

NAME:=VALUE, as xacro itself takes it, and --package NAME=DIR are for files of macros; --tool is what sits on a tip.
"""

from __future__ import annotations

import re
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import typer

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["SharedOptions", "shared_options", "with_given_tool"]

_ARGUMENT: Final = re.compile(r"([A-Za-z_]\w*):=(.*)", re.DOTALL)
_TAKE_A_TOOL: Final = {"fk", "ik", "compare", "trajectory", "workspace"}
_OWN_PACKAGES: Final = {"check"}
_TOOL: ContextVar[tuple[float, ...] | None] = ContextVar("tool", default=None)


@dataclass(frozen=True, slots=True)
class SharedOptions:
    """A command line, taken apart.

    Attributes:
        words: What is left for the command.
        arguments: Values of a file's ``<xacro:arg>``, by name.
        packages: Package folders, by name.
        tool: x y z [m] and roll pitch yaw [rad] of the tool's frame in the tip's, if one is given.
    """

    words: list[str]
    arguments: dict[str, str] = field(default_factory=dict)
    packages: dict[str, str] = field(default_factory=dict)
    tool: tuple[float, ...] | None = None

    @contextmanager
    def in_force(self) -> Iterator[None]:
        """While it lasts, robots are read with the arguments and packages, and chains of robots carry the tool."""
        from nao_kin.robot.sources import reading

        token = _TOOL.set(self.tool)
        try:
            with reading(self.arguments, self.packages):
                yield
        finally:
            _TOOL.reset(token)


def shared_options(words: Sequence[str]) -> SharedOptions:
    """Take these options out of a command line.

    Raises:
        typer.BadParameter: A tool of other than three or six numbers.
    """
    command = words[0] if words else ""
    found = SharedOptions([])
    pending, tool = list(words), None
    while pending:
        word = pending.pop(0)
        option, equals, value = word.partition("=")
        if argument := _ARGUMENT.fullmatch(word):
            found.arguments[argument[1]] = argument[2]
        elif option == "--package" and command not in _OWN_PACKAGES and (equals or pending):
            name, _, folder = (value if equals else pending.pop(0)).partition("=")
            found.packages[name] = folder
        elif option == "--tool" and command in _TAKE_A_TOOL and (equals or pending):
            tool = _numbers(value if equals else pending.pop(0))
        else:
            found.words.append(word)
    return SharedOptions(found.words, found.arguments, found.packages, tool)


def with_given_tool(chain: UrdfChain) -> UrdfChain:
    """The chain with the tool of the command line on its tip, if there is one."""
    tool = _TOOL.get()
    return chain if tool is None else chain.with_tool(tool)


def _numbers(text: str) -> tuple[float, ...]:
    try:
        numbers = tuple(map(float, text.split()))
    except ValueError:
        numbers = ()
    if len(numbers) not in {3, 6}:
        raise typer.BadParameter(f'--tool {text!r}: expected "x y z" [m] or "x y z roll pitch yaw" [m, rad].')
    return numbers
