"""`nao-kin check`: URDF files through all rules, for people and for CI."""

from __future__ import annotations

import glob
import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypedDict

import typer

from nao_kin.output import report_json, wants_colour

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.finding import Report, Severity

__all__ = ["check"]


# A file of macros by itself is no robot; what ends in .urdf.xacro is meant as one.
_SUFFIXES = (".urdf", ".srdf", ".urdf.xacro")


class CheckFormat(StrEnum):
    """How findings are printed."""

    text = "text"
    json = "json"
    sarif = "sarif"
    junit = "junit"
    github = "github"


_FILES_HELP = "URDF, xacro, SRDF files, directories, globs, known robots; NAME:=VALUE for xacro; - is standard input."


def check(
    files: Annotated[list[str], typer.Argument(help=_FILES_HELP, metavar="FILE…")],
    format: Annotated[CheckFormat, typer.Option("--format", help="How to print.")] = CheckFormat.text,
    select: Annotated[list[str] | None, typer.Option(help="Report these codes only (CODE or CODE,CODE).")] = None,
    ignore: Annotated[list[str] | None, typer.Option(help="Do not report these codes.")] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Warnings fail too.")] = False,
    thorough: Annotated[bool, typer.Option("--thorough", help="Open every mesh; hold two readers together.")] = False,
    package: Annotated[list[str] | None, typer.Option(help="Where package://NAME is.", metavar="NAME=DIR")] = None,
    dh: Annotated[str | None, typer.Option(help="A DH table (TOML) to hold the model against.")] = None,
    urdf: Annotated[str | None, typer.Option(help="The URDF that an SRDF is about.", metavar="FILE")] = None,
    against: Annotated[str | None, typer.Option(help="Another URDF to hold the model against.")] = None,
    baseline: Annotated[Path | None, typer.Option(help="Do not report what this file knows already.")] = None,
    update_baseline: Annotated[bool, typer.Option("--update-baseline", help="Record the findings in it.")] = False,
    fix: Annotated[bool, typer.Option("--fix", help="Show repairs that cannot change kinematics, as a diff.")] = False,
    write: Annotated[bool, typer.Option("--write", help="With --fix: write them.")] = False,
    swap_limits: Annotated[bool, typer.Option("--swap-limits", help="With --fix: exchange such limits.")] = False,
) -> None:
    """Check URDF files. Exit status 0: clean; 1: findings; 2: wrong usage or unreadable input."""
    from nao_kin.checks.catalogue import require_codes

    if update_baseline and baseline is None:
        raise typer.BadParameter("--update-baseline needs --baseline FILE.")
    if (write or swap_limits) and not fix:
        raise typer.BadParameter("--write and --swap-limits go with --fix.")
    selected, ignored = _codes(select), _codes(ignore)
    require_codes((*selected, *ignored))
    options: _Options = {
        "packages": _packages(package),
        "thorough": thorough,
        "select": selected,
        "ignore": ignored,
    }
    paths = _paths(files)
    if fix:
        from nao_kin.cli.fixing import fix_files

        raise typer.Exit(fix_files(paths, write=write, swap_limits=swap_limits))
    if (dh or against) and (len(paths) != 1 or paths == ["-"]):
        raise typer.BadParameter("--dh and --against are for one file.")
    found, unreadable = _all_checked(paths, options, urdf, (dh, against))
    raise typer.Exit(_reported(found, unreadable, format, strict, (baseline, update_baseline)))


def _all_checked(
    paths: list[str], options: _Options, urdf: str | None, held: tuple[str | None, str | None]
) -> tuple[Report, bool]:
    """The findings of all files, and whether one could not be read at all."""
    from nao_kin.checks.finding import Report
    from nao_kin.errors import UrdfError

    reports, unreadable = [], False
    for path in paths:
        try:
            reports.append(_checked(path, options, urdf, held))
        except UrdfError as error:
            typer.echo(f"nao-kin: {error}", err=True)
            unreadable = True
    return Report.joined(reports), unreadable


def _reported(
    found: Report, unreadable: bool, format: CheckFormat, strict: bool, baseline: tuple[Path | None, bool]
) -> int:
    """Prints the findings, or what is new of them, or records them; the exit status."""
    from nao_kin.checks.baseline import read_baseline, without_known, write_baseline
    from nao_kin.checks.finding import Severity

    path, update = baseline
    if path is not None and update:
        write_baseline(found, path)
        typer.echo(f"nao-kin: {path} now knows {len(found)} findings.", err=True)
        return 2 if unreadable else 0
    found = found if path is None else without_known(found, read_baseline(path))
    threshold = Severity.warning if strict else Severity.error
    _print(found, format, threshold)
    return 2 if unreadable else 1 if found.at_or_above(threshold) else 0


class _Options(TypedDict):
    """What is the same for every file, as `nao_kin.check` takes it."""

    packages: dict[str, str]
    thorough: bool
    select: list[str]
    ignore: list[str]


def _checked(path: str, options: _Options, urdf: str | None, held: tuple[str | None, str | None]) -> Report:
    from nao_kin.checks.checker import check as check_file
    from nao_kin.checks.checker import check_bytes
    from nao_kin.checks.finding import Report
    from nao_kin.robot.sources import given_arguments
    from nao_kin.urdf import LIMITS

    if path == "-":
        data = sys.stdin.buffer.read(LIMITS.file_bytes + 1)
        return check_bytes(data, "<stdin>", **options)
    found, (table, other) = check_file(path, urdf=urdf, arguments=given_arguments(), **options), held
    if (table or other) and found.errors:
        typer.echo(f"nao-kin: {path} was not compared, because of its errors.", err=True)
    elif table or other:
        from nao_kin.cli.departures import departures_from_model, departures_from_table

        departures = [
            *(departures_from_table(path, table) if table else ()),
            *(departures_from_model(path, other) if other else ()),
        ]
        wanted = [
            f for f in departures if f.code not in options["ignore"] and f.code in (options["select"] or [f.code])
        ]
        found = Report.joined([found, Report.of([], wanted)])
    return found


def _print(found: Report, format: CheckFormat, threshold: Severity) -> None:
    match format:
        case CheckFormat.text:
            from nao_kin.checks.formats.text import as_text

            colour = wants_colour()
            typer.echo(as_text(found, colour=colour), color=colour)
        case CheckFormat.json:
            from nao_kin.checks.formats.machine import as_data

            report_json(as_data(found))
        case CheckFormat.sarif:
            from nao_kin.checks.formats.machine import as_sarif

            report_json(as_sarif(found))
        case CheckFormat.junit:
            from nao_kin.checks.formats.machine import as_junit

            typer.echo(as_junit(found, threshold), nl=False)
        case CheckFormat.github:
            from nao_kin.checks.formats.machine import as_github

            typer.echo(as_github(found), nl=len(found) > 0)


def _codes(given: list[str] | None) -> list[str]:
    return [code for words in given or () for code in words.split(",") if code]


def _packages(given: list[str] | None) -> dict[str, str]:
    packages = {}
    for word in given or ():
        name, equals, folder = word.partition("=")
        if not name or not equals or not os.path.isdir(folder):  # noqa: PTH112 - Path raises for long names
            raise typer.BadParameter(f"--package {word}: expected NAME=DIR with an existing directory.")
        packages[name] = folder
    return packages


def _paths(given: list[str]) -> list[str]:
    """The files meant, each once, in the order given."""
    return list(dict.fromkeys(path for word in given for path in _expanded(word)))


def _expanded(word: str) -> Iterator[str]:
    if os.path.isdir(word):  # noqa: PTH112 - Path raises for long names
        found = sorted(str(path) for path in Path(word).rglob("*") if path.name.endswith(_SUFFIXES))
        if not found:
            raise typer.BadParameter(f"{word}: no .urdf, .urdf.xacro or .srdf file in this directory or below.")
        yield from found
    elif any(sign in word for sign in "*?[") and not os.path.lexists(word):
        found = sorted(path for path in glob.glob(word, recursive=True) if os.path.isfile(path))  # noqa: PTH113, PTH207
        if not found:
            raise typer.BadParameter(f"{word}: no such file.")
        yield from found
    else:
        yield word
