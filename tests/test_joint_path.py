"""The flat form of every chain is that chain: its product of matrices gives the same pose."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.documents.chains import DOCUMENT_CHAINS
from tests.conftest import BUNDLED, robot

if TYPE_CHECKING:
    from nao_kin.kernels.joint_path import JointPath


def product(path: JointPath, q: np.ndarray) -> np.ndarray:
    """T_base_tip by the definition of the flat form, with homogeneous matrices."""
    T = np.eye(4)
    for R, p, slides, column, factor, offset in zip(*path[:2], *path[4:8], strict=True):
        value = factor * q[column] + offset
        c, s = (1.0, 0.0) if slides else (math.cos(value), math.sin(value))
        moving = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, value if slides else 0.0], [0, 0, 0, 1]])
        T = T @ np.block([[R, p[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]]) @ moving
    tool = np.block([[path.tool_rotation, path.tool_translation[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
    return T @ tool


@pytest.mark.parametrize("name", BUNDLED)
def test_of_robots(name: str, rng: np.random.Generator) -> None:
    model = robot(name)
    chains = [model.chain(c) for c in model.chain_frames]
    if name.startswith("nao"):
        chains += [model.chain("l_sole", "r_sole"), model.chain("RArm", "l_sole")]
    for chain in chains:
        for q in random_configurations(chain, 20, rng):
            np.testing.assert_allclose(product(chain.joint_path, q), chain.pose(q).homogeneous, atol=1e-13)


@pytest.mark.parametrize("name", DOCUMENT_CHAINS)
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_of_tables(name: str, convention, rng: np.random.Generator) -> None:
    table = nk.document_chain(name).read_as(convention)
    for q in rng.uniform(-3, 3, (20, len(table.rows))):
        np.testing.assert_allclose(product(table.joint_path, q), table.pose(q).homogeneous, atol=1e-13)


def test_of_prismatic_and_negative_rows(rng: np.random.Generator) -> None:
    rows = [
        {"a": 0.1, "alpha": 0.4, "d": 0.2, "theta": 0.3, "kind": "prismatic", "sign": -1},
        {"a": -0.3, "alpha": -1.4, "d": 0.1, "theta": 1.3, "sign": -1},
    ]
    for convention in ("standard", "modified"):
        table = nk.DHChain.from_table(rows, convention)
        for q in rng.uniform(-1, 1, (20, 2)):
            np.testing.assert_allclose(product(table.joint_path, q), table.pose(q).homogeneous, atol=1e-14)
