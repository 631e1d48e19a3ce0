"""`nao-kin robots`: the robots that load by name."""

from __future__ import annotations

from nao_kin.cli.output import FormatOption, OutputFormat, report, report_json

__all__ = ["robots"]


def robots(format: FormatOption = OutputFormat.text) -> None:
    """List the robots and document chains that load by name."""
    from nao_kin.known import ALIASES, KNOWN_ROBOTS, example_robot_data_share
    from nao_kin.table import Column, Table

    installed = example_robot_data_share() is not None
    shorter = {name: alias for alias, name in ALIASES.items()}
    if format is OutputFormat.json:
        report_json(
            [
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
        )
        return
    rows = []
    for robot in KNOWN_ROBOTS.values():
        name = f"{robot.name} = {shorter[robot.name]}" if robot.name in shorter else robot.name
        extra = "" if robot.source == "bundled" else "robots"
        rows.append((name, robot.title, extra))
    note = "The extra 'robots' is installed." if installed else "Not installed: pip install 'nao_kin[robots]'"
    report(
        Table((Column("name"), Column("robot"), Column("extra")), tuple(rows), note=note),
        "Chains: nao-kin robots --format json.  Any URDF loads by its path.",
    )
