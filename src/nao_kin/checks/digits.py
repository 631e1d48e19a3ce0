"""Figures that are nearly the same, as typing slips leave them."""

from __future__ import annotations

__all__ = ["swapped_digits"]


def swapped_digits(a: float, b: float) -> bool:
    """Whether two figures differ in the order of two neighbouring digits, whatever their signs."""
    x, y = f"{abs(a):.8f}", f"{abs(b):.8f}"
    if len(x) != len(y):
        return False
    apart = [i for i, (p, q) in enumerate(zip(x, y, strict=True)) if p != q]
    return len(apart) == 2 and apart[1] == apart[0] + 1 and x[apart[0]] == y[apart[1]] and x[apart[1]] == y[apart[0]]
