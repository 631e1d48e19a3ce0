"""The page's own forward kinematics against Pinocchio's, read from the page while its sliders move."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.se3 import from_xyz_rpy
from tests.browser.seeing import drive, slide, tip, tip_shown
from tests.conftest import robot

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

EVERY_KIND = """<robot name="every">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="tip"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="a"/><origin xyz="0.1 -0.2 0.3" rpy="0.3 -0.4 1.2"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-2" upper="1.5" velocity="1" effort="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="a"/><child link="b"/><origin xyz="0 0.1 0.2" rpy="1 0 -0.7"/><axis xyz="0 -0.6 0.8"/>
    <limit lower="-0.1" upper="0.3" velocity="1" effort="1"/>
  </joint>
  <joint name="spin" type="continuous">
    <parent link="b"/><child link="c"/><origin xyz="0.2 0 0" rpy="0 0.5 0"/><axis xyz="1 2 2"/>
  </joint>
  <joint name="a_follower" type="revolute">
    <parent link="c"/><child link="d"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
    <mimic joint="turn" multiplier="-0.5" offset="0.2"/>
    <limit lower="-3" upper="3" velocity="1" effort="1"/>
  </joint>
  <joint name="slide_along" type="prismatic">
    <parent link="d"/><child link="e"/><origin xyz="0 0.1 0"/><axis xyz="1 0 0"/>
    <mimic joint="lift" multiplier="2"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="flange" type="fixed"><parent link="e"/><child link="tip"/><origin xyz="0.1 0.2 0.3" rpy="1 2 3"/></joint>
</robot>
"""


def read(page: Any, model: nk.Robot, posture: dict[str, float], base: str, frame: str) -> None:
    """Holds what is drawn and what is printed against Pinocchio."""
    expected = model.pose(posture, frame, base)
    np.testing.assert_allclose(tip(page), expected.homogeneous, rtol=0, atol=1e-12)
    x, y, z, *angles = tip_shown(page)
    np.testing.assert_allclose([x, y, z], expected.translation, rtol=0, atol=1e-6)
    shown = from_xyz_rpy((0, 0, 0), np.radians(angles)).rotation
    np.testing.assert_allclose(shown, expected.rotation, rtol=0, atol=3e-5)  # three decimals of a degree


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx"])
def test_sliders_move_the_tip_by_what_pinocchio_says(
    name: str, tmp_path: Path, visit: Callable[..., Any], rng: np.random.Generator
) -> None:
    model = robot(name)
    page = visit(nk.export_html(tmp_path / "out.html", model)).page
    posture = dict(model.neutral)
    for index, (base, frame) in enumerate(model.chain_frames.values()):
        page.locator("#chain").select_option(str(index))
        chain = model.chain(base, frame)
        for q in random_configurations(chain, 4, rng):
            moved = dict(zip(chain.joint_names, q.tolist(), strict=True))
            posture |= moved
            drive(page, model.joint_names, moved)
            read(page, model, model.expand(moved | {k: v for k, v in posture.items() if k in moved}), base, frame)


def test_every_kind_of_joint_and_its_followers(
    tmp_path: Path, visit: Callable[..., Any], rng: np.random.Generator
) -> None:
    urdf = tmp_path / "every.urdf"
    urdf.write_text(EVERY_KIND, encoding="utf-8")
    model = nk.load(urdf)
    page = visit(nk.export_html(tmp_path / "out.html", model)).page
    frames = page.locator("#base option").all_inner_texts()
    for _ in range(8):
        posture = {
            "turn": float(rng.uniform(-2, 1.5)),
            "lift": float(rng.uniform(-0.1, 0.3)),
            "spin": float(rng.uniform(-math.pi, math.pi)),
        }
        drive(page, model.joint_names, posture)
        base, frame = rng.choice(frames, 2)
        page.locator("#base").select_option(label=base)
        page.locator("#tip-frame").select_option(label=frame)
        read(page, model, posture, str(base), str(frame))
    drive(page, model.joint_names, {"a_follower": 0.4})  # moves its leader
    values = dict(zip(model.joint_names, page.evaluate("() => naoKin.state.values"), strict=True))
    assert values["turn"] == pytest.approx((0.4 - 0.2) / -0.5, abs=1e-15)
    assert page.get_by_text("follows turn").is_visible()


def test_a_coupled_limit_moves_the_joint_it_limits_along(tmp_path: Path, visit: Callable[..., Any]) -> None:
    nao = robot("nao")
    page = visit(nk.export_html(tmp_path / "out.html", nao)).page
    (rule,) = [rule for rule in nao.limit_rules if rule.joint == "HeadPitch"]
    drive(page, nao.joint_names, {"HeadPitch": 0.5, "HeadYaw": 1.5})
    values = dict(zip(nao.joint_names, page.evaluate("() => naoKin.state.values"), strict=True))
    assert values["HeadPitch"] == pytest.approx(rule.range(1.5)[1], abs=1e-12)
    assert page.get_by_text("its range depends on HeadYaw").is_visible()
    drive(page, nao.joint_names, {"HeadPitch": 0.5})  # not beyond it
    assert page.evaluate("(k) => naoKin.state.values[k]", nao.joint_names.index("HeadPitch")) == values["HeadPitch"]


def test_numbers_are_typed_in_the_unit_shown_and_refused_beyond_the_range(
    tmp_path: Path, visit: Callable[..., Any]
) -> None:
    nao = robot("nao")
    page = visit(nk.export_html(tmp_path / "out.html", nao)).page
    value = f"() => naoKin.state.values[{nao.joint_names.index('HeadYaw')}]"
    field = page.get_by_label("HeadYaw, value")
    field.fill("30")
    field.press("Enter")
    assert page.evaluate(value) == pytest.approx(math.radians(30), abs=1e-15)
    field.fill("500")
    field.press("Enter")
    assert page.get_by_text("Not set: it may be −119.5 to 119.5 °.").is_visible()
    assert page.evaluate(value) == pytest.approx(math.radians(30), abs=1e-15)
    page.locator("#units").click()
    assert field.input_value() == "0.5236"
    field.fill("-1.25")
    field.press("Enter")
    assert page.evaluate(value) == -1.25


def test_a_posture_goes_out_and_comes_back(tmp_path: Path, visit: Callable[..., Any]) -> None:
    nao = robot("nao")
    visited = visit(nk.export_html(tmp_path / "out.html", nao))
    page = visited.page
    page.evaluate("() => { navigator.clipboard.writeText = () => Promise.reject(new Error('blocked')); }")
    drive(page, nao.joint_names, {"LShoulderPitch": 0.123456789012345, "LHipYawPitch": -0.4})
    page.locator("#copy").click()
    copied = json.loads(page.locator("#posture-text").input_value())
    assert copied == {**nao.neutral, "LShoulderPitch": 0.123456789012345, "LHipYawPitch": -0.4, "RHipYawPitch": -0.4}
    page.keyboard.press("Escape")
    page.locator("#reset-posture").click()
    assert page.evaluate("() => naoKin.state.values") == list(nao.neutral.values())
    page.locator("#paste").click()
    page.locator("#posture-text").fill('{"HedYaw": 1, "HeadPitch": "low", "LHipYawPitch": 0, "RHipYawPitch": 1}')
    page.get_by_role("button", name="Apply").click()
    told = page.locator("#posture-errors").inner_text()
    for part in ("no joint HedYaw", "HeadPitch: low is not a number", "RHipYawPitch follows LHipYawPitch"):
        assert part in told
    page.locator("#posture-text").fill("{")
    page.get_by_role("button", name="Apply").click()
    assert "not JSON" in page.locator("#posture-errors").inner_text()
    page.locator("#posture-text").fill(json.dumps(copied))
    page.get_by_role("button", name="Apply").click()
    assert page.evaluate("() => naoKin.state.values") == list(copied.values())
    assert (visited.console, visited.errors) == ([], [])


def test_a_posture_outside_its_limits_is_shown_as_it_is_and_says_so(tmp_path: Path, visit: Callable[..., Any]) -> None:
    jaco2 = robot("jaco2")
    page = visit(nk.export_html(tmp_path / "out.html", jaco2, {"joint_2": 0.1})).page
    assert page.evaluate("() => naoKin.state.values[1]") == 0.1
    assert page.get_by_text("Outside its limits.").first.is_visible()
    slide(page, "#j1", 1.0)
    assert not page.locator("#joints").get_by_text("Outside its limits.").nth(1).is_visible()
