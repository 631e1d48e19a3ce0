"""Planted numbers come back, what the rows cannot tell is counted and named, and derivatives are differences."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import least_squares

import nao_kin as nk
from nao_kin.calibration.chain_model import Model, model_of
from nao_kin.calibration.parameters import chosen, nominal_values
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from nao_kin.robot.urdf_chain import UrdfChain

CHAINS = [
    ("nao", "left_arm"),
    ("nao", "right_arm"),
    ("nao", "left_leg"),
    ("nao", "head"),
    ("jaco2", "arm"),
    ("ur5", "arm"),
    ("panda", "arm"),
    ("phantomx", "leg_lf"),
]


def chain_named(robot: str, name: str) -> UrdfChain:
    return nk.load(robot).chain(name)


def planted(model: Model, words: str, rng: np.random.Generator, size: float) -> dict[tuple[str, str], float]:
    values = nominal_values([model])
    return values | {name: values[name] + rng.normal(scale=size) for name in chosen(words, [model])}


@pytest.mark.parametrize(("robot", "name"), [*CHAINS, ("nao", "whole")])
def test_the_model_is_the_chain_and_its_derivatives_are_differences(robot: str, name: str) -> None:
    chain = nk.load("nao").chain("l_sole", "r_gripper") if name == "whole" else chain_named(robot, name)
    model, rng = model_of(chain), np.random.default_rng(1)
    Q = random_configurations(chain, 20, rng)
    assert np.abs(model.poses(nominal_values([model]), Q) - chain.poses(Q)).max() < 1e-12
    values = {key: value + rng.normal(scale=0.05) for key, value in nominal_values([model]).items()}
    T, twists = model.derivatives(values, Q, model.names)
    for k, key in enumerate(model.names):
        ahead, behind = (model.poses(values | {key: values[key] + h}, Q) for h in (1e-6, -1e-6))
        moved = (ahead - behind) / 2e-6
        W = moved[:, :3, :3] @ np.swapaxes(T[:, :3, :3], 1, 2)
        turned = np.stack([W[:, 2, 1], W[:, 0, 2], W[:, 1, 0]], axis=1)
        assert np.abs(np.hstack([moved[:, :3, 3], turned]) - twists[:, :, k]).max() < 1e-7


@pytest.mark.parametrize("words", ["offsets", "geometry"])
@pytest.mark.parametrize(("robot", "name"), CHAINS)
def test_planted_numbers_come_back_from_poses(robot: str, name: str, words: str) -> None:
    chain, rng = chain_named(robot, name), np.random.default_rng(2)
    model, Q = model_of(chain), random_configurations(chain, 60, rng)
    truth = planted(model, words, rng, 3e-3)
    found = nk.calibrate(chain, nk.Measurements.poses(Q, model.poses(truth, Q)), words, robust=False)
    assert found.unidentifiable == ()  # poses in the base frame tell four numbers a line and the tool's six
    assert max(abs(found.fit.values[key] - truth[key]) for key in truth) < 1e-8
    assert np.abs(found.fit.residuals).max() * 1e-3 < 1e-10


@pytest.mark.parametrize(("robot", "name"), CHAINS[2:])
def test_what_positions_cannot_tell_is_counted_and_named(robot: str, name: str) -> None:
    """A point says nothing of the turn of the tool, nor of a zero that only moves the tool's own number."""
    chain, rng = chain_named(robot, name), np.random.default_rng(3)
    model, Q = model_of(chain), random_configurations(chain, 80, rng)
    places = model.poses(nominal_values([model]), Q)[:, :3, 3]
    found = nk.calibrate(chain, nk.Measurements.positions(Q, places), "geometry", robust=False)
    J = found.fit.system.jacobian(found.fit.u)
    rank = np.linalg.matrix_rank(J / np.maximum(np.linalg.norm(J, axis=0), 1e-300), tol=1e-8)
    assert len(found.unidentifiable) == J.shape[1] - rank
    assert any("the tool" in sentence for sentence in found.unidentifiable)
    assert {e.verdict for e in found.estimates if e.name == ("tool", "rx")} == {"not seen"}
    assert max(abs(e.value) for e in found.estimates) < 1e-9  # and what is not told stays where it was


def test_the_calibrated_file_moves_as_measured_and_keeps_the_rest(tmp_path: Path) -> None:
    source = Path(nk.load("ur5").document.path).read_text(encoding="utf-8")
    path = tmp_path / "mine.urdf"
    path.write_text(source.replace("<robot", "<!-- measured in May -->\n<robot", 1), encoding="utf-8")
    chain, rng = nk.load(path).chain("base_link", "tool0"), np.random.default_rng(4)
    model, Q = model_of(chain), random_configurations(chain, 60, rng)
    words = [name for name in chain.joint_names if name != "elbow_joint"]
    numbers = [f"{name}.{number}" for name in words for number in ("x", "y", "rx", "ry", "zero")]
    values = nominal_values([model])
    truth = values | {key: rng.normal(scale=2e-3) for key in chosen(numbers, [model]) if key[1] in ("x", "ry", "zero")}
    found = nk.calibrate(chain, nk.Measurements.poses(Q, model.poses(truth, Q)), numbers, robust=False)
    text = found.to_urdf()
    assert "<!-- measured in May -->" in text
    kept = [a == b for a, b in zip(text.splitlines(), path.read_text(encoding="utf-8").splitlines(), strict=True)]
    assert 0 < kept.count(False) <= len(words)
    oracle = pin.buildModelFromXML(text)
    data, frame = oracle.createData(), oracle.getFrameId("tool0")
    order = [oracle.joints[oracle.getJointId(name)].idx_q for name in chain.joint_names]
    for q, T in zip(Q, model.poses(truth, Q), strict=True):
        full = pin.neutral(oracle)
        full[order] = q
        pin.framesForwardKinematics(oracle, data, full)
        base = data.oMf[oracle.getFrameId("base_link")]
        assert np.abs(base.actInv(data.oMf[frame]).homogeneous - T).max() < 1e-9
    assert np.abs(found.chain.poses(Q) - model.poses(truth, Q)).max() < 1e-9
    assert np.abs(found.table.poses(Q) - model.poses(truth, Q)).max() < 1e-9


def test_a_plain_least_squares_finds_the_same() -> None:
    """The zeros of an arm from noisy points, by scipy alone on Pinocchio's forward kinematics."""
    chain, rng = chain_named("nao", "left_arm"), np.random.default_rng(5)
    Q, zeros = random_configurations(chain, 50, rng), rng.normal(scale=0.03, size=5)
    places = np.array([chain.pose(q + zeros).translation for q in Q]) + rng.normal(scale=1e-3, size=(50, 3))

    def residuals(x: np.ndarray) -> np.ndarray:
        return np.concatenate([places[k] - chain.pose(q + x).translation for k, q in enumerate(Q)])

    words = [f"{name}.zero" for name in chain.joint_names[:4]]  # all but the last, which both leave where it is
    plain = least_squares(lambda x: residuals(np.append(x, 0.0)), np.zeros(4), xtol=1e-14, ftol=1e-14).x
    found = nk.calibrate(chain, nk.Measurements.positions(Q, places), words, robust=False)
    assert [e.value for e in found.estimates] == pytest.approx(plain, abs=1e-6)
    assert found.noise == pytest.approx(1.0, abs=0.2)


def test_a_ball_in_two_sockets_tells_the_arm() -> None:
    chain, rng = chain_named("panda", "arm"), np.random.default_rng(6)
    model = model_of(chain)
    truth = planted(model, "offsets", rng, 0.01)
    targets = [np.array([0.4, 0.1, 0.3]), np.array([0.4, 0.15, 0.3])]
    groups = []
    for target in targets:
        rows = []
        while len(rows) < 25:
            result = nk.solve(chain, target, random_configurations(chain, 1, rng)[0])
            if result.solved:
                q = result.q.copy()
                for _ in range(8):  # the joints of the true arm whose tip is there
                    T, twists = model.derivatives(truth, q[None], [(name, "zero") for name in chain.joint_names])
                    q += np.linalg.pinv(twists[0, :3]) @ (target - T[0, :3, 3])
                rows.append(q)
        groups.append(np.array(rows))
    measured = nk.Measurements.same_points(groups, distances={(0, 1): 0.05}, noise=1e-4)
    found = nk.calibrate(chain, measured, "offsets")
    tips = [found.model.poses(found.fit.values, group)[:, :3, 3] for group in groups]
    assert max(np.linalg.norm(tip - tip.mean(axis=0), axis=1).max() for tip in tips) < 1e-7
    for name in chain.joint_names[1:6]:  # the base's turn and the tool's are the socket's own
        assert found.fit.values[name, "zero"] == pytest.approx(truth[name, "zero"], abs=1e-6)
    assert any("panda_joint1" in sentence for sentence in found.unidentifiable)


def test_wrong_input_is_refused_by_name() -> None:
    chain = chain_named("nao", "left_arm")
    Q = random_configurations(chain, 20, np.random.default_rng(7))
    rows = nk.Measurements.positions(Q, chain.poses(Q)[:, :3, 3])
    with pytest.raises(UnknownNameError, match="offsets"):
        nk.calibrate(chain, rows, "ofsets")
    with pytest.raises(InvalidInputError, match="at least one row"):
        nk.calibrate(chain, nk.Measurements())
    with pytest.raises(InvalidInputError, match="LElbowRoll"):
        nk.calibrate(chain, nk.Measurements.positions(Q[:, :4], chain.poses(Q)[:, :3, 3]))
    with pytest.raises(InvalidInputError, match="finite"):
        nk.Measurements.positions(Q, np.full((20, 3), np.nan))
    with pytest.raises(InvalidInputError, match="at least two rows"):
        nk.Measurements.same_points([Q[:1]])
    with pytest.raises(InvalidInputError, match="numbers"):
        nk.calibrate(chain, nk.Measurements.positions(Q[:3], chain.poses(Q[:3])[:, :3, 3]), "geometry")
