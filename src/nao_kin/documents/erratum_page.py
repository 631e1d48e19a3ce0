"""The ledger as one HTML page that needs no network and no script; formulas are MathML."""

from __future__ import annotations

import html
import re
from typing import TYPE_CHECKING, Final

from latex2mathml.converter import convert

from nao_kin.documents.claim import DOCUMENTS, Verdict
from nao_kin.documents.erratum import entries

if TYPE_CHECKING:
    from collections.abc import Iterable

    from nao_kin.documents.claim import Judgement
    from nao_kin.documents.judging import Ledger

__all__ = ["as_html"]

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
