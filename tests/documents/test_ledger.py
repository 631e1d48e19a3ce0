"""The ledger: every claim judged, every verdict computed, every failing form beside one that holds."""

from __future__ import annotations

import html.parser
import json
import math
from functools import cache

import pytest

import nao_kin as nk
from nao_kin.documents.claim import DOCUMENTS, Claim, Correction, Measured, Verdict, judged
from nao_kin.documents.erratum import as_markdown, as_text
from nao_kin.documents.judging import Ledger, claims
from nao_kin.errors import UnknownNameError

# The statements that the ledger has to judge, by document and place; it may have more.
REQUIRED = {
    "000": """
        2.2.1.1 2.2.1.2 2.2.1.3 2.2.1.4 2.2.1-fixed-axes-remark 2.2.1.5 2.2.1-rotate-about-d 2.2.1-worked-example
        2.2.1.6 2.2.1.7 2.2.2.1 2.2.2.2 2.2.2.3 2.2.2.4 2.2.2.5 2.2.2.6 2.2.2.7 2.2.2.8 2.2.2.9 2.2.2.10
        2.2.2-dh-rules 2.1-joint-count table-1 table-2 3.1-joint-names table-3 3.1-T_Basis 3.1-T_End 3.1.0.1 table-4
        3.1.0.2 3.2.0.1 3.2.0.2 3.2.0.3 3.2.0.4 3.2.1.1 satz-1 3.2.1.2 3.2.2.1 3.2.2.2 3.2.2.3 3.2.2-JTJ-5x5 3.3.0.1
        3.3.0.2 3.3-s-definition 3.3.0.3 3.3.0.4 3.3.0.5 3.3.0.6 3.3.0.7 3.3.0.8 3.3-left-pipeline 3.3.0.9 3.3.0.10
        3.3.0.11 3.3.0.12 3.3.0.13 3.3.0.14 3.3.0.15 3.3.0.16 3.3-l2 algorithm-1-distances algorithm-1-unreachable
        algorithm-1-forward algorithm-1-backward algorithm-1-loop 3.4-base-index 3.4.0.1""",
    "001": """
        task-1b task-1d-sixth-column task-1d-jacobian eq-1 eq-2 eq-3 eq-4 eq-5 eq-6 eq-7 eq-8 eq-9 eq-10 eq-11 eq-12
        eq-13 1.7-singularities eq-14 eq-15 eq-16 1.8-combination eq-17 eq-18 eq-19 eq-20 eq-21 eq-22 eq-23 eq-24 eq-25
        eq-26 eq-27 eq-28 eq-29 eq-30 eq-31 eq-32 eq-33 eq-34 eq-35 eq-36""",
    "002": """
        rotation-matrix rotation-order hip-angle virtual-plane thigh-point a1 a2 a4 a3 struck-sentence joint-count
        whole-procedure""",
    "004": """
        ABase0 T01 T12 Rx Ry A2Head getT getA-getR head-chain eqns theta_2_sol theta_2_conds theta_1_sol yc_sol
        theta_1-rows-1-5 theta_1-rows-4-7-8-9 theta_1-row-6 result-table example-parameters lefthand-chain""",
}


@cache
def everything() -> Ledger:
    return nk.ledger()


def test_every_statement_has_exactly_one_row_in_the_order_of_the_documents() -> None:
    names = [claim.id for claim in claims()]
    assert len(names) == len(set(names))
    assert {f"{number}:{place}" for number, places in REQUIRED.items() for place in places.split()} <= set(names)
    assert [name[:3] for name in names] == sorted(name[:3] for name in names)


def test_every_verdict_but_not_checkable_has_a_residual_that_a_second_run_reproduces() -> None:
    for judgement in everything():
        if judgement.verdict is Verdict.not_checkable:
            assert judgement.claim.not_checkable
            assert judgement.measured is None
            continue
        assert judgement.measured is not None
        assert math.isfinite(judgement.measured.residual), judgement.claim.id
        again = nk.ledger(judgement.claim.id)[judgement.claim.id]
        assert again.verdict is judgement.verdict
        assert again.measured is not None
        assert again.measured.residual == judgement.measured.residual, judgement.claim.id


def test_a_verdict_follows_from_its_residual() -> None:
    for judgement in everything():
        if judgement.measured is not None:
            holds = judgement.measured.residual <= judgement.claim.tolerance
            assert holds == (judgement.verdict is not Verdict.fails), judgement.claim.id
            assert bool(judgement.convention) == (judgement.verdict is Verdict.holds_under_convention)


def test_what_fails_has_a_correction_that_holds_or_a_reason_why_there_is_none() -> None:
    for judgement in everything():
        if judgement.verdict is not Verdict.fails:
            continue
        if judgement.claim.correction is None:
            assert judgement.claim.uncorrectable, judgement.claim.id
        else:
            assert judgement.corrected is not None
            assert judgement.corrected.residual <= 1e-9, judgement.claim.id
            assert judgement.claim.correction.why, judgement.claim.id


def test_at_most_twelve_statements_cannot_be_checked() -> None:
    assert everything().counts[Verdict.not_checkable] <= 12


@pytest.mark.parametrize("field", ["place", "said", "formula", "reference", "domain"])
def test_every_claim_says_what_it_is(field: str) -> None:
    assert [claim.id for claim in claims() if not getattr(claim, field).strip()] == []


def test_one_claim_a_document_and_what_fails() -> None:
    found = everything()
    assert len(nk.ledger("001:eq-14")) == 1
    assert {each.claim.document for each in nk.ledger(document="004")} == {"004"}
    assert len(nk.ledger(document="004", failing=True)) == sum(
        each.claim.document == "004" for each in found if each.verdict is Verdict.fails
    )


def test_unknown_names_come_with_near_matches() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean '001:eq-14'"):
        nk.ledger("001:eq14")
    with pytest.raises(UnknownNameError, match="document"):
        nk.ledger(document="003")
    with pytest.raises(UnknownNameError, match="claim"):
        everything()["000:9.9"]


def test_the_figures_of_the_documents_are_there_to_compare() -> None:
    found = everything()
    table = found["004:result-table"]
    assert table.measured is not None
    assert "-2.61800   -1.08010   -2.61799   -1.08012" in table.measured.found
    matrix = found["001:task-1b"]
    assert matrix.measured is not None
    assert "printed 410.0, 259.5, 84.0; by the model 410.000, 259.456, 84.059" in matrix.measured.found
    short = found["001:2.2-short-distance"]
    assert short.verdict is Verdict.fails
    assert short.measured is not None
    assert "Of 60 motions 60 end elsewhere" in short.measured.found


def _off(size: float) -> Claim:
    return Claim(
        id="000:test",
        place="nowhere",
        said="Two is two.",
        formula="2 = 2",
        printed=lambda: 2.0 + size,
        check=lambda form: Measured(abs(form() - 2.0), 1),
        reference="two",
        domain="two",
        conventions={"three counts as two": lambda form: Measured(abs(form() - 3.0), 1)},
        correction=Correction(lambda: 2.0, "2 = 2"),
    )


@pytest.mark.parametrize(
    ("size", "verdict"),
    [(0.0, "holds"), (0.9e-9, "holds"), (1.1e-9, "fails"), (1.0, "holds-under-convention"), (math.nan, "fails")],
)
def test_the_verdict_is_computed(size: float, verdict: str) -> None:
    found = judged(_off(size))
    assert found.verdict == verdict
    assert (found.corrected is not None) == (verdict == "fails")
    assert bool(found.convention) == (verdict == "holds-under-convention")


def test_worst_takes_what_is_not_a_number_as_infinite() -> None:
    found = Measured.worst([0.0, -3.0, math.nan, 1.0], lambda i: f"case {i}")
    assert (found.residual, found.samples, found.where) == (math.inf, 4, "case 2")


def test_the_text_fits_eighty_columns_whole_and_in_parts() -> None:
    found = everything()
    sheets = [as_text(found), *(as_text(Ledger((each,))) for each in found)]
    assert max(len(line) for sheet in sheets for line in sheet.splitlines()) <= 80
    assert all(each.claim.id.partition(":")[2] in sheets[0] for each in found)


def test_json_rows_have_the_promised_fields() -> None:
    promised = {"claim", "document", "formula", "verdict", "residual", "unit", "reference", "domain", "convention"}
    promised |= {"correction", "correction_residual", "command"}
    rows = everything().rows()
    assert all(promised <= set(row) for row in rows)
    assert json.loads(json.dumps(rows, allow_nan=True)) is not None
    assert {row["document"] for row in rows} == set(DOCUMENTS)


def test_markdown_has_a_row_a_claim() -> None:
    found = everything()
    rows = [line for line in as_markdown(found).splitlines() if line.startswith("| 0")]
    assert len(rows) == len(found)
    assert all(row.replace("\\|", "").count("|") == 6 for row in rows)


class _Page(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.policy = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        values = dict(attrs)
        assert not {"src", "onclick", "onload"} & set(values)
        assert (values.get("href") or "#").startswith("#")
        if values.get("http-equiv") == "Content-Security-Policy":
            self.policy = values["content"] or ""


def test_the_page_needs_no_network_and_typesets_every_formula_that_has_latex() -> None:
    pytest.importorskip("latex2mathml")
    from nao_kin.documents.erratum import as_html

    found, page = everything(), _Page()
    text = as_html(found)
    page.feed(text)
    assert page.policy.startswith("default-src 'none'")
    assert "script" not in page.tags
    assert "link" not in page.tags
    assert page.tags.count("article") == len(found)
    assert page.tags.count("math") >= sum(bool(each.claim.latex) for each in found)
    assert text == as_html(found)


def test_latex_leaves_no_command_unread() -> None:
    convert = pytest.importorskip("latex2mathml.converter").convert
    for claim in claims():
        for latex in (claim.latex, claim.correction.latex if claim.correction else ""):
            if latex:
                assert "\\" not in convert(latex), claim.id
