"""A NAO points at something: an arm whose hand axis passes through a point, and a head that looks at it.

The arm starts from a stretched guess towards the point, so that the gesture is one, and its inverse kinematics wants
the hand's x axis to point from where the hand then is to the point; as the hand moves, the direction is taken again.
The head is solved in closed form with the camera's real place (`nao_kin.analytic.nao.looking`). Both are measured by
the whole robot's forward kinematics. Nothing here looks whether the arm meets the body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NoReturn, TypeAlias

import numpy as np

from nao_kin.analytic.form import Mismatch
from nao_kin.analytic.nao.looking import gaze, look_at
from nao_kin.analytic.nao.nao_arm import recognise
from nao_kin.analytic.solutions import nearest
from nao_kin.arrays import positive, vector
from nao_kin.chain import into_limits
from nao_kin.errors import InvalidInputError
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.single import solve
from nao_kin.motion.feasible import Attempted, Refusal, refusals, said
from nao_kin.motion.loop.profile import PEAK, minimum_jerk
from nao_kin.robot.motors import Motors
from nao_kin.tolerances import TOLERANCES, Tolerances
from nao_kin.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["Arm", "Pointing", "point_at"]

Arm: TypeAlias = Literal["left", "right"]

_TORSO: Final = "torso"
_HURRY: Final = 0.5  # share of a joint's greatest speed that a gesture uses where no duration is asked for
_SHORTEST: Final = 0.5  # [s]
_MOST_SAMPLES: Final = 200_000
_AIMS: Final = 50  # directions taken again, at most
_AIMED: Final = 1e-9  # [rad]
_SLOW: Final = 0.7  # an aim that leaves more than this of the angle turns too far
_SMALLEST_SHARE: Final = 1.0 / 16.0
_BETWEEN: Final = 1e-6  # [m] or relative: what is shorter has no direction
_FINE: Final = Tolerances(rotation=1e-10)
_ONE_START: Final = Budget(restarts=0)


@dataclass(frozen=True, eq=False, slots=True)
class Pointing(Attempted):
    """A gesture, measured.

    Attributes:
        arm: Which arm points.
        hand: The arm's result: ``rotation_error`` is the angle by which the hand's axis misses the point, seen from the
            hand [rad].
        head: The head's result, likewise for the camera; None where it cannot look there or was not asked to.
        head_reason: Why it cannot; empty otherwise.
        miss: Distance of the point from the hand's axis [m], by the whole robot's forward kinematics.
        attempt: What the joints would do: every joint of the robot that has a motor.
        refused: What of it cannot be done.
    """

    arm: Arm
    hand: IKResult
    head: IKResult | None
    head_reason: str
    miss: float
    attempt: Trajectory
    refused: tuple[Refusal, ...]

    @property
    def points(self) -> bool:
        """Whether the hand's axis passes through the point before the hand, measured, with all joints in range."""
        return self.hand.solved

    @property
    def looks(self) -> bool:
        """Whether the camera's axis does."""
        return self.head is not None and self.head.solved

    @property
    def message(self) -> str:
        """For people: what points and looks, or why not."""
        if self.refused:
            return f"It cannot be done: {said(self.refused)}"
        looking = "The head looks there." if self.looks else self.head_reason or "The head was left alone."
        aimed = f"The {self.arm} arm points, its axis {self.miss:.2g} m from the point"
        return f"{aimed}, after {self.attempt.duration:.2f} s. {looking}"

    def __bool__(self) -> NoReturn:
        raise TypeError("A Pointing is not a truth value: ask for pointing.points, or whether its trajectory is None.")

    def __repr__(self) -> str:
        return f"<Pointing {self.arm}: {self.message}>"


def point_at(
    robot: Robot,
    point: ArrayLike,
    *,
    frame: str | None = None,
    arm: Arm | None = None,
    posture: Mapping[str, float] | None = None,
    look: bool = True,
    camera: str = "CameraTop_frame",
    duration: float | None = None,
    sample_time: float = 0.01,
    tolerances: Tolerances = TOLERANCES,
) -> Pointing:
    """A gesture: from a posture to one in which an arm points at a point and the head looks at it.

    Args:
        robot: A NAO.
        point: What to point at (3,) [m].
        frame: The frame in which the point is given, where it is in the start posture; the torso by default.
        arm: Which arm; by default the one on the point's side, or the other one where that one cannot.
        posture: Where the motion starts; joints not named are at their neutral values.
        look: Whether the head is to look there too.
        camera: The camera's frame; its x axis looks.
        duration: How long the motion takes [s]; by default as long as half the joints' speeds allow, and at
            least half a second.
        sample_time: Time between samples [s].
        tolerances: When an axis counts as passing through the point, as an angle [rad].

    Raises:
        InvalidInputError: Not three finite numbers, a robot without a NAO's arms or head, or a bad time.
        UnknownNameError: No such frame or joint; carries near matches.
    """
    if arm not in (None, "left", "right"):
        raise InvalidInputError("arm", "'left', 'right' or None", repr(arm))
    start = robot.complete(posture or {})
    p = vector(point, "point", 3)
    p = p if frame is None else robot.pose(start, frame, _TORSO).act(p)
    step = positive(sample_time, "sample_time", "[s]")
    wanted = None if duration is None else positive(duration, "duration", "[s]")
    side, hand = _pointing(robot, p, arm, start, tolerances)
    head, reason = _looking(robot, p, camera, start, tolerances) if look else (None, "")
    end = robot.complete(start | hand.posture | (head.posture if head is not None else {}))
    attempt = _gesture(robot, start, end, wanted, step)
    refused = refusals(attempt, robot.limit_rules, tolerances)
    if not hand.solved:
        time = float(attempt.times[-1])
        angle = hand.rotation_error or 0.0
        refused = (Refusal(f"{side} arm", "off its aim", time, angle, "rad", time), *refused)
    return Pointing(side, hand, head, reason, _miss(robot, end, hand, p), attempt, refused)


def _pointing(
    robot: Robot, p: Floats, arm: Arm | None, start: Mapping[str, float], tolerances: Tolerances
) -> tuple[Arm, IKResult]:
    """The arm that points, the better one where neither does."""
    first: Arm = arm or ("left" if p[1] >= 0.0 else "right")
    sides: list[Arm] = [first] if arm else [first, "right" if first == "left" else "left"]
    found: list[tuple[Arm, IKResult]] = []
    for side in sides:
        found.append((side, _aimed(_arm(robot, side), p, start, tolerances)))
        if found[-1][1].solved:
            return found[-1]
    return min(found, key=lambda each: each[1].rotation_error or 0.0)


def _arm(robot: Robot, side: Arm) -> UrdfChain:
    if f"{side}_arm" not in robot.chain_frames:
        raise InvalidInputError("robot", "a NAO, with left_arm and right_arm", robot.name)
    chain = robot.chain(f"{side}_arm")
    joints = len(chain.joints)
    shape = recognise(chain.joint_path, joints) if joints in (4, 5) else Mismatch(f"{joints} joints")
    if isinstance(shape, Mismatch) or chain.base != _TORSO:
        reason = shape.reason if isinstance(shape, Mismatch) else f"it begins at {chain.base}"
        raise InvalidInputError(f"{side} arm", "a NAO's arm", f"{chain.name}: {reason}")
    return chain


def _aimed(chain: UrdfChain, p: Floats, start: Mapping[str, float], tolerances: Tolerances) -> IKResult:
    """The first start from which the arm comes to point; else the attempt whose axis misses by the least angle."""
    now = chain.q_of(start)
    starts = (_towards(chain, p, now), now, _elbow_at_side(chain, now))
    attempts = []
    for q0, budget in (*((q0, _ONE_START) for q0 in starts), (now, Budget())):
        attempts.append(_aimed_from(chain, p, into_limits(chain, q0), budget, tolerances))
        if attempts[-1].solved:
            return attempts[-1]
    return min(attempts, key=lambda result: result.rotation_error or 0.0)


def _towards(chain: UrdfChain, p: Floats, now: Floats) -> Floats:
    """The arm with its elbow straight and its upper arm towards the point: pitch about y, then roll about z."""
    q = now.copy()
    x, y, z = p - chain.link_poses(now)[0][:3, 3]
    q[0], q[1], q[3] = math.atan2(-z, x), math.atan2(y, math.hypot(x, z)), 0.0
    return q


def _elbow_at_side(chain: UrdfChain, now: Floats) -> Floats:
    """The upper arm down and the forearm forward, for what is nearer than a stretched arm."""
    q = now.copy()
    outward = 1.0 if chain.lower[3] < -0.5 else -1.0  # the left elbow bends to −, the right one to +
    q[:4] = 0.5 * math.pi, 0.0, -0.5 * math.pi * outward, -1.2 * outward
    return q


def _aimed_from(chain: UrdfChain, p: Floats, q: Floats, budget: Budget, tolerances: Tolerances) -> IKResult:
    """Turns the hand's axis to the point from where the hand is, until the hand's own motion no longer matters.

    Where the point is so near that the hand moves farther round it than the axis has still to turn, the axis is turned
    by a part of the way only.
    """
    share, best, least = 1.0, q, _angle(chain, q, p)
    for _ in range(_AIMS):
        axis, towards = _axis(chain, q, p)
        if least < _AIMED or not towards.any():
            break
        direction = (1.0 - share) * axis + share * towards
        if np.linalg.norm(direction) < _BETWEEN:  # half-way to the opposite direction there is none
            direction = towards
        q = solve(chain, gaze(direction), q, budget=budget, tolerances=_FINE).q
        angle = _angle(chain, q, p)
        if angle > _SLOW * least:
            share = max(0.5 * share, _SMALLEST_SHARE)
        if angle < least:
            best, least = q, angle
    _, towards = _axis(chain, best, p)
    target = gaze(towards if towards.any() else (1.0, 0.0, 0.0))
    ended = Status.SOLVED if towards.any() else Status.STALLED
    return judge(Problem(chain, target, tolerances), Run(best.copy(), ended))


def _axis(chain: UrdfChain, q: Floats, p: Floats) -> tuple[Floats, Floats]:
    """The hand's axis and the direction from the hand to the point, unit vectors (3,); zero where the two meet."""
    T = chain.pose(q)
    towards = p - T.translation
    length = float(np.linalg.norm(towards))
    return T.rotation[:, 0], towards / length if length > _BETWEEN else np.zeros(3)


def _angle(chain: UrdfChain, q: Floats, p: Floats) -> float:
    axis, towards = _axis(chain, q, p)
    return math.atan2(float(np.linalg.norm(np.cross(axis, towards))), float(axis @ towards))


def _looking(
    robot: Robot, p: Floats, camera: str, start: Mapping[str, float], tolerances: Tolerances
) -> tuple[IKResult | None, str]:
    chain = robot.chain(_TORSO, camera)
    solutions = look_at(chain, p, tolerances=tolerances)
    if not solutions.solved:
        return None, f"The head cannot look there: {solutions.reason}"
    return nearest(solutions.solved, chain.q_of(start)), ""


def _gesture(
    robot: Robot, start: Mapping[str, float], end: Mapping[str, float], duration: float | None, step: float
) -> Trajectory:
    """All joints from start to end together, at rest at both; on the way, coupled ranges bend the straight line.

    A head that turns to the side and nods would leave the coupled range in between, though both ends are in it.
    """
    joints = Motors.of(robot).joints
    here, there = (np.array([posture[joint.name] for joint in joints]) for posture in (start, end))
    speeds = np.array([joint.max_velocity for joint in joints])
    if duration is None:
        duration = max(_SHORTEST, PEAK / _HURRY * float((np.abs(there - here) / speeds).max()))
    count = math.ceil(duration / step - 1e-9)
    if count > _MOST_SAMPLES:
        raise InvalidInputError("sample_time", f"at most {_MOST_SAMPLES} samples", f"{count} of {step:g} s")
    times = np.append(step * np.arange(count), duration).astype(np.float64)
    q = here + minimum_jerk(times / duration)[:, None] * (there - here)
    q[-1] = there
    columns = {joint.name: k for k, joint in enumerate(joints)}
    for rule in robot.limit_rules:
        if rule.joint in columns and rule.by in columns:
            values = q[:, columns[rule.joint]]
            kept = np.array(
                [np.clip(value, *rule.range(by)) for value, by in zip(values, q[:, columns[rule.by]], strict=True)]
            )
            if kept[0] == values[0] and kept[-1] == values[-1]:  # an end that is outside is refused and not moved
                q[:, columns[rule.joint]] = kept
    return Trajectory(joints, times, q, "pointing")


def _miss(robot: Robot, end: Mapping[str, float], hand: IKResult, p: Floats) -> float:
    """Distance of the point from the ray along the hand's x axis [m]."""
    T_torso_hand = robot.pose(end, hand.problem.chain.tip_name, _TORSO)
    seen = T_torso_hand.actInv(p)
    return float(np.linalg.norm(seen[1:] if seen[0] > 0.0 else seen))
