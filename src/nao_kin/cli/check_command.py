"""`nao-kin check`: URDF files through all rules, for people and for CI."""

from __future__ import annotations

import glob
import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypedDict

import typer

from nao_kin.checks.checker import departure_finding
from nao_kin.output import report_json, wants_colour

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nao_kin.checks.finding import Finding, Report, Severity
    from nao_kin.checks.fix import Fix
    from nao_kin.crosscheck import Comparison
    from nao_kin.robot.robot import Robot

__all__ = ["check", "departures_from_model", "departures_from_table", "fix_files"]

_SAMPLES = 200  # a fault shows at almost any configuration


def departures_from_table(path: str, table: str) -> Iterator[Finding]:
    """Where the chain between a table's base and tip moves otherwise than the table says.

    Raises:
        UnknownNameError: The file has no frame of the name of the table's base or tip.
        TableFileError: The table cannot be read.
        UrdfError: The file cannot be read.
    """
    from nao_kin.crosscheck import compare
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.robot.robot import load

    chain = DHChain.from_file(table)
    robot = load(path)
    found = compare(chain, robot.chain(chain.base_name, chain.tip_name))
    hint = "Look at that joint's origin and axis, and at its row in the table."
    if not found.agrees and found.explanation.steps:
        hint = f"They agree after changing in the table: {'; '.join(map(str, found.explanation.steps))}."
    yield from _finding(path, "departs-from-table", found, _joint_above(robot, chain.tip_name), hint)


def departures_from_model(path: str, other: str) -> Iterator[Finding]:
    """Where the chains from the root to the ends that both files have move otherwise than in the other file.

    Raises:
        UrdfError: One of the files cannot be read.
    """
    from nao_kin.robot.robot import load

    ours, theirs = load(path), load(other)
    frames = set(theirs.frame_names)
    if ours.root not in frames:
        message = f"The root {ours.root!r} is not a frame of {other}, so nothing can be compared."
        yield departure_finding(path, "departs-from-model", None, message, "Do both files describe the same robot?")
        return
    seen: set[str] = set()
    for tip in _ends(ours):
        for finding in _end_findings(path, ours, theirs, tip, other):
            if finding.element not in seen:  # ends that share joints depart at the same one
                seen.add(finding.element)
                yield finding


def _end_findings(path: str, ours: Robot, theirs: Robot, tip: str, other: str) -> Iterator[Finding]:
    from nao_kin.crosscheck import compare

    above, code = _joint_above(ours, tip), "departs-from-model"
    if tip not in theirs.frame_names:
        yield departure_finding(path, code, above, f"The frame {tip!r} is not in {other}.")
        return
    names, others = (_moving_on_the_way(robot, ours.root, tip) for robot in (ours, theirs))
    if names != others:
        message = f"The way to {tip!r} has other joints than in {other}: {_listed(others)}."
        name = next((a for a, b in zip(names, others, strict=False) if a != b), names[-1])
        yield departure_finding(path, code, name, message)
        return
    found = compare(theirs.chain(ours.root, tip), ours.chain(ours.root, tip), samples=_SAMPLES)
    yield from _finding(path, code, found, above, "Look at that joint's origin and axis in both files.")


def _finding(path: str, code: str, found: Comparison, above: str | None, hint: str) -> Iterator[Finding]:
    """The one place where a comparison becomes a finding; what explains it goes into the hint.

    Args:
        path: The file that is checked.
        code: Of the finding.
        found: The comparison, the file's chain second.
        above: The joint that the tip hangs on, where the finding stands if only the ends differ.
        hint: What to look at.
    """
    departure = found.first_departure
    if departure is None:
        return
    worst = f"{found.max_position_error * 1e3:.4g} mm and {found.max_rotation_error:.4g} rad at worst"
    where = "the joints move alike, only the ends differ"
    if departure.joint is not None:
        where = f"they part at the joint {departure.joint!r}, or at the fixed transform that leads to it"
    message = f"{found.b.name} and {found.a.name} are apart by {worst}: {where}."
    yield departure_finding(path, code, departure.joint or above, message, hint)


def _joint_above(robot: Robot, link: str) -> str | None:
    return next((joint.name for joint in robot.document.joints if joint.child == link), None)


def _moving_on_the_way(robot: Robot, base: str, tip: str) -> tuple[str, ...]:
    """Names of the joints from base to tip that move, whichever way they are met."""
    up, down = robot.path(base, tip)
    return tuple(joint.name for joint in (*up, *down) if joint.kind != "fixed")


def _ends(robot: Robot) -> list[str]:
    """The links that nothing hangs on and that move against the root."""
    parents = {joint.parent for joint in robot.document.joints}
    return [
        link.name
        for link in robot.document.links
        if link.name not in parents and any(j.kind != "fixed" for j in robot.path(robot.root, link.name)[1])
    ]


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "")


def fix_files(paths: Sequence[str], *, write: bool, swap_limits: bool) -> int:
    """Show, and write if wanted, the repairs of files; the exit status is 1 where some are shown but not written."""
    from nao_kin.checks.fix import fix_urdf
    from nao_kin.errors import UrdfError
    from nao_kin.replacing import replace_file
    from nao_kin.urdf.document import read_bytes

    status = 0
    for path in paths:
        if path == "-" or not path.endswith(".urdf"):
            raise typer.BadParameter(f"{path}: --fix is for URDF files; what is expanded or piped has no text to mend.")
        try:
            data = read_bytes(path)
            found = fix_urdf(data, path, swap_limits=swap_limits)
            if found.swapped and not swap_limits and _may_swap(found):
                found = fix_urdf(data, path, swap_limits=True)
        except UrdfError as error:
            typer.echo(f"nao-kin: {error}", err=True)
            status = 2
            continue
        _show(found)
        if found.repairs and write:
            mark = b"\xef\xbb\xbf" if data.startswith(b"\xef\xbb\xbf") else b""
            replace_file(path, mark + found.after.encode())
            typer.echo(f"nao-kin: wrote {path}.", err=True)
        elif found.repairs:
            status = max(status, 1)
            typer.echo("nao-kin: nothing was written; --write does.", err=True)
    return status


def _may_swap(found: Fix) -> bool:
    """Whether limits may be exchanged: a person at a terminal is asked, nobody else is."""
    lines = ", ".join(map(str, found.swapped))
    if sys.stdin.isatty() and sys.stderr.isatty():
        return typer.confirm(f"{found.path}: exchange the swapped limits on line {lines}?", default=False, err=True)
    typer.echo(f"nao-kin: {found.path}: limits on line {lines} are swapped; --swap-limits exchanges them.", err=True)
    return False


def _show(found: Fix) -> None:
    if not found.repairs:
        typer.echo(f"nao-kin: {found.path}: nothing that can be repaired without changing the robot.", err=True)
        return
    typer.echo(found.diff(), nl=False)
    for repair in found.repairs:
        typer.echo(f"nao-kin: {found.path}:{repair.line}: {repair.code}: {repair.what}", err=True)


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
        from nao_kin.cli.check_command import fix_files

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
        from nao_kin.cli.check_command import departures_from_model, departures_from_table

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
