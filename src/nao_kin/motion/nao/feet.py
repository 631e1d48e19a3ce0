"""Both feet of a robot whose legs share the motor of their first hip joint, as NAO's HipYawPitch.

Two poses are twelve wishes, and the legs have eleven motors. Either foot alone can be placed exactly, each with its own
angle of the shared joint; together they can only if the two angles happen to agree. So the angle is chosen between the
two, and each foot gives up a little of its orientation:

1. Each leg is solved in closed form (`nao_kin.analytic.nao.nao_leg`), which says the shared angle that its foot wants.
2. For any angle between these two, each foot keeps its position and takes the orientation nearest to the wanted one
   that goes with the angle. A foot's pose goes with an angle where the hip's roll axis, the line from hip to ankle and
   the ankle's roll axis lie in one plane, which is one equation for the three angles of the orientation, and where the
   leg is long enough (`nao_kin.analytic.nao.leg_yaw`).
3. The angle is the one at which the weighted sum of the two squared errors is least. Where a joint would be outside
   its range there, it is the best of those at which none is.

Another way to choose is a blend of the two wanted angles by a fixed ratio, as B-Human's walk does; here the ratio
follows from the errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Literal, NoReturn

import numpy as np
import pinocchio as pin

from nao_kin.analytic.form import Mismatch
from nao_kin.analytic.nao.leg_yaw import Hinges, hinges, nearest_orientation
from nao_kin.analytic.nao.nao_leg import ANY_YAW, BRANCHES, LABELS, recognise, solve_with_yaw
from nao_kin.arrays import frozen, vector
from nao_kin.chain import into_limits, outside_limits
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.target import Target
from nao_kin.motion.feasible import Attempted, Refusal, refusal_where, refusals, said
from nao_kin.robot.motors import Motors
from nao_kin.se3 import PoseLike, as_pose, rotation_distance, rotation_z
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain, OutsideLimit
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["BENT_KNEES", "FeetResult", "TorsoMotion", "both_feet", "torso_motion", "wanted_angles"]

_BESIDE: Final = 1e-9  # [m] an ankle this near to the plane of the thigh is in it
_ANGLE_RESOLUTION: Final = 1e-10  # [rad] to which the shared angle is found
_SCAN: Final = 65  # angles tried between the two wanted ones where the best one brings a joint outside its range
_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, eq=False, slots=True)
class FeetResult:
    """Joints of both legs, measured.

    Attributes:
        left: The left foot's result against its wanted pose.
        right: The right foot's.
        shared: The angle of the shared joint [rad].
        wanted: The angles that the left and the right foot want [rad].
    """

    left: IKResult
    right: IKResult
    shared: float
    wanted: tuple[float, float]

    @property
    def solved(self) -> bool:
        """Whether both feet are where and as they are wanted, measured, with every joint within its limits."""
        return self.left.solved and self.right.solved

    @property
    def posture(self) -> dict[str, float]:
        """The joints of both legs by name [rad]; the shared joint under both of its names."""
        return self.left.posture | self.right.posture

    @property
    def position_errors(self) -> tuple[float, float]:
        """Distances of the left and the right foot from where they are wanted [m]."""
        return self.left.position_error or 0.0, self.right.position_error or 0.0

    @property
    def rotation_errors(self) -> tuple[float, float]:
        """Angles of the left and the right foot from how they are wanted [rad]."""
        return self.left.rotation_error or 0.0, self.right.rotation_error or 0.0

    @property
    def outside(self) -> tuple[OutsideLimit, ...]:
        """Joints of both legs outside their own or their coupled ranges."""
        return self.left.outside + self.right.outside

    @property
    def message(self) -> str:
        """For people: the angle chosen, and what each foot gives up for it."""
        said = [f"The shared joint is at {self.shared:.6g} rad; the feet want {self.wanted[0]:.6g} and "]
        said[0] += f"{self.wanted[1]:.6g} rad."
        for foot, far, turned in zip(("left", "right"), self.position_errors, self.rotation_errors, strict=True):
            said.append(f"The {foot} foot is off by {far:.3g} m and {turned:.3g} rad.")
        return " ".join(said + [f"{outside}." for outside in self.outside])

    def __bool__(self) -> NoReturn:
        raise TypeError("A FeetResult is not a truth value: ask for result.solved.")

    def __repr__(self) -> str:
        return f"<FeetResult: {self.message}>"


def both_feet(
    left: Chain,
    right: Chain,
    T_base_left: PoseLike,
    T_base_right: PoseLike,
    *,
    weights: tuple[float, float] = (1.0, 1.0),
    near: Mapping[str, float] | None = None,
    tolerances: Tolerances = TOLERANCES,
) -> FeetResult:
    """Joints of both legs for two wanted feet, the first joints of the two legs turning by the same angle.

    Positions are kept and orientations approached as well as one motor allows; what is left is measured by forward
    kinematics and reported. The rule is that of the module. An error of a foot is its angle [rad], and where no
    orientation nearby lets it keep its position, or its wanted pose is out of reach, also its distance over the length
    of the leg.

    Args:
        left: Chain of six joints from the torso to the left foot.
        right: The same to the right foot; its first joint takes the same value as the left leg's.
        T_base_left: The wanted pose of the left chain's tip in the torso's frame.
        T_base_right: The wanted pose of the right chain's tip.
        weights: How much the squared errors of the left and the right foot count.
        near: Joints by name [rad]: of several branches within limits, each leg takes the one nearest to these. By
            default all zeros, moved into the limits.
        tolerances: When a foot counts as solved.

    Raises:
        InvalidInputError: Not poses, chains that are no such legs of one torso, or weights below 0 or both 0.
        UnknownNameError: `near` names a joint of neither leg.
    """
    weight = np.asarray(weights, dtype=np.float64)
    if weight.shape != (2,) or not (weight >= 0.0).all() or not 0.0 < weight.sum() < math.inf:
        raise InvalidInputError("weights", "two numbers ≥ 0, not both 0", repr(weights))
    feet = _feet(left, right, T_base_left, T_base_right, near, tolerances)
    wanted = _wanted(feet)
    shared = _best_angle(feet, wanted, weight)
    results = [foot.judged(foot.at(shared)) for foot in feet]
    return FeetResult(results[0], results[1], shared, wanted)


def wanted_angles(
    left: Chain, right: Chain, T_base_left: PoseLike, T_base_right: PoseLike, near: Mapping[str, float] | None = None
) -> tuple[float, float]:
    """The angles of the shared joint that the left and the right foot want [rad]; both feet are met if they agree.

    A foot out of reach wants the angle of the pose that comes nearest.

    Raises:
        InvalidInputError, UnknownNameError: See `both_feet`.
    """
    return _wanted(_feet(left, right, T_base_left, T_base_right, near, TOLERANCES))


def _feet(
    left: Chain,
    right: Chain,
    T_base_left: PoseLike,
    T_base_right: PoseLike,
    near: Mapping[str, float] | None,
    tolerances: Tolerances,
) -> tuple[_Foot, _Foot]:
    if left.base_name != right.base_name:
        raise InvalidInputError("legs", "two legs of one torso", f"the bases {left.base_name} and {right.base_name}")
    for name in near or ():
        if name not in left.joint_names + right.joint_names:
            raise UnknownNameError("joint", name, left.joint_names + right.joint_names, "near")
    return (
        _Foot.of("left", left, as_pose(T_base_left, "T_base_left"), near, tolerances),
        _Foot.of("right", right, as_pose(T_base_right, "T_base_right"), near, tolerances),
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Foot:
    """One leg and what is wanted of it.

    Attributes:
        problem: The leg, the wanted pose of its foot and the tolerances.
        parameters: The leg's numbers for the kernel.
        hinges: Its hip and ankle.
        near: Joints to stay near to (6,) [rad].
        longest: How far the ankle may be from the hip [m]; infinitely far if the wanted pose is out of reach anyway.
    """

    problem: Problem
    parameters: Floats
    hinges: Hinges
    near: Floats
    longest: float = math.inf

    @classmethod
    def of(cls, side: str, chain: Chain, T: pin.SE3, near: Mapping[str, float] | None, tolerances: Tolerances) -> _Foot:
        geometry, points = recognise(chain.joint_path), hinges(chain.joint_path)
        if isinstance(geometry, Mismatch) or isinstance(points, Mismatch):
            reason = next(each.reason for each in (points, geometry) if isinstance(each, Mismatch))
            raise InvalidInputError(f"{side} leg", "a leg as NAO's, from torso to foot", f"{chain.name}: {reason}")
        if abs(points.beside) > _BESIDE:
            got = f"one {abs(points.beside):.3g} m beside it in {chain.name}"
            raise InvalidInputError(f"{side} leg", "an ankle in the plane of the thigh", got)
        start = np.zeros(6)
        if near is not None:
            start = vector([near.get(name, 0.0) for name in chain.joint_names], f"near, {side} leg", 6)
        problem = Problem(chain, Target.pose(T), tolerances)
        foot = cls(problem, geometry.parameters, points, into_limits(chain, start))
        in_reach = len(foot.solutions(problem.target.goal, math.nan, 0.0)) > 0
        return replace(foot, longest=points.thigh + points.shank) if in_reach else foot

    def solutions(self, T_base_tip: Floats, yaw: float, slack: float) -> Floats:
        """Rows of the kernel, see `nao_kin.analytic.form.ClosedForm`."""
        rows = np.empty((BRANCHES, 8))
        count = solve_with_yaw(self.parameters, T_base_tip, yaw, slack, rows)
        return rows[:count]

    def chosen(self, rows: Floats) -> Floats:
        """The row within limits that is nearest to `near`; without any, the one that is least outside."""
        chain = self.problem.chain
        costs = []
        for row in rows:
            outside = outside_limits(chain, row[:6], self.problem.tolerances.limits)
            excess = max((max(o.lower - o.value, o.value - o.upper) for o in outside), default=0.0)
            move = np.abs(np.remainder(row[:6] - self.near + math.pi, 2.0 * math.pi) - math.pi).max()
            costs.append((excess, move))
        best: Floats = rows[min(range(len(rows)), key=costs.__getitem__)]
        return best

    def at(self, shared: float) -> Floats:
        """The row of the leg's joints with its first one at an angle."""
        T, bones = self.problem.target.goal.copy(), self.hinges
        x = pin.exp3(shared * bones.yaw_axis) @ bones.roll_axis
        T[:3, :3] = nearest_orientation(x, bones.hip, bones.ankle, bones.foot_axis, self.longest, T)
        row = self.chosen(self.solutions(T, shared, math.inf))
        row[0] = shared  # as it was given, to the last bit, whatever the leg's own offset made of it
        return row

    def error_squared(self, q: Floats) -> float:
        """Squared error [rad²]: angle, and distance over the length of the leg."""
        R, p = self.problem.chain.tip_at(q)
        goal = self.problem.target.goal
        far = float(np.linalg.norm(p - goal[:3, 3])) / (self.hinges.thigh + self.hinges.shank)
        return float(np.linalg.norm(pin.log3(R @ goal[:3, :3].T))) ** 2 + far * far

    def inside(self, q: Floats) -> bool:
        return not outside_limits(self.problem.chain, q, self.problem.tolerances.limits)

    def judged(self, row: Floats) -> IKResult:
        """The joints of a row, measured against the wanted pose."""
        goal, bones = self.problem.target.goal, self.hinges
        run = Run(row[:6].copy(), Status.STALLED, branch=LABELS[int(row[6])])
        if self.longest == math.inf:  # not even with a motor of its own
            distance = float(np.linalg.norm(goal[:3, :3] @ bones.ankle + goal[:3, 3] - bones.hip))
            run.ended = Status.OUT_OF_REACH
            run.misses_by = max(distance - bones.thigh - bones.shank, abs(bones.thigh - bones.shank) - distance)
        return judge(self.problem, run)


def _wanted(feet: tuple[_Foot, _Foot]) -> tuple[float, float]:
    """The angle of the shared joint that each foot wants [rad]; a foot that takes any wants the other one's."""
    left, right = (foot.chosen(foot.solutions(foot.problem.target.goal, math.nan, math.inf)) for foot in feet)
    free = [bool(int(row[7]) & ANY_YAW) for row in (left, right)]
    return float(right[0] if free[0] else left[0]), float(left[0] if free[1] and not free[0] else right[0])


def _best_angle(feet: tuple[_Foot, _Foot], wanted: tuple[float, float], weights: Floats) -> float:
    """The angle between the two wanted ones at which the weighted sum of squared errors is least."""
    lower = max(float(foot.problem.chain.lower[0]) for foot in feet)
    upper = min(float(foot.problem.chain.upper[0]) for foot in feet)
    start, end = sorted(min(max(angle, lower), upper) for angle in wanted)

    def cost(shared: float, outside: float = 0.0) -> float:
        total = 0.0
        for foot, weight in zip(feet, weights.tolist(), strict=True):
            row = foot.at(shared)
            total += weight * foot.error_squared(row[:6]) + (0.0 if not outside or foot.inside(row[:6]) else outside)
        return total

    best = _least(cost, start, end)
    if all(foot.inside(foot.at(best)[:6]) for foot in feet):
        return best

    def within_limits(shared: float) -> float:
        return cost(shared, outside=math.inf)

    tried = np.linspace(start, end, _SCAN)
    costs = [within_limits(float(angle)) for angle in tried]
    k = int(np.argmin(costs))
    if costs[k] == math.inf:
        return best
    # From a place within the limits towards the least error; beyond them everything costs infinitely much.
    return _least(within_limits, float(tried[max(k - 1, 0)]), float(tried[min(k + 1, _SCAN - 1)]), float(tried[k]))


def _least(cost: Callable[[float], float], start: float, end: float, inside: float | None = None) -> float:
    """Where a function with one valley is least, by golden section; among the places tried, the best one."""
    left, right = end - _GOLDEN * (end - start), start + _GOLDEN * (end - start)
    at_left, at_right = cost(left), cost(right)
    tried = [(cost(place), place) for place in ((start, end) if inside is None else (start, end, inside))]
    while end - start > _ANGLE_RESOLUTION:
        tried += [(at_left, left), (at_right, right)]
        if at_left < at_right or (at_left == at_right and inside is not None and inside <= left):
            end, right, at_right = right, left, at_left
            left = end - _GOLDEN * (end - start)
            at_left = cost(left)
        else:
            start, left, at_left = left, right, at_right
            right = start + _GOLDEN * (end - start)
            at_right = cost(right)
    return min(tried)[1]


BENT_KNEES: Final = {
    f"{side}{joint}": value
    for side in "LR"
    for joint, value in (("HipPitch", -0.4), ("KneePitch", 0.8), ("AnklePitch", -0.4))
}
"""Legs with which a NAO's torso has room to move [rad]: soles level, knees bent by 0.8 rad."""

_AGREED: Final = 1e-11  # [rad] between the angles that the two feet want
_STEPS: Final = 30
_FIRST_STEP: Final = 1e-3  # [rad]


@dataclass(frozen=True, eq=False, slots=True)
class TorsoMotion(Attempted):
    """A motion of the torso over feet that stay, measured by the whole robot's forward kinematics.

    Attributes:
        attempt: What the joints would do: every joint of the robot that has a motor.
        position_errors: How far the left and the right foot are from where they stood (N, 2) [m].
        rotation_errors: By which angle they have turned (N, 2) [rad].
        yaw: By how much the torso is turned about its own z axis against what was wanted (N,) [rad].
        refused: What of it cannot be done.
    """

    attempt: Trajectory
    position_errors: Floats
    rotation_errors: Floats
    yaw: Floats
    refused: tuple[Refusal, ...]

    @property
    def message(self) -> str:
        """For people: what was measured, or why it is refused."""
        measured = (
            f"Feet stay within {self.position_errors.max():.2g} m and {self.rotation_errors.max():.2g} rad; "
            f"the torso's yaw gives way by up to {np.abs(self.yaw).max():.2g} rad."
        )
        return f"It cannot be done: {said(self.refused)} {measured}" if self.refused else measured

    def __bool__(self) -> NoReturn:
        raise TypeError("A TorsoMotion is not a truth value: ask whether motion.trajectory is None.")

    def __repr__(self) -> str:
        return f"<TorsoMotion: {self.message}>"


def torso_motion(
    robot: Robot,
    times: ArrayLike,
    T_start_torso: Sequence[PoseLike] | Floats,
    *,
    posture: Mapping[str, float] | None = None,
    give: Literal["feet", "yaw"] = "feet",
    weights: tuple[float, float] = (1.0, 1.0),
    frames: tuple[str, str, str] = ("torso", "l_sole", "r_sole"),
    tolerances: Tolerances = TOLERANCES,
) -> TorsoMotion:
    """Moves the torso over both feet, which stay where the start posture has them.

    Args:
        robot: A NAO, or another robot with such legs.
        times: When (N,) [s], strictly increasing.
        T_start_torso: Wanted poses of the torso (N), each seen from where it is in the start posture: identity is that.
        posture: The start posture; joints not named are at their neutral values. By default with `BENT_KNEES`.
        give: What gives way to the motor that both hips share; see the module.
        weights: With ``give="feet"``, how much the squared errors of the left and the right foot count.
        frames: Torso, left and right foot.
        tolerances: How far a foot may be from its place [m].

    Raises:
        InvalidInputError: Not poses, times that do not fit them or stand still, no such legs, or another `give`.
        UnknownNameError: No such frame or joint; carries near matches.
    """
    if give not in ("feet", "yaw"):
        raise InvalidInputError("give", "'feet' or 'yaw'", repr(give))
    if not isinstance(T_start_torso, Sequence | np.ndarray):
        raise InvalidInputError("T_start_torso", "a sequence of poses", repr(T_start_torso)[:60])
    wanted = [as_pose(T, f"T_start_torso, row {i}") for i, T in enumerate(T_start_torso)]
    instants = vector(times, "times", len(wanted))
    start = robot.complete(BENT_KNEES if posture is None else posture)
    base, *soles = frames
    legs, stood = [robot.chain(base, sole) for sole in soles], [robot.pose(start, sole, base) for sole in soles]
    joints, near = Motors.of(robot).joints, {name: start[name] for leg in legs for name in leg.joint_names}
    q, yaw = np.tile([start[joint.name] for joint in joints], (len(wanted), 1)), np.zeros(len(wanted))
    columns = {joint.name: k for k, joint in enumerate(joints)}
    turned = []
    for i, T in enumerate(wanted):
        yaw[i] = _agreeing_yaw(legs, T, stood, near, yaw[i - 1] if i else 0.0) if give == "yaw" else 0.0
        turned.append(T * rotation_z(yaw[i]))
        left, right = (turned[i].actInv(foot) for foot in stood)
        near = both_feet(legs[0], legs[1], left, right, weights=weights, near=near, tolerances=tolerances).posture
        for name, value in near.items():
            if name in columns:
                q[i, columns[name]] = value
    attempt = Trajectory(joints, instants, q, f"{robot.name} torso")
    far, angle = _measured(robot, attempt, turned, stood, frames)
    missed = [
        refusal
        for k, sole in enumerate(soles)
        for refusal in refusal_where(far[:, k] > tolerances.position, far[:, k], instants, sole, "off its place", "m")
    ]
    refused = (*missed, *refusals(attempt, robot.limit_rules, tolerances))
    return TorsoMotion(attempt, frozen(far), frozen(angle), frozen(yaw), refused)


def _agreeing_yaw(
    legs: list[UrdfChain], T_start_torso: pin.SE3, stood: list[pin.SE3], near: Mapping[str, float], guess: float
) -> float:
    """The turn of the torso about its z axis at which both feet want the same angle, by the secant method [rad].

    Where it does not converge, the last guess: what is left then is seen by the measurement.
    """

    def disagreement(yaw: float) -> float:
        T = T_start_torso * rotation_z(yaw)
        angles = wanted_angles(legs[0], legs[1], T.actInv(stood[0]), T.actInv(stood[1]), near)
        return angles[0] - angles[1]

    before, at = guess, guess + _FIRST_STEP
    value_before, value = disagreement(before), disagreement(at)
    if abs(value_before) < _AGREED:
        return before
    for _ in range(_STEPS):
        if abs(value) < _AGREED or value == value_before:
            return at
        before, at = at, at - value * (at - before) / (value - value_before)
        value_before, value = value, disagreement(at)
    return guess


def _measured(
    robot: Robot, attempt: Trajectory, T_start_torso: list[pin.SE3], stood: list[pin.SE3], frames: tuple[str, ...]
) -> tuple[Floats, Floats]:
    """Distances [m] and angles [rad] of the feet from where they stood (N, 2), by the whole robot."""
    far, angle = np.zeros((len(attempt), 2)), np.zeros((len(attempt), 2))
    for i, T in enumerate(T_start_torso):
        poses = robot.link_poses(attempt.posture(i))
        for k, foot in enumerate(stood):
            T_start_foot = T * poses[frames[0]].actInv(poses[frames[1 + k]])
            far[i, k] = np.linalg.norm(T_start_foot.translation - foot.translation)
            angle[i, k] = rotation_distance(T_start_foot, foot)
    return far, angle
