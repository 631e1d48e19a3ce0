"""The self-motion of arms with a joint too many."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.redundancy import self_motion
from nao_kin.dh.dh_chain import DHChain
from nao_kin.errors import InvalidInputError, UnknownNameError

ROWS = [  # a shoulder, an elbow and a wrist, each of axes through one point
    {"a": 0.0, "alpha": alpha, "d": d, "theta": 0.0}
    for alpha, d in (
        (-np.pi / 2, 0.34),
        (np.pi / 2, 0.0),
        (np.pi / 2, 0.4),
        (-np.pi / 2, 0.0),
        (-np.pi / 2, 0.4),
        (np.pi / 2, 0.0),
        (0.0, 0.126),
    )
]


def seven() -> DHChain:
    return DHChain.from_table(ROWS, convention="standard", lengths="m", angles="rad", name="seven")


def test_a_pose_is_kept_along_the_self_motion() -> None:
    chain, q = seven(), np.array([0.4, 0.7, -0.5, 1.1, 0.3, -0.8, 0.2])
    target = chain.pose(q)
    free = chain.joint_names[2]
    swept = self_motion(chain, target, redundancy=free, samples=5)
    assert [sample.value for sample in swept] == pytest.approx(np.linspace(-np.pi, np.pi, 5, endpoint=False).tolist())
    assert sum(len(sample.solutions) for sample in swept) > 0
    for sample in swept:
        for result in sample.solutions:
            assert result.q[2] == pytest.approx(sample.value, abs=1e-12)
            assert np.abs(chain.pose(result.q).homogeneous - target.homogeneous).max() < 1e-8


def test_joints_that_cannot_be_free_are_refused() -> None:
    chain = seven()
    with pytest.raises(UnknownNameError):
        self_motion(chain, np.eye(4), redundancy="elbow")
    with pytest.raises(InvalidInputError, match="samples"):
        self_motion(chain, np.eye(4), redundancy=chain.joint_names[2], samples=1)
    with pytest.raises(InvalidInputError, match="not locked"):
        self_motion(chain, np.eye(4), redundancy=chain.joint_names[2], locked={chain.joint_names[2]: 0.0})


def test_solve_all_samples_a_free_joint_and_says_its_value() -> None:
    chain, q = seven(), np.array([0.4, 0.7, -np.pi / 2, 1.1, 0.3, -0.8, 0.2])
    free = chain.joint_names[2]
    found = nk.solve_all(chain, chain.pose(q), redundancy=free, samples=4)
    assert len(found.solved) > 1
    assert min(np.abs(result.q - q).max() for result in found) < 1e-9
    for result in found:
        assert result.branch.endswith(f"{free} at {result.q[2]:.6g}")
        assert np.abs(chain.pose(result.q).homogeneous - chain.pose(q).homogeneous).max() < 1e-8
    with pytest.raises(InvalidInputError, match="samples"):
        nk.solve_all(chain, chain.pose(q), redundancy=free, samples=1)
