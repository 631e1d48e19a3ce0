"""The benchmarks, at sizes where only what they say can be tested, never how fast anything is."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from typer.testing import CliRunner

import nao_kin as nk
from nao_kin.bench import peers as peers_module
from nao_kin.bench.arms import many_chains
from nao_kin.bench.contest import Contender, SolverTask
from nao_kin.bench.peers import Peer, Unsuited
from nao_kin.cli.app import application
from tests.conftest import needs

if TYPE_CHECKING:
    from pathlib import Path

IK = ("ik", "--targets", "20", "--batch", "40", "--runs", "1")
TIPS = ("tips", "--targets", "6", "--samples", "2000")
EDGES = ("edges", "--targets", "10", "--samples", "5000")
METHODS = ("methods", "--targets", "12")
PRACTICUM = ("practicum", "--targets", "10")
TRAJECTORY = ("trajectory", "--cases", "200", "--targets", "10")
CLOSED = ("closed", "--targets", "20", "--newton", "2", "--starts", "12", "--rounds", "1")
GAIT = ("gait", "--paths", "1", "--duration", "1.5", "--no-speeds")
GUARD = ("guard", "--motions", "1")
LOOP = ("loop", "--seconds", "0.4", "--stall", "0.4")
SERVO = ("servo", "--no-dynamics")
FK = ("fk", "--configurations", "200", "--rounds", "1", "--samples", "5")


def bench(*arguments: str, status: int = 0) -> str:
    done = CliRunner().invoke(application(["bench"]), ["bench", *arguments, "--no-goals"], catch_exceptions=False)
    assert done.exit_code == status, done.output
    return done.stdout


def data_of(*arguments: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(bench(*arguments, "--format", "json"))
    assert data["machine"].keys() == {"python", "processor", "cores", "load", "versions"}
    assert all(goal.keys() == {"what", "value", "bound", "at_least", "met"} for goal in data["goals"])
    return data


def missed(data: dict[str, Any], *timed: str) -> list[str]:
    """Goals that are missed, those about time left out."""
    return [
        goal["what"] for goal in data["goals"] if not goal["met"] and not any(word in goal["what"] for word in timed)
    ]


def liar(task: SolverTask) -> Contender:
    """Says of every target that the start reaches it."""
    return Contender("liar", lambda _: task.start, lambda q: q)


def honest(task: SolverTask) -> Contender:
    """Solves as we do, in its own words."""
    chain = task.chain
    return Contender("honest", lambda T: nk.solve(chain, T), lambda r: r.q if r.solved else None)


def fussy(task: SolverTask) -> Contender:
    raise Unsuited("only arms of another colour")


@pytest.fixture
def fakes(monkeypatch: pytest.MonkeyPatch) -> None:
    made = (
        Peer("liar", "liar", "json", liar),
        Peer("honest", "honest", "json", honest),
        Peer("fussy", "fussy", "json", fussy),
        Peer("absent", "absent-on-the-shelf", "no_such_module_here", honest),
    )
    monkeypatch.setattr(peers_module, "PEERS", {peer.name: peer for peer in made})


@pytest.mark.parametrize(
    "arguments", [FK, IK, EDGES, METHODS, PRACTICUM, TRAJECTORY, CLOSED, TIPS, GAIT, GUARD, LOOP, SERVO]
)
def test_text_fits_a_terminal(arguments: tuple[str, ...]) -> None:
    text = bench(*arguments)
    assert max(map(len, text.splitlines())) <= 80
    assert "should be" in text
    assert "numpy" in text


def test_the_guard_stops_what_collides_and_nothing_else() -> None:
    data = data_of(*GUARD)
    assert missed(data) == []
    assert {(row["robot"], row["kind"]) for row in data["rows"]} >= {("nao", "colliding"), ("jaco2", "clear")}
    assert all(row["path"] < 0.0 for row in data["rows"] if row["kind"] == "colliding")
    assert all(row["path"] >= 10.0 for row in data["rows"] if row["kind"] == "clear")


def test_the_loop_counts_deadlines_and_comes_to_rest() -> None:
    data = data_of(*LOOP)
    assert missed(data, "in time") == []
    commanding, silent = data["rows"]
    assert commanding["met"] + commanding["missed"] == commanding["cycles"]
    assert (silent["met"], silent["missed"]) == (0, silent["cycles"])


def test_feed_forward_is_worth_what_is_promised() -> None:
    data = data_of(*SERVO)
    assert missed(data) == []
    assert all(row["cut"] == 0 for row in data["rows"])


def test_fk_compares_every_bundled_robot_with_pinocchio() -> None:
    data = data_of(*FK)
    assert {"poses", "Jacobians"} == {row["what"] for row in data["rows"]}
    assert all(row["ms"] > 0.0 and row["over_loop"] > 0.0 for row in data["rows"])
    assert {"nao_v50_h25", "jaco2", "phantomx"} <= {row["robot"] for row in data["differences"]}
    assert all(max(row["poses"], row["jacobians"]) <= 1e-12 for row in data["differences"])
    assert missed(data, "times the loop") == []


def test_ik_solves_everything_alone_in_batches_and_on_many_robots() -> None:
    data = data_of(*IK)
    assert [row["solver"] for row in data["single_pose"]] == ["nao_kin"]
    assert all(row["success"] == 100.0 for row in data["single_pose"] + data["single_position"] + data["robots"])
    assert all(row["success"] == 100.0 and row["same_bits"] and row["ratio"] is None for row in data["batch"])
    assert len(data["robots"]) == len(many_chains()[0])
    assert missed(data) == []


def test_tips_serves_both_hands_and_believes_no_reach_that_the_model_does_not_confirm() -> None:
    data = data_of(*TIPS)
    assert missed(data) == []
    assert all(row["false"] == 0 for row in data["reachable"] + data["unreachable"])
    up, forward = data["reach"]
    # Standing, the shoulder is 85 + 100 + 102.9 + 45.11 + 100 mm above the sole; upper arm and forearm with their
    # offsets, hypot(105, 15) and hypot(55.95 + 57.75, 12.31), are 220.5 mm long.
    assert 0.64 < up["still"] < 0.4331 + 0.2205 < up["moving"]
    assert 0.21 < forward["still"] < 0.2205 < forward["moving"]
    assert all(row["both"] <= row["moving"] + 1e-3 for row in (up, forward))


def test_methods_reach_near_targets_and_none_lies() -> None:
    data = data_of(*METHODS)
    # So few targets make percentages coarse; that nobody claims what is not so holds for any number.
    assert missed(data, "near targets", "NAO arm") == []
    iterating = {name for name, method in nk.METHODS.items() if method.kind == "iteration"}
    assert {row["method"] for row in data["easy"]} == iterating
    able = {row["method"] for row in data["two_hands"]}
    assert able == {name for name, method in nk.METHODS.items() if method.several_tips}
    verdicts = [note for note in data["notes"] if note.startswith(("Thesis", "Practicum"))]
    assert len(verdicts) >= 14
    assert all("confirmed" in verdict or "refuted" in verdict for verdict in verdicts)


def test_convergence_plots_are_pictures(tmp_path: Path) -> None:
    from nao_kin.bench.bench_methods import draw
    from nao_kin.bench.method_sets import easy

    near = easy(nk.load("nao_v33_h21").chain("left_arm"), "position", 5, np.random.default_rng(0))
    (written,) = draw([near], tmp_path)
    assert written.read_bytes().startswith(b"\x89PNG")


def test_the_practicums_tasks_report_every_fault() -> None:
    data = data_of(*PRACTICUM)
    assert missed(data, "pseudo-inverse") == []
    assert {row["count"] for row in data["task_1ef_near"]} >= {128, 64, 1}
    assert sum(note.startswith(("1f,", "1g,")) for note in data["notes"]) == 4


def test_trajectory_agrees_with_ruckig_and_names_what_ends_a_line() -> None:
    needs("ruckig")
    data = data_of(*TRAJECTORY)
    assert [goal["what"] for goal in data["goals"] if not goal["met"]] == []
    assert {row["line"]: row["completed"] for row in data["lines"]}["out of reach"] is False
    assert all(row["cause"] != "NONE" for row in data["lines"] if not row["completed"])
    assert len(data["task_2b"]) == 2


def test_closed_recovers_everything_and_prices_the_folded_arm() -> None:
    data = data_of(*CLOSED)
    forms = {row["form"] for row in data["closed"]}
    assert {"nao_head", "nao_arm_h21", "nao_arm_h25"} <= forms
    assert all(row["recovered"] == row["regular"] and row["missing"] == 0 for row in data["closed"])
    assert all(row["wrong"] == row["nan"] == 0 for row in data["strata"])
    same, solved = data["folded"]
    # By the offsets alone: the elbow's 15 mm turns with the upper arm, the hand's 12.31 mm with the hand.
    assert 5.0 < same["median"] < same["most"] <= 2.0 * 15.0 + 12.31
    assert solved["median"] > 5.0
    assert missed(data, "CFJ") == []


def test_a_peer_that_lies_has_no_success(fakes: None) -> None:
    data = data_of(*IK, "--peers")
    for sheet in ("single_pose", "single_position"):
        success = {row["solver"]: (row["success"], row["near"]) for row in data[sheet]}
        assert success["liar"] == (0.0, 0.0)
        assert success["nao_kin"] == (100.0, 100.0)
    assert {row["solver"]: row["success"] for row in data["single_pose"]}["honest"] == 100.0
    assert "Without roboticstoolbox, the goals against it are not measured." in data["notes"]
    assert "Without fussy: only arms of another colour." in data["notes"]
    assert "Without absent: to have it beside, pip install absent-on-the-shelf." in data["notes"]


def test_edges_proves_what_is_out_of_reach_and_refuses_nonsense() -> None:
    data = data_of(*EDGES)
    assert all(row["success"] == 100.0 for row in data["singular"])
    assert all(row["proven"] == row["targets"] for row in data["unreachable"] if row["factor"] >= 1.5)
    assert all(row["false"] == 0 for row in data["unreachable"])
    assert {row["nao_kin"] for row in data["bad_input"]} == {"refused"}
    assert missed(data, "proven no") == []


def test_edges_tells_a_claim_from_an_answer(fakes: None) -> None:
    data = data_of(*EDGES, "--peers")
    told = {(row["solver"], row["factor"]): (row["claimed"], row["reached"]) for row in data["unreachable_peers"]}
    assert told["liar", 5.0] == (10, 0)
    assert told["honest", 5.0] == (0, 0)
    assert {row["solver"] for row in data["singular"]} == {"nao_kin", "liar", "honest"}


def test_pages_are_plain_data() -> None:
    data = data_of("page", "--rounds", "1")
    assert [row["robot"] for row in data["rows"]] == ["nao", "jaco2", "phantomx"]
    assert all(row["ratio"] > 0 and 0.9 < row["mb"] < 5 for row in data["rows"])


def test_startup_is_plain_data() -> None:
    data = data_of("startup", "--rounds", "1")
    assert [row["what"] for row in data["rows"]][-1] == "first solve, warm cache"
    assert all(row["ratio"] == pytest.approx(row["ms"] / row["against_ms"]) for row in data["rows"])


def test_gait_finds_feet_where_they_stood() -> None:
    data = data_of(*GAIT)
    assert missed(data) == []
    assert len(data["walks"]) == 12
    assert all(0.0 < row["slip"] < 1e-9 for row in data["walks"])
    assert {row["give"] for row in data["torsos"]} == {"feet", "yaw"}


def test_planted_errors_are_explained() -> None:
    data = data_of("explain", "--singles", "10", "--doubles", "3", "--seed", "1")
    assert missed(data, "slowest") == []
    assert sum(row["tables"] for row in data["one_error"]) == 10
    assert sum(row["tables"] for row in data["two_errors"]) == 6
