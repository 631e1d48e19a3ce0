"""Our own robots: the files are what tools/make_urdf.py writes, and they are sound.

Every expected figure is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pinocchio as pin
import pytest

from tests.make_urdf.files import NAO, NAO_H21, NAO_H25, ROBOTS, ROOT, floats, inertia, joints, links, model, tree

TOOL = ROOT / "tools" / "make_urdf.py"


def test_regenerating_gives_the_same_bytes(tmp_path):
    subprocess.run([sys.executable, TOOL, "--output", tmp_path], check=True)
    written = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    kept = {path.name: path.read_bytes() for path in (ROOT / "urdf").glob("*.urdf")}
    assert sorted(written) == sorted(f"{robot}.urdf" for robot in ROBOTS)
    assert written == kept


def test_check_passes_on_the_files_of_the_repository():
    done = subprocess.run([sys.executable, TOOL, "--check"], check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_check_names_the_file_that_differs(tmp_path):
    subprocess.run([sys.executable, TOOL, "--output", tmp_path], check=True)
    stale = tmp_path / "jaco2.urdf"
    stale.write_bytes(stale.read_bytes().replace(b"0.15675", b"0.15676"))
    (tmp_path / "phantomx.urdf").unlink()
    (tmp_path / "stranger.urdf").write_text("<robot/>")
    command = [sys.executable, TOOL, "--check", "--output", tmp_path]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode == 1
    assert [line.split()[0] for line in done.stderr.splitlines()] == ["jaco2.urdf", "phantomx.urdf", "stranger.urdf"]


@pytest.mark.parametrize("robot", ROBOTS)
def test_names_are_unique_and_the_header_speaks_for_itself(robot):
    text = (ROOT / "urdf" / f"{robot}.urdf").read_text(encoding="utf-8")
    assert tree(robot).attrib["name"] == robot
    assert text.isascii()
    for words in ("Sources:", "Decision", "BSD-3-Clause", "do not edit", "no vendor mesh"):
        assert words in " ".join(text.split("-->")[0].split())
    for tag in ("link", "joint", "material"):
        names = [element.attrib["name"] for element in tree(robot).findall(tag)]
        assert len(names) == len(set(names))
    assert set(links(robot)) & set(joints(robot)) == ({"LAnklePitch", "RAnklePitch"} if robot in NAO else set())


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_visual_is_a_coloured_primitive_and_no_robot_has_too_many(robot):
    defined = {material.attrib["name"] for material in tree(robot).findall("material")}
    visuals = list(tree(robot).iter("visual"))
    assert 10 <= len(visuals) <= 140
    assert {visual.find("material").attrib["name"] for visual in visuals} == defined
    for solid in (*visuals, *tree(robot).iter("collision")):
        (shape,) = solid.find("geometry")
        assert shape.tag in {"box", "cylinder", "sphere"}
        assert all(size > 0 for value in shape.attrib.values() for size in floats(value))


@pytest.mark.parametrize(
    ("robot", "moving"),
    [*((robot, 26) for robot in NAO_H25), *((robot, 22) for robot in NAO_H21), ("jaco2", 6), ("phantomx", 18)],
)
def test_loads_in_pinocchio(robot, moving):
    assert model(robot).nv == moving


# NAO: sums of the masses printed in the public nao.urdf of V33, V40 and V50; the NAOqi documentation says 5.195350 kg
# for V4. JACO2: kinova_inertial.xacro. PhantomX: 0.9756 + 24 * 0.02436.
MASSES = {"v32": 5.00591, "v33": 5.00591, "v40": 5.19535, "v50": 5.30535, "v60": 5.30535}


def mass(robot: str) -> float:
    return math.fsum(float(element.attrib["value"]) for element in tree(robot).iter("mass"))


@pytest.mark.parametrize("robot", NAO)
def test_total_mass_of_the_nao(robot):
    assert mass(robot) == pytest.approx(MASSES[robot.split("_")[1]], abs=1e-9)


def test_total_mass_of_arm_and_hexapod():
    assert mass("jaco2") == pytest.approx(0.46784 + 0.7477 + 0.99 + 0.6763 + 2 * 0.426367 + 0.99, abs=1e-12)
    assert mass("phantomx") == pytest.approx(1.56024, abs=1e-12)


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_inertia_belongs_to_a_possible_body(robot):
    for name, link in links(robot).items():
        if link.find("inertial") is None:
            continue
        principal = np.linalg.eigvalsh(inertia(link))
        assert principal[0] > 0, name
        assert principal[2] <= principal[0] + principal[1], name


def test_v33_takes_the_hip_inertia_of_v4():
    for hip in ("LHip", "RHip"):
        np.testing.assert_array_equal(inertia(links("nao_v33_h25")[hip]), inertia(links("nao_v40_h25")[hip]))
        assert float(links("nao_v33_h25")[hip].find("inertial/mass").attrib["value"]) == 0.1353


@pytest.mark.parametrize("robot", NAO_H21)
def test_h21_forearm_is_forearm_and_hand_of_h25_welded_together(robot):
    full = robot.replace("h21", "h25")
    for forearm, wrist in (("LForeArm", "l_wrist"), ("RForeArm", "r_wrist")):
        welded = body(full, forearm) + pin.SE3(np.eye(3), np.array([0.05595, 0, 0])).act(body(full, wrist))
        np.testing.assert_allclose(body(robot, forearm).toDynamicParameters(), welded.toDynamicParameters(), rtol=1e-7)
        assert links(robot)[wrist].find("inertial") is None


def body(robot: str, link: str) -> pin.Inertia:
    element = links(robot)[link]
    com = np.array(floats(element.find("inertial/origin").attrib["xyz"]))
    return pin.Inertia(float(element.find("inertial/mass").attrib["value"]), com, inertia(element))
