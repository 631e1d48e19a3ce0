"""Chains to DH tables and DH tables to URDF: poses survive, whatever the convention and the axes' places."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import from_xyz_rpy, rotation_x, rotation_z, translation
from tests.conftest import BUNDLED, needs_examples, robot

CONVENTIONS = ("standard", "modified")


def largest_difference(a: nk.Chain, b: nk.Chain, rng: np.random.Generator) -> float:
    """Largest difference of an entry of the two poses (rotation; metres)."""
    Q = random_configurations(b, 20, rng)
    return max(float(np.abs(a.pose(q).homogeneous - b.pose(q).homogeneous).max()) for q in Q)


def back_from_urdf(table: nk.DHChain, tmp_path) -> nk.UrdfChain:
    path = tmp_path / "table.urdf"
    path.write_text(table.to_urdf(), encoding="utf-8")
    return nk.load(path).chain(table.base_name, table.tip_name)


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("name", [*BUNDLED, "ur5", "z1", "panda"])
def test_every_chain_survives_to_dh_and_to_urdf(name: str, convention, tmp_path, rng) -> None:
    if name not in BUNDLED:
        needs_examples()
    for label in robot(name).chain_frames:
        chain = robot(name).chain(label)
        table = nk.to_dh(chain, convention)
        back = back_from_urdf(table, tmp_path)
        assert largest_difference(table, chain, rng) < 1e-12
        assert largest_difference(back, chain, rng) < 1e-12
        assert table.joint_names == back.joint_names == chain.joint_names
        assert [j.kind for j in table.joints] == [j.kind for j in chain.joints]
        np.testing.assert_array_equal(table.lower, chain.lower)
        np.testing.assert_array_equal(back.upper, chain.upper)
        np.testing.assert_array_equal(back.max_velocity, chain.max_velocity)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_path_up_and_down_the_tree(convention, rng) -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_gripper")
    assert largest_difference(nk.to_dh(chain, convention), chain, rng) < 1e-12


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_table_survives_its_text(convention, tmp_path, rng) -> None:
    table = nk.to_dh(robot("jaco2").chain("arm"), convention)
    (tmp_path / "table.toml").write_text(table.to_toml(), encoding="utf-8")
    again = nk.DHChain.from_file(tmp_path / "table.toml")
    assert again.rows == table.rows
    np.testing.assert_array_equal(again.tool.homogeneous, table.tool.homogeneous)


def planar(*lengths: float) -> nk.DHChain:
    return nk.DHChain.from_table([(a, 0.0, 0.01 * k, 0.1 * k) for k, a in enumerate(lengths)], "standard")


STRATA = {
    "one joint": planar(0.3),
    "all parallel": planar(0.3, 0.2, 0.1),
    "all on one line": planar(0.0, 0.0, 0.0),
    "antiparallel": nk.DHChain.from_table(
        [(0.3, math.pi, 0.1, 0.2), (0.2, math.pi, 0.0, 0.0), (0.1, 0, 0, 0)], "standard"
    ),
    "all meeting": nk.DHChain.from_table([(0, 1.0, 0, 0.1), (0, -0.4, 0, 0.2), (0, 0.7, 0, 0.3)], "modified"),
    "skew": nk.DHChain.from_table([(0.1, 1.0, 0.2, 0.1), (-0.2, -0.4, 0.1, 2.0), (0.3, 2.7, 0, -3.0)], "modified"),
    "skew by 1e-6": nk.DHChain.from_table([(0.1, 1e-6, 0.2, 0.1), (0.2, 0.0, 0.1, 2.0), (0.3, 0, 0, 0)], "standard"),
    "oblique base": dataclasses.replace(planar(0.3, 0.2), base=from_xyz_rpy([0.1, -0.2, 0.3], [0.4, -1.5, 2.0])),
    "scara": nk.DHChain(
        rows=(
            nk.DHRow(0.3, 0.0, 0.4, 0.0, name="one"),
            nk.DHRow(0.2, math.pi, 0.0, 0.3, sign=-1, name="two"),
            nk.DHRow(0.0, 0.0, 0.1, 0.2, sign=-1, name="down", kind="prismatic", lower=0.0, upper=0.2),
            nk.DHRow(0.0, 0.0, 0.0, 0.0, name="turn", kind="continuous"),
        ),
        convention="standard",
        base=translation(0.0, 0.0, 0.1),
        tool=rotation_x(0.3),
    ),
    "sliding first": nk.DHChain(
        rows=(
            nk.DHRow(0.0, math.pi / 2, 0.0, 0.0, name="rail", kind="prismatic", lower=-1.0),
            nk.DHRow(0.2, 0.3, 0.0, 0.3, name="two", max_velocity=2.0),
            nk.DHRow(0.1, 0.0, 0.0, 0.3, name="three", upper=1.0),
        ),
        convention="modified",
        base=translation(0.0, 0.0, 0.1),
        tool=rotation_z(0.3),
    ),
}


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("name", STRATA)
def test_axes_in_every_special_place(name: str, convention, tmp_path, rng) -> None:
    """Tables held against their own conversions: the product of the printed rows is the oracle."""
    chain = STRATA[name]
    tolerance = 1e-10 if name == "skew by 1e-6" else 1e-12  # lengths of 100 km cancel there
    assert largest_difference(nk.to_dh(chain, convention), chain, rng) < tolerance
    assert largest_difference(back_from_urdf(chain, tmp_path), chain, rng) < 1e-12
    assert largest_difference(back_from_urdf(nk.to_dh(chain, convention), tmp_path), chain, rng) < tolerance


def test_a_known_table_comes_out_as_people_write_it() -> None:
    needs_examples()
    table = nk.to_dh(robot("ur5").chain("arm"), "standard")
    rows = [(r.a, r.alpha, r.d, r.theta) for r in table.rows[:5]]
    # Universal Robots' own DH parameters of the UR5, lengths as in its URDF, whose x axis points along the arm.
    expected = [
        (0.0, -math.pi / 2, 0.089159, 0.0),
        (0.425, 0.0, 0.0, 0.0),
        (0.39225, 0.0, 0.0, 0.0),
        (0.0, -math.pi / 2, 0.10915, 0.0),
        (0.0, math.pi / 2, 0.09465, 0.0),
    ]
    np.testing.assert_allclose(rows, expected, rtol=0.0, atol=1e-11)
    assert table.base.isIdentity(0.0)


def test_coupled_joints_are_refused() -> None:
    with pytest.raises(InvalidInputError, match="12 joints on 11 columns"):
        nk.to_dh(robot("nao_v50_h25").chain("l_sole", "r_sole"))


def test_nearly_parallel_axes_are_refused_where_the_table_would_miss() -> None:
    # Lines 1 and 2 meet at 3e-9 rad: they count as parallel, and the plane of the small angle is lost.
    chain = nk.DHChain.from_table([(0.0, 3e-9, 0.2, 0.7), (0.3, 0.0, 0.1, 2.0), (0.3, 1.0, 1.0, 0.0)], "standard")
    with pytest.raises(InvalidInputError, match="nearly parallel"):
        nk.to_dh(chain)


def test_bad_arguments() -> None:
    with pytest.raises(InvalidInputError, match="convention"):
        nk.to_dh(robot("jaco2").chain("arm"), "craig")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="different names of base and tip"):
        dataclasses.replace(planar(0.1), base_name="here", tip_name="here").to_urdf()


def test_awkward_names_survive_urdf(tmp_path) -> None:
    rows = [nk.DHRow(0.1, 0.0, 0.0, 0.0, name='a"<&'), nk.DHRow(0.1, 0.0, 0.0, 0.0, name="tip_fixed")]
    table = nk.DHChain(tuple(rows), "standard", translation(0, 0, 0), translation(0, 0, 0), base_name='a"<&_link')
    assert back_from_urdf(table, tmp_path).joint_names == ('a"<&', "tip_fixed")
