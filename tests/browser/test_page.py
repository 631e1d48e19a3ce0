"""What a browser makes of an exported page: the robot, in full, and not a word to anybody else."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from nao_kin.crosscheck import compare
from nao_kin.documents.chains import document_chain
from nao_kin.robot import load
from nao_kin.view.export import export_comparison, export_html, show
from nao_kin.view.record import node_paths
from nao_kin.view.scene import robot_scene

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

HOSTILE = """<robot name="&lt;/script&gt;&lt;script&gt;window.hit=1&lt;/script&gt;">
  <link name="__proto__"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
  <link name="constructor"><visual><geometry><box size="0.1 0.1 0.3"/></geometry></visual></link>
  <link name="a//b">
    <visual><geometry><mesh filename="&lt;img src=x onerror=window.hit=1&gt;.stl"/></geometry></visual>
  </link>
  <joint name="&lt;img src=x onerror=window.hit=1&gt;" type="revolute">
    <parent link="__proto__"/><child link="constructor"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="&quot; onmouseover=&quot;window.hit=1" type="fixed">
    <parent link="constructor"/><child link="a//b"/><origin xyz="0 0 0.2"/>
  </joint>
</robot>
"""


def pixels(page: Any) -> NDArray[np.int16]:
    settle(page)
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=np.int16)


def settle(page: Any) -> None:
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def robot_mask(page: Any) -> NDArray[np.bool_]:
    """Where the picture changes when the robot disappears; the ground, and so the shadow, is left out."""
    hide = "(name) => { naoKin.viewer.set_property([name], 'visible', false); naoKin.viewer.set_dirty(); }"
    page.evaluate(hide, "ground")
    seen = pixels(page)
    page.evaluate(hide, "robot")
    return np.abs(seen - pixels(page)).max(axis=2) > 12


def box_of(page: Any, selector: str) -> tuple[int, int, int, int]:
    box = page.locator(selector).bounding_box()
    left, top = int(box["x"]), int(box["y"])
    return left, top, left + int(box["width"]) + 1, top + int(box["height"]) + 1


def exported(name: str, tmp_path: Path) -> Path:
    try:
        robot = load(name)
    except ImportError as error:
        pytest.skip(str(error))
    return export_html(tmp_path / f"{name}.html", robot)


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx", "ur5"])
@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 800), (900, 420)])
def test_the_robot_is_in_full_view(
    name: str, width: int, height: int, tmp_path: Path, visit: Callable[..., Any]
) -> None:
    path = exported(name, tmp_path)
    visited = visit(path, width, height)
    mask = robot_mask(visited.page)
    assert mask.mean() > 0.01
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    assert rows[0] > 2
    assert rows[-1] < height - 3
    assert columns[0] > 2
    assert columns[-1] < width - 3
    assert max(np.ptp(rows) / height, np.ptp(columns) / width) > 0.45  # and not lost in the distance
    for cover in ("#card", "#reset"):
        left, top, right, bottom = box_of(visited.page, cover)
        assert not mask[top:bottom, left:right].any(), cover
    assert visited.requests == [path.as_uri()]
    assert (visited.console, visited.errors) == ([], [])


def test_the_nodes_in_the_browser_stand_where_pinocchio_says(tmp_path: Path, visit: Callable[..., Any]) -> None:
    robot = load("nao")
    posture = {"HeadYaw": 0.4, "LShoulderPitch": 1.1, "LElbowRoll": -0.7, "RKneePitch": 0.9, "LHipYawPitch": -0.3}
    page = visit(export_html(tmp_path / "nao.html", robot, posture)).page
    scene, expected = robot_scene(robot, posture), robot.link_poses(posture)
    read = """(path) => {
      const node = naoKin.viewer.scene_tree.find(path).object;
      node.updateWorldMatrix(true, false);
      return naoKin.viewer.scene.matrixWorld.clone().invert().multiply(node.matrixWorld).elements;
    }"""
    for node, path in zip(scene.nodes, node_paths(scene), strict=True):
        there = np.array(page.evaluate(read, path.strip("/").split("/"))).reshape(4, 4).T
        np.testing.assert_allclose(there, expected[node.label].homogeneous, rtol=0, atol=1e-9)


def test_the_joint_panel_opens_and_the_robot_makes_room(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("nao", tmp_path), 390, 800).page
    assert not page.get_by_text("LElbowRoll").is_visible()
    page.get_by_text("Joint values").click()
    assert page.get_by_text("LElbowRoll").is_visible()
    left, top, right, bottom = box_of(page, "#card")
    assert not robot_mask(page)[top:bottom, left:right].any()


def test_the_view_can_be_turned_and_put_back(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("jaco2", tmp_path)).page
    first = pixels(page)
    page.mouse.move(700, 400)
    page.mouse.down()
    page.mouse.move(820, 430, steps=4)
    page.mouse.up()
    assert (np.abs(pixels(page) - first).max(axis=2) > 12).mean() > 0.01
    page.get_by_text("Reset view").click()
    page.mouse.move(5, 400)  # off the button, which looks different under the pointer
    page.evaluate("() => document.activeElement.blur()")
    assert (np.abs(pixels(page) - first).max(axis=2) > 12).mean() < 0.001


def test_a_new_size_keeps_the_robot_in_view(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("nao", tmp_path), 1280, 800).page
    page.set_viewport_size({"width": 500, "height": 700})
    settle(page)
    mask = robot_mask(page)
    assert mask.shape == (700, 500)
    assert mask.any()
    assert not np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]]).any()


def test_a_comparison_shows_both_chains(tmp_path: Path, visit: Callable[..., Any]) -> None:
    found = compare(document_chain("thesis_left_arm"), load("nao_v50_h21").chain("left_arm"), samples=50)
    page = visit(export_comparison(tmp_path / "both.html", found, explain=True)).page
    assert page.get_by_text("Orange: thesis_left_arm").is_visible()
    page.get_by_text("Explanation").click()
    assert page.get_by_text("modified convention").first.is_visible()
    picture = pixels(page)
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    assert ((red - blue > 80) & (red - green > 30)).sum() > 300  # orange and red sticks
    assert ((blue - red > 60) & (blue - green > 30)).sum() > 300  # blue ones


def test_the_policy_stops_every_way_out(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("jaco2", tmp_path)).page
    stopped = page.evaluate(
        """async () => {
          const stopped = [];
          document.addEventListener("securitypolicyviolation", (event) => stopped.push(event.effectiveDirective));
          try { await fetch("https://example.org/"); } catch {}
          try { new WebSocket("wss://example.org/"); } catch {}
          const picture = document.createElement("img");
          picture.src = "https://example.org/a.png";
          const script = document.createElement("script");
          script.textContent = "window.hit = 1";
          document.body.append(picture, script);
          document.body.insertAdjacentHTML("beforeend", "<p onclick='window.hit = 1'></p>");
          document.body.lastElementChild.click();
          await new Promise((done) => setTimeout(done, 100));
          return { stopped: [...new Set(stopped)].sort(), hit: window.hit ?? null };
        }"""
    )
    assert stopped["hit"] is None
    assert {"connect-src", "img-src", "script-src-attr", "script-src-elem"} <= set(stopped["stopped"])


def test_a_hostile_robot_is_drawn_and_does_nothing_else(tmp_path: Path, visit: Callable[..., Any]) -> None:
    urdf = tmp_path / "hostile.urdf"
    urdf.write_text(HOSTILE, encoding="utf-8")
    robot = load(urdf)
    path = export_html(tmp_path / "hostile.html", robot)
    visited = visit(path)
    visited.page.get_by_text("Joint values").click()
    visited.page.get_by_text("Not shown").click()
    assert visited.page.locator("h1").inner_text() == robot.name
    assert visited.page.locator("img").count() == 0
    assert visited.page.evaluate("() => window.hit ?? null") is None
    assert robot_mask(visited.page).mean() > 0.01
    assert visited.requests == [path.as_uri()]
    assert (visited.console, visited.errors) == ([], [])


def test_two_robots_in_one_notebook_page(tmp_path: Path, visit: Callable[..., Any]) -> None:
    frames = [show(load(name), height=360)._repr_html_() for name in ("nao", "jaco2")]
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><meta charset=utf-8><body>{''.join(frames)}", encoding="utf-8")
    visited = visit(path, 900, 800, wait=False)
    for frame in visited.page.query_selector_all("iframe"):
        frame.content_frame().wait_for_selector('html[data-state="ready"]', state="attached", timeout=60_000)
    picture = pixels(visited.page)
    for top in (0, 365):
        assert np.ptp(picture[top : top + 340, 320:], axis=(0, 1)).max() > 100
    assert [url for url in visited.requests if url.startswith(("http", "ws"))] == []
    assert (visited.console, visited.errors) == ([], [])


def test_without_webgl_the_numbers_remain(tmp_path: Path, launch: Callable[..., Any]) -> None:
    path = exported("jaco2", tmp_path)
    page = launch("--disable-3d-apis").new_page()
    page.goto(path.as_uri())
    page.wait_for_selector('html[data-state="failed"]', state="attached")
    assert page.locator("#trouble").is_visible()
    page.get_by_text("Joint values").click()
    assert page.locator("tbody tr").count() == len(load("jaco2").joint_names)
