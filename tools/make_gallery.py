"""The gallery's pictures: each the default view of a page that one command writes.

python tools/make_gallery.py                 all of them
python tools/make_gallery.py ur5 talos       some

Needs Chromium and the extra `robots`. The pictures go to docs/gallery, the table to docs/gallery.md.
"""

from __future__ import annotations

import io
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parent.parent
PICTURES: Final = ROOT / "docs" / "gallery"
SIZE: Final = (1280, 800)  # CSS pixels of the window
WIDTH: Final = 880  # pixels of a picture
COLOURS: Final = 256  # enough for shades of a few materials; a third of the bytes
ARGUMENTS: Final = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")


@dataclass(frozen=True, slots=True)
class Picture:
    """One entry of the gallery.

    Attributes:
        name: Of the picture's file.
        shows: What it is, for the table.
        command: Writes the page, to the file that stands for `PAGE`.
        share: Where a motion is shown, the share of it that has been played.
    """

    name: str
    shows: str
    command: str
    share: float = 0.0


GALLERY: Final = (
    Picture("nao", "NAO, all joints on sliders, and where its hand is", "nao-kin html nao --output PAGE"),
    Picture("jaco2", "The Kinova JACO2, drawn from primitives", "nao-kin html jaco2 --output PAGE"),
    Picture("ur5", "A UR5 with every mesh of its file", "nao-kin html ur5 --output PAGE"),
    Picture("talos", "TALOS, its meshes simplified to a page of 5 MB", "nao-kin html talos --output PAGE"),
    Picture("phantomx", "The PhantomX, whose body moves over standing feet", "nao-kin html phantomx --output PAGE"),
    Picture(
        "branches",
        "Every posture of a JACO2 for one pose of its hand, one solid, the others as ghosts",
        "nao-kin ik jaco2 --deg --posture joint_1=60 --posture joint_2=150 --posture joint_3=100 "
        "--posture joint_4=40 --posture joint_5=-50 --posture joint_6=20 --all --html PAGE",
    ),
    Picture(
        "overlay",
        "The thesis' left arm (orange) on the NAO's (blue), the gap in mm, and what accounts for it",
        "nao-kin compare thesis_left_arm --explain --html PAGE",
    ),
    Picture(
        "walk", "A hexapod walking, to play, pause and scrub", "nao-kin html phantomx --gait tripod --output PAGE", 0.5
    ),
    Picture(
        "run",
        "The way of a solver to its target, with the error of each step",
        "nao-kin ik nao --chain left_arm --xyz 0.20 0.12 0.15 --html PAGE",
        1.0,
    ),
    Picture("reach", "Where NAO's left hand can be", "nao-kin workspace nao:left_arm --html PAGE"),
)


def main(names: list[str]) -> int:
    """Draws the pictures named, or all, and writes the table."""
    unknown = set(names) - {picture.name for picture in GALLERY}
    if unknown:
        print(f"no such picture: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        _draw([picture for picture in GALLERY if not names or picture.name in names], Path(folder))
    (ROOT / "docs" / "gallery.md").write_text(table(), encoding="utf-8")
    return 0


def table() -> str:
    """The page of the gallery."""
    rows = [
        f"| ![{picture.shows}](gallery/{picture.name}.png) | {picture.shows} | `{_typed(picture)}` |"
        for picture in GALLERY
    ]
    return "\n".join(
        [
            "# Gallery",
            "",
            "Every picture is a page as it opens, which one command writes: a single file for any browser, without a",
            "server or a network. `python tools/make_gallery.py` draws them again.",
            "",
            "| picture | what it is | command |",
            "|---|---|---|",
            *rows,
            "",
        ]
    )


def _typed(picture: Picture) -> str:
    return picture.command.replace("PAGE", f"{picture.name}.html")


def _draw(pictures: list[Picture], folder: Path) -> None:
    from playwright.sync_api import sync_playwright

    browser_path = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path, args=list(ARGUMENTS))
        for picture in pictures:
            page = folder / f"{picture.name}.html"
            command = shlex.split(picture.command.replace("PAGE", str(page)))
            program = Path(sys.executable).parent / command[0]
            done = subprocess.run([program, *command[1:]], check=False, capture_output=True, text=True)
            if done.returncode == 2:
                raise SystemExit(f"{picture.name}: {done.stderr}")
            (PICTURES / f"{picture.name}.png").write_bytes(_small(_seen(browser, page, picture.share)))
            print(f"{picture.name}: {page.stat().st_size / 1e6:.2f} MB")


def _seen(browser: Any, page: Path, share: float) -> bytes:
    view = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
    view.goto(page.as_uri())
    view.wait_for_selector('html[data-state="ready"]', state="attached", timeout=120_000)
    if share:
        slider = view.locator("#scrub")
        slider.evaluate(
            "(slider, share) => { slider.value = +slider.min + share * (slider.max - slider.min);"
            " slider.dispatchEvent(new Event('input', { bubbles: true })); }",
            share,
        )
    view.wait_for_timeout(1500)  # [ms] shadows and labels come with the second frame
    picture: bytes = view.screenshot()
    view.close()
    return picture


def _small(png: bytes) -> bytes:
    from PIL import Image

    picture = Image.open(io.BytesIO(png)).convert("RGB")
    height = round(picture.height * WIDTH / picture.width)
    smaller = picture.resize((WIDTH, height), Image.Resampling.LANCZOS)
    file = io.BytesIO()
    # By the widest coverage, or the few orange and blue pixels of thin lines would become grey.
    palette = smaller.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
    smaller.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(file, "PNG", optimize=True)
    return file.getvalue()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
