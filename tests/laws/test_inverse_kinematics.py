"""Laws of inverse kinematics: what a change of base, axis sign, unit or side must do to a solution."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from tests.conftest import robot

import nao_kin as nk
from nao_kin.chain import random_configurations

TABLE = nk.document_chain("practicum_jaco2")


@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_a_moved_base_moves_nothing_else(engine, rng: np.random.Generator) -> None:
    G = pin.SE3.Random()
    moved = dataclasses.replace(TABLE, base=G * TABLE.base)
    for q in rng.uniform(-3, 3, (20, 6)):
        T, q0 = TABLE.pose(q), q + rng.normal(scale=0.3, size=6)
        one, other = nk.solve(TABLE, T, q0, engine=engine), nk.solve(moved, G * T, q0, engine=engine)
        assert one.status is other.status
        assert one.solved
        if one.run.starts == other.run.starts == 1:
            np.testing.assert_allclose(one.q, other.q, atol=1e-6)


@pytest.mark.parametrize("k", range(6))
@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_a_flipped_axis_flips_its_joint(engine, k: int, rng: np.random.Generator) -> None:
    rows = list(TABLE.rows)
    rows[k] = dataclasses.replace(rows[k], sign=-rows[k].sign)
    flipped, signs = dataclasses.replace(TABLE, rows=tuple(rows)), np.ones(6)
    signs[k] = -1.0
    for q in rng.uniform(-3, 3, (10, 6)):
        T, q0 = TABLE.pose(q), q + rng.normal(scale=0.3, size=6)
        one, other = nk.solve(TABLE, T, q0, engine=engine), nk.solve(flipped, T, signs * q0, engine=engine)
        assert one.solved
        assert other.solved
        if one.run.starts == other.run.starts == 1:
            np.testing.assert_allclose(one.q, signs * other.q, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_another_unit_of_length_is_solved_as_well(scale: float, rng: np.random.Generator) -> None:
    """An arm given in another unit, with the tolerance in that unit, has the same solutions."""
    rows = tuple(dataclasses.replace(row, a=row.a * scale, d=row.d * scale) for row in TABLE.rows)
    scaled = dataclasses.replace(TABLE, rows=rows)
    tolerances = nk.Tolerances(position=1e-6 * scale)
    for q in rng.uniform(-3, 3, (20, 6)):
        target = scaled.pose(q)
        result = nk.solve(scaled, target, tolerances=tolerances)
        assert result.solved, result.message
        T = TABLE.pose(q)
        assert np.linalg.norm(TABLE.pose(result.q).translation - T.translation) <= 1.1e-6


@pytest.mark.parametrize("kind", ["pose", "position"])
def test_the_mirrored_arm_has_the_mirrored_solutions(kind: str, rng: np.random.Generator) -> None:
    model = robot("nao_v50_h25")
    left, right = model.chain("left_arm"), model.chain("right_arm")
    flip = np.diag([1.0, -1.0, 1.0])
    signs = np.array([1.0 if "Pitch" in name else -1.0 for name in left.joint_names])
    for q in random_configurations(left, 30, rng):
        T = left.pose(q)
        mirrored = pin.SE3(flip @ T.rotation @ flip, flip @ T.translation)
        targets = (T, mirrored) if kind == "pose" else (T.translation, mirrored.translation)
        q0 = q + rng.normal(scale=0.2, size=5)
        one, other = nk.solve(left, targets[0], q0), nk.solve(right, targets[1], signs * q0)
        assert one.solved
        assert other.solved
        if one.run.starts == other.run.starts == 1:
            np.testing.assert_allclose(one.q, signs * other.q, atol=1e-6)
