"""What a page shows, as plain data: triangles in a tree of nodes, joints that move them, and what goes with them.

Lengths in metres, angles in radians, x forward and z up. Nothing here knows about HTML or a viewer. Forward kinematics
is the tree: a node stands in its parent's frame at its placement, moved along by its joint (`local_pose`), here for a
picture's bounds and in the page for its sliders.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import LimitRule, MovingKind
    from nao_kin.urdf.elements import Colour
    from nao_kin.view.meshes import Mesh

__all__ = [
    "Curve",
    "NamedPosture",
    "Node",
    "NodeDrive",
    "Panel",
    "Rod",
    "Scene",
    "SceneChain",
    "SceneGoal",
    "SceneJoint",
    "SceneLeg",
    "SceneMotion",
    "bounds",
    "local_pose",
    "world_poses",
]


@dataclass(frozen=True, slots=True)
class NodeDrive:
    """What moves a node: its pose in the parent is placement · Z(v), v = multiplier · joint + offset.

    Attributes:
        joint: Name of the joint.
        axis: Unit axis of Z in the node's frame.
        slides: Whether Z slides by v [m] along the axis instead of turning by v [rad] about it.
        multiplier: See there.
        offset: See there [rad or m].
    """

    joint: str
    axis: tuple[float, float, float]
    slides: bool
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False, slots=True)
class Node:
    """One body of the scene.

    Attributes:
        label: What a person calls it (a link's name); text only, never an identifier.
        parent: Index of the node it hangs on, smaller than its own; None for a root.
        joint: Name of the joint between the parent and this node, fixed ones included; None where there is none.
        placement: Pose of this node in its parent's frame, (4, 4), where its joint is at 0.
        meshes: Its triangles, in this node's frame.
        collisions: The shapes of its collision elements, likewise; empty where they are its `meshes`.
        collides: Whether its collision elements are the very shapes of `meshes`.
        drive: What moves it; None where nothing does.
    """

    label: str
    parent: int | None
    joint: str | None
    placement: Floats
    meshes: tuple[Mesh, ...] = ()
    collisions: tuple[Mesh, ...] = ()
    collides: bool = False
    drive: NodeDrive | None = None


@dataclass(frozen=True, slots=True)
class SceneJoint:
    """One moving joint: value and range in [rad], or [m] where it is prismatic.

    Attributes:
        name: Its name.
        kind: What it does.
        value: Where it stands at first.
        lower: Least value; −inf where there is none.
        upper: Greatest value; +inf where there is none.
        max_velocity: Greatest speed [rad/s or m/s]; +inf where none is known.
        leader: The joint it follows, value = multiplier · leader + offset; None for one with a motor of its own.
        multiplier: See there.
        offset: See there.
    """

    name: str
    kind: MovingKind
    value: float
    lower: float = -math.inf
    upper: float = math.inf
    max_velocity: float = math.inf
    leader: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class SceneChain:
    """A chain whose tip pose the page states: its name, and the nodes that are its base and its tip."""

    name: str
    base: int
    tip: int


@dataclass(frozen=True, eq=False, slots=True)
class NamedPosture:
    """Joint values to choose from a list.

    Attributes:
        name: What to call it.
        values: Joint name to value [rad or m]; joints not named stand where the scene's do.
        cells: What else its row says, under `Scene.posture_columns`.
        good: Whether it is as wanted (within limits, at its target); None where nothing was wanted.
    """

    name: str
    values: Mapping[str, float]
    cells: tuple[str, ...] = ()
    good: bool | None = None


@dataclass(frozen=True, eq=False, slots=True)
class SceneGoal:
    """A target of a chain's tip, from which the page draws and states the residual.

    Attributes:
        chain: Index of its chain in the scene.
        kind: What is wanted, as in `nao_kin.ik.target.Target`.
        T_base_target: The wanted pose (4, 4); the parts that the kind leaves free are identity.
        counts: Whether each of x, y, z, rx, ry, rz counts.
        tip_axis: Of a pointing target: what points, a unit axis in tip axes.
        base_axis: Of a pointing target: where to, a unit axis in base axes.
    """

    chain: int
    kind: Literal["pose", "position", "pointing", "orientation"]
    T_base_target: Floats
    counts: tuple[bool, ...] = (True,) * 6
    tip_axis: tuple[float, ...] | None = None
    base_axis: tuple[float, ...] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """Numbers that go with the samples of a motion, drawn over them: y (N,), NaN where there is none."""

    name: str
    unit: str
    y: Floats


@dataclass(frozen=True, eq=False, slots=True)
class SceneMotion:
    """Joint values to play.

    Attributes:
        name: What to call it.
        joints: Names of the columns.
        times: When, (N,) [s]; or the number of the iterate where `iterates` is set.
        q: Values (N, n) [rad or m]; joints not named stand still.
        iterates: Whether the samples are the iterates of a solver: shown one by one, and nothing in between.
        curves: What is drawn over them besides the joints, on a logarithmic scale.
        tips: Indices of chains whose tips' paths are drawn.
        starts: Number of the start each iterate belongs to, (N,); None for a motion.
        body: T_ground_root (N, 4, 4), where the whole robot moves over the ground; None where it stays.
    """

    name: str
    joints: tuple[str, ...]
    times: Floats
    q: Floats
    iterates: bool = False
    curves: tuple[Curve, ...] = ()
    tips: tuple[int, ...] = ()
    starts: NDArray[np.int64] | None = None
    body: Floats | None = None


@dataclass(frozen=True, slots=True)
class Rod:
    """A rod between the origins of two nodes, which follows them.

    Attributes:
        start: Index of a node.
        end: Index of another one.
        colour: Its colour.
        radius: Its radius [m].
        measured: Whether its length is written beside it.
    """

    start: int
    end: int
    colour: Colour
    radius: float
    measured: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class SceneLeg:
    """A leg of three joints whose closed form the page knows, for moving the body over feet that stay.

    Attributes:
        name: What to call it.
        base: Index of the body's node.
        foot: Index of the foot's node.
        joints: Its three joints.
        numbers: The leg's numbers as `nao_kin.analytic.hexapod.hexapod_leg.pack` arranges them.
    """

    name: str
    base: int
    foot: int
    joints: tuple[str, ...]
    numbers: tuple[float, ...]


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
        title: Name of the robot, or of what is shown.
        nodes: The bodies, parents before children.
        joints: The moving joints, in the order of the file.
        source: Name of the file the robot came from, without its directory.
        sha256: Hash of that file's bytes, in hexadecimal.
        notes: What could not be shown and why, one sentence each.
        panels: What else there is to say.
        produced: What the page shows, in a few words for its footer.
        rules: Coupled limits of the joints.
        groups: Joints by limb: a title and the names.
        chains: Chains whose tip pose can be read; the first one is shown at first.
        postures: Named postures; the first one is shown at first.
        posture_columns: Headings of their cells.
        ghosts: Whether the postures not chosen are drawn too, faintly.
        goals: Targets.
        motion: What can be played.
        rods: Rods between nodes.
        framed: Nodes whose frames are drawn from the start.
        legs: Legs whose feet stay where they are while the body moves.
    """

    title: str
    nodes: tuple[Node, ...]
    joints: tuple[SceneJoint, ...] = ()
    source: str = ""
    sha256: str = ""
    notes: tuple[str, ...] = ()
    panels: tuple[Panel, ...] = ()
    produced: str = ""
    rules: tuple[LimitRule, ...] = ()
    groups: tuple[tuple[str, tuple[str, ...]], ...] = ()
    chains: tuple[SceneChain, ...] = ()
    postures: tuple[NamedPosture, ...] = ()
    posture_columns: tuple[str, ...] = ()
    ghosts: bool = False
    goals: tuple[SceneGoal, ...] = ()
    motion: SceneMotion | None = None
    rods: tuple[Rod, ...] = ()
    framed: tuple[int, ...] = ()
    legs: tuple[SceneLeg, ...] = ()


def local_pose(node: Node, values: Mapping[str, float]) -> Floats:
    """Pose of a node in its parent's frame, (4, 4), at joint values by name [rad or m]."""
    drive = node.drive
    if drive is None:
        return node.placement
    value = drive.multiplier * values[drive.joint] + drive.offset
    axis, moved = np.array(drive.axis), np.eye(4)
    if drive.slides:
        moved[:3, 3] = value * axis
    else:
        x, y, z = axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        half = math.sin(0.5 * value)
        moved[:3, :3] += math.sin(value) * cross + 2.0 * half * half * (cross @ cross)
    product: Floats = node.placement @ moved
    return product


def world_poses(scene: Scene) -> Floats:
    """Pose of every node in the root frame, (number of nodes, 4, 4), where the scene's joints stand."""
    values = {joint.name: joint.value for joint in scene.joints}
    poses = np.empty((len(scene.nodes), 4, 4))
    for index, node in enumerate(scene.nodes):
        local = local_pose(node, values)
        poses[index] = local if node.parent is None else poses[node.parent] @ local
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
