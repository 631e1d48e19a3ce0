"""`nao-kin ledger`: every printed statement of the source documents, run and judged."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from nao_kin.output import progress, report_json

if TYPE_CHECKING:
    from nao_kin.documents.judging import Ledger

__all__ = ["ledger"]


class LedgerFormat(StrEnum):
    """How the ledger is printed."""

    text = "text"
    json = "json"
    markdown = "markdown"
    html = "html"


def ledger(
    claim: Annotated[str | None, typer.Argument(help="One claim, as 000:3.3.0.2; it is shown whole.")] = None,
    document: Annotated[str | None, typer.Option(help="Only this document: 000, 001, 002 or 004.")] = None,
    failing: Annotated[bool, typer.Option("--failing", help="Only what fails as printed.")] = False,
    format: Annotated[LedgerFormat, typer.Option("--format", help="How to print.")] = LedgerFormat.text,
) -> None:
    """Run every printed formula of the four documents and judge it; exit status 1 if one fails."""
    from nao_kin.documents.claim import Verdict, judged
    from nao_kin.documents.judging import Ledger, claims

    wanted = claims(claim, document=document)
    found = Ledger(tuple(judged(each) for each in progress(wanted, "claims", len(wanted))))
    failed = Ledger(tuple(each for each in found if each.verdict is Verdict.fails))
    _print(failed if failing else found, format)
    if len(failed):
        raise typer.Exit(1)


def _print(found: Ledger, format: LedgerFormat) -> None:
    if format is LedgerFormat.json:
        report_json(found.rows())
    elif format is LedgerFormat.html:
        from nao_kin.documents.erratum import as_html

        typer.echo(as_html(found))
    else:
        from nao_kin.documents.erratum import as_markdown, as_text

        typer.echo(as_text(found) if format is LedgerFormat.text else as_markdown(found))
