"""The compiled kernels against Pinocchio and DH products, and what must not change a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np
import pytest

from nao_kin.chain import random_configurations
from nao_kin.documents.chains import DOCUMENT_CHAINS
from nao_kin.kernels import audit, forward, motion
from tests.conftest import BUNDLED, EXAMPLES, needs_examples, robot
from tests.kernels.paths import odd_robot, random_path, slow_pose

if TYPE_CHECKING:
    from nao_kin.chain import Chain
    from nao_kin.kernels.joint_path import JointPath

EXTRA_PATHS = {
    "nao_v50_h25": [("l_sole", "r_gripper"), ("l_sole", "r_sole"), ("r_sole", "CameraTop_frame"), ("LArm", "RArm")],
    "nao_v33_h21": [("l_sole", "r_gripper"), ("r_sole", "l_sole")],
    "jaco2": [("end_effector", "link_base"), ("link_3", "link_6")],
    "phantomx": [("foot_lf", "foot_rr")],
    "romeo": [("l_sole", "RFinger13Link")],
    "icub": [("l_sole", "r_hand")],
    "baxter": [("left_gripper", "right_gripper")],
    "tiago": [("base_footprint", "hand_index_flex_3_link"), ("hand_thumb_flex_2_link", "hand_little_flex_3_link")],
    "so100": [("base", "jaw")],
}
ODD_PATHS = [("base", "tip"), ("tip", "base"), ("b", "tip"), ("d", "a"), ("tip", "c")]


def chains_of(name: str) -> list:
    model = robot(name)
    return [model.chain(c) for c in model.chain_frames] + [model.chain(*p) for p in EXTRA_PATHS.get(name, [])]


def one_by_one(path: JointPath, Q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Poses and Jacobians by the functions for a single configuration."""
    m, n = len(path.columns), Q.shape[1]
    joints, axes, tip = motion.packed_joints(path), np.empty((m, 6)), np.empty(12)
    T, J = np.zeros((len(Q), 4, 4)), np.empty((len(Q), 6, n))
    T[:, 3, 3] = 1.0
    for i, q in enumerate(Q):
        motion.place(joints, q, axes, tip)
        motion.jacobian(joints, axes, tip, J[i])
        T[i, :3, :3], T[i, :3, 3] = tip[:9].reshape(3, 3), tip[9:]
    return T, J


def check(chain: Chain, Q: np.ndarray) -> None:
    path = chain.joint_path
    T = np.array([chain.pose(q).homogeneous for q in Q])
    J = np.array([chain.jacobian(q) for q in Q])
    singly = one_by_one(path, Q)
    for poses in (forward.poses(path, Q), audit.tips(path, Q), singly[0]):
        np.testing.assert_allclose(poses, T, atol=1e-12, rtol=0)
        np.testing.assert_array_equal(poses[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (len(Q), 1)))
    for jacobians in (forward.jacobians(path, Q), singly[1]):
        np.testing.assert_allclose(jacobians, J, atol=1e-12, rtol=0)


@pytest.mark.parametrize("name", [*BUNDLED, *EXAMPLES])
def test_kernels_equal_pinocchio(name: str, rng: np.random.Generator) -> None:
    if name in EXAMPLES:
        needs_examples()
    chains = chains_of(name)
    assert chains
    for chain in chains:
        check(chain, random_configurations(chain, 100, rng))


@pytest.mark.parametrize("name", DOCUMENT_CHAINS)
def test_kernels_equal_the_documents(name: str, rng: np.random.Generator) -> None:
    table = DOCUMENT_CHAINS[name].build()
    check(table, random_configurations(table, 100, rng))


@pytest.mark.parametrize("frames", ODD_PATHS)
def test_sliding_continuous_and_coupled_joints(frames, tmp_path, rng: np.random.Generator) -> None:
    chain = odd_robot(tmp_path).chain(*frames)
    check(chain, random_configurations(chain, 100, rng))


def test_a_column_that_moves_no_joint_is_zero(rng: np.random.Generator) -> None:
    path, Q = random_path(rng), rng.uniform(-3, 3, (70, 6))
    wider = path._replace(columns=path.columns + 2)
    padded = np.column_stack([rng.uniform(-3, 3, (70, 2)), Q, rng.uniform(-3, 3, 70)])
    np.testing.assert_array_equal(forward.poses(wider, padded), forward.poses(path, Q))
    J = forward.jacobians(wider, padded)
    np.testing.assert_array_equal(J[:, :, 2:8], forward.jacobians(path, Q))
    assert not J[:, :, [0, 1, 8]].any()
    np.testing.assert_allclose(one_by_one(wider, padded)[1], J, atol=1e-14, rtol=0)


@pytest.mark.parametrize("count", [0, 1, 2, 63, 64, 65, 127, 128, 1000, 1023, 1024, 1025, 3000])
def test_every_number_of_configurations(count: int, rng: np.random.Generator) -> None:
    path, Q = random_path(rng, slides=(2,)), rng.uniform(-3, 3, (count, 6))
    T, J = forward.poses(path, Q), forward.jacobians(path, Q)
    assert T.shape == (count, 4, 4)
    assert J.shape == (count, 6, 6)
    assert audit.tips(path, Q).shape == (count, 4, 4)
    for i in {0, count // 2, count - 1} & set(range(count)):
        np.testing.assert_allclose(T[i], slow_pose(path, Q[i]), atol=1e-13, rtol=0)
    np.testing.assert_allclose(audit.tips(path, Q), T, atol=1e-13, rtol=0)


@pytest.mark.parametrize("joints", [1, 2, 3, 7, 12, 40])
def test_every_number_of_joints(joints: int, rng: np.random.Generator) -> None:
    path, Q = random_path(rng, joints, slides=(0, 5)), rng.uniform(-3, 3, (100, joints))
    T, J = one_by_one(path, Q)
    np.testing.assert_allclose(forward.poses(path, Q), T, atol=1e-13, rtol=0)
    np.testing.assert_allclose(forward.jacobians(path, Q), J, atol=1e-13, rtol=0)
    np.testing.assert_allclose(T[0], slow_pose(path, Q[0]), atol=1e-12, rtol=0)


@pytest.mark.parametrize("kernel", [forward.poses, forward.jacobians, audit.tips])
def test_a_row_does_not_depend_on_its_place(kernel, rng: np.random.Generator) -> None:
    path, Q = random_path(rng, slides=(3,)), rng.uniform(-9, 9, (1500, 6))
    Q[::7] *= 1e6  # rows for the C library's sine and cosine among the others
    whole, order = kernel(path, Q), rng.permutation(len(Q))
    np.testing.assert_array_equal(kernel(path, Q[order]), whole[order])
    for i in [*range(0, 1500, 101), 1499]:
        np.testing.assert_array_equal(kernel(path, Q[i : i + 1].copy())[0], whole[i])


@pytest.mark.parametrize("kernel", [forward.poses, forward.jacobians, audit.tips])
def test_the_number_of_threads_changes_nothing(kernel, rng: np.random.Generator) -> None:
    path, Q = random_path(rng), rng.uniform(-3, 3, (5000, 6))
    usual = numba.get_num_threads()
    try:
        results = []
        for threads in range(1, usual + 1):
            numba.set_num_threads(threads)
            results.append(kernel(path, Q))
    finally:
        numba.set_num_threads(usual)
    for result in results:
        np.testing.assert_array_equal(result, results[0])


@pytest.mark.parametrize("kernel", [forward.poses, forward.jacobians, audit.tips])
def test_what_the_caller_passes_stays_as_it_is(kernel, rng: np.random.Generator) -> None:
    path, Q = random_path(rng), rng.uniform(-3, 3, (100, 6))
    before = [array.copy() for array in (*path, Q)]
    kernel(path, Q)
    for array, copy in zip((*path, Q), before, strict=True):
        np.testing.assert_array_equal(array, copy)
