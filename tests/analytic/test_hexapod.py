"""The closed form of hexapod legs: four solutions, whatever the leg is fixed to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.form import Geometry, Mismatch
from nao_kin.analytic.hexapod import hexapod_leg as hexapod
from nao_kin.analytic.hexapod import hexapod_leg as hexapod_kernel
from nao_kin.chain import Chain, random_configurations
from nao_kin.kernels.forward import jacobians, poses
from tests.analytic.searching import POSITION, Branches, branches, moved, newton, random_poses, replace_path, wrapped
from tests.analytic.walkers import HIP, LEGS, SHIN, THIGH, phantomx_legs, round_legs
from tests.conftest import robot

if TYPE_CHECKING:
    from nao_kin.kernels.joint_path import JointPath


def solved(path: JointPath, goals: np.ndarray, slack: float = 0.0) -> Branches:
    return branches(hexapod, hexapod_kernel, path, goals, POSITION, slack)


def smallest_singular_values(path: JointPath, Q: np.ndarray) -> np.ndarray:
    return np.linalg.svd(jacobians(path, Q)[:, :3], compute_uv=False)[:, -1]


def misses(path: JointPath, points: np.ndarray) -> np.ndarray:
    geometry = hexapod.recognise(path)
    assert isinstance(geometry, Geometry)
    missed = np.empty(len(points))
    hexapod_kernel.misses_by_many(geometry.parameters, goals_at(points), missed)
    return missed


def goals_at(points: np.ndarray) -> np.ndarray:
    goals = np.tile(np.eye(4), (len(points), 1, 1))
    goals[:, :3, 3] = points
    return goals


def a_leg() -> Chain:
    return phantomx_legs()["rf"]


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize("walker", ["phantomx", "round"])
def test_ten_thousand_configurations_come_back(walker: str, name: str, rng: np.random.Generator) -> None:
    chain = (phantomx_legs() if walker == "phantomx" else round_legs())[name]
    Q = random_configurations(chain, 10_000, rng)
    goals = chain.poses(Q)
    found = solved(chain.joint_path, goals)
    assert set(found.counts.tolist()) == {2, 4}  # reaching over is not always possible
    regular = smallest_singular_values(chain.joint_path, Q) > 1e-6
    assert regular.mean() > 0.99
    assert found.distance(Q)[regular].max() < 1e-9
    assert found.errors(chain.joint_path, goals, rows=0).max() < 1e-14
    assert np.abs(misses(chain.joint_path, goals[:, :3, 3])).max() < 1e-15
    for i in range(0, 10_000, 500):  # and as the chain's own arithmetic says
        for q in found.q[i][found.exists[i]]:
            assert np.abs(chain.pose(q).translation - goals[i, :3, 3]).max() < 1e-14


def test_newton_from_everywhere_finds_no_other_solution(rng: np.random.Generator) -> None:
    for path in (a_leg().joint_path, skewed(a_leg().joint_path)):
        for q in rng.uniform(-2.5, 2.5, (6, 3)):
            goal = poses(path, q[None, :])
            found = solved(path, goal)
            roots = newton(
                lambda Q, path=path, goal=goal: 10.0 * (poses(path, Q)[:, :3, 3] - goal[:, :3, 3]),  # type: ignore[misc]
                lambda Q, path=path: 10.0 * jacobians(path, Q)[:, :3],  # type: ignore[misc]
                rng.uniform(-np.pi, np.pi, (100, 3)),
            )
            distance = np.abs(wrapped(roots[:, None] - found.q[0][found.exists[0]][None])).max(axis=2)
            assert distance.min(axis=1).max() < 1e-6
            assert set(distance.argmin(axis=1).tolist()) == set(range(found.counts[0]))  # the search finds them all


def skewed(path: JointPath) -> JointPath:
    """The leg with a foot beside the plane through its coxa axis."""
    tool = path.tool_translation.copy()
    tool += 0.01 * np.array([0.0, 0.0, 1.0])  # along the tibia axis, which is z of its own frame
    return replace_path(path, tool_translation=tool)


def test_base_tool_axis_signs_and_offsets_may_be_anything(rng: np.random.Generator) -> None:
    path = skewed(a_leg().joint_path)
    for _ in range(40):
        base, turn = random_poses(rng, 2, 0.7)
        turn[:3, 3] = 0.0
        changed = replace_path(
            moved(path, base, turn), multipliers=rng.choice([-1.0, 1.0], 3), offsets=rng.uniform(-3.0, 3.0, 3)
        )
        Q = rng.uniform(-3.0, 3.0, (50, 3))
        goals = poses(changed, Q)
        found = solved(changed, goals)
        assert found.distance(Q)[smallest_singular_values(changed, Q) > 1e-5].max() < 1e-9
        assert found.errors(changed, goals, rows=0).max() < 1e-13


def test_labels_say_where_the_knee_and_the_coxa_are(rng: np.random.Generator) -> None:
    for chain in (*phantomx_legs().values(), *round_legs().values()):
        path = chain.joint_path
        coxa_axis = path.rotations[0] @ np.array([0.0, 0.0, 1.0])
        up = coxa_axis if coxa_axis[2] > 0.0 else -coxa_axis
        Q = random_configurations(chain, 50, rng)
        goals = chain.poses(Q)
        found = solved(path, goals)
        for i, k in np.argwhere(found.exists).tolist():
            links = chain.link_poses(found.q[i, k])
            hip, foot = path.translations[0], goals[i, :3, 3]
            femur, knee = joint_points(chain, found.q[i, k])
            words = hexapod.LABELS[found.label[i, k]]
            over = (femur - hip)[:2] @ (foot - hip)[:2] < 0.0
            assert ("reaching over" in words) == bool(over)
            outwards = (femur - hip) - up * (up @ (femur - hip))
            line = foot - femur
            # Above the line on the side of the leg that points at the foot, seen along the leg's plane.
            turn = np.cross(line, knee - femur) @ np.cross(outwards, up) * (-1.0 if over else 1.0)
            if abs(turn) > 1e-9:
                assert ("knee up" in words) == bool(turn > 0.0)
            assert len(links) == 3


def joint_points(chain: Chain, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A point on the femur axis and on the tibia axis."""
    path, T, points = chain.joint_path, np.eye(4), []
    for k in range(3):
        P, Z = np.eye(4), np.eye(4)
        P[:3, :3], P[:3, 3] = path.rotations[k], path.translations[k]
        v = path.multipliers[k] * q[k] + path.offsets[k]
        Z[:2, :2] = [[math.cos(v), -math.sin(v)], [math.sin(v), math.cos(v)]]
        T = T @ P
        points.append(T[:3, 3].copy())
        T = T @ Z
    return points[1], points[2]


def test_how_far_a_foot_is_out_of_reach_is_what_a_search_finds(rng: np.random.Generator) -> None:
    chain = round_legs()["rm"]
    path = chain.joint_path
    hip = path.translations[0]
    points = hip + rng.uniform(-0.3, 0.3, (60, 3))
    near_the_axis = hip + np.array([[0.03, 0.0, 0.0], [0.02, 0.01, -0.01], [0.0, 0.0, 0.001], [-0.03, 0.0, 0.0]])
    points = np.vstack([points, near_the_axis])
    missed = misses(path, points)
    assert (missed != 0.0).sum() > 30
    assert (missed < 0.0).any()
    t = np.linspace(-math.pi, math.pi, 361)
    # The distance in the half-plane through the coxa axis and the foot, to all that femur and tibia reach in it.
    for point, miss in zip(points - hip, missed.tolist(), strict=True):
        out, z = math.hypot(point[0], point[1]), point[2]
        thigh, knee = np.meshgrid(t, t)
        x = HIP + THIGH * np.cos(thigh) + SHIN * np.cos(thigh + knee)
        height = THIGH * np.sin(thigh) + SHIN * np.sin(thigh + knee)
        searched = np.hypot(np.abs(x) - out, height - z).min()
        assert abs(miss) == pytest.approx(searched, abs=2e-3)
        assert (miss == 0.0) == bool(solved(path, goals_at(point[None, :] + hip)).counts[0])


@pytest.mark.parametrize("skew", [False, True])
def test_near_singularities_feet_are_kept_and_errors_small(skew: bool, rng: np.random.Generator) -> None:
    path = a_leg().joint_path
    path = skewed(path) if skew else path
    geometry = hexapod.recognise(path)
    assert isinstance(geometry, Geometry)
    straight = float(-geometry.parameters[21] / geometry.parameters[18])  # q3 of the straight leg
    for distance in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 0.0):
        Q = rng.uniform(-2.0, 2.0, (200, 3))
        Q[:, 2] = straight + distance
        goals = poses(path, Q)
        found = solved(path, goals)
        assert found.errors(path, goals, rows=0).max() < 1e-12
        regular = smallest_singular_values(path, Q) > 1e-6
        assert found.distance(Q)[regular].max(initial=0.0) < 1e-9
        on_axis = goals_at(rng.uniform(-0.15, 0.15, (200, 3)))
        side = np.array([0.0, 0.01]) if skew else np.array([0.0, 0.0])
        on_axis[:, :3, 3] = path.translations[0] + np.outer(
            np.ones(200), path.rotations[0] @ np.array([side[0] + distance, side[1], 0.0])
        )
        on_axis[:, 2, 3] += rng.uniform(-0.15, -0.08, 200)
        found = solved(path, on_axis)
        assert (found.counts >= 2).all()
        assert found.errors(path, on_axis, rows=0).max() < 1e-12


def test_a_foot_on_the_coxa_axis_leaves_the_coxa_free() -> None:
    chain = a_leg()
    point = chain.joint_path.translations[0] + np.array([0.0, 0.0, -0.12])
    found = nk.solve_all(chain, point)
    assert len(found) == 2
    assert all("any coxa" in result.branch and result.q[0] == 0.0 for result in found)
    assert all(result.position_error is not None and result.position_error < 1e-15 for result in found)


def test_the_border_of_the_reachable_set(rng: np.random.Generator) -> None:
    chain = round_legs()["lf"]
    path = chain.joint_path
    Q = rng.uniform(-1.0, 1.0, (300, 3))
    Q[:, 2] = math.pi  # thigh and shin in one line
    goals = chain.poses(Q)
    femur = np.array([joint_points(chain, q)[0] for q in Q])
    away = (goals[:, :3, 3] - femur) / (THIGH + SHIN)
    for beyond, least in ((1e-14, 1), (-1e-12, 1), (-1e-9, 2), (-1e-6, 2)):
        shifted = goals_at(goals[:, :3, 3] + beyond * away)
        found = solved(path, shifted)
        assert (found.counts >= least).all()
        assert found.errors(path, shifted, rows=0).max() < 1e-12
    shifted = goals_at(goals[:, :3, 3] + 1e-6 * away)  # out of reach by a micrometre
    assert (solved(path, shifted).counts == 0).all()
    assert misses(path, shifted[:, :3, 3]) == pytest.approx(1e-6, rel=1e-6)
    assert solved(path, shifted, slack=1.1e-6).errors(path, shifted, rows=0).max() < 1.0001e-6


def test_other_chains_are_no_hexapod_legs() -> None:
    path = a_leg().joint_path
    rotations = path.rotations.copy()
    rotations[2] = rotations[2] @ nk.load("phantomx").pose({}, "foot_lm").rotation
    for other in (
        robot("nao").chain("head").joint_path,
        robot("nao").chain("left_leg").joint_path,
        replace_path(path, rotations=rotations),
        robot("phantomx").chain("foot_lf", "base_link").joint_path,  # met from the foot, the parallel pair comes first
    ):
        assert isinstance(hexapod.recognise(other), Mismatch)


def test_no_goal_however_degenerate_gives_a_number_that_is_none(rng: np.random.Generator) -> None:
    for path in (a_leg().joint_path, skewed(a_leg().joint_path), equal_links().joint_path):
        goals = random_poses(rng, 10_000, 0.3)
        goals[:2000, :3, 3] = path.translations[0] + rng.choice([0.0, 1e-300, 1e-16, 0.054], (2000, 3))
        goals[2000:4000, :3, 3] *= rng.choice([1e-320, 1e-9, 1e150, 1e300], (2000, 1))
        goals[4000:5000] = rng.choice([np.nan, np.inf, -np.inf, 0.0, 1.0], (1000, 4, 4))
        for slack in (0.0, 1e-6, math.inf):
            solved(path, goals, slack)  # asserts that what is written is finite


def test_links_of_one_length_fold_onto_the_femur_axis() -> None:
    chain = equal_links()
    found = nk.solve_all(chain, np.array([0.05, 0.0, 0.0]))
    assert {"coxa forward, knee up, both knee branches in one, any femur"} == {result.branch for result in found[:1]}
    assert all(result.position_error is not None and result.position_error < 1e-15 for result in found)


def equal_links() -> Chain:
    rows = [(0.05, math.pi / 2, 0.0, 0.0), (0.07, 0.0, 0.0, 0.0), (0.07, 0.0, 0.0, 0.0)]
    return nk.DHChain.from_table(rows, "standard", name="equal links")
