"""The command line as a person or a script meets it: a real process, its output, its exit status."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

import nao_kin as nk
from nao_kin.se3 import rpy
from nao_kin.trajectory.files.reading import write_trajectory


def run(*arguments: object, cwd: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {key: value for key, value in os.environ.items() if key not in ("FORCE_COLOR", "COLUMNS")}
    return subprocess.run(
        [sys.executable, "-m", "nao_kin", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        env=kept | environment,
        check=False,
    )


def quiet(stderr: str) -> bool:
    """Nothing but, on a machine's first run, the announcement of what is being compiled."""
    return all(line.startswith("nao_kin: compiling kernels") for line in stderr.splitlines())


def ok(*arguments: object, status: int = 0, **environment: str) -> str:
    done = run(*arguments, **environment)
    assert done.returncode == status, done.stdout + done.stderr
    if "json" not in arguments:
        assert max((len(line) for line in done.stdout.splitlines()), default=0) <= 80
    return done.stdout


def test_fk_prints_the_check_pose_of_model_and_document() -> None:
    text = ok("fk", "jaco2", "--tip", "end_effector", "--deg", 180, 270, 90, 180, 180, 0)
    model, document = (line.split() for line in text.splitlines() if line.startswith(("jaco2 arm  ", "practicum")))
    assert model[2:5] == ["0.4100", "0.2595", "0.0841"]
    assert document[1:4] == ["0.4100", "0.2595", "0.0840"]


def test_fk_as_json_takes_negative_numbers_and_gives_the_jacobian() -> None:
    q = [-0.3, 0.2, -0.5, -0.8, 0.4]
    data = json.loads(ok("fk", "nao", "--chain", "left_arm", "--jacobian", "--format", "json", *q))
    arm = nk.load("nao").chain("left_arm")
    assert data["position"] == arm.pose(q).translation.tolist()
    assert data["jacobian"] == arm.jacobian(q).tolist()
    assert data["q"]["LElbowRoll"] == -0.8


def test_fk_of_a_table_a_spec_and_a_path(tmp_path: Path) -> None:
    assert "kofinas_left_arm" in ok("fk", "kofinas_left_arm", 0, 0, 0, 0, 0)
    assert "l_sole" in ok("fk", "nao:l_sole:r_gripper")
    assert "LElbowRoll" in ok("fk", "nao:left_arm")
    table = tmp_path / "mine.toml"
    table.write_text(nk.document_chain("practicum_jaco2").to_toml())
    assert "practicum_jaco2" in ok("fk", table)
    urdf = tmp_path / "mine.urdf"
    urdf.write_text(Path(nk.load("jaco2").document.path).read_text())
    assert "end_effector" in ok("fk", urdf, "--tip", "end_effector")


def test_ik_reaches_and_says_where_it_does_not(tmp_path: Path) -> None:
    text = ok("ik", "nao", "--chain", "left_arm", "--xyz", 0.15, 0.15, "0.1")
    assert "The target is reached" in text
    page = tmp_path / "page.html"
    data = json.loads(
        ok(
            "ik",
            "jaco2",
            "--posture",
            "joint_1=20",
            "--posture",
            "joint_2=150",
            "--deg",
            "--html",
            page,
            "--format",
            "json",
        )
    )
    assert data["solved"] is True
    assert data["position_error"] < 1e-6
    assert page.stat().st_size > 500_000
    far = json.loads(ok("ik", "nao", "--chain", "left_arm", "--xyz", 5, 0, 0, "--format", "json", status=1))
    assert far["status"] == "OUT_OF_REACH"
    pose = nk.load("jaco2").chain("arm").pose([-1.7, 2.9, 0.5, 1.5, -1.3, -0.5])
    degrees = [math.degrees(angle) for angle in rpy(pose)]
    assert "is reached" in ok("ik", "jaco2", "--xyz", *pose.translation, "--rpy", *degrees, "--deg")


def test_ik_all_lists_every_branch() -> None:
    posture = ("--posture", "LShoulderRoll=17", "--posture", "LElbowRoll=-30", "--deg")
    text = ok("ik", "nao", "--chain", "left_arm", *posture, "--all")
    assert "4 solutions" in text
    assert "#1 SOLVED: shoulder upright, elbow bent to −." in text
    assert max(map(len, text.splitlines())) <= 80
    locked = ("--lock", "LElbowYaw=-1", "--lock", "LWristYaw=0.2")
    where = ("ik", "nao", "--chain", "left_arm", "--all", "--format", "json")
    data = json.loads(ok(*where, "--xyz", 0.15, 0.15, 0.1, *locked))
    assert [s["status"] for s in data["solutions"]] == ["SOLVED", *["OUTSIDE_LIMITS"] * 3]
    assert {s["q"]["LElbowYaw"] for s in data["solutions"]} == {-1.0}
    far = json.loads(ok(*where, "--xyz", 5, 0, 0, *locked, status=1))
    assert far["solutions"] == []
    assert "misses by" in far["reason"]


def test_compare_exits_with_its_verdict(tmp_path: Path) -> None:
    assert "yes" in ok("compare", "kofinas_left_leg")
    text = ok("compare", "thesis_left_arm", "--read-as", "modified", status=1)
    assert "LShoulderRoll (18.47 mm" in text
    data = json.loads(ok("compare", "practicum_jaco2", "--format", "json", status=1))
    assert data["first_departure"]["joint"] == "joint_5"
    table = tmp_path / "mine.toml"
    table.write_text(nk.document_chain("kofinas_left_arm").to_toml())
    assert "yes" in ok("compare", table, "nao:left_arm")
    assert "yes" in ok("compare", "nao:left_arm", "nao_v60_h25:left_arm")


def test_compare_explains(tmp_path: Path) -> None:
    written = tmp_path / "corrected.toml"
    text = " ".join(ok("compare", "matlab_left_hand", "--explain", "--corrected", written, status=1).split())
    assert "Agrees to" in text
    assert "tool z 0 mm → -12.31 mm (dropped) (12.31 mm)" in text
    assert "yes" in ok("compare", written, "nao_v33_h21:left_arm")
    data = json.loads(ok("compare", "matlab_left_hand", "--explain", "--format", "json", status=1))
    explanation = data["explanation"]
    assert [step["kind"] for step in explanation["steps"]] == ["dropped offset", "folded offset"]
    assert all(one["position_error"] < 1e-12 for one in explanation["alternatives"])
    assert data["corrected"] == written.read_text() == explanation["alternatives"][0]["table"]
    assert data["gauge"] is None
    assert data["first_pair"]["joints"] == ["LShoulderRoll", "LElbowYaw"]
    assert len(data["overlay"]["a"]) == len(data["overlay"]["b"]) == len(data["overlay"]["joints"]) + 1
    assert "first_pair" in json.loads(ok("compare", "practicum_jaco2", "--format", "json", status=1))
    assert "exactly" in ok("compare", "kofinas_head", "--explain")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("alpha =", "alpa ="), "bad.toml:7: unknown key 'alpa'"),
        (("d = 0.105", 'd = "long"'), "bad.toml:20: d"),
        (("d = 0.105", ""), "bad.toml:17: [[joint]] 3: d missing"),
        (("d = 0.105", "d = nan"), "bad.toml:20: d"),
        (('lengths = "m"', 'lengths = "feet"'), "bad.toml:3: lengths: expected m or mm"),
        (("[[joint]]", "[[joint]]\na = 0\nalpha = 0\nd = 0\ntheta = 0\n[[joint]]"), "expected 4 rows (LShoulderPitch"),
    ],
)
def test_bad_tables_are_refused_with_the_line_and_what_was_expected(tmp_path: Path, change, said: str) -> None:
    rows = "\n".join(f"[[joint]]\na = 0\nalpha = 0\nd = {d}\ntheta = 0\n" for d in (0, 0, 0.105, 0))
    text = f'name = "mine"\nconvention = "modified"\nlengths = "m"\n\n{rows}'
    assert change[0] in text
    (tmp_path / "bad.toml").write_text(text.replace(*change, 1))
    done = run("compare", "bad.toml", "nao_v50_h21:left_arm", "--explain", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert said in done.stderr


def test_robots_lists_what_loads() -> None:
    text = ok("robots")
    assert "nao_v50_h25 = nao" in text
    listed = json.loads(ok("robots", "--format", "json"))
    assert {row["name"] for row in listed["robots"]} == set(nk.robot_names()) - {"nao"}
    assert [row["name"] for row in listed["document_chains"]] == list(nk.document_chain_names())
    assert all(name in text for name in nk.document_chain_names())


def test_check_prints_findings_and_exits_with_1(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text('<robot name="arm">\n<link name="base"/>\n<link name="base"/>\n</robot>\n')
    done = run("check", "arm.urdf", cwd=tmp_path)
    assert done.returncode == 1
    assert "error[duplicate-link]" in done.stdout
    assert " --> arm.urdf:3:13\n" in done.stdout
    assert "Two links bear the same name" in ok("explain", "duplicate-link")


def test_pages_of_postures_and_of_a_motion(tmp_path: Path) -> None:
    postures, motion, page = tmp_path / "postures.json", tmp_path / "motion.csv", tmp_path / "page.html"
    postures.write_text(json.dumps({"up": {"joint_2": 3.1}, "folded": {"joint_2": 2.0}}), encoding="utf-8")
    ok("html", "jaco2", "--output", page, "--postures", postures)
    assert (
        page.read_bytes()
        == nk.export_html(
            tmp_path / "same.html", nk.load("jaco2"), {"up": {"joint_2": 3.1}, "folded": {"joint_2": 2.0}}
        ).read_bytes()
    )
    trajectory = nk.Trajectory(nk.load("jaco2").chain("arm").joints[:2], [0.0, 1.0], [[0.0, 3.0], [0.5, 2.0]], "bow")
    write_trajectory(motion, trajectory)
    ok("html", "jaco2", "--output", page, "--trajectory", motion)
    assert "2 samples over 1 s" in page.read_text(encoding="utf-8")


def test_ik_writes_a_page_of_every_solution(tmp_path: Path) -> None:
    page = tmp_path / "branches.html"
    target = ("--posture", "joint_2=4.71", "--posture", "joint_3=1.57", "--posture", "joint_5=3.14")
    ok("ik", "jaco2", *target, "--all", "--html", page)
    arm = nk.load("jaco2").chain("arm")
    solutions = nk.solve_all(arm, arm.pose([0, 4.71, 1.57, 0, 3.14, 0]))
    text = page.read_text(encoding="utf-8")
    assert f"{len(solutions)} solutions of a pose target" in text
    done = run("ik", "jaco2", "--xyz", 9, 9, 9, "--rpy", 0, 0, 0, "--all", "--html", tmp_path / "none.html")
    assert done.returncode == 1
    assert "none.html is not written" in done.stderr
    assert not (tmp_path / "none.html").exists()


def test_html_writes_a_page(tmp_path: Path) -> None:
    page = tmp_path / "nao.html"
    done = run("html", "nao", "--output", page, "--posture", "LHand=0.5")
    assert done.returncode == 0
    assert done.stdout == ""
    assert str(page) in done.stderr
    assert page.read_text(encoding="utf-8").lower().startswith("<!doctype html>")


def test_demo_does_the_main_job(tmp_path: Path) -> None:
    done = run("demo", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert max(len(line) for line in done.stdout.splitlines()) <= 80
    assert quiet(done.stderr)
    for expected in ("thesis_right_arm", "agrees", "joint_5", "Where to look next", "The target is reached"):
        assert expected in done.stdout
    assert (tmp_path / "demo" / "nao.html").is_file()
    assert (tmp_path / "demo" / "jaco2.html").is_file()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fk", "jako2"), "Did you mean 'jaco2'"),
        (("fk", "nao", "--chain", "larm"), "Did you mean 'left_arm'"),
        (("fk", "nao", "--tip", "l_grippr"), "Did you mean 'l_gripper'"),
        (("fk", "jaco2", 1, 2), "6 numbers (joint_1"),
        (("fk", "jaco2", 1, 2, 3, "x", 5, 6), "'x' is not a number"),
        (("fk", "jaco2", "nan", 2, 3, 4, 5, 6), "finite"),
        (("fk", "jaco2", "--dge", 1), "No such option: --dge"),
        (("fk", "no/such.urdf"), "no/such.urdf: There is no such file"),
        (("fk", "nao", "--base", "torso"), "--base needs --tip"),
        (("fk", "nao", "--chain", "head", "--tip", "Head"), "--chain already says"),
        (("fk", "thesis_left_arm", "--tip", "x"), "is a table"),
        (("fk", "nao:a:b:c"), "ROBOT:BASE:TIP"),
        (("ik", "nao"), "either --xyz"),
        (("ik", "nao", "--xyz", 1, 2), "requires 3"),
        (("ik", "nao", "--posture", "LElbowRoll"), "NAME=NUMBER"),
        (("ik", "nao", "--posture", "LElbowRol=1"), "Did you mean 'LElbowRoll'"),
        (("ik", "nao", "--xyz", 0, 0, 0, "--method", "ml"), "There is no method 'ml'"),
        (("ik", "nao:left_arm", "--xyz", 0, 0, 0, "--all"), "position with LElbowYaw and LWristYaw locked"),
        (("ik", "nao:left_arm", "--xyz", 0, 0, 0, "--all", "--lock", "LElbow=1"), "Did you mean"),
        (("ik", "nao:left_arm", "--xyz", 0, 0, 0, "--lock", "LElbowYaw=1"), "--lock goes with --all"),
        (("ik", "nao:left_arm", "--xyz", 0, 0, 0, "--all", "--method", "dls"), "leave out --all"),
        (("compare", "thesis_left_arm", "nao:left_arm"), "5 joints as"),
        (("compare", "nao:left_arm"), "say what to hold"),
        (("compare", "nao:left_arm", "nao:left_arm", "--read-as", "standard"), "--read-as is for tables"),
        (("ik", "nao", "--posture", "HeadYaw=0", "--rpy", 1, 2, 3), "--rpy goes with --xyz"),
        (("ik", "thesis_left_arm", "--xyz", 0, 0, 0), "is a table"),
        (("ik", "nao", "--xyz", 0, 0, 0, "--seed", -1), "seed"),
        (("html", "nao", "--output", "/nonexistent/x.html"), "/nonexistent/x.html: No such file"),
        (("html", "nao", "--output", "/dev/null"), "special file"),
        (("fk", "nao:torso:" + "x" * 5000), "There is no frame"),
        (("compare", "nothing.toml", "nao:left_arm"), "nothing.toml: no such file"),
        (("html", "nao", "--output", "/"), "a file to write"),
        (("html", "nao", "--output", "x.html", "--posture", "LHand=0.5", "--trajectory", "a.csv"), "is enough"),
        (("html", "nao", "--output", "x.html", "--postures", "pyproject.toml"), "no JSON"),
        (("nosuch",), "No such command"),
    ],
)
def test_wrong_usage_and_unreadable_input_exit_with_2_and_a_reason(arguments: tuple[object, ...], said: str) -> None:
    done = run(*arguments)
    assert done.returncode == 2, done.stdout + done.stderr
    assert said in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_a_hostile_file_exits_with_2_path_line_and_reason(tmp_path: Path) -> None:
    path = tmp_path / "bomb.urdf"
    path.write_text('<?xml version="1.0"?>\n<!DOCTYPE r [<!ENTITY a "x">]>\n<robot name="r"/>')
    done = run("fk", path, "--tip", "x")
    assert done.returncode == 2
    assert f"{path}:2:" in done.stderr
    assert "DOCTYPE" in done.stderr


def test_joints_outside_their_limits_are_mentioned() -> None:
    assert "joint_2 = 0 is outside" in ok("fk", "jaco2")
    assert "outside" not in ok("fk", "jaco2", 0, 3, 3, 0, 0, 0)


def test_an_answer_is_printed_before_its_page_fails() -> None:
    done = run("ik", "nao:left_arm", "--xyz", 0.15, 0.15, 0.1, "--html", "/nonexistent/x.html")
    assert done.returncode == 2
    assert "The target is reached" in done.stdout


def test_the_demo_as_json(tmp_path: Path) -> None:
    data = json.loads(ok("demo", "--output", tmp_path, "--format", "json"))
    assert [row["agrees"] for row in data["comparisons"] if row["a"] == "kofinas_head"] == [True, False]
    assert all(solution["solved"] for solution in data["solutions"])


@pytest.mark.parametrize("environment", [{"COLUMNS": "40"}, {"PYTHONIOENCODING": "ascii"}])
def test_narrow_or_plain_terminals_lose_no_digit(environment: dict[str, str]) -> None:
    text = ok("fk", "jaco2", "--deg", 180, 270, 90, 180, 180, 0, **environment)
    assert "-1.0472" in text
    assert "0.0661" in text


def test_version_help_and_no_colour() -> None:
    assert ok("--version").strip() == nk.__version__
    for command in ("", "fk", "ik", "compare", "check", "explain", "html", "demo", "robots", "bench"):
        assert "Usage" in ok(*filter(None, [command]), "--help")
    assert "\x1b[" not in ok("compare", "kofinas_head", NO_COLOR="1", FORCE_COLOR="1")


def test_a_reader_that_leaves_early_is_no_error() -> None:
    command = f"{sys.executable} -m nao_kin robots | head -1"
    done = subprocess.run(["/bin/sh", "-c", command], capture_output=True, text=True, check=False)
    assert done.stderr == ""
