"""`nao-kin diff`: what differs in meaning between two descriptions of a robot."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from nao_kin.output import FormatOption, OutputFormat, report, report_json

__all__ = ["diff"]


def diff(
    before: Annotated[str, typer.Argument(help="A known robot or a file: URDF of any version, xacro.", metavar="A")],
    after: Annotated[str, typer.Argument(help="The other one.", metavar="B")],
    format: FormatOption = OutputFormat.text,
) -> None:
    """What differs in meaning: links, joints, placements, limits, masses; and by how much it moves the tips.

    Names decide what is compared with what. Exit status 0: they mean the same; 1: they do not.
    """
    from nao_kin.checks.diff import compare_robots
    from nao_kin.robot.robot import load

    found = compare_robots(load(before), load(after))
    if format is OutputFormat.json:
        report_json(
            {
                "same": found.same,
                "differences": [asdict(difference) for difference in found.differences],
                "tips": [asdict(tip) for tip in found.tips],
            }
        )
    else:
        report(found.table(), *(("", found.tip_table()) if found.tips and not found.same else ()))
    raise typer.Exit(0 if found.same else 1)
