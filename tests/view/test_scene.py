"""Laws of a scene: the tree of nodes is the robot's forward kinematics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from nao_kin.errors import UnknownNameError
from nao_kin.robot.robot import Robot, load
from nao_kin.view.page import page
from nao_kin.view.robot_scene import SHAPELESS, robot_scene
from nao_kin.view.scene import Node, Scene, bounds, local_pose, world_poses

if TYPE_CHECKING:
    from pathlib import Path


def random_posture(robot: Robot, seed: int) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    followers = {coupling.follower for coupling in robot.couplings}
    return {name: float(rng.uniform(-1.5, 1.5)) for name in robot.joint_names if name not in followers}


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_composed_placements_are_the_link_poses(name: str, seed: int) -> None:
    robot = load(name)
    posture = random_posture(robot, seed)
    scene = robot_scene(robot, posture)
    expected = robot.link_poses(posture)
    assert sorted(node.label for node in scene.nodes) == sorted(expected)
    for node, pose in zip(scene.nodes, world_poses(scene), strict=True):
        np.testing.assert_allclose(pose, expected[node.label].homogeneous, rtol=0, atol=1e-12)


def test_every_node_hangs_below_its_parent_link_by_its_joint(small: Robot) -> None:
    scene = robot_scene(small)
    parents = {joint.child: (joint.name, joint.parent) for joint in small.document.joints}
    for index, node in enumerate(scene.nodes):
        if node.parent is None:
            assert (node.label, node.joint) == ("base", None)
            continue
        assert node.parent < index
        assert (node.joint, scene.nodes[node.parent].label) == parents[node.label]


def test_changing_one_joint_changes_one_placement(small: Robot) -> None:
    before, after = robot_scene(small, {}), robot_scene(small, {"lift": 0.1})
    poses = [
        [local_pose(node, {joint.name: joint.value for joint in scene.joints}) for node in scene.nodes]
        for scene in (before, after)
    ]
    changed = [
        node.label for node, a, b in zip(before.nodes, *poses, strict=True) if not np.allclose(a, b, rtol=0, atol=1e-12)
    ]
    assert changed == ["slide"]


def test_joint_values_are_those_of_the_whole_posture(small: Robot) -> None:
    rows = robot_scene(small, {"shoulder": 0.5}).joints
    assert [(row.name, row.kind, row.value) for row in rows] == [
        ("shoulder", "revolute", 0.5),
        ("lift", "prismatic", 0.0),
        ("roll", "continuous", 0.0),
    ]


def test_no_posture_means_neutral(small: Robot) -> None:
    assert robot_scene(small).joints == robot_scene(small, small.neutral).joints


def test_unknown_joint_is_refused_with_its_neighbours(small: Robot) -> None:
    with pytest.raises(UnknownNameError, match="shoulder"):
        robot_scene(small, {"sholder": 0.0})


def test_missing_mesh_is_a_note_and_a_box_with_its_name(small: Robot, tmp_path: object) -> None:
    scene = robot_scene(small)
    (note,) = scene.notes
    assert "wheel" in note
    assert "missing/wheel.stl" in note
    assert str(tmp_path) not in note
    (box,) = next(node for node in scene.nodes if node.label == "wheel").meshes
    assert box.sign is not None
    assert box.sign.text == "wheel.stl"


def test_bounds_follow_the_posture(small: Robot) -> None:
    low, high = bounds(robot_scene(small, {"lift": 0.0}))
    _, lifted = bounds(robot_scene(small, {"lift": 0.1}))
    assert (low < high).all()
    assert lifted[2] > high[2] + 0.05


def test_a_skeleton_without_shapes_has_bounds() -> None:
    placement = np.eye(4)
    placement[:3, 3] = (1.0, 2.0, 3.0)
    low, high = bounds(Scene("bones", (Node("a", None, None, np.eye(4)), Node("b", 0, "j", placement))))
    np.testing.assert_array_equal(low, (0, 0, 0))
    np.testing.assert_array_equal(high, (1, 2, 3))


def test_a_robot_without_shapes_says_so(tmp_path: Path) -> None:
    path = tmp_path / "bare.urdf"
    path.write_text('<robot name="bare"><link name="only"/></robot>', encoding="utf-8")
    scene = robot_scene(load(path))
    assert scene.notes == (SHAPELESS,)
    assert len(page(scene)) > 1000


def test_a_shape_beyond_all_measure_is_a_note(tmp_path: Path) -> None:
    path = tmp_path / "vast.urdf"
    visual = '<visual><geometry><box size="{0} 1 1"/></geometry></visual>'
    path.write_text(
        f'<robot name="vast"><link name="only">{visual.format("1e300")}{visual.format("1")}</link></robot>',
        encoding="utf-8",
    )
    scene = robot_scene(load(path))
    assert [mesh.sign is None for mesh in scene.nodes[0].meshes] == [True, False]
    assert "box" in scene.notes[0]


def test_collision_shapes_that_are_the_visuals_come_once(tmp_path: Path) -> None:
    path = tmp_path / "twice.urdf"
    box, ball = '<geometry><box size="1 2 3"/></geometry>', '<geometry><sphere radius="0.2"/></geometry>'
    path.write_text(
        f'<robot name="twice"><link name="same"><visual>{box}</visual><collision>{box}</collision></link>'
        f'<link name="other"><visual>{box}</visual><collision>{ball}</collision></link>'
        '<joint name="j" type="fixed"><parent link="same"/><child link="other"/></joint></robot>',
        encoding="utf-8",
    )
    same, other = robot_scene(load(path)).nodes
    assert (same.collides, len(same.collisions)) == (True, 0)
    assert (other.collides, len(other.collisions)) == (False, 1)
