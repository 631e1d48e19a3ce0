"""Files of macros to URDF, by the library `xacro`, in a process that may do little else.

Macros are code. They are expanded apart from the caller, with bounded time and memory, without the environment, and
with no file in reach but those below the file's own folder, its package, and the packages that it names.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nao_kin.errors import InvalidInputError, MissingExtraError, UrdfError
from nao_kin.urdf.document import document_of, read_bytes
from nao_kin.urdf.outline import Outline
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.safe_xml import read_tree
from nao_kin.urdf.structure import first_defect, tolerated_defects

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lxml import etree

    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.outline import Defect
    from nao_kin.urdf.packages import PackageRoots

__all__ = ["Expansion", "expand_xacro", "is_xacro_file", "read_xacro"]

_UNDEFINED = re.compile(r"Undefined substitution argument (\w+)")
_SECONDS = 40.0  # by the clock; the process has a bound on its processor time too
_HINT = "Macros may read files of their own package, and of those in --package, ROS_PACKAGE_PATH and AMENT_PREFIX_PATH."


@dataclass(frozen=True)
class Expansion:
    """A file of macros, expanded.

    Attributes:
        path: The file of macros.
        data: The URDF, as bytes.
        places: File and line that each element comes from, in the order of the URDF; None where nothing tells.
    """

    path: str
    data: bytes = field(repr=False)
    places: tuple[tuple[str, int] | None, ...] = field(repr=False)

    def place(self, root: etree._Element, defect: Defect) -> tuple[str, int] | None:
        """File and line of a defect in the macros; None where only the expanded text has it."""
        if defect.offset >= 0:
            return None
        for element, place in zip(root.iter("*"), self.places, strict=False):
            if element is defect.at:
                return place
        return None

    def line_text(self, file: str, line: int) -> str:
        """The text of a line of the macros, "" where it cannot be read any more."""
        try:
            lines = read_bytes(file).decode("utf-8", "replace").split("\n")
        except UrdfError:
            return ""
        return lines[line - 1].rstrip("\r") if line <= len(lines) else ""


def is_xacro_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file is one of macros, by its name."""
    return os.fspath(path).endswith(".xacro")


def expand_xacro(
    path: str | os.PathLike[str], arguments: Mapping[str, object] | None = None, packages: PackageRoots = ()
) -> Expansion:
    """Expand a file of macros that may come from a stranger.

    Args:
        path: The file.
        arguments: Values of its ``<xacro:arg>``.
        packages: Package folders by name, or folders that hold packages, for ``$(find NAME)``.

    Returns:
        The URDF and where each of its elements comes from.

    Raises:
        MissingExtraError: The extra ``xacro`` is not installed.
        UrdfError: The file is unreadable, a macro fails or asks for what it may not have, or takes too long; with the
            file and line of the macro.
    """
    name = os.fspath(path)
    read_bytes(name)  # says so if it is no file at all
    if importlib.util.find_spec("xacro") is None:
        raise MissingExtraError(f"The xacro file {name}", "xacro")
    given = {key: _text(key, value) for key, value in (arguments or {}).items()}
    answer = _asked({"path": os.path.abspath(name), "arguments": given, "packages": _plain(packages)}, name)  # noqa: PTH100
    if "xml" in answer:
        places = tuple(None if place is None else (_shown(place[0], name), int(place[1])) for place in answer["places"])
        return Expansion(name, answer["xml"].encode(), places)
    file = answer.get("file")
    where = name if file is None else _shown(file, name)
    said, hint = answer["failure"], _HINT if answer.get("refused") else ""
    if missing := _UNDEFINED.match(said):
        hint = f"Give it: {missing[1]}:=VALUE on the command line, arguments={{{missing[1]!r}: ...}} in Python."
    raise UrdfError(
        where, answer.get("line"), said, hint, code=f"xacro-{'refused' if answer.get('refused') else 'failed'}"
    )


def read_xacro(
    path: str | os.PathLike[str], arguments: Mapping[str, object] | None = None, packages: PackageRoots = ()
) -> UrdfDocument:
    """Read the robot that a file of macros describes; see `expand_xacro` for arguments and errors.

    Raises:
        UrdfError: What it expands to breaks a rule of `read_urdf` too; with the file and line of the macro where they
            can be traced, else with the line of the expanded text, which the message says.
    """
    expansion = expand_xacro(path, arguments, packages)
    root = read_tree(expansion.data, expansion.path)
    outline = Outline(root)
    if (defect := first_defect(outline)) is not None:
        file, line, said = _blamed(expansion, root, defect)
        raise UrdfError(file, line, said, defect.hint, code=defect.code)
    told = []
    for defect in tolerated_defects(outline):
        file, line, said = _blamed(expansion, root, defect)
        told.append(f"{file}:{line}: {said}" if line else said)
    document = document_of(outline, expansion.data, expansion.path)
    return replace(document, directory=Path(expansion.path).absolute().parent, tolerated=tuple(told))


def _blamed(expansion: Expansion, root: etree._Element, defect: Defect) -> tuple[str, int | None, str]:
    place = expansion.place(root, defect)
    if place is not None:
        return *place, defect.message
    line = Positions.of(expansion.data, root).place(defect).line
    return expansion.path, None, f"{defect.message.rstrip('.')} (line {line} of the expanded file)."


def _asked(request: dict[str, Any], name: str) -> dict[str, Any]:
    program = Path(__file__).with_name("xacro_process.py")
    kept = {key: os.environ[key] for key in ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH") if key in os.environ}
    try:
        done = subprocess.run(  # noqa: S603 - our own program, by the interpreter that runs us
            [sys.executable, "-I", "-B", str(program)],
            input=json.dumps(request),
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=_SECONDS,
            env=kept,
            cwd=Path(request["path"]).parent,
            check=False,
        )
        answer = json.loads(done.stdout)
    except (subprocess.TimeoutExpired, ValueError):
        reason = "The expansion took more time or memory than a robot needs, and was ended."
        raise UrdfError(name, None, reason, _HINT, code="xacro-refused") from None
    if not isinstance(answer, dict):
        raise UrdfError(name, None, "The expansion gave no answer.", code="xacro-failed")
    return answer


def _text(name: str, value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str | int | float):
        return str(value)
    raise InvalidInputError(f"arguments, {name}", "text, a number or a truth value", repr(value)[:60])


def _plain(packages: PackageRoots) -> Any:
    if hasattr(packages, "items"):
        return {name: os.path.abspath(folder) for name, folder in packages.items()}  # noqa: PTH100
    given = (packages,) if isinstance(packages, str) else packages
    return [os.path.abspath(folder) for folder in given]  # noqa: PTH100


def _shown(file: str, name: str) -> str:
    """A file as the caller would name it: the file of macros as given, another one relative to it where that helps."""
    absolute = os.path.abspath(name)  # noqa: PTH100
    if file == absolute:
        return name
    folder = os.path.dirname(absolute)  # noqa: PTH120
    relative = os.path.relpath(file, folder)
    return file if os.path.isabs(name) else os.path.normpath(os.path.join(os.path.dirname(name), relative))  # noqa: PTH117, PTH118, PTH120
