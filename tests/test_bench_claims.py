"""Verdicts on the documents' claims, on made-up outcomes: each can go either way, and follows the figures."""

from __future__ import annotations

import numpy as np
import pytest

from nao_kin.bench import claims
from nao_kin.bench.claims import Figures
from nao_kin.bench.closed_beside import CLOSED, Beside
from nao_kin.bench.method_sets import Outcome, TargetSet
from nao_kin.documents.thesis.methods_compared import ITERATIVE, JACOBIAN, SHOWN

N = 100


def outcome(method: str, *, solved: int = N, micro: float = 10.0, iterations: int = 5, move: float = 0.2) -> Outcome:
    """A hundred positions, all alike but for how many are solved."""
    of = TargetSet("made up", "made up", None, "position", np.zeros((N, 4, 4)), np.zeros((N, 2)))  # type: ignore[arg-type]
    reached = np.arange(N) < solved
    return Outcome(of, method, reached, 0, np.full((N, 2), move), np.full(N, iterations), np.full(N, micro * 1e-6))


def figures(**of: Outcome) -> Figures:
    """Every iterative method at the usual figures, but for those given."""
    every = [of.get(name, outcome(name)) for name in ITERATIVE]
    return Figures(every, every, every, every, [])


@pytest.mark.parametrize(("micro", "holds"), [(1.0, True), (20.0, False)])
def test_the_fastest_is_who_takes_least(micro: float, holds: bool) -> None:
    verdict, told = claims._fabrik_is_fastest(figures(fabrik=outcome("fabrik", micro=micro)))
    assert verdict is holds
    assert f"fabrik {micro:.0f} µs" in told


@pytest.mark.parametrize(("micro", "holds"), [(10_001.0, True), (9_000.0, False)])
def test_a_thousand_times_is_a_thousand_times(micro: float, holds: bool) -> None:
    every = {name: outcome(name, micro=10_001.0) for name in JACOBIAN}
    one = {"transpose_buss": outcome("transpose_buss", micro=micro)}
    assert claims._thousand_times(figures(**(every | one)))[0] is holds


@pytest.mark.parametrize(("iterations", "holds"), [(5, True), (6, False)])
def test_many_iterations_are_more_than_fabriks(iterations: int, holds: bool) -> None:
    assert claims._many_iterations(figures(fabrik=outcome("fabrik", iterations=iterations)))[0] is holds


@pytest.mark.parametrize(("move", "holds"), [(0.21, True), (0.4, False)])
def test_natural_is_what_moves_little(move: float, holds: bool) -> None:
    assert claims._natural(figures(fabrik=outcome("fabrik", move=move)))[0] is holds


@pytest.mark.parametrize(("ftl", "holds"), [(80, True), (86, True), (99, False)])
def test_a_difference_within_chance_is_none(ftl: int, holds: bool) -> None:
    usual = {name: outcome(name, solved=80) for name in (*SHOWN, "ccd")}
    assert claims._inferior(figures(**usual, ftl=outcome("ftl", solved=ftl)))[0] is holds


@pytest.mark.parametrize(("closed", "holds"), [(2.0, True), (20.0, False)])
def test_the_closed_form_is_fastest_where_nobody_is_faster(closed: float, holds: bool) -> None:
    beside = Beside("arm", {CLOSED: 100.0, "lm": 100.0}, {CLOSED: closed, "lm": 10.0})
    assert claims._closed_is_fastest(Figures([], [], [], [], [beside]))[0] is holds


@pytest.mark.parametrize(("success", "holds"), [(100.0, True), (99.9, False)])
def test_stable_is_every_target(success: float, holds: bool) -> None:
    beside = Beside("arm", {CLOSED: success}, {CLOSED: 1.0})
    assert claims._closed_is_stable(Figures([], [], [], [], [beside]))[0] is holds
