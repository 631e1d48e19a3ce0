"""The ledger as text of 80 columns, as markdown, and as one HTML page: an erratum sheet, grouped by document."""

from __future__ import annotations

import html
import re
import textwrap
from typing import TYPE_CHECKING, Final

from latex2mathml.converter import convert

from nao_kin.documents.claim import DOCUMENTS, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.documents.claim import Judgement, Measured
    from nao_kin.documents.judging import Ledger

__all__ = ["as_html", "as_markdown", "as_text", "entries", "quantity", "residual"]

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


_POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"

_STYLE: Final = """
:root { color-scheme: light dark; --line: #8884; --faint: #777; --bad: #b3261e; --good: #1b6e3c; }
@media (prefers-color-scheme: dark) { :root { --bad: #f2877f; --good: #7fd6a0; --faint: #aaa; } }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
article { border-top: 1px solid var(--line); padding: .75rem 0; }
article h3 { font-size: 1rem; margin: 0; } article h3 .place { font-weight: normal; color: var(--faint); }
dl { display: grid; grid-template-columns: 7rem 1fr; gap: .25rem 1rem; margin: .5rem 0 0; }
dt { color: var(--faint); } dd { margin: 0; overflow: auto hidden; }
pre { margin: 0; white-space: pre-wrap; font: .9rem/1.4 ui-monospace, monospace; }
math { font-size: 1.1rem; } code { font: .9rem ui-monospace, monospace; }
.fails { color: var(--bad); } .not-checkable { color: var(--faint); }
.holds, .holds-under-convention { color: var(--good); }
nav a { margin-right: 1rem; }
""".replace("\n", "\n    ")


def as_html(found: Ledger) -> str:
    """The page, complete; the same verdicts and figures give the same text."""
    present = [number for number in DOCUMENTS if any(each.claim.document == number for each in found)]
    links = "".join(f'<a href="#d{number}">{html.escape(DOCUMENTS[number])}</a>' for number in present)
    sections = "\n".join(_section(number, [j for j in found if j.claim.document == number]) for number in present)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
  <meta charset="utf-8">
  <meta http-equiv="Content-Security-Policy" content="{html.escape(_POLICY)}">
  <meta name="viewport" content="width=device-width, initial-scale=1">
  <title>Ledger</title>
  <style>{_STYLE}</style>
</head>
<body>
<h1>Ledger</h1>
<p>{html.escape(found.summary)}</p>
<nav>{links}</nav>
{sections}
</body>
</html>"""


def _section(number: str, judgements: Iterable[Judgement]) -> str:
    articles = "\n".join(_article(judgement) for judgement in judgements)
    return f'<section id="d{number}">\n<h2>{html.escape(DOCUMENTS[number])}</h2>\n{articles}\n</section>'


def _article(judgement: Judgement) -> str:
    claim, verdict = judgement.claim, str(judgement.verdict)
    rows = [
        *((label, _text(label, text, judgement)) for label, text in entries(judgement)),
        ("held against", html.escape(claim.reference)),
        ("domain", html.escape(claim.domain)),
        ("again", f"<code>{html.escape(claim.command)}</code>"),
    ]
    items = "".join(f"<dt>{label}</dt><dd>{text}</dd>" for label, text in rows)
    return (
        f'<article id="{html.escape(claim.id)}"><h3>{html.escape(claim.id)} '
        f'<span class="place">{html.escape(claim.place)}</span> <span class="{verdict}">{verdict}</span></h3>'
        f"<dl>{items}</dl></article>"
    )


_WORD: Final = re.compile(r"(?<!\\mathrm\{)(?<![\\\w])[A-Z][a-z]+[A-Z]\w*")
"""A name such as CameraX, which would otherwise be set as the product of its letters."""


def _text(label: str, text: str, judgement: Judgement) -> str:
    """A text, or a formula as MathML where it has LaTeX."""
    correction = judgement.claim.correction if judgement.verdict is Verdict.fails else None
    latex = {"printed": judgement.claim.latex, "corrected": correction.latex if correction else ""}.get(label, "")
    if latex:
        return str(convert(_WORD.sub(r"\\mathrm{\g<0>}", latex), display="block"))
    if label in ("printed", "corrected") or "\n" in text:
        return f"<pre>{html.escape(text)}</pre>"
    return html.escape(text)
