"""What a browser makes of an exported page: the robot, in full, and not a word to anybody else."""

from __future__ import annotations

import base64
import json
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from nao_kin.robot.robot import load
from nao_kin.view.export import export_html, show
from nao_kin.view.record import node_paths
from nao_kin.view.robot_scene import robot_scene
from tests.browser.seeing import box_of, pixels, robot_mask, settle, slide, tip_shown

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

HOSTILE = """<robot name="&lt;/script&gt;&lt;script&gt;window.hit=1&lt;/script&gt;">
  <link name="__proto__">
    <visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
    <visual><geometry><mesh filename="spy.dae"/></geometry></visual>
  </link>
  <link name="constructor"><visual><geometry><box size="0.1 0.1 0.3"/></geometry></visual></link>
  <link name="a//b">
    <visual><geometry><mesh filename="&lt;img src=x onerror=window.hit=1&gt;.stl"/></geometry></visual>
  </link>
  <link name="&lt;/script&gt;&lt;script&gt;window.hit=1&lt;/script&gt;"/>
  <joint name="&lt;img src=x onerror=window.hit=1&gt;" type="revolute">
    <parent link="__proto__"/><child link="constructor"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="__proto__" type="continuous">
    <parent link="a//b"/><child link="&lt;/script&gt;&lt;script&gt;window.hit=1&lt;/script&gt;"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="&quot; onmouseover=&quot;window.hit=1" type="fixed">
    <parent link="constructor"/><child link="a//b"/><origin xyz="0 0 0.2"/>
  </joint>
</robot>
"""

SPY = """<?xml version="1.0"?>
<!DOCTYPE COLLADA [<!ENTITY secret SYSTEM "file://{secret}">]>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><contributor><author>&secret;</author></contributor><up_axis>Z_UP</up_axis></asset>
  <library_images><image id="i"><init_from>{secret}</init_from></image></library_images>
</COLLADA>
"""


def exported(name: str, tmp_path: Path) -> Path:
    try:
        robot = load(name)
    except ImportError as error:
        pytest.skip(str(error))
    return export_html(tmp_path / f"{name}.html", robot)


@pytest.mark.parametrize(
    ("name", "width", "height"),
    [
        *(("nao", *size) for size in ((1280, 800), (390, 844), (900, 420))),
        *(("phantomx", *size) for size in ((1280, 800), (390, 844))),
        ("jaco2", 1280, 800),
        ("ur5", 1280, 800),
    ],
)
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
    for cover in ("#card", "#toolbar"):
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


def test_folding_the_panel_gives_the_robot_more_room(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("nao", tmp_path), 390, 844).page
    before = robot_mask(page)
    assert page.get_by_label("HeadYaw", exact=True).is_visible()
    page.locator("#grip").click()
    assert not page.get_by_label("HeadYaw", exact=True).is_visible()
    after = robot_mask(page)
    assert after.sum() > 1.3 * before.sum()
    left, top, right, bottom = box_of(page, "#card")
    assert not after[top:bottom, left:right].any()


def test_the_view_can_be_turned_and_put_back(tmp_path: Path, visit: Callable[..., Any]) -> None:
    page = visit(exported("jaco2", tmp_path)).page
    first = pixels(page)
    page.mouse.move(700, 400)
    page.mouse.down()
    page.mouse.move(820, 430, steps=4)
    page.mouse.up()
    assert (np.abs(pixels(page) - first).max(axis=2) > 12).mean() > 0.01
    page.locator("#frame").click()
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
    secret = tmp_path / "secret.txt"
    secret.write_text("open sesame", encoding="utf-8")
    (tmp_path / "spy.dae").write_text(SPY.format(secret=secret), encoding="utf-8")
    urdf = tmp_path / "hostile.urdf"
    urdf.write_text(HOSTILE, encoding="utf-8")
    robot = load(urdf)
    path = export_html(tmp_path / "hostile.html", robot)
    text = path.read_text(encoding="utf-8")
    packed = json.loads(text.split('id="scene">')[1].split("</script>")[0])["deflated"]
    for part in ("open sesame", "secret.txt"):
        assert part not in text
        assert part.encode() not in zlib.decompress(base64.b64decode(packed))
    visited = visit(path)
    page = visited.page
    page.get_by_text("Notes").click()
    for switch in ("x", "a", "l", "b"):
        page.keyboard.press(switch)
    page.evaluate("() => { document.querySelector('#j0').value = 0.5; }")
    page.locator("#j0").dispatch_event("input")
    assert page.evaluate("() => naoKin.state.values") == [0.5, 0.0]
    assert page.locator("h1").inner_text() == robot.name
    assert page.locator("img").count() == 0
    assert page.evaluate("() => window.hit ?? null") is None
    assert page.evaluate("() => ({}).label ?? null") is None  # nothing was written to the prototype of objects
    assert [page.locator(f"#tip-frame option >> nth={k}").inner_text() for k in range(4)] == [
        node.label for node in robot_scene(robot).nodes
    ]
    assert robot_mask(page).mean() > 0.01
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
    jaco2 = load("jaco2")
    slide(page, "#j1", 2.0)
    assert page.locator(".joint").count() == len(jaco2.joint_names)
    expected = jaco2.pose({**jaco2.neutral, "joint_2": 2.0}, "end_effector").translation
    np.testing.assert_allclose(tip_shown(page)[:3], expected, rtol=0, atol=1e-6)
