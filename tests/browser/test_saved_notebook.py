"""A notebook saved as HTML: its tables and its scenes stay, without a kernel and without a network."""

from __future__ import annotations

import io
import warnings
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any

import nbformat
import numpy as np
import pytest
from PIL import Image

from tests.conftest import needs

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # jupyter's own deprecations
    from nbclient import NotebookClient

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CELLS = (
    """import numpy as np
import nao_kin as nk
from nao_kin.trajectory import Trajectory
robot = nk.load("nao")
arm = robot.chain("left_arm")
table = nk.document_chain("kofinas_left_arm")
q = [0.3, 0.2, -0.5, -0.8, 0.4]
target = arm.pose(q)""",
    "robot",
    "arm",
    "table",
    'robot.tree("torso", ["LArm", "RArm"])',
    "nk.solve(arm, target)",
    "nk.solve_batch(arm, arm.poses([q, q]))",
    "nk.solve_all(arm, target)",
    "nk.solve_all_batch(arm, arm.poses([q, q]))",
    "nk.follow(arm, [target], q)",
    "nk.compare(table, arm)",
    'nk.check("nao")',
    'nk.ledger("000:3.3.0.2")',
    'nk.ledger("000:3.3.0.2")["000:3.3.0.2"]',
    'Trajectory(arm.joints, [0.0, 1.0], np.array([q, np.zeros(5)]), "wave")',
    "nk.show(robot)",
    'nk.show(nk.load("jaco2"))',
)
TABLES = len(CELLS) - 3


class Parts(HTMLParser):
    """How many tables a page has outside of its frames, and how many frames."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables, self.frames = 0, 0
        self.feed(text)

    def handle_starttag(self, tag: str, _: list[tuple[str, str | None]]) -> None:
        self.tables += tag == "table"
        self.frames += tag == "iframe"


@pytest.fixture
def saved(this_kernel: None, tmp_path: Path) -> Path:
    """The notebook, run in a fresh kernel and saved as HTML; what nbconvert would load from the network is left out."""
    nbconvert = needs("nbconvert")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in CELLS])
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    exporter = nbconvert.HTMLExporter(mathjax_url="", require_js_url="", jquery_url="", embed_images=True)
    text, _ = exporter.from_notebook_node(notebook)
    found = tmp_path / "saved.html"
    found.write_text(text, encoding="utf-8")
    return found


def pixels(element: Any) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(element.screenshot())).convert("RGB"), dtype=np.int16)


@pytest.mark.filterwarnings("default")
def test_tables_and_scenes_stay_and_share_nothing(saved: Path, visit: Callable[..., Any]) -> None:
    parts = Parts(saved.read_text(encoding="utf-8"))
    assert (parts.tables, parts.frames) == (TABLES, 2)
    visited = visit(saved, wait=False)
    elements = visited.page.query_selector_all("iframe")
    frames = [element.content_frame() for element in elements]
    pictures = []
    for element, frame in zip(elements, frames, strict=True):
        element.scroll_into_view_if_needed()  # a browser draws only what can be seen
        frame.wait_for_selector('html[data-state="ready"]', state="attached", timeout=120_000)
        pictures.append(pixels(element))
        assert pictures[-1].std(axis=(0, 1)).min() > 10.0  # not blank
    assert [frame.evaluate("document.title") for frame in frames] == ["nao_v50_h25", "jaco2"]
    assert np.abs(pictures[0] - pictures[1]).mean() > 1.0  # each its own robot
    for frame in frames:
        assert frame.evaluate("() => { try { return parent.document.title; } catch { return 'closed'; } }") == "closed"
    frames[0].evaluate("() => { window.mark = 1; }")
    assert frames[1].evaluate("() => typeof window.mark") == "undefined"
    assert [url for url in visited.requests if not url.startswith(("file:", "about:", "data:", "blob:"))] == []
    assert visited.errors == []
