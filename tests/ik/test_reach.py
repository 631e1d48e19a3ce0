"""The shell that link lengths allow: no tip ever leaves it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.ik.reach import reach_shell
from tests.conftest import BUNDLED, robot

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("name", BUNDLED)
def test_the_tip_never_leaves_the_reach_shell(name: str, rng: np.random.Generator) -> None:
    model = robot(name)
    chains = [model.chain(c) for c in model.chain_frames]
    if name.startswith("nao"):
        chains.append(model.chain("l_sole", "r_sole"))
    for chain in chains:
        shell = reach_shell(chain)
        positions = chain.poses(rng.uniform(-np.pi, np.pi, (500, len(chain.joints))))[:, :3, 3]
        distances = np.linalg.norm(positions - shell.centre, axis=1)
        assert distances.max() <= shell.outer * (1 + 1e-12)
        assert distances.min() >= shell.inner * (1 - 1e-12)
        assert max(shell.misses_by(p) for p in positions) == 0.0


def test_coupled_joints_count_one_by_one(mimic: nk.Robot, rng: np.random.Generator) -> None:
    chain = mimic.chain("a", "d")
    shell = reach_shell(chain)
    for q in random_configurations(chain, 200, rng):
        assert shell.misses_by(chain.pose(q).translation) == 0.0


def test_prismatic_travel_counts_as_reach(tmp_path: Path) -> None:
    path = tmp_path / "slider.urdf"
    path.write_text(
        '<robot name="s"><link name="a"/><link name="b"/><joint name="x" type="prismatic"><parent link="a"/>'
        '<child link="b"/><axis xyz="1 0 0"/><limit lower="-0.2" upper="0.7" effort="1" velocity="1"/></joint></robot>'
    )
    chain = nk.load(path).chain("a", "b")
    shell = reach_shell(chain)
    assert np.linalg.norm(chain.pose([0.7]).translation - shell.centre) <= shell.outer == pytest.approx(0.7)


def test_an_arm_that_cannot_fold_has_a_hole_in_its_reach() -> None:
    """Rods of 0.3 and 0.1 m leave the first 0.2 m around the shoulder free."""
    table = nk.DHChain.from_table([(0.3, 0, 0, 0), (0.1, 0, 0, 0)], convention="standard")
    shell = reach_shell(table)
    assert (shell.inner, shell.outer) == (pytest.approx(0.2), pytest.approx(0.4))
    assert shell.misses_by(np.zeros(3)) == pytest.approx(0.2)
    assert nk.solve(table, [0.1, 0.0, 0.0]).status is nk.Status.OUT_OF_REACH
