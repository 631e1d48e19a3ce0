"""`nao-kin trajectory` as a person or a script meets it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from typer.testing import CliRunner

import nao_kin as nk
from nao_kin.cli.app import application
from nao_kin.cli.trajectory_command import curve, headline
from nao_kin.trajectory.trajectory import Trajectory
from tests.test_cli import run

if TYPE_CHECKING:
    from pathlib import Path

APP = application(["trajectory"])
FROM = [
    word
    for joint, degrees in enumerate([180, 200, 120, 100, 80, 30], start=1)
    for word in ("--from", f"joint_{joint}={degrees}")
]


def ok(*words: object, status: int = 0) -> str:
    """What a command prints, in this process: a new one for each would take longer than all the rest."""
    done = CliRunner().invoke(APP, list(map(str, words)), catch_exceptions=False)
    assert done.exit_code == status, done.output
    if "json" not in words:
        assert max(map(len, done.stdout.splitlines()), default=0) <= 80
    return done.stdout


def plan(*more: object, status: int = 0) -> str:
    return ok("trajectory", "plan", "jaco2", "--deg", *FROM, *more, status=status)


def test_plan_run_and_show(tmp_path: Path) -> None:
    file = tmp_path / "line.txt"
    text = plan("--xyz", 0.3, -0.2, 0.7, "--output", file)
    assert "samples are reached" in text
    motion = nk.read_trajectory(file)
    arm = nk.load("jaco2").chain("arm")
    np.testing.assert_allclose(arm.pose(motion.q[-1]).translation, [0.3, -0.2, 0.7], atol=1e-6)
    shown = ok("trajectory", "show", file)
    assert "█" in shown
    assert "joint_6" in shown
    ran = ok("trajectory", "run", file, "jaco2")
    assert "(0.3000 -0.2000 0.7000)" in ran
    assert "Every joint stays within its range and its speed." in ran
    data = json.loads(ok("trajectory", "run", file, "jaco2:arm", "--format", "json"))
    assert data["possible"] is True
    assert data["off_the_line"] < 1e-6
    assert data["tip_speed"] <= 0.1 + 1e-9
    assert json.loads(ok("trajectory", "show", file, "--format", "json"))["samples"] == len(motion)


def test_every_way_of_getting_there(tmp_path: Path) -> None:
    posture = ("--to", "joint_1=170", "--to", "joint_2=205", "--to", "joint_3=115", "--to", "joint_4=100")
    rest = ("--to", "joint_5=80", "--to", "joint_6=30")
    for by, form in (("line", "csv"), ("screw", "json"), ("joints", "txt")):
        file = tmp_path / f"{by}.{form}"
        data = json.loads(plan(*posture, *rest, "--by", by, "--output", file, "--format", "json"))
        assert data["completed"] is True
        found = nk.read_trajectory(file)
        np.testing.assert_allclose(found.q[-1], np.radians([170, 205, 115, 100, 80, 30]), atol=1e-5)
        assert data["duration"] == found.duration
    pose = ("--xyz", 0.45, -0.15, 0.85, "--rpy", -45, 30, -40)
    assert json.loads(plan(*pose, "--by", "joints", "--format", "json"))["faults"] == []


def test_what_cannot_be_done_exits_with_1_and_writes_nothing(tmp_path: Path) -> None:
    file = tmp_path / "none.txt"
    text = plan("--xyz", 2, 0, 0.5, "--output", file, status=1)
    assert "no such motion" in text
    assert "ample" in text
    assert not file.exists()
    far = json.loads(plan("--xyz", 2, 0, 0.5, "--by", "joints", "--format", "json", status=1))
    assert far["completed"] is False
    hasty = ("--xyz", 0.3, -0.2, 0.7, "--speed", 5, "--acceleration", 50)
    text = plan(*hasty, "--no-scale", "--output", file, status=1)
    assert "needs a speed of" in text
    assert not file.exists()
    assert "times as long as was asked" in " ".join(plan(*hasty, "--output", file).split())
    assert "Every joint stays" in ok("trajectory", "run", file, "jaco2")


def test_a_file_that_the_robot_cannot_run(tmp_path: Path) -> None:
    joints = nk.load("jaco2").chain("arm").joints
    q = np.tile(np.radians([180, 200, 120, 100, 80, 30]), (3, 1))
    q[1, 1] = 0.0
    path = nk.write_trajectory(tmp_path / "wild.json", Trajectory(joints, [0, 1, 2], q))
    text = ok("trajectory", "run", path, "jaco2", status=1)
    assert "At sample 1 joint_2 = 0 is outside [0.820305, 5.46288]" in " ".join(text.split())
    assert "joint_2 needs a speed of 3.491 at sample 1" in " ".join(text.split())
    assert "joint_2 is outside its own range" in " ".join(ok("trajectory", "show", path, status=1).split())
    with pytest.raises(nk.NaoKinError, match="There is no joint 'LShoulderPitch'"):
        ok("trajectory", "run", path, "nao:left_arm")
    bad = tmp_path / "bad.txt"
    bad.write_text("# time [s], a [rad]\n0 1\n1 nan\n")
    done = run("trajectory", "show", bad)
    assert done.returncode == 2
    assert f"{bad}:3: column 2: a [rad]: expected a finite number, got 'nan'." in done.stderr


@pytest.mark.parametrize(
    "more",
    [
        (),
        ("--xyz", 0.3, 0, 0.5, "--by", "wing"),
        ("--xyz", 0.3, 0, 0.5, "--to", "joint_1=0"),
        ("--rpy", 0, 0, 0, "--to", "joint_1=0"),
        ("--xyz", 0.3, 0, 0.5, "--by", "screw"),
    ],
)
def test_usage(more: tuple[object, ...]) -> None:
    done = CliRunner().invoke(APP, list(map(str, ("trajectory", "plan", "jaco2", *more))))
    assert done.exit_code == 2
    assert done.stderr


@pytest.mark.parametrize(
    ("more", "named"),
    [
        (("--to", "joint_9=0"), "joint_9"),
        (("--xyz", 0.3, 0, 0.5, "--speed", 0), "speed"),
        (("--xyz", 0.3, 0, 0.5, "--output", "line.yaml"), "line.yaml"),
        (("--xyz", 0.3, 0, 0.5, "--sampling", "nan"), "sampling"),
    ],
)
def test_bad_input_is_named(more: tuple[object, ...], named: str) -> None:
    with pytest.raises(nk.NaoKinError, match=named):
        ok("trajectory", "plan", "jaco2", *more)


def test_curves_and_long_names() -> None:
    assert curve(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 8) == "▁▂▃▄▅▆▇█"
    assert curve(np.array([0.0]), np.array([3.0]), 4) == "▁▁▁▁"
    assert headline(Trajectory(["a"], [1.0], [[0.0]], "still")) == "still: 1 sample, 0 s"
