"""`nao-kin bench`: speed as ratios taken in one run, never as bare seconds, and every answer checked."""

from __future__ import annotations

import importlib
from typing import Final

import typer

__all__ = ["QUESTIONS", "bench"]

QUESTIONS: Final = (
    "fk",
    "ik",
    "edges",
    "explain",
    "guard",
    "loop",
    "gait",
    "methods",
    "mutants",
    "page",
    "practicum",
    "closed",
    "servo",
    "sixr",
    "reach",
    "startup",
    "tips",
    "trajectory",
)
"""What is measured, in the order of the help: each is the function of that name in `bench/bench_NAME.py`."""

bench = typer.Typer(help="Measure speed as ratios within one run.", no_args_is_help=True, rich_markup_mode=None)


@bench.callback()
def root() -> None:
    """Measure speed as ratios within one run. Exit status 1 means that a goal was missed."""


for _name in QUESTIONS:
    bench.command()(getattr(importlib.import_module(f"{__name__}.bench_{_name}"), _name))
