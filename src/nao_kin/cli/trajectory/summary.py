"""A trajectory in eighty columns: a table of its joints, and curves drawn with text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.table import Table
    from nao_kin.trajectory.demand import Demand
    from nao_kin.trajectory.trajectory import Trajectory

__all__ = ["curve", "curves", "headline", "joints_table", "trajectory_data"]

_LEVELS: Final = "▁▂▃▄▅▆▇█"
_WIDTH: Final = 40  # of a curve
_NAME: Final = 16  # of a joint


def headline(trajectory: Trajectory) -> str:
    """Name, number of samples, duration, and how far apart the samples are."""
    import numpy as np

    count = len(trajectory)
    said = f"{trajectory.name or 'trajectory'}: {count} sample{'s' if count > 1 else ''}, {trajectory.duration:.6g} s"
    if count < 2:
        return said
    steps = np.diff(trajectory.times)
    return f"{said}, {steps.min():.4g} to {steps.max():.4g} s apart"


def joints_table(demand: Demand, trajectory: Trajectory) -> Table:
    """A row a joint: where it starts, ends and goes, and how fast."""
    import math

    from nao_kin.table import Column, Style, Table

    rows, styles = [], dict[int, Style]()
    for i, (joint, column) in enumerate(zip(trajectory.joints, trajectory.q.T.tolist(), strict=True)):
        numbers = [column[0], column[-1], min(column), max(column)]
        limit = float(demand.max_velocity[i])
        allowed = f"{limit:.4f}" if math.isfinite(limit) else ""
        rows.append((_shortened(joint.name), *(_fixed(x) for x in numbers), f"{demand.speed[i]:.4f}", allowed))
        if any(fault.startswith(f"{joint.name} ") for fault in demand.faults):
            styles[i] = "bad"
    headings = ("start", "end", "least", "greatest", "speed", "limit")
    columns = (Column("joint"), *(Column(heading, number=True) for heading in headings))
    note = "Values [rad, m]; the largest speed from sample to sample [rad/s, m/s]."
    return Table(columns, tuple(rows), title=headline(trajectory), note=note, styles=styles)


def curves(trajectory: Trajectory) -> list[str]:
    """Two lines a joint: its value and its speed over time."""
    import numpy as np

    lines = []
    middles = (trajectory.times[1:] + trajectory.times[:-1]) / 2.0
    for i, joint in enumerate(trajectory.joints):
        value = trajectory.q[:, i]
        lines.append(_line(joint.name, "q", trajectory.times, value))
        if len(trajectory) > 1:
            lines.append(_line("", "v", middles, np.asarray(trajectory.velocities[:, i])))
    return lines


def curve(times: Floats, values: Floats, width: int = _WIDTH) -> str:
    """Values over time as one line of bars, the lowest for the least value, evenly spaced in time."""
    import numpy as np

    lowest, span = float(values.min()), float(values.max() - values.min())
    if not span > 0.0:
        return _LEVELS[0] * width
    shares = (np.interp(np.linspace(times[0], times[-1], width), times, values) - lowest) / span
    return "".join(_LEVELS[min(int(share * len(_LEVELS)), len(_LEVELS) - 1)] for share in shares)


def trajectory_data(trajectory: Trajectory, demand: Demand) -> dict[str, Any]:
    """A trajectory's figures as plain data, without its samples."""
    return {
        "name": trajectory.name,
        "samples": len(trajectory),
        "start_time": float(trajectory.times[0]),
        "duration": trajectory.duration,
        "joints": [
            {
                "name": joint.name,
                "kind": joint.kind,
                "start": float(column[0]),
                "end": float(column[-1]),
                "least": float(column.min()),
                "greatest": float(column.max()),
                "speed": float(demand.speed[i]),
                "speed_at": int(demand.speed_at[i]),
                "max_velocity": float(demand.max_velocity[i]),
                "acceleration": float(demand.acceleration[i]),
                "acceleration_at": int(demand.acceleration_at[i]),
            }
            for i, (joint, column) in enumerate(zip(trajectory.joints, trajectory.q.T, strict=True))
        ],
        "faults": list(demand.faults),
    }


def _line(name: str, what: str, times: Floats, values: Floats) -> str:
    ends = f"{_fixed(float(values.min())):>8}  {curve(times, values)}  {_fixed(float(values.max())):>8}"
    return f"{_shortened(name):<{_NAME}} {what} {ends}"


def _shortened(name: str) -> str:
    """A name that leaves room for its row, without what would spoil a terminal."""
    plain = "".join(letter if letter.isprintable() else "?" for letter in name)
    return plain if len(plain) <= _NAME else plain[: _NAME - 1] + "…"


def _fixed(value: float) -> str:
    text = f"{round(value, 4) + 0.0:.4f}"
    return text if len(text) <= 8 else f"{value:.1e}"
