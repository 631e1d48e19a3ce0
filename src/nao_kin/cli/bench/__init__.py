"""`nao-kin bench`: speed as ratios taken in one run, never as bare seconds, and every answer checked."""

from __future__ import annotations

import typer

from nao_kin.cli.bench.closed import closed
from nao_kin.cli.bench.edges import edges
from nao_kin.cli.bench.explain import explain
from nao_kin.cli.bench.fk import fk
from nao_kin.cli.bench.gait import gait
from nao_kin.cli.bench.guard import guard
from nao_kin.cli.bench.ik import ik
from nao_kin.cli.bench.loop import loop
from nao_kin.cli.bench.methods import methods
from nao_kin.cli.bench.mutants import mutants
from nao_kin.cli.bench.page import page
from nao_kin.cli.bench.practicum import practicum
from nao_kin.cli.bench.reach import reach
from nao_kin.cli.bench.servo import servo
from nao_kin.cli.bench.sixr import sixr
from nao_kin.cli.bench.startup import startup
from nao_kin.cli.bench.tips import tips
from nao_kin.cli.bench.trajectory import trajectory

__all__ = ["bench"]

bench = typer.Typer(help="Measure speed as ratios within one run.", no_args_is_help=True, rich_markup_mode=None)


@bench.callback()
def root() -> None:
    """Measure speed as ratios within one run. Exit status 1 means that a goal was missed."""


bench.command()(fk)
bench.command()(ik)
bench.command()(edges)
bench.command()(explain)
bench.command()(guard)
bench.command()(loop)
bench.command()(gait)
bench.command()(methods)
bench.command()(mutants)
bench.command()(page)
bench.command()(practicum)
bench.command()(closed)
bench.command()(servo)
bench.command()(sixr)
bench.command()(reach)
bench.command()(startup)
bench.command()(tips)
bench.command()(trajectory)
