"""What the ledger is made of: a printed statement of a document as code, and the verdict that running it gives.

A claim carries the form *as printed* and a check that takes a form, puts it on sampled data with every other quantity
exact, and measures how far it is from the reference. So the same check judges the printed form, its correction, and any
deliberately spoilt copy of it. No verdict is written down anywhere; `judged` computes it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["DOCUMENTS", "EXACT", "Check", "Claim", "Correction", "Form", "Judgement", "Measured", "Verdict", "judged"]

Form: TypeAlias = Callable[..., Any]
"""A printed statement as code: an equation, a table, a number, an algorithm."""

DOCUMENTS: Final = {
    "000": "Bischoff 2016",
    "001": "practicum",
    "002": "hexapod article",
    "004": "MATLAB example",
}
"""How the documents are cited, by the number that begins a claim's name."""

EXACT: Final = 1e-9
"""Largest residual of what holds exactly, relative to the size of the quantity: rounding of a few hundred operations in
double precision is far below, the smallest error that a printed form can have is far above."""


class Verdict(StrEnum):
    """What running a claim says of it."""

    holds = "holds"
    holds_under_convention = "holds-under-convention"
    fails = "fails"
    not_checkable = "not-checkable"


@dataclass(frozen=True, slots=True)
class Measured:
    """How far a form is from its reference.

    Attributes:
        residual: The largest deviation, in the claim's unit; infinite where the form has no value at all.
        samples: How many cases it was measured on.
        where: The case with the largest deviation, in words.
        found: Figures that a reader can compare with the document; may have several lines.
    """

    residual: float
    samples: int
    where: str = ""
    found: str = ""

    @classmethod
    def worst(cls, deviations: Iterable[float], where: Callable[[int], str] | None = None, found: str = "") -> Measured:
        """The largest of some deviations; one that is not a number counts as infinite.

        Args:
            deviations: One number a case, signed or not.
            where: Describes a case by its index.
            found: Figures to show with it.
        """
        sizes = [math.inf if math.isnan(size) else abs(size) for size in map(float, deviations)]
        worst = max(range(len(sizes)), key=sizes.__getitem__)
        return cls(sizes[worst], len(sizes), where(worst) if where is not None else "", found)


Check: TypeAlias = Callable[[Form], Measured]
"""Runs any form that takes the printed one's arguments; fixed seed, every other quantity exact."""


@dataclass(frozen=True, slots=True)
class Correction:
    """What a printed form should have been.

    Attributes:
        form: As code.
        formula: As plain text.
        latex: As LaTeX, for the page.
        why: What was wrong, one sentence.
        check: How it is checked, where it takes other arguments than the printed form; otherwise by the claim's own.
    """

    form: Form
    formula: str
    latex: str = ""
    why: str = ""
    check: Check | None = None


@dataclass(frozen=True, slots=True)
class Claim:
    """One printed statement of a document.

    Attributes:
        id: Document and place, for example ``"000:3.3.0.2"``.
        place: Where it is printed, for a reader who has the document, for example ``"equation (3.3.0.2)"``.
        said: What it says, one sentence of ours.
        formula: As printed, plain text, lines of at most 76 characters.
        latex: The same as LaTeX; empty where it is words or code.
        printed: As printed, as code.
        check: Holds a form against the reference.
        reference: What it is held against.
        domain: Where it was sampled, and where it is meant to hold.
        unit: Unit of the residual; ``"1"`` for a relative one or a share.
        tolerance: Largest residual that holds; for printed numbers half of their last digit.
        conventions: Readings under which a form that fails as it stands may hold: the check with that reading, by a
            name that completes "holds if …". The first that holds is the verdict's.
        correction: What makes it hold, for a form that fails.
        uncorrectable: Why there is no correction, for a form that fails and has none.
        not_checkable: Why there is nothing to test; then `printed` is not run.
    """

    id: str
    place: str
    said: str
    formula: str
    printed: Form
    check: Check
    reference: str
    domain: str
    latex: str = ""
    unit: str = "1"
    tolerance: float = EXACT
    conventions: Mapping[str, Check] = field(default_factory=dict)
    correction: Correction | None = None
    uncorrectable: str = ""
    not_checkable: str = ""

    @property
    def document(self) -> str:
        """The number of its document."""
        return self.id.partition(":")[0]

    @property
    def command(self) -> str:
        """What measures it again."""
        return f"nao-kin ledger {self.id}"


@dataclass(frozen=True, slots=True)
class Judgement:
    """A claim with what running it gave.

    Attributes:
        claim: The claim.
        verdict: What follows from the figures.
        measured: The printed form against the reference, under `convention` if there is one; None if not checkable.
        convention: The reading under which it holds, empty if none is needed or none helps.
        as_it_stands: The printed form without that reading, where there is one.
        corrected: The correction against the reference, for a form that fails.
    """

    claim: Claim
    verdict: Verdict
    measured: Measured | None
    convention: str = ""
    as_it_stands: Measured | None = None
    corrected: Measured | None = None

    def row(self) -> dict[str, Any]:
        """As plain data, the fields that `nao-kin ledger --format json` prints."""
        claim, measured, corrected = self.claim, self.measured, self.corrected
        shown = claim.correction if self.verdict is Verdict.fails else None
        return {
            "claim": claim.id,
            "document": claim.document,
            "place": claim.place,
            "formula": claim.formula,
            "verdict": str(self.verdict),
            "residual": None if measured is None else measured.residual,
            "unit": claim.unit,
            "tolerance": claim.tolerance,
            "samples": 0 if measured is None else measured.samples,
            "where": "" if measured is None else measured.where,
            "measured": "" if measured is None else measured.found,
            "reference": claim.reference,
            "domain": claim.domain,
            "convention": self.convention,
            "residual_as_it_stands": None if self.as_it_stands is None else self.as_it_stands.residual,
            "correction": "" if shown is None else shown.formula,
            "correction_residual": None if corrected is None else corrected.residual,
            "reason": self.reason,
            "command": claim.command,
        }

    def table(self) -> Table:
        """The same for people, two columns; what is empty is left out."""
        told = {key.replace("_", " "): value for key, value in self.row().items() if value not in ("", None)}
        rows = tuple((key, f"{value:.3g}" if isinstance(value, float) else str(value)) for key, value in told.items())
        return Table((Column("what"), Column("value")), rows, title=f"{self.claim.id}: {self.verdict}")

    def __repr__(self) -> str:
        measured = "" if self.measured is None else f", residual {self.measured.residual:.2g} {self.claim.unit}"
        return f"<Judgement {self.claim.id}: {self.verdict}{measured}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()

    @property
    def reason(self) -> str:
        """What the correction does, why there is none, or why there is nothing to check; empty for what holds."""
        if self.verdict is Verdict.not_checkable:
            return self.claim.not_checkable
        if self.verdict is not Verdict.fails:
            return ""
        return self.claim.correction.why if self.claim.correction else self.claim.uncorrectable


_NO_VALUE: Final = (ArithmeticError, LookupError, TimeoutError, TypeError, ValueError)
"""What a formula raises where it has no value; any other error is a defect of its code, and is raised."""


class _Watched:
    """A form that remembers the error it raised, so that one of the check's own is not taken for it."""

    def __init__(self, form: Form) -> None:
        self.form = form
        self.raised: Exception | None = None

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        try:
            return self.form(*arguments, **options)
        except _NO_VALUE as error:
            self.raised = error
            raise


def _measured(check: Check, form: Form) -> Measured:
    """What a check finds of a form; one that raises has no value there, which is infinitely far from any."""
    watched = _Watched(form)
    try:
        return check(watched)
    except _NO_VALUE as error:
        if error is not watched.raised:
            raise  # the check is at fault, and its claim must not be judged by that
        return Measured(math.inf, 1, f"no value: {type(error).__name__}: {error}")


def judged(claim: Claim, form: Form | None = None) -> Judgement:
    """Runs a claim and says what follows.

    Args:
        claim: Which.
        form: Put in place of the printed form, to judge a spoilt copy of it.

    Raises:
        Exception: Whatever the check itself raises. A form that raises fails instead.
    """
    if claim.not_checkable:
        return Judgement(claim, Verdict.not_checkable, None)
    tried = claim.printed if form is None else form
    # A form outside its domain gives nan, which is a finding; numpy's warning about it says nothing more.
    with np.errstate(all="ignore"):
        plain = _measured(claim.check, tried)
        if plain.residual <= claim.tolerance:
            return Judgement(claim, Verdict.holds, plain)
        for name, check in claim.conventions.items():
            read = _measured(check, tried)
            if read.residual <= claim.tolerance:
                return Judgement(claim, Verdict.holds_under_convention, read, name, plain)
        return Judgement(claim, Verdict.fails, plain, corrected=_corrected(claim))


def _corrected(claim: Claim) -> Measured | None:
    if claim.correction is None:
        return None
    check = claim.correction.check or claim.check
    return check(claim.correction.form)
