"""What two descriptions of one arm may differ in: planted, found again, and confirmed by the poses of both."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.se3 import from_xyz_rpy, position_distance, rotation_distance, rotation_z
from tests.conftest import needs_examples, robot

ARMS = (("nao", "left_arm"), ("nao", "right_leg"), ("nao", "head"), ("jaco2", "arm"), ("phantomx", "leg_lf"))
EXAMPLES = (("ur5", "arm"), ("panda", "arm"), ("z1", "arm"))
IDENTITY = from_xyz_rpy()


def regauged(table: nk.DHChain, signs, offsets, base=IDENTITY, tool=IDENTITY) -> nk.DHChain:
    """The same arm with other joint senses, zero positions and ends."""
    rows = tuple(
        dataclasses.replace(row, sign=int(row.sign * s), theta=row.theta + row.sign * o)
        for row, s, o in zip(table.rows, signs, offsets, strict=True)
    )
    return dataclasses.replace(table, rows=rows, base=base * table.base, tool=table.tool * tool)


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize(("name", "label"), [*ARMS, *EXAMPLES])
def test_a_planted_gauge_is_found(name: str, label: str, convention, rng) -> None:
    if (name, label) in EXAMPLES:
        needs_examples()
    chain = robot(name).chain(label)
    n = len(chain.joints)
    signs, offsets = rng.choice([1, -1], n), rng.choice([0.0, math.pi / 2, -math.pi / 2, math.pi, 0.3], n)
    ends = [from_xyz_rpy(rng.uniform(-1, 1, 3), rng.uniform(-1.5, 1.5, 3)) for _ in range(2)]
    a = regauged(nk.to_dh(chain, convention), signs, offsets, *ends)
    found = nk.compare(a, chain, samples=20)
    assert not found.agrees
    gauge = found.gauge
    assert gauge is not None
    assert found.first_pair is None
    for q in rng.uniform(-3.0, 3.0, (10, n)):
        T = gauge.base * a.pose(np.array(gauge.signs) * q + np.array(gauge.offsets)) * gauge.tool
        assert position_distance(T, chain.pose(q)) < 1e-12
        assert rotation_distance(T, chain.pose(q)) < 1e-12
    assert nk.compare(gauge.applied(a), chain, samples=20).agrees


def test_a_gauge_is_said_in_its_smallest_words() -> None:
    chain = robot("nao").chain("left_arm")
    signs, offsets = [1, 1, -1, 1, 1], [0.0, -math.pi / 2, 0.0, 0.0, 0.0]
    found = nk.compare(regauged(nk.to_dh(chain), signs, offsets), chain, samples=20)
    assert str(found.gauge) == "joint 2 (LShoulderRoll) offset π/2, joint 3 (LElbowYaw) sign -1"
    turned = dataclasses.replace(nk.to_dh(chain), base=rotation_z(math.pi) * nk.to_dh(chain).base)
    assert str(nk.compare(turned, chain, samples=20).gauge) == "base Rz(π)"
    assert str(nk.compare(chain, chain, samples=20).gauge) == "nothing"


@pytest.mark.parametrize(("name", "label"), ARMS)
def test_another_arm_is_the_same_up_to_nothing(name: str, label: str, rng) -> None:
    """A length of 1 µm more between two axes is no gauge, wherever it is, and the pair there is named."""
    chain = robot(name).chain(label)
    table = nk.to_dh(chain, "modified")
    for k in range(1, len(table.rows)):
        rows = list(table.rows)
        rows[k] = dataclasses.replace(rows[k], a=rows[k].a + 1e-6)
        found = nk.compare(dataclasses.replace(table, rows=tuple(rows)), chain, samples=20)
        assert found.gauge is None
        assert found.first_pair is not None
        assert found.first_pair.joints == (chain.joint_names[k - 1], chain.joint_names[k])
        assert found.first_pair.a.distance != pytest.approx(found.first_pair.b.distance, abs=1e-7)


def test_an_offset_hidden_behind_parallel_axes_is_shown() -> None:
    needs_examples()
    chain = robot("ur5").chain("arm")
    table = nk.to_dh(chain, "modified")
    rows = list(table.rows)
    rows[3] = dataclasses.replace(rows[3], d=rows[3].d + 0.001)
    pair = nk.compare(dataclasses.replace(table, rows=tuple(rows)), chain, samples=20).first_pair
    assert pair is not None
    assert pair.joints == ("wrist_1_joint", "wrist_2_joint")
    assert (pair.a.offset, pair.b.offset) == (pytest.approx(0.11015, abs=1e-9), pytest.approx(0.10915, abs=1e-9))


@pytest.mark.parametrize(
    "rows",
    [
        [(0.3, 0.0, 0.0, 0.0)],
        [(0.3, 0.0, 0.0, 0.1), (0.2, 0.0, 0.1, 0.0), (0.1, 0.0, 0.0, 0.0)],
        [(0.3, math.pi, 0.0, 0.1), (0.2, math.pi, 0.1, 0.0), (0.1, 0.0, 0.0, 0.0)],
        [(0.0, math.pi / 2, 0.0, 0.0), (0.0, -math.pi / 2, 0.0, 0.0), (0.0, 0.3, 0.2, 0.0)],
    ],
)
def test_special_axes(rows) -> None:
    table = nk.DHChain.from_table(rows, "standard")
    n = len(rows)
    signs, offsets = [-1] * n, [0.4] * n
    found = nk.compare(regauged(table, signs, offsets, from_xyz_rpy([1, 2, 3], [0.1, 0.2, 0.3])), table, samples=20)
    assert found.gauge is not None
    assert nk.compare(found.gauge.applied(found.a), table, samples=20).agrees  # type: ignore[arg-type]


def test_the_jaco2s_wrist_is_where_table_and_urdf_part() -> None:
    found = nk.compare(nk.document_chain("practicum_jaco2"), robot("jaco2").chain("arm"))
    assert found.max_position_error < 0.08e-3
    assert found.first_pair is not None
    assert found.first_pair.joints == ("joint_4", "joint_5")
    # D3 + D4 / (2 cos 30°) against 0.2073 + 0.06414 − 0.03703 / tan 60° of the URDF's rounded offsets.
    assert found.first_pair.a.offset == pytest.approx(0.2073 + 0.0741 / math.sqrt(3.0), abs=1e-12)
    assert found.first_pair.b.offset == pytest.approx(0.2073 + 0.06414 - 0.03703 / math.sqrt(3.0), abs=1e-12)


def test_coupled_joints_have_no_gauge() -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_sole")
    found = nk.compare(chain, chain, samples=10)
    assert found.gauge is None
    assert found.first_pair is None
