"""The size and shape of the package, as a table: files, lines, lone importers, wide signatures, names used twice.

    python tools/structure.py [FOLDER]

FOLDER holds the package `nao_kin` (default: src). A module with a single importer is read by one other module of the
package only, and is not a package's `__init__`; imports that only types need count, as a reader follows them too.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

WIDE = 10
"""Parameters from which on a signature is too wide to call without looking."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Module:
    """A source file: its dotted name, its path and its syntax tree."""

    name: str
    path: Path
    tree: ast.Module

    @property
    def is_package(self) -> bool:
        """Whether this is the `__init__` of a folder."""
        return self.path.name == "__init__.py"


def modules(folder: Path) -> list[Module]:
    """Every module of the package below a folder."""
    found = []
    for path in sorted((folder / "nao_kin").rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found.append(Module(name, path, ast.parse(path.read_text(encoding="utf-8"))))
    return found


def imported(module: Module, names: set[str]) -> Iterator[str]:
    """The package's modules that a module imports anywhere, inside functions too."""
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield whole if whole in names else node.module


def importers(found: list[Module]) -> dict[str, set[str]]:
    """For each module, who imports it."""
    names = {module.name for module in found}
    readers: dict[str, set[str]] = defaultdict(set)
    for module in found:
        for name in set(imported(module, names)) - {module.name}:
            readers[name].add(module.name)
    return readers


def lone(found: list[Module]) -> list[str]:
    """The modules that a single other module imports."""
    readers = importers(found)
    return [module.name for module in found if not module.is_package and len(readers[module.name]) == 1]


def parameters(function: Function) -> int:
    """How many parameters a function has, without `self` or `cls`."""
    given = function.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    return len(every) - bool(every and every[0].arg in {"self", "cls"})


def wide(found: list[Module]) -> list[str]:
    """Functions with many parameters, as `module.name (count)`; commands are left out, whose parameters are options."""
    return [
        f"{module.name}.{node.name} ({parameters(node)})"
        for module in found
        for node in ast.walk(module.tree)
        if isinstance(node, Function) and parameters(node) >= WIDE and not is_command(node)
    ]


def is_command(function: Function) -> bool:
    """Whether a function is a command of the command line: a decorator registers it, or every option is annotated."""
    given = function.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    return any("typer." in ast.unparse(argument.annotation or ast.Constant("")) for argument in every)


def twice(names: Iterator[str]) -> list[str]:
    """The names that occur more than once, with their number."""
    return [f"{name} ×{count}" for name, count in sorted(Counter(names).items()) if count > 1]


def public_classes(found: list[Module]) -> Iterator[str]:
    """The names of all public classes at the top of modules."""
    for module in found:
        for node in module.tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                yield node.name


def main(folder: Path) -> None:
    """Print the table."""
    found = modules(folder)
    alone = lone(found)
    files = twice(m.path.name for m in found if not m.is_package)
    classes = twice(public_classes(found))
    signatures = wide(found)
    print(f"files                          {len(found):6}")
    print(f"lines                          {sum(len(m.path.read_text('utf-8').splitlines()) for m in found):6}")
    print(f"modules with one importer      {len(alone):6}")
    print(f"functions of {WIDE}+ parameters    {len(signatures):6}")
    print(f"file names used twice          {len(files):6}")
    print(f"public classes of one name     {len(classes):6}")
    for title, names in (("one importer", alone), ("wide", signatures), ("files", files), ("classes", classes)):
        print(f"\n{title}:")
        for name in names:
            print(f"  {name}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "src"))
