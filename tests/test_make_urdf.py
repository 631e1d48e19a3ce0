"""Our own robots: the files are what tools/make_urdf.py writes, and they say what their sources say.

Every expected figure here is typed from the source named beside it, never imported from the tables under test.
"""

from __future__ import annotations

import math
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

ROOT = Path(__file__).resolve().parent.parent
TOOL = ROOT / "tools" / "make_urdf.py"
NAO_H25 = ("nao_v32_h25", "nao_v33_h25", "nao_v40_h25", "nao_v50_h25", "nao_v60_h25")
NAO_H21 = ("nao_v33_h21", "nao_v40_h21", "nao_v50_h21", "nao_v60_h21")
NAO = NAO_H25 + NAO_H21
ROBOTS = (*NAO, "jaco2", "phantomx")
LEGS = ("rf", "rm", "rr", "lf", "lm", "lr")


@cache
def tree(robot: str) -> etree._Element:
    return etree.parse(ROOT / "urdf" / f"{robot}.urdf").getroot()


@cache
def model(robot: str) -> pin.Model:
    return pin.buildModelFromUrdf(str(ROOT / "urdf" / f"{robot}.urdf"))


def floats(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def joints(robot: str) -> dict[str, etree._Element]:
    return {joint.attrib["name"]: joint for joint in tree(robot).iter("joint")}


def links(robot: str) -> dict[str, etree._Element]:
    return {link.attrib["name"]: link for link in tree(robot).iter("link")}


def limit(robot: str, joint: str) -> dict[str, float]:
    return {key: float(value) for key, value in joints(robot)[joint].find("limit").attrib.items()}


def placement(robot: str, frame: str, base: str, posture: dict[str, float] | None = None) -> pin.SE3:
    """Pose of a frame in another; a continuous joint takes (cos, sin) in Pinocchio's configuration."""
    the_model = model(robot)
    data, q = the_model.createData(), pin.neutral(the_model)
    for name, angle in (posture or {}).items():
        assert the_model.existJointName(name)
        joint = the_model.joints[the_model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
    pin.framesForwardKinematics(the_model, data, q)
    assert the_model.existFrame(frame, pin.BODY)
    assert the_model.existFrame(base, pin.BODY)
    ids = [the_model.getFrameId(name, pin.BODY) for name in (base, frame)]
    return data.oMf[ids[0]].actInv(data.oMf[ids[1]])


# --- the files as files ---------------------------------------------------------------------------------------------


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


# --- masses ---------------------------------------------------------------------------------------------------------

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


def inertia(link: etree._Element) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (
        float(link.find("inertial/inertia").attrib[f"i{key}"]) for key in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


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


# --- NAO: joints and limits -----------------------------------------------------------------------------------------

# Public nao.urdf of V50: lower, upper, effort, as printed.
LIMITS = {
    "HeadYaw": (-2.08567, 2.08567, 1.547),
    "HeadPitch": (-0.671952, 0.514872, 1.532),
    "LShoulderPitch": (-2.08567, 2.08567, 1.329),
    "LShoulderRoll": (-0.314159, 1.32645, 1.7835),
    "LElbowYaw": (-2.08567, 2.08567, 1.547),
    "LElbowRoll": (-1.54462, -0.0349066, 1.532),
    "LWristYaw": (-1.82387, 1.82387, 0.4075),
    "LHand": (0, 1, 0.292),
    "LHipYawPitch": (-1.14529, 0.740718, 3.348),
    "LHipRoll": (-0.379435, 0.79046, 3.348),
    "LHipPitch": (-1.53589, 0.48398, 3.023),
    "LKneePitch": (-0.0923279, 2.11255, 3.023),
    "LAnklePitch": (-1.18944, 0.922581, 3.023),
    "LAnkleRoll": (-0.397761, 0.768992, 3.348),
    "RHipYawPitch": (-1.14529, 0.740718, 3.348),
    "RHipRoll": (-0.79046, 0.379435, 3.348),
    "RHipPitch": (-1.53589, 0.48398, 3.0226),
    "RKneePitch": (-0.0923279, 2.11255, 3.0226),
    "RAnklePitch": (-1.1863, 0.932006, 3.0226),
    "RAnkleRoll": (-0.768992, 0.397761, 3.348),
    "RShoulderPitch": (-2.08567, 2.08567, 1.329),
    "RShoulderRoll": (-1.32645, 0.314159, 1.783),
    "RElbowYaw": (-2.08567, 2.08567, 1.547),
    "RElbowRoll": (0.0349066, 1.54462, 1.532),
    "RWristYaw": (-1.82387, 1.82387, 0.4075),
    "RHand": (0, 1, 0.292),
}
LIMITS_V32 = {  # public nao.urdf of V32
    "LShoulderRoll": (0.00872665, 1.64934, 1.7835),
    "RShoulderRoll": (-1.64934, -0.00872665, 1.783),
    "LElbowRoll": (-1.56207, -0.00872665, 1.532),
    "RElbowRoll": (0.00872665, 1.56207, 1.532),
}


@pytest.mark.parametrize("robot", NAO)
def test_joints_ranges_and_efforts_of_the_nao(robot):
    expected = LIMITS | (LIMITS_V32 if "v32" in robot else {})
    if "h21" in robot:
        expected = {name: row for name, row in expected.items() if not name.endswith(("WristYaw", "Hand"))}
    moving = {name for name, joint in joints(robot).items() if joint.attrib["type"] == "revolute"}
    assert moving == set(expected)
    for name, (lower, upper, effort) in expected.items():
        given = limit(robot, name)
        assert (given["lower"], given["upper"], given["effort"]) == (lower, upper, effort), name


# NAOqi documentation (V3.2, V3.3) and rUNSWift: motor speed [rpm] and reduction ratio, by joint without its side.
RATIOS = {
    201.3: ("HipYawPitch", "HipRoll", "AnkleRoll"),
    130.85: ("HipPitch", "KneePitch", "AnklePitch"),
    150.27: ("HeadYaw", "ElbowYaw", "ShoulderPitch"),
    173.22: ("HeadPitch", "ShoulderRoll", "ElbowRoll"),
    50.61: ("WristYaw",),
    36.24: ("Hand",),
}
LEG_RPM = {"v32": 8000, "v33": 8000, "v40": 8300, "v50": 8300, "v60": 8700}
ARM_RPM = {"v32": 11900, "v33": 11900, "v40": 10700, "v50": 10700, "v60": 10700}
HAND_RPM = {"v33": 11900, "v40": 8400, "v50": 8400, "v60": 8400}


@pytest.mark.parametrize("robot", NAO)
def test_speeds_are_those_of_the_motors(robot):
    version = robot.split("_")[1]
    for name, joint in joints(robot).items():
        if joint.attrib["type"] == "fixed":
            continue
        kind = name if name.startswith("Head") else name[1:]
        ratio = next(ratio for ratio, kinds in RATIOS.items() if kind in kinds)
        rpm = LEG_RPM[version] if ratio in (201.3, 130.85) else ARM_RPM[version]
        if kind in {"WristYaw", "Hand"}:
            rpm = HAND_RPM.get(version, math.nan)
        if (version, kind) == ("v60", "ShoulderPitch"):
            rpm = 11400
        wanted = {"WristYaw": 5.03144, "Hand": 3.71}[kind] if math.isnan(rpm) else rpm * 2 * math.pi / 60 / ratio
        assert limit(robot, name)["velocity"] == pytest.approx(wanted, abs=1e-4), name


@pytest.mark.parametrize("robot", NAO)
def test_hip_yaw_pitch_axes_are_exact_and_coupled(robot):
    half = math.sqrt(0.5)
    assert floats(joints(robot)["LHipYawPitch"].find("axis").attrib["xyz"]) == [0, half, -half]
    assert floats(joints(robot)["RHipYawPitch"].find("axis").attrib["xyz"]) == [0, half, half]
    mimics = {
        name: dict(joint.find("mimic").attrib)
        for name, joint in joints(robot).items()
        if joint.find("mimic") is not None
    }
    assert mimics == {"RHipYawPitch": {"joint": "LHipYawPitch", "multiplier": "1", "offset": "0"}}


@pytest.mark.parametrize("robot", NAO)
def test_positive_hip_yaw_pitch_turns_both_toes_inward_and_swings_the_legs_back(robot):
    left = placement(robot, "l_sole", "torso", {"LHipYawPitch": 0.3})
    right = placement(robot, "r_sole", "torso", {"RHipYawPitch": 0.3})
    assert left.rotation[1, 0] < -0.1
    assert left.translation[0] < -0.02
    mirror = np.diag([1.0, -1.0, 1.0])
    np.testing.assert_allclose(right.translation, mirror @ left.translation, atol=1e-15)
    np.testing.assert_allclose(right.rotation, mirror @ left.rotation @ mirror, atol=1e-15)


@pytest.mark.parametrize("robot", NAO)
def test_right_mirrors_left(robot):
    """Origins, axes and ranges, but for RAnklePitch, whose range differs in the public URDF."""
    table = joints(robot)
    for name, joint in table.items():
        if not name.startswith(("L", "l_")) or "Fsr" in name:
            continue
        other = table[("r" if name[0] == "l" else "R") + name[1:]]
        x, y, z = floats(joint.find("origin").attrib["xyz"])
        assert floats(other.find("origin").attrib["xyz"]) == [x, -y, z]
        roll, pitch, yaw = floats(joint.find("origin").attrib["rpy"])
        assert floats(other.find("origin").attrib["rpy"]) == [-roll, pitch, -yaw]
        if joint.attrib["type"] == "fixed" or name in {"LAnklePitch", "LHand", "LHipYawPitch"}:
            continue
        axis = floats(joint.find("axis").attrib["xyz"])
        assert floats(other.find("axis").attrib["xyz"]) == axis
        left, right = limit(robot, name), limit(robot, other.attrib["name"])
        same = axis == [0, 1, 0]  # pitch; roll and yaw change sign in a mirror
        wanted = (left["lower"], left["upper"]) if same else (-left["upper"], -left["lower"])
        assert (right["lower"], right["upper"]) == wanted, name


# --- NAO: frames at zero --------------------------------------------------------------------------------------------

# Sums of the NAOqi documentation's lengths [mm] in the torso frame. Arm: 98 + 15 = 113 (V3.2: 98), 105 + 55.95 + 57.75
# = 218.70 (V3.2: 90 + 50.55 + 58 = 198.55), 100 - 12.31 (V3.2: 100 - 15.90). Leg: 85 + 100 + 102.9 = 287.9 to the
# ankle, then 45.11 to the public URDF's sole or 45.19 to the documented effector. Head: 126.5 + the camera's place.
ARM = {"old": (0.19855, 0.098, 0.0841), "new": (0.2187, 0.113, 0.08769)}
CAMERAS = {  # x, z in the torso, pitch: V3.x; V4, V5, V6
    "old": {"CameraTop_frame": (0.0539, 0.1944, 0.0), "CameraBottom_frame": (0.0488, 0.15031, 0.6981)},
    "new": {"CameraTop_frame": (0.05871, 0.19014, 0.0209435), "CameraBottom_frame": (0.05071, 0.14424, 0.692896)},
}


@pytest.mark.parametrize("robot", NAO)
def test_frames_at_zero_are_the_sums_of_the_documented_lengths(robot):
    x, y, z = ARM["old" if "v32" in robot else "new"]
    effector = -0.33301 if "v32" in robot else -0.33309
    expected = {"Head": (0, 0, 0.1265), "gaze": (0.05871, 0, 0.19014)}
    for side, sign in (("L", 1), ("R", -1)):
        small = side.lower()
        expected[f"{side}Arm"] = expected[f"{small}_gripper"] = (x, sign * y, z)
        expected[f"{small}_wrist"] = (0.14055 if "v32" in robot else 0.16095, sign * y, 0.1)
        expected[f"{small}_sole"] = (0, sign * 0.05, -0.33301)
        expected[f"{side}Leg"] = (0, sign * 0.05, effector)
        expected[f"{small}_ankle"] = (0, sign * 0.05, -0.2879)
    for name, position in expected.items():
        pose = placement(robot, name, "torso")
        np.testing.assert_allclose(pose.translation, position, rtol=0, atol=1e-15, err_msg=name)
        np.testing.assert_array_equal(pose.rotation, np.eye(3), err_msg=name)


@pytest.mark.parametrize("robot", NAO)
def test_cameras(robot):
    for name, (x, z, pitch) in CAMERAS["old" if "v3" in robot else "new"].items():
        pose = placement(robot, name, "torso")
        np.testing.assert_allclose(pose.translation, (x, 0, z), rtol=0, atol=1e-15)
        np.testing.assert_allclose(pose.rotation, pin.rpy.rpyToMatrix(0, pitch, 0), rtol=0, atol=1e-15)
        optical = placement(robot, name.replace("_frame", "_optical_frame"), name)  # z looks ahead, x right, y down
        np.testing.assert_allclose(optical.rotation, [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], rtol=0, atol=1e-15)
        np.testing.assert_array_equal(optical.translation, np.zeros(3))


@pytest.mark.parametrize("robot", NAO)
def test_sensor_frames(robot):
    """Public nao.urdf of V50, in the parent named."""
    expected = {
        ("ImuTorsoAccelerometer_frame", "torso"): (-0.008, 0.00606, 0.027),
        ("ImuTorsoGyrometer_frame", "torso"): (-0.008, 0.006, 0.029),
        ("LSonar_frame", "torso"): (0.00558253, 0.0192068, 0.0623853),
        ("RSonar_frame", "torso"): (0.00558253, -0.0192068, 0.0623853),
        ("LFsrFL_frame", "l_sole"): (0.07025, 0.0299, 0),
        ("LFsrFR_frame", "l_sole"): (0.07025, -0.0231, 0),
        ("LFsrRL_frame", "l_sole"): (-0.03025, 0.0299, 0),
        ("LFsrRR_frame", "l_sole"): (-0.02965, -0.0191, 0),
        ("RFsrFL_frame", "r_sole"): (0.07025, 0.0231, 0),
        ("RFsrFR_frame", "r_sole"): (0.07025, -0.0299, 0),
        ("RFsrRL_frame", "r_sole"): (-0.03025, 0.0191, 0),
        ("RFsrRR_frame", "r_sole"): (-0.02965, -0.0299, 0),
    }
    for (name, parent), position in expected.items():
        np.testing.assert_allclose(
            placement(robot, name, parent).translation, position, rtol=0, atol=1e-15, err_msg=name
        )
    sonar = placement(robot, "LSonar_frame", "torso").rotation
    np.testing.assert_allclose(sonar, pin.rpy.rpyToMatrix(-0.00478508, 0.0436497, 0.392441), rtol=0, atol=1e-15)


@pytest.mark.parametrize("robot", NAO_H25)
def test_the_gripper_turns_with_the_hand_and_the_effector_does_not(robot):
    opened = {"LHand": 1.0}
    np.testing.assert_array_equal(placement(robot, "LArm", "l_wrist", opened).rotation, np.eye(3))
    turned = pin.rpy.rpyToMatrix(1.0, 0.0, 0.0)
    np.testing.assert_allclose(placement(robot, "l_gripper", "l_wrist", opened).rotation, turned, rtol=0, atol=1e-15)


@pytest.mark.parametrize("robot", NAO)
def test_the_visuals_stand_573_mm_tall_on_the_published_foot(robot):
    """573 mm: Aldebaran's data sheet. Foot outline, left: 100 and 50, 50.02 and 38.77 mm (B-Human's configuration)."""
    corners = visual_corners(robot)
    highest, lowest = corners["Head"][:, 2].max(), corners["l_ankle"][:, 2].min()
    assert highest - lowest == pytest.approx(0.573, abs=0.003)
    foot = corners["l_ankle"] - placement(robot, "l_sole", "torso").translation
    np.testing.assert_allclose(foot.min(axis=0)[:2], (-0.05, -0.03877), atol=2e-4)
    np.testing.assert_allclose(foot.max(axis=0)[:2], (0.1, 0.05002), atol=2e-4)
    head = corners["Head"]
    assert 0.12 <= np.ptp(head[:, 1]) <= 0.14
    for left, right in (("LBicep", "RBicep"), ("LTibia", "RTibia"), ("l_ankle", "r_ankle")):
        np.testing.assert_allclose(corners[left].max(axis=0)[1], -corners[right].min(axis=0)[1], atol=1e-9)


def visual_corners(robot: str) -> dict[str, np.ndarray]:
    """Extreme points of each link's visuals along the torso's axes, at zero."""
    points: dict[str, list[np.ndarray]] = {}
    for name, link in links(robot).items():
        for visual in link.findall("visual"):
            pose = placement(robot, name, "torso") * origin(visual)
            half = half_extent(visual.find("geometry")[0], pose.rotation)
            points.setdefault(name, []).extend((pose.translation - half, pose.translation + half))
    return {name: np.array(rows) for name, rows in points.items()}


def origin(element: etree._Element) -> pin.SE3:
    found = element.find("origin")
    if found is None:
        return pin.SE3.Identity()
    return pin.SE3(pin.rpy.rpyToMatrix(*floats(found.attrib["rpy"])), np.array(floats(found.attrib["xyz"])))


def half_extent(shape: etree._Element, rotation: np.ndarray) -> np.ndarray:
    if shape.tag == "sphere":
        return np.full(3, float(shape.attrib["radius"]))
    if shape.tag == "box":
        return np.abs(rotation) @ floats(shape.attrib["size"]) / 2
    along = rotation[:, 2]
    across = np.sqrt(np.clip(1 - along**2, 0, None))
    return np.abs(along) * float(shape.attrib["length"]) / 2 + across * float(shape.attrib["radius"])


# --- JACO2 ----------------------------------------------------------------------------------------------------------


def arm_pose(degrees: tuple[float, ...]) -> pin.SE3:
    posture = {f"joint_{k}": math.radians(angle) for k, angle in enumerate(degrees, start=1)}
    return placement("jaco2", "end_effector", "link_base", posture)


@pytest.mark.parametrize(
    ("degrees", "position", "tolerance"),
    [
        ((180, 270, 90, 180, 180, 0), (0.410000, 0.259456, 0.084059), 1e-6),
        ((180,) * 6, (0.0, 0.259456, 0.876941), 1e-6),
        # "Home" and "Retract" of kinova_moveit's j2n6s300 SRDF; the angles are printed to 1e-3 degrees
        ((275.288, 167.580, 57.410, 240.825, 82.838, 75.820), (0.212743, -0.256609, 0.506962), 2e-5),
        ((-89.780, 150.052, 26.860, -92.178, 5.180, 99.752), (0.027817, -0.169251, 0.298066), 2e-5),
    ],
)
def test_jaco2_check_poses(degrees, position, tolerance):
    np.testing.assert_allclose(arm_pose(degrees).translation, position, rtol=0, atol=tolerance)


def test_jaco2_orientation_of_the_practicum_check():
    expected = [[0, 1, 0], [-0.5, 0, math.sqrt(0.75)], [math.sqrt(0.75), 0, 0.5]]
    np.testing.assert_allclose(arm_pose((180, 270, 90, 180, 180, 0)).rotation, expected, rtol=0, atol=1e-12)


def test_jaco2_is_the_table_of_j2n6s300():
    half, third = math.pi / 2, math.pi / 3
    expected = {  # j2n6s300.xacro of kinova-ros: type, xyz, rpy, range [deg], speed [deg/s], effort
        "joint_1": ("continuous", [0, 0, 0.15675], [0, math.pi, 0], None, 36, 40),
        "joint_2": ("revolute", [0, 0.0016, -0.11875], [-half, 0, math.pi], (47, 313), 36, 80),
        "joint_3": ("revolute", [0, -0.41, 0], [0, math.pi, 0], (19, 341), 36, 40),
        "joint_4": ("continuous", [0, 0.2073, -0.0114], [-half, 0, math.pi], None, 48, 20),
        "joint_5": ("continuous", [0, -0.03703, -0.06414], [third, 0, math.pi], None, 48, 20),
        "joint_6": ("continuous", [0, -0.03703, -0.06414], [third, 0, math.pi], None, 48, 20),
    }
    for name, (kind, xyz, rpy, span, speed, effort) in expected.items():
        joint, given = joints("jaco2")[name], limit("jaco2", name)
        assert joint.attrib["type"] == kind
        assert floats(joint.find("origin").attrib["xyz"]) == xyz
        assert floats(joint.find("origin").attrib["rpy"]) == rpy
        assert floats(joint.find("axis").attrib["xyz"]) == [0, 0, 1]
        assert given["velocity"] == pytest.approx(math.radians(speed), rel=1e-15)
        assert given["effort"] == effort
        if span is None:
            assert set(given) == {"velocity", "effort"}
        else:
            assert (given["lower"], given["upper"]) == pytest.approx([math.radians(a) for a in span], rel=1e-15)
    tool = joints("jaco2")["joint_end_effector"]
    assert floats(tool.find("origin").attrib["xyz"]) == [0, 0, -0.16]
    assert floats(tool.find("origin").attrib["rpy"]) == [math.pi, 0, half]


# --- PhantomX -------------------------------------------------------------------------------------------------------

# HumaRobotics phantomx_urdf.xacro: coxa joint in the body and heading of the leg at zero [deg from +x].
COXAS = {
    "rf": (0.1248, -0.06164, -45),
    "rm": (0.0, -0.1034, -90),
    "rr": (-0.1248, -0.06164, -135),
    "lf": (0.1248, 0.06164, 45),
    "lm": (0.0, 0.1034, 90),
    "lr": (-0.1248, 0.06164, 135),
}


def point_of(leg: str, outward: float, down: float) -> np.ndarray:
    x, y, heading = COXAS[leg]
    ahead = math.radians(heading)
    return np.array([x + outward * math.cos(ahead), y + outward * math.sin(ahead), 0.001116 - down])


@pytest.mark.parametrize("leg", LEGS)
def test_phantomx_leg_at_zero(leg):
    """Coxa 54 mm, femur 64.5 outward and 14.5 down (HumaRobotics), tibia 133 mm at 34 degrees (KevinOchs, 48 - 14)."""
    lean = math.radians(34)
    for name, outward, down in (
        (f"c1_{leg}", 0, 0),
        (f"thigh_{leg}", 0.054, 0),
        (f"tibia_{leg}", 0.1185, 0.0145),
        (f"foot_{leg}", 0.1185 + 0.133 * math.sin(lean), 0.0145 + 0.133 * math.cos(lean)),
    ):
        pose = placement("phantomx", name, "base_link")
        np.testing.assert_allclose(pose.translation, point_of(leg, outward, down), rtol=0, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("leg", LEGS)
def test_phantomx_axes_and_limits(leg):
    """Coxa about the body's z; tibia axis opposite to the femur's; a positive thigh angle lowers the knee."""
    for joint in ("c1", "thigh", "tibia"):
        given = limit("phantomx", f"j_{joint}_{leg}")
        assert given == {"lower": -2.6179939, "upper": 2.6179939, "velocity": 5.6548668, "effort": 2.8}
        assert floats(joints("phantomx")[f"j_{joint}_{leg}"].find("axis").attrib["xyz"]) == [1, 0, 0]
    coxa, thigh, tibia = (
        placement("phantomx", f"{part}_{leg}", "base_link").rotation[:, 0] for part in ("c1", "thigh", "tibia")
    )
    np.testing.assert_allclose(coxa, (0, 0, 1), rtol=0, atol=1e-15)
    np.testing.assert_allclose(tibia, -thigh, rtol=0, atol=1e-15)
    assert thigh[2] == pytest.approx(0, abs=1e-15)
    assert thigh @ (point_of(leg, 1, 0) - point_of(leg, 0, 0)) == pytest.approx(0, abs=1e-15)
    knee = [placement("phantomx", f"tibia_{leg}", "base_link", {f"j_thigh_{leg}": q}).translation[2] for q in (0, 0.1)]
    foot = [placement("phantomx", f"foot_{leg}", "base_link", {f"j_tibia_{leg}": q}).translation[2] for q in (0, 0.1)]
    assert knee[1] < knee[0]
    assert foot[1] > foot[0]


def test_phantomx_angles_are_exact_multiples_of_a_quarter_turn():
    for joint in joints("phantomx").values():
        eighths = [angle / (math.pi / 4) for angle in floats(joint.find("origin").attrib["rpy"])]
        assert eighths == [round(value) for value in eighths]


def test_phantomx_reaches_its_published_start_position_within_the_limits():
    """KevinOchs phantomX.yaml: middle foot 0.141 m from the coxa axis, body 0.09 m above the ground."""
    femur, tibia, outward, down = math.hypot(0.0645, 0.0145), 0.133, 0.141 - 0.054, 0.09 + 0.001116
    reach = math.hypot(outward, down)
    slope = math.atan2(down, outward) - math.acos((femur**2 + reach**2 - tibia**2) / (2 * femur * reach))
    knee = np.array([femur * math.cos(slope), femur * math.sin(slope)])  # outward, down
    shin = math.atan2(outward - knee[0], down - knee[1])  # from straight down, outward positive
    thigh = slope - math.atan2(0.0145, 0.0645)
    posture = {"j_thigh_lm": thigh, "j_tibia_lm": shin - math.radians(34) + thigh}
    foot = placement("phantomx", "foot_lm", "base_link", posture).translation
    np.testing.assert_allclose(foot, (0, 0.1034 + 0.141, -0.09), rtol=0, atol=1e-12)
    assert max(abs(angle) for angle in posture.values()) < math.radians(100)
