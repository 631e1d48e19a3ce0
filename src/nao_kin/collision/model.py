"""Which bodies of a robot touch, and how far apart they are, by coal through Pinocchio's geometry model."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, frozen
from nao_kin.chain import random_configurations
from nao_kin.collision.shapes import CollisionBody, Plane, link_bodies, plane_body
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.robot.motors import Motors
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nao_kin.robot.robot import Robot

__all__ = ["DISTANCE_ACCURACY", "CollisionModel", "Excluded", "Proximity", "pair_levers"]

DISTANCE_ACCURACY: Final = 1e-5
"""What a measured distance may be off by [m]: coal iterates to 1e-6 of its own."""

_SAMPLES: Final = 200  # postures at which a pair has to touch to count as always touching
_SEED: Final = 0


@dataclass(frozen=True, eq=False, slots=True)
class Proximity:
    """Two bodies and what is between them.

    Attributes:
        first: Link of the one.
        second: Link of the other, or the plane.
        distance: Between their nearest points [m]; below 0 it is the depth to which they overlap.
        first_point: The nearest point of the first, (3,) in the root frame [m].
        second_point: The nearest point of the second, (3,) in the root frame [m].
    """

    first: str
    second: str
    distance: float
    first_point: Floats
    second_point: Floats

    def __str__(self) -> str:
        if self.distance <= 0.0:
            return f"{self.first} and {self.second} overlap by {-self.distance:.4g} m"
        return f"{self.first} and {self.second} are {self.distance:.4g} m apart"


@dataclass(frozen=True, slots=True)
class Excluded:
    """Two bodies that are not watched, and why."""

    first: str
    second: str
    reason: str


class CollisionModel:
    """The collision shapes of a robot, its planes, and the pairs of them that are watched.

    Left out are pairs that nothing moves against each other, pairs that meet in a joint (with no shape between), and
    pairs that touch at every one of a fixed set of random postures within the limits: links that overlap by how they
    are drawn. `excluded` lists them all. A pair that touches at some postures only is a collision and stays.

    It holds working memory, so use one in each thread.

    Args:
        robot: Whose shapes; meshes are not watched and `notes` says so.
        margin: Bodies nearer than this touch [m].
        planes: Ground or tables, fixed to the root frame.
        ignored: Further pairs of links or planes not to watch.

    Raises:
        InvalidInputError: Nothing to watch, a margin below 0, or a plane with the name of a link or another plane.
        UnknownNameError: An ignored pair names no body.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        margin: float = 0.0,
        planes: Sequence[Plane] = (),
        ignored: Sequence[tuple[str, str]] = (),
    ) -> None:
        if not 0.0 <= margin < np.inf:
            raise InvalidInputError("margin", "a finite number ≥ 0 [m]", repr(margin))
        self.robot, self.margin, self.planes = robot, float(margin), tuple(planes)
        self.motors = Motors.of(robot)
        bodies, self.notes = link_bodies(robot)
        _check_names(self.planes, robot)
        self.bodies: tuple[CollisionBody, ...] = (*bodies, *map(plane_body, self.planes))
        pairs, excluded = self._sorted_pairs(ignored)
        self._load(pairs)
        always = self._always_touching()
        self.excluded: tuple[Excluded, ...] = (*excluded, *(Excluded(*owners, "always touch") for owners in always))
        self._load([pair for pair in pairs if self._owners(pair) not in always])
        if not self.pairs:
            raise InvalidInputError(f"collision shapes of {robot.name}", "two bodies that can touch", "none")

    @cached_property
    def levers(self) -> Floats:
        """Levers (P, n) [m/rad]: moving the motors by Δq changes a pair's distance by at most levers · |Δq|."""
        return frozen(pair_levers(self.motors, self.bodies, self.pairs))

    def owners(self, pair: int) -> tuple[str, str]:
        """The links, or link and plane, of a watched pair."""
        return self._owners(self.pairs[pair])

    def measure(self, q: Floats, pairs: Sequence[int] | None = None) -> Floats:
        """Signed distances [m] (k,) of watched pairs, all by default, at motor values q (n,) that are not checked.

        The fast way in for loops; `distances` says what is near what.
        """
        self._place(q)
        chosen = range(len(self.pairs)) if pairs is None else pairs
        return np.array([self._result(k).min_distance for k in chosen])

    def distances(self, posture: Mapping[str, float]) -> tuple[Proximity, ...]:
        """Every watched pair of shapes, nearest first; joints that the posture does not name are at 0.

        Raises:
            UnknownNameError, InvalidInputError: See `nao_kin.Robot.expand`.
        """
        self._place(self.motors.q_of(posture))
        found = []
        for k in range(len(self.pairs)):
            result = self._result(k)
            points = (np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2()))
            found.append(Proximity(*self.owners(k), float(result.min_distance), *points))
        return tuple(sorted(found, key=lambda each: each.distance))

    def distance(self, posture: Mapping[str, float]) -> Proximity:
        """The nearest pair at a posture.

        Raises:
            UnknownNameError, InvalidInputError: See `nao_kin.Robot.expand`.
        """
        return self.distances(posture)[0]

    def touching(self, posture: Mapping[str, float]) -> tuple[Proximity, ...]:
        """The pairs that are nearer than the margin, or overlap, nearest first.

        Raises:
            UnknownNameError, InvalidInputError: See `nao_kin.Robot.expand`.
        """
        return tuple(each for each in self.distances(posture) if each.distance <= self.margin)

    def table(self) -> Table:
        """The pairs that are not watched, with the reason."""
        rows = tuple((each.first, each.second, each.reason) for each in self.excluded)
        note = f"{len(self.pairs)} pairs of shapes are watched. {' '.join(self.notes)}".rstrip()
        return Table(
            (Column("first"), Column("second"), Column("not watched since")),
            rows,
            title=f"{self.robot.name}: collisions",
            note=note,
        )

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()

    def __repr__(self) -> str:
        return f"<CollisionModel {self.robot.name}: {len(self.bodies)} bodies, {len(self.pairs)} pairs>"

    def _owners(self, pair: tuple[int, int]) -> tuple[str, str]:
        return self.bodies[pair[0]].owner, self.bodies[pair[1]].owner

    def _sorted_pairs(self, ignored: Sequence[tuple[str, str]]) -> tuple[list[tuple[int, int]], list[Excluded]]:
        """The pairs that may have to be watched, and the others."""
        owners = {body.owner for body in self.bodies}
        for name in itertools.chain.from_iterable(ignored):
            if name not in owners:
                raise UnknownNameError("body", name, sorted(owners), self.robot.name)
        unwanted = {frozenset(pair) for pair in ignored}
        neighbours = _neighbours(self.robot.model, {body.joint for body in self.bodies if body.reach < np.inf})
        pairs, excluded = [], dict[tuple[str, str], Excluded]()
        for i, j in itertools.combinations(range(len(self.bodies)), 2):
            names, joints = self._owners((i, j)), (self.bodies[i].joint, self.bodies[j].joint)
            if names[0] == names[1]:
                continue
            plane = self.bodies[j].reach == np.inf
            if joints[0] == joints[1]:
                excluded.setdefault(names, Excluded(*names, "nothing moves them against each other"))
            elif frozenset(joints) in neighbours and not plane:
                excluded.setdefault(names, Excluded(*names, "meet in a joint"))
            elif frozenset(names) in unwanted:
                excluded.setdefault(names, Excluded(*names, "ignored on request"))
            else:
                pairs.append((i, j))
        return pairs, list(excluded.values())

    def _load(self, pairs: list[tuple[int, int]]) -> None:
        """Takes these pairs as the watched ones."""
        self.pairs = tuple(pairs)
        self._geometry = pin.GeometryModel()
        for number, body in enumerate(self.bodies):
            name = f"{number}:{body.owner}"
            self._geometry.addGeometryObject(pin.GeometryObject(name, body.joint, body.T_joint_shape, body.shape))
        for i, j in pairs:
            self._geometry.addCollisionPair(pin.CollisionPair(i, j))
        self._data, self._shapes = self.robot.model.createData(), pin.GeometryData(self._geometry)

    def _always_touching(self) -> set[tuple[str, str]]:
        """The owners whose shapes touch at every one of the sampled postures."""
        planes = {plane.name for plane in self.planes}  # one that lies wrongly is to be noticed
        candidates = {owners for pair in self.pairs if not planes & set(owners := self._owners(pair))}
        samples = random_configurations(self.motors, _SAMPLES, np.random.default_rng(_SEED))
        for q in samples:
            near = np.flatnonzero(self.measure(q) <= 0.0)
            candidates &= {self.owners(int(k)) for k in near}
            if not candidates:
                break
        return candidates

    def _place(self, q: Floats) -> None:
        model, motors = self.robot.model, self.motors
        pin.updateGeometryPlacements(model, self._data, self._geometry, self._shapes, motors.pinocchio_q(q))

    def _result(self, pair: int) -> pin.DistanceResult:
        return pin.computeDistance(self._geometry, self._shapes, pair)


def _check_names(planes: Sequence[Plane], robot: Robot) -> None:
    taken = set(robot.frame_names)
    for plane in planes:
        if plane.name in taken:
            raise InvalidInputError("planes", "a name that no link and no other plane has", repr(plane.name))
        taken.add(plane.name)


def _neighbours(model: pin.Model, shaped: set[int]) -> set[frozenset[int]]:
    """Pairs of moving parts with no other part that has a shape between them: they meet in a joint and may overlap."""
    nearest: dict[int, int] = {0: 0}  # the part with a shape that a joint's part hangs on; the root if there is none
    for joint in range(1, model.njoints):
        above = int(model.parents[joint])
        nearest[joint] = above if above in shaped or above == 0 else nearest[above]
    return {frozenset({joint, nearest[joint]}) for joint in shaped if joint}


def pair_levers(motors: Motors, bodies: Sequence[CollisionBody], pairs: Sequence[tuple[int, int]]) -> Floats:
    """Levers (P, n) of every pair for every motor [m/rad, or m/m for prismatic joints].

    A motor that moves neither body against the other has lever 0.
    """
    to_body = [_levers(motors, body) for body in bodies]
    levers = np.zeros((len(pairs), len(motors.joints)))
    for row, (i, j) in enumerate(pairs):
        apart = set(to_body[i]) ^ set(to_body[j])  # joints above both move them alike
        for body in (i, j):
            for joint, lever in to_body[body].items():
                if joint in apart:
                    levers[row] += lever * np.abs(motors.spread[joint])
    return levers


def _levers(motors: Motors, body: CollisionBody) -> dict[int, float]:
    """For each moving joint above a body, by its place in file order, how far from its axis the body may ever be."""
    model, names, found, distance, joint = motors.robot.model, motors.robot.joint_names, {}, body.reach, body.joint
    while joint:
        place = names.index(model.names[joint])
        prismatic = motors.robot.moving_joints[place].kind == "prismatic"
        found[place] = 1.0 if prismatic else distance
        if prismatic:
            distance += _travel(motors, place)
        distance += float(np.linalg.norm(model.jointPlacements[joint].translation))
        joint = model.parents[joint]
    return found


def _travel(motors: Motors, place: int) -> float:
    """Greatest offset of a prismatic joint from its zero [m]; infinite where it has no limits."""
    row, shift = motors.spread[place], motors.shift[place]
    (column,) = np.flatnonzero(row)
    return float(max(abs(row[column] * end + shift) for end in (motors.lower[column], motors.upper[column])))
