"""Files and functions stay short enough to read; what is longer is a table, or is named here with its reason."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LONGEST_FILE = 350
LONGEST_FUNCTION = 50
FILES = sorted(path for folder in ("src", "tests", "tools", "docs") for path in (ROOT / folder).rglob("*.py"))
SCRIPTS = sorted((ROOT / "src").rglob("*.js"))

_SECTION = "a section of a document: each claim's formula, check and text are one thought"

LONG_FILES: dict[str, str] = {
    "src/nao_kin/robot/robot.py": "what users hold: every question that a robot answers",
    "src/nao_kin/chain.py": "what any chain is, and the free functions on any of them",
    "src/nao_kin/documents/hexapod/hexapod_article.py": _SECTION,
    "src/nao_kin/documents/matlab/head_solutions.py": _SECTION,
    "src/nao_kin/documents/practicum/inverse_jacobians.py": _SECTION,
    "src/nao_kin/documents/practicum/line_profile.py": _SECTION,
    "src/nao_kin/documents/practicum/newtons_method.py": _SECTION,
    "src/nao_kin/documents/thesis/closed_form.py": _SECTION,
    "src/nao_kin/documents/thesis/closed_form_claims.py": _SECTION,
    "src/nao_kin/documents/thesis/fabrik_algorithm.py": _SECTION,
    "src/nao_kin/documents/thesis/jacobian_methods.py": _SECTION,
    "src/nao_kin/documents/thesis/methods_compared.py": _SECTION,
}
LONG_FUNCTIONS: dict[str, str] = {}
"""By path, or by path and name: why it is as long as it is."""


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def functions(path: Path) -> dict[str, int]:
    """Lines of each function without its docstring and decorators, by name."""
    found = {}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first, *rest = node.body
            documented = ast.get_docstring(node, clean=False) is not None
            start = rest[0].lineno if documented and rest else first.lineno
            signature = first.lineno - node.lineno
            found[node.name] = max(found.get(node.name, 0), (node.end_lineno or start) - start + 1 + signature)
    return found


@pytest.mark.parametrize("path", [*FILES, *SCRIPTS], ids=name_of)
def test_files_and_functions_are_short(path: Path) -> None:
    lines = len(path.read_text(encoding="utf-8").splitlines())
    assert lines <= LONGEST_FILE or name_of(path) in LONG_FILES
    if path.suffix == ".py":
        longer = {f"{name_of(path)}:{name}" for name, count in functions(path).items() if count > LONGEST_FUNCTION}
        assert longer <= LONG_FUNCTIONS.keys()


def test_no_exception_is_left_over() -> None:
    lines = {name_of(path): len(path.read_text(encoding="utf-8").splitlines()) for path in [*FILES, *SCRIPTS]}
    assert {name for name, count in lines.items() if count > LONGEST_FILE} == LONG_FILES.keys()
    long = {f"{name_of(path)}:{name}" for path in FILES for name, n in functions(path).items() if n > LONGEST_FUNCTION}
    assert long == LONG_FUNCTIONS.keys()
