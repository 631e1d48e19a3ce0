"""What can be seen and read of a page in the browser, and how its sliders are moved."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["box_of", "drive", "number", "pixels", "robot_mask", "settle", "slide", "slide_all", "tip", "tip_shown"]


def settle(page: Any) -> None:
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def pixels(page: Any) -> NDArray[np.int16]:
    settle(page)
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=np.int16)


def robot_mask(page: Any) -> NDArray[np.bool_]:
    """Where the picture changes when the robot disappears; the ground, and so the shadow, is left out."""
    hide = "(name) => { naoKin.viewer.set_property([name], 'visible', false); naoKin.viewer.set_dirty(); }"
    page.evaluate(hide, "ground")
    seen = pixels(page)
    page.evaluate(hide, "robot")
    mask = np.abs(seen - pixels(page)).max(axis=2) > 12
    page.evaluate("() => { for (const n of ['ground', 'robot']) naoKin.viewer.set_property([n], 'visible', true); }")
    return mask


def box_of(page: Any, selector: str) -> tuple[int, int, int, int]:
    box = page.locator(selector).bounding_box()
    left, top = int(box["x"]), int(box["y"])
    return left, top, left + int(box["width"]) + 1, top + int(box["height"]) + 1


def slide(page: Any, selector: str, value: float) -> None:
    """Moves a slider as a person would, to a value in full digits."""
    slide_all(page, {selector: value})


def slide_all(page: Any, sliders: Mapping[str, float]) -> None:
    """The same for several sliders, one after the other."""
    page.evaluate(
        """(sliders) => {
          for (const [selector, value] of sliders) {
            const slider = document.querySelector(selector);
            slider.value = value;
            slider.dispatchEvent(new Event("input", { bubbles: true }));
          }
        }""",
        [[selector, repr(float(value))] for selector, value in sliders.items()],
    )


def drive(page: Any, names: tuple[str, ...], posture: Mapping[str, float]) -> None:
    """Moves the sliders of joints by name; `names` are the page's joints in order."""
    slide_all(page, {f"#j{names.index(name)}": value for name, value in posture.items()})


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


def tip_shown(page: Any) -> list[float]:
    """x, y, z [m] and roll, pitch, yaw [deg] as the page prints them."""
    return [number(page.locator(f"#tip-{name}").inner_text()) for name in ("x", "y", "z", "roll", "pitch", "yaw")]


def tip(page: Any) -> NDArray[np.float64]:
    """T_base_tip (4, 4) as the page has it, of the objects drawn where there is a picture."""
    numbers = page.evaluate(
        """() => {
          const { tip, viewer } = naoKin;
          const path = (index) => {
            const node = naoKin.state.scene.nodes[index];
            return [...(node.parent < 0 ? ["robot"] : path(node.parent)), `n${index}`];
          };
          const drawn = tip.ends.map((index) => viewer.scene_tree.find(path(index)).object);
          drawn.forEach((object) => object.updateWorldMatrix(true, false));
          return drawn[0].matrixWorld.clone().invert().multiply(drawn[1].matrixWorld).elements;
        }"""
    )
    return np.array(numbers).reshape(4, 4).T
