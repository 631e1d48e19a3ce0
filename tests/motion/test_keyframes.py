"""Keyframes: curves that are what they are called, limits kept all along, and files refused by line."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from nao_kin.errors import InvalidInputError, KeyframeFileError, UnknownNameError
from nao_kin.motion.nao.keyframe_file import EXAMPLE, Keyframe, Keyframes, parse_keyframes, read_keyframes
from nao_kin.motion.nao.keyframes import Played, play
from tests.conftest import robot

if TYPE_CHECKING:
    from pathlib import Path

TIMES = np.array([0.0, 0.7, 1.0, 2.5, 2.9, 4.0])
GOOD = """\
robot = "nao"
angles = "deg"
between = "cubic"

[posture.low]
LShoulderPitch = 80
LElbowRoll = -20

[posture.high]
LShoulderPitch = -30

[[keyframe]]
posture = "low"
time = 0.0

[[keyframe]]
posture = "high"
time = 1.5
"""


def random_keys(rng: np.random.Generator, between: str, too_fast: str = "refuse", pace: float = 1.0) -> Keyframes:
    """Six random postures of a NAO's left arm, well inside its ranges."""
    arm = robot("nao").chain("left_arm")
    middle, half = 0.5 * (arm.lower + arm.upper), 0.5 * (arm.upper - arm.lower)
    rows = middle + 0.3 * half * rng.uniform(-1.0, 1.0, (len(TIMES), 5))
    postures = {f"p{i}": dict(zip(arm.joint_names, row.tolist(), strict=True)) for i, row in enumerate(rows)}
    keys = tuple(Keyframe(float(pace * t), f"p{i}") for i, t in enumerate(TIMES))
    return Keyframes(robot("nao"), "random", postures, keys, between, too_fast, 0.001)  # type: ignore[arg-type]


def at_keys(played: Played) -> np.ndarray:
    """Samples at the instants of the keyframes (k, n)."""
    samples = [int(np.flatnonzero(played.attempt.times == time)[0]) for time in played.times]
    return np.asarray(played.attempt.q[samples])


@pytest.mark.parametrize("between", ["cubic", "stop"])
def test_every_keyframe_is_met_exactly(between: str, rng: np.random.Generator) -> None:
    keys = random_keys(rng, between)
    played = play(keys)
    arm = [played.attempt.joint_names.index(name) for name in robot("nao").chain("left_arm").joint_names]
    wanted = [list(keys.postures[key.posture].values()) for key in keys.keys]
    assert at_keys(played)[:, arm] == pytest.approx(np.array(wanted), abs=1e-12)
    still = [k for k in range(len(played.attempt.joints)) if k not in arm]
    assert not np.ptp(played.attempt.q[:, still], axis=0).any()
    assert played.attempt.q[0, still].tolist() == [robot("nao").neutral[played.attempt.joint_names[k]] for k in still]


def test_the_cubic_is_the_clamped_spline(rng: np.random.Generator) -> None:
    """Its properties make it: cubic between keys, smooth to the second derivative, at rest at both ends."""
    played = play(random_keys(rng, "cubic"))
    times, q = played.attempt.times, played.attempt.q
    first, second = [], []
    for start, end in itertools.pairwise(TIMES):
        inside = (times >= start) & (times <= end)
        fits = [np.polynomial.Polynomial.fit(times[inside], column, 3) for column in q[inside].T]
        residual = max(np.abs(fit(times[inside]) - column).max() for fit, column in zip(fits, q[inside].T, strict=True))
        assert residual < 1e-12
        for found, order in ((first, 1), (second, 2)):
            found.append([[fit.deriv(order)(t) for t in (start, end)] for fit in fits])
    first_, second_ = np.array(first), np.array(second)  # (segments, joints, two ends)
    assert np.abs(first_[1:, :, 0] - first_[:-1, :, 1]).max() < 1e-9
    assert np.abs(second_[1:, :, 0] - second_[:-1, :, 1]).max() < 1e-8
    assert np.abs(first_[0, :, 0]).max() < 1e-9
    assert np.abs(first_[-1, :, 1]).max() < 1e-9


def test_stopping_comes_to_rest_together_and_stays_between_the_postures(rng: np.random.Generator) -> None:
    played = play(random_keys(rng, "stop"))
    times, q, keys = played.attempt.times, played.attempt.q, at_keys(played)
    for k, (start, end) in enumerate(itertools.pairwise(TIMES)):
        inside = (times >= start) & (times <= end)
        move = keys[k + 1] - keys[k]
        moving = np.abs(move) > 1e-6
        share = (q[inside][:, moving] - keys[k, moving]) / move[moving]
        assert np.ptp(share, axis=1).max() < 1e-9  # synchronised
        assert share.min() >= 0.0
        assert share.max() <= 1.0
        assert np.abs(np.diff(share[:3], axis=0)).max() < 1e-4
        assert np.diff(share[:, 0]).max() / 0.001 * (end - start) == pytest.approx(1.875, abs=0.01)


@pytest.mark.parametrize("between", ["cubic", "stop"])
def test_too_fast_is_refused_or_slowed_down_as_asked(between: str, rng: np.random.Generator) -> None:
    hurried = random_keys(rng, between, pace=0.1)
    refused = play(hurried)
    assert refused.trajectory is None
    assert {refusal.reason for refusal in refused.refused} <= {"too fast", "below its range", "above its range"}
    assert any(refusal.reason == "too fast" for refusal in refused.refused)
    assert "slow" in refused.message
    slowed = play(Keyframes(**{**_fields(hurried), "too_fast": "slow"}))
    assert not any(refusal.reason == "too fast" for refusal in slowed.refused)
    assert slowed.times[-1] > hurried.keys[-1].time
    limits = np.array([joint.max_velocity for joint in slowed.attempt.joints])
    share = np.abs(slowed.attempt.velocities) / limits
    assert 0.99 < share.max() <= 1.0 + 1e-12
    if between == "stop":  # every move takes as little time as it may, and no move takes more
        for k, (start, end) in enumerate(itertools.pairwise(slowed.times)):
            inside = (slowed.attempt.times[:-1] >= start) & (slowed.attempt.times[1:] <= end)
            asked = hurried.keys[k + 1].time - hurried.keys[k].time
            assert share[inside].max() > 0.99 or end - start == pytest.approx(asked)
            assert end - start >= asked * (1.0 - 1e-12)
    else:  # the same curve, run through more slowly
        stretch = slowed.times[-1] / hurried.keys[-1].time
        assert slowed.times == pytest.approx(stretch * refused.times)
        refused_q = np.array(
            [np.interp(slowed.attempt.times / stretch, refused.attempt.times, c) for c in refused.attempt.q.T]
        )
        assert np.abs(refused_q.T - slowed.attempt.q).max() < 1e-3


def _fields(keys: Keyframes) -> dict[str, object]:
    return {name: getattr(keys, name) for name in keys.__slots__}


def test_what_is_fast_enough_is_not_slowed_down(rng: np.random.Generator) -> None:
    for between in ("cubic", "stop"):
        played = play(random_keys(rng, between, "slow", pace=5.0))
        assert played.times == pytest.approx(5.0 * TIMES, abs=0.0)
        assert played.trajectory is not None, played.message


def test_a_curve_that_swings_out_of_range_is_refused_and_stopping_helps() -> None:
    """The elbow's range ends at −0.0349 rad: two equal keys near it make a cubic overshoot."""
    postures = {"bent": {"LElbowRoll": -1.2}, "straight": {"LElbowRoll": -0.036}}
    keys = tuple(Keyframe(t, name) for t, name in ((0.0, "bent"), (0.5, "straight"), (0.7, "straight"), (1.5, "bent")))
    cubic = play(Keyframes(robot("nao"), "", postures, keys))
    (refusal,) = cubic.refused
    assert (refusal.what, refusal.reason) == ("LElbowRoll", "above its range")
    assert 0.5 < refusal.worst < 0.7
    assert "stop" in cubic.message
    assert play(Keyframes(robot("nao"), "", postures, keys, "stop")).trajectory is not None


def test_coupled_limits_hold_along_the_way_and_not_only_at_the_keys() -> None:
    """Both postures are within the head's coupled range, which is narrower between them."""
    postures = {"left": {"HeadYaw": 1.0, "HeadPitch": -0.44}, "ahead": {"HeadYaw": 0.0, "HeadPitch": -0.67}}
    keys = (Keyframe(0.0, "left"), Keyframe(2.0, "ahead"))
    played = play(Keyframes(robot("nao"), "", postures, keys, "stop"))
    for posture in postures.values():
        assert not robot("nao").outside_limits(robot("nao").complete(posture))
    refused = [refusal for refusal in played.refused if "HeadPitch (as HeadYaw stands)" in refusal.what]
    beyond = [bool(robot("nao").outside_limits(played.attempt.posture(i))) for i in range(len(played.attempt))]
    assert bool(refused) == any(beyond)
    wide = {"left": {"HeadYaw": 1.0, "HeadPitch": -0.6}, "ahead": postures["ahead"]}
    (found,) = play(Keyframes(robot("nao"), "", wide, keys, "stop")).refused
    assert found.what == "HeadPitch (as HeadYaw stands)"
    assert found.amount == pytest.approx(0.6 - 0.4555, abs=2e-3)


def test_a_follower_moves_its_leader_and_the_start_is_held_until_named() -> None:
    postures = {"in": {"RHipYawPitch": -0.3}, "out": {"LHipYawPitch": 0.0, "HeadYaw": 0.5}}
    keys = (Keyframe(1.0, "in"), Keyframe(2.0, "out"))
    played = play(Keyframes(robot("nao"), "", postures, keys), {"HeadYaw": 0.2})
    assert played.times.tolist() == [0.0, 1.0, 2.0]
    assert "RHipYawPitch" not in played.attempt.joint_names
    values = at_keys(played)[:, [played.attempt.joint_names.index(n) for n in ("LHipYawPitch", "HeadYaw")]]
    assert values == pytest.approx(np.array([[0.0, 0.2], [-0.3, 0.2], [0.0, 0.5]]))
    with pytest.raises(UnknownNameError, match="HeadYaw"):
        play(Keyframes(robot("nao"), "", postures, keys), {"HeadYow": 0.2})


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"keys": ()}, "keyframes"),
        ({"keys": (Keyframe(1.0, "a"), Keyframe(1.0, "a"))}, "keyframes"),
        ({"keys": (Keyframe(-1.0, "a"),)}, "keyframes"),
        ({"keys": (Keyframe(math.nan, "a"),)}, "times"),
        ({"keys": (Keyframe(0.0, "aa"),)}, "no posture"),
        ({"between": "linear"}, "between"),
        ({"too_fast": "never"}, "too_fast"),
        ({"sample_time": 0.0}, "sample_time"),
    ],
)
def test_keyframes_made_by_hand_are_checked_too(fields: dict[str, object], said: str) -> None:
    good = {"robot": robot("nao"), "name": "", "postures": {"a": {"HeadYaw": 0.1}}, "keys": (Keyframe(0.0, "a"),)}
    with pytest.raises((InvalidInputError, UnknownNameError), match=said):
        Keyframes(**{**good, **fields})  # type: ignore[arg-type]


def test_one_keyframe_is_a_motion_too() -> None:
    played = play(Keyframes(robot("nao"), "", {"a": {"HeadYaw": 0.1}}, (Keyframe(0.0, "a"),)))
    assert played.trajectory is not None
    assert len(played.attempt) == 1
    assert played.attempt.posture(0)["HeadYaw"] == 0.1


def test_the_example_plays_and_the_file_reads_back_in_radians() -> None:
    played = play(read_keyframes(EXAMPLE))
    assert played.trajectory is not None, played.message
    assert played.keyframes.name == "wave"
    assert played.keyframes.postures["raised"]["RShoulderPitch"] == math.radians(-50)
    assert "wave" in played._repr_html_()
    with pytest.raises(TypeError, match="trajectory"):
        bool(played)


def test_the_robot_may_be_another_one(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    path.write_text(GOOD, encoding="utf-8")
    assert read_keyframes(path).robot.name == "nao_v50_h25"
    assert read_keyframes(path, robot("nao_v33_h21")).robot.name == "nao_v33_h21"


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ('robot = "nao"', 'robot = "noa"', 1, "Did you mean 'nao'"),
        ('robot = "nao"', 'robot = "/etc/passwd"', 1, "no known robot"),
        ('robot = "nao"', "robot = 3", 1, "no known robot"),
        ('robot = "nao"', "", None, "robot is missing"),
        ('angles = "deg"', "", None, "angles is missing"),
        ('angles = "deg"', 'angles = "grad"', 2, "rad or deg"),
        ('between = "cubic"', 'between = "linear"', 3, "cubic or stop"),
        ('between = "cubic"', "between = [1]", 3, "cubic or stop"),
        ('between = "cubic"', 'betwen = "cubic"', 3, "did you mean 'between'"),
        ('between = "cubic"', "sample_time = 0", 3, "sample_time"),
        ('between = "cubic"', "sample_time = 1e-9", 3, "sample_time"),
        ('between = "cubic"', "name = 7", 3, "expected text"),
        ("LShoulderPitch = 80", "LShoulderPich = 80", 6, "LShoulderPitch"),
        ("LShoulderPitch = 80", 'LShoulderPitch = "80"', 6, "finite number"),
        ("LShoulderPitch = 80", "LShoulderPitch = true", 6, "finite number"),
        ("LShoulderPitch = 80", "LShoulderPitch = nan", 6, "finite number"),
        ("LShoulderPitch = 80", "LShoulderPitch = -inf", 6, "finite number"),
        ("LShoulderPitch = 80", f"LShoulderPitch = 1{'0' * 400}", 6, "finite number"),
        ("LShoulderPitch = 80", "LShoulderPitch = [80]", 6, "finite number"),
        ("LShoulderPitch = 80", "LShoulderPitch = 200", 6, "outside"),
        ("LElbowRoll = -20", "LHipYawPitch = 1\nRHipYawPitch = 2", 5, "follows"),
        ('posture = "high"', 'posture = "hgih"', 17, "Did you mean 'high'"),
        ('posture = "high"', "posture = 5", 17, "no posture"),
        ('posture = "high"', "postur = 5", 17, "did you mean 'posture'"),
        ("time = 1.5", "", 16, "time missing"),
        ("time = 1.5", "time = nan", 18, "finite number"),
        ("time = 1.5", "time = -1.0", 18, "0 to 3600"),
        ("time = 1.5", "time = 1e9", 18, "0 to 3600"),
        ("time = 1.5", "time = 0.0", 18, "or more after"),
        ("time = 1.5", "time = 1e-300", 18, "or more after"),
        ("time = 1.5", "time = ", 18, "not TOML"),
        ("[posture.high]", "[posture.low]", 9, "not TOML"),
    ],
)
def test_a_bad_file_is_refused_with_line_and_reason(old: str, new: str, line: int | None, said: str) -> None:
    assert GOOD.count(old) == 1
    with pytest.raises(KeyframeFileError, match=said.replace("'", "['\"]")) as caught:
        parse_keyframes(GOOD.replace(old, new))
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('robot = "nao"\nangles = "rad"\n', "at least one table"),
        ('robot = "nao"\nangles = "rad"\nposture = 3\n', "at least one table"),
        ('robot = "nao"\nangles = "rad"\n[posture]\na = 3\n', "expected joints and values"),
        ('robot = "nao"\nangles = "rad"\n[posture.a]\n', "at least one .*keyframe"),
        ('robot = "nao"\nangles = "rad"\nkeyframe = 3\n[posture.a]\n', "at least one .*keyframe"),
        ('robot = "nao"\nangles = "rad"\nkeyframe = [3]\n[posture.a]\n', "expected a table"),
        ("a = " + "[" * 5000, "nested too deeply|not TOML"),
    ],
)
def test_what_is_no_file_of_keyframes_says_so(text: str, said: str) -> None:
    with pytest.raises(KeyframeFileError, match=said):
        parse_keyframes(text)


def test_too_many_keyframes_are_refused() -> None:
    keys = "".join(f'[[keyframe]]\nposture = "a"\ntime = {k}\n' for k in range(1001))
    with pytest.raises(KeyframeFileError, match="at most 1000"):
        parse_keyframes('robot = "nao"\nangles = "rad"\n[posture.a]\n' + keys)


def test_sliding_joints_need_a_unit_of_length(tmp_path: Path) -> None:
    urdf = tmp_path / "slide.urdf"
    urdf.write_text(
        '<robot name="slide"><link name="a"/><link name="b"/><joint name="j" type="prismatic"><parent link="a"/>'
        '<child link="b"/><axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint></robot>'
    )
    from nao_kin.robot.robot import load

    text = 'angles = "rad"\n[posture.out]\nj = 200\n[[keyframe]]\nposture = "out"\ntime = 1.0\n'
    with pytest.raises(KeyframeFileError, match="lengths"):
        parse_keyframes(text, load(urdf))
    played = play(parse_keyframes('lengths = "mm"\n' + text, load(urdf)))
    assert played.attempt.q[-1] == pytest.approx([0.2])
    with pytest.raises(KeyframeFileError, match="outside"):
        parse_keyframes('lengths = "m"\n' + text, load(urdf))


def test_unreadable_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(KeyframeFileError, match="no such file"):
        read_keyframes(tmp_path / "none.toml")
    with pytest.raises(KeyframeFileError, match="not a regular file"):
        read_keyframes(tmp_path)
    (tmp_path / "big.toml").write_bytes(b"#" * (1 << 21))
    with pytest.raises(KeyframeFileError, match="larger than"):
        read_keyframes(tmp_path / "big.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(KeyframeFileError, match="not UTF-8"):
        read_keyframes(tmp_path / "bytes.toml")


@pytest.mark.parametrize("number", ["0x" + "f" * 6000, "9" * 6000, f"[1, [0o{'7' * 6000}]]"])
@pytest.mark.parametrize("key", ["robot", "angles", "sample_time"])
def test_a_whole_number_that_python_does_not_print_is_refused(key: str, number: str) -> None:
    with pytest.raises(KeyframeFileError, match="too many digits"):
        parse_keyframes(f"{key} = {number}")
