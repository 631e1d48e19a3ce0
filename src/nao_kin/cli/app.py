"""The `nao-kin` command: which commands there are, and how errors become exit statuses.

0 is fine, 1 is a disagreement or an unsolved problem, 2 is wrong usage or unreadable input.
"""

from __future__ import annotations

import io
import os
import sys
from typing import NoReturn

import typer

from nao_kin.cli.bench import bench
from nao_kin.cli.compare import compare
from nao_kin.cli.demo import demo
from nao_kin.cli.fk import fk
from nao_kin.cli.html import html
from nao_kin.cli.ik import ik
from nao_kin.cli.robots import robots
from nao_kin.cli.warmup import warmup
from nao_kin.errors import NaoKinError

__all__ = ["app", "main"]

app = typer.Typer(
    name="nao-kin",
    help="Robot kinematics with the model as the truth: look at robots, solve, compare tables, write pages.",
    no_args_is_help=True,
    invoke_without_command=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

# "-0.5" is a number for these commands, not an option; what else begins with a dash is refused by name.
NUMBERS = {"ignore_unknown_options": True}

app.command()(demo)
app.command()(robots)
app.command(context_settings=NUMBERS)(fk)
app.command()(ik)
app.command()(compare)
app.command()(html)
app.command()(warmup)
app.add_typer(bench, name="bench")


@app.callback()
def root(
    version: bool = typer.Option(False, "--version", help="Print the version and exit."),
) -> None:
    """Robot kinematics with the model as the truth."""
    if version:
        import nao_kin

        typer.echo(nao_kin.__version__)
        raise typer.Exit


def main() -> NoReturn:
    """Runs the command line and exits with its status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal that has no arrow gets a question mark
    try:
        status = app(standalone_mode=True)
    except NaoKinError as error:
        typer.echo(f"nao-kin: {error}", err=True)
        sys.exit(2)
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            _reader_has_left()
        typer.echo(f"nao-kin: {error.filename or 'file'}: {error.strerror or error}.", err=True)
        sys.exit(2)
    sys.exit(status)


def _reader_has_left() -> NoReturn:
    """A reader such as head or less may leave early: that is not an error, but Python would report one on flushing."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(0)
