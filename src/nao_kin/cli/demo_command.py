"""`nao-kin demo`: the main job on real robots, in one go."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.output import FormatOption, OutputFormat, number, progress, report, report_json, rows_of_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.crosscheck import Comparison
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.ik.problem import IKResult
    from nao_kin.robot.urdf_chain import UrdfChain
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

HAND_Q = (0.3, 0.2, -0.5, -0.8, 0.4)
HAND_TARGET = (0.20, 0.12, 0.15)

# Kinova's "Home" in its MoveIt configuration [deg].
JACO2_HOME_DEG = (275.288, 167.580, 57.410, 240.825, 82.838, 75.820)

NEXT = (
    "Where to look next:",
    "  . .venv/bin/activate                               so that nao-kin is found",
    "  nao-kin fk nao --chain left_arm --jacobian         where a hand is",
    "  nao-kin ik nao --chain left_arm --xyz 0.2 0.1 0.1  how to bring it somewhere",
    "  nao-kin compare thesis_left_arm                    where a table departs",
    "  README.md, docs/dh-table.md (your own table), notebooks/00_quickstart.ipynb",
)


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the pages.")] = Path("demo"),
    format: FormatOption = OutputFormat.text,
) -> None:
    """Load NAO and JACO2, print poses and Jacobians, compare the documents' tables, solve, write two pages."""
    from nao_kin.documents.chains import DOCUMENT_CHAINS

    text = format is OutputFormat.text
    poses = _poses()
    if text:
        _report_hand(poses[0])
        _report_check(poses[1])
    compared = list(progress(_comparisons(), "comparing tables", 2 * len(DOCUMENT_CHAINS)))
    if text:
        report("", _comparison_table(compared))
    solutions = _solutions()
    if text:
        _report_solutions(solutions)
    pages = _pages(output, poses[1]["q"])
    if text:
        report("", "Pages, to open in any browser: " + ", ".join(pages), "", *NEXT)
        return
    report_json({"poses": poses, **_results_data(compared, solutions), "pages": pages})


def _poses() -> list[dict[str, Any]]:
    """NAO's left hand at some joints, and the JACO2 at the practicum's check pose."""
    import numpy as np

    from nao_kin.cli.fk_command import pose_data
    from nao_kin.documents.practicum.practicum_sheet import CHECK_Q_DEG, CHECK_T_BASE_HAND

    nao, jaco2 = _chains()
    check = np.radians(CHECK_Q_DEG)
    return [
        {**pose_data(nao, np.array(HAND_Q)), "jacobian": nao.jacobian(HAND_Q)},
        {**pose_data(jaco2, check), "jacobian": jaco2.jacobian(check), "printed": CHECK_T_BASE_HAND},
    ]


def _chains() -> tuple[UrdfChain, UrdfChain]:
    from nao_kin.robot.robot import load

    return load("nao").chain("left_arm"), load("jaco2").chain("arm")


def _report_hand(pose: dict[str, Any]) -> None:
    from nao_kin.chain import joint_table

    chain, _ = _chains()
    report(joint_table(chain, list(pose["q"].values()), "NAO V5, left arm: torso → LArm"), "", "T_torso_LArm")
    report(rows_of_numbers(pose["T"]))
    report("frame Jacobian, torso axes, rows vx vy vz wx wy wz", rows_of_numbers(pose["jacobian"]), "")


def _report_check(pose: dict[str, Any]) -> None:
    import numpy as np

    angles = ", ".join(f"{np.degrees(value):.0f}" for value in pose["q"].values())
    report(f"JACO2 at the practicum's check pose q = ({angles})°")
    report("  the model's T_base_hand           | as the sheet prints it")
    for mine, printed in zip(pose["T"], pose["printed"], strict=True):
        left = " ".join(f"{number(x, 4):>7}" for x in mine)
        report(f"  {left}   | " + " ".join(f"{x:>7g}" for x in printed))
    worst = float(np.abs(np.array(pose["T"]) - np.array(pose["printed"])).max())
    report(f"  largest difference {worst:.1e}; the sheet prints three or four decimals")
    report("frame Jacobian there, base axes", rows_of_numbers(pose["jacobian"]))


def _comparisons() -> Iterator[tuple[bool, Comparison]]:
    """Every table of the documents against its robot's model, read in its own convention and in the other."""
    from nao_kin.crosscheck import compare
    from nao_kin.documents.chains import DOCUMENT_CHAINS
    from nao_kin.robot.robot import load

    for document in DOCUMENT_CHAINS.values():
        table, model = document.build(), load(document.robot).chain(document.base, document.tip)
        yield True, compare(table, model)
        yield False, compare(table.read_as("modified" if table.convention == "standard" else "standard"), model)


def _table_of(found: Comparison) -> DHChain:
    from nao_kin.dh.dh_chain import DHChain

    if not isinstance(found.a, DHChain):
        raise TypeError(found.a.name)
    return found.a


def _comparison_table(compared: list[tuple[bool, Comparison]]) -> Table:
    from nao_kin.table import Column, Style, Table

    rows: list[tuple[str, ...]] = []
    styles: dict[int, Style] = {}
    for index, (own, found) in enumerate(compared):
        table, departure = _table_of(found), found.first_departure
        differs = "agrees" if departure is None else departure.joint or "fixed end"
        rows.append(
            (
                table.name if own else "",
                table.convention + (" (its own)" if own else ""),
                f"{found.max_position_error * 1e3:.3f}",
                f"{found.max_rotation_error:.3f}",
                differs,
            )
        )
        styles[index] = "good" if found.agrees else ("bad" if own else "faint")
    numbers = (Column("[mm]", number=True), Column("[rad]", number=True))
    columns = (Column("table"), Column("read as"), *numbers, Column("first differs at"))
    title = "The documents' tables against the robots' models: largest tip errors"
    return Table(columns, tuple(rows), title=title, styles=styles)


def _solutions() -> tuple[IKResult, IKResult]:
    import numpy as np

    from nao_kin.ik.single import solve

    nao, jaco2 = _chains()
    return solve(nao, np.array(HAND_TARGET)), solve(jaco2, jaco2.pose(np.radians(JACO2_HOME_DEG)))


def _report_solutions(solutions: tuple[IKResult, ...]) -> None:
    from nao_kin.chain import joint_table

    for result in solutions:
        chain, target = result.problem.chain, result.problem.target
        x, y, z = target.T_base_target.translation
        title = f"IK, {chain.name}: {target.kind} ({x:.3f}, {y:.3f}, {z:.3f}) m"
        report("", joint_table(chain, result.q, title), result.message)


def _pages(folder: Path, check: dict[str, float]) -> list[str]:
    from nao_kin.robot.robot import load
    from nao_kin.view.export import export_html

    folder.mkdir(parents=True, exist_ok=True)
    return [
        str(export_html(folder / "nao.html", load("nao"), WAVE)),
        str(export_html(folder / "jaco2.html", load("jaco2"), check)),
    ]


def _results_data(compared: list[tuple[bool, Comparison]], solutions: tuple[IKResult, ...]) -> dict[str, Any]:
    from nao_kin.cli.compare_command import comparison_data
    from nao_kin.cli.ik_command import result_data

    comparisons = [
        {**comparison_data(found), "read_as": _table_of(found).convention, "its_own": own} for own, found in compared
    ]
    return {"comparisons": comparisons, "solutions": [result_data(result) for result in solutions]}
