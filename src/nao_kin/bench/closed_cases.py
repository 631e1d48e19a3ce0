"""What `nao-kin bench closed` asks: chains with a closed form, goals they reach, and goals where formulas stumble."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import GoalKind
from nao_kin.analytic.forms import FORMS
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.nao import nao_arm, nao_head
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.target import Target

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.analytic.solution_batch import BatchSolutions
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["Case", "cases", "found_by", "strata", "unreachable"]

_CHAINS: Final = (
    ("nao", "torso", "CameraTop_frame"),
    ("nao", "torso", "CameraBottom_frame"),
    ("nao", "torso", "LArm"),
    ("nao", "torso", "RArm"),
    ("nao_v32_h25", "torso", "LArm"),
    ("nao_v50_h21", "torso", "LArm"),
    ("nao_v50_h21", "torso", "RArm"),
    ("nao", "torso", "LLeg"),
    ("nao", "torso", "RLeg"),
    ("phantomx", "base_link", "foot_lf"),
)
_FREE: Final = {"x": 0.0, "y": 0.0, "z": 0.0}
_NEAR: Final = tuple(10.0**-k for k in range(3, 13))
_BEYOND: Final = 3e-6  # [m]: three times what counts as reached


@dataclass(frozen=True, eq=False)
class Case:
    """Goals of one kind for one chain.

    Attributes:
        chain: The chain.
        found: Its closed form.
        Q: Joints (N, n) that the goals were made of [rad].
        goals: The goals (N, 4, 4), see `nao_kin.ik.target.Target`.
    """

    chain: UrdfChain
    found: Matched
    Q: Floats
    goals: Floats

    @property
    def given(self) -> tuple[int, ...]:
        """Columns of the joints that are given with a goal."""
        return tuple(self.found.columns[i] for i in self.found.request.given)

    @property
    def locked(self) -> Floats:
        """Values of the joints that are given (N, n), NaN for the others."""
        locked = np.full(self.Q.shape, np.nan)
        locked[:, self.given] = self.Q[:, self.given]
        return locked

    @property
    def name(self) -> str:
        """Robot and tip."""
        return f"{self.chain.robot.name} {self.chain.tip}"


def cases(count: int, rng: np.random.Generator) -> Iterator[Case]:
    """Every kind of goal that a closed form of a bundled robot takes, at random joints within the limits."""
    from nao_kin.robot.robot import load

    kinds = list(dict.fromkeys(kind for form in FORMS for kind in form.requests))
    for robot, base, tip in _CHAINS:
        chain = load(robot).chain(base, tip)
        Q = random_configurations(chain, count, rng)
        for kind in kinds:
            if (found := _form_of(chain, kind)) is not None:
                yield Case(chain, found, Q, _goals(kind, chain.poses(Q), rng))


def found_by(case: Case) -> BatchSolutions:
    """What the package answers."""
    from nao_kin.analytic.solution_batch import solve_all_batch

    names = case.chain.joint_names
    targets = [_target(case.found.kind, goal) for goal in case.goals]
    return solve_all_batch(case.chain, targets, locked={names[i]: case.Q[:, i] for i in case.given})


def strata(case: Case, count: int, rng: np.random.Generator) -> Iterator[tuple[str, Case]]:
    """The same kind of goals at joint limits, at and near singularities, at the border; by Pinocchio's kinematics."""
    ends = np.array([case.chain.lower, case.chain.upper])
    Q = random_configurations(case.chain, count, rng)
    at_ends = rng.integers(0, 3, Q.shape)
    yield "joints at limits", _again(case, np.where(at_ends < 2, np.where(at_ends == 0, *ends), Q), rng)
    singular = _singular(case)
    for what, values in singular.items():
        exact = Q.copy()
        exact[:, list(values)] = list(values.values())
        yield f"{what}, exactly", _again(case, exact, rng)
        near = exact.copy()
        near[:, list(values)] += rng.choice(_NEAR, (count, 1)) * rng.choice((-1.0, 1.0), (count, len(values)))
        yield f"{what}, off by 1e-3 to 1e-12", _again(case, near, rng)
    if case.found.kind == "position" and case.found.form.name.startswith("nao_arm"):
        yield "border of the reach", _again(case, _stretched(case, Q), rng)
    if case.found.kind == "pointing":
        yield "line through the shoulder, exactly", _through_shoulder(case, Q, np.zeros((count, 3)))
        off = rng.choice(_NEAR, (count, 1)) * rng.normal(size=(count, 3))
        yield "line through the shoulder, off by 1e-3 to 1e-12", _through_shoulder(case, Q, off)


def unreachable(case: Case, count: int, rng: np.random.Generator) -> Case | None:
    """Goals of an arm that miss what it reaches by three micrometres, or None of another chain."""
    if not case.found.form.name.startswith("nao_arm") or case.found.kind == "pointing":
        return None
    numbers, Q = case.found.geometry.parameters, random_configurations(case.chain, count, rng)
    Q = _stretched(case, Q) if case.found.kind == "position" else Q
    missed = _again(case, Q, rng)
    from_shoulder = missed.goals[:, :3, 3] - numbers[nao_arm.SHOULDER : nao_arm.LENGTH]
    if case.found.kind == "pose":  # the elbow point is moved away from the shoulder, which its upper arm forbids
        T = missed.goals[:, :3, :3] @ numbers[nao_arm.HAND : nao_arm.TIP].reshape(3, 3).T
        from_shoulder -= np.einsum("nij,j->ni", T, numbers[nao_arm.TIP : nao_arm.TIP + 3])
    outwards = from_shoulder / np.linalg.norm(from_shoulder, axis=1, keepdims=True)
    missed.goals[:, :3, 3] += _BEYOND * outwards
    return missed


def _form_of(chain: UrdfChain, kind: GoalKind) -> Matched | None:
    """The chain's own closed form for a kind of goal, with what it leaves free given; None if there is none."""
    for form in (form for form in FORMS if form.joints == len(chain.joints) and kind in form.requests):
        given = {chain.joint_names[i]: 0.0 for i in form.requests[kind].given}
        try:
            return matched(chain, _target(kind, np.eye(4) if kind in ("pose", "orientation") else _AHEAD), given)
        except InvalidInputError:
            continue
    return None


_AHEAD: Final = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def _target(kind: GoalKind, goal: Floats) -> Target:
    if kind == "direction":
        return Target.pointing(goal[:3, 3], goal[:3, 1], goal[:3, 0], weights=_FREE)
    return Target(kind, np.ascontiguousarray(goal))


def _goals(kind: GoalKind, tips: Floats, rng: np.random.Generator) -> Floats:
    """Goals that these tips reach; a pointing axis is a random one of the tip."""
    goals = tips.copy()
    if kind in ("pointing", "direction"):
        axes = rng.normal(size=(len(tips), 3))
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        goals[:, :3, 0], goals[:, :3, 2] = axes, 0.0
        goals[:, :3, 1] = np.einsum("nij,nj->ni", tips[:, :3, :3], axes)
    return goals


def _again(case: Case, Q: Floats, rng: np.random.Generator) -> Case:
    tips = np.array([case.chain.pose(q).homogeneous for q in Q])
    return Case(case.chain, case.found, Q, _goals(case.found.kind, tips, rng))


def _through_shoulder(case: Case, Q: Floats, off: Floats) -> Case:
    """Pointing goals whose line passes the shoulder at about some distance (N, 3) [m]: the arm may turn about it."""
    numbers, goals = case.found.geometry.parameters, np.array([case.chain.pose(q).homogeneous for q in Q])
    lines = goals[:, :3, 3] - numbers[nao_arm.SHOULDER : nao_arm.LENGTH] + off
    lines /= np.linalg.norm(lines, axis=1, keepdims=True)
    axes = np.einsum("nji,nj->ni", goals[:, :3, :3], lines)
    goals[:, :3, 0], goals[:, :3, 1], goals[:, :3, 2] = axes, lines, 0.0
    return Case(case.chain, case.found, Q, goals)


def _singular(case: Case) -> dict[str, dict[int, float]]:
    """Joint values at which a form is singular, by column."""
    numbers = case.found.geometry.parameters
    if case.found.form.name == "nao_head":
        t = numbers[nao_head.TIP :]
        return {"camera above the neck": {1: math.atan2(-t[0], t[2])}}
    if case.found.form.name.startswith("nao_arm"):
        bend = math.atan2(numbers[nao_arm.OFFSET], numbers[nao_arm.LENGTH])
        shifts = numbers[nao_arm.SHIFTS :]
        elbow, shoulder = {3: -shifts[3]}, {1: 0.5 * math.pi - bend - shifts[1]}
        return {"elbow straight": elbow, "elbow on the pitch axis": shoulder, "both": elbow | shoulder}
    return {}


def _stretched(case: Case, Q: Floats) -> Floats:
    """The same joints with the elbow roll at which the tip is farthest from the shoulder."""
    p, stretched = case.found.geometry.parameters, Q.copy()
    L, o, (x, y, z) = p[nao_arm.LENGTH], p[nao_arm.OFFSET], p[nao_arm.TIP : nao_arm.TIP + 3]
    turn = Q[:, 4] if Q.shape[1] == 5 else np.zeros(len(Q))
    beside, yaw = np.cos(turn) * y - np.sin(turn) * z, np.cos(Q[:, 2] + p[nao_arm.SHIFTS + 2])
    stretched[:, 3] = np.arctan2(o * yaw * x - L * beside, L * x + o * yaw * beside) - p[nao_arm.SHIFTS + 3]
    return stretched
