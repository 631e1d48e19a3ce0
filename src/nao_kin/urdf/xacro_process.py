"""The program that expands one xacro, in a process of its own: ``python xacro_process.py < request > answer``.

The request and the answer are JSON. Each element that does not belong to xacro carries the file and line it comes from
through the expansion, in an attribute that is taken off again at the end.
"""

from __future__ import annotations

import glob
import io
import json
import os
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.dom import Node, expatbuilder, minidom

_AT = "nao_kin-at"
"""The attribute that says where an element comes from: number of the file and line."""

_MOST_CHARACTERS = 32 * 1024 * 1024


class _Trace:
    """Which files were read, and where the element stands that is being expanded."""

    def __init__(self) -> None:
        self.files: list[str] = []
        self.place: tuple[str, int] | None = None

    def enter(self, node: Any) -> None:
        """Remembers the place of an element, if it has one."""
        if isinstance(place := getattr(node, "nao_kin_place", None), tuple):
            self.place = place
        elif node.nodeType == Node.ELEMENT_NODE and node.hasAttribute(_AT):
            self.place = self.split(node.getAttribute(_AT))

    def split(self, text: str) -> tuple[str, int]:
        """File and line of an attribute's text."""
        file, _, line = text.partition(":")
        return self.files[int(file)], int(line)


class _Builder(expatbuilder.ExpatBuilderNS):
    """Builds the tree that xacro works on, with the place of each element."""

    def __init__(self, trace: _Trace, path: str) -> None:
        super().__init__()
        trace.files.append(path)
        self._path, self._number = path, len(trace.files) - 1

    def start_element_handler(self, name: str, attributes: list[str]) -> None:
        super().start_element_handler(name, attributes)
        node: Any = self.curNode
        line = self.getParser().CurrentLineNumber
        node.nao_kin_place = (self._path, line)
        if not node.tagName.startswith("xacro:"):
            node.setAttribute(_AT, f"{self._number}:{line}")


def _expand(request: dict[str, Any]) -> dict[str, Any]:
    import xacro
    import xacro.substitution_args
    import yaml  # noqa: F401 - xacro imports it late, when nothing may be opened any more

    from nao_kin.urdf.packages import own_package
    from nao_kin.urdf.xacro_guard import Roots, confine

    path, directory = request["path"], Path(request["path"]).absolute().parent
    roots, trace = Roots(), _Trace()
    roots.add(directory)
    if (package := own_package(directory)) is not None:
        roots.add(package)
    packages = request["packages"]
    for folder in packages.values() if isinstance(packages, dict) else packages:
        roots.add(Path(folder))
    _patch(xacro, roots, trace, (directory, packages))
    confine(roots)
    xacro.init_stacks(path)
    try:
        document = xacro.parse(None, path)
        xacro.process_doc(document, mappings=dict(request["arguments"]), verbosity=0)
        return _answer(document, trace)
    except RecursionError:
        return _failure(xacro, trace, "Macros or includes are nested without an end.", refused=True)
    except MemoryError:
        return _failure(xacro, trace, "The expansion takes more memory than a robot needs.", refused=True)
    except BaseException as error:
        return _failure(xacro, trace, _said(error), refused=_is_refusal(error))


def _patch(xacro: Any, roots: Any, trace: _Trace, where: tuple[Path, Any]) -> None:
    """Puts our reading of files, expressions, packages and the environment in the place of xacro's own."""
    _patch_files(xacro, roots, trace, where[0])
    _patch_substitutions(xacro.substitution_args, roots, where)
    xacro.safe_eval = _checked(xacro.safe_eval)
    for name in ("type", "vars"):  # which make classes, and tables of what is behind names
        xacro._global_symbols["python"].pop(name, None)  # noqa: SLF001
    for name in ("eval_all", "grab_property", "grab_macro", "process_include", "handle_macro_call"):
        setattr(xacro, name, _entered(getattr(xacro, name), trace))


def _patch_files(xacro: Any, roots: Any, trace: _Trace, directory: Path) -> None:
    def parse(_: Any, filename: str | None = None) -> Any:
        from nao_kin.urdf.safe_xml import read_tree

        name = os.path.join(str(directory), str(filename))  # noqa: PTH118 - the path as it is shown
        try:
            data = roots.read(name)
        except OSError as error:
            raise xacro.XacroException(f"{error.strerror or error}: {filename}", exc=error) from None
        read_tree(data, name)  # size, encoding, DOCTYPE, depth
        return _Builder(trace, name).parseString(data)

    def open_text(name: str, *_: Any, **__: Any) -> io.StringIO:
        return io.StringIO(roots.read(name).decode("utf-8-sig"))

    def matches(pattern: str) -> list[str]:
        fixed = re.split(r"[*?\[]", pattern, maxsplit=1)[0]
        roots.require(os.path.dirname(fixed))  # noqa: PTH120 - glob itself would pass over what it may not see
        return glob.glob(pattern)  # noqa: PTH207

    xacro.parse, xacro.open, xacro.glob = parse, open_text, SimpleNamespace(glob=matches)


def _patch_substitutions(substitutions: Any, roots: Any, where: tuple[Path, Any]) -> None:
    def find(package: str) -> str:
        from nao_kin.urdf.packages import packages_named

        roots.searching = True
        try:
            found = next((folder for folder, _ in packages_named(package, *where) if folder.is_dir()), None)
        finally:
            roots.searching = False
        if found is not None:
            roots.add(found)
            return str(found)
        raise KeyError(f"package {package!r} was not found")

    def from_environment(name: str) -> str:
        raise KeyError(f"the environment variable {name!r} is not given to files; give it as an argument")

    def default_of(_: str, default: str = "") -> str:
        return default  # as in an empty environment

    substitutions._eval = _checked(substitutions._eval)  # noqa: SLF001
    substitutions._eval_find, substitutions._eval_env = find, from_environment  # noqa: SLF001
    substitutions._eval_optenv = default_of  # noqa: SLF001
    substitutions._eval_dict.update(find=find, env=from_environment, optenv=default_of)  # noqa: SLF001


def _checked(evaluate: Any) -> Any:
    from nao_kin.urdf.xacro_guard import check_expression

    def wrapped(text: str, *arguments: Any) -> Any:
        check_expression(text)
        return evaluate(text, *arguments)

    return wrapped


def _entered(function: Any, trace: _Trace) -> Any:
    def wrapped(node: Any, *arguments: Any) -> Any:
        trace.enter(node)
        return function(node, *arguments)

    return wrapped


def _answer(document: minidom.Document, trace: _Trace) -> dict[str, Any]:
    places: list[tuple[str, int] | None] = []
    pending: list[Any] = [document.documentElement]
    while pending:
        element = pending.pop()
        text = element.getAttribute(_AT)
        places.append(trace.split(text) if text else None)
        if text:
            element.removeAttribute(_AT)
        pending.extend(reversed([child for child in element.childNodes if child.nodeType == Node.ELEMENT_NODE]))
    xml = document.toprettyxml(indent="  ")
    if len(xml) > _MOST_CHARACTERS:
        return {"failure": f"The expansion has more than {_MOST_CHARACTERS} characters.", "refused": True}
    return {"xml": xml, "places": places}


def _failure(xacro: Any, trace: _Trace, said: str, *, refused: bool) -> dict[str, Any]:
    place = trace.place or ((xacro.filestack or [None])[-1], None)
    return {"failure": said, "refused": refused, "file": place[0], "line": place[1]}


def _said(error: BaseException) -> str:
    # xacro puts the type ahead, and says what it wraps once more.
    text = re.sub(r"<class '[\w.]+'>: ", "", " ".join(str(error).split())) or type(error).__name__
    half = len(text) // 2
    if text[:half] == text[half + 1 :]:
        text = text[:half]
    return text[:300] + ("" if text.endswith((".", "!")) else ".")


def _is_refusal(error: BaseException | None) -> bool:
    from nao_kin.urdf.xacro_guard import OutsideError, RefusedExpressionError

    while error is not None:
        if isinstance(error, OutsideError | RefusedExpressionError | MemoryError | RecursionError):
            return True
        error = getattr(error, "exc", None) or error.__context__
    return False


def main() -> None:
    """Reads the request, confines itself, answers."""
    sys.path[:] = [str(Path(__file__).resolve().parents[2]), *sys.path]
    from nao_kin.urdf.xacro_guard import limit_resources

    request = json.loads(sys.stdin.read())
    answer, sys.stdout = sys.stdout, io.StringIO()  # macros may print
    sys.stderr = io.StringIO()
    limit_resources()
    json.dump(_expand(request), answer)
    answer.flush()
    os._exit(0)  # nothing of what macros have left behind is run at the end


if __name__ == "__main__":
    main()
