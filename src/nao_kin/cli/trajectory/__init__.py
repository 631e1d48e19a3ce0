"""`nao-kin trajectory`: plan a motion into a file, run a file through a model, show what is in one."""

from __future__ import annotations

import typer

from nao_kin.cli.trajectory.trajectory_plan import plan
from nao_kin.cli.trajectory.trajectory_run import run
from nao_kin.cli.trajectory.trajectory_show import show

__all__ = ["trajectory"]

trajectory = typer.Typer(help="Motions over time, in files.", no_args_is_help=True, rich_markup_mode=None)
trajectory.command()(plan)
trajectory.command()(run)
trajectory.command()(show)
