"""`nao-kin trajectory show`: what is in a file."""

from __future__ import annotations

from typing import Annotated

import typer

from nao_kin.cli.trajectory.summary import curves, joints_table, trajectory_data
from nao_kin.output import FormatOption, OutputFormat, report, report_json

__all__ = ["show"]


def show(
    file: Annotated[str, typer.Argument(help="A trajectory: .txt, .csv or .json.")],
    curve: Annotated[bool, typer.Option("--curves/--no-curves", help="Draw values and speeds over time.")] = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """The joints of a trajectory, their ranges and speeds, and curves; exit status 1 where its own limits are left."""
    from nao_kin.trajectory.demand import demand_of
    from nao_kin.trajectory.files.reading import read_trajectory

    motion = read_trajectory(file)
    demand = demand_of(motion)
    outside = [
        f"{joint.name} is outside its own range [{joint.lower:.6g}, {joint.upper:.6g}] at sample {sample}."
        for joint, column in zip(motion.joints, motion.q.T, strict=True)
        for sample in [
            next((k for k, value in enumerate(column.tolist()) if not joint.lower <= value <= joint.upper), None)
        ]
        if sample is not None
    ]
    if format is OutputFormat.json:
        data = trajectory_data(motion, demand)
        report_json(data | {"faults": [*outside, *data["faults"]]})
    else:
        report(joints_table(demand, motion))
        if curve:
            report("", *curves(motion))
        report(*(["", *outside, *demand.faults] if outside or demand.faults else []))
    if outside or demand.faults:
        raise typer.Exit(1)
