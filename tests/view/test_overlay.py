"""Both chains of a comparison in one scene: at the right joints, in the right frame, and said in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from tests.conftest import robot

import nao_kin as nk
from nao_kin.view.export import export_comparison
from nao_kin.view.overlay import FAINT, FIRST, GAP, SECOND, comparison_scene
from nao_kin.view.page import page
from nao_kin.view.scene import world_poses

if TYPE_CHECKING:
    from pathlib import Path


def points_of(scene, colour) -> np.ndarray:
    """Vertices of the mesh of one colour in the root frame."""
    poses = world_poses(scene)
    for node, T in zip(scene.nodes, poses, strict=True):
        for mesh in node.meshes:
            if mesh.colour == colour:
                return mesh.vertices @ T[:3, :3].T + T[:3, 3]
    raise LookupError(colour)


def test_sticks_end_where_pinocchio_has_the_tips() -> None:
    model = robot("nao_v50_h21")
    found = nk.compare(nk.document_chain("thesis_left_arm"), model.chain("left_arm"), samples=50)
    scene = comparison_scene(found)
    q = found.worst_position_q
    posture = model.complete(dict(zip(found.b.joint_names, q.tolist(), strict=True)))
    T_root_base = model.pose(posture, "torso")
    tips = {
        SECOND: model.pose(posture, "LArm").translation,
        FIRST: T_root_base.act(found.a.pose(q).translation),
    }
    for colour, tip in tips.items():
        cloud = points_of(scene, colour)
        assert np.linalg.norm(cloud - tip, axis=1).min() < 0.02 * 0.4
    gap = points_of(scene, GAP)
    assert np.ptp(gap @ (tips[FIRST] - tips[SECOND])) / found.max_position_error == pytest.approx(
        found.max_position_error, rel=0.1
    )
    shapes = [mesh for node in scene.nodes[:-1] for mesh in node.meshes]
    assert shapes
    assert all(mesh.colour[3] <= FAINT for mesh in shapes)


def test_the_panels_say_what_the_colours_are_and_why_they_differ() -> None:
    found = nk.compare(nk.document_chain("thesis_left_arm"), robot("nao_v50_h21").chain("left_arm"), samples=50)
    scene = comparison_scene(found, explain=True)
    assert [panel.title for panel in scene.panels] == ["Comparison", "Explanation"]
    text = "\n".join(line for panel in scene.panels for line in panel.lines)
    for part in ("Orange: thesis_left_arm", "Blue: nao_v50_h21", "modified convention", "12.31"):
        assert part in text


def test_two_tables_need_no_robot_and_names_are_only_text(tmp_path: Path) -> None:
    table = nk.DHChain.from_table(
        [(0.3, 0.0, 0.1, 0.0), (0.2, 0.5, 0.0, 0.0)], "standard", name="<script>hit()</script>"
    )
    other = nk.DHChain.from_table([(0.3, 0.0, 0.1, 0.0), (0.25, 0.5, 0.0, 0.0)], "standard", name="other")
    found = nk.compare(table, other, samples=20)
    written = export_comparison(tmp_path / "out.html", found)
    text = written.read_text(encoding="utf-8")
    assert "<script>hit()" not in text
    assert "&lt;script&gt;hit()" in text
    assert text == page(comparison_scene(found))


def test_chains_that_agree_have_no_gap() -> None:
    chain = robot("jaco2").chain("arm")
    scene = comparison_scene(nk.compare(chain, chain, samples=10))
    with pytest.raises(LookupError):
        points_of(scene, GAP)
    assert "agree exactly" in scene.panels[0].lines[-1]
