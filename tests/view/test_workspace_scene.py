"""A workspace map in a scene: closed around exactly the cubes, in the right frame, and explained beside."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import trimesh
from tests.conftest import robot

import nao_kin as nk
from nao_kin.view.contents import scene_of
from nao_kin.view.page import page
from nao_kin.view.scene import Scene, bounds
from nao_kin.view.workspace_scene import with_workspace, workspace_meshes


@pytest.fixture(scope="module")
def reach() -> nk.ReachMap:
    return nk.reachability(robot("nao").chain("left_arm"), 20_000, voxel=0.02)


def test_the_veil_encloses_the_maps_volume(reach: nk.ReachMap) -> None:
    veil, *section = workspace_meshes(reach)
    body = trimesh.Trimesh(veil.vertices, veil.faces, process=False)
    assert body.volume == pytest.approx(reach.volume, rel=1e-9)  # by the divergence theorem, so faces look outwards
    np.testing.assert_allclose(body.bounds, reach.extent, atol=1e-12)
    plane = trimesh.util.concatenate([trimesh.Trimesh(m.vertices, m.faces, process=False) for m in section])
    assert np.ptp(plane.vertices[:, int(np.argmin(reach.counts.shape))]) == pytest.approx(reach.voxel)
    most = max(reach.reached.sum(axis=tuple({0, 1, 2} - {int(np.argmin(reach.counts.shape))})))
    assert plane.volume == pytest.approx(most * reach.voxel**3, rel=1e-9)


def test_it_stands_in_its_base_frame_and_is_said_in_words(reach: nk.ReachMap) -> None:
    T = np.eye(4)
    T[:3, 3] = (1.0, 2.0, 3.0)
    scene = with_workspace(Scene("reach", ()), reach, T)
    np.testing.assert_allclose(bounds(scene), reach.extent + T[:3, 3], atol=1e-12)
    (panel,) = scene.panels
    text = "\n".join(panel.lines)
    assert "m³/rad³" in text
    assert "dark 0 to yellow" in text
    assert "LArm" in page(scene)


def test_a_robot_is_shown_inside_its_map(reach: nk.ReachMap) -> None:
    nao = robot("nao")
    from_foot = nk.reachability(nao.chain("l_sole", "LArm"), 5000, voxel=0.05)
    for found in (reach, from_foot):
        scene = scene_of(nao, found)
        T_root_base = nao.pose(nao.neutral, found.base_name).homogeneous
        np.testing.assert_allclose(scene.nodes[-1].placement, T_root_base, atol=1e-12)
        assert len(scene.nodes) == len(scene_of(nao).nodes) + 1
    with pytest.raises(nk.NaoKinError, match="no frame 'torso'"):
        scene_of(robot("jaco2"), reach)


def test_without_a_measure_the_section_shows_counts() -> None:
    bare = nk.reachability(robot("nao").chain("left_arm"), 5000, voxel=0.02, measure="none")
    (panel,) = with_workspace(Scene("reach", ()), bare, np.eye(4)).panels
    assert f"0 to {bare.counts.max()}" in panel.lines[-1]


def test_a_map_of_cubes_that_all_stand_alone_is_refused_at_once(reach: nk.ReachMap) -> None:
    counts = np.indices((70, 70, 70)).sum(axis=0) % 2
    measure = counts.astype(np.float64)
    dust = dataclasses.replace(reach, counts=counts, greatest=measure, mean=measure)
    with pytest.raises(nk.NaoKinError, match=f"at most 1000000 triangles .* got {6 * 70**3}"):
        workspace_meshes(dust)
