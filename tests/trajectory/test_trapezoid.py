"""Laws of profiles, and ruckig beside them, whose jerk is infinite here."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from nao_kin.errors import InvalidInputError
from nao_kin.trajectory.synchrony import synchronised
from nao_kin.trajectory.trapezoid import Trapezoid
from tests.conftest import needs


def cases(count: int, seed: int, *, at_speed: bool = True) -> list[dict[str, float]]:
    """Moves at random, short and long, either way, from and to rest or speed; every seventh goes nowhere."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        v_max = rng.uniform(0.1, 2.0)
        speeds = rng.uniform(-v_max, v_max, 2) * (at_speed and k % 4 > 0, at_speed and k % 4 > 1)
        distance = 0.0 if k % 7 == 0 else rng.uniform(-3, 3) * 10.0 ** rng.uniform(-6, 0.5)
        start = rng.uniform(-2, 2)
        found.append(
            {
                "start": start,
                "end": start + distance,
                "max_velocity": v_max,
                "acceleration": rng.uniform(0.1, 5.0),
                "braking": rng.uniform(0.1, 5.0),
                "start_velocity": speeds[0],
                "end_velocity": speeds[1],
                "start_time": rng.uniform(-1, 5),
            }
        )
    return found


def planned(case: dict[str, float], **more: Any) -> Trapezoid:
    start, end = case["start"], case["end"]
    return Trapezoid(start, end, **{k: v for k, v in case.items() if k not in ("start", "end")}, **more)


def ruckigs_duration(*columns: dict[str, float]) -> float:
    """The least duration [s] that ruckig finds for axes together; its limits have signs, ours the direction's."""
    ruckig, n = needs("ruckig"), len(columns)
    given = ruckig.InputParameter(n)
    forward = [case["end"] >= case["start"] for case in columns]
    given.current_position = [case["start"] for case in columns]
    given.target_position = [case["end"] for case in columns]
    given.current_velocity = [case["start_velocity"] for case in columns]
    given.target_velocity = [case["end_velocity"] for case in columns]
    given.max_velocity = [case["max_velocity"] for case in columns]
    up = [case["acceleration"] if ahead else case["braking"] for case, ahead in zip(columns, forward, strict=True)]
    down = [case["braking"] if ahead else case["acceleration"] for case, ahead in zip(columns, forward, strict=True)]
    given.max_acceleration, given.min_acceleration = up, [-a for a in down]
    given.max_jerk = [math.inf] * n
    found = ruckig.Trajectory(n)
    assert ruckig.Ruckig(n).calculate(given, found) in (ruckig.Result.Working, ruckig.Result.Finished)
    return float(found.duration)


def test_ten_thousand_durations_equal_ruckigs() -> None:
    apart = [abs(planned(case).duration - ruckigs_duration(case)) for case in cases(10_000, 1)]
    assert max(apart) < 1e-6


def test_several_axes_take_as_long_as_ruckig_has_them_take() -> None:
    drawn = cases(6000, 2)
    for count in (2, 3, 5):
        for k in range(0, 1500, count):
            axes = drawn[k : k + count]
            names = [name for name in axes[0] if name != "start_time"]
            profiles = synchronised(**{name: [axis[name] for axis in axes] for name in names})
            durations = [profile.duration for profile in profiles]
            assert max(durations) - min(durations) < 1e-9
            assert durations[0] == pytest.approx(ruckigs_duration(*axes), abs=1e-6)


@pytest.mark.parametrize("seed", [3, 4])
def test_position_is_the_integral_of_velocity_and_velocity_that_of_acceleration(seed: int) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(3)  # exact for the quadratics at hand
    for case in cases(400, seed):
        profile = planned(case)
        for a, b in zip(profile.phase_times[:-1], profile.phase_times[1:], strict=True):
            t, h = (a + b) / 2 + (b - a) / 2 * nodes, (b - a) / 2
            travelled = h * weights @ profile.velocity(t)
            assert profile.position(b) - profile.position(a) == pytest.approx(travelled, abs=1e-9)
            gained = h * weights @ profile.acceleration_at(t)
            assert profile.velocity(b) - profile.velocity(a) == pytest.approx(gained, abs=1e-9)


def test_limits_are_never_exceeded_and_ends_are_exact() -> None:
    for case in cases(1000, 5):
        profile = planned(case)
        t = np.concatenate([profile.phase_times, np.linspace(profile.start_time, profile.end_time, 101)])
        assert (np.abs(profile.velocity(t)) <= case["max_velocity"]).all()
        rates = profile.direction * profile.acceleration_at(t)
        assert rates.max() <= case["acceleration"]
        assert rates.min() >= -case["braking"]
        assert profile.position(profile.start_time) == case["start"]
        assert profile.position(profile.end_time) == case["end"] == profile.position(profile.end_time + 1.0)
        assert profile.velocity(profile.start_time) == pytest.approx(case["start_velocity"], abs=1e-12)
        assert profile.velocity(profile.end_time) == pytest.approx(case["end_velocity"], abs=1e-12)
        assert profile.velocity(profile.start_time - 0.1) == 0.0 == profile.velocity(profile.end_time + 0.1)


def test_position_has_no_steps() -> None:
    for case in cases(500, 6):
        profile = planned(case)
        for t in profile.phase_times:
            around = profile.position([t - 1e-9, t + 1e-9])
            assert abs(around[1] - around[0]) < 2e-9 * case["max_velocity"] + 1e-12


def test_nothing_is_faster() -> None:
    """A brute force: coarse time grids of admissible accelerations never cover more distance in less time."""
    rng = np.random.default_rng(7)
    for case in cases(200, 8, at_speed=False):
        profile = planned(case)
        distance, n = abs(case["end"] - case["start"]), 200
        step = profile.duration / n
        for _ in range(5):
            rates = rng.uniform(-case["braking"], case["acceleration"], n)
            v = np.clip(np.cumsum(rates) * step, -case["max_velocity"], case["max_velocity"])
            # Braking to rest at the end bounds the speed at every moment.
            left = profile.duration - step * np.arange(1, n + 1)
            v = np.minimum(v, case["braking"] * left)
            assert v.sum() * step <= distance * (1 + 2 / n) + 1e-12


@pytest.mark.parametrize("longer", [1.0, 1.0001, 1.7, 40.0])
def test_a_longer_move_takes_exactly_as_long_as_asked(longer: float) -> None:
    for case in cases(300, 9, at_speed=False):
        shortest = planned(case)
        profile = planned(case, duration=shortest.duration * longer)
        assert profile.duration == pytest.approx(shortest.duration * longer, rel=1e-12)
        assert abs(profile.peak_velocity) <= abs(shortest.peak_velocity) * (1 + 1e-12)
        t = np.array(profile.phase_times[1:3])
        np.testing.assert_allclose(profile.position(t - 1e-9), profile.position(t + 1e-9), atol=1e-8)


def test_equal_rates_make_a_symmetric_profile() -> None:
    profile = Trapezoid(0.0, 1.0, max_velocity=0.5, acceleration=1.0)
    assert profile.phase_times == pytest.approx((0.0, 0.5, 2.0, 2.5))
    assert profile.position(1.25) == pytest.approx(0.5)
    short = Trapezoid(0.0, -0.09, max_velocity=0.5, acceleration=1.0)
    assert short.phase_times == pytest.approx((0.0, 0.3, 0.3, 0.6))
    assert short.peak_velocity == pytest.approx(-0.3)
    assert Trapezoid(2.0, 2.0, max_velocity=1.0, acceleration=1.0).duration == 0.0


def test_a_distance_too_short_to_stop_in_is_overshot_and_driven_back() -> None:
    profile = Trapezoid(0.0, 0.1, max_velocity=1.0, acceleration=1.0, start_velocity=1.0)
    assert profile.position(1.0) == pytest.approx(0.5)  # where it has braked to rest
    assert profile.position(np.linspace(0.0, profile.duration, 1001)).max() <= 0.5
    assert profile.position(profile.duration) == 0.1
    assert profile.velocity(profile.duration) == pytest.approx(0.0, abs=1e-12)


def test_a_duration_that_speeds_at_the_ends_exclude_is_refused() -> None:
    """From and to 1 m/s over 1 m: 1 s; dawdling is possible to a point, and then only with a second run-up."""
    limits = {"max_velocity": 1.0, "acceleration": 1.0, "start_velocity": 1.0, "end_velocity": 1.0}
    assert Trapezoid(0.0, 0.5, **limits).duration == pytest.approx(0.5)
    with pytest.raises(InvalidInputError, match="speeds at both ends"):
        Trapezoid(0.0, 0.5, **limits, duration=1.5)
    with pytest.raises(InvalidInputError, match=r"at least 0\.5 s"):
        Trapezoid(0.0, 0.5, **limits, duration=0.4)
    assert Trapezoid(0.0, 0.5, **limits, duration=4.0).position(4.0) == 0.5


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"max_velocity": 0.0}, "max_velocity"),
        ({"max_velocity": math.inf}, "max_velocity"),
        ({"acceleration": -1.0}, "acceleration"),
        ({"braking": math.nan}, "braking"),
        ({"end": math.nan}, "end"),
        ({"start": True}, "start"),
        ({"start_velocity": 1.1}, "start_velocity"),
        ({"end_velocity": -1.1}, "end_velocity"),
        ({"start_time": math.inf}, "start_time"),
        ({"duration": -1.0}, "duration"),
        ({"start": -1e308, "end": 1e308}, "holds"),
    ],
)
def test_what_makes_no_sense_is_named(change: dict[str, Any], named: str) -> None:
    case = {"start": 0.0, "end": 1.0, "max_velocity": 1.0, "acceleration": 1.0} | change
    with pytest.raises(InvalidInputError, match=named):
        planned(case)


def test_axes_are_named() -> None:
    with pytest.raises(InvalidInputError, match="axis 1, acceleration"):
        synchronised([0, 0], [1, 1], max_velocity=1.0, acceleration=[1.0, 0.0])
    with pytest.raises(InvalidInputError, match="end"):
        synchronised([0, 0], [1], max_velocity=1.0, acceleration=1.0)
    with pytest.raises(InvalidInputError, match="at least one axis"):
        synchronised([], [], max_velocity=1.0, acceleration=1.0)
