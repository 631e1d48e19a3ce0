"""The trials of the check, in small: mutants and seeded defects; the commands in tools/ run them in full."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.conftest import needs_examples

TOOLS = Path(__file__).parent.parent.parent / "tools"


def lines_of(*command: object) -> str:
    done = subprocess.run(
        [sys.executable, *map(str, command)], capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_500_mutants_break_no_promise() -> None:
    text = lines_of(TOOLS / "fuzz_check.py", "--mutants", 500, "--seed", 8)
    assert "broken promises               0" in text


def test_200_files_of_every_version_are_read_as_pinocchio_reads_them() -> None:
    text = lines_of(TOOLS / "compare_versions.py", "--files", 200, "--seed", 5)
    assert "different from Pinocchio      0" in text


def test_a_round_of_defects_is_found() -> None:
    needs_examples()
    text = lines_of(TOOLS / "seed_defects.py", "--defects", 61, "--seed", 3, "--robots", 14)
    assert "61 = 100.0 %" in text
