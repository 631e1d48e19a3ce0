"""What can be put on a page: a robot in one posture or several, a motion, results, a comparison, a chain."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias, Union, cast

import numpy as np

from nao_kin.chain import Chain, OutsideLimit
from nao_kin.errors import InvalidInputError
from nao_kin.robot.robot import Robot
from nao_kin.view.chain_ends import with_ends
from nao_kin.view.robot_scene import robot_scene
from nao_kin.view.scene import Curve, NamedPosture, Panel, Scene, SceneChain, SceneGoal, SceneMotion
from nao_kin.view.workspace_scene import with_workspace

if TYPE_CHECKING:
    from nao_kin.analytic.solutions import Solutions
    from nao_kin.arrays import Floats
    from nao_kin.crosscheck import Comparison
    from nao_kin.ik.problem import IKResult
    from nao_kin.ik.target import Target
    from nao_kin.ik.tips.tree_problem import TreeResult
    from nao_kin.motion.hexapod.gait import Walk
    from nao_kin.robot.tree import Tree
    from nao_kin.trajectory import Trajectory
    from nao_kin.workspace.reach_map import ReachMap

__all__ = ["Content", "Subject", "scene_of"]

Subject: TypeAlias = Union[Robot, "Chain", "IKResult", "TreeResult", "Solutions", "Comparison"]
"""What a page is about."""

Content: TypeAlias = Union[
    "Mapping[str, float]",
    "Mapping[str, Mapping[str, float]]",
    "Trajectory",
    "Walk",
    "ReachMap",
    "IKResult",
    "TreeResult",
    "Solutions",
]
"""What a robot is shown with."""

DIGITS: Final = 9  # of the values of a motion [rad, m]: 1e-9 is a thousandth of what a page promises


def scene_of(subject: Subject, content: Content | None = None, *, explain: bool = False) -> Scene:
    """The scene of anything that has one.

    Args:
        subject: A robot, a chain, a result, all solutions, or a comparison.
        content: For a robot: a posture, named postures, a trajectory, a walk, a map of where a tip can be, or a
            result or solutions of one of its chains; None means its neutral posture.
        explain: Of a comparison: whether to say what accounts for a disagreement, which may have to be searched.

    Raises:
        UnknownNameError: A posture or trajectory names a joint that the robot does not have.
        InvalidInputError: Nothing of the above, values that are not finite or contradict a coupling, no solutions, a
            walk that is refused, or a result of another robot.
    """
    if isinstance(subject, Robot):
        return _robot_with(subject, content)
    if content is not None:
        raise InvalidInputError("content", "a robot before it", f"{type(subject).__name__} and a second thing")
    return _scene(subject, explain)


def _robot_with(robot: Robot, content: Any) -> Scene:
    from nao_kin.motion.hexapod.gait import Walk
    from nao_kin.trajectory import Trajectory
    from nao_kin.workspace.reach_map import ReachMap

    if content is None:
        return robot_scene(robot)
    if isinstance(content, Walk):
        return _walk_scene(robot, content)
    if isinstance(content, ReachMap):
        T_root_base = robot.pose(robot.neutral, content.base_name).homogeneous
        return with_workspace(robot_scene(robot), content, T_root_base)
    if isinstance(content, Trajectory):
        return _trajectory_scene(robot, content)
    if isinstance(content, Mapping):
        return _postures_scene(robot, content)
    scene = _scene(content, explain=False)
    if scene.sha256 != robot.document.sha256:
        raise InvalidInputError("content", f"a result of {robot.name}", f"one of {scene.title}")
    return scene


def _scene(subject: Any, explain: bool) -> Scene:
    from nao_kin.analytic.solutions import Solutions
    from nao_kin.crosscheck import Comparison
    from nao_kin.ik.problem import IKResult
    from nao_kin.ik.tips.tree_problem import TreeResult
    from nao_kin.view.overlay import chain_scene, comparison_scene

    match subject:
        case Comparison():
            return comparison_scene(subject, explain=explain)
        case Solutions():
            return _solutions_scene(subject)
        case IKResult() | TreeResult():
            return _result_scene(subject)
        case Chain():
            return chain_scene(subject)
    expected = (
        "a robot, a chain, an IKResult, Solutions or a Comparison; with a robot also a posture, named postures, a "
        "Trajectory, a Walk or a ReachMap"
    )
    raise InvalidInputError("what to show", expected, repr(subject)[:60])


def _postures_scene(robot: Robot, content: Mapping[str, Any]) -> Scene:
    named = {name: value for name, value in content.items() if isinstance(value, Mapping)}
    if not named:
        return robot_scene(robot, content)
    if len(named) < len(content):
        odd = next(name for name in content if name not in named)
        raise InvalidInputError("postures", "a posture for every name", f"{content[odd]!r} for {str(odd)[:60]!r}")
    expanded = {str(name): robot.expand(posture) for name, posture in named.items()}
    outside = {name: robot.outside_limits(posture) for name, posture in expanded.items()}
    scene = robot_scene(robot, next(iter(expanded.values())))
    return replace(
        scene,
        notes=(
            *(f"Posture {name}, outside its limits: {one}." for name in outside for one in outside[name]),
            *_not_shown(scene),
        ),
        postures=tuple(NamedPosture(name, values, (_limits(outside[name]),)) for name, values in expanded.items()),
        posture_columns=("limits",),
        ghosts=True,
        produced=f"{len(expanded)} named postures",
    )


def _not_shown(scene: Scene) -> tuple[str, ...]:
    """The scene's notes without those on limits, which a list of postures says for each."""
    return tuple(note for note in scene.notes if not note.startswith("Outside its limits"))


def _limits(outside: tuple[OutsideLimit, ...]) -> str:
    return f"outside: {', '.join(one.joint for one in outside)}" if outside else "within"


def _trajectory_scene(robot: Robot, trajectory: Trajectory) -> Scene:
    leaders = {c.follower: c for c in robot.couplings}
    scene = robot_scene(robot, robot.complete(trajectory.posture(0)))
    for name in trajectory.joint_names:  # every sample obeys the couplings, or it would be drawn other than it is
        c = leaders.get(name)
        if c is not None and c.leader in trajectory.joint_names:
            wanted = c.multiplier * trajectory.column(c.leader) + c.offset
            if np.abs(trajectory.column(name) - wanted).max() > 1e-9:
                raise InvalidInputError(f"trajectory, {name}", f"values that follow {c.leader}", "others")
    name = trajectory.name or "trajectory"
    moved = {leaders[joint].leader if joint in leaders else joint for joint in trajectory.joint_names}
    shared = [len(moved & _motors(scene, chain)) for chain in scene.chains]
    tips = sorted((k for k, count in enumerate(shared) if count), key=lambda k: -shared[k])
    motion = SceneMotion(name, trajectory.joint_names, trajectory.times, _rounded(trajectory.q), tips=tuple(tips))
    produced = f"{name}, {len(trajectory)} samples over {trajectory.duration:.4g} s"
    return replace(scene, motion=motion, produced=produced, legs=())


def _walk_scene(robot: Robot, walk: Walk) -> Scene:
    """The joints, and the robot over the ground as the walk has it; where it stands first is where it is drawn."""
    if walk.trajectory is None:
        raise InvalidInputError("walk", "one that can be walked", walk.message.rstrip("."))
    scene = _trajectory_scene(robot, walk.trajectory)
    T_start_root = _rounded(np.linalg.inv(walk.T_world_body[0]) @ walk.T_world_body)
    motion = replace(cast("SceneMotion", scene.motion), body=T_start_root, tips=tuple(range(len(scene.chains))))
    return replace(scene, motion=motion, notes=(*scene.notes, walk.message))


def _motors(scene: Scene, chain: SceneChain) -> set[str]:
    """The joints that move a chain, each by its leader, from its tip down to its base or the root."""
    leaders = {joint.name: joint.leader or joint.name for joint in scene.joints}
    found, index = set(), chain.tip
    while index != chain.base:
        node = scene.nodes[index]
        if node.drive is not None:
            found.add(leaders[node.drive.joint])
        if node.parent is None:
            break
        index = node.parent
    return found


def _space_scene(space: Chain | Tree, q: list[float], targets: Mapping[str, Target]) -> Scene:
    """The robot of a chain or tree at given joints, or the chain alone; with its chains and targets."""
    from nao_kin.robot.tree import Tree
    from nao_kin.view.overlay import chain_scene

    chains = dict(space.chains) if isinstance(space, Tree) else {space.tip_name: space}
    robot: Robot | None = getattr(space, "robot", None)
    if robot is None:
        (chain,) = chains.values()
        scene = chain_scene(chain)
        values = dict(zip(chain.joint_names, q, strict=True))
        joints = tuple(replace(joint, value=values[joint.name]) for joint in scene.joints)
        return replace(scene, joints=joints, goals=tuple(_goal(0, target) for target in targets.values()))
    scene = robot_scene(robot, robot.complete(dict(zip(space.joint_names, q, strict=True))))
    own = []
    for chain in chains.values():
        scene, base, tip = with_ends(scene, chain)
        own.append(SceneChain(_short(chain), base, tip))
    ends = {(chain.base, chain.tip) for chain in own}
    others = [chain for chain in scene.chains if (chain.base, chain.tip) not in ends]
    goals = tuple(_goal(list(chains).index(tip), target) for tip, target in targets.items())
    return replace(scene, chains=(*own, *others), goals=goals, legs=())


def _short(chain: Chain) -> str:
    """A chain's name without its robot's, which the page's title says."""
    robot: Robot | None = getattr(chain, "robot", None)
    return chain.name if robot is None else chain.name.removeprefix(f"{robot.name} ")


def _goal(chain: int, target: Target) -> SceneGoal:
    tip_axis, base_axis = target.tip_axis, target.base_axis
    return SceneGoal(
        chain,
        target.kind,
        np.asarray(target.T_base_target.homogeneous),
        tuple(bool(target.counts >> bit & 1) for bit in range(6)),
        None if tip_axis is None else tuple(tip_axis.tolist()),
        None if base_axis is None else tuple(base_axis.tolist()),
    )


def _solutions_scene(solutions: Solutions) -> Scene:
    if not solutions:
        reason = solutions.reason or "nothing was solved."
        raise InvalidInputError("solutions", "at least one", f"none: {reason.rstrip('.')}")
    first = solutions[0]
    chain, target = first.problem.chain, first.problem.target
    scene = _space_scene(chain, first.q.tolist(), {chain.tip_name: target})
    postures = tuple(
        NamedPosture(
            result.branch or "the only one",
            result.posture,
            (_thousandths(result.position_error), _thousandths(result.rotation_error), _limits(result.outside)),
            result.solved,
        )
        for result in solutions
    )
    inside = len(solutions.solved)
    told = f"{len(solutions)} solutions of a {target.kind} target by closed form, {inside} of them within limits"
    return replace(
        scene,
        notes=_not_shown(scene),
        postures=postures,
        posture_columns=("mm", "mrad", "limits"),
        ghosts=True,
        panels=(*scene.panels, *((Panel("No solution within limits", (solutions.reason,)),) if not inside else ())),
        produced=f"{told}, {_short(chain)}",
    )


def _thousandths(error: float | None) -> str:
    return "free" if error is None else f"{error * 1e3:.0e}"


def _result_scene(result: IKResult | TreeResult) -> Scene:
    from nao_kin.ik.problem import IKResult

    if isinstance(result, IKResult):
        space: Chain | Tree = result.problem.chain
        targets: Mapping[str, Target] = {result.problem.chain.tip_name: result.problem.target}
    else:
        space, targets = result.problem.tree, result.problem.targets
    scene = _space_scene(space, result.q.tolist(), targets)
    return replace(
        scene,
        panels=(*scene.panels, Panel(result.status.name.replace("_", " ").capitalize(), (result.message,), open=True)),
        motion=_iterates(result, space, tuple(targets)),
        produced=f"one inverse kinematics problem on {space.name}",
    )


def _iterates(result: IKResult | TreeResult, space: Chain | Tree, tips: tuple[str, ...]) -> SceneMotion | None:
    """What a solver went through, with the returned joints at its end; None where no trace was asked for."""
    trace = result.trace
    if trace is None or not len(trace.q):
        return None
    q = np.vstack([trace.q, result.q])
    final = [
        (result.position_error, result.rotation_error)
        if not isinstance(result.position_error, Mapping)
        else (result.position_error[tip], result.rotation_error[tip])
        for tip in tips
    ]
    curves = []
    for k, tip in enumerate(tips):
        prefix = f"{tip}, " if len(tips) > 1 else ""
        for what, unit, rows, last in (
            ("position error", "m", trace.position_error, final[k][0]),
            ("rotation error", "rad", trace.rotation_error, final[k][1]),
        ):
            column = np.append(rows.reshape(len(trace.q), -1)[:, k], math.nan if last is None else last)
            if np.isfinite(column).any():
                curves.append(Curve(prefix + what, unit, column))
    return SceneMotion(
        name="iterates",
        joints=space.joint_names,
        times=np.arange(len(q), dtype=np.float64),
        q=_rounded(q),
        iterates=True,
        curves=tuple(curves),
        tips=tuple(range(len(tips))),
        starts=np.append(trace.start, trace.start[-1]),
    )


def _rounded(values: Floats) -> Floats:
    """Values to `DIGITS`; the largest ones, which have no digits there and would run over, as they are."""
    with np.errstate(over="ignore"):
        return np.where(np.abs(values) < 1e9, np.round(values, DIGITS), values)
