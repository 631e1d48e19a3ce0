"""`nao-kin fk`: where the tip of a chain is, by the model and by the documents' tables beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import SPEC_HELP, chain_from_spec, chain_of_robot, document_or_file, parse_values
from nao_kin.output import FormatOption, OutputFormat, number, report, report_json, rows_of_numbers

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.table import Table

__all__ = ["fk", "pose_data"]


def fk(
    robot: Annotated[str, typer.Argument(help=SPEC_HELP)],
    values: Annotated[list[str] | None, typer.Argument(help="Joint values, base to tip [rad, m]; default 0.")] = None,
    chain: Annotated[str | None, typer.Option(help="A named chain of the robot, as left_arm.")] = None,
    base: Annotated[str | None, typer.Option(help="Base frame; default the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip frame.")] = None,
    deg: Annotated[bool, typer.Option("--deg", help="Joint values are in degrees.")] = False,
    jacobian: Annotated[bool, typer.Option("--jacobian", help="Print the frame Jacobian too.")] = False,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Forward kinematics: pose and Jacobian of a chain's tip, with the documents' DH chains of it beside."""
    import numpy as np

    from nao_kin.chain import joint_table, outside_limits

    which = _chain(robot, chain, base, tip)
    typed = parse_values(values or [], deg, which)
    q = np.array(typed or [0.0] * len(which.joints))
    data = pose_data(which, q)
    if jacobian:
        data["jacobian"] = which.jacobian(q)
    limits = ("lower", "upper", "max_velocity")
    data["limits"] = {joint.name: {what: getattr(joint, what) for what in limits} for joint in which.joints}
    outside = outside_limits(which, q)
    data["outside_limits"] = [str(joint) for joint in outside]
    data["documents"] = [pose_data(table, q) for table in _documents(which)]
    if format is OutputFormat.json:
        report_json(data)
        return
    title = f"{which.name}: {which.base_name} → {which.tip_name}"
    report(joint_table(which, q, title, limits=True), "", _poses_table([data, *data["documents"]]))
    report("", "T_base_tip", rows_of_numbers(data["T"]))
    if outside:
        report("", *(f"Outside its limits: {joint}." for joint in outside))
    if jacobian:
        report("", "Jacobian, base axes, rows vx vy vz wx wy wz", rows_of_numbers(data["jacobian"]))


def pose_data(chain: Chain, q: Floats) -> dict[str, Any]:
    """The pose of a chain's tip as plain data."""
    from nao_kin.se3 import rpy

    T_base_tip = chain.pose(q)
    return {
        "chain": chain.name,
        "base": chain.base_name,
        "tip": chain.tip_name,
        "q": dict(zip(chain.joint_names, q.tolist(), strict=True)),
        "position": T_base_tip.translation.tolist(),
        "rpy": rpy(T_base_tip).tolist(),
        "T": T_base_tip.homogeneous.tolist(),
    }


def _chain(robot: str, name: str | None, base: str | None, tip: str | None) -> Chain:
    if name is None and base is None and tip is None:
        return chain_from_spec(robot)
    if document_or_file(robot) is not None:
        raise typer.BadParameter(f"{robot} is a table: it has one chain, without --chain, --base or --tip.")
    from nao_kin.robot.robot import load

    return chain_of_robot(load(robot), name, base, tip)


def _documents(chain: Chain) -> list[Chain]:
    from nao_kin.documents.chains import document_chain, documents_of
    from nao_kin.robot.urdf_chain import UrdfChain

    if not isinstance(chain, UrdfChain) or not chain.is_bare:
        return []
    return [document_chain(name) for name in documents_of(chain.robot.name, chain.base, chain.tip)]


def _poses_table(poses: list[dict[str, Any]]) -> Table:
    import math

    from nao_kin.table import Column, Table

    truth = poses[0]["position"]
    rows = []
    for pose in poses:
        apart = math.dist(pose["position"], truth) * 1e3
        numbers = [number(x, 4) for x in (*pose["position"], *pose["rpy"])]
        rows.append((pose["chain"], *numbers, "" if pose is poses[0] else f"{apart:.4f}"))
    headings = ("x", "y", "z", "roll", "pitch", "yaw", "Δ [mm]")
    columns = (Column("chain"), *(Column(heading, number=True) for heading in headings))
    return Table(columns, tuple(rows), title="pose of the tip in the base: x y z [m], roll pitch yaw [rad]")
