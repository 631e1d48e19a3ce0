"""What one motor moves: its joint and all that follow it, how far and how fast all of them let it go.

A follower's value is multiplier · leader + offset, so it moves |multiplier| times as fast. Ranges and speeds of a motor
are therefore what every joint that it moves allows, on the path that is looked at or off it. This is the only place
that works them out: chains, trees, motors, pages and the checks ask it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.chain import ChainJoint
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import UrdfJoint

__all__ = ["Coupling", "contradictions", "couplings_of", "couplings_on", "driven_joints", "spread_and_shift", "stated"]


@dataclass(frozen=True, slots=True)
class Coupling:
    """A joint without a motor of its own: value = multiplier · leader + offset [rad or m]."""

    follower: str
    leader: str
    multiplier: float
    offset: float

    def range_of_follower(self, leader: ChainJoint) -> tuple[float, float]:
        """Where the follower goes while its leader goes through its range [rad or m]."""
        lower, upper = sorted(self.multiplier * end + self.offset for end in (leader.lower, leader.upper))
        return lower, upper

    def range_of_leader(self, follower: ChainJoint) -> tuple[float, float]:
        """Where the leader may go for its follower to stay in its range [rad or m]."""
        lower, upper = sorted((end - self.offset) / self.multiplier for end in (follower.lower, follower.upper))
        return lower, upper


def couplings_of(joints: Iterable[UrdfJoint]) -> tuple[Coupling, ...]:
    """The followers among the moving joints of a file, each given by the leader that has the motor."""
    mimics = {joint.name: joint.mimic for joint in joints if joint.mimic is not None}
    found = []
    for follower, mimic in mimics.items():
        leader, multiplier, offset = mimic.joint, mimic.multiplier, mimic.offset
        while leader in mimics:  # the reader has refused cycles
            above = mimics[leader]
            leader, offset = above.joint, multiplier * above.offset + offset
            multiplier *= above.multiplier
        found.append(Coupling(follower, leader, multiplier, offset))
    return tuple(found)


def stated(joint: UrdfJoint) -> ChainJoint:
    """A moving joint as the file states it, whatever follows it: no range for a continuous one, ∞ for no speed."""
    if joint.kind == "fixed":
        raise ValueError(joint.name)  # paths hold moving joints only
    limit = joint.limit
    speed = math.inf if limit is None or limit.velocity is None else limit.velocity
    # A chain with a joint that has its limits swapped is refused.
    if joint.kind == "continuous" or limit is None or limit.lower is None or limit.upper is None or limit.swapped:
        return ChainJoint(joint.name, joint.kind, max_velocity=speed)
    return ChainJoint(joint.name, joint.kind, limit.lower, limit.upper, speed)


def driven_joints(
    joints: Iterable[ChainJoint], couplings: Sequence[Coupling], *, contradictory: bool = False
) -> dict[str, ChainJoint]:
    """The joints with the ranges and speeds that they have together, by name, in the order given.

    A motor's are cut down to what all its followers allow, and a follower's are what its motor makes of them. A
    continuous joint that a follower or leader gives a range to is a revolute one.

    Args:
        joints: The joints as the file states them.
        couplings: The followers among them, each given by the joint that has the motor.
        contradictory: Whether a follower that leaves its leader no value is let pass instead of refused: both keep
            their ranges, at speeds that both can do.

    Raises:
        InvalidInputError: A follower leaves its leader no value at all.
    """
    found, empty = _motors(joints, couplings)
    if empty and not contradictory:
        c, leader = next(iter(empty.items()))
        ranges = f"{(leader.lower, leader.upper)} and {(found[c.follower].lower, found[c.follower].upper)}"
        expected = f"a value of {c.leader} that its follower {c.follower} allows"
        raise InvalidInputError("coupled joints", expected, f"ranges {ranges}, which exclude each other")
    for c in couplings:
        motor, own = found[c.leader], found[c.follower]
        ends = (own.lower, own.upper) if c in empty else c.range_of_follower(motor)
        found[c.follower] = _limited(own, ends, motor.max_velocity * abs(c.multiplier))
    return found


def contradictions(joints: Iterable[ChainJoint], couplings: Sequence[Coupling]) -> tuple[Coupling, ...]:
    """The followers that leave their leaders no value at which both, and the followers before, are in their ranges."""
    return tuple(_motors(joints, couplings)[1])


def _motors(
    joints: Iterable[ChainJoint], couplings: Sequence[Coupling]
) -> tuple[dict[str, ChainJoint], dict[Coupling, ChainJoint]]:
    """The joints, motors cut down to what their followers allow; and who allows nothing, with the leader it met."""
    found, empty = {joint.name: joint for joint in joints}, {}
    for c in couplings:
        leader, follower = found[c.leader], found[c.follower]
        ends = c.range_of_leader(follower)
        lower, upper = max(leader.lower, ends[0]), min(leader.upper, ends[1])
        if lower > upper:
            empty[c] = leader
            lower, upper = leader.lower, leader.upper
        speed = min(leader.max_velocity, follower.max_velocity / abs(c.multiplier))
        found[c.leader] = _limited(leader, (lower, upper), speed)
    return found, empty


def _limited(joint: ChainJoint, ends: tuple[float, float], max_velocity: float) -> ChainJoint:
    """The joint in a range and at a speed that others give it."""
    kind = joint.kind if ends == (-math.inf, math.inf) or joint.kind == "prismatic" else "revolute"
    return ChainJoint(joint.name, kind, *ends, max_velocity)


def couplings_on(names: Sequence[str], couplings: Sequence[Coupling]) -> dict[str, Coupling]:
    """How each of the named joints hangs on the one among them that owns its motor's column.

    That is the leader where it is among them; else the first of its followers stands for the motor, and the others go
    with it.
    """
    by_follower = {c.follower: c for c in couplings}
    to_motor = {name: by_follower.get(name, Coupling(name, name, 1.0, 0.0)) for name in names}
    owners: dict[str, Coupling] = {}
    for c in to_motor.values():
        if c.leader in to_motor:
            owners[c.leader] = to_motor[c.leader]
        else:
            owners.setdefault(c.leader, c)
    found = {}
    for name, c in to_motor.items():
        owner = owners[c.leader]
        ratio = c.multiplier / owner.multiplier
        found[name] = Coupling(name, owner.follower, ratio, c.offset - ratio * owner.offset)
    return found


def spread_and_shift(couplings: Sequence[Coupling], owners: Sequence[str]) -> tuple[Floats, Floats]:
    """Matrix (m, n) and vector (m,): the values of m coupled joints are spread · q + shift, with q the n owners'."""
    column = {name: k for k, name in enumerate(owners)}
    spread = np.zeros((len(couplings), len(owners)))
    for row, c in enumerate(couplings):
        spread[row, column[c.leader]] = c.multiplier
    return spread, np.array([c.offset for c in couplings], dtype=np.float64)
