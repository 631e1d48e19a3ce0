"""`nao-kin explain`: what a code of `nao-kin check` means."""

from __future__ import annotations

import textwrap
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.checks.catalogue import Entry

__all__ = ["explain"]


def explain(
    code: Annotated[str | None, typer.Argument(help="A code, as zero-axis; without one, all are listed.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Say what a code of nao-kin check means, why it matters, and how to fix it."""
    from nao_kin.checks.catalogue import CATALOGUE, require_codes

    if code is not None:
        require_codes([code])
    entries = list(CATALOGUE.values()) if code is None else [CATALOGUE[code]]
    if format is OutputFormat.json:
        report_json([asdict(entry) for entry in entries])
    elif code is None:
        from nao_kin.table import Column, Table

        rows = tuple((entry.code, entry.severity.value, entry.what) for entry in entries)
        report(Table((Column("code"), Column("severity"), Column("what")), rows))
    else:
        typer.echo(_text(entries[0]))


def _text(entry: Entry) -> str:
    paragraphs = [
        f"{entry.code} ({entry.severity}): {entry.what}",
        f"Why it matters: {entry.why}",
        f"How to fix it: {entry.fix}",
    ]
    head, why, fix = ("\n".join(textwrap.wrap(text, 80)) for text in paragraphs)
    wrong, right = (textwrap.indent(text, "    ") for text in (entry.bad, entry.good))
    fragments = [f"Wrong:\n{wrong}"] if entry.bad else []
    return "\n\n".join([head, why, *fragments, f"Right:\n{right}", fix])
