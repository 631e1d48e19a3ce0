"""A robot as a scene: one node a link, its joints with their ranges, its limbs and its chains."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from nao_kin.se3 import from_xyz_rpy
from nao_kin.view.meshes import Triangulator
from nao_kin.view.scene import Node, NodeDrive, Scene, SceneChain, SceneJoint, SceneLeg

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain
    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.elements import Origin, Shape, Solid, UrdfJoint

__all__ = ["legs_of", "limbs", "main_tip", "robot_scene"]

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
        drive = NodeDrive(joint.name, joint.axis, joint.kind == "prismatic")
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


LIMB: Final = 3  # branches with at least so many moving joints are limbs of their own
LEAST_LEGS: Final = 4  # what stands on fewer cannot be moved over its feet by legs of three joints
LEG_JOINTS: Final = 3


def limbs(robot: Robot) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Joint names by limb, each limb and joint in the order in which the tree has them.

    The limbs are the robot's named chains; a joint on none of them goes with the nearest one above it, as a hand with
    its arm. A robot without named chains is taken apart where its tree forks: each long branch is a limb.
    """
    by_limb: dict[str, list[str]] = {}
    owner = _named_owners(robot) if robot.chain_frames else {}
    above = {joint.child: joint for joint in robot.document.joints}
    forks = {} if robot.chain_frames else _forks(robot)
    for joint in robot.moving_joints:
        title, link = "", joint.child
        while not title and (upper := above.get(link)) is not None:
            title = owner.get(upper.name, "") or forks.get(upper.name, "")
            link = upper.parent
        by_limb.setdefault(title or "trunk", []).append(joint.name)
    return tuple((title, tuple(names)) for title, names in by_limb.items())


def _named_owners(robot: Robot) -> dict[str, str]:
    """Joint name to the first named chain whose path it is on, in words."""
    owner: dict[str, str] = {}
    for name, (base, tip) in robot.chain_frames.items():
        for joint in (joint for part in robot.path(base, tip) for joint in part):
            if joint.kind != "fixed":
                owner.setdefault(joint.name, name.replace("_", " "))
    return owner


def _forks(robot: Robot) -> dict[str, str]:
    """The joint at which each limb begins, and the limb's title."""
    children: dict[str, list[str]] = {}
    for joint in robot.document.joints:
        children.setdefault(joint.parent, []).append(joint.name)
    by_name = {joint.name: joint for joint in robot.document.joints}
    size: Counter[str] = Counter()
    above = {joint.child: joint for joint in robot.document.joints}
    for joint in robot.moving_joints:
        link: str | None = joint.child
        while link is not None and (upper := above.get(link)) is not None:
            size[upper.name] += 1
            link = upper.parent
    moving = set(robot.joint_names)
    found = {}
    for names in children.values():
        long = [name for name in names if size[name] >= LIMB]
        for name in long if sum(size[name] > 0 for name in names) > 1 else ():
            first = name
            while first not in moving:  # a fixed joint at the root of a limb says little
                first = max(children[by_name[first].child], key=lambda below: size[below])
            found[name] = f"from {first}"
    return found


def main_tip(robot: Robot) -> str:
    """The frame farthest from the root, counted in moving joints; of equals the last in the file."""
    depth = {robot.root: 0}
    pending = list(robot.document.joints)
    while pending:
        ready = [joint for joint in pending if joint.parent in depth]
        for joint in ready:
            depth[joint.child] = depth[joint.parent] + (joint.kind != "fixed")
        pending = [joint for joint in pending if joint.child not in depth]
    most = max(depth.values())
    return [link.name for link in robot.document.links if depth[link.name] == most][-1]


def legs_of(robot: Robot, index: Mapping[str, int]) -> tuple[SceneLeg, ...]:
    """The legs of a machine that can move its body over its feet: all its chains, if all are legs of three joints.

    Args:
        robot: The robot.
        index: Link name to the index of its node.
    """
    if len(robot.chain_frames) < LEAST_LEGS or len({base for base, _ in robot.chain_frames.values()}) > 1:
        return ()
    chains = {name: robot.chain(name) for name in robot.chain_frames}
    if any(len(chain.path_joint_names) != LEG_JOINTS for chain in chains.values()):
        return ()
    legs = [leg for name, chain in chains.items() if (leg := _leg(name, chain, index)) is not None]
    return tuple(legs) if len(legs) == len(chains) else ()


def _leg(name: str, chain: UrdfChain, index: Mapping[str, int]) -> SceneLeg | None:
    from nao_kin.analytic.form import Mismatch
    from nao_kin.analytic.hexapod.hexapod_leg import recognise

    geometry = recognise(chain.joint_path)
    if isinstance(geometry, Mismatch):
        return None
    title = name.removeprefix("leg_").upper()
    numbers = tuple(float(number) for number in geometry.parameters)
    return SceneLeg(title, index[chain.base], index[chain.tip], chain.joint_names, numbers)
