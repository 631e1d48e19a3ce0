"""What the process that expands a xacro may do: compute for a while, and read files below the allowed folders.

Three locks, one behind the other: expressions are looked at before they are evaluated, every file
name is checked before it is opened, and the interpreter itself refuses what got past both.
"""

from __future__ import annotations

import ast
import contextlib
import os
import resource
import sys
import sysconfig
from pathlib import Path
from typing import Any

__all__ = ["OutsideError", "RefusedExpressionError", "Roots", "check_expression", "confine", "limit_resources"]

_LONGEST = 4096
_ALLOWED = (
    *(ast.Expression, ast.BoolOp, ast.And, ast.Or, ast.BinOp, ast.operator, ast.UnaryOp, ast.unaryop, ast.Compare),
    *(ast.cmpop, ast.IfExp, ast.Call, ast.keyword, ast.Attribute, ast.Subscript, ast.Slice, ast.Name, ast.Constant),
    *(ast.List, ast.Tuple, ast.Dict, ast.Set, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
    *(ast.comprehension, ast.Starred, ast.JoinedStr, ast.FormattedValue, ast.expr_context),
)
_REACHING = frozenset({"format", "format_map", "mro", "tb_frame", "tb_next"})
"""Attributes without an underscore ahead that lead from a value to the interpreter."""

_FRAMES = ("gi_", "cr_", "ag_", "co_", "f_back", "f_builtins", "f_code", "f_globals", "f_locals", "func_")


class RefusedExpressionError(ValueError):
    """An expression asks for more than values; the message is a predicate."""


def check_expression(text: str) -> None:
    """Make sure that an expression only computes.

    Raises:
        RefusedExpressionError: It holds something else; the message says what.
        SyntaxError: It is no expression.
    """
    if len(text) > _LONGEST:
        raise RefusedExpressionError(f"has more than {_LONGEST} characters")
    for node in ast.walk(ast.parse(text.strip(), mode="eval")):
        if not isinstance(node, _ALLOWED):
            raise RefusedExpressionError(f"holds a {type(node).__name__}, which is not evaluated")
        if isinstance(node, ast.Name) and node.id.startswith("__"):
            raise RefusedExpressionError(f"names {node.id}")
        if isinstance(node, ast.Attribute) and _reaches(node.attr):
            raise RefusedExpressionError(f"asks for the attribute {node.attr}, which leads out of the expression")


def _reaches(attribute: str) -> bool:
    return attribute.startswith("_") or attribute in _REACHING or attribute.startswith(_FRAMES)


_SECONDS = 10  # of processor time
_MEMORY = 1 << 30  # [bytes]
_FILES = 64
_FILE_BYTES = 16 * 1024 * 1024
_DENIED = (
    *("subprocess.", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.fork", "os.startfile", "os.kill"),
    *("socket.", "ctypes.", "urllib.", "http.", "ftplib.", "smtplib.", "pty.", "mmap.", "fcntl."),
    *("os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.link", "os.symlink", "os.chmod", "os.chown", "os.utime"),
    *("os.truncate", "os.putenv", "os.unsetenv", "shutil.", "tempfile.", "code.__new__", "function.__new__"),
    *("sys.setprofile", "sys.settrace"),
)
"""Beginnings of the names of audit events."""

_FOLDERS = ("os.listdir", "os.scandir", "os.walk", "glob.glob")


class OutsideError(PermissionError):
    """A file outside the allowed folders, or something else that a macro may not ask for."""


class Roots:
    """The folders that may be read; a package that was found by its name is added."""

    def __init__(self) -> None:
        self._folders: list[str] = []
        self.searching = False
        """Whether our own search for a package is under way, which looks at more folders than macros may."""

    def add(self, folder: Path) -> None:
        """Allows a folder and what is below it."""
        self._folders.append(os.path.realpath(folder))

    def require(self, path: str) -> str:
        """The real path, with symbolic links followed, if it is allowed.

        Raises:
            OutsideError: It is not.
        """
        real = os.path.realpath(path)
        if not any(real == folder or real.startswith(folder.rstrip("/") + "/") for folder in self._folders):
            raise OutsideError(f"{path} lies outside the folders that may be read")
        return real

    def read(self, path: str) -> bytes:
        """The bytes of an allowed regular file.

        Raises:
            OSError: There is none, or it is too large; `OutsideError` where it is elsewhere.
        """
        real = Path(self.require(path))
        if not real.is_file():
            raise FileNotFoundError(2, "No such file", path)
        if real.stat().st_size > _FILE_BYTES:
            raise OSError(27, f"The file has more than {_FILE_BYTES} bytes", path)
        return real.read_bytes()


def limit_resources() -> None:
    """Bounds time, memory and files of this process, for good."""
    for what, most in (
        (resource.RLIMIT_CPU, _SECONDS),
        (resource.RLIMIT_AS, _MEMORY),
        (resource.RLIMIT_NOFILE, _FILES),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        with contextlib.suppress(ValueError, OSError):  # where the machine allows even less
            resource.setrlimit(what, (most, most))


def confine(roots: Roots) -> None:
    """From here on the interpreter opens allowed files only, writes none, and starts and reaches nothing."""
    libraries = tuple({os.path.realpath(path) + "/" for path in (*sysconfig.get_paths().values(), *sys.path) if path})

    def refuse(event: str, arguments: tuple[Any, ...]) -> None:
        if roots.searching and event in {"open", *_FOLDERS}:
            return
        if event == "open":
            path, mode, flags = arguments
            if isinstance(path, int):
                return
            name = os.fsdecode(path)
            if (flags or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT) or set(mode or "") & set("wax+"):
                raise OutsideError(f"{name} would be written")
            # Python reads its own modules late, and the names of encodings later still.
            if not os.path.realpath(name).startswith(libraries):
                roots.require(name)
        elif event in _FOLDERS:
            if arguments and isinstance(arguments[0], str | bytes) and event != "glob.glob":
                folder = os.path.realpath(os.fsdecode(arguments[0]))
                if not f"{folder}/".startswith(libraries):
                    roots.require(folder)
        elif event.startswith(_DENIED):
            raise OutsideError(f"{event} is not allowed")

    sys.addaudithook(refuse)
