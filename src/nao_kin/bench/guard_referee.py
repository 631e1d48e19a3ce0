"""A second opinion on clearances: coal called directly on shapes that our compiled kinematics places."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.collision import CollisionModel
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["ClearanceReferee"]


class ClearanceReferee:
    """Measures how near any two bodies are that the model watches, by itself.

    Args:
        collisions: Says which links and planes; nothing is measured with it.
    """

    def __init__(self, collisions: CollisionModel) -> None:
        import coal

        from nao_kin.urdf.elements import Box, Cylinder, Sphere

        self._motors, self._robot = collisions.motors, collisions.robot
        self._solids: list[tuple[str, Any, Any]] = []
        for link in self._robot.document.links:
            for solid in link.collisions:
                match solid.shape:
                    case Box(size):
                        shape: Any = coal.Box(*size)
                    case Cylinder(radius, length):
                        shape = coal.Cylinder(radius, length)
                    case Sphere(radius):
                        shape = coal.Sphere(radius)
                    case _:
                        continue
                self._solids.append((link.name, shape, _rigid(solid.origin.xyz, solid.origin.rpy)))
        planes = [coal.Halfspace(plane.normal, plane.offset) for plane in collisions.planes]
        self._coal, self._shapes = coal, [shape for _, shape, _ in self._solids] + planes
        unwatched = {frozenset((pair.first, pair.second)) for pair in collisions.excluded}
        names = [name for name, *_ in self._solids] + [plane.name for plane in collisions.planes]
        pairs = [
            (i, j)
            for i, j in itertools.combinations(range(len(names)), 2)
            if names[i] != names[j] and i < len(self._solids) and frozenset((names[i], names[j])) not in unwatched
        ]
        self._first, self._second = np.array(pairs).T
        balls = np.array([_ball(shape) for _, shape, _ in self._solids] + [np.inf] * len(planes))
        self._radii = balls[self._first] + balls[self._second]
        self._poses = self._chains()

    def _chains(self) -> dict[str, tuple[UrdfChain, list[int]]]:
        """The chain from the root to each link that moves, and where its joints are among all of them."""
        robot = self._robot
        found: dict[str, tuple[UrdfChain, list[int]]] = {}
        for name in {name for name, *_ in self._solids}:
            if any(joint.kind != "fixed" for joint in robot.path(robot.root, name)[1]):
                chain = robot.chain(robot.root, name)
                found[name] = chain, [robot.joint_names.index(joint) for joint in chain.joint_names]
        return found

    def clearances(self, Q: Floats) -> Floats:
        """Least distances (N,) of any two watched bodies [m] at motor values (N, n); below 0 they overlap."""
        T = self._placed(Q)
        centres = T[:, :, :3, 3]
        # Balls around the shapes first: what they already keep farther apart than the least found cannot be nearer.
        between = np.linalg.norm(centres[:, self._first] - centres[:, self._second], axis=2) - self._radii
        return np.array([self._nearest(*row) for row in zip(T, between, strict=True)])

    def along(self, start: Floats, end: Floats, samples: int) -> Floats:
        """Clearances (samples,) [m] on the straight move between two postures, both ends included."""
        return self.clearances(start + np.linspace(0.0, 1.0, samples)[:, None] * (end - start))

    def _placed(self, Q: Floats) -> Floats:
        """Poses (N, B, 4, 4) of all bodies in the root frame, by the compiled forward kinematics."""
        values = Q @ self._motors.spread.T + self._motors.shift
        T = np.tile(np.eye(4), (len(Q), len(self._shapes), 1, 1))
        for k, (name, _, T_link_shape) in enumerate(self._solids):
            if name not in self._poses:
                T[:, k] = T_link_shape
                continue
            chain, columns = self._poses[name]
            T[:, k] = chain.poses(values[:, columns]) @ T_link_shape
        return T

    def _nearest(self, T: Floats, between: Floats) -> float:
        least = np.inf
        for k in np.argsort(between):
            if between[k] >= least:
                break
            i, j = self._first[k], self._second[k]
            poses = [self._coal.Transform3s(T[body, :3, :3], T[body, :3, 3]) for body in (i, j)]
            request, result = self._coal.DistanceRequest(), self._coal.DistanceResult()
            shapes = self._shapes[i], self._shapes[j]
            least = min(least, self._coal.distance(shapes[0], poses[0], shapes[1], poses[1], request, result))
        return float(least)


def _ball(shape: Any) -> float:
    """Radius of a ball around the shape's origin that holds all of it [m]."""
    shape.computeLocalAABB()
    return float(np.linalg.norm(shape.aabb_center) + shape.aabb_radius)


def _rigid(xyz: tuple[float, float, float], rpy: tuple[float, float, float]) -> Floats:
    """Homogeneous transform (4, 4) of an origin: Rz(yaw) Ry(pitch) Rx(roll)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    T = np.eye(4)
    T[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    T[:3, 3] = xyz
    return T
