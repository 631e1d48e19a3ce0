"""The commands that move robots, as a script meets them."""

from __future__ import annotations

import json

from tests.test_cli import ok, run


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
    text = ok("walk", "--velocity", 0.6, 0, "--duration", 2, status=1)
    assert "foot lf is too far by" in text
    assert "The fastest walk this way" in text
    data = json.loads(ok("walk", "--velocity", 0.6, 0, "--duration", 2, "--format", "json", status=1))
    assert data["fastest"]["walkable"] is True
    assert 0.05 < data["fastest"]["velocity"][0] < 0.6
    stuck = ok("walk", "--shift", 0, 0, 0.2, "--duration", 2, status=1)
    assert "Not even stepping on the spot" in stuck


def test_walk_misused_is_two() -> None:
    for arguments in (("nao",), ("--gait", "trippod"), ("--cycle", 0), ("--velocity", "nan", 0)):
        done = run("walk", *arguments)
        assert done.returncode == 2
        assert "nao-kin: " in done.stderr
