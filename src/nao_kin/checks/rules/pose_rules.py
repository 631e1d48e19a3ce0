"""Rules about the model that the file describes: it has a posture, its poses are numbers, other readers agree."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree

from nao_kin.robot.couplings import contradictions
from nao_kin.urdf.format_version import FormatVersion
from nao_kin.urdf.outline import Defect, describe, first, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import pinocchio as pin

    from nao_kin.checks.subject import Subject
    from nao_kin.robot.robot import Robot

__all__ = ["coupled_limits", "coupled_ranges", "finite_poses", "readers_agree", "sample_postures"]

_WIDE = math.pi  # [rad or m] joints without limits are tried up to here
_AGREEMENT = 1e-6  # [1 and m, relative to the robot's size] yourdfpy loses half of its digits near half a turn
_ROUNDING = 1e-3  # [rad] documents print degrees to a tenth or a hundredth
_POSTURES = 8


def coupled_ranges(subject: Subject) -> Iterator[Defect]:
    """A follower leaves its leader a value at which both are within their limits."""
    robot = subject.robot
    for c in contradictions(robot.stated_joints, robot.couplings):
        joint = subject.joint(c.follower)
        mimic = first(joint, "mimic")
        message = f"The {describe(joint)} follows {shown(c.leader)}, and no value of it keeps both within their limits."
        hint = "Check multiplier and offset against the two ranges."
        yield Defect("coupled-range-empty", joint if mimic is None else mimic, message, hint)


def coupled_limits(subject: Subject) -> Iterator[Defect]:
    """The documented ranges that depend on another joint lie inside the file's plain ranges."""
    joints = {joint.name: joint for joint in subject.robot.stated_joints}
    for rule in subject.robot.limit_rules:
        if rule.joint not in joints or rule.by not in joints:
            continue
        lower, upper = joints[rule.joint].lower, joints[rule.joint].upper
        least, most = min(rule.lower), max(rule.upper)
        ends = ((least, least < lower - _ROUNDING), (most, most > upper + _ROUNDING))
        beyond = [f"{end:g}" for end, outside in ends if outside]
        if beyond:
            joint = subject.joint(rule.joint)
            limit = first(joint, "limit")
            message = (
                f"The range of the {describe(joint)} that depends on {shown(rule.by)} reaches {' and '.join(beyond)} "
                f"rad, outside its plain limits {lower:g} … {upper:g}."
            )
            hint = "The plain limits are in the file, the others in the robot's documentation; one of them is wrong."
            yield Defect("coupled-limit-outside", joint if limit is None else limit, message, hint)


def sample_postures(robot: Robot, count: int, seed: int = 0) -> list[dict[str, float]]:
    """Postures to try: every joint at 0 if it may, at its lower limit, at its upper one, and random ones."""
    rng = np.random.default_rng(seed)
    followers = {c.follower for c in robot.couplings}
    motors = (joint for name, joint in robot.shown_joints.items() if name not in followers)
    ranges = {joint.name: _tried(joint.lower, joint.upper) for joint in motors}
    ends = [
        {name: min(max(0.0, lower), upper) for name, (lower, upper) in ranges.items()},
        {name: lower for name, (lower, _) in ranges.items()},
        {name: upper for name, (_, upper) in ranges.items()},
    ]
    return ends + [
        {name: low + (high - low) * float(rng.random()) for name, (low, high) in ranges.items()} for _ in range(count)
    ]


def _tried(lower: float, upper: float) -> tuple[float, float]:
    """The part of a range that is tried: what is near 0 of a wide one, all of one that is far from 0."""
    near = max(lower, -_WIDE), min(upper, _WIDE)
    return near if near[0] <= near[1] else (lower, upper)


def finite_poses(subject: Subject) -> Iterator[Defect]:
    """The pose of every link is a number, at zero, at the limits and between them."""
    for posture in sample_postures(subject.robot, 1):
        for name, pose in subject.robot.link_poses(posture).items():
            if not np.isfinite(pose.homogeneous).all():
                link = subject.link(name)
                message = f"The pose of the {describe(link)} is no number within the joints' limits."
                yield Defect("pose-not-finite", link, message, "Are the origins and limits on the way to it sane?")
                return


def readers_agree(subject: Subject) -> Iterator[Defect]:
    """Two readers that share no code, Pinocchio and yourdfpy, put every link in the same place."""
    import yourdfpy

    robot = subject.robot
    try:
        text = io.BytesIO(_for_yourdfpy(subject))
        other = yourdfpy.URDF.load(text, load_meshes=False, build_collision_scene_graph=False)
    except Exception as error:  # whatever a reader of other people's files stumbles on
        message = f"yourdfpy cannot read the file: {type(error).__name__}: {shown(str(error))}."
        yield Defect("readers-disagree", subject.outline.root, message)
        return
    for posture in sample_postures(robot, _POSTURES):
        values = robot.expand(posture)
        other.update_cfg({name: values[name] for name in other.actuated_joint_names})
        ours = robot.link_poses(posture)
        worst = _first_apart(ours, {name: other.get_transform(name, robot.root) for name in ours})
        if worst:
            link = subject.link(worst)
            message = f"Pinocchio and yourdfpy put the {describe(link)} in different places."
            hint = "The file can be read in two ways; look at the joints between it and the root."
            yield Defect("readers-disagree", link, message, hint)
            return


def _for_yourdfpy(subject: Subject) -> bytes:
    """The file, or what we have read in words of 1.0: yourdfpy knows no later version."""
    if subject.outline.version > FormatVersion.V1_0:
        return subject.document.to_xml().encode()
    return etree.tostring(subject.outline.root)


def _first_apart(ours: Mapping[str, pin.SE3], theirs: Mapping[str, object]) -> str:
    size = max(1.0, *(float(np.abs(pose.translation).max()) for pose in ours.values()))
    for name, pose in ours.items():
        if np.abs(pose.homogeneous - np.asarray(theirs[name])).max() > _AGREEMENT * size:
            return name
    return ""
