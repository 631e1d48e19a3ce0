"""One thought a file: one that is very long or very short is asked why, and its reason stands here."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LONGEST_FILE = 350
SHORTEST_FILE = 40
LONGEST_FUNCTION = 50
FILES = sorted(path for folder in ("src", "tests", "tools", "docs") for path in (ROOT / folder).rglob("*.py"))
SCRIPTS = sorted((ROOT / "src").rglob("*.js"))

_SECTION = "a section of a document: each claim's formula, check and text are one thought"

LONG_FILES: dict[str, str] = {
    "src/nao_kin/robot/robot.py": "what users hold: every question that a robot answers",
    "src/nao_kin/analytic/certifying.py": "one pass over what closed forms wrote: placed, measured, kept once",
    "src/nao_kin/analytic/hexapod/body.py": "one pose of the body, or many, by the same steps",
    "src/nao_kin/analytic/nao/nao_arm_kernel.py": "one compiled solver: pose, position and pointing share its joints",
    "src/nao_kin/analytic/nao/nao_leg.py": "a closed form: how its geometry is recognised, and its solver",
    "src/nao_kin/analytic/six_r/six_r_bent_wrist.py": "a closed form: one equation, its loops and its solver",
    "src/nao_kin/bench/bench_closed.py": "a question with its cases",
    "src/nao_kin/bench/bench_explain.py": "a question with its planted errors",
    "src/nao_kin/bench/bench_sixr.py": "a question with its strata and its peers",
    "src/nao_kin/calibration/measurements.py": "the kinds of rows side by side, each with its derivatives",
    "src/nao_kin/chain.py": "what any chain is, and the free functions on any of them",
    "src/nao_kin/cli/check_command.py": "a command with what it is held against, and its repairs",
    "src/nao_kin/cli/trajectory_command.py": "three commands on one kind of file",
    "src/nao_kin/crosscheck/explanation.py": "what an explanation says, down to where no usual error explains",
    "src/nao_kin/crosscheck/search.py": "the search, and the lengths it reads off",
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
    "src/nao_kin/ik/compiled_loop.py": "one loop, to be read from top to bottom without leaving the file",
    "src/nao_kin/ik/tips/tree_solver.py": "the loop of several tips, and the call that runs it",
    "src/nao_kin/motion/nao/feet.py": "both feet that stay, and the torso that moves over them",
    "src/nao_kin/trajectory/files/reading.py": "one format in three spellings: what they share is read beside them",
    "src/nao_kin/trajectory/following.py": "a path followed, between its samples and in time",
}
SHORT_FILES: dict[str, str] = {
    "src/nao_kin/checks/digits.py": "a question that rules on twins and on limits ask",
    "src/nao_kin/cli/diff_command.py": "a command",
    "src/nao_kin/urdf/quaternion.py": "one conversion, without Pinocchio",
    "src/nao_kin/__main__.py": "what Python calls it",
    "src/nao_kin/analytic/ranges.py": "a rule that four closed forms share",
    "src/nao_kin/checks/catalogue/entry.py": "the row that every list of codes imports",
    "src/nao_kin/checks/rules/tree_rules.py": "a room of rules keeps one file a thought",
    "src/nao_kin/lazy.py": "below everything, so that packages stay light",
    "src/nao_kin/motion/loop/profile.py": "a formula that four motions share",
    "src/nao_kin/progress.py": "below everything that takes long",
    "src/nao_kin/urdf/mesh_errors.py": "errors that readers and rules share",
}
LONG_FUNCTIONS: dict[str, str] = {}
"""By path, or by path and name: why it is as long, or as short, as it is."""


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
    modules = {name for name in lines if name.startswith("src/") and not name.endswith(("__init__.py", ".js"))}
    assert {name for name in modules if lines[name] < SHORTEST_FILE} == SHORT_FILES.keys()
