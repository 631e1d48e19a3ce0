"""A hexapod walks: feet that stand do not move, whatever the gait, the way and the body do; the model says so."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.hexapod.footfall import GAITS, LEGS, BodyCourse, Gait
from nao_kin.motion.hexapod.gait import Walk, WalkPlan, fastest, walk
from nao_kin.motion.hexapod.walk_request import WalkCommand
from tests.conftest import robot

LEAN = (0.01, -0.01, 0.01, 0.05, -0.05, 0.1)
WAYS = (
    WalkCommand(velocity=(0.08, 0.0)),
    WalkCommand(velocity=(-0.05, 0.05), turn=-0.1),
    WalkCommand(velocity=(0.0, 0.0), turn=0.3, body=LEAN),
    WalkCommand(velocity=(0.0, -0.05), turn=0.2, body=(0.0, 0.0, -0.01, -0.1, 0.05, -0.1)),
)


SHARES = {"tripod": 1.0, "ripple": 0.6, "wave": 0.3}  # the longer a foot stands, the farther it is left behind


@cache
def walked(gait: str, way: WalkCommand) -> Walk:
    return walk(robot("phantomx"), replace(way, gait=gait).at_speed(SHARES[gait]))


CASES = list(itertools.product(GAITS, WAYS))


def feet_by_pinocchio(found: Walk) -> np.ndarray:
    """Feet in the world (N, 6, 3): the whole model as Pinocchio read it, and no chain."""
    model = robot("phantomx").model
    data, q = model.createData(), pin.neutral(model)
    columns = [model.joints[model.getJointId(name)].idx_q for name in found.attempt.joint_names]
    frames = [model.getFrameId(f"foot_{leg}") for leg in LEGS]
    feet = np.empty((len(found.attempt), 6, 3))
    for i, row in enumerate(found.attempt.q):
        q[columns] = row
        pin.framesForwardKinematics(model, data, q)
        T = found.T_world_body[i]
        feet[i] = [T[:3, :3] @ data.oMf[frame].translation + T[:3, 3] for frame in frames]
    return feet


@pytest.mark.parametrize(("gait", "way"), CASES)
def test_feet_on_the_ground_stay_for_ten_seconds(gait: str, way: WalkCommand) -> None:
    found = walked(gait, way)
    assert found.walkable, found.message
    feet, stance = feet_by_pinocchio(found), found.stance
    assert found.attempt.duration >= 10.0
    for k in range(6):
        both = stance[1:, k] & stance[:-1, k]
        assert both.sum() > 400
        where = np.flatnonzero(~stance[:, k])
        for stand in np.split(np.arange(len(stance)), where):
            stood = [i for i in stand if stance[i, k]]
            if stood:
                moved = np.linalg.norm(feet[stood, k] - feet[stood[0], k], axis=1)
                assert moved.max() < 1e-9
                assert np.abs(feet[stood, k, 2]).max() < 1e-9
    assert found.slip < 1e-9
    assert np.abs(found.feet - feet).max() < 1e-12


@pytest.mark.parametrize(("gait", "way"), CASES)
def test_every_gait_keeps_its_duty_and_its_feet_down(gait: str, way: WalkCommand) -> None:
    found, rhythm = walked(gait, way), GAITS[gait]
    assert found.stance.sum(axis=1).min() == rhythm.down == {"tripod": 3, "ripple": 4, "wave": 5}[gait]
    lean = found.command.period if any(way.body) else 0.0
    period = found.command.period  # of the first cycle the swings are missing that began before it
    times, end = found.attempt.times - lean, int(10.0 / period) * period
    inside = (times >= period - 1e-9) & (times < end - 1e-9)
    per_cycle = found.command.period / found.command.sample_time
    assert np.abs(found.stance[inside].mean(axis=0) - rhythm.duty).max() < 2.0 / per_cycle
    lifted = np.where(found.stance, 0.0, found.feet[:, :, 2])
    assert lifted.min() >= 0.0
    assert lifted.max() == pytest.approx(found.command.step_height, rel=1e-2)


@pytest.mark.parametrize(("gait", "way"), CASES)
def test_limits_and_speeds_are_kept_and_it_ends_as_it_began(gait: str, way: WalkCommand) -> None:
    found = walked(gait, way)
    trajectory = found.trajectory
    assert trajectory is not None
    model = robot("phantomx").model
    for name in trajectory.joint_names:
        joint = model.joints[model.getJointId(name)]
        column = trajectory.column(name)
        assert model.lowerPositionLimit[joint.idx_q] <= column.min()
        assert column.max() <= model.upperPositionLimit[joint.idx_q]
        speeds = np.abs(np.diff(column) / np.diff(trajectory.times))
        assert speeds.max() <= model.velocityLimit[joint.idx_v]
    assert trajectory.q[-1] == pytest.approx(trajectory.q[0], abs=1e-9)
    first, last = found.T_world_body[0], found.T_world_body[-1]
    assert first == pytest.approx(np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.09], [0, 0, 0, 1.0]]), abs=1e-15)
    assert last[2] == pytest.approx([0, 0, 1, 0.09], abs=1e-15)
    homes = np.linalg.solve(last, np.vstack([found.feet[-1].T, np.ones(6)]))[:3].T
    assert homes == pytest.approx(np.linalg.solve(first, np.vstack([found.feet[0].T, np.ones(6)]))[:3].T, abs=1e-9)


@pytest.mark.parametrize("way", WAYS)
def test_the_body_moves_as_commanded(way: WalkCommand) -> None:
    """Between start and stop: the twist of the body in its own axes, by finite differences of its measured pose."""
    found = walked("tripod", way)
    T, step, lean = found.T_world_body, found.command.sample_time, found.command.period if any(way.body) else 0.0
    x, y, z, *turned = way.body
    tilt = pin.SE3(pin.rpy.rpyToMatrix(*turned), np.array([x, y, z + way.height])).homogeneous
    planar = T @ np.linalg.inv(tilt)
    times = found.attempt.times - lean
    for i in np.flatnonzero((times > 1.5) & (times < 8.5))[::50]:
        motion = pin.log6(pin.SE3(np.linalg.inv(planar[i]) @ planar[i + 1])).vector / step
        assert motion == pytest.approx([*way.velocity, 0.0, 0.0, 0.0, way.turn], abs=1e-9)


def test_the_course_is_the_integral_of_its_velocity() -> None:
    course = BodyCourse((0.1, -0.03), 0.4, 7.0, 1.3)
    times = np.linspace(0.0, 7.0, 70_001)
    u = np.clip(np.minimum(times, 7.0 - times) / 1.3, 0.0, 1.0)
    share = 3 * u**2 - 2 * u**3
    mean = 0.5 * (share[1:] + share[:-1]) * np.diff(times)
    heading = np.r_[0.0, np.cumsum(0.4 * mean)]
    c, s = np.cos(heading), np.sin(heading)
    x = np.r_[0.0, np.cumsum(np.diff(times) * 0.5 * np.convolve(share * (0.1 * c + 0.03 * s), [1, 1], "valid"))]
    y = np.r_[0.0, np.cumsum(np.diff(times) * 0.5 * np.convolve(share * (0.1 * s - 0.03 * c), [1, 1], "valid"))]
    assert course.poses(times) == pytest.approx(np.column_stack([x, y, heading]), abs=1e-8)
    assert course.poses(np.array([-1.0, 9.0])) == pytest.approx(
        np.array([[0, 0, 0], [x[-1], y[-1], heading[-1]]]), abs=1e-8
    )


@pytest.mark.parametrize("gait", GAITS)
def test_feet_leave_and_meet_the_ground_at_rest(gait: str) -> None:
    """Finely sampled about its steps, no foot jumps in speed: a step of speed would not shrink with the sampling."""
    way = WalkCommand(gait=gait, velocity=(0.06, 0.02), turn=0.1, duration=2.0, sample_time=0.001)
    found = walk(robot("phantomx"), way)
    speeds = np.diff(found.feet, axis=0) / 0.001
    assert np.linalg.norm(np.diff(speeds, axis=0), axis=2).max() < 0.05
    at_rest = found.stance[1:] & found.stance[:-1]
    assert np.linalg.norm(speeds[at_rest], axis=1).max() < 1e-6


@pytest.mark.parametrize("gait", GAITS)
def test_it_repeats_itself_every_cycle(gait: str) -> None:
    way = replace(WAYS[1], gait=gait).at_speed(SHARES[gait])
    found = walk(robot("phantomx"), replace(way, duration=6.0 * way.period))
    count, times = round(way.period / way.sample_time), found.attempt.times / way.period
    # From when the first steps at full speed are done until the first foot that will stand when the body slows down.
    steady = np.flatnonzero((times > 2.1) & (times < 6.0 - 3.1))
    assert len(steady) > 50
    assert np.abs(found.attempt.q[steady + count] - found.attempt.q[steady]).max() < 1e-9


@pytest.mark.parametrize("gait", GAITS)
def test_the_mirrored_walk_is_half_a_cycle_later(gait: str) -> None:
    """Left and right exchanged: the feet seen from the body are mirrored, when both walk at full speed."""
    way = replace(WAYS[1], gait=gait, body=LEAN).at_speed(SHARES[gait])
    way = replace(way, duration=6.0 * way.period)
    other = replace(
        way,
        velocity=(way.velocity[0], -way.velocity[1]),
        turn=-way.turn,
        body=(LEAN[0], -LEAN[1], LEAN[2], -LEAN[3], LEAN[4], -LEAN[5]),
    )
    here, there = walk(robot("phantomx"), way), walk(robot("phantomx"), other)
    half = round(0.5 * way.period / way.sample_time)
    start = round(3.1 * way.period / way.sample_time)

    def seen(found: Walk) -> np.ndarray:
        T = np.linalg.inv(found.T_world_body)
        return np.einsum("nij,nlj->nli", T[:, :3, :3], found.feet) + T[:, None, :3, 3]

    mirrored = seen(there)[
        :,
        [
            LEGS.index(
                leg.translate(
                    str.maketrans("lr", "rl"),
                )[0]
                + leg[1]
            )
            for leg in LEGS
        ],
    ]
    mirrored = mirrored * (1.0, -1.0, 1.0)
    samples = np.arange(start, start + half)
    assert np.abs(seen(here)[samples] - mirrored[samples + half]).max() < 1e-9


def test_the_centre_of_mass_is_that_of_all_links_and_its_margin_that_of_the_hull() -> None:
    """Against the masses in the file, and against the support function of the standing feet."""
    found, model = walked("tripod", WAYS[2]), robot("phantomx")
    angles = np.linspace(0.0, 2.0 * np.pi, 200_001)
    directions = np.stack([np.cos(angles), np.sin(angles)])
    for i in range(0, len(found.attempt), 100):
        poses = model.link_poses(found.attempt.posture(i))
        total, moment = 0.0, np.zeros(3)
        for link in model.document.links:
            if link.inertial is not None:
                total += link.inertial.mass
                moment += link.inertial.mass * poses[link.name].act(np.array(link.inertial.origin.xyz))
        centre = (found.T_world_body[i] @ [*(moment / total), 1.0])[:2]
        standing = found.feet[i, found.stance[i], :2]
        support = ((standing - centre) @ directions).max(axis=0).min()
        assert found.margins[i] == pytest.approx(support, abs=1e-5)
        assert found.margins[i] <= support + 1e-12
    assert found.least > 0.04


def test_what_cannot_be_walked_is_refused_with_leg_time_and_amount() -> None:
    found = walk(robot("phantomx"), WalkCommand(velocity=(0.6, 0.0), duration=4.0))
    assert not found.walkable
    assert found.trajectory is None
    far = [refusal for refusal in found.refused if refusal.reason == "too far"]
    assert far
    chains = {leg: robot("phantomx").chain(f"leg_{leg}") for leg in LEGS}
    T, wanted, _ = WalkPlan.of(found.command, chains).at(found.attempt.times)
    for refusal in far:
        leg = refusal.what.removeprefix("foot ")
        i = int(np.argmin(np.abs(found.attempt.times - refusal.worst)))
        femur, knee, foot = (robot("phantomx").pose({}, f"{link}_{leg}") for link in ("thigh", "tibia", "foot"))
        coxa = robot("phantomx").pose({}, f"c1_{leg}").translation
        p = np.linalg.inv(T[i]) @ [*wanted[i, LEGS.index(leg)], 1.0]
        out, up = math.dist(p[:2], coxa[:2]), p[2] - femur.translation[2]
        beyond = math.hypot(out - math.dist(femur.translation[:2], coxa[:2]), up)
        femur_and_tibia = math.dist(femur.translation, knee.translation) + math.dist(knee.translation, foot.translation)
        assert refusal.amount == pytest.approx(beyond - femur_and_tibia, abs=1e-9)
        assert refusal.time <= refusal.worst
    assert "foot" in found.message
    assert "s on" in found.message
    with pytest.raises(TypeError, match="walkable"):
        bool(found)


def test_a_foot_that_slips_is_not_hidden() -> None:
    """A leg that does not reach its foothold drags its foot, and the measurement says so."""
    found = walk(robot("phantomx"), WalkCommand(velocity=(0.6, 0.0), duration=4.0))
    assert found.slip > 1e-3


def test_out_of_balance_and_too_fast_are_refused() -> None:
    found = walk(robot("phantomx"), WalkCommand(duration=3.0, margin=0.11))
    (refusal,) = found.refused
    assert (refusal.what, refusal.reason) == ("body", "out of balance")
    assert refusal.amount == pytest.approx(0.11 - found.margins.min())
    found = walk(robot("phantomx"), WalkCommand(gait="wave", cycle=1.0, duration=3.0))
    assert {refusal.reason for refusal in found.refused} == {"too fast"}


def test_the_fastest_walk_is_walkable_and_a_little_faster_is_not() -> None:
    way = WalkCommand(velocity=(0.3, 0.0), duration=1.5, sample_time=0.02)
    found = fastest(robot("phantomx"), way)
    assert found.walkable
    assert 0.05 < found.command.velocity[0] < 0.3
    assert not walk(robot("phantomx"), found.command.at_speed(1.011)).walkable
    hundred = fastest(robot("phantomx"), replace(way, velocity=(100.0, 0.0)))
    assert hundred.command.velocity[0] == pytest.approx(found.command.velocity[0], rel=0.021)
    stuck = fastest(robot("phantomx"), replace(way, body=(0.0, 0.0, 0.2, 0.0, 0.0, 0.0)))
    assert not stuck.walkable
    assert stuck.command.velocity == (0.0, 0.0)


def test_a_rhythm_of_ones_own() -> None:
    slow = Gait("slow wave", 11 / 12, {leg: k / 6 for k, leg in enumerate(LEGS)}, 5)
    found = walk(robot("phantomx"), WalkCommand(gait=slow, velocity=(0.01, 0.0), duration=7.0, cycle=6.0))
    assert found.walkable, found.message
    assert found.stance.sum(axis=1).min() == 5


def test_the_last_sample_is_the_end_even_off_the_grid() -> None:
    found = walk(robot("phantomx"), WalkCommand(duration=1.2345, cycle=1.1, sample_time=0.013))
    assert found.stance[-1].all()
    assert found.attempt.q[-1] == pytest.approx(found.attempt.q[0], abs=1e-9)
    steps = np.diff(found.attempt.times)
    assert steps[:-1] == pytest.approx(np.full(len(steps) - 1, 0.013))
    assert 0.0 < steps[-1] <= 0.013 + 1e-9


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"velocity": (math.nan, 0.0)}, "velocity"),
        ({"velocity": 0.1}, "velocity"),
        ({"turn": math.inf}, "turn"),
        ({"duration": 0.0}, "duration"),
        ({"duration": 1e300}, "samples"),
        ({"cycle": -1.0}, "cycle"),
        ({"cycle": 0.05}, "sample_time"),
        ({"sample_time": 1e-300}, "samples"),
        ({"body": (0.0, 0.0)}, "body"),
        ({"step_height": True}, "step_height"),
    ],
)
def test_a_command_that_makes_no_sense_is_refused_by_name(fields: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        WalkCommand(**fields)  # type: ignore[arg-type]


def test_misuse_is_named() -> None:
    with pytest.raises(UnknownNameError, match="tripod"):
        WalkCommand(gait="tripot")
    with pytest.raises(InvalidInputError, match="leg_lf"):
        walk(robot("nao"))
    chains = {leg: robot("phantomx").chain(f"leg_{leg}") for leg in LEGS}
    with pytest.raises(InvalidInputError, match="none for rr"):
        walk(robot("phantomx"), legs={leg: chains[leg] for leg in LEGS[:-1]})
    with pytest.raises(UnknownNameError, match="lf"):
        walk(robot("phantomx"), legs={**chains, "lff": chains["lf"]})
    with pytest.raises(InvalidInputError, match="stance"):
        walk(robot("phantomx"), WalkCommand(height=0.4))
    with pytest.raises(InvalidInputError, match="duty"):
        Gait("flying", 1.0, dict.fromkeys(LEGS, 0.0), 0)
    with pytest.raises(InvalidInputError, match="lift_off"):
        Gait("lame", 0.5, {"lf": 0.0}, 0)
