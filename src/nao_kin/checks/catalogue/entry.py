"""What is said about one code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nao_kin.checks.finding import Severity

__all__ = ["Entry"]


@dataclass(frozen=True, slots=True)
class Entry:
    """The explanation of one code.

    Attributes:
        code: The permanent name.
        severity: How bad a finding of it is.
        what: What is wrong, one sentence.
        why: Why it matters.
        bad: A fragment that has it.
        good: The same without it.
        fix: How to fix it.
    """

    code: str
    severity: Severity
    what: str
    why: str
    bad: str
    good: str
    fix: str
