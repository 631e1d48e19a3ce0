"""A file is replaced whole or not at all."""

from __future__ import annotations

import os
import resource
import signal
import stat
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.replacing import replace_file
from nao_kin.trajectory.files.reading import write_trajectory
from tests.conftest import robot

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def write_motion(path: Path) -> None:
    write_trajectory(path, nk.Trajectory(["a"], np.arange(1000), np.zeros((1000, 1))))


def write_map(path: Path) -> None:
    nk.reachability(robot("jaco2").chain("arm"), 5000).save(path)


@pytest.mark.parametrize(
    ("write", "name"),
    [(lambda path: replace_file(path, bytes(1000)), "a"), (write_motion, "a.csv"), (write_map, "a.npz")],
)
def test_what_does_not_fit_on_the_disk_leaves_the_old_file(
    write: Callable[[Path], object], name: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_text("old")
    write(tmp_path / f"other-{name}")  # whatever is compiled on the way is there now
    limits, action = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
        with pytest.raises(OSError, match="too large"):
            write(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, action)
    assert path.read_text() == "old"
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted([name, f"other-{name}"])


def test_permissions_are_passed_on(tmp_path: Path) -> None:
    path = tmp_path / "mine"
    path.touch(mode=0o600)
    assert replace_file(path, b"new") == path
    assert (stat.S_IMODE(path.stat().st_mode), path.read_bytes()) == (0o600, b"new")


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    replace_file(pipe, b"through")
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    assert pipe.is_fifo()
