"""The closed form of six-joint legs: nothing lost, nothing invented, whatever the leg is fixed to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.form import Geometry, Mismatch
from nao_kin.analytic.nao import nao_leg
from nao_kin.analytic.nao import nao_leg as leg_kernel
from nao_kin.chain import Chain, in_limits, random_configurations
from nao_kin.kernels.forward import jacobians, poses
from nao_kin.se3 import from_xyz_rpy
from tests.analytic.searching import POSE, Branches, branches, moved, newton, random_poses, replace_path, wrapped
from tests.conftest import needs_examples, robot

if TYPE_CHECKING:
    from nao_kin.kernels.joint_path import JointPath

LEGS = [
    ("nao", "torso", "LLeg"),
    ("nao", "torso", "RLeg"),
    ("nao", "torso", "l_sole"),
    ("nao", "l_sole", "torso"),
    ("nao", "r_sole", "torso"),
    ("nao_v32_h25", "torso", "RLeg"),
]
THIGH, SHANK = 0.1, 0.1029  # [m] Aldebaran NAOqi documentation, ThighLength and TibiaLength
MIRROR = np.array([1.0, -1.0, 1.0, 1.0, 1.0, -1.0])  # a roll changes its sign from left to right, a pitch does not


def leg(name: str = "nao", base: str = "torso", tip: str = "LLeg") -> Chain:
    return robot(name).chain(base, tip)


def solved(path: JointPath, goals: np.ndarray, slack: float = 0.0) -> Branches:
    return branches(nao_leg, leg_kernel, path, goals, POSE, slack)


def smallest_singular_values(path: JointPath, Q: np.ndarray) -> np.ndarray:
    return np.linalg.svd(jacobians(path, Q), compute_uv=False)[:, -1]


@pytest.mark.parametrize("names", LEGS, ids="-".join)
def test_ten_thousand_configurations_come_back_among_eight_branches(
    names: tuple[str, str, str], rng: np.random.Generator
) -> None:
    chain = leg(*names)
    Q = random_configurations(chain, 10_000, rng)
    goals = chain.poses(Q)
    found = solved(chain.joint_path, goals)
    assert (found.counts == 8).all()
    assert (np.sort(found.label, axis=1) == np.arange(8)).all()
    regular = smallest_singular_values(chain.joint_path, Q) > 1e-6
    assert regular.mean() > 0.99
    assert found.distance(Q)[regular].max() < 1e-9
    assert found.errors(chain.joint_path, goals).max() < 1e-13
    for i in range(0, 10_000, 500):  # and as Pinocchio says
        for q in found.q[i]:
            assert np.abs(chain.pose(q).homogeneous - goals[i]).max() < 1e-13


def test_the_leg_of_another_humanoid_is_solved_too(rng: np.random.Generator) -> None:
    needs_examples()
    for name in ("left_leg", "right_leg"):
        chain = robot("talos").chain(name)
        Q = random_configurations(chain, 2000, rng)
        goals = chain.poses(Q)
        found = solved(chain.joint_path, goals)
        assert found.distance(Q).max() < 1e-8
        assert found.errors(chain.joint_path, goals).max() < 1e-12


@pytest.mark.parametrize("names", [LEGS[0], LEGS[3]], ids="-".join)
def test_newton_from_everywhere_finds_no_other_solution(names: tuple[str, str, str], rng: np.random.Generator) -> None:
    path = leg(*names).joint_path
    seen = 0
    for q in rng.uniform(-2.5, 2.5, (5, 6)):
        goal = poses(path, q[None, :])
        found = solved(path, goal)

        def residual(Q: np.ndarray, goal: np.ndarray = goal) -> np.ndarray:
            T = poses(path, Q)
            E = np.einsum("nij,kj->nik", T[:, :3, :3], goal[0, :3, :3])
            turned = 0.5 * np.stack([E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]], 1)
            half_turn = np.where(np.trace(E, axis1=1, axis2=2) < 0.0, 1.0, 0.0)  # where the sine vanishes too
            return np.hstack([10.0 * (T[:, :3, 3] - goal[:, :3, 3]), turned, half_turn[:, None]])

        def jacobian(Q: np.ndarray) -> np.ndarray:
            J = jacobians(path, Q)
            return np.concatenate([10.0 * J[:, :3], J[:, 3:], np.zeros((len(Q), 1, 6))], axis=1)

        roots = newton(residual, jacobian, rng.uniform(-np.pi, np.pi, (300, 6)))
        distance = np.abs(wrapped(roots[:, None] - found.q[0][None])).max(axis=2)
        assert distance.min(axis=1).max() < 1e-6
        seen += len(set(distance.argmin(axis=1).tolist()))
    assert seen >= 5 * 7  # the search is worth something: it finds nearly all of the eight


def test_the_right_leg_mirrors_the_left_one(rng: np.random.Generator) -> None:
    left, right = leg(tip="LLeg"), leg(tip="RLeg")
    goals = left.poses(random_configurations(left, 500, rng))
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    on_the_left, on_the_right = solved(left.joint_path, goals), solved(right.joint_path, mirror @ goals @ mirror)
    by_label = np.take_along_axis(on_the_left.q, np.argsort(on_the_left.label, axis=1)[:, :, None], axis=1)
    mirrored = np.take_along_axis(on_the_right.q, np.argsort(on_the_right.label, axis=1)[:, :, None], axis=1)
    assert np.abs(wrapped(by_label * MIRROR - mirrored)).max() < 1e-9


def test_base_tool_axis_signs_and_offsets_may_be_anything(rng: np.random.Generator) -> None:
    path = leg().joint_path
    for _ in range(40):
        base, tool = (T for T in random_poses(rng, 2, 0.7))
        changed = replace_path(
            moved(path, base, tool),
            multipliers=rng.choice([-1.0, 1.0], 6),
            offsets=rng.uniform(-3.0, 3.0, 6),
        )
        Q = rng.uniform(-3.0, 3.0, (50, 6))
        goals = poses(changed, Q)
        found = solved(changed, goals)
        assert (found.counts == 8).all()
        assert found.distance(Q).max() < 1e-8
        assert found.errors(changed, goals).max() < 1e-12


def test_an_ankle_beside_the_plane_of_the_thigh_is_solved(rng: np.random.Generator) -> None:
    beside = ankle_beside()
    Q = rng.uniform(-3.0, 3.0, (3000, 6))
    goals = poses(beside, Q)
    found = solved(beside, goals)
    assert (found.counts == 8).all()
    assert found.distance(Q)[smallest_singular_values(beside, Q) > 1e-4].max() < 1e-9
    assert found.errors(beside, goals).max() < 1e-12


@pytest.mark.parametrize(
    ("joint", "shift", "words"),
    [
        (1, 1e-6, "first three axes miss a common point"),
        (5, 1e-6, "last two axes miss a common point"),
    ],
)
def test_a_leg_that_is_not_one_is_refused_with_what_was_measured(joint: int, shift: float, words: str) -> None:
    path = leg().joint_path
    translations = path.translations.copy()
    translations[joint] += shift
    told = nao_leg.recognise(replace_path(path, translations=translations))
    assert isinstance(told, Mismatch)
    assert words in told.reason
    tilt = from_xyz_rpy(rpy=(1e-6, 2e-6, 0.0)).rotation
    rotations = path.rotations.copy()
    rotations[3] = rotations[3] @ tilt
    told = nao_leg.recognise(replace_path(path, rotations=rotations))
    assert isinstance(told, Mismatch)
    assert "parallel" in told.reason


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_table_of_a_document_is_the_same_leg(side: str, rng: np.random.Generator) -> None:
    table = nk.document_chain(f"kofinas_{side}_leg")
    Q = rng.uniform(-3.0, 3.0, (1000, 6))
    found = solved(table.joint_path, table.poses(Q))
    assert found.distance(Q)[smallest_singular_values(table.joint_path, Q) > 1e-6].max() < 1e-9
    assert found.errors(table.joint_path, table.poses(Q)).max() < 1e-13


def test_every_solution_is_judged_in_and_out_of_limits(rng: np.random.Generator) -> None:
    chain = leg()
    for q in random_configurations(chain, 20, rng):
        results = nk.solve_all(chain, chain.pose(q))
        assert len(results) == 8
        assert {result.branch for result in results} == set(nao_leg.LABELS)
        assert results[0].solved
        for result in results:
            assert result.status in (nk.Status.SOLVED, nk.Status.OUTSIDE_LIMITS)
            assert (result.status is nk.Status.SOLVED) == in_limits(chain, result.q, 1e-9)
            assert np.abs(chain.pose(result.q).homogeneous - chain.pose(q).homogeneous).max() < 1e-13
        assert nk.nearest(results, q).q == pytest.approx(q, abs=1e-8)
    far = chain.pose(np.zeros(6))
    far.translation = far.translation - np.array([0.0, 0.0, 0.01])
    unreached = nk.solve_all(chain, far)
    assert not unreached
    assert "misses by 0.01 m" in unreached.reason


def test_other_chains_are_no_legs() -> None:
    for chain in (robot("nao").chain("left_arm"), robot("jaco2").chain("arm"), robot("phantomx").chain("leg_lf")):
        assert isinstance(nao_leg.recognise(chain.joint_path), Mismatch)
    assert isinstance(nao_leg.recognise(leg().joint_path), Geometry)


def leg_for(kind: str) -> JointPath:
    """The left leg; for the hip's singularity with a hip roll that may go there, which NAO's own may not."""
    path = leg().joint_path
    if kind != "hip":
        return path
    lower = path.lower.copy()
    lower[1] = -1.0
    return replace_path(path, lower=lower)


def singular(kind: str, distance: float, rng: np.random.Generator, count: int) -> np.ndarray:
    """Configurations (count, 6) of that leg, within limits, at a distance [rad] from a singularity."""
    path = leg_for(kind)
    Q = rng.uniform(path.lower + 0.05, path.upper - 0.05, (count, 6))
    if kind == "knee":
        Q[:, 3] = distance
    elif kind == "hip":
        Q[:, 1] = distance - math.pi / 4  # where the hip's yaw axis is along its pitch axis
    elif kind == "ankle":
        Q[:, 3] = rng.uniform(1.9, 2.1, count)
        # The hip on the axis of the ankle roll: thigh · cos(t4 + t5) + shank · cos t5 = 0.
        Q[:, 4] = np.arctan2(THIGH * np.cos(Q[:, 3]) + SHANK, THIGH * np.sin(Q[:, 3])) + distance
    return Q


@pytest.mark.parametrize("kind", ["knee", "hip", "ankle"])
def test_near_singularities_poses_are_kept_and_errors_small(kind: str, rng: np.random.Generator) -> None:
    path = leg_for(kind)
    for distance in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 0.0):
        Q = singular(kind, distance, rng, 200)
        assert ((path.lower < Q) & (path.upper > Q)).all()
        goals = poses(path, Q)
        found = solved(path, goals)
        assert found.errors(path, goals).max() < 1e-11
        inside = ((found.q >= path.lower - 1e-9) & (found.q <= path.upper + 1e-9)).all(axis=2) & found.exists
        assert inside.any(axis=1).all()  # a solution within limits is there, as there was
        regular = smallest_singular_values(path, Q) > 1e-6
        assert found.distance(Q)[regular].max(initial=0.0) < 1e-9


@pytest.mark.parametrize(
    ("kind", "words"),
    [("knee", "both knee branches in one"), ("hip", "any hip yaw"), ("ankle", "any ankle roll")],
)
def test_at_a_singularity_one_solution_stands_for_all_and_says_so(
    kind: str, words: str, rng: np.random.Generator
) -> None:
    path = leg_for(kind)
    found = solved(path, poses(path, singular(kind, 0.0, rng, 200)))
    told = np.array([words in each for each in nao_leg.SINGULARITIES])[found.singularity]
    # All branches of one goal share the knee and the hip's first two axes, so all are singular and half in number.
    assert told[found.exists].all()
    assert (found.counts == 4).all()


def test_the_border_of_the_reachable_set(rng: np.random.Generator) -> None:
    chain = leg()
    Q = singular("knee", 0.0, rng, 300)
    goals = chain.poses(Q)
    hip, ankle = np.array([0.0, 0.05, -0.085]), goals[:, :3, 3] + goals[:, :3, 2] * 0.04519
    away = (ankle - hip) / (THIGH + SHANK)
    for beyond in (1e-13, -1e-12, -1e-9, -1e-6):
        shifted = goals.copy()
        shifted[:, :3, 3] += beyond * away
        found = solved(chain.joint_path, shifted)
        assert (found.counts >= 4).all()
        assert found.errors(chain.joint_path, shifted).max() < 1e-12
    shifted = goals.copy()
    shifted[:, :3, 3] += 1e-6 * away  # out of reach by a micrometre
    assert (solved(chain.joint_path, shifted).counts == 0).all()
    at_the_border = solved(chain.joint_path, shifted, slack=1.1e-6)
    assert (at_the_border.counts >= 2).all()
    assert at_the_border.errors(chain.joint_path, shifted).max() < 1.0001e-6


def test_limits_are_reached_and_not_passed(rng: np.random.Generator) -> None:
    chain = leg()
    Q = np.where(rng.random((500, 6)) < 0.5, chain.lower, chain.upper)
    goals = chain.poses(Q)
    found = solved(chain.joint_path, goals)
    assert found.distance(Q).max() < 1e-9
    assert found.errors(chain.joint_path, goals).max() < 1e-13


def test_no_goal_however_degenerate_gives_a_number_that_is_none(rng: np.random.Generator) -> None:
    path = leg().joint_path
    hip = np.array([0.0, 0.05, -0.085])
    goals = random_poses(rng, 10_000, 0.5)
    goals[:2000, :3, :3] = np.eye(3)[rng.permutation(3)]  # axes along axes, some of them reflections
    at_hip = slice(2000, 4000)  # the ankle in the hip, or nearly so
    goals[at_hip, :3, 3] = hip - 0.04519 * goals[at_hip, :3, 2] + rng.choice([0.0, 1e-300, 1e-16, 0.0029], (2000, 1))
    goals[4000:6000, :3, 3] *= rng.choice([1e-320, 1e-9, 1e150, 1e300], (2000, 1))
    goals[6000:7000, :3, :3] = 0.0
    goals[7000:8000] = rng.choice([np.nan, np.inf, -np.inf, 0.0, 1.0], (1000, 4, 4))
    with np.errstate(all="ignore"):
        for slack in (0.0, 1e-6, math.inf):
            solved(path, goals, slack)  # asserts that what is written is finite


def test_an_ankle_beside_the_plane_has_a_turning_point(rng: np.random.Generator) -> None:
    """Where the hip is as far beside the foot as the ankle is beside the thigh, both ankle branches meet."""
    beside = ankle_beside()
    for distance in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0):
        Q = singular("ankle", distance, rng, 200)
        goals = poses(beside, Q)
        found = solved(beside, goals)
        assert (found.counts >= 4).all()
        assert found.errors(beside, goals).max() < 1e-11
        regular = smallest_singular_values(beside, Q) > 1e-6
        assert found.distance(Q)[regular].max(initial=0.0) < 1e-8
    assert (found.counts == 4).all()
    met = np.array(["both ankle branches in one" in words for words in nao_leg.SINGULARITIES])
    assert met[found.singularity[found.exists]].all()


def ankle_beside() -> JointPath:
    """The left leg with its ankle 2 cm beside the plane of the thigh."""
    path = leg().joint_path
    translations = path.translations.copy()
    translations[4] += 0.02 * np.array([0.0, 0.0, 1.0])  # along the pitch axes, which are z of their own frames
    return replace_path(path, translations=translations)
