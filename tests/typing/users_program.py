"""A program of somebody who uses the public names, for the type checker; `assert_type` says what must be inferred."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_type

import numpy as np

import nao_kin as nk

if TYPE_CHECKING:
    from numpy.typing import NDArray


def where_the_hand_is() -> NDArray[np.float64]:
    robot = nk.load("nao")
    arm = robot.chain("left_arm")
    assert_type(arm.joint_names, tuple[str, ...])
    assert_type(arm.lower, "NDArray[np.float64]")
    assert_type(arm.jacobian([0.0] * 5, frame="tip"), "NDArray[np.float64]")
    posture: dict[str, float] = robot.expand({"LElbowRoll": -0.5})
    assert robot.pose(posture, "l_gripper", base="torso") is not None
    return arm.poses(np.zeros((3, 5)))


def solving(chain: nk.Chain, tree: nk.Tree) -> list[float]:
    one = nk.solve(chain, [0.2, 0.1, 0.1], method="dls", budget=nk.Budget(restarts=3), parameters={"damping": 0.01})
    assert_type(one, nk.IKResult)
    assert_type(one.status, nk.Status)
    assert_type(one.position_error, float | None)
    several = nk.solve(tree, {"LArm": [0.2, 0.1, 0.1]})
    assert_type(several, nk.TreeResult)
    pointing = nk.Target.pointing([0.15, 0.15, 0.1], [1.0, 0.2, 0.0])
    assert_type(nk.solve_batch(chain, [pointing]), nk.BatchResult)
    every = nk.solve_all(chain, pointing, locked={"LWristYaw": 0.0})
    assert_type(every, nk.Solutions)
    assert_type(nk.nearest(every, one.q), nk.IKResult)
    assert_type(nk.follow(chain, [pointing], one.q).completed, bool)
    assert_type(nk.project_to_reach(chain, pointing), nk.Target)
    return [float(value) for value in one.q]


def comparing(rows: list[dict[str, Any]]) -> str:
    table = nk.DHChain.from_table(rows, convention="modified", lengths="mm", angles="deg")
    found = nk.compare(table, nk.to_dh(nk.document_chain("thesis_left_arm"), "standard"))
    assert_type(found, nk.Comparison)
    assert_type(found.agrees, bool)
    return table.to_urdf()


def checking(path: str) -> tuple[nk.Finding, ...]:
    report = nk.check(path, ignore=["zero-axis"])
    assert_type(report, nk.Report)
    lines = [finding.line for finding in report]
    assert_type(lines, list[int | None])
    return report.errors


def reading_the_ledger() -> list[str]:
    try:
        return [judgement.claim.formula for judgement in nk.ledger(document="000")]
    except nk.NaoKinError:
        return []


def choosing() -> dict[str, str]:
    return {name: method.choose_it for name, method in nk.METHODS.items()}
