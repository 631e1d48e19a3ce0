"""Deliberately spoilt copies of printed forms: whether the ledger's checks notice.

A check that accepts a formula with a wrong sign would accept a misprint too. So each sign and operator of a printed
form that holds is flipped, each of its numbers is changed by 1 %, one at a time, and the copy is judged like the
original.
"""

from __future__ import annotations

import ast
import functools
import inspect
import itertools
import textwrap
import threading
from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass
from signal import ITIMER_REAL, SIGALRM, setitimer, signal
from typing import TYPE_CHECKING, Any, Final

from nao_kin.documents.claim import Verdict, judged

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.documents.claim import Claim, Form

__all__ = ["EQUIVALENT", "Mutant", "Trial", "mutants", "trials_of", "tried"]

_PATIENCE: Final = 20.0  # [s] a copy that runs longer than this has lost the end of its loop, and fails by that

_OPERATORS: Final[dict[type[ast.AST], type[ast.AST]]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}

_COUNTED: Final = ("range", "eye", "zeros", "ones")

_BETWEEN: Final = "any bound between rounding and the distance of two solutions tells the same rows apart"

_EVEN: Final = "a cosine or a square, which has no sign of its argument"

EQUIVALENT: Final[dict[tuple[str, str], str]] = {
    (
        "000:2.2.2.5",
        "factors swapped in eq_2_2_2_1(d) @ eq_2_2_2_2(t)",
    ): "a rotation about z and a shift along it commute",
    (
        "000:3.1.0.1",
        "factors swapped in T_basis @ A[0] @ A[1] @ A[2] @ A[3] @ A[4]",
    ): "A_4^5, which the table lacks, is the unit matrix",
    ("000:3.3.0.6", "− → + in -t_3"): _EVEN,
    ("000:3.3.0.6", "− → + in -t_3 #2"): _EVEN,
    ("000:3.3.0.6", "Sub → Add in t_2 - pi / 2 #2"): _EVEN,
    ("000:3.3.0.6", "− → + in -t_3 #5"): _EVEN,
    ("000:3.3.0.6", "− → + in -t_3 #4"): _EVEN,
    ("000:3.3.0.7", "Mult → Div in cos(t_2 - pi / 2) * sin(-t_3)"): "the sine is ±1 where the formula is meant",
    ("000:3.3.0.9", "− → + in -pi"): "half a turn is the same both ways",
    (
        "000:3.3.0.11",
        "Sub → Add in -A[1, 3] - l_1 - l_4 * sin(t_4) * A[1, 1] / cos(t_4)",
    ): "this copy is the correction",
    ("000:3.3.0.14", "Add → Sub in t_2 + pi / 2 #2"): _EVEN,
    ("000:3.3.0.15", "Mult → Div in cos(t_2 + pi / 2) * sin(t_3)"): "the sine is ±1 where the formula is meant",
    ("001:task-1b", "0.41 → 0.4141"): "rounds to the two decimals that are printed",
    (
        "004:head-chain",
        "factors swapped in a_base_0(NeckOffsetZ) @ t_01(theta_1)",
    ): "a rotation about z and a shift along it commute",
    ("004:theta_1-row-6", "0 → 0.01"): "where the row stands every yaw is a solution",
    ("004:4-two-solutions", "Mult → Div in 1e-06 * abs(y_known)"): _BETWEEN,
    ("004:4-two-solutions", "100 → 101"): _BETWEEN,
    ("004:4-two-solutions", "2.2e-16 → 2.222e-16"): _BETWEEN,
    ("004:4-two-solutions", "1e-06 → 1.01e-06"): _BETWEEN,
}
"""Why a copy that survives is no misprint: by claim and change."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A spoilt copy of a printed form.

    Attributes:
        claim: Whose form it is.
        change: What was changed and in what, for example ``"Add → Sub in a + b"``; with a number behind it where a form
            has the same again, in the order of its syntax tree.
        form: The copy.
    """

    claim: Claim
    change: str
    form: Form


@dataclass(frozen=True, slots=True)
class Trial:
    """A spoilt copy with what became of it.

    Attributes:
        mutant: The copy.
        caught: Whether its verdict is that it fails.
        how: Its verdict.
    """

    mutant: Mutant
    caught: bool
    how: str

    @property
    def excuse(self) -> str:
        """Why it need not be caught; empty for one that is a hole in the check."""
        return EQUIVALENT.get((self.mutant.claim.id, self.mutant.change), "")


def mutants(claim: Claim) -> Iterator[Mutant]:
    """Every spoilt copy of a claim's printed form."""
    source = textwrap.dedent(inspect.getsource(claim.printed))
    counts = Counter[str]()
    for number in range(len(list(_changes(ast.parse(source))))):
        tree = ast.parse(source)
        change = next(itertools.islice(_changes(tree), number, None))()
        counts[change] += 1
        again = f" #{counts[change]}" if counts[change] > 1 else ""
        yield Mutant(claim, change + again, _compiled(tree, claim.printed))


def trials_of(claim: Claim) -> tuple[Trial, ...]:
    """Every spoilt copy of a claim that holds, with or without a convention, judged; none of one that fails."""
    copies = tuple(mutants(claim))
    if not copies or judged(claim).verdict not in (Verdict.holds, Verdict.holds_under_convention):
        return ()
    return tuple(tried(copy) for copy in copies)


def tried(mutant: Mutant) -> Trial:
    """Judges a spoilt copy as if it were printed.

    Raises:
        Exception: Whatever the claim's check itself raises: then it is no verdict on the copy.
    """
    with _time_limit():
        verdict = judged(mutant.claim, mutant.form).verdict
    return Trial(mutant, verdict is Verdict.fails, str(verdict))


def _compiled(tree: ast.Module, original: Form) -> Form:
    """The function of a changed tree, with the globals that the original sees."""
    function = tree.body[0]
    assert isinstance(function, ast.FunctionDef)  # noqa: S101 (printed forms are functions of a module)
    namespace = dict(original.__globals__)
    exec(compile(ast.fix_missing_locations(tree), f"<{function.name}, spoilt>", "exec"), namespace)  # noqa: S102
    form: Form = namespace[function.name]
    return form


def _changes(tree: ast.Module) -> Iterator[Callable[[], str]]:
    """What can be changed in a form: functions that do it and say what they did, always in the same order."""
    names = _names(tree)
    for node in ast.walk(tree):
        if isinstance(node, (ast.BinOp, ast.AugAssign, ast.BoolOp)) and type(node.op) in _OPERATORS:
            yield functools.partial(_flip, node)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield functools.partial(_swap, node)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield functools.partial(_drop_sign, node)
        elif isinstance(node, ast.Compare):
            yield from (functools.partial(_negate, node, k) for k, op in enumerate(node.ops) if type(op) in _OPERATORS)
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float) and id(node) not in names:
            yield functools.partial(_stretch, node)


def _names(tree: ast.Module) -> set[int]:
    """Numbers that only say which or how many: indices, sizes of ranges and arrays, and what annotations contain."""
    parts: list[ast.AST | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript):
            parts.append(node.slice)
        elif isinstance(node, (ast.arg, ast.AnnAssign)):
            parts.append(node.annotation)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in _COUNTED:
            parts += node.args
    return {id(inner) for part in parts if part is not None for inner in ast.walk(part)}


def _flip(node: Any) -> str:
    before, code = type(node.op), ast.unparse(node)
    node.op = _OPERATORS[before]()
    return f"{before.__name__} → {type(node.op).__name__} in {code}"


def _swap(node: ast.BinOp) -> str:
    code = ast.unparse(node)
    node.left, node.right = node.right, node.left
    return f"factors swapped in {code}"


def _drop_sign(node: ast.UnaryOp) -> str:
    code = ast.unparse(node)
    node.op = ast.UAdd()
    return f"− → + in {code}"


def _negate(node: Any, k: int) -> str:
    before, code = type(node.ops[k]), ast.unparse(node)
    node.ops[k] = _OPERATORS[before]()
    return f"{before.__name__} → {type(node.ops[k]).__name__} in {code}"


def _stretch(node: Any) -> str:
    before, node.value = node.value, node.value * 1.01 or 0.01  # nought has no 1 % of itself
    return f"{before:g} → {node.value:g}"


@contextmanager
def _time_limit() -> Iterator[None]:
    """Raises TimeoutError where a form runs for too long; only the main thread can be interrupted."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def give_up(*_: object) -> None:
        raise TimeoutError

    before = signal(SIGALRM, give_up)
    setitimer(ITIMER_REAL, _PATIENCE)
    try:
        yield
    finally:
        setitimer(ITIMER_REAL, 0.0)
        signal(SIGALRM, before)
