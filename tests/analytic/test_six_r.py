"""Closed forms of six-joint arms: recognised by their axes, nothing lost, nothing invented, singular poses kept."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.form import Mismatch
from nao_kin.analytic.six_r import elbow as six_r_elbow
from nao_kin.analytic.six_r import general as six_r_general
from nao_kin.analytic.six_r import recognising as six_r
from nao_kin.analytic.six_r import six_r_bent_wrist as six_r_bent
from nao_kin.kernels.audit import tips
from nao_kin.kernels.forward import jacobians, poses
from nao_kin.se3 import from_xyz_rpy
from tests.analytic.searching import POSE, Branches, branches, moved, newton, random_poses, replace_path, wrapped
from tests.conftest import needs_examples, robot

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.kernels.joint_path import JointPath

ENDS = {"kinova": ("j2s6s200_link_base", "j2s6s200_end_effector"), "jaco2": ("link_base", "end_effector")}
ENDS |= dict.fromkeys(("ur3", "ur5", "ur10"), ("base_link", "ee_link")) | {"z1": ("link00", "link06")}
CLASSES = dict.fromkeys(("ur3", "ur5", "ur10", "z1"), six_r.THREE_PARALLEL)
CLASSES |= {"kinova": six_r.SPHERICAL, "jaco2": six_r.BENT_WRIST}
ARMS = [pytest.param(name, mirror, id=f"{name}{'-mirrored' * mirror}") for name in CLASSES for mirror in (False, True)]
KERNELS = {
    six_r.THREE_PARALLEL: SimpleNamespace(BRANCHES=8, solve_many=six_r_elbow.solve_parallel_many),
    six_r.SPHERICAL: SimpleNamespace(BRANCHES=8, solve_many=six_r_elbow.solve_spherical_many),
    six_r.BENT_WRIST: six_r_bent,
}


def arm(name: str, mirror: bool = False) -> Chain:
    if name != "jaco2":
        needs_examples()
    base, tip = ENDS[name]
    return robot(name).chain(tip, base) if mirror else robot(name).chain(base, tip)


def solved(kind: six_r.SixRClass, path: JointPath, goals: Floats, slack: float = 0.0) -> Branches:
    form: Any = SimpleNamespace(recognise=partial(six_r.recognise, kind=kind))
    return branches(form, KERNELS[kind], path, goals, POSE, slack)


def smallest_singular_values(path: JointPath, Q: Floats) -> Floats:
    return np.linalg.svd(jacobians(path, np.ascontiguousarray(Q)), compute_uv=False)[:, -1]


def disturbed(path: JointPath, rng: np.random.Generator, metres: float, radians: float) -> JointPath:
    """The path with every placement off by so much."""
    rotations, translations = path.rotations.copy(), path.translations.copy()
    for k in range(6):
        T = from_xyz_rpy(rng.uniform(-metres, metres, 3), rng.uniform(-radians, radians, 3)).homogeneous
        rotations[k], translations[k] = rotations[k] @ T[:3, :3], translations[k] + T[:3, 3]
    return replace_path(path, rotations=rotations, translations=translations)


def missing(path: JointPath, found: Branches, goals: Floats, rng: np.random.Generator, starts: int) -> int:
    """Regular solutions that Newton finds from random starts and that are not among the branches."""
    count = 0
    for i, goal in enumerate(goals):

        def residual(Q: Floats, goal: Floats = goal) -> Floats:
            T = tips(path, np.ascontiguousarray(Q))
            E = goal[:3, :3] @ T[:, :3, :3].transpose(0, 2, 1)
            turn = 0.5 * np.stack([E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]], axis=1)
            turn[np.trace(E, axis1=1, axis2=2) < 0.0] += 1.0  # half a turn away is no root
            return np.concatenate([T[:, :3, 3] - goal[:3, 3], -turn], axis=1)

        roots = newton(
            residual, lambda Q: jacobians(path, np.ascontiguousarray(Q)), rng.uniform(-np.pi, np.pi, (starts, 6))
        )
        if len(roots):
            roots = roots[smallest_singular_values(path, roots) > 1e-4]
        known = found.q[i][found.exists[i]]
        count += sum(not len(known) or np.abs(wrapped(known - q)).max(axis=1).min() > 1e-5 for q in roots)
    return count


@pytest.mark.parametrize(("name", "mirror"), ARMS)
def test_random_configurations_come_back(name: str, mirror: bool, rng: np.random.Generator) -> None:
    chain, kind = arm(name, mirror), CLASSES[name]
    Q = rng.uniform(-np.pi, np.pi, (3000 if mirror or kind is six_r.BENT_WRIST else 10_000, 6))
    goals = chain.poses(Q)
    found = solved(kind, chain.joint_path, goals)
    assert (found.counts > 0).all()
    values = smallest_singular_values(chain.joint_path, Q)
    assert (values > 1e-6).mean() > 0.99
    assert found.distance(Q)[values > 1e-6].max() < 1e-9
    assert found.errors(chain.joint_path, goals).max() < 1e-10
    assert (found.counts % 2 == 0).mean() > 0.999
    for i in range(0, len(Q), 1000):  # and as Pinocchio says
        for q in found.q[i][found.exists[i]]:
            assert np.abs(chain.pose(q).homogeneous - goals[i]).max() < 1e-10


@pytest.mark.parametrize(("name", "mirror"), [("ur5", False), ("z1", True), ("kinova", False), ("jaco2", False)])
def test_newton_from_everywhere_finds_no_other_solution(name: str, mirror: bool, rng: np.random.Generator) -> None:
    path = arm(name, mirror).joint_path
    goals = poses(path, rng.uniform(-np.pi, np.pi, (4, 6)))
    assert missing(path, solved(CLASSES[name], path, goals), goals, rng, 150) == 0


@pytest.mark.parametrize(("name", "mirror"), ARMS)
def test_singular_poses_keep_a_labelled_solution(name: str, mirror: bool, rng: np.random.Generator) -> None:
    chain, kind = arm(name, mirror), CLASSES[name]
    Q = rng.uniform(-np.pi, np.pi, (900, 6))
    elbow, wrist = (3, 1) if mirror else (2, 4)
    Q[:300, elbow] = 0.0 if name.startswith("ur") else _singular_joint(chain.joint_path, Q[0], elbow)
    Q[300:600, wrist] = _singular_joint(chain.joint_path, Q[0], wrist) if name in ("z1", "kinova") else 0.0
    Q[600:, elbow], Q[600:, wrist] = Q[:300, elbow], Q[300:600, wrist]
    goals = chain.poses(Q)
    found = solved(kind, chain.joint_path, goals, 1e-6)
    assert (found.counts > 0).all(), np.flatnonzero(found.counts == 0)
    assert found.errors(chain.joint_path, goals).max() < 1e-9


def _singular_joint(path: JointPath, q: Floats, joint: int) -> float:
    """A value of a joint at which the arm is singular whatever the others are, if there is one."""
    angles = np.linspace(-np.pi, np.pi, 721)
    Q = np.tile(q, (721, 1))
    Q[:, joint] = angles
    values = np.linalg.det(jacobians(path, np.ascontiguousarray(Q)))
    other = Q.copy()
    other[:, [k for k in range(6) if k != joint]] += 0.7
    others = np.linalg.det(jacobians(path, other))
    changes = np.flatnonzero(
        (np.sign(values[:-1]) != np.sign(values[1:])) & (np.sign(others[:-1]) != np.sign(others[1:]))
    )
    return float(_bisected(path, q, joint, angles[changes[0]], angles[changes[0] + 1])) if len(changes) else 0.0


def singular_by(joint: int, path: JointPath, count: int, rng: np.random.Generator) -> Floats:
    """Joints at which the Jacobian's determinant changes its sign as one joint turns."""

    def determinants(Q: Floats, values: Floats) -> Floats:
        moved_joint = Q.copy()
        moved_joint[:, joint] = values
        return np.linalg.det(jacobians(path, moved_joint))

    Q = rng.uniform(-np.pi, np.pi, (20 * count, 6))
    low = Q[:, joint].copy()
    high = low + 0.5
    start = determinants(Q, low) < 0.0
    change = np.flatnonzero(start != (determinants(Q, high) < 0.0))[:count]
    Q, low, high, start = Q[change], low[change], high[change], start[change]
    for _ in range(70):
        middle = 0.5 * (low + high)
        same = (determinants(Q, middle) < 0.0) == start
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    Q[:, joint] = low
    return Q


@pytest.mark.parametrize("joint", [1, 2, 3, 4])
def test_a_bent_wrist_keeps_the_joints_of_exactly_singular_poses(joint: int, rng: np.random.Generator) -> None:
    path = arm("jaco2").joint_path
    Q = singular_by(joint, path, 300, rng)
    assert len(Q) == 300
    assert np.median(smallest_singular_values(path, Q)) < 1e-14
    found = solved(six_r.BENT_WRIST, path, poses(path, Q), 1e-6)
    assert found.distance(Q).max() < 1e-5  # where two solutions are one, half the digits are


def test_a_bent_wrist_that_is_straight_and_square_keeps_its_joints(rng: np.random.Generator) -> None:
    path = arm("jaco2").joint_path
    Q = rng.integers(-2, 3, (400, 6)) * (np.pi / 2.0)
    assert solved(six_r.BENT_WRIST, path, poses(path, Q), 1e-6).distance(Q).max() < 1e-5


def test_far_more_samples_find_no_other_solution_of_a_bent_wrist(rng: np.random.Generator) -> None:
    path = arm("jaco2").joint_path
    goals = poses(path, rng.uniform(-np.pi, np.pi, (300, 6)))
    found: Any = solved(six_r.BENT_WRIST, path, goals)
    geometry: Any = six_r.recognise(path, six_r.BENT_WRIST)
    rows, counts = np.zeros((300, six_r_bent.BRANCHES, 8)), np.zeros(300, dtype=np.int64)
    six_r_bent.solve_densely(geometry.parameters, 20 * six_r_bent.SAMPLES, goals, rows, counts)
    for i in range(300):
        for q in rows[i, : counts[i], :6]:
            assert np.abs(wrapped(found.q[i][found.exists[i]] - q)).max(axis=1).min() < 1e-5


def _bisected(path: JointPath, q: Floats, joint: int, a: float, b: float) -> float:
    def value(x: float) -> float:
        v = q.copy()
        v[joint] = x
        return float(np.linalg.det(jacobians(path, v[None])[0]))

    low = value(a)
    for _ in range(60):
        middle = 0.5 * (a + b)
        if (value(middle) < 0.0) == (low < 0.0):
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


@pytest.mark.parametrize("name", ["ur5", "kinova", "jaco2"])
def test_an_arm_with_rounded_numbers_is_solved_on_its_own_numbers(name: str, rng: np.random.Generator) -> None:
    path = disturbed(arm(name).joint_path, rng, 2e-5, 2e-6)
    Q = rng.uniform(-np.pi, np.pi, (2000, 6))
    goals = tips(path, Q)
    found = solved(CLASSES[name], path, goals, 1e-4)
    assert found.errors(path, goals).max() < 1e-10
    regular = smallest_singular_values(path, Q) > 1e-2
    assert found.distance(Q)[regular].max() < 1e-9


def test_an_arm_that_is_off_parallel_is_told_by_how_much() -> None:
    path = arm("ur5").joint_path
    rotations = path.rotations.copy()
    c, s = np.cos(6e-3), np.sin(6e-3)
    rotations[2] = rotations[2] @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    refused = six_r.recognise(replace_path(path, rotations=rotations), six_r.THREE_PARALLEL)
    assert isinstance(refused, Mismatch)
    assert "axes 2 and 3 are 0.006 rad off parallel where 1e-05 is allowed" in refused.reason


@pytest.mark.parametrize(("name", "mirror"), ARMS)
def test_base_and_tool_may_be_anywhere(name: str, mirror: bool, rng: np.random.Generator) -> None:
    base = from_xyz_rpy([0.3, -0.2, 0.5], [0.7, -1.1, 2.0]).homogeneous
    tool = from_xyz_rpy([-0.1, 0.2, 0.05], [2.5, 0.4, -0.9]).homogeneous
    path = moved(arm(name, mirror).joint_path, base, tool)
    Q = rng.uniform(-np.pi, np.pi, (300, 6))
    goals = tips(path, Q)
    found = solved(CLASSES[name], path, goals)
    assert found.distance(Q)[smallest_singular_values(path, Q) > 1e-3].max() < 1e-9
    assert found.errors(path, goals).max() < 1e-10


@pytest.mark.parametrize(("name", "mirror"), ARMS)
def test_any_pose_gives_finite_solutions_that_hold(name: str, mirror: bool, rng: np.random.Generator) -> None:
    path = arm(name, mirror).joint_path
    goals = random_poses(rng, 2000, 1.5)
    goals[:200, :3, :3] = np.eye(3)
    goals[200:210, :3, 3] = 1e12
    goals[210:220, :3, 3] = 0.0
    found = solved(CLASSES[name], path, goals)  # which asserts that rows are finite
    assert found.errors(path, goals).max() < 1e-9


def test_solve_all_labels_branches_and_says_why_there_is_none() -> None:
    chain = arm("jaco2")
    q = np.array([0.3, 2.0, 1.5, 0.4, -1.0, 2.0])
    found = nk.solve_all(chain, chain.pose(q))
    assert any(np.abs(wrapped(result.q - q)).max() < 1e-9 for result in found)
    assert all("shoulder" in result.branch and "elbow" in result.branch for result in found)
    far = nk.solve_all(chain, from_xyz_rpy([5.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    assert len(far) == 0
    assert "no branch" in far.reason


def random_arm(rng: np.random.Generator) -> JointPath:
    """An arm of six joints without any structure."""
    path = arm("jaco2").joint_path
    placements = [from_xyz_rpy(rng.uniform(-0.4, 0.4, 3), rng.uniform(-3.0, 3.0, 3)).homogeneous for _ in range(6)]
    return replace_path(
        path,
        rotations=np.ascontiguousarray([T[:3, :3] for T in placements]),
        translations=np.ascontiguousarray([T[:3, 3] for T in placements]),
    )


def any_six(path: JointPath, goals: Floats) -> Branches:
    return branches(six_r_general, six_r_general, path, goals, POSE)


def test_any_six_joints_are_solved(rng: np.random.Generator) -> None:
    for i in range(20):
        path, q = random_arm(rng), rng.uniform(-np.pi, np.pi, (1, 6))
        goals = tips(path, q)
        found = any_six(path, goals)
        assert found.distance(q)[0] < 1e-9
        assert found.errors(path, goals).max() < 1e-10
        assert found.counts[0] % 2 == 0
        if i < 4:
            assert missing(path, found, goals, rng, 150) == 0


def test_what_is_nearly_a_class_is_solved_as_any_arm(rng: np.random.Generator) -> None:
    path = disturbed(arm("ur5").joint_path, rng, 1e-3, 6e-3)
    Q = rng.uniform(-np.pi, np.pi, (20, 6))
    goals = tips(path, Q)
    found = any_six(path, goals)
    assert found.distance(Q)[smallest_singular_values(path, Q) > 1e-4].max() < 1e-9
    assert found.errors(path, goals).max() < 1e-10
    assert missing(path, found, goals[:2], rng, 150) == 0


def test_general_arm_at_a_singular_pose_and_out_of_reach(rng: np.random.Generator) -> None:
    path = arm("ur5").joint_path
    Q = rng.uniform(-np.pi, np.pi, (6, 6))
    Q[:3, 2], Q[3:, 4] = 0.0, 0.0
    goals = tips(path, Q)
    found = any_six(path, goals)
    assert (found.counts > 0).all()
    assert found.errors(path, goals).max() < 1e-9
    far = random_poses(rng, 3, 0.1)
    far[:, 0, 3] = (3.0, 1e5, 1e200)
    assert (any_six(path, far).counts == 0).all()
