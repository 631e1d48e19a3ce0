"""Two chains against each other: verdicts that are known beforehand."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.documents.chains import DOCUMENT_CHAINS, documents_of
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import rotation_z, translation
from tests.conftest import robot


def against_model(name: str, convention: str | None = None) -> nk.Comparison:
    document = DOCUMENT_CHAINS[name]
    table = document.build()
    if convention is not None:
        table = table.read_as(convention)
    return nk.compare(table, robot(document.robot).chain(document.base, document.tip))


@pytest.mark.parametrize("name", [n for n in DOCUMENT_CHAINS if n.startswith("kofinas")])
def test_kofinas_tables_agree_with_the_models(name: str) -> None:
    found = against_model(name)
    assert found.agrees
    assert found.max_position_error < 1e-15
    assert found.max_linear_jacobian_error < 1e-14
    assert found.max_angular_jacobian_error < 1e-14
    assert found.first_departure is None


@pytest.mark.parametrize(
    ("name", "convention", "joint"),
    [
        # In the printed matrix's convention the first joint already turns about another axis; in the other one the
        # elbow offset folded into the base puts the shoulder in the wrong place.
        ("thesis_left_arm", "standard", "LShoulderPitch"),
        ("thesis_left_arm", "modified", "LShoulderRoll"),
        ("thesis_right_arm", "standard", "RShoulderPitch"),
        ("thesis_right_arm", "modified", "RShoulderRoll"),
        ("matlab_left_hand", "modified", "LShoulderRoll"),
        ("matlab_head", "modified", "HeadPitch"),  # the neck's height is along HeadYaw's axis: the next joint shows it
        ("practicum_jaco2", "standard", "joint_5"),
    ],
)
def test_the_other_tables_differ_from_their_fault_on(name: str, convention: str, joint: str) -> None:
    found = against_model(name, convention)
    assert not found.agrees
    assert found.first_departure is not None
    assert found.first_departure.joint == joint
    assert joint in repr(found)


def test_the_sizes_of_the_disagreements() -> None:
    # NeckOffsetZ is 126.5 mm on the robot and −5 in the example; nothing else differs.
    assert against_model("matlab_head").max_position_error == pytest.approx(0.1315, abs=1e-12)
    # The URDF rounds the oblique wrist's offsets; the documented figure is 0.076 mm at most.
    assert against_model("practicum_jaco2").max_position_error == pytest.approx(7.6e-5, abs=1e-6)
    assert against_model("practicum_jaco2").max_rotation_error < 1e-14


TABLE = nk.document_chain("kofinas_left_arm")


def planted(k: int, **change: float) -> nk.DHChain:
    rows = list(TABLE.rows)
    rows[k] = dataclasses.replace(rows[k], **change)
    return dataclasses.replace(TABLE, rows=tuple(rows))


@pytest.mark.parametrize(
    ("table", "joint", "number"),
    [
        (planted(3, sign=-1), "LElbowRoll", 4),
        (planted(1, theta=0.0), "LElbowYaw", 3),  # a constant turn behind joint 2 shows at the next axis
        (planted(2, d=0.1), "LElbowRoll", 4),
        (planted(4, alpha=0.0), "LWristYaw", 5),
        (dataclasses.replace(TABLE, tool=TABLE.tool * translation(0, 0, 1e-6)), None, 6),
        (dataclasses.replace(TABLE, tool=TABLE.tool * rotation_z(1e-6)), None, 6),
        (dataclasses.replace(TABLE, base=translation(0, 0, 1e-6) * TABLE.base), "LShoulderPitch", 1),
    ],
)
def test_a_planted_fault_is_localised(table: nk.DHChain, joint: str | None, number: int) -> None:
    found = nk.compare(table, TABLE)
    assert not found.agrees
    assert found.first_departure is not None
    assert (found.first_departure.joint, found.first_departure.number) == (joint, number)


@pytest.mark.parametrize("fault", ["LHipRoll", "RHipPitch", "RAnkleRoll"])
def test_a_fault_behind_coupled_joints_is_localised(tmp_path, fault: str) -> None:
    """From sole to sole there are 12 joints and 11 columns; names count joints."""
    document = robot("nao_v50_h25").document
    text = Path(document.path).read_text()
    joint = document.joint(fault)
    at = text.index(f'<joint name="{fault}"')
    x, y, z = joint.origin.xyz
    end = text.index("</joint>", at)
    changed = text[at:end].replace("<origin xyz=", f'<origin xyz="{x} {y} {z + 0.01}"/><unused xyz=', 1)
    (tmp_path / "faulty.urdf").write_text(text[:at] + changed + text[end:])
    found = nk.compare(
        nk.load(tmp_path / "faulty.urdf").chain("l_sole", "r_sole"), robot("nao_v50_h25").chain("l_sole", "r_sole")
    )
    assert found.first_departure is not None
    names = robot("nao_v50_h25").chain("l_sole", "r_sole").path_joint_names
    # The left leg is gone up: what lies behind a joint's own fixed transform is the joint above it.
    expected = fault if fault.startswith("R") else names[names.index(fault) + 1]
    assert found.first_departure.joint == expected


def test_different_numbers_of_physical_joints_are_not_localised(tmp_path) -> None:
    table = nk.DHChain.from_table([(0.1, 0, 0, 0)] * 11, "standard")
    found = nk.compare(table, robot("nao_v50_h25").chain("l_sole", "r_sole"), samples=10)
    assert found.first_departure is not None
    assert (found.first_departure.joint, found.first_departure.number) == (None, 0)
    assert "not localised" in str(found.first_departure)


def test_a_chain_agrees_with_itself_and_comparing_is_repeatable() -> None:
    chain = robot("nao_v50_h25").chain("l_sole", "r_sole")
    assert nk.compare(chain, chain).max_position_error == 0.0
    one, two = against_model("thesis_left_arm"), against_model("thesis_left_arm")
    assert one.max_position_error == two.max_position_error
    np.testing.assert_array_equal(one.worst_position_q, two.worst_position_q)


def test_the_worst_errors_are_at_the_joints_given() -> None:
    found = against_model("thesis_left_arm")
    a, b = found.a.pose(found.worst_position_q), found.b.pose(found.worst_position_q)
    assert math.dist(a.translation, b.translation) == found.max_position_error


def test_different_numbers_of_joints_are_said_so() -> None:
    with pytest.raises(InvalidInputError, match=r"5 joints as .* has \(LShoulderPitch.*got 4"):
        nk.compare(nk.document_chain("thesis_left_arm"), robot("nao_v50_h25").chain("left_arm"))
    with pytest.raises(InvalidInputError, match="samples"):
        nk.compare(TABLE, TABLE, samples=0)
    with pytest.raises(InvalidInputError, match="seed"):
        nk.compare(TABLE, TABLE, seed=-1)


def test_tables_know_their_models() -> None:
    assert documents_of("jaco2", "link_base", "end_effector") == ("practicum_jaco2",)
    assert documents_of("nao_v50_h21", "torso", "LArm") == ("thesis_left_arm",)
    assert nk.document_chain_names() == tuple(DOCUMENT_CHAINS)


def test_a_comparison_shows_itself() -> None:
    assert "LShoulderRoll" in against_model("thesis_left_arm", "modified")._repr_html_()
