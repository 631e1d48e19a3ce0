"""Findings for people: the line, a caret under the place, what to do; nothing wider than a terminal if it can wrap."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from nao_kin.checks.finding import Severity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.checks.finding import Finding, Report

__all__ = ["as_text"]

_WIDTH: Final = 80
_STYLES: Final[dict[str, str]] = {
    Severity.error: "1;31",
    Severity.warning: "1;33",
    Severity.note: "1;36",
    "bold": "1",
    "faint": "2",
}


def as_text(report: Report, *, colour: bool = False) -> str:
    """All findings and a line that counts them, without a final line break.

    Args:
        report: The findings.
        colour: Whether to use terminal colours; they never carry meaning alone.
    """
    paint = _paint if colour else _plain
    blocks = ["\n".join(_block(finding, paint)) for finding in report.findings]
    more = [f"More findings of {code} in {_printable(path)} than are listed." for path, code in report.incomplete]
    worst = min(report.findings, key=lambda finding: finding.severity.rank, default=None)
    example = [f"What a code means: nao-kin explain {worst.code}"] if worst else []
    tail = [*more, *example, report.summary()]
    return "\n\n".join([*blocks, "\n".join(tail)])


def _block(finding: Finding, paint: Callable[[str, str], str]) -> Iterator[str]:
    head = f"{finding.severity}[{finding.code}]: "
    first, *rest = textwrap.wrap(head + _printable(finding.message), _WIDTH, subsequent_indent="  ")
    yield paint(finding.severity, head.rstrip()) + paint("bold", first[len(head.rstrip()) :])
    for line in rest:
        yield paint("bold", line)
    gutter = " " * len(str(finding.line or ""))
    yield f"{gutter}{paint('faint', '-->')} {_printable(finding.place)}"
    if finding.line and finding.source.strip():
        source, column = _window(_printable(finding.source), finding.column, _WIDTH - len(gutter) - 3)
        bar = paint("faint", "|")
        yield f"{gutter} {bar}"
        yield f"{paint('faint', str(finding.line))} {bar} {source}".rstrip()
        if column:
            width = max(1, min(finding.width, len(source) - column + 1))
            yield f"{gutter} {bar} {' ' * (column - 1)}{paint(finding.severity, '^' * width)}"
    if finding.hint:
        for line in textwrap.wrap(
            f"hint: {_printable(finding.hint)}",
            _WIDTH,
            initial_indent=f"{gutter} = ",
            subsequent_indent=f"{gutter}   ",
            break_long_words=False,
        ):
            yield line


def _window(source: str, column: int, width: int) -> tuple[str, int]:
    """As much of a line around a column as fits, and where the column is in it."""
    indent = len(source) - len(source.lstrip())
    source, column = source[indent:], max(column - indent, 0)
    if len(source) <= width:
        return source, column
    start = 0 if column < width * 3 // 4 else min(column - width // 2, len(source) - width)
    end = start + width
    cut = ("…" if start else "") + source[start + bool(start) : end - (end < len(source))]
    return cut + ("…" if end < len(source) else ""), column - start if column else 0


def _printable(text: str) -> str:
    """The text with one character for each, none of which can take over a terminal."""
    return "".join(c if c.isprintable() else " " if c.isspace() else "�" for c in text)


def _paint(style: str, text: str) -> str:
    return f"\x1b[{_STYLES[style]}m{text}\x1b[0m"


def _plain(style: str, text: str) -> str:  # noqa: ARG001
    return text
