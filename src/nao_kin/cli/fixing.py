"""`nao-kin check --fix`: repairs as a diff, written only if that is asked for."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.checks.fix import Fix

__all__ = ["fix_files"]


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
