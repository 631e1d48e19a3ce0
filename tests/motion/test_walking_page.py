"""docs/walking.md does what it says."""

from __future__ import annotations

import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

from nao_kin.motion.hexapod.footfall import GAITS, LEGS
from nao_kin.motion.nao.keyframe_file import parse_keyframes
from nao_kin.motion.nao.keyframes import play

PAGE = (Path(__file__).parents[2] / "docs" / "walking.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    (found,) = re.findall(rf"^```{language}\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)
    return str(found)


def test_the_table_of_gaits_is_the_one_that_walks() -> None:
    rows = [
        line.strip("| ").split(" | ") for line in PAGE.splitlines() if line.startswith(tuple(f"| {g} " for g in GAITS))
    ]
    assert [row[0] for row in rows] == list(GAITS)
    for name, duty, *phases, down in rows:
        assert float(Fraction(duty)) == GAITS[name].duty
        assert [float(Fraction(phase)) for phase in phases] == [GAITS[name].lift_off[leg] for leg in LEGS]
        assert int(down) == GAITS[name].down


def test_the_keyframes_play() -> None:
    played = play(parse_keyframes(block("toml")))
    assert played.trajectory is not None, played.message
    assert played.keyframes.name == "nod"


def test_the_python_runs(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", block("python")], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "It can be walked" in done.stdout
