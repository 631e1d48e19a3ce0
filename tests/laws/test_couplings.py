"""A follower moves |multiplier| times as fast as its leader, so no motor may go where or as fast as one of its joints
cannot: on every chain, on a tree of them, on all motors and on the page.

What is allowed is worked out here from the text of the file alone.
"""

from __future__ import annotations

import itertools
import json
import math
import xml.etree.ElementTree as ET
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pytest
from tests.test_cli_trajectory import ok
from typer.testing import CliRunner

import nao_kin as nk
from nao_kin.chain import sampling_range
from nao_kin.cli.app import application
from nao_kin.errors import InvalidInputError
from nao_kin.robot.motors import Motors
from nao_kin.trajectory.joint_space import joint_motion
from nao_kin.view.page import scene_json
from nao_kin.view.robot_scene import robot_scene

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from nao_kin.chain import ChainJoint

OFF_PATH = """<robot name="c"><link name="b"/><link name="l1"/><link name="l2"/>
<joint name="m" type="revolute"><parent link="b"/><child link="l1"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" velocity="2" effort="1"/></joint>
<joint name="f" type="revolute"><parent link="l1"/><child link="l2"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1" effort="1"/><mimic joint="m" multiplier="-2" offset="0"/></joint></robot>"""
ROUNDING = 1e-9  # relative to values of some hundreds


@dataclass(frozen=True)
class RawFile:
    """The joints of a file by what is written in it, each as an affine function of its motor."""

    text: str

    @cached_property
    def joints(self) -> dict[str, ET.Element]:
        return {str(joint.get("name")): joint for joint in ET.fromstring(self.text).iter("joint")}  # noqa: S314 - own

    def motor(self, name: str) -> str:
        mimic = self.joints[name].find("mimic")
        return name if mimic is None else self.motor(str(mimic.get("joint")))

    def value(self, name: str, motor: float) -> float:
        """The joint's value where its motor stands at a value."""
        mimic = self.joints[name].find("mimic")
        if mimic is None:
            return motor
        return float(mimic.get("multiplier", 1)) * self.value(str(mimic.get("joint")), motor) + float(
            mimic.get("offset", 0)
        )

    def gear(self, name: str) -> float:
        """How fast it moves where its motor moves at 1."""
        return abs(self.value(name, 1.0) - self.value(name, 0.0))

    def moved_with(self, name: str) -> list[str]:
        return [other for other in self.joints if self.motor(other) == self.motor(name)]

    def limits(self, name: str) -> tuple[float, float, float]:
        """Its own least and greatest value and its greatest speed."""
        limit, kind = self.joints[name].find("limit"), self.joints[name].get("type")
        stated = {} if limit is None else dict(limit.attrib)
        ends = (-math.inf, math.inf) if kind == "continuous" else (float(stated["lower"]), float(stated["upper"]))
        return (*ends, float(stated.get("velocity", math.inf)))

    def speed(self, name: str) -> float:
        """The greatest speed of a joint at which all that moves with it keeps its own."""
        return self.gear(name) * min(self.limits(other)[2] / self.gear(other) for other in self.moved_with(name))

    def keeps(self, name: str, motor: float, slack: float) -> bool:
        """Whether all that moves with a joint is in its own range where their motor stands at a value."""
        return all(
            lower - slack <= self.value(other, motor) <= upper + slack
            for other in self.moved_with(name)
            for lower, upper, _ in [self.limits(other)]
        )

    def motor_value(self, name: str, value: float) -> float:
        start = self.value(name, 0.0)
        return (value - start) / (self.value(name, 1.0) - start)


def random_file(rng: np.random.Generator) -> RawFile:
    """A tree of 3 to 9 joints: about half follow another one, which may come later in the file or on another branch."""
    count = int(rng.integers(3, 10))
    names = [f"j{k}" for k in rng.permutation(count)]  # Pinocchio sorts names
    order = list(rng.permutation(count))  # who may follow whom: only earlier ones, so that there is no cycle
    joints, value_of = {}, {}
    for place, k in enumerate(order):
        name, kind = names[k], str(rng.choice(["revolute", "revolute", "continuous", "prismatic"]))
        mimic, value = "", float(rng.uniform(-1, 1))
        if place and rng.random() < 0.55:
            leader = names[order[int(rng.integers(place))]]
            gear = float(rng.choice([-1, 1]) * rng.choice([0.1, 0.5, 1.0, 2.0, 7.0]))
            offset = float(rng.choice([0.0, rng.uniform(-2, 2)]))
            value = gear * value_of[leader] + offset  # every range holds this one, so that they have a value in common
            mimic = f'<mimic joint="{leader}" multiplier="{gear!r}" offset="{offset!r}"/>'
        value_of[name] = value
        low, high = value - rng.uniform(0.05, 3), value + rng.uniform(0.05, 3)
        ends = "" if kind == "continuous" else f'lower="{low!r}" upper="{high!r}"'
        speed = "" if kind == "continuous" and rng.random() < 0.3 else f'velocity="{rng.uniform(0.1, 5)!r}"'
        limit = f'<limit {ends} {speed} effort="1"/>' if ends or speed else ""
        above = "root" if k == 0 else f"l{int(rng.integers(max(0, k - 3), k))}"
        joints[k] = (
            f'<joint name="{name}" type="{kind}"><parent link="{above}"/><child link="l{k}"/>'
            f'<origin xyz="0.1 0 0.2" rpy="0.3 0 1"/><axis xyz="0 0 1"/>{limit}{mimic}</joint>'
        )
    links = "".join(f'<link name="{link}"/>' for link in ["root", *(f"l{k}" for k in range(count))])
    return RawFile(f'<robot name="tree">{links}{"".join(joints[k] for k in sorted(joints))}</robot>'.replace("np.", ""))


def load(text: str, folder: Path) -> nk.Robot:
    (folder / "robot.urdf").write_text(text)
    return nk.load(folder / "robot.urdf")


def assert_what_its_motor_allows(raw: RawFile, joints: Iterable[ChainJoint]) -> None:
    """Ranges and speeds are neither more than all that moves allows, nor less."""
    for joint in joints:
        assert joint.max_velocity == pytest.approx(raw.speed(joint.name), rel=1e-12), joint
        inward = raw.motor_value(joint.name, 0.5 * (joint.lower + joint.upper)) if joint.lower > -math.inf else 0.0
        for end in (joint.lower, joint.upper):
            if math.isinf(end):
                assert all(raw.limits(other)[:2] == (-math.inf, math.inf) for other in raw.moved_with(joint.name))
                continue
            motor = raw.motor_value(joint.name, end)
            assert raw.keeps(joint.name, motor, ROUNDING), joint
            assert not raw.keeps(joint.name, motor + 1e-6 * np.sign(motor - inward), 0.0), joint
        own = raw.joints[joint.name].get("type")
        expected = "revolute" if own == "continuous" and joint.lower > -math.inf else own
        assert joint.kind == expected


def assert_no_joint_is_too_fast(raw: RawFile, robot: nk.Robot, chain: nk.Chain) -> None:
    """A motion through the whole range of a chain, at its greatest speeds, measured joint by joint."""
    if not np.isfinite(chain.max_velocity).all():
        return
    motion = joint_motion(chain, *sampling_range(chain), acceleration=50.0, sampling=0.1)
    postures = [robot.expand(dict(zip(chain.joint_names, q, strict=True))) for q in motion.q]
    for name in (other for joint in chain.joint_names for other in raw.moved_with(joint)):
        speeds = np.abs(np.diff([posture[name] for posture in postures])) / np.diff(motion.times)
        assert speeds.max() <= raw.limits(name)[2] * (1 + ROUNDING), name


def test_every_view_of_200_random_trees_keeps_the_law(tmp_path: Path) -> None:
    rng, seen = np.random.default_rng(17), Counter[str]()
    for _ in range(200):
        raw = random_file(rng)
        robot = load(raw.text, tmp_path)
        followers = {name for name in raw.joints if raw.motor(name) != name}
        links = robot.frame_names
        pairs = list(itertools.permutations(links, 2))
        for base, tip in (pairs[i] for i in rng.choice(len(pairs), size=5, replace=False)):
            chain = robot.chain(base, tip)
            assert_what_its_motor_allows(raw, chain.joints)
            seen["a follower stands for its motor"] += bool(followers & set(chain.joint_names))
            for name in chain.joint_names:
                on = [other for other in raw.moved_with(name) if other in chain.path_joint_names]
                alone = raw.gear(name) * min(raw.limits(other)[2] / raw.gear(other) for other in on)
                seen["slowed by a joint off the path"] += alone > raw.speed(name) * (1 + ROUNDING)
        assert_no_joint_is_too_fast(raw, robot, chain)
        tree = robot.tree(links[int(rng.integers(2))], list(links[-2:]))
        assert_what_its_motor_allows(raw, tree.joints)
        motors = Motors.of(robot)
        assert set(motors.joint_names) == set(raw.joints) - followers
        assert_what_its_motor_allows(raw, motors.joints)
        shown = {joint.name: joint for joint in robot_scene(robot).joints}
        assert_what_its_motor_allows(raw, shown.values())
        assert_what_its_motor_allows(raw, robot.driven_joints.values())
        for name in followers:
            leader = shown[raw.motor(name)]
            assert shown[name].max_velocity == pytest.approx(raw.gear(name) * leader.max_velocity, rel=1e-12)
        assert not robot.outside_limits(robot.neutral)
        ends = {joint.name: joint.upper for joint in motors.joints if joint.upper < math.inf}
        assert not robot.outside_limits(ends)  # to the last bit, whatever a follower's end rounds to
        beyond = {outside.joint for outside in robot.outside_limits({name: end + 1e-6 for name, end in ends.items()})}
        assert {raw.motor(name) for name in beyond} == ends.keys()
        leaders = [raw.joints[name].find("mimic").get("joint") for name in followers]
        seen["a follower's follower"] += bool(followers & set(leaders))
        seen["a range for an endless joint"] += any(
            joint.kind == "revolute" and raw.joints[joint.name].get("type") == "continuous" for joint in motors.joints
        )
    assert min(seen.values()) >= 20, seen
    assert len(seen) == 4


def test_a_follower_off_the_path_slows_its_motor_everywhere(tmp_path: Path) -> None:
    robot = load(OFF_PATH, tmp_path)
    for space in (robot.chain("b", "l1"), robot.chain("b", "l2"), robot.tree("b", ["l1", "l2"]), Motors.of(robot)):
        assert [(joint.name, joint.max_velocity) for joint in space.joints] == [("m", 0.5)]
    written = json.loads(scene_json(robot_scene(robot)))  # what a page is told
    assert [(joint["name"], joint["velocity"]) for joint in written["joints"]] == [("m", 0.5), ("f", 1.0)]
    assert [(j.name, j.max_velocity) for j in robot.chain("l1", "l2").joints] == [("f", 1.0)]
    assert robot.joint_table().rows == (
        ("m", "revolute", "rad", "-1", "1", "0.5"),
        ("f", "revolute, follows m", "rad", "-2", "2", "1"),
    )


def test_the_command_line_says_so_and_slows_down(tmp_path: Path) -> None:
    load(OFF_PATH, tmp_path)
    for chain in ("b:l1", "b:l2"):
        spec = f"{tmp_path / 'robot.urdf'}:{chain}"
        asked = ("--by", "joints", "--from", "m=-1", "--to", "m=1", "--joint-acceleration", 50)
        data = json.loads(ok("trajectory", "plan", spec, *asked, "--format", "json"))
        assert data["duration"] == pytest.approx(2 / 0.5 + 0.5 / 50, abs=0.01)
        assert "0.5000   0.5000" in ok("trajectory", "plan", spec, *asked)
        told = CliRunner().invoke(application(["fk"]), ["fk", spec, "0.3"], catch_exceptions=False)
        assert told.stdout.splitlines()[3].split() == ["m", "0.300000", "17.189", "-1", "…", "1", "0.5"]
        told = CliRunner().invoke(application(["fk"]), ["fk", spec, "--format", "json"], catch_exceptions=False)
        assert json.loads(told.stdout)["limits"] == {"m": {"lower": -1.0, "upper": 1.0, "max_velocity": 0.5}}


def test_a_trajectory_too_fast_for_a_follower_off_the_path_is_refused(tmp_path: Path) -> None:
    load(OFF_PATH, tmp_path)
    (tmp_path / "fast.csv").write_text("time [s],m [rad]\n0,-1\n1,1\n")
    told = ok("trajectory", "run", tmp_path / "fast.csv", f"{tmp_path / 'robot.urdf'}:b:l1", status=1)
    assert "m needs a speed of 2 at sample 1; its limit is 0.5." in told


def test_joints_that_exclude_each_other_are_refused_but_shown(tmp_path: Path) -> None:
    """Their speeds are shown together all the same, and a posture outside a follower's range is said."""
    robot = load(OFF_PATH.replace('lower="-2" upper="2"', 'lower="4" upper="5"'), tmp_path)
    for ask in (lambda: robot.chain("b", "l1"), lambda: robot.neutral, lambda: Motors.of(robot)):
        with pytest.raises(InvalidInputError, match="a value of m that its follower f allows"):
            ask()
    scene = robot_scene(robot, {})
    assert [(j.lower, j.upper, j.max_velocity) for j in scene.joints] == [(-1.0, 1.0, 0.5), (4.0, 5.0, 1.0)]
    assert [outside.joint for outside in robot.outside_limits({})] == ["f"]
    assert "f" in robot.joint_table()._repr_html_()


def test_a_joint_that_a_follower_bounds_has_a_table(tmp_path: Path) -> None:
    """A continuous joint with a range is no continuous joint any more; a table of it would be refused."""
    endless = OFF_PATH.replace('name="m" type="revolute"', 'name="m" type="continuous"')
    chain = load(endless.replace('lower="-1" upper="1" ', ""), tmp_path).chain("b", "l1")
    assert [(j.kind, j.lower, j.upper) for j in chain.joints] == [("revolute", -1.0, 1.0)]
    assert nk.to_dh(chain).joints == chain.joints
