"""Targets for `nao-kin bench edges`, reachable ones made from joints, unreachable ones from a distance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.bench.referee import Referee
from nao_kin.chain import random_configurations
from nao_kin.output import progress

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["bad_targets", "beyond_reach", "farthest", "near_full_reach", "with_joint_at_zero"]

_CHUNK = 100_000
_BISECTIONS = 60  # enough for the last digit


def farthest(chain: UrdfChain, samples: int, rng: np.random.Generator) -> tuple[Floats, float]:
    """The configuration with the largest distance of the tip from the base among random ones, and that distance [m]."""
    best, q_best = 0.0, np.zeros(len(chain.joints))
    starts = range(0, samples, _CHUNK)
    for start in progress(starts, "looking for the reach", len(starts)):
        Q = random_configurations(chain, min(_CHUNK, samples - start), rng)
        distances = np.linalg.norm(chain.poses(Q)[:, :3, 3], axis=1)
        k = int(distances.argmax())
        if distances[k] > best:
            best, q_best = float(distances[k]), Q[k]
    return q_best, best


def with_joint_at_zero(chain: UrdfChain, joint: int, count: int, rng: np.random.Generator) -> Floats:
    """Poses (count, 4, 4) of random configurations with one joint at exactly 0."""
    Q = random_configurations(chain, count, rng)
    Q[:, joint] = np.clip(0.0, chain.lower[joint], chain.upper[joint])
    referee = Referee(chain)
    return np.array([referee.pose(q) for q in Q])


def near_full_reach(chain: UrdfChain, q_far: Floats, distance: float, count: int, rng: np.random.Generator) -> Floats:
    """Reachable poses (count, 4, 4) whose tip is at exactly that distance from the base, near the largest there is.

    From the farthest configuration, turned about the first joint, a random direction is followed until the tip has
    come that near. So the orientation is one that the arm has there.
    """
    referee, poses, tries = Referee(chain), list["Floats"](), 0
    while len(poses) < count:
        tries += 1
        if tries > 100 * count:
            raise RuntimeError(f"found {len(poses)} of {count} poses of {chain.name} at {distance:.6g} m")
        q, direction = q_far.copy(), rng.normal(size=len(q_far))
        q[0] = random_configurations(chain, 1, rng)[0, 0]
        direction[0] = 0.0
        T = _at_distance(referee, q, direction / np.linalg.norm(direction), distance)
        if T is not None:
            poses.append(T)
    return np.array(poses)


def _at_distance(referee: Referee, q: Floats, direction: Floats, distance: float) -> Floats | None:
    """The pose on the way from q along a direction of the joints where the tip comes within a distance; bisection."""

    def away(step: float) -> float:
        return float(np.linalg.norm(referee.pose(q + step * direction)[:3, 3]))

    near, far = 0.0, 1.0
    if away(near) < distance or away(far) > distance:
        return None
    for _ in range(_BISECTIONS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if away(middle) > distance else (near, middle)
    found = q + far * direction
    return referee.pose(found) if referee.inside(found) else None


def beyond_reach(distance: float, count: int, rng: np.random.Generator) -> Floats:
    """Random poses (count, 4, 4) at a distance from the base."""
    directions = rng.normal(size=(count, 3))
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, 3] = distance * directions / np.linalg.norm(directions, axis=1)[:, None]
    for pose, x in zip(poses, rng.normal(size=(count, 4)), strict=True):
        pose[:3, :3] = pin.Quaternion(*(x / np.linalg.norm(x))).matrix()
    return poses


def bad_targets(chain: UrdfChain) -> dict[str, Floats]:
    """Matrices (4, 4) that are no rigid pose, by what is wrong with them."""
    good = Referee(chain).pose(random_configurations(chain, 1, np.random.default_rng(5))[0])

    def changed(row: slice | int, column: slice | int, factor: float) -> Floats:
        T = good.copy()
        T[row, column] *= factor
        return T

    sheared, last_row = good.copy(), good.copy()
    sheared[:3, 0] += 0.01 * sheared[:3, 1]
    last_row[3] = (0.0, 0.0, 0.1, 1.0)
    return {
        "NaN in the position": changed(0, 3, np.nan),
        "NaN in the rotation": changed(1, 1, np.nan),
        "infinite position": changed(2, 3, np.inf),
        "rotation scaled by 1.001": changed(slice(0, 3), slice(0, 3), 1.001),
        "reflection": changed(slice(0, 3), 0, -1.0),
        "sheared rotation": sheared,
        "last row not 0 0 0 1": last_row,
    }
