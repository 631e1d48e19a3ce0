"""The head: the MATLAB example's table, its derivation, both cameras, directions and looking at a point."""

from __future__ import annotations

import os

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.nao import symbolic_head
from nao_kin.analytic.nao.looking import gaze, look_at
from nao_kin.analytic.nao.symbolic_head import derive_head
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError, MissingExtraError
from tests.analytic.goals import CAMERAS, chain_of, move

# MATLAB example, "Verification": theta_1 and theta_2 known, theta_1 and theta_2 derived, to the digits printed.
TABLE = (
    (0.7854, 0.3927, 0.7854, 0.3927),
    (0.7854, 0.3927, -2.3562, -1.7346),
    (0.5236, -0.2618, 0.5236, -0.2618),
    (0.5236, -0.2618, -2.618, -1.0801),
    (0.3927, 0.19635, 0.3927, 0.19635),
    (0.3927, 0.19635, -2.7489, -1.5383),
    (0.31416, -0.31416, 0.31416, -0.31416),
    (0.31416, -0.31416, -2.8274, -1.0278),
)
KNOWN = ((np.pi / 4, np.pi / 8), (np.pi / 6, -np.pi / 12), (np.pi / 8, np.pi / 16), (np.pi / 10, -np.pi / 10))


def needs_sympy() -> None:
    """Skip without sympy, except in CI, where it must be there."""
    if os.environ.get("CI") != "true":
        pytest.importorskip("sympy")


def test_the_matlab_examples_table() -> None:
    chain = nk.document_chain("matlab_head")
    rows = []
    for q in KNOWN:
        results = nk.solve_all(chain, chain.pose(q).translation)
        assert [result.branch for result in results] == ["before the neck", "behind the neck"]
        rows += [(*q, *result.q) for result in results]
    np.testing.assert_allclose(rows, TABLE, atol=5e-5)


def test_the_derivation_gives_the_examples_equations_and_table() -> None:
    needs_sympy()
    derived = derive_head()
    solve = derived.function()
    chain, rows = nk.document_chain("matlab_head"), []
    for q in KNOWN:
        x, y, z = chain.pose(q).translation
        found = [s for s in solve(x, z, 0.0539, 0.0679, -0.005) if abs(s[2] - y) < max(100 * 2.3e-16, 1e-6 * abs(y))]
        rows += [(*q, yaw, pitch) for yaw, pitch, _ in sorted(found, reverse=True)]
    np.testing.assert_allclose(rows, TABLE, atol=5e-5)
    at = {
        "yaw": 0.3,
        "pitch": -0.2,
        "x": 1.0,
        "y": 2.0,
        "z": 3.0,
        "camera_x": 4.0,
        "camera_z": 5.0,
        "neck_offset_z": 6.0,
    }
    c1, s1, c2, s2 = np.cos(0.3), np.sin(0.3), np.cos(-0.2), np.sin(-0.2)
    printed = (c1 - 5.0 * s2 - 4.0 * c2 + 2.0 * s1, 2.0 * c1 - s1, 3.0 - 6.0 - 5.0 * c2 + 4.0 * s2)  # eq1, eq2, eq3
    values = [float(e.subs({derived.symbols[name]: value for name, value in at.items()})) for e in derived.equations]
    np.testing.assert_allclose(values, printed, atol=1e-12)


@pytest.mark.parametrize(("name", "part", "lengths"), [("nao_v33_h25", "CameraTop_frame", (0.0539, 0.0679, 0.1265))])
def test_the_generated_function_equals_the_shipped_one(
    name: str, part: str, lengths: tuple[float, float, float], rng: np.random.Generator
) -> None:
    needs_sympy()
    solve, chain = derive_head().function(), chain_of(name, part)
    for q in random_configurations(chain, 200, rng):
        x, y, z = chain.pose(q).translation
        shipped = nk.solve_all(chain, [x, y, z])
        derived = [(yaw, pitch) for yaw, pitch, found_y in solve(x, z, *lengths) if abs(found_y - y) <= 1e-9]
        assert len(derived) == len(shipped) == 2
        for result in shipped:
            assert min(move(result.q, np.array(pair)) for pair in derived) <= 1e-6


def test_without_sympy_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "sympy", None)
    with pytest.raises(MissingExtraError, match=r"nao_kin\[symbolic\]"):
        symbolic_head.derive_head()


@pytest.mark.parametrize(("name", "part"), CAMERAS)
def test_a_direction_is_gazed_at(name: str, part: str, rng: np.random.Generator) -> None:
    chain = chain_of(name, part)
    axis = np.array([0.0, 0.0, 1.0] if "optical" in part else [1.0, 0.0, 0.0])
    for q in random_configurations(chain, 50, rng):
        wanted = chain.pose(q).rotation @ axis
        results = nk.solve_all(chain, gaze(3.0 * wanted, axis))
        assert len(results) == 2
        assert min(move(result.q, q) for result in results) <= 1e-9
        for result in results:
            assert result.position_error == 0.0  # over no axis that counts
            np.testing.assert_allclose(chain.pose(result.q).rotation @ axis, wanted, atol=1e-12)


@pytest.mark.parametrize(("name", "part"), CAMERAS)
def test_looking_at_a_point_puts_it_on_the_cameras_axis(name: str, part: str, rng: np.random.Generator) -> None:
    """By Pinocchio: the point seen from the camera has no parts beside the axis, and is before it."""
    chain = chain_of(name, part)
    axis = np.array([0.0, 0.0, 1.0] if "optical" in part else [1.0, 0.0, 0.0])
    for q in random_configurations(chain, 50, rng):
        T = chain.pose(q)
        distance = 10.0 ** rng.uniform(-1.5, 1.0)
        point = T.translation + distance * (T.rotation @ axis)
        results = look_at(chain, point, axis)
        assert min(move(result.q, q) for result in results) <= 1e-9
        assert nk.nearest(results, q).solved
        for result in results:
            seen = chain.pose(result.q).actInv(point)
            assert np.linalg.norm(seen - (seen @ axis) * axis) <= 1e-12
            assert seen @ axis > 0.0


def test_points_that_cannot_be_looked_at_say_so() -> None:
    chain = chain_of("nao", "CameraTop_frame")
    near = look_at(chain, [0.0, 0.0, 0.13])
    assert len(near) == 0
    assert "nearer to the neck" in near.reason
    above = look_at(chain, [0.001, 0.0, 3.0])
    assert above
    assert not above.solved
    assert above.reason == "Every solution is outside the limits."
    with pytest.raises(InvalidInputError, match="point: expected 3 numbers"):
        look_at(chain, [1.0, 2.0])
    with pytest.raises(InvalidInputError, match="tip_axis"):
        look_at(chain, [1.0, 2.0, 3.0], [0.0, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match="a direction"):
        look_at(chain_of("nao", "left_arm"), [1.0, 2.0, 3.0])
