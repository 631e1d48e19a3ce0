"""The commands that move robots, as a script meets them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from nao_kin.trajectory.files.reading import read_trajectory
from tests.conftest import robot
from tests.test_cli import ok, run

if TYPE_CHECKING:
    from pathlib import Path


def test_walk_reports_what_the_walk_is() -> None:
    text = ok("walk", "--gait", "ripple", "--duration", 2)
    assert "It can be walked" in text
    data = json.loads(ok("walk", "phantomx", "--turn", 0.2, "--duration", 2, "--format", "json"))
    assert data["walkable"] is True
    assert data["gait"] == "tripod"
    assert data["feet_down"] == 3
    assert data["slip"] < 1e-9
    assert data["refused"] == []
    assert set(data["joint_speed_share"]) == {
        f"j_{part}_{leg}" for part in ("c1", "thigh", "tibia") for leg in ("lf", "lm", "lr", "rf", "rm", "rr")
    }


def test_walk_refuses_with_leg_time_amount_and_the_speed_that_can() -> None:
    text = ok("walk", "--velocity", 0.6, 0, "--duration", 1, status=1)
    assert "foot lf is too far by" in text
    assert "The fastest walk this way" in text
    data = json.loads(ok("walk", "--shift", 0, 0, 0.2, "--duration", 1, "--format", "json", status=1))
    assert data["walkable"] is False
    assert data["fastest"]["walkable"] is False
    assert {refusal["unit"] for refusal in data["refused"]} <= {"m", "rad/s", "rad"}


def test_walk_and_play_write_trajectories_that_read_back(tmp_path: Path) -> None:
    ok("walk", "--duration", 1, "--output", tmp_path / "walk.csv")
    walk = read_trajectory(tmp_path / "walk.csv")
    assert len(walk.joints) == 18
    assert walk.velocities.max() <= 5.6548668
    ok("play", "wave", "--output", tmp_path / "wave.json")
    wave = read_trajectory(tmp_path / "wave.json")
    assert wave.duration == 4.0
    assert not any(robot("nao").outside_limits(wave.posture(i)) for i in range(0, len(wave), 20))


def test_play_prints_the_keyframes_and_refuses_what_cannot_be_played(tmp_path: Path) -> None:
    assert "within all limits" in ok("play", "wave")
    path = tmp_path / "fast.toml"
    path.write_text(
        'robot = "nao"\nangles = "rad"\n[posture.a]\nHeadYaw = 2.0\n[[keyframe]]\nposture = "a"\ntime = 0.1\n'
    )
    text = ok("play", path, status=1)
    assert "HeadYaw is too fast by" in text
    data = json.loads(ok("play", path, "--format", "json", status=1))
    assert data["playable"] is False
    assert data["refused"][0]["what"] == "HeadYaw"
    path.write_text("angles = 3")
    done = run("play", path)
    assert done.returncode == 2
    assert f"{path}:1: angles" in done.stderr


def test_walk_misused_is_two() -> None:
    for arguments in (("nao",), ("--gait", "trippod"), ("--cycle", 0), ("--velocity", "nan", 0)):
        done = run("walk", *arguments)
        assert done.returncode == 2
        assert "nao-kin: " in done.stderr
