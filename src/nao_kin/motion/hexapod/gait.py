"""A hexapod that walks: a gait, a speed and a pose of the body become the motion of eighteen joints, checked.

The plan of the feet and the body is `nao_kin.motion.hexapod.footfall`'s. Here every leg is solved in closed form
(`nao_kin.analytic.hexapod.body`), every foot is measured again by Pinocchio, and the motion is held against reach,
joint ranges, joint speeds and static balance. What cannot be walked is refused: which leg or joint, when, and by how
much.

Stance as published for the PhantomX: feet 0.141 m from the coxa axes, body 0.09 m up (KevinOchs/hexapod_ros,
params/phantomX.yaml).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NoReturn

import numpy as np
import pinocchio as pin

from nao_kin.analytic.hexapod.body import BodyBatchResult, body_ik, body_ik_batch
from nao_kin.arrays import frozen
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.balance import centres_of_mass, support_margins
from nao_kin.motion.feasible import Attempted, Refusal, refusal_where, refusals, said
from nao_kin.motion.hexapod.footfall import LEGS, Steps, steps
from nao_kin.motion.hexapod.walk_request import WalkCommand
from nao_kin.motion.loop.profile import minimum_jerk
from nao_kin.se3 import from_xyz_rpy, rotation_z, translation
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.robot.robot import Robot

__all__ = ["Walk", "WalkCommand", "WalkPlan", "fastest", "hexapod_legs", "walk"]

_SHARES: Final = (1e-6, 1e9)  # of the speed asked for, between which the greatest one is looked for
_SHARE: Final = 0.01  # to which it is found, relative


@dataclass(frozen=True, eq=False, slots=True)
class Walk(Attempted):
    """A walk, measured.

    Attributes:
        command: What was asked for.
        attempt: What the joints would do; where a foot is out of reach, the nearest that its leg can do.
        T_world_body: Pose of the body in the world at every sample (N, 4, 4): where to put the robot's base.
        stance: Which feet are on the ground (N, 6), in the order of `nao_kin.motion.hexapod.footfall.LEGS`.
        feet: Where the feet are in the world (N, 6, 3) [m], by the legs' forward kinematics.
        margins: How far the centre of mass is inside the polygon of the standing feet (N,) [m].
        slip: Farthest that a standing foot moves on the ground [m], measured at the samples.
        slip_between: The same half-way between samples, where joints move straight and feet do not quite stay [m].
        refused: What of it cannot be done.
    """

    command: WalkCommand
    attempt: Trajectory
    T_world_body: Floats
    stance: NDArray[np.bool_]
    feet: Floats
    margins: Floats
    slip: float
    slip_between: float
    refused: tuple[Refusal, ...]
    legs: Mapping[str, Chain] = field(repr=False)

    @property
    def walkable(self) -> bool:
        """Whether it can be walked: within reach, ranges, speeds and balance, everything measured."""
        return not self.refused

    @property
    def message(self) -> str:
        """For people: what was measured, or why it is refused."""
        if self.refused:
            return f"It cannot be walked: {said(self.refused)}"
        return (
            f"It can be walked: feet on the ground move by {self.slip:.2g} m, the centre of mass stays "
            f"{self.least:.3g} m inside the feet, and joints use up to {100.0 * float(self.speed_share.max()):.0f} % "
            "of their speed."
        )

    @property
    def least(self) -> float:
        """The least of the margins [m]."""
        return float(self.margins.min())

    @property
    def speed_share(self) -> Floats:
        """Greatest speed of every joint over what it can do (n,)."""
        allowed = np.array([joint.max_velocity for joint in self.attempt.joints])
        with np.errstate(divide="ignore", invalid="ignore"):  # a file may allow a joint no speed at all
            return np.asarray(np.abs(self.attempt.velocities).max(axis=0) / allowed)

    def table(self) -> Table:
        """One row a leg: steps, time on the ground, room to the ends of the joints' ranges, and speed used."""
        rows = []
        for k, (leg, chain) in enumerate(self.legs.items()):
            q, down = self.attempt.q[:, 3 * k : 3 * k + 3], self.stance[:, k]
            room = float(np.minimum(q - chain.lower, chain.upper - q).min())
            begun = int((down[:-1] & ~down[1:]).sum())
            share = float(self.speed_share[3 * k : 3 * k + 3].max())
            cells = (f"{100.0 * down.mean():.1f}", f"{math.degrees(room):.1f}", f"{100.0 * share:.0f}")
            rows.append((leg, str(begun), *cells))
        headings = ("steps", "on ground [%]", "room to limits [deg]", "of joint speed [%]")
        columns = (Column("leg"), *(Column(heading, number=True) for heading in headings))
        return Table(columns, tuple(rows), title=f"{self.command.rhythm.name}, {self.attempt.duration:.2f} s in all")

    def __bool__(self) -> NoReturn:
        raise TypeError("A Walk is not a truth value: ask for walk.walkable.")

    def __repr__(self) -> str:
        return f"<Walk {self.command.rhythm.name}: {self.message}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def walk(
    robot: Robot,
    command: WalkCommand = WalkCommand(),  # noqa: B008 - immutable
    *,
    legs: Mapping[str, Chain] | None = None,
    tolerances: Tolerances = TOLERANCES,
) -> Walk:
    """A hexapod walks as commanded, from standing to standing.

    Args:
        robot: The hexapod; its root is its body, z up.
        command: Gait, speed, body pose and the rest.
        legs: Its legs under the names of `nao_kin.motion.hexapod.footfall.LEGS`, from the root to the feet; by default
            the robot's chains ``leg_lf`` and so on.
        tolerances: When a foot counts as being in its place.

    Raises:
        InvalidInputError: The robot is no such hexapod, or does not even stand as commanded: the message says why.
        UnknownNameError: A leg of another name; carries near matches.
    """
    chains = hexapod_legs(robot, legs)
    plan = WalkPlan.of(command, chains)
    standing = body_ik(chains, translation(0.0, 0.0, command.height), plan.standing, tolerances=tolerances)
    if not standing.solved:
        got = f"a spread of {command.spread:g} m at a height of {command.height:g} m: {standing.message}"
        raise InvalidInputError("stance", "one that every leg reaches", got)
    times = plan.sample_times()
    T, wanted, down = plan.at(times)
    found = body_ik_batch(chains, T, wanted, near=standing.posture, tolerances=tolerances)
    joints = [joint for chain in chains.values() for joint in chain.joints]
    attempt = Trajectory(joints, times - times[0], found.q, f"{robot.name} {command.rhythm.name}")
    feet = _measured(chains, found.q, T)
    centre = np.einsum("nij,nj->ni", T[:, :3, :3], centres_of_mass(robot, attempt)) + T[:, :3, 3]
    margins = support_margins(feet[:, :, :2], down, centre[:, :2])
    refused = (
        *_missed(found, attempt, tolerances),
        *refusals(attempt, tolerances=tolerances),
        *refusal_where(
            margins < command.margin, command.margin - margins, attempt.times, "body", "out of balance", "m"
        ),
    )
    between = _between(chains, found.q, plan, times)
    arrays = (frozen(T), down, frozen(feet), frozen(margins))
    return Walk(command, attempt, *arrays, _slip(feet, down), between, refused, chains)


def fastest(
    robot: Robot,
    command: WalkCommand = WalkCommand(),  # noqa: B008 - immutable
    *,
    legs: Mapping[str, Chain] | None = None,
    tolerances: Tolerances = TOLERANCES,
) -> Walk:
    """The walk at the greatest multiple of the commanded speed that can be walked, found by bisection to a hundredth.

    What it returns was walked and measured as any other. Where not even stepping on the spot is possible, it is that
    walk, refused; then the body's pose, the step height or the cycle must change.

    Raises:
        InvalidInputError, UnknownNameError: See `walk`.
    """
    best = walk(robot, command.at_speed(0.0), legs=legs, tolerances=tolerances)
    if not best.walkable or not (any(command.velocity) or command.turn):
        return best
    slow, fast = 0.0, 1.0
    while (
        fast < _SHARES[1] and (tried := walk(robot, command.at_speed(fast), legs=legs, tolerances=tolerances)).walkable
    ):
        best, slow, fast = tried, fast, 2.0 * fast
    while fast - slow > _SHARE * fast and fast > _SHARES[0]:
        middle = 0.5 * (slow + fast)
        tried = walk(robot, command.at_speed(middle), legs=legs, tolerances=tolerances)
        if tried.walkable:
            best, slow = tried, middle
        else:
            fast = middle
    return best


def _measured(chains: Mapping[str, Chain], q: Floats, T_world_body: Floats) -> Floats:
    """Where the feet are in the world (N, L, 3), by the forward kinematics of the chains themselves."""
    feet = [[chain.pose(row).translation for row in q[:, 3 * k : 3 * k + 3]] for k, chain in enumerate(chains.values())]
    return np.asarray(np.einsum("nij,lnj->nli", T_world_body[:, :3, :3], np.array(feet)) + T_world_body[:, None, :3, 3])


def _missed(found: BodyBatchResult, attempt: Trajectory, tolerances: Tolerances) -> list[Refusal]:
    """Feet out of reach; one that a joint's range keeps from its place has that joint outside of it."""
    refused = []
    for k, leg in enumerate(found.legs):
        missed, times = found.misses_by[:, k], attempt.times
        refused += refusal_where(missed > 0.0, missed, times, f"foot {leg}", "too far", "m")
        refused += refusal_where(missed < 0.0, -missed, times, f"foot {leg}", "too near", "m")
        astray = ~found.solved[:, k] & (missed == 0.0) & (found.position_error[:, k] > tolerances.position)
        refused += refusal_where(astray, found.position_error[:, k], times, f"foot {leg}", "off its place", "m")
    return refused


def _slip(feet: Floats, down: NDArray[np.bool_]) -> float:
    """Farthest that a foot is from where it began to stand, while it stands [m]."""
    farthest = 0.0
    for k in range(down.shape[1]):
        began = np.flatnonzero(down[:, k] & ~np.r_[False, down[:-1, k]])
        stretch = np.cumsum(np.isin(np.arange(len(down)), began)) - 1
        moved = np.linalg.norm(feet[:, k] - feet[began[np.maximum(stretch, 0)], k], axis=1)
        farthest = max(farthest, float(moved[down[:, k]].max(initial=0.0)))
    return farthest


def _between(chains: Mapping[str, Chain], q: Floats, plan: WalkPlan, times: Floats) -> float:
    """Farthest that a standing foot is from its place half-way between two samples [m]."""
    T, wanted, down = plan.at(0.5 * (times[1:] + times[:-1]))
    middle, R, t = 0.5 * (q[1:] + q[:-1]), T[:, :3, :3], T[:, :3, 3]
    places = [chain.poses(middle[:, 3 * k : 3 * k + 3])[:, :3, 3] for k, chain in enumerate(chains.values())]
    feet = np.stack([np.einsum("nij,nj->ni", R, place) + t for place in places], axis=1)
    return float(np.linalg.norm(feet - wanted, axis=2)[down].max(initial=0.0))


def hexapod_legs(robot: Robot, legs: Mapping[str, Chain] | None) -> dict[str, Chain]:
    """The six legs in the order of `footfall.LEGS`: those given, or the robot's chains ``leg_…``.

    Raises:
        InvalidInputError: A leg is missing, is no chain of three joints, or does not begin at the robot's root.
        UnknownNameError: A leg of another name; carries near matches.
    """
    if legs is None:
        names = {leg: f"leg_{leg}" for leg in LEGS}
        if absent := [name for name in names.values() if name not in robot.chain_frames]:
            expected = "a hexapod with chains leg_lf to leg_rr, or its legs as legs={'lf': chain, …}"
            raise InvalidInputError("robot", expected, f"{robot.name} without {', '.join(absent)}")
        legs = {leg: robot.chain(name) for leg, name in names.items()}
    for leg in legs:
        if leg not in LEGS:
            raise UnknownNameError("leg", leg, LEGS, "legs")
    for leg in LEGS:
        if leg not in legs:
            raise InvalidInputError("legs", "six legs", f"none for {leg}")
        if (base := legs[leg].base_name) != robot.root or len(legs[leg].joints) != 3:
            expected = f"three joints from {robot.root} to the foot"
            raise InvalidInputError(f"leg {leg}", expected, f"{len(legs[leg].joints)} from {base}")
    return {leg: legs[leg] for leg in LEGS}


@dataclass(frozen=True, eq=False, slots=True)
class WalkPlan:
    """Body and feet over time; time 0 is the first lift-off.

    Attributes:
        command: What was asked for.
        homes: Where the feet usually are under the body, in its axes (6, 2) [m].
        steps: The steps of each leg.
        lean: How long the body takes to its pose before the first step, and back after the last [s].
        end: When the last foot has landed and the body stands still [s].
    """

    command: WalkCommand
    homes: Floats
    steps: tuple[Steps, ...]
    lean: float
    end: float

    @classmethod
    def of(cls, command: WalkCommand, chains: Mapping[str, Chain]) -> WalkPlan:
        """The plan of a command for the legs in the order of `nao_kin.motion.hexapod.footfall.LEGS`."""
        homes = np.array([_home(chain, command.spread) for chain in chains.values()])
        planned = tuple(
            steps(command.course, command.rhythm, command.period, leg, home)
            for leg, home in zip(chains, homes, strict=True)
        )
        end = max([command.duration, *(float(each.land[-1]) for each in planned)])
        return cls(command, homes, planned, command.period if any(command.body) else 0.0, end)

    @property
    def standing(self) -> Floats:
        """Where the feet are before the first step (6, 3) [m]."""
        return np.column_stack([self.homes, np.zeros(len(self.homes))])

    def sample_times(self) -> Floats:
        """Every `sample_time` from standing to standing, and the end itself (N,) [s]."""
        step, last = self.command.sample_time, self.end + self.lean
        count = int(np.floor((last + self.lean) / step + 1e-9))
        times = np.asarray(step * np.arange(count + 1) - self.lean, dtype=np.float64)
        if last - times[-1] > 1e-9 * step:
            return np.append(times, last)
        times[-1] = last
        return times

    def at(self, time: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """T_world_body (N, 4, 4), the feet in the world (N, 6, 3) [m] and which of them are on the ground (N, 6)."""
        feet, down = zip(*(each.at(time, self.command.step_height) for each in self.steps), strict=True)
        return self._bodies(time), np.stack(feet, axis=1), np.stack(down, axis=1)

    def _bodies(self, time: Floats) -> Floats:
        offset, T = np.array(self.command.body), np.empty((len(time), 4, 4))
        rows = zip(self.command.course.poses(time).tolist(), self._leaning(time).tolist(), strict=True)
        for i, ((x, y, heading), share) in enumerate(rows):
            usual = pin.SE3(rotation_z(heading).rotation, np.array([x, y, self.command.height]))
            T[i] = (usual * from_xyz_rpy(share * offset[:3], share * offset[3:])).homogeneous
        return T

    def _leaning(self, time: Floats) -> Floats:
        """How much of its pose the body has taken up (N,), from 0 to 1."""
        if not self.lean:
            return np.ones(len(time))
        u = np.clip(np.minimum(time + self.lean, self.end + self.lean - time) / self.lean, 0.0, 1.0)
        return minimum_jerk(u)


def _home(chain: Chain, spread: float) -> Floats:
    """Where a foot is that stands straight out from its coxa axis, seen from above (2,) [m]."""
    zero = np.zeros(len(chain.joints))
    coxa, foot = chain.link_poses(zero)[0][:2, 3], chain.pose(zero).translation[:2]
    return np.asarray(coxa + spread * (foot - coxa) / np.linalg.norm(foot - coxa))
