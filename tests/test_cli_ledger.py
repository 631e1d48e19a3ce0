"""`nao-kin ledger` as a process: formats, selections and exit statuses."""

from __future__ import annotations

import json

import pytest

from tests.test_cli import ok, quiet, run


def test_one_claim_is_shown_whole() -> None:
    text = ok("ledger", "004:result-table")
    assert text.startswith("004:result-table  MATLAB example, step 4, table T: holds\n")
    assert "-2.61800   -1.08010   -2.61799   -1.08012" in text
    assert "again        nao-kin ledger 004:result-table" in text


def test_a_claim_that_fails_has_exit_status_1_and_its_correction() -> None:
    text = ok("ledger", "001:eq-29", status=1)
    assert text.splitlines()[0].endswith(": fails")
    assert "printed      p_1 − p_0 = ½ a_2 t_1²" in text
    assert "corrected    p_1 − p_0 = ½ a_0 (t_1 − t_0)²" in text


def test_json_is_rows_and_a_row_reproduces_its_own_residual() -> None:
    rows = json.loads(ok("ledger", "--document", "004", "--failing", "--format", "json", status=1))
    assert rows
    assert {row["verdict"] for row in rows} == {"fails"}
    for row in rows:
        (again,) = json.loads(ok(*row["command"].split()[1:], "--format", "json", status=1))
        assert again == row


def test_markdown_and_a_page() -> None:
    assert ok_wide("ledger", "001:eq-2", "--format", "markdown").startswith("# Ledger\n")
    pytest.importorskip("latex2mathml")
    page = ok_wide("ledger", "001:eq-2", "--format", "html")
    assert page.startswith("<!DOCTYPE html>")
    assert "<math" in page


def test_nothing_fails_among_what_holds() -> None:
    assert ok("ledger", "001:eq-14", "--failing") == "Nothing fails as printed.\n"


def test_unknown_claims_and_documents_are_refused_with_near_matches() -> None:
    done = run("ledger", "001:eq_14")
    assert done.returncode == 2
    assert "Did you mean '001:eq-14'" in done.stderr
    done = run("ledger", "--document", "1")
    assert done.returncode == 2
    assert "There is no document '1'" in done.stderr


def ok_wide(*arguments: object) -> str:
    done = run(*arguments)
    assert done.returncode == 0
    assert quiet(done.stderr)
    return done.stdout
