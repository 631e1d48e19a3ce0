"""Servos against closed forms, forward dynamics against energy and Lagrange's equation, feed-forward in numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.loop.plants import RigidBodies, VelocityServos
from nao_kin.motion.loop.servo import P_OVERSHOOT, Gains, Servo, compare_feed_forward, overshoot, run_servo, tune
from nao_kin.robot.motors import Motors
from nao_kin.trajectory import Trajectory
from tests.conftest import robot

START = np.array([0.3, 3.0, 2.0, 0.5, -0.5, 0.2])
WAY = np.array([1.0, 0.6, -0.8, 1.2, 0.9, -1.0])


def jaco2():
    return Motors.of(robot("jaco2"))


def ramp(speed=0.2, duration=2.0):
    times = np.linspace(0.0, duration, 201)
    return Trajectory(["joint_1"], times, START[0] + speed * times[:, None])


def smooth(duration=3.2, samples=321):
    """All joints from START by WAY, speed a raised cosine."""
    times = np.linspace(0.0, duration, samples)
    share = times / duration - np.sin(2 * np.pi * times / duration) / (2 * np.pi)
    return Trajectory(jaco2().joints, times, START + share[:, None] * WAY)


def hold():
    return dict(zip(jaco2().joint_names, START.tolist(), strict=True))


def pendulum(tmp_path, effort=1.0):
    """A point mass of 2 kg at 0.5 m on a joint about y, hanging at 0: I = 0.5 kg m², m g l = 9.81 N m."""
    path = tmp_path / "pendulum.urdf"
    path.write_text(
        "<robot name='pendulum'><link name='base'/><link name='bob'><inertial><origin xyz='0 0 -0.5'/><mass value='2'/>"
        "<inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial></link>"
        "<joint name='pivot' type='revolute'>"
        "<parent link='base'/><child link='bob'/><axis xyz='0 1 0'/>"
        f"<limit lower='-3' upper='3' velocity='50' effort='{effort}'/></joint></robot>",
        encoding="utf-8",
    )
    return Motors.of(nk.load(path))


def geared(tmp_path):
    """A leader and a follower that turns twice as far the other way, each with a flywheel: I = 0.1 + 4 × 0.02 kg m²."""
    path = tmp_path / "geared.urdf"
    wheel = "<inertial><mass value='1'/><inertia ixx='{0}' ixy='0' ixz='0' iyy='{0}' iyz='0' izz='{0}'/></inertial>"
    follows = "<mimic joint='a' multiplier='-2' offset='0.3'/>"
    joint = (
        "<joint name='{0}' type='revolute'><parent link='base'/><child link='{0}_wheel'/><axis xyz='0 0 1'/>"
        "<limit lower='-9' upper='9' velocity='5' effort='3'/>{1}</joint>"
    )
    path.write_text(
        f"<robot name='geared'><link name='base'/><link name='a_wheel'>{wheel.format(0.1)}</link><link name='b_wheel'>"
        f"{wheel.format(0.02)}</link>{joint.format('a', '')}"
        f"{joint.format('b', follows)}</robot>",
        encoding="utf-8",
    )
    return Motors.of(nk.load(path))


@pytest.mark.parametrize("time_constant", [0.004, 0.02, 0.2])
def test_a_velocity_servo_is_the_exact_solution_of_its_equation(time_constant):
    """Against v(t) = u + (v0 − u) e^(−t/τ) and its integral, reached in steps of any size."""
    plant = VelocityServos(jaco2(), time_constant)
    u, t = np.linspace(-0.5, 0.5, 6), 0.37
    state = plant.at_rest(START)
    for step in (0.01, 0.2, 0.05, 0.11):
        state = plant.advance(state, u, step)
    decay = math.exp(-t / time_constant)
    assert state.velocity == pytest.approx(u * (1.0 - decay), abs=1e-12)
    assert state.q == pytest.approx(START + u * (t - time_constant * (1.0 - decay)), abs=1e-12)


@pytest.mark.parametrize("kp", [2.0, 8.0, 14.0])
def test_on_a_ramp_a_p_servo_lags_by_speed_over_gain_and_not_at_all_with_feed_forward(kp):
    for on, lag in ((False, 0.2 / kp), (True, 0.0)):
        run = run_servo(VelocityServos(jaco2()), ramp(duration=6.0), Gains(kp, feed_forward=on), hold=hold())
        assert run.errors[-2, 0] == pytest.approx(lag, abs=2e-6)
        assert np.abs(run.errors[:, 1:]).max() == 0.0
        assert not run.cut.any()


def test_integral_action_takes_the_lag_away_too():
    run = run_servo(VelocityServos(jaco2()), ramp(duration=8.0), Gains(8.0, 8.0), hold=hold())
    assert abs(run.errors[-2, 0]) < 1e-4
    assert run.largest_error > 1e-2


def test_speed_acceleration_and_range_bound_the_commands_and_every_cut_is_on_record():
    motors = jaco2()
    times = np.linspace(0.0, 1.0, 101)
    fast = Trajectory(motors.joints, times, START + np.outer(times, 1.5 * WAY))
    run = run_servo(VelocityServos(motors), fast, Gains(10.0, feed_forward=True), acceleration=2.0, settle=3.0)
    assert run.cut.any()
    assert (np.abs(run.command) <= motors.max_velocity + 1e-12).all()
    assert (np.abs(np.diff(run.command, axis=0)) <= 2.0 * 0.01 + 1e-12).all()
    assert run.largest_error > 0.3
    beyond = Trajectory(["joint_3"], [0.0, 2.0], [[START[2]], [motors.upper[2] + 1.0]])
    kept = run_servo(VelocityServos(motors), beyond, Gains(10.0), hold=hold(), acceleration=2.0, settle=10.0)
    assert kept.cut[:, 2].any()
    lag = 2.0 * 0.02  # the drive is faster by that than a command that falls by 2 rad/s², and for about as long as τ
    assert kept.q[:, 2].max() <= motors.upper[2] + 2.0 * lag * (0.02 + 0.01)
    assert kept.q[-1, 2] == pytest.approx(motors.upper[2], abs=1e-2)


def test_anti_windup_keeps_the_integral_from_running_away():
    """A step that saturates for long: the overshoot is what the tuned PI servo has anyway, not what was summed up."""
    motors = jaco2()
    servo = Servo(motors, Gains(5.0, 5.0))
    state, target = VelocityServos(motors).at_rest(START), START + np.array([2.0, 0, 0, 0, 0, 0])
    plant, farthest = VelocityServos(motors), 0.0
    for _ in range(1500):
        command, _ = servo.command(target, np.zeros(6), state.q)
        state = plant.advance(state, command, servo.period)
        farthest = max(farthest, float(state.q[0] - target[0]))
    # Saturated for three seconds, an integral without anti-windup would have summed up five times the speed limit.
    assert farthest < 0.03
    assert state.q == pytest.approx(target, abs=1e-3)


def test_feed_forward_makes_the_error_at_least_five_times_smaller_at_the_same_gains():
    plant, reference = VelocityServos(jaco2()), smooth()
    gains = tune(plant, reference)
    assert gains == tune(plant, reference)
    assert overshoot(plant, gains, START) <= P_OVERSHOOT
    found = compare_feed_forward(plant, reference, gains)
    assert found.without.rms_error / found.with_it.rms_error == found.rms_ratio >= 5.0
    assert found.largest_ratio >= 5.0
    # No gain that was tried is better for the run without, among those that do not overshoot.
    for kp in (0.8 * gains.position, 0.95 * gains.position):
        assert run_servo(plant, reference, Gains(kp)).rms_error > found.without.rms_error
    assert overshoot(plant, Gains(1.3 * gains.position), START) > P_OVERSHOOT


def test_feed_forward_helps_the_rigid_bodies_as_much():
    plant, reference = RigidBodies(jaco2(), START), smooth(duration=3.2, samples=41)
    found = compare_feed_forward(plant, reference, Gains(20.0))
    assert min(found.rms_ratio, found.largest_ratio) >= 5.0
    assert not found.with_it.effort_cut.any()
    assert np.abs(found.with_it.effort).max() > 1.0  # it carries its arm


@pytest.mark.parametrize("name", ["jaco2", "nao"])
def test_accelerations_fulfil_lagranges_equation(name, rng):
    """d/dt ∂L/∂v − ∂L/∂q = τ, by central differences of the kinetic and potential energy alone."""
    motors = Motors.of(robot(name))
    plant = RigidBodies(motors, random_configurations(motors, 1, rng)[0], armature=1e-2, step=1e-5)
    n, h = len(motors.joints), 1e-5
    q, v, effort = random_configurations(motors, 1, rng)[0], rng.normal(size=n), rng.normal(size=n)
    a = plant.acceleration(q, v, effort)

    def lagrangian(q, v):
        return 2.0 * 0.5 * v @ plant.mass_matrix(q) @ v - plant.energy(q, v)

    def momentum(q, v, k):
        step = h * np.eye(n)[k]
        return (lagrangian(q, v + step) - lagrangian(q, v - step)) / (2 * h)

    for k in range(0, n, 5):
        step = h * np.eye(n)[k]
        rate = (momentum(q + h * v, v + h * a, k) - momentum(q - h * v, v - h * a, k)) / (2 * h)
        force = (lagrangian(q + step, v) - lagrangian(q - step, v)) / (2 * h)
        assert rate - force == pytest.approx(effort[k], abs=2e-4)


def test_a_pendulum_swings_as_pendulums_do(tmp_path):
    """I θ̈ = −m g l sin θ: acceleration exact, small swings of period 2π √(l/g)."""
    motors = pendulum(tmp_path)
    plant = RigidBodies(motors, [0.0])
    for angle in (-2.0, 0.1, 1.0):
        found = plant.acceleration(np.array([angle]), np.array([0.7]), np.array([0.4]))
        assert found == pytest.approx([(0.4 - 2 * 9.81 * 0.5 * math.sin(angle)) / 0.5], abs=1e-9)
    q, v, times = np.array([0.01]), np.zeros(1), []
    for k in range(6000):
        v = v + 5e-4 * plant.acceleration(q, v, np.zeros(1))
        before, q = q, q + 5e-4 * v
        if before[0] < 0.0 <= q[0]:
            times.append(5e-4 * k)
    assert np.diff(times) == pytest.approx(2 * math.pi * math.sqrt(0.5 / 9.81), abs=2e-3)


def test_efforts_are_cut_to_their_limits_and_it_is_on_record(tmp_path):
    """1 N m does not hold 9.81 N m · sin 1."""
    held = Trajectory(["pivot"], [0.0, 0.3], [[1.0], [1.0]])
    weak = run_servo(RigidBodies(pendulum(tmp_path), [0.0]), held, Gains(10.0))
    assert weak.effort_cut.any()
    assert np.abs(weak.effort).max() <= 1.0
    assert weak.q[-1, 0] < 0.9
    strong = run_servo(RigidBodies(pendulum(tmp_path, effort=20.0), [0.0]), held, Gains(10.0))
    assert not strong.effort_cut.any()
    assert strong.q[-1, 0] == pytest.approx(1.0, abs=1e-9)
    assert strong.effort[-1, 0] == pytest.approx(9.81 * math.sin(1.0), abs=1e-6)
    sagging = RigidBodies(pendulum(tmp_path, effort=20.0), [0.0], compensate_gravity=False)
    sag = run_servo(sagging, held, Gains(10.0), settle=5.0).errors[-1, 0]
    # At rest: I kp e / τ = m g l sin(1 − e)
    assert 0.5 * 10.0 * sag / 0.005 == pytest.approx(9.81 * math.sin(1.0 - sag), abs=1e-4)


def test_a_follower_adds_its_inertia_by_the_square_of_its_gear(tmp_path):
    motors = geared(tmp_path)
    plant = RigidBodies(motors, [0.0])
    assert plant.mass_matrix(np.zeros(1)) == pytest.approx(np.array([[0.18]]), abs=1e-12)
    assert plant.acceleration(np.zeros(1), np.ones(1), np.array([0.9])) == pytest.approx([5.0], abs=1e-9)
    assert motors.posture([0.5]) == {"a": 0.5, "b": -0.7}
    assert motors.max_velocity == pytest.approx([2.5])


def test_armature_adds_to_the_motors_own_inertia_and_leaves_the_robot_alone():
    motors = jaco2()
    bare, heavy = (RigidBodies(motors, START, armature=armature) for armature in (0.0, np.arange(6) / 10))
    added = heavy.mass_matrix(START) - bare.mass_matrix(START)
    assert added == pytest.approx(np.diag(np.arange(6) / 10), abs=1e-12)
    assert not np.array(motors.robot.model.armature).any()


def test_misuse_is_named():
    motors = jaco2()
    with pytest.raises(InvalidInputError, match="gain position"):
        Gains(-1.0)
    with pytest.raises(InvalidInputError, match="at most"):
        RigidBodies(motors, START, step=0.01)
    nao = Motors.of(robot("nao"))
    with pytest.raises(InvalidInputError, match="LHand, RHand move"):
        RigidBodies(nao, nao.q_of(robot("nao").neutral))
    with pytest.raises(UnknownNameError, match="joint_x"):
        run_servo(VelocityServos(motors), Trajectory(["joint_x"], [0, 1], [[0], [1]]), Gains(1.0))
    with pytest.raises(InvalidInputError, match="period"):
        run_servo(VelocityServos(motors), ramp(), Gains(1.0), period=0.0)
    with pytest.raises(InvalidInputError, match="overshoot"):
        tune(VelocityServos(motors, time_constant=5.0), smooth(samples=33), allowed=0.0)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"settle": math.nan}, "settle"),
        ({"settle": -5.0}, "settle"),
        ({"settle": 1e12}, "at most 1000000 control periods"),
        ({"period": 1e-9}, "at most 1000000 control periods"),
        ({"acceleration": [1.0, 2.0]}, "acceleration: expected"),
        ({"acceleration": "fast"}, "acceleration: expected"),
        ({"acceleration": math.nan}, "acceleration: expected"),
    ],
)
def test_numbers_of_a_run_that_make_no_sense_are_refused(options: dict[str, Any], said: str) -> None:
    plant = VelocityServos(Motors.of(robot("nao")))
    reference = Trajectory(["HeadYaw"], [0.0, 1.0], [[0.0], [0.5]])
    with pytest.raises(InvalidInputError, match=said):
        run_servo(plant, reference, Gains(5.0), **options)
