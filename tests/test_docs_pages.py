"""Every code block of the documentation's pages runs, in the order of the page; what a page shows as printed is."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

import nao_kin as nk

ROOT = Path(__file__).parent.parent
PAGES = sorted((ROOT / "docs").glob("*.md"))
MADE = {"benchmarks.md", "changes.md"}  # written by tools/bench_page.py, and a copy of the changelog
EXECUTED = {"python", "sh", "toml", "yaml"}
SHOWN = {"text"}
DIRECTIVES = re.compile(r"\{(toctree|include|eval-rst|literalinclude)\}.*")


class Block(NamedTuple):
    language: str
    text: str


def blocks(page: Path) -> list[Block]:
    found = re.findall(r"^```(.*?)\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return [Block(*pair) for pair in found]


def of(language: str) -> list[Path]:
    return [page for page in PAGES if page.name not in MADE and any(b.language == language for b in blocks(page))]


def folder_of_a_user(folder: Path) -> None:
    """What the pages' commands speak of."""
    sample = ROOT / "tests" / "checks" / "data" / "sample.urdf"
    (folder / "urdf").mkdir()
    for name in ("my_robot.urdf", "urdf/my_robot.urdf"):
        shutil.copy(sample, folder / name)
    table = nk.to_dh(nk.load("jaco2").chain("arm"), "modified")
    (folder / "my_arm.toml").write_text(table.to_toml(), encoding="utf-8")


def test_every_block_says_what_it_is() -> None:
    for page in PAGES:
        for block in blocks(page):
            known = block.language in EXECUTED | SHOWN or DIRECTIVES.fullmatch(block.language)
            assert known, f"{page.name}: {block}"


@pytest.mark.parametrize("page", of("python"), ids=lambda page: page.stem)
def test_the_python_runs_and_prints_what_is_shown(page: Path, tmp_path: Path) -> None:
    folder_of_a_user(tmp_path)
    program = "\n".join(block.text for block in blocks(page) if block.language == "python")
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    printed = {" ".join(line.split()) for line in done.stdout.splitlines()}
    for block in blocks(page):
        if block.language == "text":
            # The first line of an explanation says how far rounding goes, which differs between processors.
            lines = [" ".join(line.split()) for line in block.text.splitlines() if not line.startswith("Agrees to")]
            assert [line for line in lines if line and line not in printed] == []


@pytest.mark.parametrize("page", of("sh"), ids=lambda page: page.stem)
def test_the_commands_run(page: Path, tmp_path: Path) -> None:
    folder_of_a_user(tmp_path)
    for block in blocks(page):
        for line in block.text.splitlines() if block.language == "sh" else ():
            program, *words = shlex.split(line, comments=True)
            if program == "nao-kin" and words[0] != "bench":
                words = [sys.executable, "-m", "nao_kin", *words]
                done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
                assert done.returncode in (0, 1), f"{line}\n{done.stderr}"
            else:
                assert_known(program, words)


def assert_known(program: str, words: list[str]) -> None:
    """A command that is too long or too much for a test is at least one that exists."""
    if program == "nao-kin":
        done = subprocess.run(
            [sys.executable, "-m", "nao_kin", *words, "--help"], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    elif program == "make":
        assert re.search(rf"^{words[0]}:", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    elif program == "python":
        named = [word for word in words if "/" in word]
        assert named
        assert all((ROOT / word.partition("::")[0]).exists() for word in named)
    else:
        assert program == "pip"


@pytest.mark.parametrize("page", [*of("toml"), *of("yaml")], ids=lambda page: page.stem)
def test_the_files_shown_are_well_formed(page: Path) -> None:
    for block in blocks(page):
        if block.language == "toml":
            assert tomllib.loads(block.text)
        elif block.language == "yaml":
            assert yaml.safe_load(block.text)
