"""The ledger's checks notice spoilt forms: at least 95 % of them, and the rest are no misprints."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest

from nao_kin.documents import mutants as module
from nao_kin.documents.claim import DOCUMENTS, Claim, Measured, Verdict, judged
from nao_kin.documents.judging import claims, ledger
from nao_kin.documents.mutants import EQUIVALENT, Trial, mutants, trials_of, tried


@cache
def trials(document: str) -> tuple[Trial, ...]:
    return tuple(trial for claim in claims(document=document) for trial in trials_of(claim))


@pytest.mark.parametrize("document", DOCUMENTS)
def test_at_least_95_percent_of_the_spoilt_forms_fail_and_the_others_have_a_reason(document: str) -> None:
    found = trials(document)
    assert len(found) >= 40
    survivors = {(trial.mutant.claim.id, trial.mutant.change) for trial in found if not trial.caught}
    assert survivors == {key for key in EQUIVALENT if key[0].startswith(document)}
    assert len(survivors) <= 0.05 * len(found)


def _two(a: float, b: float) -> float:
    return -a * 2.0 + b**2 if a < b else 0.0


def _claim(form: object = _two) -> Claim:
    cases = [(1.0, 3.0), (2.0, 5.0), (4.0, 2.0)]

    def check(given: object) -> Measured:
        return Measured.worst(given(a, b) - (b * b - (a + a) if a < b else 0.0) for a, b in cases)  # type: ignore[operator]

    return Claim("000:test", "here", "said", "formula", form, check, "by hand", "three cases")  # type: ignore[arg-type]


def test_every_sign_operator_and_number_is_changed_once() -> None:
    changes = [mutant.change for mutant in mutants(_claim())]
    assert sorted(changes) == sorted(
        [
            "Add → Sub in -a * 2.0 + b ** 2",
            "Mult → Div in -a * 2.0",
            "Pow → Mult in b ** 2",
            "− → + in -a",
            "Lt → GtE in a < b",
            "2 → 2.02",
            "2 → 2.02 #2",
            "0 → 0.01",
        ]
    )


def test_the_original_is_left_alone_and_every_copy_of_it_is_caught() -> None:
    claim = _claim()
    assert all(tried(mutant).caught for mutant in mutants(claim))
    assert judged(claim).verdict is Verdict.holds
    assert _two(1.0, 3.0) == 7.0


def _indices(x: list[float]) -> float:
    total: float = 0.0
    for k in range(2):
        total = total + x[k + 1]
    return total


def test_indices_and_counts_are_not_numbers_to_be_stretched() -> None:
    changes = [mutant.change for mutant in mutants(_claim(_indices))]
    assert sorted(changes) == ["0 → 0.01", "Add → Sub in k + 1", "Add → Sub in total + x[k + 1]"]


def _matrices(A: object, B: object) -> object:
    return A @ B  # type: ignore[operator]


def test_factors_of_a_matrix_product_are_swapped() -> None:
    (mutant,) = mutants(_claim(_matrices))
    assert mutant.change == "factors swapped in A @ B"


def _endless(a: float, b: float) -> float:
    while a < b:
        a = a + 1.0
    return math.nan


def test_a_copy_that_never_ends_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_PATIENCE", 0.2)
    assert {tried(mutant).how for mutant in mutants(_claim(_endless))} == {"fails"}


def _raises(a: float, b: float) -> float:
    return [a][1] + b


def test_a_form_that_raises_has_no_value_and_fails() -> None:
    found = judged(_claim(_raises))
    assert found.verdict is Verdict.fails
    assert found.measured is not None
    assert found.measured.residual == math.inf
    assert "IndexError" in found.measured.where


def test_an_error_of_the_check_is_no_verdict() -> None:
    def check(given: object) -> Measured:
        raise IndexError("the check's own")

    claim = replace(_claim(), check=check)
    with pytest.raises(IndexError, match="own"):
        judged(claim)
    with pytest.raises(IndexError, match="own"):
        tried(next(iter(mutants(claim))))


def _misspelt(a: float, b: float) -> float:
    return a + c  # type: ignore[name-defined]  # noqa: F821


def test_code_that_is_wrong_is_no_form_without_a_value() -> None:
    with pytest.raises(NameError):
        judged(_claim(_misspelt))


def test_no_printed_form_fails_by_raising() -> None:
    assert not [found.claim.id for found in ledger() if found.measured and found.measured.where.startswith("no value")]
