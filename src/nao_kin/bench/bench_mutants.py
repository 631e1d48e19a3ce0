"""`nao-kin bench mutants`: whether the ledger's checks notice a wrong sign, operator or number in a printed form."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from nao_kin.documents.mutants import Trial

__all__ = ["mutants"]

_ENOUGH = 95.0  # [%]


def mutants(
    document: Annotated[str | None, typer.Option(help="Only this document: 000, 001, 002 or 004.")] = None,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Spoil every printed form that holds, one sign, operator or number at a time; its check has to notice."""
    from nao_kin.documents.claim import DOCUMENTS

    machine = Machine()
    trials = _trials(document)
    rows = [
        _row(DOCUMENTS[number], [trial for trial in trials if trial.mutant.claim.document == number])
        for number in DOCUMENTS
        if document in (None, number)
    ]
    everything = _row("all", trials)
    survivors = [trial for trial in trials if not trial.caught]
    sheets = [
        Sheet("mutants", "spoilt copies of the printed forms that hold", _HEADINGS, [*rows, everything]),
        Sheet("survivors", "copies that no check notices", _SURVIVORS, [_survivor(trial) for trial in survivors]),
    ]
    unexcused = sum(not trial.excuse for trial in survivors)
    bounds = [
        Promise("spoilt copies whose verdict is fails, %", everything["share"], _ENOUGH),
        Promise("copies that survive without a reason", float(unexcused), 0.0, at_least=False),
    ]
    conclude(machine, sheets, bounds, [], format, goals)


_HEADINGS = (
    Heading("document", "document"),
    Heading("claims", "claims", "d"),
    Heading("copies", "copies", "d"),
    Heading("caught", "fails", "d"),
    Heading("share", "%", ".1f"),
)
_SURVIVORS = (
    Heading("claim", "claim"),
    Heading("change", "line:column, change"),
    Heading("reason", "equivalent since"),
)


def _trials(document: str | None) -> list[Trial]:
    from nao_kin.documents.judging import claims
    from nao_kin.documents.mutants import trials_of
    from nao_kin.output import progress

    every = claims(document=document)
    return [trial for claim in progress(every, "claims", len(every)) for trial in trials_of(claim)]


def _row(name: str, trials: list[Trial]) -> dict[str, Any]:
    caught = sum(trial.caught for trial in trials)
    return {
        "document": name,
        "claims": len({trial.mutant.claim.id for trial in trials}),
        "copies": len(trials),
        "caught": caught,
        "share": 100.0 * caught / max(1, len(trials)),
    }


def _survivor(trial: Trial) -> dict[str, Any]:
    return {
        "claim": trial.mutant.claim.id,
        "change": trial.mutant.change,
        "reason": trial.excuse or "NONE",
    }
