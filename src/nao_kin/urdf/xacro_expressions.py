"""Which expressions of xacro are evaluated: arithmetic, text, lists and look-ups.

xacro hands ``${...}`` and ``$(eval ...)`` to Python's `eval` without builtins. That keeps out names, but not
attributes: from any value a path of attributes leads to every class and module. Here the expression's syntax tree is
looked at before it is evaluated.
"""

from __future__ import annotations

import ast

__all__ = ["RefusedExpressionError", "check_expression"]

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
