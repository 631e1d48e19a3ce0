"""The guard keeps its promise on motions that collide, on those that do not, and on targets that jump about."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.bench.bench_guard import ClearanceReferee, _drawn, _least_between, _run
from nao_kin.chain import in_limits, random_configurations
from nao_kin.collision import CollisionModel, Plane
from nao_kin.errors import InvalidInputError
from nao_kin.motion.loop.guard import Clearance, Guard
from tests.conftest import robot

MARGIN = 0.01
PLANES = {"nao": Plane("wall", (-1.0, 0.0, 0.0), -0.25), "jaco2": Plane("table")}


def guarded(name):
    collisions = CollisionModel(robot(name), margin=MARGIN, planes=[PLANES[name]])
    return collisions, ClearanceReferee(collisions)


def slider(tmp_path):
    """A ball of 0.1 m on a slider along x, and a wall at x = 1: the clearance is 0.9 − q."""
    path = tmp_path / "slider.urdf"
    path.write_text(
        "<robot name='slider'><link name='rail'/><link name='ball'><collision><geometry><sphere radius='0.1'/>"
        "</geometry></collision></link><joint name='slide' type='prismatic'><parent link='rail'/><child link='ball'/>"
        "<axis xyz='1 0 0'/><limit lower='-2' upper='2' velocity='0.5' effort='1'/></joint></robot>",
        encoding="utf-8",
    )
    return CollisionModel(nk.load(path), margin=MARGIN, planes=[Plane("wall", (-1.0, 0.0, 0.0), -1.0)])


def driven(guard, target, most=20000):
    """All commands until the robot is at rest."""
    steps = []
    for _ in range(most):
        steps.append(guard.step(target))
        if steps[-1].at_rest:
            return steps
    raise AssertionError("never at rest")


@pytest.mark.parametrize("name", ["nao", "jaco2"])
@pytest.mark.parametrize("kind", ["colliding", "clear"])
def test_motions_that_collide_stop_before_and_clear_ones_arrive(name, kind):
    collisions, referee = guarded(name)
    rng = np.random.default_rng(7)
    for motion in itertools.islice(_drawn(collisions, referee, rng, kind), 3):
        done = _run(collisions, referee, motion)
        assert done["stopped"] == (kind == "colliding")
        assert done["arrived"] == (kind == "clear")
        assert done["least"] >= 0.5 * MARGIN - 1e-5


@pytest.mark.parametrize("name", ["nao", "jaco2"])
def test_targets_that_jump_about_break_no_limit_and_touch_nothing(name, rng):
    collisions, referee = guarded(name)
    motors = collisions.motors
    starts = random_configurations(motors, 200, rng)
    start = next(q for q in starts if collisions.measure(q).min() > 0.02)
    guard = Guard(collisions, start)
    way, speeds = [start], [np.zeros(len(start))]
    for target in random_configurations(motors, 12, rng):
        for _ in range(int(rng.integers(1, 60))):
            done = guard.step(target)
            way.append(done.q)
            speeds.append(done.velocity)
            assert in_limits(motors, done.q, 1e-9)
    speeds = np.array(speeds)
    assert (np.abs(speeds) <= motors.max_velocity * (1 + 1e-9)).all()
    assert (np.abs(np.diff(speeds, axis=0)) <= guard.max_acceleration * guard.period * (1 + 1e-6)).all()
    assert np.diff(way, axis=0) == pytest.approx(speeds[1:] * guard.period, abs=1e-12)
    assert _least_between(referee, way) >= 0.5 * MARGIN - 1e-5


@pytest.mark.parametrize("beyond", [-0.1, -1e-4, 1e-4, 0.003, 0.3])
def test_where_it_stops_is_known_where_the_clearance_is(tmp_path, beyond):
    """Targets up to the margin are reached, those beyond are not passed to less than half of it."""
    collisions = slider(tmp_path)
    guard = Guard(collisions, [0.0], acceleration=[2.0])
    target = 0.9 - MARGIN + beyond
    steps = driven(guard, np.array([target]))
    nearest = max(float(step.q[0]) for step in steps)
    if beyond < 0.0:
        assert not any(step.blocked_by for step in steps)
        assert nearest == pytest.approx(target, abs=1e-12)
    else:
        assert 0.9 - MARGIN - 0.01 <= nearest <= min(target, 0.9 - 0.5 * MARGIN) + 1e-12
    if beyond > 0.5 * MARGIN:
        assert "ball and wall" in steps[-1].blocked_by


def test_a_move_takes_the_time_of_its_trapezoid(tmp_path):
    guard = Guard(slider(tmp_path), [-1.5], acceleration=[2.0])
    steps = driven(guard, np.array([0.5]))
    assert len(steps) * guard.period == pytest.approx(2.0 / 0.5 + 0.5 / 2.0, abs=3 * guard.period)
    assert np.diff([float(step.q[0]) for step in steps]).min() >= 0.0  # no step back
    assert steps[-1].q[0] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize("way", [1e-12, 1e-6, 3e-4, 0.01, 0.1, 1.0])
@pytest.mark.parametrize("acceleration", [0.1, 2.0, 500.0])
def test_every_target_is_arrived_at_exactly_and_without_passing_it(tmp_path, way, acceleration):
    guard = Guard(slider(tmp_path), [-1.0], acceleration=[acceleration])
    steps = driven(guard, np.array([-1.0 + way]))
    assert steps[-1].q[0] == pytest.approx(-1.0 + way, abs=1e-14)
    assert max(float(step.q[0]) for step in steps) <= -1.0 + way + 1e-14


def test_braking_stays_on_the_line_it_was_proven_on():
    collisions, _ = guarded("jaco2")
    guard = Guard(collisions, [0.3, 3.0, 2.0, 0.5, -0.5, 0.2])
    target = guard.checked([1.3, 3.6, 1.2, 1.7, 0.4, -0.8])
    for _ in range(40):
        guard.step(target)
    q, v = guard.q.copy(), guard.velocity.copy()
    cycles = guard._braking_cycles(v)
    points = []
    while guard.velocity.any():
        guard.velocity = guard._braked()
        guard.q = guard.q + guard.velocity * guard.period
        points.append(guard.q.copy())
    assert len(points) <= cycles
    shares = np.array([(p - q) @ v / (v @ v) for p in points])
    assert np.array(points) == pytest.approx(q + shares[:, None] * v, abs=1e-12)
    assert shares[-1] <= 0.5 * guard.period * (cycles - 1) + 1e-12


def test_a_coupled_limit_on_the_way_stops_a_move_too():
    """NAO's head may bend least at a yaw of 1.527 rad, by 0.2 rad; at 0.9 and 2.08 rad it may by 0.31 rad."""
    collisions = CollisionModel(robot("nao"), margin=MARGIN)
    motors = collisions.motors
    first = motors.q_of(robot("nao").neutral)
    yaw, pitch = motors.index("HeadYaw"), motors.index("HeadPitch")
    first[pitch] = 0.31
    last = first.copy()
    first[yaw], last[yaw] = 0.9, 2.08
    guard = Guard(collisions, first)
    steps = driven(guard, guard.checked(last))
    assert "HeadPitch" in steps[-1].blocked_by
    assert all(in_limits(motors, step.q, 1e-9) for step in steps)


def test_clearance_is_proven_between_the_ends_of_a_move(tmp_path):
    """Past an obstacle: both ends are clear and the middle is not."""
    path = tmp_path / "past.urdf"
    balls = "".join(
        f"<link name='{name}'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
        for name in ("fixed", "arm", "ball")
    )
    path.write_text(
        f"<robot name='past'>{balls}<joint name='turn' type='continuous'><parent link='fixed'/><child link='arm'/>"
        "<origin xyz='1 0 0'/><axis xyz='0 0 1'/><limit velocity='1' effort='1'/></joint>"
        "<joint name='out' type='continuous'>"
        "<parent link='arm'/><child link='ball'/><origin xyz='0.7 0 0'/>"
        "<axis xyz='0 0 1'/><limit velocity='1' effort='1'/></joint></robot>",
        encoding="utf-8",
    )
    # The ball goes round the point (1, 0) at 0.7 m; the fixed one is at the origin, 0.3 m from the circle.
    for margin, clear in ((0.099, True), (0.21, False)):
        clearance = Clearance(CollisionModel(nk.load(path), margin=margin))
        met = clearance.obstacle(np.array([0.5 * np.pi, 0.0]), np.array([1.5 * np.pi, 0.0]))
        assert (met is None) == clear


def test_misuse_is_named(tmp_path):
    collisions, _ = guarded("jaco2")
    fine = [0.3, 3.0, 2.0, 0.5, -0.5, 0.2]
    with pytest.raises(InvalidInputError, match=r"at least 0\.001 m"):
        Guard(CollisionModel(robot("jaco2")), fine)
    with pytest.raises(InvalidInputError, match="joint_2 = 0 is outside"):
        Guard(collisions, np.zeros(6))
    with pytest.raises(InvalidInputError, match="link_2 and link_4 nearer"):
        Guard(collisions, list(robot("jaco2").neutral.values()))
    with pytest.raises(InvalidInputError, match="acceleration"):
        Guard(collisions, fine, acceleration=np.zeros(6))
    with pytest.raises(InvalidInputError, match="joint_3"):
        Guard(collisions, fine).checked([0.3, 3.0, np.nan, 0.5, -0.5, 0.2])


def test_a_motor_without_a_greatest_speed_needs_one(tmp_path):
    slider(tmp_path)
    text = (tmp_path / "slider.urdf").read_text().replace("velocity='0.5' ", "")
    (tmp_path / "endless.urdf").write_text(text)
    collisions = CollisionModel(nk.load(tmp_path / "endless.urdf"), margin=MARGIN, planes=[PLANES["nao"]])
    with pytest.raises(InvalidInputError, match="greatest speed of slide"):
        Guard(collisions, [-1.0])
    assert Guard(collisions, [-1.0], velocity=[1.0]).max_velocity == 1.0
