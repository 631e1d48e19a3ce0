"""Chains with a closed form, and goals for them, as the tests of the closed forms share them."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

import nao_kin as nk
from tests.conftest import robot

if TYPE_CHECKING:
    from nao_kin.analytic.form import GoalKind
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

FREE = {"x": 0.0, "y": 0.0, "z": 0.0}

ARMS = (
    ("nao", "left_arm"),
    ("nao", "right_arm"),
    ("nao_v33_h25", "left_arm"),
    ("nao_v32_h25", "left_arm"),
    ("nao_v32_h25", "right_arm"),
    ("nao_v50_h21", "left_arm"),
    ("nao_v50_h21", "right_arm"),
)
CAMERAS = (
    ("nao", "CameraTop_frame"),
    ("nao", "CameraBottom_frame"),
    ("nao_v33_h25", "CameraTop_frame"),
    ("nao", "CameraTop_optical_frame"),
)

# What is asked of a chain of so many joints, and the columns that are given with it.
REQUESTS: dict[int, tuple[tuple[GoalKind, tuple[int, ...]], ...]] = {
    2: (("pose", ()), ("orientation", ()), ("position", ()), ("direction", ())),
    4: (("pose", ()), ("position", (2,)), ("pointing", ())),
    5: (("pose", ()), ("position", (2, 4)), ("pointing", ())),
}


@cache
def chain_of(name: str, part: str) -> UrdfChain:
    return robot(name).chain("torso", part) if part.startswith("Camera") else robot(name).chain(part)


def asked() -> list[tuple[str, str, GoalKind]]:
    arms = [(name, part, kind) for name, part in ARMS for kind, _ in REQUESTS[4]]
    return arms + [(name, part, kind) for name, part in CAMERAS for kind, _ in REQUESTS[2]]


def given_of(chain: nk.Chain, kind: GoalKind) -> tuple[int, ...]:
    return dict(REQUESTS[len(chain.joints)])[kind]


def locked_of(chain: nk.Chain, kind: GoalKind, Q: Floats) -> dict[str, Floats]:
    return {chain.joint_names[i]: Q[..., i] for i in given_of(chain, kind)}


def target_of(kind: GoalKind, T: Floats, axis: Floats) -> nk.Target:
    """The target of a kind that a tip at T reaches; an axis of the tip for those that point."""
    if kind == "pose":
        return nk.Target.pose(T)
    if kind == "position":
        return nk.Target.position(T[:3, 3])
    if kind == "orientation":
        return nk.Target.orientation(T[:3, :3])
    weights = FREE if kind == "direction" else None
    return nk.Target.pointing(T[:3, 3], T[:3, :3] @ axis, axis, weights=weights)


def targets_of(chain: nk.Chain, kind: GoalKind, Q: Floats, rng: np.random.Generator) -> list[nk.Target]:
    """Targets from Pinocchio's, or the DH product's, own poses."""
    axes = rng.normal(size=(len(Q), 3))
    return [target_of(kind, chain.pose(q).homogeneous, axis) for q, axis in zip(Q, axes, strict=True)]


def move(a: Floats, b: Floats) -> Floats:
    """Largest joint move from a to b, whole turns left out."""
    return np.asarray(np.abs((a - b + np.pi) % (2.0 * np.pi) - np.pi).max(axis=-1))


def errors(result: nk.IKResult) -> float:
    return max(result.position_error or 0.0, result.rotation_error or 0.0)
