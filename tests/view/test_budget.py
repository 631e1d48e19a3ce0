"""No page larger than asked for, and every simplification said."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from tests.conftest import needs_examples, robot

from nao_kin.errors import InvalidInputError
from nao_kin.robot.known import example_robot_data_share
from nao_kin.robot.robot import Robot, load
from nao_kin.view.budget import DEFAULT_MAX_MB, fitted
from nao_kin.view.export import export_html, show
from nao_kin.view.page import page
from nao_kin.view.robot_scene import robot_scene

if TYPE_CHECKING:
    from pathlib import Path

LARGE = {  # more triangles than fit
    "anymal_b_simple_description/robots/anymal-kinova.urdf": DEFAULT_MAX_MB,
    "talos_data/robots/talos_reduced.urdf": 2.0,
    "ur_description/urdf/ur5_robot.urdf": 1.2,
}


def example(file: str) -> Robot:
    needs_examples()
    return load(str(example_robot_data_share() / "example-robot-data" / "robots" / file))


@pytest.mark.parametrize(("file", "max_mb"), LARGE.items(), ids=[file.rsplit("/", 1)[1] for file in LARGE])
def test_a_large_robot_fits_and_says_how(file: str, max_mb: float, tmp_path: Path) -> None:
    model = example(file)
    written = export_html(tmp_path / "out.html", model, max_mb=max_mb)
    size = written.stat().st_size
    assert 0.85 * max_mb * 1e6 < size <= max_mb * 1e6  # the room is used
    text = written.read_text(encoding="utf-8")
    (said,) = re.findall(r"Simplified, so that the page stays below ([\d.]+) MB: (\d+) of (\d+) triangles", text)
    whole = sum(len(mesh.faces) for node in robot_scene(model).nodes for mesh in (*node.meshes, *node.collisions))
    assert (float(said[0]), int(said[2])) == (max_mb, whole)
    assert 0 < int(said[1]) < whole


@pytest.mark.parametrize(("name", "megabytes"), [("ur5", 4.0), ("nao", 1.5), ("talos", 5.0), ("panda", 5.0)])
def test_usual_robots_are_drawn_in_full(name: str, megabytes: float) -> None:
    if name != "nao":
        needs_examples()
    scene = robot_scene(robot(name))
    shown = fitted(scene, DEFAULT_MAX_MB, page)
    assert shown == page(scene)
    assert len(shown.encode("utf-8")) < megabytes * 1e6


def test_same_input_same_bytes() -> None:
    model = example("ur_description/urdf/ur5_robot.urdf")
    first, second = (fitted(robot_scene(model), 1.3, page) for _ in range(2))
    assert first == second


def test_a_limit_that_nothing_meets_names_one_that_does(small: Robot) -> None:
    with pytest.raises(InvalidInputError, match=r"max_mb: expected more than [\d.]+") as raised:
        show(small, max_mb=0.01)
    needed = float(re.findall(r"more than ([\d.]+)", str(raised.value))[0])
    assert len(show(small, max_mb=needed + 0.02).html.encode("utf-8")) <= (needed + 0.02) * 1e6


@pytest.mark.parametrize("max_mb", [0.0, -1.0, float("nan"), float("inf")])
def test_a_limit_is_a_positive_number(small: Robot, tmp_path: Path, max_mb: float) -> None:
    with pytest.raises(InvalidInputError, match="max_mb"):
        export_html(tmp_path / "out.html", small, max_mb=max_mb)
    assert not (tmp_path / "out.html").exists()
