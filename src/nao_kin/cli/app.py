"""The `nao-kin` command: which commands there are, and how errors become exit statuses.

0 is fine, 1 is a disagreement or an unsolved problem, 2 is wrong usage or unreadable input.
"""

from __future__ import annotations

import importlib
import io
import os
import sys
import warnings
from typing import TYPE_CHECKING, Any, Final, NoReturn

import typer

from nao_kin.cli.shared_options import shared_options
from nao_kin.errors import NaoKinError

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["COMMANDS", "application", "main"]

# "-0.5" is a number for fk, not an option; what else begins with a dash is refused there by name.
_NUMBERS: Final = {"ignore_unknown_options": True}

COMMANDS: Final[dict[str, dict[str, Any]]] = {
    "demo": {"short_help": "The main job on NAO and JACO2, and two pages."},
    "robots": {"short_help": "The robots and document chains that load by name."},
    "fk": {"short_help": "Where a chain's tip is.", "context_settings": _NUMBERS},
    "ik": {"short_help": "Joints that bring a tip somewhere."},
    "compare": {"short_help": "A table against a model, or any two chains."},
    "check": {"short_help": "Defects of URDF files, with lines; for CI."},
    "diff": {"short_help": "What differs between two robots, and how far tips move."},
    "explain": {"short_help": "What a code of check means."},
    "ledger": {"short_help": "Every printed formula of the documents, judged."},
    "workspace": {"short_help": "A map of where a tip can be."},
    "walk": {"short_help": "A hexapod's walk: gait, speed, margins."},
    "play": {"short_help": "Keyframes as a motion, within limits."},
    "html": {"short_help": "One HTML page of a robot, postures or a motion."},
    "trajectory": {"short_help": "Motions over time: plan, run, show."},
    "warmup": {"short_help": "Compile ahead what later calls need."},
    "bench": {"short_help": "Speed and success as ratios within one run."},
}
"""The commands, in the order of the help; each is the function of that name in `cli/NAME_command.py`."""

_MODULES: Final = {"bench": "nao_kin.bench"}
"""Commands that live elsewhere."""


def application(names: Iterable[str] = COMMANDS) -> typer.Typer:
    """The command line with these commands; only their modules are imported."""
    app = typer.Typer(
        name="nao-kin",
        help="Robot kinematics with the model as the truth: look at robots, solve, compare tables, write pages. "
        "Where a robot is a file of xacro, NAME:=VALUE gives its arguments and --package NAME=DIR its packages; "
        '--tool "x y z roll pitch yaw" [m, rad] puts a tool on the tip of fk, ik, compare, trajectory and workspace.',
        no_args_is_help=True,
        invoke_without_command=True,
        add_completion=False,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_root)
    for name in names:
        command = getattr(importlib.import_module(_MODULES.get(name, f"nao_kin.cli.{name}_command")), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, **COMMANDS[name])
        else:
            app.command(**COMMANDS[name])(command)
    return app


def _root(version: bool = typer.Option(False, "--version", help="Print the version and exit.")) -> None:
    """Robot kinematics with the model as the truth."""
    if version:
        import nao_kin

        typer.echo(nao_kin.__version__)
        raise typer.Exit


def main() -> NoReturn:
    """Runs the command line and exits with its status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal that has no arrow gets a question mark
    warnings.formatwarning = _plain  # type: ignore[assignment]
    # typer reads every parameter of every command before it runs one, which takes longer than most of them do.
    asked = [word for word in sys.argv[1:2] if word in COMMANDS]
    try:
        given = shared_options(sys.argv[1:])
        with given.in_force():
            status = application(asked or COMMANDS)(given.words, standalone_mode=True)
    except (NaoKinError, typer.BadParameter) as error:  # typer itself shows those of its own parameters
        typer.echo(f"nao-kin: {error}", err=True)
        sys.exit(2)
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            _reader_has_left()
        typer.echo(f"nao-kin: {error.filename or 'file'}: {error.strerror or error}.", err=True)
        sys.exit(2)
    sys.exit(status)


def _plain(message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: object) -> str:
    """A warning about a file in our words; others as Python prints them."""
    from nao_kin.urdf import UrdfWarning

    if issubclass(category, UrdfWarning):
        return f"nao-kin: {message}\n"
    return f"{filename}:{lineno}: {category.__name__}: {message}\n"


def _reader_has_left() -> NoReturn:
    """A reader such as head or less may leave early: that is not an error, but Python would report one on flushing."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(0)
