"""The layers of the package as pictures, drawn from the import contract in pyproject.toml, which is the only list.

    python tools/layers.py      write docs/images/layers.svg, and the blocks in CONTRIBUTING.md, docs/architecture.md

Each line of the contract carries its sentence as a comment; nothing about layers is said anywhere else.
"""

from __future__ import annotations

import html
import re
import textwrap
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
PICTURE: Final = ROOT / "docs" / "images" / "layers.svg"
PAGES: Final = (ROOT / "CONTRIBUTING.md", ROOT / "docs" / "architecture.md")
BEGIN, END = "<!-- layers -->", "<!-- /layers -->"
_WIDEST: Final = 44
"""Characters of the longest row of names in the text block."""


@dataclass(frozen=True)
class Layer:
    """One line of the contract: siblings that do not see each other, and what they are."""

    names: tuple[str, ...]
    sentence: str


def layers() -> tuple[Layer, ...]:
    """The layers from the top down.

    Raises:
        ValueError: A layer has no sentence.
    """
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    contracts = tomllib.loads(text)["tool"]["importlinter"]["contracts"]
    found = []
    for line in contracts[0]["layers"]:
        comment = re.search(rf'^ *"{re.escape(line)}", *# (.+)$', text, flags=re.MULTILINE)
        if comment is None:
            raise ValueError(f"the layer {line!r} of pyproject.toml says nothing about itself")
        names = tuple(name.strip() for name in line.split("|"))
        found.append(Layer(names, comment.group(1)))
    return tuple(found)


def as_text() -> str:
    """The layers as lines of at most 120 characters, names to the left, sentences to the right."""
    lines = []
    for layer in layers():
        first, *more = textwrap.wrap(layer.sentence, 119 - _WIDEST)
        lines += [f"{' | '.join(layer.names):<{_WIDEST}} {first}", *(" " * (_WIDEST + 1) + line for line in more)]
    return "\n".join(lines)


def as_svg() -> str:
    """The layers as boxes on shelves; whoever stands higher may reach down."""
    width, high, gap, left = 920, 34, 12, 26
    shelves = []
    for row, layer in enumerate(layers()):
        y = 16 + row * (high + gap)
        each = (420 - gap * (len(layer.names) - 1)) / len(layer.names)
        for column, name in enumerate(layer.names):
            x = left + column * (each + gap)
            shelves.append(
                f'<rect x="{x:.0f}" y="{y}" width="{each:.0f}" height="{high}" rx="5" class="room"/>'
                f'<text x="{x + each / 2:.0f}" y="{y + 22}" class="name">{html.escape(name)}</text>'
            )
        for k, line in enumerate(textwrap.wrap(layer.sentence, 66)[:2]):
            lift = 22 if len(layer.sentence) <= 66 else 15 + 15 * k
            shelves.append(f'<text x="{left + 436}" y="{y + lift}" class="says">{html.escape(line)}</text>')
    height = 16 + len(layers()) * (high + gap) + 6
    style = (
        "text{font-family:DejaVu Sans,Verdana,sans-serif}.room{fill:#eef3fa;stroke:#34567c}"
        ".name{font-size:13px;text-anchor:middle;fill:#12283f}.says{font-size:12px;fill:#333}.down{stroke:#34567c;stroke-width:2}"
    )
    arrow = (
        f'<path class="down" d="M10 20 V{height - 24}" fill="none"/>'
        f'<path d="M5 {height - 26} L10 {height - 14} L15 {height - 26} Z" fill="#34567c"/>'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'aria-label="The layers of nao_kin"><style>{style}</style>'
        f'<rect width="{width}" height="{height}" fill="#fff"/>{arrow}{"".join(shelves)}</svg>\n'
    )


def with_block(page: str) -> str:
    """A page with the text block in it written anew."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n\n```text\n{as_text()}\n```\n\n{END}{after}"


def write() -> None:
    """Writes the picture and the blocks."""
    PICTURE.write_text(as_svg(), encoding="utf-8")
    for page in PAGES:
        page.write_text(with_block(page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    write()
