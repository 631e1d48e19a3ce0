"""What stands for a mesh that cannot be shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.robot.robot import load
from nao_kin.urdf.elements import Box, Inertial, MeshFile, Origin, Solid
from nao_kin.view.meshes import COLOUR, EDGE, placeholder_box, sign_corners
from nao_kin.view.record import recorded
from nao_kin.view.robot_scene import robot_scene

if TYPE_CHECKING:
    from pathlib import Path

VISUAL = Solid(MeshFile("gone.stl"), Origin((0.1, 0.2, 0.3), (0.0, 0.0, 0.5)), None, 1)


def inertial(mass: float, inertia: np.ndarray) -> Inertial:
    xx, xy, xz, _, yy, yz, _, _, zz = inertia.ravel().tolist()
    return Inertial(mass, Origin((0.0, 0.1, -0.2), (0.2, -0.4, 1.0)), (xx, xy, xz, yy, yz, zz), 1)


@pytest.mark.parametrize("seed", range(20))
def test_a_box_is_recovered_from_its_inertia(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = np.array([0.05, 0.15, 0.4])[rng.permutation(3)] * rng.uniform(0.8, 1.2, 3)
    R = pin.exp3(rng.normal(size=3))
    of_box = np.asarray(pin.Inertia.FromBox(2.5, *size).inertia)
    box, T = placeholder_box(inertial(2.5, R @ of_box @ R.T), VISUAL)
    np.testing.assert_allclose(sorted(box.size), sorted(size), rtol=1e-9)
    T_link_inertial = pin.SE3(pin.rpy.rpyToMatrix(0.2, -0.4, 1.0), np.array((0.0, 0.1, -0.2)))
    np.testing.assert_allclose(T[:3, 3], T_link_inertial.translation, atol=1e-12)
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
    again = T[:3, :3] @ np.asarray(pin.Inertia.FromBox(2.5, *box.size).inertia) @ T[:3, :3].T
    in_link = T_link_inertial.rotation @ R @ of_box @ R.T @ T_link_inertial.rotation.T
    np.testing.assert_allclose(again, in_link, atol=1e-12)


@pytest.mark.parametrize(
    "given",
    [
        None,
        inertial(0.0, np.eye(3)),
        inertial(1.0, np.zeros((3, 3))),
        inertial(1.0, np.diag([1.0, 1.0, 5.0])),  # no body has it
        inertial(1e-3, np.diag([1e3, 1e3, 1e3])),  # kilometres
    ],
)
def test_without_a_usable_inertia_it_is_a_cube_at_the_visual(given: Inertial | None) -> None:
    box, T = placeholder_box(given, VISUAL)
    assert box == Box((EDGE, EDGE, EDGE))
    np.testing.assert_allclose(T, pin.SE3(pin.rpy.rpyToMatrix(0, 0, 0.5), np.array((0.1, 0.2, 0.3))).homogeneous)


def test_text_stands_in_front_of_each_side_and_reads_from_outside() -> None:
    size = np.array((0.2, 0.3, 0.5))
    for square in sign_corners((0.2, 0.3, 0.5)):
        right, up = square[1] - square[0], square[3] - square[0]
        assert right @ up == pytest.approx(0.0)
        assert np.linalg.norm(right) == pytest.approx(np.linalg.norm(up))
        assert np.cross(right, up) @ square.mean(axis=0) > 0.0
        outside = np.abs(square) - size / 2
        assert (outside.max(axis=1) > 0.0).all()
        assert outside.max() < 0.01 * size.max()


def test_a_link_has_one_box_whose_text_is_only_text(tmp_path: Path) -> None:
    hostile = "&lt;img src=x onerror=alert(1)&gt;.stl"
    visual = '<visual><geometry><mesh filename="deep/{}"/></geometry></visual>'
    box = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    path = tmp_path / "gone.urdf"
    path.write_text(
        f'<robot name="gone"><link name="a">{visual.format(hostile)}{box}</link>'
        f'<link name="b">{visual.format("x.stl")}{visual.format("y.stl")}</link>'
        '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>',
        encoding="utf-8",
    )
    scene = robot_scene(load(path))
    assert len(scene.notes) == 3
    first, second = (node.meshes for node in scene.nodes)
    assert [mesh.sign and mesh.sign.text for mesh in first] == [None, "<img src=x onerror=alert(1)>.stl"]
    assert [mesh.sign and mesh.sign.text for mesh in second] == ["2 missing"]
    assert second[0].colour == COLOUR
    commands = [command for command in recorded(scene) if b"onerror" in command]
    assert len(commands) == 1
    assert b"_text" in commands[0]
