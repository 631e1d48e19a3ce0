"""A tool on a tip and a mount under a base: products of poses, on every kind of chain, through every solver."""

from __future__ import annotations

import json
import pickle
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest
from tests.conftest import needs_examples

import nao_kin as nk
from nao_kin.chain import finite_difference_jacobian
from nao_kin.cli.app import main
from nao_kin.errors import InvalidInputError
from nao_kin.robot.tool import as_tool
from nao_kin.se3 import from_xyz_rpy
from nao_kin.view.contents import scene_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from nao_kin.view.scene import Scene

T_TIP_TOOL = from_xyz_rpy((0.01, -0.02, 0.1034), (0.3, -0.2, 0.785))
T_MOUNT_BASE = from_xyz_rpy((0.5, 0.1, 0.8), (0.0, 0.1, 1.2))


def chains() -> dict[str, tuple[str, str]]:
    return {"jaco2": ("link_base", "end_effector"), "nao": ("torso", "l_gripper"), "phantomx": ("foot_lf", "foot_rf")}


@pytest.mark.parametrize("name", chains())
def test_poses_and_jacobians_are_those_of_the_tools_frame(name: str) -> None:
    robot = nk.load(name)
    plain = robot.chain(*chains()[name])
    chain = plain.with_tool(T_TIP_TOOL).with_base(T_MOUNT_BASE)
    rng = np.random.default_rng(0)
    Q = rng.uniform(-0.5, 0.5, (20, len(chain.joints)))
    for q in Q:
        expected = T_MOUNT_BASE * plain.pose(q) * T_TIP_TOOL
        np.testing.assert_allclose(chain.pose(q).homogeneous, expected.homogeneous, atol=1e-12)
        np.testing.assert_allclose(chain.jacobian(q), finite_difference_jacobian(chain, q), atol=1e-7)
    np.testing.assert_allclose(chain.poses(Q), [chain.pose(q).homogeneous for q in Q], atol=1e-12)
    np.testing.assert_allclose(chain.jacobians(Q), [chain.jacobian(q) for q in Q], atol=1e-12)
    assert (chain.base, chain.tip) == chains()[name]
    assert (plain.is_bare, chain.is_bare) == (True, False)
    again = pickle.loads(pickle.dumps(chain))  # noqa: S301 - our own
    np.testing.assert_array_equal(again.pose(Q[0]).homogeneous, chain.pose(Q[0]).homogeneous)


def test_tools_sit_on_tools_and_bases_stand_on_bases() -> None:
    chain = nk.load("jaco2").chain("arm")
    q = np.full(6, 0.3)
    twice = chain.with_tool(T_TIP_TOOL).with_tool(T_MOUNT_BASE).with_base(T_TIP_TOOL).with_base(T_MOUNT_BASE)
    expected = T_MOUNT_BASE * T_TIP_TOOL * chain.pose(q) * T_TIP_TOOL * T_MOUNT_BASE
    np.testing.assert_allclose(twice.pose(q).homogeneous, expected.homogeneous, atol=1e-12)
    np.testing.assert_allclose(twice.tool.homogeneous, (T_TIP_TOOL * T_MOUNT_BASE).homogeneous, atol=1e-15)


def test_a_table_takes_them_too() -> None:
    table = nk.document_chain("practicum_jaco2")
    q = np.full(len(table.joints), 0.2)
    expected = T_MOUNT_BASE * table.pose(q) * T_TIP_TOOL
    found = table.with_tool(T_TIP_TOOL).with_base(T_MOUNT_BASE).pose(q)
    np.testing.assert_allclose(found.homogeneous, expected.homogeneous, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "chain_name"), [("jaco2", "arm"), ("nao", "left_leg"), ("ur5", "arm"), ("panda", "arm")]
)
def test_closed_forms_and_iterations_reach_targets_of_the_tool(name: str, chain_name: str) -> None:
    if name in {"ur5", "panda"}:
        needs_examples()
    chain = nk.load(name).chain(chain_name, tool=T_TIP_TOOL).with_base(T_MOUNT_BASE)
    q = chain.lower.clip(-1.0) * 0.4 + chain.upper.clip(None, 1.0) * 0.6
    target = chain.pose(q)
    assert nk.solve(chain, target, q0=q + 0.05).solved
    if name == "panda":
        return  # seven joints: a closed form has one locked
    found = [result for result in nk.solve_all(chain, target) if result.solved]
    assert found
    assert min(np.abs(pin.log6(chain.pose(result.q).actInv(target)).vector).max() for result in found) < 1e-6
    if name in {"jaco2", "ur5"}:
        assert min(np.abs(np.remainder(result.q - q + np.pi, 2 * np.pi) - np.pi).max() for result in found) < 1e-6


def test_a_table_of_it_agrees_and_an_explanation_names_the_tool() -> None:
    chain = nk.load("jaco2").chain("arm").with_tool(T_TIP_TOOL)
    table = nk.to_dh(chain, convention="modified")
    assert nk.compare(table, chain).agrees
    bare = nk.to_dh(nk.load("jaco2").chain("arm"), convention="modified")
    found = nk.compare(bare, chain)
    assert not found.agrees
    assert found.corrected is not None
    assert nk.compare(found.corrected, chain).agrees


def test_every_way_to_write_a_tool_means_the_same() -> None:
    T = from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    for written in (T, T.homogeneous, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], {"xyz": (0.1, 0.2, 0.3), "rpy": (0.4, 0.5, 0.6)}):
        np.testing.assert_allclose(as_tool(written).homogeneous, T.homogeneous, atol=1e-15)
    np.testing.assert_allclose(as_tool((0.1, 0.2, 0.3)).homogeneous, pin.SE3(np.eye(3), T.translation).homogeneous)
    row = {"a": 0.1, "alpha": 0.2, "d": 0.3, "theta": 0.4}
    rz, rx = pin.rpy.rpyToMatrix(0, 0, 0.4), pin.rpy.rpyToMatrix(0.2, 0, 0)
    x, z = np.array([0.1, 0, 0]), np.array([0, 0, 0.3])
    standard = pin.SE3(rz, z) * pin.SE3(rx, x)
    np.testing.assert_allclose(as_tool({**row, "convention": "standard"}).homogeneous, standard.homogeneous, atol=1e-15)
    modified = pin.SE3(rx, x) * pin.SE3(rz, z)
    np.testing.assert_allclose(as_tool({**row, "convention": "modified"}).homogeneous, modified.homogeneous, atol=1e-15)


@pytest.mark.parametrize(
    "written",
    [
        [0.1, 0.2],
        "0 0 1",
        {"a": 0.1},
        {"xyz": "a"},
        {"x": 1},
        {},
        [np.nan] * 3,
        np.eye(3),
        2.0 * np.eye(4),
        ["a"] * 6,
        None,
    ],
)
def test_what_is_no_tool_is_refused(written: object) -> None:
    with pytest.raises(InvalidInputError):
        nk.load("jaco2").chain("arm", tool=written if written is not None else {})  # type: ignore[arg-type]


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["nao-kin", *words])
    with pytest.raises(SystemExit) as caught:
        main()
    return int(caught.value.code or 0)


def test_commands_take_it(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    tool, chain = "0.01 -0.02 0.1034 0.3 -0.2 0.785", nk.load("jaco2").chain("arm", tool=T_TIP_TOOL)
    joints = ["0.1", "3.2", "3.1", "0.4", "0.5", "0.6"]
    assert run(monkeypatch, "fk", "jaco2", *joints, "--tool", tool, "--format", "json") == 0
    found = json.loads(capsys.readouterr().out)
    expected = chain.pose(np.array(joints, dtype=float))
    np.testing.assert_allclose(found["T"], expected.homogeneous, atol=1e-12)
    assert found["documents"] == []
    place = " ".join(f"{x!r}" for x in expected.translation.tolist()).split()
    assert run(monkeypatch, "ik", "jaco2", "--xyz", *place, f"--tool={tool}", "--format", "json") == 0
    capsys.readouterr()
    assert run(monkeypatch, "fk", "jaco2", "--tool", "1 2") == 2
    assert "expected" in capsys.readouterr().err
    assert run(monkeypatch, "check", "jaco2", "--tool", tool) == 2


def test_pages_show_the_tools_frame(tmp_path: Path) -> None:
    chain = nk.load("jaco2").chain("arm", tool=T_TIP_TOOL).with_base(T_MOUNT_BASE)
    q = chain.lower.clip(-1.0) * 0.4 + chain.upper.clip(None, 1.0) * 0.6
    result = nk.solve(chain, chain.pose(q), q0=q + 0.05)
    for number, content in enumerate((result, chain, nk.compare(nk.to_dh(chain, convention="standard"), chain))):
        scene = scene_of(content)
        shown = scene.chains[1 if number == 2 else 0]
        tip = np.eye(4) if number else _pose_in(scene, shown.tip, result.posture)
        nk.export_html(tmp_path / f"{number}.html", content)
        assert (tmp_path / f"{number}.html").stat().st_size > 10_000
        if number == 0:
            base = _pose_in(scene, shown.base, result.posture)
            np.testing.assert_allclose(np.linalg.inv(base) @ tip, chain.pose(result.q).homogeneous, atol=1e-9)


def _pose_in(scene: Scene, index: int | None, posture: Mapping[str, float]) -> np.ndarray:
    """The pose of a node in the scene, as the page works it out."""
    T = np.eye(4)
    while index is not None:
        node, moved = scene.nodes[index], np.eye(4)
        if node.drive is not None:
            value = node.drive.multiplier * posture[node.drive.joint] + node.drive.offset
            axis = np.array(node.drive.axis)
            moved[:3, :3], moved[:3, 3] = (
                (np.eye(3), axis * value) if node.drive.slides else (pin.exp3(axis * value), 0.0)
            )
        T = node.placement @ moved @ T
        index = node.parent
    return T
