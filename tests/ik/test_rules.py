"""Update rules against their formulas in numpy, and what theory says of every one of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nao_kin.chain import random_configurations
from nao_kin.ik import orientation, rules
from nao_kin.ik.aim import POSE, raw_error
from nao_kin.ik.methods import METHODS
from nao_kin.ik.rules import update
from nao_kin.ik.scales import Scales, chain_scales
from nao_kin.kernels.linear import orthogonal_rows
from nao_kin.se3 import rotation_angle
from tests.conftest import robot

SHAPES = [(6, 6), (6, 7), (3, 5), (6, 4), (3, 2), (12, 10)]
LEAST = rules.LEAST_DAMPING


def problems(m: int, n: int, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Jacobians and errors: regular, of a lost rank, nearly so, with held joints, and of nothing at all."""
    J, e = rng.standard_normal((m, n)), 0.3 * rng.standard_normal(m)
    lost, near, held = J.copy(), J.copy(), J.copy()
    lost[m - 1] = lost[0] + lost[1]
    near[m - 1] = near[0] + 1e-9 * near[m - 1]
    held[:, :2] = 0.0
    return [(J, e), (lost, e), (near, e), (held, e), (np.zeros((m, n)), e), (J, np.zeros(m))]


def step_of(name: str, J: np.ndarray, e: np.ndarray, tuned: tuple[float, ...]) -> np.ndarray:
    m, n = J.shape
    steps, given = np.full((2, n), np.nan), np.zeros(rules.PARAMETERS)
    given[: len(tuned)] = tuned
    proposed = update(METHODS[name].code, J.copy(), e, given, np.empty((m, m)), np.empty(m), steps)
    assert proposed == (2 if name == "combination" else 1)
    return steps[:proposed]


def by_singular_values(J: np.ndarray, e: np.ndarray, factor) -> np.ndarray:
    """Σ v_i factor(σ_i, all σ) u_iᵀ e."""
    U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
    return Vt.T @ (np.array([factor(s, sigma) for s in sigma]) * (U.T @ e))


def damped(squared: float):
    return lambda s, _: s / (s * s + squared + LEAST)


FORMULAS = {
    "lm": (
        (0.8, 0.05),
        lambda J, e, p: p[0] * by_singular_values(J, e, damped(p[1] * (e @ e))),
    ),
    "transpose": ((0.1,), lambda J, e, p: p[0] * J.T @ e),
    "pinv": ((0.9,), lambda J, e, p: p[0] * np.linalg.pinv(J, rcond=1e-8) @ e),
    "newton": ((0.9,), lambda J, e, p: p[0] * by_singular_values(J, e, damped(0.0))),
    "dls": ((1.0, 0.2), lambda J, e, p: p[0] * by_singular_values(J, e, damped(p[1] ** 2))),
    "tsvd": (
        (1.0, 0.3),
        lambda J, e, p: by_singular_values(J, e, lambda s, all_of: 1.0 / s if s > p[1] * all_of.max() else 0.0),
    ),
    "dls_adaptive": (
        (1.0, 0.4, 30.0),
        lambda J, e, p: by_singular_values(
            J, e, lambda s, all_of: damped((p[1] * max(0.0, 1.0 - all_of.prod() / p[2])) ** 2)(s, all_of)
        ),
    ),
}


@pytest.mark.parametrize("name", FORMULAS)
@pytest.mark.parametrize(("m", "n"), SHAPES)
def test_a_rule_is_its_formula(name: str, m: int, n: int, rng: np.random.Generator) -> None:
    tuned, formula = FORMULAS[name]
    for _ in range(20):
        J, e = problems(m, n, rng)[0]
        np.testing.assert_allclose(step_of(name, J, e, tuned)[0], formula(J, e, tuned), atol=1e-8, rtol=1e-7)


def test_buss_step_is_the_best_along_the_transpose(rng: np.random.Generator) -> None:
    for m, n in SHAPES:
        J, e = problems(m, n, rng)[0]
        step = step_of("transpose_buss", J, e, (1.0,))[0]
        direction = J.T @ e
        lengths = np.linspace(0.0, 2.0, 2001) * (step @ direction) / (direction @ direction)
        least = min(np.linalg.norm(e - J @ (length * direction)) for length in lengths)
        assert np.linalg.norm(e - J @ step) == pytest.approx(least, rel=1e-9)


def test_selectively_damped_is_the_sum_of_its_cut_directions(rng: np.random.Generator) -> None:
    """The definition in Buss and Kim 2005, word by word, for one position and for a pose as two parts."""
    bound = math.pi / 4.0
    for m, n in [(3, 4), (6, 6), (6, 7)]:
        for _ in range(50):
            J, e = rng.standard_normal((m, n)), rng.standard_normal(m)
            U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
            total = np.zeros(n)
            for u, s, v in zip(U.T, sigma, Vt, strict=True):
                M = sum(abs(v[k]) / s * np.linalg.norm(J[:, k].reshape(-1, 3), axis=1).sum() for k in range(n))
                gamma, phi = min(1.0, np.linalg.norm(u.reshape(-1, 3), axis=1).sum() / M) * bound, v * (u @ e) / s
                total += phi * min(1.0, gamma / np.abs(phi).max())
            total *= min(1.0, bound / np.abs(total).max())
            np.testing.assert_allclose(step_of("sdls", J, e, (1.0, bound))[0], total, atol=1e-9)


def test_the_combination_proposes_both(rng: np.random.Generator) -> None:
    J, e = problems(6, 6, rng)[0]
    pinv, transpose = step_of("combination", J, e, (1.0, 0.05))
    np.testing.assert_array_equal(pinv, step_of("pinv", J, e, (1.0,))[0])
    np.testing.assert_array_equal(transpose, step_of("transpose", J, e, (0.05,))[0])


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if 0 <= method.code <= rules.COMBINATION])
@pytest.mark.parametrize(("m", "n"), SHAPES)
def test_the_error_never_grows_on_the_linear_model(name: str, m: int, n: int, rng: np.random.Generator) -> None:
    """|e − J Δq| ≤ |e| for every rule, at any rank; the transpose with its default gain, which is 1/σ² at most."""
    for J, e in [problem for _ in range(20) for problem in problems(m, n, rng)]:
        scales = Scales(max(1e-3, np.linalg.norm(J, 2)), 1.0)
        for step in step_of(name, J, e, METHODS[name].tuned({}, scales)):
            assert np.isfinite(step).all()
            # LEAST_DAMPING is all that holds an undamped step in a lost direction: rounding shows there.
            slack = 1e-12 + 1e-15 * np.abs(J).max() * np.abs(step).max() * n
            assert np.linalg.norm(e - J @ step) <= np.linalg.norm(e) + slack
            assert (step[np.abs(J).max(axis=0) == 0.0] == 0.0).all()


def test_orthogonal_rows_are_the_singular_value_decomposition(rng: np.random.Generator) -> None:
    for m, n in SHAPES:
        for J, _ in problems(m, n, rng):
            W, U = J.copy(), np.empty((m, m))
            orthogonal_rows(W, U)
            np.testing.assert_allclose(U @ W, J, atol=1e-13)
            np.testing.assert_allclose(U.T @ U, np.eye(m), atol=1e-13)
            lengths = np.sort(np.linalg.norm(W, axis=1))[::-1]
            np.testing.assert_allclose(lengths[: min(m, n)], np.linalg.svd(J, compute_uv=False), atol=1e-12)
            across = W @ W.T - np.diag(np.diag(W @ W.T))
            assert np.abs(across).max() <= 1e-13 * max(1.0, lengths[0] ** 2)


@pytest.mark.parametrize("form", [orientation.EULER, orientation.QUATERNION])
def test_rows_of_an_orientation_error_are_its_derivative(form: int, rng: np.random.Generator) -> None:
    """By central differences of the error itself over joint moves, poses from Pinocchio."""
    chain, h = robot("jaco2").chain("arm"), 1e-6

    def error(q: np.ndarray, goal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        T = chain.pose(q)
        tip, e = np.concatenate([T.rotation.ravel(), T.translation]), np.empty(6)
        raw_error(POSE, goal, tip, e)
        J = np.ascontiguousarray(chain.jacobian(q))
        orientation.recast_rows(form, goal, tip, e, J)
        return e, J

    checked = 0
    while checked < 200:
        q, q_goal = random_configurations(chain, 2, rng)
        goal = chain.pose(q_goal).homogeneous
        R = chain.pose(q).rotation
        if rotation_angle(R.T @ goal[:3, :3]) > 3.0 or abs(R[2, 0]) > 0.95:
            continue  # near the places where these coordinates are singular
        e, J = error(q, goal)
        moves = [(error(q + h * d, goal)[0] - error(q - h * d, goal)[0]) / (2 * h) for d in np.eye(6)]
        np.testing.assert_allclose(-np.array(moves).T[3:], J[3:], atol=2e-6)
        np.testing.assert_allclose(e[:3], goal[:3, 3] - chain.pose(q).translation, atol=1e-12)
        checked += 1


def test_quaternion_and_euler_errors_are_those_of_the_practicum(rng: np.random.Generator) -> None:
    """e = η_a ε_d − η_d ε_a − ε_d × ε_a, and differences of roll, pitch and yaw, by Pinocchio's conversions."""
    import pinocchio as pin

    for _ in range(300):
        a, d = (pin.Quaternion(*(x / np.linalg.norm(x))) for x in rng.standard_normal((2, 4)))
        T = np.eye(4)
        T[:3, :3] = d.matrix()
        tip = np.concatenate([a.matrix().ravel(), np.zeros(3)])
        e, J = np.empty(6), np.zeros((6, 1))
        raw_error(POSE, T, tip, e)
        euler = e.copy()
        orientation.recast_rows(orientation.QUATERNION, T, tip, e, J)
        printed = a.w * d.vec() - d.w * a.vec() - np.cross(d.vec(), a.vec())
        sign = 1.0 if (d * a.inverse()).w >= 0.0 else -1.0
        np.testing.assert_allclose(e[3:], sign * printed, atol=1e-9)
        orientation.recast_rows(orientation.EULER, T, tip, euler, J)
        difference = pin.rpy.matrixToRpy(d.matrix()) - pin.rpy.matrixToRpy(a.matrix())
        np.testing.assert_allclose(np.exp(1j * euler[3:]), np.exp(1j * difference), atol=1e-9)


def test_scales_are_the_largest_seen(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    Q = random_configurations(chain, 50, rng)
    scales = chain_scales(chain, "position", Q)
    assert scales.singular_value == pytest.approx(max(np.linalg.norm(chain.jacobian(q)[:3], 2) for q in Q))
    volumes = [math.sqrt(np.linalg.det(chain.jacobian(q)[:3] @ chain.jacobian(q)[:3].T)) for q in Q]
    assert scales.manipulability == pytest.approx(max(volumes))
