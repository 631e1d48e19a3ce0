"""Four ways to the same pose: the chain's own model, Pinocchio on the whole robot, DH products, yourdfpy."""

from __future__ import annotations

import dataclasses
import io
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from tests.conftest import BUNDLED, EXAMPLES, needs_examples, robot

from nao_kin.chain import finite_difference_jacobian, random_configurations
from nao_kin.documents import kofinas
from nao_kin.documents.chains import DOCUMENT_CHAINS

EXTRA_PATHS = {
    "nao_v50_h25": [("l_sole", "r_gripper"), ("l_sole", "r_sole"), ("r_sole", "CameraTop_frame"), ("LArm", "RArm")],
    "nao_v33_h21": [("l_sole", "r_gripper")],
    "jaco2": [("end_effector", "link_base"), ("link_3", "link_6")],
    "phantomx": [("foot_lf", "foot_rr")],
}


def chains_of(name: str) -> list:
    model = robot(name)
    return [model.chain(c) for c in model.chain_frames] + [model.chain(*p) for p in EXTRA_PATHS.get(name, [])]


@cache
def file_model(name: str) -> pin.Model:
    """Pinocchio's model of the file itself, not of our reading of it."""
    return pin.buildModelFromXML(Path(robot(name).document.path).read_text(encoding="utf-8"))


def file_pose(name: str, posture: dict[str, float], base: str, tip: str) -> np.ndarray:
    """T_base_tip by Pinocchio on the whole robot."""
    full = file_model(name)
    data, q = full.createData(), pin.neutral(full)
    for joint_name, value in robot(name).expand(posture).items():
        joint = full.joints[full.getJointId(joint_name)]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            q[joint.idx_q] = value
    pin.framesForwardKinematics(full, data, q)
    base_id, tip_id = (full.getFrameId(frame, pin.FrameType.BODY) for frame in (base, tip))
    return data.oMf[base_id].actInv(data.oMf[tip_id]).homogeneous


@pytest.mark.parametrize("name", [*BUNDLED, *EXAMPLES])
def test_chain_equals_pinocchio_on_the_file_itself(name: str, rng: np.random.Generator) -> None:
    if name in EXAMPLES:
        needs_examples()
    for chain in chains_of(name):
        for q in random_configurations(chain, 1000, rng):
            expected = file_pose(name, dict(zip(chain.joint_names, q, strict=True)), chain.base, chain.tip)
            np.testing.assert_allclose(chain.pose(q).homogeneous, expected, atol=1e-12, rtol=0)


@pytest.mark.parametrize("name", [*BUNDLED, *EXAMPLES])
def test_chain_equals_yourdfpy(name: str, rng: np.random.Generator) -> None:
    if name in EXAMPLES:
        needs_examples()
    model, chains = robot(name), chains_of(name)
    file = io.BytesIO(Path(model.document.path).read_bytes())
    other = yourdfpy.URDF.load(file, load_meshes=False, build_collision_scene_graph=False)
    for _ in range(1000 if chains else 0):
        values = dict(zip(other.actuated_joint_names, rng.uniform(-3, 3, len(other.actuated_joint_names)), strict=True))
        other.update_cfg(values)
        full = model.expand(values)
        for chain in chains:
            expected = other.get_transform(chain.tip, chain.base)
            found = chain.pose([full[joint] for joint in chain.joint_names]).homogeneous
            np.testing.assert_allclose(found, expected, atol=1e-12, rtol=0)


def test_a_posture_places_every_link_as_the_chains_do(rng: np.random.Generator) -> None:
    for name in BUNDLED:
        model = robot(name)
        for chain in chains_of(name):
            q = random_configurations(chain, 1, rng)[0]
            poses = model.link_poses(dict(zip(chain.joint_names, q, strict=True)))
            expected = poses[chain.base].actInv(poses[chain.tip]).homogeneous
            np.testing.assert_allclose(chain.pose(q).homogeneous, expected, atol=1e-12, rtol=0)


@pytest.mark.parametrize("name", [n for n in DOCUMENT_CHAINS if n.startswith("kofinas")])
@pytest.mark.parametrize("version", ["v33", "v40", "v50", "v60"])
def test_kofinas_tables_equal_the_nao_models(name: str, version: str, rng: np.random.Generator) -> None:
    document = DOCUMENT_CHAINS[name]
    table = document.build()
    chain = robot(document.robot.replace("v33", version)).chain(document.base, document.tip)
    for q in random_configurations(chain, 1000, rng):
        np.testing.assert_allclose(table.pose(q).homogeneous, chain.pose(q).homogeneous, atol=1e-12, rtol=0)
        np.testing.assert_allclose(table.jacobian(q), chain.jacobian(q), atol=1e-12, rtol=0)


@pytest.mark.parametrize(("side", "sole"), [("left", "l_sole"), ("right", "r_sole")])
def test_kofinas_legs_end_at_the_soles_with_the_public_foot_height(side, sole, rng: np.random.Generator) -> None:
    table = kofinas.leg(side, dataclasses.replace(kofinas.V33_LENGTHS, foot_height=0.04511))
    chain = robot("nao_v33_h25").chain("torso", sole)
    for q in random_configurations(chain, 200, rng):
        np.testing.assert_allclose(table.pose(q).homogeneous, chain.pose(q).homogeneous, atol=1e-12, rtol=0)


@pytest.mark.parametrize("name", [*BUNDLED, *EXAMPLES])
def test_jacobian_equals_finite_differences(name: str, rng: np.random.Generator) -> None:
    if name in EXAMPLES:
        needs_examples()
    for chain in chains_of(name):
        for q in random_configurations(chain, 20, rng):
            np.testing.assert_allclose(chain.jacobian(q), finite_difference_jacobian(chain, q), atol=1e-7, rtol=0)


@pytest.mark.parametrize("name", DOCUMENT_CHAINS)
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_table_jacobian_equals_finite_differences(name: str, convention, rng: np.random.Generator) -> None:
    table = DOCUMENT_CHAINS[name].build().read_as(convention)
    for q in rng.uniform(-3.0, 3.0, (20, len(table.rows))):
        np.testing.assert_allclose(table.jacobian(q), finite_difference_jacobian(table, q), atol=1e-7, rtol=0)


def test_tip_jacobian_is_the_base_jacobian_in_tip_axes(rng: np.random.Generator) -> None:
    for chain in (robot("nao_v50_h25").chain("l_sole", "r_gripper"), DOCUMENT_CHAINS["thesis_left_arm"].build()):
        for q in rng.uniform(-1.0, 1.0, (50, len(chain.joints))):
            R = chain.pose(q).rotation
            J = chain.jacobian(q)
            turned = np.concatenate([R.T @ J[:3], R.T @ J[3:]])
            np.testing.assert_allclose(chain.jacobian(q, frame="tip"), turned, atol=1e-13)


def test_poses_compose_and_invert(rng: np.random.Generator) -> None:
    """T_a_c = T_a_b T_b_c through a frame in the middle, and T_b_a = T_a_b⁻¹."""
    model = robot("nao_v50_h25")
    names = model.joint_names
    for _ in range(50):
        posture = dict(zip(names, rng.uniform(-1.0, 1.0, len(names)), strict=True)) | {"RHipYawPitch": 0.3}
        posture["LHipYawPitch"] = 0.3
        T_a_b = model.pose(posture, "LForeArm", base="l_sole")
        T_b_c = model.pose(posture, "CameraBottom_frame", base="LForeArm")
        T_a_c = model.pose(posture, "CameraBottom_frame", base="l_sole")
        np.testing.assert_allclose((T_a_b * T_b_c).homogeneous, T_a_c.homogeneous, atol=1e-14)
        back = model.pose(posture, "l_sole", base="LForeArm")
        np.testing.assert_allclose((T_a_b * back).homogeneous, np.eye(4), atol=1e-14)


def test_the_right_arm_is_the_mirrored_left_arm(rng: np.random.Generator) -> None:
    """Mirroring at the x-z plane keeps pitch angles and turns roll and yaw angles round."""
    model = robot("nao_v50_h25")
    left, right = model.chain("left_arm"), model.chain("right_arm")
    flip = np.diag([1.0, -1.0, 1.0])
    signs = np.array([1.0 if "Pitch" in name else -1.0 for name in left.joint_names])
    for q in random_configurations(left, 200, rng):
        T_left, T_right = left.pose(q), right.pose(signs * q)
        np.testing.assert_allclose(T_right.translation, flip @ T_left.translation, atol=1e-15)
        np.testing.assert_allclose(T_right.rotation, flip @ T_left.rotation @ flip, atol=1e-15)
