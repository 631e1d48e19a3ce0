"""`nao-kin robots`: the robots that load by name."""

from __future__ import annotations

from typing import Annotated

import typer

from nao_kin.output import FormatOption, OutputFormat, report, report_json

__all__ = ["robots"]


def robots(
    fetch: Annotated[
        str | None, typer.Option(help="Download a robot of robot_descriptions.py.", metavar="NAME")
    ] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """List the robots that load by name, and the names of the documents' chains."""
    if fetch is not None:
        from nao_kin.robot.descriptions import fetch as fetch_description

        report(f"{fetch} is at {fetch_description(fetch).path}.")
        return
    if format is OutputFormat.json:
        _as_data()
    else:
        _as_tables()


def _as_data() -> None:
    from nao_kin.documents.chains import DOCUMENT_CHAINS
    from nao_kin.robot.known import ALIASES, KNOWN_ROBOTS, example_robot_data_share

    installed = example_robot_data_share() is not None
    shorter = {name: alias for alias, name in ALIASES.items()}
    robots_data = [
        {
            "name": robot.name,
            "alias": shorter.get(robot.name),
            "title": robot.title,
            "source": robot.source,
            "available": robot.source == "bundled" or installed,
            "chains": {chain: list(frames) for chain, frames in robot.chains.items()},
        }
        for robot in KNOWN_ROBOTS.values()
    ]
    documents_data = [
        {"name": name, "source": d.source, "robot": d.robot, "base": d.base, "tip": d.tip}
        for name, d in DOCUMENT_CHAINS.items()
    ]
    report_json({"robots": robots_data, "document_chains": documents_data})


def _as_tables() -> None:
    from nao_kin.documents.chains import DOCUMENT_CHAINS
    from nao_kin.robot.known import ALIASES, KNOWN_ROBOTS, example_robot_data_share
    from nao_kin.table import Column, Table

    installed = example_robot_data_share() is not None
    shorter = {name: alias for alias, name in ALIASES.items()}
    rows = []
    for robot in KNOWN_ROBOTS.values():
        name = f"{robot.name} = {shorter[robot.name]}" if robot.name in shorter else robot.name
        extra = "" if robot.source == "bundled" else "robots"
        rows.append((name, robot.title, extra))
    here = "is installed" if installed else "is not installed: pip install 'nao_kin[robots]'"
    columns = (Column("name"), Column("robot"), Column("extra"))
    report(
        Table(
            columns,
            tuple(rows),
            note=f"The extra 'robots' {here}. Any URDF loads by its path.",
        ),
        "",
    )
    documents = tuple((name, d.source, d.robot) for name, d in DOCUMENT_CHAINS.items())
    report(Table((Column("document chain"), Column("source"), Column("robot")), documents))
