"""The parts of the search, each held against something that shares no code with it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.crosscheck.edits import known_edits
from nao_kin.crosscheck.explanation import printed_resolution
from nao_kin.crosscheck.tables import Tables, errors_of, goal_of, motion
from nao_kin.se3 import from_xyz_rpy
from tests.conftest import robot


def random_table(rng: np.random.Generator, n: int = 5) -> nk.DHChain:
    rows = [nk.DHRow(*rng.uniform(-1, 1, 4).tolist(), sign=int(rng.choice([1, -1])), name=f"j{k}") for k in range(n)]
    rows[2] = dataclasses.replace(rows[2], kind="prismatic")
    ends = [from_xyz_rpy(rng.uniform(-1, 1, 3), rng.uniform(-1.5, 1.5, 3)) for _ in range(2)]
    return nk.DHChain(tuple(rows), "standard", *ends)


def test_the_batch_moves_as_the_tables_do(rng) -> None:
    """Both conventions in one batch, against the product of each table's own rows."""
    tables = [random_table(rng) for _ in range(4)]
    tables += [table.read_as("modified") for table in tables]
    Q = rng.uniform(-2, 2, (6, 5))
    found = motion(Tables.joined(Tables.of(table) for table in tables), Q)
    for m, table in enumerate(tables):
        poses = np.array([table.pose(q).homogeneous for q in Q])
        np.testing.assert_allclose(found.R[m], poses[:, :3, :3], rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(found.p[m], poses[:, :3, 3], rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_directions_are_derivatives(rng, convention) -> None:
    """x, z and the points on them say how the tip moves with every number of a row: finite differences."""
    table = random_table(rng).read_as(convention)
    q, step = rng.uniform(-2, 2, 5), 1e-6
    found = motion(Tables.of(table), q[None])
    tip = table.pose(q)
    for k in range(5):
        lines = (
            ("a", found.x, None),
            ("alpha", found.x, found.at_x),
            ("d", found.z, None),
            ("theta", found.z, found.at_z),
        )
        for column, axes, at in lines:
            moved = []
            for sign in (1, -1):
                rows = list(table.rows)
                rows[k] = dataclasses.replace(rows[k], **{column: getattr(rows[k], column) + sign * step})
                moved.append(dataclasses.replace(table, rows=tuple(rows)).pose(q))
            linear = (moved[0].translation - moved[1].translation) / (2 * step)
            W = (moved[0].rotation - moved[1].rotation) @ tip.rotation.T / (2 * step)
            axis = axes[0, 0, k]
            expected = axis if at is None else np.cross(axis, tip.translation - at[0, 0, k])
            np.testing.assert_allclose(linear, expected, rtol=0.0, atol=1e-8)
            angular = np.array([W[2, 1], W[0, 2], W[1, 0]])
            np.testing.assert_allclose(angular, 0.0 if at is None else axis, rtol=0.0, atol=1e-8)


def test_a_table_survives_the_batch(rng) -> None:
    table = random_table(rng)
    again = Tables.of(table).chain(0, table)
    assert again.rows == table.rows
    np.testing.assert_allclose(again.tool.homogeneous, table.tool.homogeneous, rtol=0.0, atol=1e-15)


def test_a_mirrored_arm_is_the_mirror_of_the_arm(rng) -> None:
    table = random_table(rng)
    mirrors = {
        edit.text: edit for edit in known_edits(Tables.of(table), table.joint_names) if edit.kind == "mirrored side"
    }
    assert len(mirrors) == 6
    for text, edit in mirrors.items():
        axis = {"yz": 0, "xz": 1, "xy": 2}[text.split("base's ")[1][:2]]
        M = np.eye(4)
        M[axis, axis] = -1.0
        mirrored = edit.change(Tables.of(table)).chain(0, table)
        senses = np.array([new.sign * old.sign for new, old in zip(mirrored.rows, table.rows, strict=True)])
        # A reflection turns revolute senses round, so the edit's own S is what is left of the signs.
        S = senses * np.array([1 if row.kind == "prismatic" else -1 for row in table.rows])
        if "senses of its joints" in text:
            np.testing.assert_array_equal(S, 1)
        q = rng.uniform(-2, 2, 5)
        expected = M @ table.pose(S * q).homogeneous @ M
        np.testing.assert_allclose(mirrored.pose(q).homogeneous, expected, rtol=0.0, atol=1e-14)


def test_known_edits_change_the_table_and_differ(rng) -> None:
    printed = Tables.of(random_table(rng))
    edits = known_edits(printed, [f"j{k}" for k in range(5)])
    keys = [edit.change(printed).keys()[0] for edit in edits]
    assert len(set(keys)) == len(keys)
    assert printed.keys()[0] not in keys
    assert len({edit.text for edit in edits}) == len(edits)


def test_errors_are_those_of_the_poses(rng) -> None:
    table, chain = nk.document_chain("thesis_left_arm"), robot("nao_v50_h21").chain("left_arm")
    goal = goal_of(chain, 5, rng, 0.0, 0.0)
    position, rotation = errors_of(motion(Tables.of(table), goal.Q), goal)
    pairs = [(table.pose(q), chain.pose(q)) for q in goal.Q]
    assert position[0] == pytest.approx(max(math.dist(a.translation, b.translation) for a, b in pairs), abs=1e-14)
    largest = max(2.0 * math.sin(nk.se3.rotation_distance(a, b) / 2.0) for a, b in pairs)
    assert rotation[0] == pytest.approx(largest, abs=1e-12)


@pytest.mark.parametrize(
    ("rows", "length", "angle"),
    [
        ([(0.105, math.pi / 2, 0.05598, 0.0)], 1e-5, 0.0),
        ([(0.1, math.pi / 4, 0.01, 0.0)], 1e-2, 0.0),
        ([(0.425, 1.57, 0.0, 0.0)], 1e-3, 1e-2),
        ([(0.425, math.radians(12.3), 0.0, 0.0)], 1e-3, math.radians(0.1)),
        ([(1 / 3, 0.1234567891, 0.0, 0.0)], 0.0, 0.0),
        ([(105.0, 90.0, 0.0, 0.0)], 0.0, 0.0),  # whole numbers in the wrong unit are no rounding
    ],
)
def test_the_precision_of_a_table_is_read_off_its_numbers(rows, length: float, angle: float) -> None:
    found = printed_resolution(Tables.of(nk.DHChain.from_table(rows, "standard")))
    assert (found.length, found.angle) == (pytest.approx(length), pytest.approx(angle))
