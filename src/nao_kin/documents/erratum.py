"""The ledger as text of 80 columns and as markdown: an erratum sheet, grouped by document."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from nao_kin.documents.claim import DOCUMENTS, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.documents.claim import Judgement, Measured
    from nao_kin.documents.judging import Ledger

__all__ = ["as_markdown", "as_text", "entries", "quantity", "residual"]

_WIDTH: Final = 80
_LABEL: Final = 12


def as_text(found: Ledger) -> str:
    """The sheet; a single claim is shown whole, of many those that hold are only named."""
    if not len(found):
        return "Nothing fails as printed."
    if len(found) == 1:
        return "\n".join(_whole(found.judgements[0]))
    lines = _wrapped(found.summary)
    for number, judgements in _by_document(found):
        heading = f"{number}  {DOCUMENTS[number]}"
        lines += ["", heading, "=" * len(heading)]
        lines += _held(judgements) + _conventional(judgements) + _failed(judgements) + _not_checkable(judgements)
    lines += ["", "Any of them whole, measured again: nao-kin ledger CLAIM"]
    return "\n".join(lines)


def as_markdown(found: Ledger) -> str:
    """The same as headings, tables and quoted formulas."""
    lines = ["# Ledger", "", found.summary]
    for number, judgements in _by_document(found):
        lines += ["", f"## {DOCUMENTS[number]} ({number})"]
        lines += ["", "| claim | verdict | residual | samples | holds if |", "|---|---|---|---|---|"]
        lines += [_markdown_row(judgement) for judgement in judgements]
        for judgement in _of(judgements, Verdict.fails):
            lines += ["", f"### {judgement.claim.id}, {judgement.claim.place}", ""]
            lines += [*_markdown_entry(judgement)]
    return "\n".join(lines)


def quantity(value: float, unit: str) -> str:
    """A number with its unit."""
    return f"{value:.3g}" if unit == "1" else f"{value:.3g} {unit}"


def residual(measured: Measured, unit: str) -> str:
    """The largest deviation, on how much, and where."""
    text = quantity(measured.residual, unit)
    text += f", the largest of {measured.samples}" if measured.samples > 1 else ""
    return text + (f", at {measured.where}" if measured.where else "")


def entries(judgement: Judgement) -> Iterator[tuple[str, str]]:
    """Everything that is to be said of a claim, as labels and texts; texts may have several lines."""
    claim, measured, corrected = judgement.claim, judgement.measured, judgement.corrected
    yield "says", claim.said
    yield "printed", claim.formula
    if measured is not None:
        if judgement.as_it_stands is not None:
            yield "as it stands", residual(judgement.as_it_stands, claim.unit)
            yield from _found(judgement.as_it_stands)
            yield "holds if", judgement.convention
        yield "residual", residual(measured, claim.unit)
        yield from _found(measured)
    if judgement.verdict is Verdict.fails:
        if claim.correction is not None and corrected is not None:
            yield "corrected", claim.correction.formula
            yield "residual", f"{quantity(corrected.residual, claim.unit)}, the largest of {corrected.samples}"
        yield "why", judgement.reason
    if judgement.verdict is Verdict.not_checkable:
        yield "why not", judgement.reason


def _found(measured: Measured) -> Iterator[tuple[str, str]]:
    if measured.found:
        yield "measured", measured.found


def _whole(judgement: Judgement) -> list[str]:
    claim = judgement.claim
    lines = _wrapped(f"{claim.id}  {DOCUMENTS[claim.document]}, {claim.place}: {judgement.verdict.replace('-', ' ')}")
    for label, text in entries(judgement):
        lines += _labelled(label, text)
    lines += _labelled("held against", claim.reference) + _labelled("domain", claim.domain)
    if judgement.corrected is not None and judgement.corrected.found:
        lines += _labelled("then", judgement.corrected.found)
    return [*lines, *_labelled("again", claim.command)]


def _by_document(found: Iterable[Judgement]) -> Iterator[tuple[str, list[Judgement]]]:
    judgements = list(found)
    for number in DOCUMENTS:
        these = [judgement for judgement in judgements if judgement.claim.document == number]
        if these:
            yield number, these


def _of(judgements: list[Judgement], verdict: Verdict) -> list[Judgement]:
    return [judgement for judgement in judgements if judgement.verdict is verdict]


def _held(judgements: list[Judgement]) -> list[str]:
    names = [judgement.claim.id.partition(":")[2] for judgement in _of(judgements, Verdict.holds)]
    return ["", f"Hold as printed ({len(names)})", *_wrapped(", ".join(names), "  ")] if names else []


def _conventional(judgements: list[Judgement]) -> list[str]:
    these = _of(judgements, Verdict.holds_under_convention)
    lines = ["", f"Hold under a convention ({len(these)})"] if these else []
    for judgement in these:
        assert judgement.measured is not None  # noqa: S101 (what holds was measured)
        assert judgement.as_it_stands is not None  # noqa: S101
        unit = judgement.claim.unit
        otherwise = quantity(judgement.as_it_stands.residual, unit)
        lines += _wrapped(f"{judgement.claim.id}, if {judgement.convention}", "  ", "      ")
        lines += _wrapped(f"residual {quantity(judgement.measured.residual, unit)}, otherwise {otherwise}", "      ")
    return lines


def _failed(judgements: list[Judgement]) -> list[str]:
    these = _of(judgements, Verdict.fails)
    lines = ["", f"Fail ({len(these)})"] if these else []
    for judgement in these:
        lines += ["", *_wrapped(f"{judgement.claim.id}, {judgement.claim.place}", "  ")]
        for label, text in entries(judgement):
            lines += _labelled(label, text, "    ")
    return lines


def _not_checkable(judgements: list[Judgement]) -> list[str]:
    these = _of(judgements, Verdict.not_checkable)
    lines = ["", f"Cannot be checked ({len(these)})"] if these else []
    for judgement in these:
        lines += _wrapped(f"{judgement.claim.id}: {judgement.reason}", "  ", "      ")
    return lines


def _labelled(label: str, text: str, indent: str = "  ") -> list[str]:
    """Lines of text beside a label; each line of the text is folded by itself, so that tables keep their columns."""
    margin = indent + " " * (_LABEL + 1)
    lines = [piece for line in text.split("\n") for piece in _wrapped(line, margin, margin)]
    return [f"{indent}{label:<{_LABEL}} {lines[0][len(margin) :]}", *lines[1:]]


def _wrapped(text: str, indent: str = "", later: str | None = None) -> list[str]:
    later = indent if later is None else later
    leading = " " * (len(text) - len(text.lstrip(" ")))
    return textwrap.wrap(
        text.strip(" "),
        _WIDTH,
        initial_indent=indent + leading,
        subsequent_indent=later + leading,
        break_on_hyphens=False,
    ) or [indent]


def _markdown_row(judgement: Judgement) -> str:
    claim, measured = judgement.claim, judgement.measured
    figure = "" if measured is None else quantity(measured.residual, claim.unit)
    correction = claim.correction if judgement.verdict is Verdict.fails else None
    remedy = judgement.convention or ("as corrected below" if correction is not None else judgement.reason)
    cells = (claim.id, str(judgement.verdict), figure, str(measured.samples) if measured else "", remedy)
    return f"| {' | '.join(_cell(cell) for cell in cells)} |"


def _markdown_entry(judgement: Judgement) -> Iterator[str]:
    for label, text in entries(judgement):
        if label in ("printed", "corrected") or "\n" in text:
            yield from (f"{label.capitalize()}:", "", "```text", *text.split("\n"), "```", "")
        else:
            yield from (f"{label.capitalize()}: {text}", "")


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
