"""What a notebook shows of each type: a table of inert text with units; and as text, one line."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from rich.console import Console

import nao_kin as nk
from nao_kin.table import Column, Table
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

NAME = "<img src=x onerror=alert(1)>"
ESCAPED = "&lt;img src=x onerror=alert(1)&gt;"

URDF = """<robot name="{0}"><link name="{0}"/><link name="a"/><link name="b"/><link name="tip {0}"/>
<joint name="{0}" type="revolute"><parent link="{0}"/><child link="a"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="second {0}" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="third {0}" type="prismatic"><parent link="b"/><child link="tip {0}"/><origin xyz="0.2 0 0"/>
<axis xyz="1 0 0"/><limit lower="0" upper="0.1" velocity="1" effort="1"/></joint></robot>
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("hostile") / "hostile.urdf"
    found.write_text(URDF.format(ESCAPED), encoding="utf-8")
    return found


@pytest.fixture(scope="module")
def model(path: Path) -> nk.Robot:
    return nk.load(str(path))


def chain(model: nk.Robot) -> nk.UrdfChain:
    return model.chain(NAME, f"tip {NAME}")


def table(model: nk.Robot) -> nk.DHChain:
    rows = [{"a": 0.1 * k, "alpha": 0.3, "d": 0.05, "theta": 0.1, "name": f"{k} {NAME}"} for k in range(1, 4)]
    return nk.DHChain.from_table(rows, "modified", name=NAME, base_name=NAME, tip_name=NAME)


def poses(model: nk.Robot) -> np.ndarray:
    return chain(model).poses(np.array([[0.1, 0.2, 0.05], [0.3, -0.2, 0.02]]))


def trajectory(model: nk.Robot) -> Trajectory:
    return Trajectory(chain(model).joints, [0.0, 1.0], np.array([[0.1, 0.2, 0.05], [0.3, -0.2, 0.02]]), NAME)


def leg() -> nk.DHChain:
    """A leg with a closed form, whose joints have names to be afraid of."""
    plain = nk.to_dh(nk.load("phantomx").chain("leg_lf"), "standard")
    rows = tuple(replace(row, name=f"{k} {NAME}") for k, row in enumerate(plain.rows))
    return replace(plain, rows=rows, name=NAME)


KINDS: dict[str, Callable[[nk.Robot], Any]] = {
    "Robot": lambda model: model,
    "UrdfChain": chain,
    "DHChain": table,
    "Tree": lambda model: model.tree(NAME, [f"tip {NAME}"]),
    "IKResult": lambda model: nk.solve(chain(model), poses(model)[0]),
    "TreeResult": lambda model: nk.solve(model.tree(NAME, [f"tip {NAME}"]), {f"tip {NAME}": poses(model)[0]}),
    "BatchResult": lambda model: nk.solve_batch(chain(model), poses(model)),
    "Solutions": lambda _: nk.solve_all(leg(), leg().pose([0.1, 0.2, 0.3]).translation),
    "BatchSolutions": lambda _: nk.solve_all_batch(leg(), leg().poses([[0.1, 0.2, 0.3], [0.2, 0.1, 0.4]])[:, :3, 3]),
    "Comparison": lambda model: nk.compare(table(model), table(model).read_as("standard"), samples=20),
    "Report": lambda model: nk.check(model.document.path),
    "Trajectory": trajectory,
}
"""One of each type that names what a file or a caller has named, all of them hostile."""

OWN: dict[str, Callable[[nk.Robot], Any]] = {
    "FollowResult": lambda model: nk.follow(chain(model), list(poses(model)), [0.1, 0.2, 0.05]),
    "Ledger": lambda _: nk.ledger("000:3.3.0.2"),
    "Judgement": lambda _: nk.ledger("000:3.3.0.2")["000:3.3.0.2"],
}
"""One of each type that shows only words of ours."""

TAGS = {"table", "caption", "thead", "tbody", "tr", "th", "td", "p", "details", "summary"}


class Fragment(HTMLParser):
    """A fragment of HTML, refused unless it is of harmless elements that are closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words = ""
        self.rows = 0
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in TAGS
        assert {name for name, _ in attrs} <= {"style", "scope"}
        self.open.append(tag)
        self.rows += tag == "tr"

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data + "\n"


COUNTS = {"BatchResult", "BatchSolutions", "Report", "Ledger"}
"""Types that count things; the numbers of the others have units."""


@pytest.mark.parametrize("kind", [*KINDS, *OWN])
def test_it_is_a_table_of_inert_text(kind: str, model: nk.Robot) -> None:
    shown = {**KINDS, **OWN}[kind](model)
    assert type(shown).__name__ == kind
    fragment = Fragment(shown._repr_html_())
    assert fragment.rows > 1
    assert (NAME in fragment.words) == (kind in KINDS)
    assert kind in COUNTS or any(unit in fragment.words for unit in ("rad", "[m]", "mm", "unit"))
    text = repr(shown)
    assert (text[0], text[-1]) == ("<", ">")
    assert "array(" not in text
    assert len(text.splitlines()) == (1 + len(shown) if kind == "Solutions" else 1)
    assert max(map(len, text.splitlines())) < 400


def test_a_trajectory_is_told_by_joint(model: nk.Robot) -> None:
    words = Fragment(trajectory(model)._repr_html_()).words
    assert "start [rad or m]" in words
    assert "allowed [rad/s or m/s]" in words
    assert "2 samples over 1 s" in words
    row = words[words.index(f"third {NAME}") :].split("\n")
    assert row[1:7] == ["0.05", "0.02", "0.02", "0.05", "0.03", "1"]


def test_long_tables_are_folded_and_notes_keep_their_lines() -> None:
    rows = tuple((str(k),) for k in range(100))
    long = Table((Column("k"),), rows, title="long <b>", note="a\nb")._repr_html_()
    assert long.startswith("<details><summary")
    assert "long &lt;b&gt; (100 rows)" in long
    assert "white-space:pre-line" in long
    assert Fragment(long).rows == 101
    short = Table((Column("k"),), rows[:5], styles={1: "bad", 2: "faint"})._repr_html_()
    assert "<details" not in short
    assert short.count("<tr style=") == 2


def test_numbers_wider_than_the_terminal_continue_below_under_the_same_names() -> None:
    numbers = tuple(f"{k}.0000" for k in range(10, 24))
    table = Table((Column("joint"), *(Column(f"#{k}", number=True) for k in range(14))), (("LHipYawPitch", *numbers),))
    printed = StringIO()
    Console(width=80, file=printed).print(table)
    lines = printed.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    rows = [line.split() for line in lines if line.startswith("LHipYawPitch ")]
    assert len(rows) > 1
    assert tuple(cell for row in rows for cell in row[1:]) == numbers
