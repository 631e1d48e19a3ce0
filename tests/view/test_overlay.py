"""Both chains of a comparison in one scene: at the right joints, in the right frame, and said in words."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from tests.conftest import robot

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.view.export import export_html
from nao_kin.view.overlay import FAINT, GAP, chain_scene, comparison_scene
from nao_kin.view.page import page
from nao_kin.view.scene import world_poses

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.chain import Chain
    from nao_kin.view.scene import Scene

TABLES = {
    "standard": [(0.3, 0.4, 0.1, 0.2), (0.2, -1.1, 0.05, 0.3), (0.0, 0.7, 0.4, -0.5)],
    "modified": [(0.1, 0.4, 0.2, 0.2), (0.2, -1.1, 0.05, 0.3), (0.3, 0.7, 0.4, -0.5)],
}


def thesis_against_nao() -> nk.Comparison:
    return nk.compare(nk.document_chain("thesis_left_arm"), robot("nao_v50_h21").chain("left_arm"), samples=50)


def at(scene: Scene, chain: Chain, q: np.ndarray) -> Scene:
    """The scene with a chain's joints moved."""
    values = dict(zip(chain.joint_names, q.tolist(), strict=True))
    return replace(scene, joints=tuple(replace(j, value=values.get(j.name, j.value)) for j in scene.joints))


def test_both_tips_are_where_the_chains_have_them_wherever_the_joints_go(rng: np.random.Generator) -> None:
    found = thesis_against_nao()
    scene = comparison_scene(found)
    first, second = scene.chains[:2]
    for q in [found.worst_position_q, *random_configurations(found.b, 5, rng)]:
        poses = world_poses(at(scene, found.b, q))
        for shown, chain in ((first, found.a), (second, found.b)):
            T = np.linalg.inv(poses[shown.base]) @ poses[shown.tip]
            np.testing.assert_allclose(T, chain.pose(q).homogeneous, rtol=0, atol=1e-12)


def test_the_scene_starts_where_the_tips_are_farthest_apart() -> None:
    found = thesis_against_nao()
    scene = comparison_scene(found)
    poses = world_poses(scene)
    (gap,) = [rod for rod in scene.rods if rod.measured and rod.end == scene.chains[1].tip]
    distance = np.linalg.norm(poses[gap.start][:3, 3] - poses[gap.end][:3, 3])
    assert distance == pytest.approx(found.max_position_error, abs=1e-12)
    assert gap.colour == GAP


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_link_frames_are_those_of_the_table(convention: str, rng: np.random.Generator) -> None:
    chain = nk.DHChain.from_table(TABLES[convention], convention, name="arm")
    scene = chain_scene(chain)
    for q in rng.uniform(-3, 3, (5, 3)):
        poses = world_poses(at(scene, chain, q))
        frames = poses[list(scene.framed)]
        np.testing.assert_allclose(frames[1:-1], chain.link_poses(q), rtol=0, atol=1e-12)
        np.testing.assert_allclose(frames[-1], chain.pose(q).homogeneous, rtol=0, atol=1e-12)


def test_the_robots_own_shapes_are_faint() -> None:
    scene = comparison_scene(thesis_against_nao())
    shapes = [mesh for node in scene.nodes if node.label in robot("nao_v50_h21").frame_names for mesh in node.meshes]
    assert len(shapes) > 20
    assert sum(mesh.colour[3] <= FAINT for mesh in shapes) >= len(shapes) - 2  # the balls at both tips


def test_the_panels_say_what_the_colours_are_and_why_they_differ() -> None:
    scene = comparison_scene(thesis_against_nao(), explain=True)
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
    written = export_html(tmp_path / "out.html", found)
    text = written.read_text(encoding="utf-8")
    assert "<script>hit()" not in text
    assert "&lt;script&gt;hit()" in text
    assert text == page(comparison_scene(found))


def test_chains_that_agree_have_no_gap() -> None:
    chain = robot("jaco2").chain("arm")
    scene = comparison_scene(nk.compare(chain, chain, samples=10))
    poses = world_poses(scene)
    for rod in scene.rods:
        if rod.measured:
            assert np.linalg.norm(poses[rod.start][:3, 3] - poses[rod.end][:3, 3]) < 1e-12
    assert "agree exactly" in scene.panels[0].lines[-1]
