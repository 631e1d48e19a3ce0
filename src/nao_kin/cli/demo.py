"""`nao-kin demo`: the main job on real robots, in one go."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nao_kin.cli.output import progress, report, rows_of_numbers

if TYPE_CHECKING:
    from nao_kin.ik.problem import IKResult
    from nao_kin.table import Table

__all__ = ["demo"]

# A greeting: the right hand up and open, the head turned towards it.
WAVE = {
    "RShoulderPitch": -1.2,
    "RShoulderRoll": -1.1,
    "RElbowYaw": 0.8,
    "RElbowRoll": 0.8,
    "RHand": 0.8,
    "LShoulderPitch": 1.3,
    "LShoulderRoll": 0.15,
    "LElbowYaw": -1.2,
    "LElbowRoll": -0.5,
    "HeadYaw": -0.25,
    "HeadPitch": -0.1,
}

# Kinova's "Home" in its MoveIt configuration [deg].
JACO2_HOME_DEG = (275.288, 167.580, 57.410, 240.825, 82.838, 75.820)


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the pages.")] = Path("demo"),
) -> None:
    """Load NAO and JACO2, print poses and Jacobians, compare the documents' tables, solve, write two pages."""
    from nao_kin.cli.tables import joint_table
    from nao_kin.robot import load
    from nao_kin.view.export import export_html

    nao, jaco2 = load("nao"), load("jaco2")
    _forward_kinematics()
    report("", _comparison_table())
    for result in _solutions():
        report("", joint_table(result.problem.chain, result.q, _solution_title(result)), result.message)
    output.mkdir(parents=True, exist_ok=True)
    pages = [
        export_html(output / "nao.html", nao, WAVE),
        export_html(output / "jaco2.html", jaco2, _check_posture()),
    ]
    report(
        "",
        "Pages, to open in any browser: " + ", ".join(str(page) for page in pages),
        "",
        "Where to look next:",
        "  nao-kin fk nao --chain left_arm --jacobian         where a hand is",
        "  nao-kin ik nao --chain left_arm --xyz 0.2 0.1 0.1  how to bring it somewhere",
        "  nao-kin compare thesis_left_arm                    where a table departs",
        "  nao-kin compare my_arm.toml ur5:arm                your own table",
        "  notebooks/00_quickstart.ipynb, docs/dh-table.md, nao-kin --help",
    )


def _forward_kinematics() -> None:
    import numpy as np

    from nao_kin.cli.tables import joint_table
    from nao_kin.documents.practicum import CHECK_Q_DEG, CHECK_T_BASE_HAND
    from nao_kin.robot import load

    arm = load("nao").chain("left_arm")
    q = np.array([0.3, 0.2, -0.5, -0.8, 0.4])
    report(joint_table(arm, q, "NAO V5, left arm: torso → LArm"), "", "T_torso_LArm")
    report(rows_of_numbers(arm.pose(q).homogeneous))
    report("frame Jacobian, torso axes, rows vx vy vz wx wy wz", rows_of_numbers(arm.jacobian(q)), "")
    chain = load("jaco2").chain("arm")
    ours = chain.pose(np.radians(CHECK_Q_DEG)).homogeneous
    report(f"JACO2 at the practicum's check pose q = {tuple(int(a) for a in CHECK_Q_DEG)}°")
    report("  the model's T_base_hand           | as the sheet prints it")
    for mine, printed in zip(ours, CHECK_T_BASE_HAND, strict=True):
        report("  " + " ".join(f"{x + 0.0:7.4f}" for x in mine) + "   | " + " ".join(f"{x:7.4f}" for x in printed))
    worst = float(np.abs(ours - np.array(CHECK_T_BASE_HAND)).max())
    report(f"  largest difference {worst:.1e}; the sheet prints three or four decimals")
    report("frame Jacobian there, base axes", rows_of_numbers(chain.jacobian(np.radians(CHECK_Q_DEG))))


def _comparison_table() -> Table:
    """Every table of the documents against its robot's model, read in its own convention and in the other."""
    from nao_kin.crosscheck import compare
    from nao_kin.documents.chains import DOCUMENT_CHAINS
    from nao_kin.robot import load
    from nao_kin.table import Column, Style, Table

    rows: list[tuple[str, ...]] = []
    styles: dict[int, Style] = {}
    readings = [(document, own) for document in DOCUMENT_CHAINS.values() for own in (True, False)]
    for index, (document, own) in enumerate(progress(readings, "comparing tables", len(readings))):
        table, model = document.build(), load(document.robot).chain(document.base, document.tip)
        if not own:
            table = table.read_as("modified" if table.convention == "standard" else "standard")
        found = compare(table, model, samples=200)
        parts = "–" if found.first_departure is None else found.first_departure.joint or "fixed ends"
        rows.append(
            (
                table.name if own else "",
                table.convention + (" (its own)" if own else ""),
                f"{found.max_position_error * 1e3:.3f}",
                f"{found.max_rotation_error:.3f}",
                "agrees" if found.agrees else parts,
            )
        )
        styles[index] = "good" if found.agrees else ("bad" if own else "faint")
    columns = (
        Column("table"),
        Column("read as"),
        Column("[mm]", number=True),
        Column("[rad]", number=True),
        Column("first parts at"),
    )
    title = "The documents' tables against the robots' models: largest tip errors"
    return Table(columns, tuple(rows), title=title, styles=styles)


def _solutions() -> tuple[IKResult, IKResult]:
    import numpy as np

    from nao_kin.ik.methods import solve
    from nao_kin.robot import load

    hand = solve(load("nao").chain("left_arm"), np.array([0.20, 0.12, 0.15]))
    arm = load("jaco2").chain("arm")
    return hand, solve(arm, arm.pose(np.radians(JACO2_HOME_DEG)))


def _solution_title(result: IKResult) -> str:
    x, y, z = result.problem.target.T_base_target.translation
    return f"IK, {result.problem.chain.name}: {result.problem.target.kind} ({x:.3f}, {y:.3f}, {z:.3f}) m"


def _check_posture() -> dict[str, float]:
    import numpy as np

    from nao_kin.documents.practicum import CHECK_Q_DEG

    return {f"joint_{k}": float(np.radians(a)) for k, a in enumerate(CHECK_Q_DEG, start=1)}
