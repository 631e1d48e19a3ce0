"""The ledger: every printed statement of the four documents, run and judged."""

from __future__ import annotations

import importlib
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from nao_kin.documents.claim import DOCUMENTS, Verdict, judged
from nao_kin.errors import UnknownNameError
from nao_kin.table import Column, Style, Table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.documents.claim import Claim, Judgement

__all__ = ["Ledger", "claims", "ledger"]

_MODULES: Final = (
    # 000, Bischoff 2016
    "thesis.coordinate_transforms",
    "thesis.denavit_hartenberg",
    "thesis.dimensions",
    "thesis.printed_chains",
    "thesis.jacobian_methods",
    "thesis.closed_form_claims",
    "thesis.fabrik_algorithm",
    "thesis.methods_compared",
    # 001, practicum
    "practicum.check_matrix",
    "practicum.newtons_method",
    "practicum.inverse_jacobians",
    "practicum.line_profile",
    # 002, hexapod article
    "hexapod.hexapod_article",
    # 004, MATLAB example
    "matlab.chain_matrices",
    "matlab.head_solutions",
    "matlab.left_hand_chain",
)
"""Modules of this package with a tuple `CLAIMS` each, in the order of the documents."""

_STYLES: Final[dict[Verdict, Style]] = {
    Verdict.holds: "",
    Verdict.holds_under_convention: "",
    Verdict.fails: "bad",
    Verdict.not_checkable: "faint",
}


@dataclass(frozen=True, slots=True)
class Ledger:
    """Claims with their verdicts, in the order of the documents; iterable, and shown as a table in a notebook.

    Attributes:
        judgements: One a claim.
    """

    judgements: tuple[Judgement, ...]

    def __iter__(self) -> Iterator[Judgement]:
        return iter(self.judgements)

    def __len__(self) -> int:
        return len(self.judgements)

    def __getitem__(self, name: str) -> Judgement:
        """The judgement of a claim, by its name.

        Raises:
            UnknownNameError: It is not among these; carries near matches.
        """
        by_name = {judgement.claim.id: judgement for judgement in self}
        try:
            return by_name[name]
        except KeyError:
            raise UnknownNameError("claim", name, by_name) from None

    @property
    def counts(self) -> dict[Verdict, int]:
        """How many claims have each verdict."""
        found = Counter(judgement.verdict for judgement in self)
        return {verdict: found[verdict] for verdict in Verdict}

    def rows(self) -> list[dict[str, Any]]:
        """As plain data, one dictionary a claim."""
        return [judgement.row() for judgement in self]

    def table(self) -> Table:
        """One row a claim: verdict, residual, and the reading or the correction that makes it hold."""
        rows = tuple(_cells(judgement) for judgement in self)
        styles = {index: _STYLES[judgement.verdict] for index, judgement in enumerate(self)}
        columns = (Column("claim"), Column("verdict"), Column("residual", number=True), Column("holds if"))
        return Table(columns, rows, title=self.summary, styles=styles)

    @property
    def summary(self) -> str:
        """How many hold, hold under a convention, fail and cannot be checked."""
        counts = self.counts
        parts = [f"{counts[Verdict.holds]} hold", f"{counts[Verdict.holds_under_convention]} hold under a convention"]
        parts += [f"{counts[Verdict.fails]} fail", f"{counts[Verdict.not_checkable]} cannot be checked"]
        return f"{len(self)} printed statements: {', '.join(parts)}."

    def __repr__(self) -> str:
        return f"<Ledger of {self.summary}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def claims(name: str | None = None, *, document: str | None = None) -> tuple[Claim, ...]:
    """The claims of the documents, in their order; nothing is run.

    Args:
        name: One of them, for example ``"000:3.3.0.2"``.
        document: Only those of this document, for example ``"000"``.

    Raises:
        UnknownNameError: There is no such claim or document; carries near matches.
    """
    if document is not None and document not in DOCUMENTS:
        raise UnknownNameError("document", document, DOCUMENTS)
    modules = (importlib.import_module(f"nao_kin.documents.{module}") for module in _MODULES)
    every: tuple[Claim, ...] = tuple(claim for module in modules for claim in module.CLAIMS)
    found = tuple(claim for claim in every if document in (None, claim.document))
    if name is None:
        return found
    by_name = {claim.id: claim for claim in found}
    try:
        return (by_name[name],)
    except KeyError:
        raise UnknownNameError("claim", name, by_name) from None


def ledger(claim: str | None = None, *, document: str | None = None, failing: bool = False) -> Ledger:
    """Runs every printed formula, table, number and algorithm of the documents and says whether it holds.

    Args:
        claim: Only this one, for example ``"000:3.3.0.2"``.
        document: Only those of this document, for example ``"000"``.
        failing: Only those that fail as printed.

    Returns:
        One judgement a claim, in the order of the documents.

    Raises:
        UnknownNameError: There is no such claim or document; carries near matches.
    """
    found = Ledger(tuple(judged(each) for each in claims(claim, document=document)))
    return Ledger(tuple(each for each in found if each.verdict is Verdict.fails)) if failing else found


def _cells(judgement: Judgement) -> tuple[str, str, str, str]:
    measured = judgement.measured
    residual = "" if measured is None else f"{measured.residual:.2g}"
    if residual and judgement.claim.unit != "1":
        residual += f" {judgement.claim.unit}"
    correction = judgement.claim.correction
    corrected = correction.formula if correction is not None and judgement.verdict is Verdict.fails else ""
    return judgement.claim.id, str(judgement.verdict), residual, judgement.convention or corrected or judgement.reason
