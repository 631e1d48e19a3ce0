"""Any five turning joints: what they reach they are solved for, and a NAO's arm as its own closed form solves it."""

from __future__ import annotations

import numpy as np

import nao_kin as nk
from nao_kin.analytic.form import Geometry, Mismatch
from nao_kin.analytic.six_r import five_r
from nao_kin.chain import random_configurations
from nao_kin.dh.dh_chain import DHChain
from tests.analytic.searching import wrapped
from tests.conftest import robot


def solved(chain: nk.Chain, goal: np.ndarray) -> np.ndarray:
    geometry, rows = five_r.recognise(chain.joint_path), np.zeros((five_r.BRANCHES, 7))
    assert isinstance(geometry, Geometry)
    return rows[: five_r.solve(geometry.parameters, 0, goal, np.zeros(1), 1e-6, rows), :5]


def test_a_nao_arm_has_the_branches_of_its_own_closed_form(rng: np.random.Generator) -> None:
    chain = robot("nao").chain("left_arm")
    for q in random_configurations(chain, 4, rng):
        T = chain.pose(q)
        ours, theirs = solved(chain, T.homogeneous), [result.q for result in nk.solve_all(chain, T)]
        assert len(ours) == len(theirs) == 4
        for other in theirs:
            assert np.abs(wrapped(ours - other)).max(axis=1).min() < 1e-8


def test_five_joints_without_structure_are_solved(rng: np.random.Generator) -> None:
    for _ in range(4):
        table = np.column_stack([rng.uniform(0.0, 0.4, 5), rng.uniform(-3.0, 3.0, 5), rng.uniform(-0.4, 0.4, 5)])
        rows = [dict(zip(("a", "alpha", "d"), row.tolist(), strict=True)) | {"theta": 0.0} for row in table]
        chain = DHChain.from_table(rows, convention="standard", lengths="m", angles="rad")
        q = rng.uniform(-np.pi, np.pi, 5)
        found = nk.solve_all(chain, chain.pose(q))
        assert min(np.abs(wrapped(result.q - q)).max() for result in found) < 1e-8
        assert all(max(result.position_error, result.rotation_error) < 1e-9 for result in found)
        off = chain.pose(q)
        off.translation[2] += 0.05
        missed = nk.solve_all(chain, off)
        assert len(missed) == 0
        assert "misses by" in missed.reason


def test_other_numbers_of_joints_are_refused() -> None:
    assert isinstance(five_r.recognise(robot("jaco2").chain("arm").joint_path), Mismatch)
