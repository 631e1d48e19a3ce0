"""A closed form is found by measuring: whatever the names, bases, tools, axis signs, offsets and tables."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

import nao_kin as nk
from nao_kin.analytic.form import Mismatch, screws
from nao_kin.analytic.forms import FORMS
from nao_kin.analytic.matching import matched
from nao_kin.chain import random_configurations
from nao_kin.documents.kofinas import V33_LENGTHS, arm, head
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.kernels.joint_path import held
from tests.analytic.goals import chain_of, errors, move

BY_NAME = {form.name: form for form in FORMS}


def test_every_form_labels_all_that_its_kernels_number() -> None:
    for form in FORMS:
        assert form.singularities[0] == ""
        assert len(set(form.labels)) == len(form.labels)
        assert form.label(0, 0) == form.labels[0]
        assert form.label(0, 1).endswith(form.singularities[1])


@pytest.mark.parametrize("name", nk.document_chain_names())
def test_document_chains_with_a_known_geometry_are_solved(name: str, rng: np.random.Generator) -> None:
    chain = nk.document_chain(name)
    if len(chain.joints) not in (2, 4, 5):
        return
    for q in random_configurations(chain, 10, rng):
        results = nk.solve_all(chain, chain.pose(q))
        assert min(move(result.q, q) for result in results) <= 1e-9
        assert max(map(errors, results)) <= 1e-12


@pytest.mark.parametrize("hands", ["h21", "h25"])
def test_signs_offsets_base_and_tool_do_not_matter(hands: str, rng: np.random.Generator) -> None:
    table = arm("left", hands)
    for _ in range(10):
        rows = tuple(
            dataclasses.replace(row, sign=int(rng.choice((-1, 1))), theta=row.theta + rng.uniform(-3, 3))
            for row in table.rows
        )
        base, tool = pin.SE3.Random() * table.base, table.tool * pin.SE3.Random()
        chain = dataclasses.replace(table, rows=rows, base=base, tool=tool)
        for q in rng.uniform(-np.pi, np.pi, (5, len(rows))):
            results = nk.solve_all(chain, chain.pose(q))
            assert min(move(result.q, q) for result in results) <= 1e-9
            target = nk.Target.pointing(chain.pose(q).translation, chain.pose(q).rotation @ [0.3, 0.4, 0.5], [3, 4, 5])
            assert min(move(result.q, q) for result in nk.solve_all(chain, target)) <= 1e-7


def test_the_screws_are_those_of_the_product_of_exponentials(rng: np.random.Generator) -> None:
    for chain in (chain_of("nao", "left_arm"), nk.document_chain("thesis_right_arm"), head()):
        found = screws(chain.joint_path, len(chain.joints))
        assert not isinstance(found, Mismatch)
        for q in rng.uniform(-3, 3, (5, len(chain.joints))):
            T = pin.SE3.Identity()
            for axis, point, value in zip(found.axes, found.points, q, strict=True):
                R = pin.exp3(axis * value)
                T = T * pin.SE3(R, point - R @ point)
            assert np.abs((T * pin.SE3(found.tip)).homogeneous - chain.pose(q).homogeneous).max() <= 1e-12


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"a": 1e-9}, "miss"),
        ({"alpha": -np.pi / 2 + 1e-9}, "out of square"),
        ({"d": 1e-3}, "miss"),
    ],
)
def test_a_departure_is_measured_and_refused(change: dict[str, float], reason: str) -> None:
    table = arm("left")
    rows = list(table.rows)
    rows[3] = dataclasses.replace(rows[3], **change)
    refused = BY_NAME["nao_arm_h25"].recognise(dataclasses.replace(table, rows=tuple(rows)).joint_path)
    assert isinstance(refused, Mismatch)
    assert reason in refused.reason
    departed = dataclasses.replace(table, rows=tuple(rows))
    with pytest.raises(InvalidInputError, match=f"a position with nothing locked .as nao_arm_h25, .*{reason}"):
        nk.solve_all(departed, np.zeros(3))
    assert matched(departed, nk.Target.pose(np.eye(4))).form.name == "five_r"


def test_a_departure_within_rounding_is_measured_and_accepted() -> None:
    table = arm("left")
    rows = list(table.rows)
    rows[3] = dataclasses.replace(rows[3], alpha=rows[3].alpha + 5e-11)
    found = matched(dataclasses.replace(table, rows=tuple(rows)), nk.Target.pose(np.eye(4)))
    assert found.geometry.residual == pytest.approx(5e-11, rel=1e-3)


@pytest.mark.parametrize(("offset", "upper"), [(0.0, 0.09), (0.015, 0.0), (-0.2, 0.05)])
def test_other_lengths_are_arms_too(offset: float, upper: float, rng: np.random.Generator) -> None:
    chain = arm("left", "h25", dataclasses.replace(V33_LENGTHS, elbow_offset_y=offset, upper_arm_length=upper))
    for q in rng.uniform(-3, 3, (10, 5)):
        assert min(move(r.q, q) for r in nk.solve_all(chain, chain.pose(q))) <= 1e-9


def test_an_arm_without_upper_arm_is_refused() -> None:
    chain = arm("left", "h25", dataclasses.replace(V33_LENGTHS, elbow_offset_y=0.0, upper_arm_length=0.0))
    with pytest.raises(InvalidInputError, match="shoulder and elbow are 0 m apart"):
        nk.solve_all(chain, np.zeros(3))


@pytest.mark.parametrize(
    ("target", "locked", "message"),
    [
        ((0.1, 0.2, 0.1), {}, "position with LElbowYaw and LWristYaw locked"),
        ((0.1, 0.2, 0.1), {"LShoulderPitch": 0.1, "LWristYaw": 0.1}, "LShoulderPitch, LWristYaw locked"),
        (np.eye(4), {"LElbowYaw": 0.0}, "a pose with LElbowYaw locked"),
        (nk.Target.orientation(np.eye(3)), {}, "an orientation with nothing locked"),
        (nk.Target.pose(np.eye(4), {"rz": 0.0}), {}, "nao_kin.solve takes any weights"),
        (np.eye(4), {"LElbowYaw": float("nan")}, "locked LElbowYaw"),
        (np.eye(4), {"LElbowYaw": "much"}, "locked LElbowYaw"),
        ((0.1, 0.2, 0.1), {"LElbowYaw": [0.1, 0.2], "LWristYaw": 0.1}, "solve_all_batch takes arrays"),
    ],
)
def test_what_cannot_be_asked_says_what_can(target: object, locked: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        nk.solve_all(chain_of("nao", "left_arm"), target, locked=locked)


def test_names_and_chains_that_do_not_exist() -> None:
    chain = chain_of("nao", "left_arm")
    with pytest.raises(UnknownNameError, match="Did you mean 'LElbowYaw'"):
        nk.solve_all(chain, np.eye(4), locked={"LElbowYa": 0.0})
    with pytest.raises(InvalidInputError, match=r"joints where the closed forms have"):
        nk.solve_all(nk.load("nao").chain("l_sole", "r_sole"), np.eye(4))
    with pytest.raises(InvalidInputError, match=r"robot\.chain"):
        nk.solve_all("nao", np.eye(4))


def test_held_joints_leave_the_rest_of_the_path(rng: np.random.Generator) -> None:
    chain = nk.load("nao").chain("l_sole", "r_gripper")
    path, Q = chain.joint_path, random_configurations(chain, 5, rng)
    from nao_kin.kernels.forward import poses

    for q in Q:
        fixed = {0: q[0], 3: q[3], len(q) - 1: q[-1]}
        rest = np.delete(q, list(fixed))
        assert np.abs(poses(held(path, fixed), rest[None, :])[0] - chain.pose(q).homogeneous).max() <= 1e-12
    with pytest.raises(ValueError, match="0"):
        held(path, dict(enumerate(Q[0])))


def test_locking_a_joint_too_many_makes_an_arm_of_the_rest(rng: np.random.Generator) -> None:
    """The gripper turns with the hand's opening; with that locked the chain is an arm of five joints again."""
    gripper = nk.load("nao").chain("torso", "l_gripper")
    for q in random_configurations(gripper, 20, rng):
        results = nk.solve_all(gripper, gripper.pose(q), locked={"LHand": q[5]})
        nearest = nk.nearest(results, q)
        assert nearest.solved
        assert move(nearest.q, q) <= 1e-9
        assert all(result.q[5] == q[5] for result in results)
    arm_chain = chain_of("nao", "left_arm")
    for q in random_configurations(arm_chain, 20, rng):
        results = nk.solve_all(arm_chain, arm_chain.pose(q), locked={"LWristYaw": q[4]})
        assert move(nk.nearest(results, q).q, q) <= 1e-9
