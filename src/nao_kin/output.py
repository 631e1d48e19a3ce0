"""What every command prints with: reports on standard output, everything else on standard error."""

from __future__ import annotations

import json
import os
import sys
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.progress import progress

if TYPE_CHECKING:
    from nao_kin.table import Table

__all__ = [
    "FormatOption",
    "OutputFormat",
    "number",
    "progress",
    "report",
    "report_json",
    "rows_of_numbers",
    "wants_colour",
]


class OutputFormat(StrEnum):
    """How a command prints."""

    text = "text"
    json = "json"


FormatOption = Annotated[OutputFormat, typer.Option("--format", help="How to print.")]


def report(*parts: Table | str) -> None:
    """Prints tables and lines on standard output, coloured on a terminal unless NO_COLOR is set."""
    from rich.console import Console
    from rich.text import Text

    # rich keeps bold and dim under NO_COLOR; people set it for plain text.
    console = Console(highlight=False, color_system=None if os.environ.get("NO_COLOR") else "auto")
    console.width = max(console.width, 80)  # a narrower terminal folds lines; rich would cut digits off
    for part in parts:
        console.print(Text(part) if isinstance(part, str) else part)


def wants_colour() -> bool:
    """Whether standard output takes colours: a terminal that can, or FORCE_COLOR; never with NO_COLOR."""
    if os.environ.get("NO_COLOR"):
        return False
    return bool(os.environ.get("FORCE_COLOR")) or (sys.stdout.isatty() and os.environ.get("TERM") != "dumb")


def report_json(data: Any) -> None:
    """Prints JSON on standard output; numbers that JSON has no word for become null."""
    typer.echo(json.dumps(_plain(data), indent=2, allow_nan=False, ensure_ascii=False))


def rows_of_numbers(matrix: Any, indent: str = "  ") -> str:
    """A matrix as lines of numbers, six decimals, rounding's −0 shown as 0."""
    return "\n".join(indent + " ".join(f"{number(x, 6):>10}" for x in row) for row in matrix)


def number(value: float, decimals: int) -> str:
    """A number with that many decimals; rounding's −0 is 0."""
    return f"{round(float(value), decimals) + 0.0:.{decimals}f}"


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_plain(value) for value in data]
    if hasattr(data, "tolist"):
        return _plain(data.tolist())
    if isinstance(data, float) and (data != data or data in (float("inf"), float("-inf"))):
        return None
    return data
