"""docs/practicum.md: every task is there, with functions and tests that exist, and what it says of them holds."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from nao_kin.bench.bench_practicum import not_converging
from nao_kin.bench.bench_trajectory import compare

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "practicum.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| ([12][a-h]) \| (.+?) \| (.*?) \|(.*?)\|$", PAGE, flags=re.MULTILINE)


def test_tasks_are_there_once_and_in_order() -> None:
    tasks = [row[0] for row in ROWS]
    assert tasks == sorted(set(tasks))
    assert {*(f"1{letter}" for letter in "abcdefgh"), *(f"2{letter}" for letter in "abcdefgh")} == set(tasks)


@pytest.mark.parametrize(("task", "function", "test"), [(row[0], row[2], row[3]) for row in ROWS])
def test_functions_and_tests_exist(task: str, function: str, test: str) -> None:
    if function == "answered below":
        assert f"**{task}. " in PAGE
        return
    (file,) = re.findall(r"`(tests/\S+\.py)`", test)
    tested = (ROOT / file).read_text(encoding="utf-8")
    for name in re.findall(r"`(nao_kin\.[\w.]+)`", function):
        module, _, called = name.rpartition(".")
        assert callable(getattr(importlib.import_module(module), called))
        assert called in tested


def test_remedies_help() -> None:
    found = not_converging(12, 2)
    assert len(found) == len(re.findall(r"^\| .+ \| \d+ \| .+ \| \d+ \|$", PAGE, flags=re.MULTILINE))
    for row in found[:4]:
        assert row["still"] < row["missed"]
    assert found[0]["missed"] == 100.0
    assert found[-1]["still"] == 0.0


def test_interpolation_keeps_to_the_line_and_to_small_turns() -> None:
    found = compare(12, 2)
    direct, stepwise = found.rows
    assert found.off_line == 0
    assert stepwise["jumped"] == 0.0
    assert stepwise["largest"] < 0.005 < direct["largest"]
