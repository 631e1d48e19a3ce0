"""Switches, keys, colours, sizes and paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from tests.browser.seeing import box_of, pixels, settle
from tests.conftest import robot

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray


@pytest.fixture
def page(tmp_path: Path, visit: Callable[..., Any]) -> Any:
    visited = visit(nk.export_html(tmp_path / "nao.html", robot("nao")), 900, 640)
    yield visited.page
    assert (visited.console, visited.errors) == ([], [])


def different(picture: NDArray[np.int16], other: NDArray[np.int16]) -> NDArray[np.bool_]:
    return np.abs(picture - other).max(axis=2) > 12


def test_switches_show_and_hide_what_they_name(page: Any) -> None:
    before = pixels(page)
    for key in ("x", "a", "l", "g", "b"):
        page.keyboard.press(key)
        assert different(pixels(page), before)[60:, 370:].sum() > 300, key
        page.keyboard.press(key)
        assert different(pixels(page), before).sum() < 50, key


def test_the_menu_lists_the_switches(page: Any) -> None:
    page.locator("#view summary").click()
    labels = page.locator(".menu label").all_inner_texts()
    assert [label.split("\n")[0] for label in labels] == [
        "frames",
        "joint axes",
        "joint names",
        "ground",
        "collision shapes",
    ]
    page.locator("#labels").check()
    settle(page)
    assert page.locator(".label.name >> visible=true").count() > 5
    page.mouse.click(700, 500)
    assert not page.locator(".menu").is_visible()


def test_keys_of_a_text_field_are_its_own(page: Any) -> None:
    field = page.get_by_label("HeadYaw, value")
    field.fill("")
    field.press_sequentially("ground")
    assert field.input_value() == "ground"
    assert page.evaluate("() => naoKin.viewer.scene_tree.find(['ground']).object.visible")


def test_help_units_and_reset_by_key(page: Any) -> None:
    page.keyboard.press("?")
    assert page.locator("#help").is_visible()
    page.keyboard.press("Escape")
    page.keyboard.press("u")
    assert page.locator("#units").inner_text() == "rad"
    page.locator("#j0").focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("() => naoKin.state.values[0]") > 0
    page.keyboard.press("r")
    assert page.evaluate("() => naoKin.state.values[0]") == 0


def test_dark_follows_the_reader_and_the_switch(tmp_path: Path, browser: Any) -> None:
    path = nk.export_html(tmp_path / "nao.html", robot("nao"))
    context = browser.new_context(viewport={"width": 600, "height": 400}, color_scheme="dark")
    page = context.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector('html[data-state="ready"]', state="attached")
    corner = lambda: pixels(page)[2, -2].mean()  # noqa: E731
    assert corner() < 80
    page.keyboard.press("t")
    assert corner() > 200
    context.close()


def test_at_phone_width_nothing_hangs_over_the_edge(tmp_path: Path, visit: Callable[..., Any]) -> None:
    arm = robot("jaco2").chain("arm")
    times = np.linspace(0, 1, 5)
    trajectory = nk.Trajectory(arm.joints, times, np.tile([0, 3, 3, 0, 0, 0], (5, 1)) + times[:, None] * 0.1)
    page = visit(nk.export_html(tmp_path / "out.html", robot("jaco2"), trajectory), 390, 844).page
    for selector in ("#card", "#toolbar", "#player"):
        left, top, right, bottom = box_of(page, selector)
        assert 0 <= left < right <= 391, selector
        assert 0 <= top < bottom <= 845, selector
    assert page.evaluate("() => document.documentElement.scrollWidth") == 390
    assert page.evaluate(
        "() => document.getElementById('scroll').scrollWidth <= document.getElementById('scroll').clientWidth"
    )


def test_paper_has_a_picture_and_every_joint(page: Any) -> None:
    page.evaluate("() => window.dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    picture = page.locator("#paper")
    picture.wait_for(state="visible")
    assert page.evaluate("(image) => image.decode().then(() => image.naturalWidth)", picture.element_handle()) > 300
    assert page.get_by_label("RWristYaw, value").is_visible()
    assert not page.locator("#toolbar").is_visible()
    page.emulate_media(media="screen")
    page.evaluate("() => window.dispatchEvent(new Event('afterprint'))")
    assert page.locator("#paper").count() == 0
    assert not page.get_by_label("RWristYaw, value").is_visible()
