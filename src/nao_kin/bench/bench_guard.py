"""`nao-kin bench guard`: random motions into collisions, which have to end before, and clear ones, which may not."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.arrays import Floats
    from nao_kin.collision import CollisionModel
    from nao_kin.robot.motors import Motors
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["ClearanceReferee", "guard"]

_MARGIN: Final = 0.01  # [m]
_PLANES: Final = {"nao": ("wall", (-1.0, 0.0, 0.0), -0.25), "jaco2": ("table", (0.0, 0.0, 1.0), 0.0)}
_COARSE, _FINE, _BETWEEN = 40, 200, 3
_LONGEST: Final = 5000  # cycles


def guard(
    motions: Annotated[int, typer.Option(min=1, help="Motions of each kind and robot.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the motions.")] = 1,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Random straight motions of a NAO and a JACO2, some into themselves or a table, through the collision guard."""
    machine, rows, bounds = Machine(), list[dict[str, Any]](), list[Promise]()
    for robot in _PLANES:
        found = _measured(robot, motions, seed)
        rows += found
        collide, clear, _ = found
        touched = collide["motions"] - collide["stopped"]
        bounds += [
            Promise(f"{robot}: colliding motions not stopped", float(touched), 0.0, at_least=False),
            Promise(f"{robot}: least clearance of all, mm", min(row["least"] for row in found), 0.5e3 * _MARGIN - 0.01),
            Promise(f"{robot}: clear motions stopped", float(clear["stopped"]), 0.0, at_least=False),
            Promise(f"{robot}: clear motions that arrive, %", 100.0 * clear["arrived"] / clear["motions"], 100.0),
        ]
    conclude(machine, [Sheet("rows", _TITLE, _HEADINGS, rows)], bounds, _NOTES, format, goals)


_TITLE = f"Guard with a margin of {1e3 * _MARGIN:g} mm; 25 cm ahead of NAO a wall, under JACO2 a table"
_HEADINGS = (
    Heading("robot", "robot"),
    Heading("kind", "motions"),
    Heading("motions", "number", "d"),
    Heading("stopped", "stopped", "d"),
    Heading("arrived", "arrived", "d"),
    Heading("path", "unguarded [mm]", ".1f"),
    Heading("least", "least [mm]", ".2f"),
)
_NOTES = (
    "unguarded: the least clearance of the straight motions themselves, below 0 an overlap; least: of what the guard "
    f"let pass. Both by coal called directly, at {_BETWEEN} instants a cycle. A colliding motion has contact on its "
    "way, a clear one keeps the margin all the way; both keep the joints' ranges. With changing targets, a new random "
    "posture every half second, the robot stops or turns round as it can.",
)


@dataclass(frozen=True, eq=False, slots=True)
class _Motion:
    """A straight motion and the least clearance on it, as the referee measures it [m]."""

    start: Floats
    end: Floats
    least: float


def _measured(robot: str, count: int, seed: int) -> list[dict[str, Any]]:
    from nao_kin.bench.bench_guard import ClearanceReferee
    from nao_kin.collision import CollisionModel, Plane
    from nao_kin.output import progress
    from nao_kin.robot.robot import load

    collisions = CollisionModel(load(robot), margin=_MARGIN, planes=[Plane(*_PLANES[robot])])
    referee, rng = ClearanceReferee(collisions), np.random.default_rng(seed)
    rows = []
    for kind in ("colliding", "clear"):
        drawn = progress(_drawn(collisions, referee, rng, kind), f"{robot}, {kind}", count)
        runs = [(motion, _run(collisions, referee, motion)) for _, motion in zip(range(count), drawn, strict=False)]
        rows.append(
            {
                "robot": robot,
                "kind": kind,
                "motions": len(runs),
                "stopped": sum(run["stopped"] for _, run in runs),
                "arrived": sum(run["arrived"] for _, run in runs),
                "path": 1e3 * min(motion.least for motion, _ in runs),
                "least": 1e3 * min(run["least"] for _, run in runs),
            }
        )
    changing = max(1, count // 4)
    restless = [_restless(collisions, referee, rng) for _ in progress(range(changing), f"{robot}, changing", changing)]
    rows.append(
        {
            "robot": robot,
            "kind": "changing targets",
            "motions": changing,
            "stopped": sum(stopped for stopped, _ in restless),
            "least": 1e3 * min(least for _, least in restless),
        }
    )
    return rows


def _drawn(
    collisions: CollisionModel, referee: ClearanceReferee, rng: np.random.Generator, kind: str
) -> Iterator[_Motion]:
    """Random motions of a kind that keep the joints' ranges, without end."""
    from nao_kin.chain import random_configurations

    while True:
        start, end = random_configurations(collisions.motors, 2, rng)
        way = [start + (end - start) * s for s in np.linspace(0.0, 1.0, _COARSE)]
        coarse = np.array([collisions.measure(q).min() for q in way])
        if coarse[0] < 1.5 * _MARGIN or (kind == "clear" and coarse.min() < _MARGIN):
            continue
        if kind == "colliding" and coarse.min() > 0.0:
            continue
        contact = int(np.argmax(coarse <= 0.0)) if kind == "colliding" else _COARSE - 1
        if not _keeps_limits(collisions.motors, start, way[contact]):
            continue
        least = _least(referee, start, end)
        if least < 0.0 if kind == "colliding" else least >= _MARGIN:
            yield _Motion(start, end, least)


def _keeps_limits(motors: Motors, start: Floats, end: Floats) -> bool:
    """Whether a straight move keeps the coupled ranges; the plain ones it keeps if its ends do."""
    way = start + np.linspace(0.0, 1.0, 20_001)[:, None] * (end - start)
    for rule in motors.limit_rules:
        by, value = way[:, motors.index(rule.by)], way[:, motors.index(rule.joint)]
        by = np.abs(by) if rule.even else by
        below, above = np.interp(by, rule.at, rule.lower), np.interp(by, rule.at, rule.upper)
        if (value < below - 1e-12).any() or (value > above + 1e-12).any():
            return False
    return True


def _least(referee: ClearanceReferee, start: Floats, end: Floats) -> float:
    """The least clearance of a straight motion [m], looked at more closely where it is least."""
    found = referee.along(start, end, _FINE)
    k, step = int(np.argmin(found)), (end - start) / (_FINE - 1)
    near = referee.along(start + max(k - 1, 0) * step, start + min(k + 1, _FINE - 1) * step, _FINE)
    return float(min(found.min(), near.min()))


def _run(collisions: CollisionModel, referee: ClearanceReferee, motion: _Motion) -> dict[str, Any]:
    """One motion through the guard, measured between its cycles too."""
    from nao_kin.motion.loop.guard import Guard

    guarded, way, blocked = Guard(collisions, motion.start), [motion.start], False
    for _ in range(_LONGEST):
        done = guarded.step(motion.end)
        way.append(done.q)
        blocked = blocked or bool(done.blocked_by)
        if done.at_rest:
            break
    arrived = bool(np.abs(way[-1] - motion.end).max() <= 1e-9)
    least = _least_between(referee, way)
    return {"stopped": blocked and done.at_rest and not arrived, "arrived": arrived and not blocked, "least": least}


def _restless(collisions: CollisionModel, referee: ClearanceReferee, rng: np.random.Generator) -> tuple[bool, float]:
    """Four targets, changed before they are reached; whether any was refused, and the least clearance [m]."""
    from nao_kin.chain import random_configurations
    from nao_kin.motion.loop.guard import Guard

    start = random_configurations(collisions.motors, 1, rng)[0]
    while collisions.measure(start).min() < 1.5 * _MARGIN:
        start = random_configurations(collisions.motors, 1, rng)[0]
    guarded, way, stopped = Guard(collisions, start), [start], False
    for target in random_configurations(collisions.motors, 4, rng):
        for _ in range(round(0.5 / guarded.period)):
            done = guarded.step(target)
            way.append(done.q)
            stopped = stopped or bool(done.blocked_by)
    return stopped, _least_between(referee, way)


def _least_between(referee: ClearanceReferee, way: list[Floats]) -> float:
    """The least clearance of a motion given once a cycle [m], at instants between the cycles too."""
    points, steps = np.array(way[:-1]), np.diff(way, axis=0)
    shares = np.arange(_BETWEEN)[:, None, None] / _BETWEEN
    return float(referee.clearances((points + shares * steps).reshape(-1, points.shape[1])).min())


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
