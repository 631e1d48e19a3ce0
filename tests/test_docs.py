"""The README and the documentation do what they say: every command and every code block runs."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import nao_kin as nk
from nao_kin.bench import bench

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


COMMANDS = [
    command for line in README.splitlines() if line.startswith("| ") for command in re.findall(r"`(nao-kin .+?)`", line)
]


def test_the_readmes_benchmarks_exist() -> None:
    asked = {shlex.split(command)[2] for command in COMMANDS if command.startswith("nao-kin bench")}
    assert asked == {command.name or command.callback.__name__ for command in bench.registered_commands}


@pytest.mark.parametrize("command", [c for c in COMMANDS if "bench" not in c])
def test_the_readmes_commands_run(command: str, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "nao_kin", *shlex.split(command)[1:]]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    verdict = 1 if "thesis" in command else 0  # a table that disagrees is a finding, not a failure
    assert done.returncode == verdict, done.stdout + done.stderr


def test_the_readmes_python_runs(tmp_path: Path) -> None:
    for block in blocks(README, "python"):
        done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "pose.html").is_file()


def test_the_readmes_table_is_what_the_demo_prints(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-m", "nao_kin", "demo"], cwd=tmp_path, capture_output=True, text=True)
    printed = [line.split() for line in done.stdout.splitlines()]
    (shown,) = blocks(README, "text")
    for line in shown.splitlines():
        assert line.split() in printed, line


def test_the_readmes_make_targets_exist() -> None:
    makefile = (ROOT / "Makefile").read_text()
    for block in blocks(README, "sh"):
        for target in re.findall(r"^make (\w+)", block, flags=re.MULTILINE):
            assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE)


def test_links_and_pictures_exist() -> None:
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_documented_table_loads(tmp_path: Path) -> None:
    (text,) = blocks((ROOT / "docs" / "dh-table.md").read_text(encoding="utf-8"), "toml")
    path = tmp_path / "table.toml"
    path.write_text(text, encoding="utf-8")
    table = nk.DHChain.from_file(path)
    assert table.joint_names == ("shoulder", "joint_2")
    assert (table.base_name, table.tip_name) == ("torso", "hand")


def test_the_documented_comparisons_run(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "dh-table.md").read_text(encoding="utf-8")
    printed = ""
    for block in blocks(page, "python"):
        done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        printed += done.stdout
    (shown,) = blocks(page, "text")
    for line in shown.splitlines()[1:]:  # the first one says how far rounding goes
        assert line in printed.splitlines()


def test_the_documented_guard_stops_where_it_says(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "motion.md").read_text(encoding="utf-8")
    (block,), (shown,) = blocks(page, "python"), blocks(page, "text")
    done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout == shown, done.stderr


def test_the_documented_peer_compiles() -> None:
    (block,) = blocks((ROOT / "docs" / "streaming.md").read_text(encoding="utf-8"), "python")
    names: dict[str, object] = {}
    exec(block, names)  # noqa: S102 - our own page
    assert callable(names["nod"])


def test_the_version_is_said_once() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == nk.__version__
