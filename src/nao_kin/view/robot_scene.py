"""A robot as a scene: one node a link, its joints with their ranges, its limbs and its chains."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from nao_kin.se3 import from_xyz_rpy
from nao_kin.view.limbs import legs_of, limbs, main_tip
from nao_kin.view.meshes import Triangulator
from nao_kin.view.scene import Drive, Node, Scene, SceneChain, SceneJoint

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.elements import Origin, Shape, Solid, UrdfJoint

__all__ = ["robot_scene"]

SHAPELESS = "The file describes no shapes: none of its links has a visual element."


def robot_scene(robot: Robot, posture: Mapping[str, float] | None = None) -> Scene:
    """A robot in one posture: one node a link, each hanging on its parent link.

    Args:
        robot: The robot.
        posture: Joint name to angle [rad] or offset [m]; joints not named are at 0. None means `robot.neutral`.

    Returns:
        The scene, in the frame of the robot's root link. Meshes that cannot be shown are named in its notes.

    Raises:
        UnknownNameError: The posture names a joint the robot does not have.
        InvalidInputError: A value of the posture is not a finite number, or contradicts a coupling.
    """
    given = robot.neutral if posture is None else posture
    document = robot.document
    values = robot.expand(given)
    triangulator = Triangulator(document.directory, robot.mesh_roots)
    tree = _tree(document)
    index = {link: i for i, (link, _, _) in enumerate(tree)}
    return Scene(
        title=robot.name,
        nodes=tuple(_node(document, triangulator, *branch) for branch in tree),
        joints=_joints(robot, values),
        source=Path(document.path).name,
        sha256=document.sha256,
        notes=(
            *(f"Outside its limits: {outside}." for outside in robot.outside_limits(given)),
            *(triangulator.notes if any(link.visuals for link in document.links) else (SHAPELESS,)),
        ),
        produced="one posture",
        rules=tuple(rule for rule in robot.limit_rules if rule.joint in values and rule.by in values),
        groups=limbs(robot),
        chains=_chains(robot, index),
        legs=legs_of(robot, index),
    )


def _node(
    document: UrdfDocument, triangulator: Triangulator, name: str, joint: UrdfJoint | None, parent: int | None
) -> Node:
    link = document.link(name)
    meshes = triangulator.link(link)
    # Many files name the same mesh for both: it is put on the page once.
    collides = bool(link.collisions) and _outlines(link.collisions) == _outlines(link.visuals)
    collisions = () if collides else triangulator.link(replace(link, visuals=link.collisions))
    origin = from_xyz_rpy((0, 0, 0), (0, 0, 0)) if joint is None else from_xyz_rpy(joint.origin.xyz, joint.origin.rpy)
    drive = None
    if joint is not None and joint.kind != "fixed":
        drive = Drive(joint.name, joint.axis, joint.kind == "prismatic")
    return Node(name, parent, joint.name if joint else None, origin.homogeneous, meshes, collisions, collides, drive)


def _outlines(solids: tuple[Solid, ...]) -> set[tuple[Shape, Origin]]:
    return {(solid.shape, solid.origin) for solid in solids}


def _tree(document: UrdfDocument) -> list[tuple[str, UrdfJoint | None, int | None]]:
    """(link, joint above it, index of its parent) from the root outwards, siblings in the order of the file."""
    children: dict[str, list[UrdfJoint]] = {}
    for joint in document.joints:
        children.setdefault(joint.parent, []).append(joint)
    ordered: list[tuple[str, UrdfJoint | None, int | None]] = [(document.root, None, None)]
    for index, (link, _, _) in enumerate(ordered):  # the list grows while it is walked: breadth first
        ordered.extend((joint.child, joint, index) for joint in children.get(link, ()))
    return ordered


def _joints(robot: Robot, values: Mapping[str, float]) -> tuple[SceneJoint, ...]:
    couplings, found = {c.follower: c for c in robot.couplings}, []
    for name, joint in robot.shown_joints.items():
        c = couplings.get(name)
        plain = SceneJoint(name, joint.kind, values[name], joint.lower, joint.upper, joint.max_velocity)
        found.append(plain if c is None else replace(plain, leader=c.leader, multiplier=c.multiplier, offset=c.offset))
    return tuple(found)


def _chains(robot: Robot, index: Mapping[str, int]) -> tuple[SceneChain, ...]:
    """The robot's named chains; for a robot without any, the one from its root to its farthest frame."""
    named = tuple(SceneChain(name, index[base], index[tip]) for name, (base, tip) in robot.chain_frames.items())
    if named or not robot.joint_names:
        return named
    tip = main_tip(robot)
    return (SceneChain(f"{robot.root} → {tip}", index[robot.root], index[tip]),)
