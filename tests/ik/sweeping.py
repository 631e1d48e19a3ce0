"""Chains, targets and the small loop that the tests of the geometric methods share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nao_kin.chain import Chain, into_limits, random_configurations
from nao_kin.ik.aim import SweepGoal
from nao_kin.ik.geometric.ccd import squared_error
from nao_kin.ik.geometric.sweep import CCD, FABRIK, FOLLOW_THE_LEADER, sweep, sweep_memory
from nao_kin.ik.starts import make_starts
from nao_kin.ik.target import KINDS
from nao_kin.kernels import motion
from nao_kin.kernels.joint_limits import packed_rules
from nao_kin.kernels.joint_path import JointPath, PathJoint, joint_path
from nao_kin.kernels.motion import At, packed_joints, place

METHODS = {"ccd": CCD, "ftl": FOLLOW_THE_LEADER, "fabrik": FABRIK}
POSITION = KINDS["position"]


@dataclass
class Arm:
    """A chain as the sweeps take it."""

    joints: np.ndarray
    limits: np.ndarray
    coupled: np.ndarray
    closeness: float = 1.0

    @classmethod
    def of(cls, chain: Chain) -> Arm:
        closeness = make_starts(chain, np.random.default_rng(0)).closeness
        rules = packed_rules(chain.limit_rules, chain.joint_names)
        return cls(packed_joints(chain.joint_path), np.array([chain.lower, chain.upper]), rules, closeness)

    @classmethod
    def along(cls, path: JointPath) -> Arm:
        return cls(packed_joints(path), np.array([path.lower, path.upper]), np.empty((0, 7)))

    @property
    def flat(self) -> motion.Arm:
        return motion.Arm(self.joints, self.limits, self.coupled)

    def placed(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        axes, tip = np.empty((len(self.joints) - 1, 6)), np.empty(12)
        place(self.joints, q, axes, tip)
        return axes, tip

    def swept(self, method: str, goal: np.ndarray, q: np.ndarray, kind: int = POSITION) -> np.ndarray:
        q, memory = q.copy(), np.full(sweep_memory(self.joints), np.nan)  # so that nothing is read before it is written
        axes, tip = self.placed(q)
        sweep(METHODS[method], self.flat, SweepGoal(kind, goal, self.closeness), At(q, axes, tip), memory)
        again = self.placed(q)
        np.testing.assert_array_equal(axes, again[0])
        np.testing.assert_array_equal(tip, again[1])
        return q

    def error(self, goal: np.ndarray, q: np.ndarray, kind: int = POSITION) -> float:
        return squared_error(SweepGoal(kind, goal, self.closeness), self.placed(q)[1])

    def missing(self, goal: np.ndarray, q: np.ndarray) -> float:
        return float(np.linalg.norm(self.placed(q)[1][9:] - goal[:3, 3]))

    def solve(self, method: str, goal: np.ndarray, q: np.ndarray, sweeps: int) -> np.ndarray:
        """Sweeps until the tip is within 1e-6 m of the target, or so many times."""
        for _ in range(sweeps):
            if self.missing(goal, q) < 1e-6:
                break
            q = self.swept(method, goal, q)
        return q


def at(*p: float) -> np.ndarray:
    goal = np.eye(4)
    goal[:3, 3] = p
    return goal


def planar(*links: float, limit: float = np.pi) -> Arm:
    """Joints about z, links along x."""
    z, places = np.array([0.0, 0.0, 1.0]), (0.0, *links[:-1])
    joints = [PathJoint(at(x, 0.0, 0.0), z, False, k) for k, x in enumerate(places)]
    return Arm.along(joint_path(joints, at(links[-1], 0.0, 0.0), [-limit] * len(links), [limit] * len(links)))


def random_hinges(rng: np.random.Generator, n: int) -> JointPath:
    """A chain of turning joints with any axes and offsets, some of them nothing, and any limits."""
    joints = []
    for k in range(n):
        axis = rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)]
        offset = rng.normal(size=3) * rng.choice([0.0, 0.01, 1.0])
        joints.append(PathJoint(at(*offset), axis / np.linalg.norm(axis), False, k, rng.choice([1.0, -1.0, 0.5])))
    lower = np.where(rng.random(n) < 0.2, -np.inf, -3.0 * rng.random(n))
    upper = np.where(rng.random(n) < 0.2, np.inf, 3.0 * rng.random(n))
    return joint_path(joints, at(*rng.normal(size=3)), lower, upper)


def near_pairs(chain: Chain, count: int, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Starts and goals' joints at most 0.2 rad apart, 10 degrees inside all limits."""
    margin = np.radians(10.0)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi) + margin
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi) - margin
    pairs: list[tuple[np.ndarray, np.ndarray]] = []
    while len(pairs) < count:
        q0, d = rng.uniform(lower, upper), rng.normal(size=len(lower))
        q1 = q0 + 0.2 * rng.random() * d / np.linalg.norm(d)
        if (q1 >= lower).all() and (q1 <= upper).all():
            pairs.append((into_limits(chain, q0), into_limits(chain, q1)))
    return pairs


def goals_of(chain: Chain, count: int, rng: np.random.Generator) -> np.ndarray:
    return np.ascontiguousarray([chain.pose(q).homogeneous for q in random_configurations(chain, count, rng)])
