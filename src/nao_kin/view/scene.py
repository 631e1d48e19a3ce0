"""What a page shows, as plain data: triangles in a tree of nodes, joint values and notes.

Lengths in metres, angles in radians, x forward and z up. Nothing here knows about HTML or a viewer.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.view.meshes import Mesh, Triangulator

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.arrays import Floats
    from nao_kin.robot import Robot
    from nao_kin.urdf.document import UrdfDocument
    from nao_kin.urdf.elements import JointKind

__all__ = ["JointValue", "Node", "Panel", "Scene", "bounds", "robot_scene", "world_poses"]

SHAPELESS = "The file describes no shapes: none of its links has a visual element."


@dataclass(frozen=True, eq=False, slots=True)
class Node:
    """One body of the scene.

    Attributes:
        label: What a person calls it (a link's name); text only, never an identifier.
        parent: Index of the node it hangs on, smaller than its own; None for a root.
        joint: Name of the joint between the parent and this node; None where there is none.
        placement: Pose of this node in its parent's frame, (4, 4).
        meshes: Its triangles, in this node's frame.
    """

    label: str
    parent: int | None
    joint: str | None
    placement: Floats
    meshes: tuple[Mesh, ...]


@dataclass(frozen=True, slots=True)
class JointValue:
    """One row of the table of joint values: an angle [rad], or an offset [m] where the kind is prismatic."""

    name: str
    kind: JointKind
    value: float


@dataclass(frozen=True, slots=True)
class Panel:
    """Text beside the picture.

    Attributes:
        title: Its heading.
        lines: Its paragraphs.
        open: Whether it is unfolded at first.
    """

    title: str
    lines: tuple[str, ...]
    open: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """Everything a page shows.

    Attributes:
        title: Name of the robot.
        nodes: The bodies, parents before children.
        joints: The joint values shown, in the order of the file.
        source: Name of the file the robot came from, without its directory.
        sha256: Hash of that file's bytes, in hexadecimal.
        notes: What could not be shown and why, one sentence each.
        panels: What else there is to say.
    """

    title: str
    nodes: tuple[Node, ...]
    joints: tuple[JointValue, ...] = ()
    source: str = ""
    sha256: str = ""
    notes: tuple[str, ...] = ()
    panels: tuple[Panel, ...] = ()


def world_poses(scene: Scene) -> Floats:
    """Pose of every node in the root frame, (number of nodes, 4, 4)."""
    poses = np.empty((len(scene.nodes), 4, 4))
    for index, node in enumerate(scene.nodes):
        poses[index] = node.placement if node.parent is None else poses[node.parent] @ node.placement
    return poses


def bounds(scene: Scene) -> Floats:
    """Lowest and highest corner of all triangles in the root frame [m], (2, 3).

    A scene without triangles is bounded by the origins of its nodes, so that a bare skeleton still has a size.
    """
    poses = world_poses(scene)
    clouds = [
        mesh.vertices @ pose[:3, :3].T + pose[:3, 3]
        for node, pose in zip(scene.nodes, poses, strict=True)
        for mesh in node.meshes
        if len(mesh.vertices)
    ]
    points = np.vstack(clouds) if clouds else np.vstack([poses[:, :3, 3], np.zeros((1, 3))])
    return np.stack([points.min(axis=0), points.max(axis=0)])


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
    poses = {name: np.asarray(pose.homogeneous) for name, pose in robot.link_poses(given).items()}
    triangulator = Triangulator(document.directory, robot.mesh_roots)
    nodes: list[Node] = []
    for link, joint, parent in _tree(document):
        placement = poses[link]
        if parent is not None:
            placement = _inverse(poses[nodes[parent].label]) @ placement
        nodes.append(Node(link, parent, joint, placement, triangulator.link(document.link(link))))
    return Scene(
        title=robot.name,
        nodes=tuple(nodes),
        joints=tuple(JointValue(j.name, j.kind, values[j.name]) for j in document.joints if j.name in values),
        source=Path(document.path).name,
        sha256=document.sha256,
        notes=(
            *(f"Outside its limits: {outside}." for outside in robot.outside_limits(given)),
            *(triangulator.notes if any(link.visuals for link in document.links) else (SHAPELESS,)),
        ),
    )


def _tree(document: UrdfDocument) -> list[tuple[str, str | None, int | None]]:
    """(link, joint above it, index of its parent) from the root outwards, siblings in the order of the file."""
    children: dict[str, list[tuple[str, str]]] = {}
    for joint in document.joints:
        children.setdefault(joint.parent, []).append((joint.child, joint.name))
    ordered: list[tuple[str, str | None, int | None]] = [(document.root, None, None)]
    for index, (link, _, _) in enumerate(ordered):  # the list grows while it is walked: breadth first
        ordered.extend((child, joint, index) for child, joint in children.get(link, ()))
    return ordered


def _inverse(pose: Floats) -> Floats:
    """Inverse of a rigid (4, 4) transform, by transposition: exact where a general inverse would round."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse
