"""What the benchmarks measure with: turns, threads, the referee, goals, peers."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import typer

import nao_kin as nk
from nao_kin.bench import peers as peers_module
from nao_kin.bench.arms import main_arm, many_chains
from nao_kin.bench.bench_edges import bad_targets, farthest, near_full_reach
from nao_kin.bench.contest import Contender, SolverTask, contest
from nao_kin.bench.measuring import in_turns, one_thread
from nao_kin.bench.peers import installed_peers
from nao_kin.bench.referee import NEAR, Referee
from nao_kin.bench.sheet import Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import OutputFormat


def test_a_missed_goal_is_an_exit_status(capsys: pytest.CaptureFixture[str]) -> None:
    sheet = Sheet("rows", "title", (Heading("a", "a"), Heading("b", "b", ".1f")), [{"a": "x", "b": None}])
    goals = [Promise("speed", 2.0, 3.0), Promise("error", 0.0, 0.0, at_least=False)]
    assert [goal.met for goal in goals] == [False, True]
    assert not Promise("nothing", math.nan, 0.0).met
    conclude(Machine(), [sheet], goals, ["a note"], OutputFormat.text, enforce=False)
    assert "NO" in capsys.readouterr().out
    with pytest.raises(typer.Exit) as left:
        conclude(Machine(), [sheet], goals, [], OutputFormat.json, enforce=True)
    assert left.value.exit_code == 1
    assert json.loads(capsys.readouterr().out)["rows"] == [{"a": "x", "b": None}]


def test_a_busy_machine_is_mentioned() -> None:
    assert "busy" in str(Machine(cores=2, load=1.5))
    assert "busy" not in str(Machine(cores=2, load=0.5))
    assert "load" not in str(Machine(load=None))


def test_the_referee_is_strict() -> None:
    head = nk.load("nao").chain("head")
    referee, inside = Referee(head), np.array([0.2, 0.1])
    T = referee.pose(inside)
    assert np.abs(T - head.pose(inside).homogeneous).max() < 1e-12
    assert referee.accepts(inside, T)
    assert not referee.accepts(None, T)
    assert not referee.accepts(np.array([0.2, np.nan]), T)
    assert not referee.accepts(np.array([0.2]), T)
    beside = inside + np.array([0.0, 5e-6])
    assert not referee.accepts(beside, T)
    assert referee.accepts(beside, T, within=NEAR)
    far_out = np.array([3.0, 0.0])
    assert not referee.accepts(far_out, referee.pose(far_out))
    coupled = np.array([2.0, 0.5])  # each joint within its own range, the pitch outside what the yaw leaves it
    assert not referee.accepts(coupled, referee.pose(coupled))


def test_the_referee_knows_continuous_and_coupled_joints_and_paths_up_the_tree(rng: np.random.Generator) -> None:
    robot = nk.load("nao")
    for chain in (nk.load("jaco2").chain("arm"), robot.chain("l_sole", "r_sole"), robot.chain("right_leg")):
        referee, q = Referee(chain), rng.uniform(-0.3, 0.3, len(chain.joints))
        assert referee.pose(q) == pytest.approx(chain.pose(q).homogeneous, abs=1e-12)
        assert referee.jacobian(q) == pytest.approx(chain.jacobian(q), abs=1e-12)


def test_targets_of_the_edges_are_what_they_claim(rng: np.random.Generator) -> None:
    arm = nk.load("jaco2").chain("arm")
    q_far, reach = farthest(arm, 1000, rng)
    assert np.linalg.norm(arm.pose(q_far).translation) == pytest.approx(reach)
    poses = near_full_reach(arm, q_far, 0.99 * reach, 5, rng)
    assert np.linalg.norm(poses[:, :3, 3], axis=1) == pytest.approx(0.99 * reach, abs=1e-12)
    assert len(bad_targets(arm)) == 7


def test_without_the_extra_the_jaco2_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nao_kin.robot.known.example_robot_data_share", lambda: None)
    arm, notes = main_arm()
    assert arm.robot.name == "jaco2"
    assert "Measured on jaco2 instead" in notes[0]
    chains, missing = many_chains()
    assert {chain.robot.name for chain, _ in chains} == {"jaco2", "nao_v50_h25", "phantomx"}
    assert len(missing) == 3


def test_times_are_taken_in_turns() -> None:
    called: list[str] = []
    jobs = {"a": lambda: called.append("a"), "b": lambda: called.append("b")}
    times = in_turns(jobs, range(2), {"b": 2})
    assert called == ["a", "b", "b"] * 2
    assert [len(times[name]) for name in "ab"] == [2, 4]


def test_one_thread_is_given_back() -> None:
    import numba

    before = numba.get_num_threads()
    with one_thread():
        assert numba.get_num_threads() == 1
    assert numba.get_num_threads() == before


def test_every_contender_gets_every_target() -> None:
    arm = nk.load("jaco2").chain("arm")
    task = SolverTask.reachable(arm, 60, 3)
    asked: list[bytes] = []
    solver = Contender("echo", lambda T: asked.append(T.tobytes()), lambda _: None)
    (score,) = contest(task, [solver], 2, "counting")
    assert score.times.shape == (2, 60)
    assert (score.claimed, score.reached, score.near) == (0, 0, 0)
    assert set(asked) == {T.tobytes() for T in task.targets}


@pytest.mark.parametrize("name", tuple(peers_module.PEERS))
def test_installed_peers_solve_what_they_are_given(name: str) -> None:
    arm, _ = main_arm()
    task = SolverTask.reachable(arm, 20, 5)
    found, left_out = installed_peers(task, [name])
    if not found:
        pytest.skip(left_out[0])
    (score,) = contest(task, found, 1, name)
    assert score.near >= 10  # a solver without restarts finds two thirds; a wrong adapter finds none
