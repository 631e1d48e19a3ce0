"""Laws that every method keeps, on both loops: limits at every iterate, finite, repeatable, and honest."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import in_limits, neutral, random_configurations
from nao_kin.errors import InvalidInputError, NaoKinError, UnknownNameError
from nao_kin.ik.problem import Problem, Run, Status, judge
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import Target
from nao_kin.se3 import position_distance, rotation_distance
from tests.conftest import robot

CASES = [
    ("nao_v33_h21", "left_arm", "position"),
    ("nao_v50_h25", "right_leg", "pose"),
    ("jaco2", "arm", "pose"),
    ("jaco2", "arm", "position"),
]
SHORT = Budget(iterations=300, restarts=2, patience=100)


def handled(kind: str) -> list[str]:
    return [name for name, method in nk.METHODS.items() if method.kind == "iteration" and kind in method.targets]


ALL = [(name, *case) for case in CASES for name in handled(case[2])]


def target_of(chain: nk.Chain, q: np.ndarray, kind: str) -> Target:
    T = chain.pose(q)
    return Target.pose(T) if kind == "pose" else Target.position(T.translation)


def strange_targets(chain: nk.Chain, kind: str, rng: np.random.Generator) -> list[Target]:
    """At the start, behind it by half a turn, at the base, just out of reach, far away, at a singular pose."""
    q = neutral(chain)
    T = chain.pose(q).homogeneous
    turned, base, far, away = T.copy(), T.copy(), T.copy(), T.copy()
    turned[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ T[:3, :3]
    base[:3, 3], far[:3, 3] = 0.0, 10.0 * T[:3, 3]
    away[:3, 3] = 1.001 * chain.pose(np.where(np.isfinite(chain.upper), chain.upper, 3.0)).translation
    straight = chain.pose(np.clip(np.zeros(len(q)), chain.lower, chain.upper)).homogeneous
    matrices = [T, turned, base, far, away, straight]
    return [Target.pose(M) if kind == "pose" else Target.position(M[:3, 3]) for M in matrices]


def is_there(result: nk.IKResult, target: Target) -> bool:
    """Measured by Pinocchio on the whole robot, not by the chain that solved."""
    chain = result.problem.chain
    T = chain.robot.pose(result.posture, chain.tip, chain.base)
    near = position_distance(T, target.T_base_target) <= 1.001e-6
    return near and (target.kind == "position" or rotation_distance(T, target.T_base_target) <= 1.001e-6)


@pytest.mark.parametrize(("method", "name", "part", "kind"), ALL)
def test_every_iterate_is_finite_and_inside_and_success_is_real(method, name, part, kind, rng) -> None:
    chain = robot(name).chain(part)
    reachable = [target_of(chain, q, kind) for q in random_configurations(chain, 6, rng)]
    for target in [*reachable, *strange_targets(chain, kind, rng)]:
        result = nk.solve(chain, target, method=method, budget=SHORT, trace=True)
        assert np.isfinite(result.trace.q).all()
        assert all(in_limits(chain, q, 1e-12) for q in result.trace.q)
        assert len(result.trace.q) == result.iterations + result.run.starts
        assert not result.solved or is_there(result, target)
        again = nk.solve(chain, target, method=method, budget=SHORT)
        np.testing.assert_array_equal(again.q, result.q)
        assert again.status is result.status


@pytest.mark.parametrize(("method", "name", "part", "kind"), ALL)
def test_one_step_is_the_reference_loops(method, name, part, kind, rng) -> None:
    chain = robot(name).chain(part)
    bound, one = slice(0, 6 if kind == "pose" else 3), Budget(iterations=1, restarts=0)
    checked = 0
    while checked < 40:
        q0, q_target = random_configurations(chain, 2, rng)
        if np.linalg.svd(chain.jacobian(q0)[bound], compute_uv=False)[-1] < 1e-2:
            continue
        target = target_of(chain, q_target, kind)
        ours, theirs = (
            nk.solve(chain, target, q0, method=method, budget=one, trace=True, engine=engine)
            for engine in ("compiled", "reference")
        )
        np.testing.assert_allclose(ours.trace.q, theirs.trace.q, atol=1e-9, rtol=0)
        checked += 1


@pytest.mark.parametrize("method", ["lm", "dls", "dls_adaptive", "sdls", "combination"])
@pytest.mark.parametrize(("name", "part", "kind"), CASES)
def test_whole_damped_runs_end_as_the_reference_loops(method, name, part, kind, rng) -> None:
    chain, budget = robot(name).chain(part), Budget(iterations=3000, restarts=0, patience=1000)
    for q in random_configurations(chain, 4, rng):
        near = np.clip(q + rng.uniform(-0.1, 0.1, len(q)), chain.lower, chain.upper)
        target = target_of(chain, q, kind)
        ours, theirs = (
            nk.solve(chain, target, near, method=method, budget=budget, engine=engine)
            for engine in ("compiled", "reference")
        )
        assert ours.status is theirs.status
        np.testing.assert_allclose(ours.q, theirs.q, atol=1e-6, rtol=0)


@pytest.mark.parametrize("method", handled("pose"))
def test_a_batch_is_its_single_solves(method: str, rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    targets = chain.poses(random_configurations(chain, 12, rng))
    many = nk.solve_batch(chain, targets, method=method, budget=SHORT)
    single = [nk.solve(chain, T, method=method, budget=SHORT) for T in targets]
    np.testing.assert_array_equal(many.q, [result.q for result in single])
    assert list(many.status) == [result.status for result in single]


@pytest.mark.parametrize("method", nk.METHODS)
def test_targets_a_little_away_are_reached(method: str, rng: np.random.Generator) -> None:
    """Positions for the transposes, whose way to a pose is too long near a singularity."""
    chain = robot("jaco2").chain("arm")
    kind = "position" if method.startswith("transpose") else nk.METHODS[method].targets[0]
    for q in random_configurations(chain, 10, rng):
        near = np.clip(q + rng.uniform(-0.05, 0.05, len(q)), chain.lower, chain.upper)
        assert nk.solve(chain, target_of(chain, q, kind), near, method=method).solved


def test_the_table_says_everything() -> None:
    assert next(iter(nk.METHODS)) == "lm"
    for name, method in nk.METHODS.items():
        assert method.name == name
        assert method.targets
        assert all(text and "\n" not in text for text in (method.reference, method.choose_it))
        assert [p.name for p in method.parameters][:1] == ["gain"] or not method.parameters
    assert len({(m.code, m.orientation_error) for m in nk.METHODS.values()}) == len(nk.METHODS)


def test_a_method_refuses_what_it_cannot_do() -> None:
    chain = robot("jaco2").chain("arm")
    T = chain.pose(neutral(chain))
    with pytest.raises(InvalidInputError, match=r"pose or orientation target.*newton_euler"):
        nk.solve(chain, T.translation, method="newton_euler")
    with pytest.raises(InvalidInputError, match="newton_quaternion"):
        nk.solve(chain, Target.pose(T, {"rz": 0.0}), method="newton_quaternion")
    with pytest.raises(UnknownNameError, match="Did you mean 'transpose'"):
        nk.solve(chain, T, method="transposed")


def test_parameters_are_named_and_positive(rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    q = random_configurations(chain, 1, rng)[0]
    T = chain.pose(q)
    with pytest.raises(UnknownNameError, match="Did you mean 'damping'"):
        nk.solve(chain, T, method="dls", parameters={"dampning": 0.1})
    assert nk.solve(chain, T, method="pinv", parameters={"gain": np.float32(1.0)}).solved
    nk.solve(chain, T, method="pinv", parameters={"gain": 1.0})  # remembered, and True equals 1.0
    for bad in (0.0, -1.0, np.nan, np.inf, True, "much", 10**400, [1.0]):
        with pytest.raises(InvalidInputError, match="parameter gain"):
            nk.solve(chain, T, method="pinv", parameters={"gain": bad})
    for given, words in ((5, "numbers by name"), ([("gain", 1.0)], "numbers by name"), ({3: 1.0, "gain": 1.0}, "'3'")):
        for engine in ("compiled", "reference"):
            with pytest.raises(NaoKinError, match=words):
                nk.solve(chain, T, method="pinv", parameters=given, engine=engine)
    one = Budget(iterations=1, restarts=0, largest_step=100.0)
    near = q + 0.01
    whole, half = (
        nk.solve(chain, T, near, method="pinv", parameters={"gain": K}, budget=one, trace=True).trace.q
        for K in (1.0, 0.5)
    )
    np.testing.assert_allclose(half[1] - half[0], 0.5 * (whole[1] - whole[0]), atol=1e-12)


@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_a_jump_is_not_a_solution(engine, rng: np.random.Generator) -> None:
    chain = robot("jaco2").chain("arm")
    for q, q0 in zip(random_configurations(chain, 10, rng), random_configurations(chain, 10, rng), strict=True):
        free = nk.solve(chain, chain.pose(q), q0, engine=engine)
        move = np.abs(free.q - q0).max()
        held = nk.solve(chain, chain.pose(q), q0, jump=0.9 * move, engine=engine)
        assert (free.status, held.status) == (Status.SOLVED, Status.JUMPED)
        assert not held.solved
        assert f"more than {0.9 * move:g}" in held.message
        assert nk.solve(chain, chain.pose(q), q0, jump=1.1 * move, engine=engine).solved
    for bad in (0.0, -1.0, np.nan, "far", True, 10**400):
        with pytest.raises(InvalidInputError, match="jump"):
            nk.solve(chain, chain.pose(q), q0, jump=bad, engine=engine)


def test_a_claimed_jump_is_measured_again() -> None:
    chain = robot("jaco2").chain("arm")
    q = neutral(chain)
    elsewhere = Problem(chain, Target.pose(chain.pose(q + 0.3)))
    assert judge(elsewhere, Run(q, Status.JUMPED)).status is Status.STALLED


def test_a_jump_is_told_after_the_caller_has_gone_on() -> None:
    """The result keeps a start of its own."""
    chain = robot("jaco2").chain("arm")
    q0 = neutral(chain)
    result = nk.solve(chain, chain.pose(q0 + 0.3), q0, jump=1e-3)
    assert result.status is Status.JUMPED
    told = result.message
    q0[:] = 99.0
    assert result.message == told


@pytest.mark.parametrize("method", handled("position"))
@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_joints_that_do_not_move_what_is_wanted_are_no_trouble(method: str, engine: str) -> None:
    """The NAO's neck frame lies on both of its axes, so no gain or damping can be measured by how far it moves."""
    chain, budget = robot("nao").chain("head"), Budget(iterations=20, restarts=2)
    p = chain.pose(neutral(chain)).translation
    assert nk.solve(chain, p, method=method, engine=engine, budget=budget).solved
    off = nk.solve(chain, p + np.array([0.0, 0.0, 0.1]), method=method, engine=engine, budget=budget)
    assert off.status is Status.OUT_OF_REACH
    assert off.position_error == pytest.approx(0.1)
    if nk.METHODS[method].several_tips:
        assert nk.solve(robot("nao").tree("torso", ["Head"]), {"Head": p}, method=method, budget=budget).solved


@pytest.mark.parametrize("engine", ["compiled", "reference"])
@pytest.mark.parametrize(
    "method", [name for name, row in nk.METHODS.items() if row.weighs and "position" in row.targets]
)
def test_an_error_whose_square_is_infinite_is_told_without_warnings(method: str, engine: str) -> None:
    """A free axis leaves it unproven that the target is out of reach, so the loop really heads for it."""
    target = Target.position([1e200, 1e200, 0.0], {"z": 0.0})
    result = nk.solve(robot("nao").chain("left_arm"), target, method=method, engine=engine, budget=SHORT)
    assert result.status in (Status.STALLED, Status.NOT_FINITE, Status.BUDGET_SPENT)
    assert result.position_error == pytest.approx(1e200 * np.sqrt(2.0))
    assert np.isfinite(result.q).all()


def test_options_of_another_kind_are_refused() -> None:
    chain, tree = robot("nao").chain("left_arm"), robot("nao").tree("torso", ["LArm"])
    for options, words in (({"budget": 5}, "nao_kin.Budget"), ({"tolerances": None}, "nao_kin.Tolerances")):
        for engine in ("compiled", "reference"):
            with pytest.raises(InvalidInputError, match=words):
                nk.solve(chain, [0.1, 0.1, 0.1], engine=engine, **options)
        with pytest.raises(InvalidInputError, match=words):
            nk.solve(tree, {"LArm": [0.1, 0.1, 0.1]}, **options)
    for options in ({"engine": "reference"}, {"engine": "fast"}, {"jump": 1.0}):
        with pytest.raises(InvalidInputError, match=next(iter(options))):
            nk.solve(tree, {"LArm": [0.1, 0.1, 0.1]}, **options)
    with pytest.raises(InvalidInputError, match="largest_step"):
        Budget(largest_step=10**400)
