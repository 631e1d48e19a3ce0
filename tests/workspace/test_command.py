"""`nao-kin workspace` and `nao-kin bench reach`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from typer.testing import CliRunner

import nao_kin as nk
from nao_kin.cli.app import application
from tests.conftest import robot

if TYPE_CHECKING:
    from pathlib import Path


def run(*arguments: object) -> str:
    done = CliRunner().invoke(application([str(arguments[0])]), [str(a) for a in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_it_prints_saves_and_draws_what_the_library_says(tmp_path: Path) -> None:
    files = ("--save", tmp_path / "reach.npz", "--html", tmp_path / "reach.html", "--picture", tmp_path / "reach.png")
    told = json.loads(run("workspace", "nao:left_arm", "--samples", 5000, "--seed", 3, *files, "--format", "json"))
    reach = nk.reachability(robot("nao").chain("left_arm"), 5000, seed=3)
    assert told["volume"] == reach.volume
    assert told["extent"] == reach.extent.tolist()
    assert told["greatest"] == reach.greatest.max()
    assert nk.ReachMap.load(tmp_path / "reach.npz").same_as(reach)
    assert "Reach of LArm in torso" in (tmp_path / "reach.html").read_text(encoding="utf-8")
    assert (tmp_path / "reach.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_has_a_map_too(tmp_path: Path) -> None:
    text = run("workspace", "practicum_jaco2", "--samples", 2000, "--html", tmp_path / "reach.html")
    assert "2000 (random, seed 0)" in text
    assert (tmp_path / "reach.html").is_file()


@pytest.mark.filterwarnings("default")
def test_bench_reach_is_plain_data() -> None:
    asked = ("--configurations", 20_000, "--rounds", 1, "--no-goals", "--format", "json")
    data = json.loads(run("bench", "reach", *asked))
    assert [row["chain"] for row in data["maps"]] == ["nao_v50_h25 left_arm", "nao_v50_h25 right_arm"]
    assert all(row["configurations"] == 10_000 and row["ratio"] > 0.0 for row in data["maps"])
    assert [goal["what"] for goal in data["goals"] if not goal["met"] and "times" not in goal["what"]] == []
