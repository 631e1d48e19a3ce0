"""Files and notebooks: never half a page, never a lost one."""

from __future__ import annotations

import html
import io
import math
import stat
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.trajectory import Trajectory
from nao_kin.view import export
from nao_kin.view.export import export_html, show
from nao_kin.view.page import page
from nao_kin.view.robot_scene import robot_scene

if TYPE_CHECKING:
    from nao_kin.robot.robot import Robot


def test_the_file_is_the_page(small: Robot, tmp_path: Path) -> None:
    written = export_html(str(tmp_path / "out.html"), small, {"lift": 0.1})
    assert written == tmp_path / "out.html"
    assert written.read_text(encoding="utf-8") == page(robot_scene(small, {"lift": 0.1}))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.html", "small.urdf"]


def test_the_file_has_the_usual_permissions(small: Robot, tmp_path: Path) -> None:
    usual = tmp_path / "usual"
    usual.touch()
    written = export_html(tmp_path / "out.html", small)
    assert stat.S_IMODE(written.stat().st_mode) == stat.S_IMODE(usual.stat().st_mode)


def test_a_wrong_posture_leaves_the_old_file(small: Robot, tmp_path: Path) -> None:
    target = tmp_path / "out.html"
    target.write_text("old")
    with pytest.raises(UnknownNameError):
        export_html(target, small, {"nobody": 1.0})
    assert target.read_text() == "old"


class FullDisk(io.BytesIO):
    def write(self, _: object) -> int:
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("moment", ["write", "replace"])
def test_a_failing_disk_leaves_the_old_file_and_no_rubbish(
    small: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    target = tmp_path / "pages" / "out.html"
    target.parent.mkdir()
    target.write_text("old")

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    if moment == "replace":
        monkeypatch.setattr(export.Path, "replace", fail)
    else:
        real = Path.open

        def opened(self: Path, mode: str = "r", *more: Any, **named: Any) -> Any:
            if mode != "xb":
                return real(self, mode, *more, **named)
            self.touch()
            return FullDisk()

        monkeypatch.setattr(export.Path, "open", opened)
    with pytest.raises(OSError, match="No space left"):
        export_html(target, small)
    assert [p.name for p in target.parent.iterdir()] == ["out.html"]
    assert target.read_text() == "old"


def test_a_link_stays_a_link(small: Robot, tmp_path: Path) -> None:
    real, link = tmp_path / "real.html", tmp_path / "link.html"
    link.symlink_to(real)
    export_html(link, small)
    assert link.is_symlink()
    assert real.read_bytes().startswith(b"<!doctype html>")


def test_a_directory_is_no_target(small: Robot, tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match="directory"):
        export_html(tmp_path, small)


def test_a_missing_directory_is_said(small: Robot, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        export_html(tmp_path / "nowhere" / "out.html", small)


class Frames(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.frames: list[dict[str, str | None]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag == "iframe"
        self.frames.append(dict(attrs))


def test_show_is_one_sandboxed_frame_with_the_whole_page(small: Robot) -> None:
    shown = show(small, {"lift": 0.1}, height=300)
    parser = Frames()
    parser.feed(shown._repr_html_())
    (frame,) = parser.frames
    assert frame["srcdoc"] == page(robot_scene(small, {"lift": 0.1}))
    assert frame["sandbox"] == "allow-scripts"
    assert "height:300px" in str(frame["style"])
    assert frame["title"] == html.escape("small")
    assert len(repr(shown)) < 80


@pytest.mark.parametrize("height", [0, -5, math.nan, math.inf])
def test_show_needs_a_height(small: Robot, height: float) -> None:
    with pytest.raises(InvalidInputError, match="height"):
        show(small, height=height)  # type: ignore[arg-type]


def test_half_a_surrogate_pair_in_a_name_is_shown_as_a_question_mark(small: Robot, tmp_path: Path) -> None:
    postures = {"\ud800up": {"lift": 0.1}, "down": {"lift": 0.0}}
    motion = Trajectory(["lift"], [0.0, 1.0], [[0.0], [0.1]], "\udfffgo")
    for content, produced in ((postures, "2 named postures"), (motion, "?go, 2 samples")):
        text = export_html(tmp_path / "out.html", small, content).read_text(encoding="utf-8")
        assert produced in text
        show(small, content)._repr_html_().encode("utf-8")


def test_a_motion_as_far_as_numbers_go_is_written(small: Robot, tmp_path: Path) -> None:
    motion = Trajectory(["lift"], [0.0, 1e300], [[0.0], [-1e308]])
    assert export_html(tmp_path / "out.html", small, motion).exists()
