"""Two chains in one picture: where a comparison found their tips farthest apart, and wherever its sliders go."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.view.chain_ends import with_ends
from nao_kin.view.meshes import Mesh
from nao_kin.view.robot_scene import robot_scene
from nao_kin.view.scene import Node, NodeDrive, Panel, Rod, Scene, SceneChain, SceneJoint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.crosscheck import Comparison
    from nao_kin.robot.robot import Robot
    from nao_kin.urdf.elements import Colour

__all__ = ["FAINT", "FIRST", "GAP", "SECOND", "Figure", "chain_figure", "chain_scene", "comparison_scene", "rod_radius"]

FIRST: Final[Colour] = (0.93, 0.47, 0.07, 1.0)  # orange
SECOND: Final[Colour] = (0.10, 0.38, 0.85, 1.0)  # blue
GAP: Final[Colour] = (0.85, 0.08, 0.12, 1.0)  # red
FAINT: Final = 0.22  # opacity of the robot's own shapes
THIN: Final = 0.5  # radius of the gap's rod next to that of the chains'


def comparison_scene(found: Comparison, *, explain: bool = False) -> Scene:
    """Both chains as stick figures at the joints where their tips are farthest apart, the gaps between them in red.

    The sliders move both. Where the second chain belongs to a robot, its shapes are drawn faintly around it.

    Args:
        found: The comparison.
        explain: Whether to say what accounts for the disagreement, which may have to be searched first.
    """
    q = found.worst_position_q
    scene, base = _surroundings(found.b, q.tolist())
    radius = rod_radius(found.b, q)
    names = found.b.joint_names
    a = chain_figure(found.a, base, len(scene.nodes), names, FIRST, radius)
    b = chain_figure(found.b, base, len(scene.nodes) + len(a.nodes), names, SECOND, radius)
    gaps = [Rod(start, end, GAP, THIN * radius, measured=True) for start, end in zip(a.frames, b.frames, strict=False)]
    if a.tip != gaps[-1].start or b.tip != gaps[-1].end:  # chains of different length: the tips belong together
        gaps[-1] = Rod(a.tip, b.tip, GAP, THIN * radius, measured=True)
    panels = [Panel("Comparison", tuple(_summary(found)), open=True)]
    if explain:
        panels.append(Panel("Explanation", tuple(str(found.explanation).splitlines())))
    return replace(
        scene,
        title=f"{found.a.name} against {found.b.name}",
        nodes=(*scene.nodes, *a.nodes, *b.nodes),
        chains=(SceneChain(found.a.name, base, a.tip), SceneChain(found.b.name, base, b.tip), *scene.chains),
        rods=(*a.rods, *b.rods, *gaps[1:]),  # the bases coincide
        framed=(*a.frames, *b.frames[1:]),
        panels=tuple(panels),
        produced=f"a comparison at {found.samples} configurations",
        groups=(("compared", names), *_others(scene, names)),
        legs=(),
    )


def chain_scene(chain: Chain) -> Scene:
    """A chain at its neutral joints: as a stick figure, and with its robot's shapes around it where it has a robot."""
    from nao_kin.chain import neutral

    q = neutral(chain)
    scene, base = _surroundings(chain, q.tolist())
    figure = chain_figure(chain, base, len(scene.nodes), chain.joint_names, FIRST, rod_radius(chain, q))
    return replace(
        scene,
        title=chain.name,
        nodes=(*scene.nodes, *figure.nodes),
        chains=(SceneChain(chain.name, base, figure.tip), *scene.chains),
        rods=figure.rods,
        framed=figure.frames,
        produced="a chain",
        groups=(("chain", chain.joint_names), *_others(scene, chain.joint_names)),
        legs=(),
    )


def _surroundings(chain: Chain, q: list[float]) -> tuple[Scene, int]:
    """The chain's robot, faint, or the chain's joints alone; and the index of the chain's base frame."""
    robot: Robot | None = getattr(chain, "robot", None)
    if robot is not None:
        posture = robot.complete(dict(zip(chain.joint_names, q, strict=True)))
        scene = robot_scene(robot, posture)
        nodes = tuple(replace(node, meshes=tuple(map(_faint, node.meshes))) for node in scene.nodes)
        scene, base, _ = with_ends(replace(scene, nodes=nodes), chain)
        return scene, base
    joints = tuple(
        SceneJoint(joint.name, joint.kind, value, joint.lower, joint.upper, joint.max_velocity)
        for joint, value in zip(chain.joints, q, strict=True)
    )
    root = Node(chain.base_name, None, None, np.eye(4))
    return Scene(title="", nodes=(root,), joints=joints, rules=chain.limit_rules), 0


def _others(scene: Scene, names: tuple[str, ...]) -> list[tuple[str, tuple[str, ...]]]:
    """The scene's groups without some joints, and without those that this leaves empty."""
    left = [(title, tuple(name for name in group if name not in names)) for title, group in scene.groups]
    return [(title, group) for title, group in left if group]


def _summary(found: Comparison) -> list[str]:
    apart = "They agree exactly as given." if found.agrees else f"They first differ at {found.first_departure}."
    return [
        f"Orange: {found.a.name}.",
        f"Blue: {found.b.name}.",
        f"Red: the gaps. That between the tips is {found.max_position_error * 1e3:.4g} mm at the worst of "
        f"{found.samples} configurations. Largest rotation error {found.max_rotation_error:.4g} rad.",
        apart,
    ]


def _faint(mesh: Mesh) -> Mesh:
    red, green, blue, alpha = mesh.colour
    return replace(mesh, colour=(red, green, blue, FAINT * alpha))


ROD: Final = 0.008  # radius of a rod next to the length of the chain
BALL: Final = 2.2  # radius of a joint next to that of a rod


@dataclass(frozen=True, eq=False, slots=True)
class Figure:
    """The nodes and rods of one chain.

    Attributes:
        nodes: Its nodes, to be appended to a scene's.
        rods: Its rods.
        frames: Indices of the nodes that are link frames, base to tip; the tip is the last one.
    """

    nodes: tuple[Node, ...]
    rods: tuple[Rod, ...]
    frames: tuple[int, ...]

    @property
    def tip(self) -> int:
        """Index of the tip's node."""
        return self.frames[-1]


def chain_figure(
    chain: Chain, base: int, first: int, joint_names: Sequence[str], colour: Colour, radius: float
) -> Figure:
    """A chain as a stick figure on the joint lines of its flat form.

    A stick runs through the origins of the link frames, which each convention places in its own way, and ends at the
    tip.

    Args:
        chain: The chain.
        base: Index of the node that is its base frame.
        first: Index that its first node will have.
        joint_names: Names of the scene's joints that are its columns.
        colour: Colour of its rods.
        radius: Radius of its rods [m].
    """
    path, links = chain.joint_path, chain.path_joint_names
    zero = np.zeros(len(chain.joints))
    T_base_links = chain.link_poses(zero)
    nodes: list[Node] = []
    frames = [base]
    parent, T_base_here = base, np.eye(4)
    for k, name in enumerate(links):
        placement = np.eye(4)
        placement[:3, :3], placement[:3, 3] = path.rotations[k], path.translations[k]
        column, slides = joint_names[int(path.columns[k])], bool(path.prismatic[k])
        drive = NodeDrive(column, (0.0, 0.0, 1.0), slides, float(path.multipliers[k]), float(path.offsets[k]))
        nodes.append(Node("", parent, None, placement, drive=drive))
        parent = first + len(nodes) - 1
        T_base_here = T_base_here @ placement @ _moved(drive, slides)
        fixed = _inverse(T_base_here) @ T_base_links[k]
        nodes.append(Node(f"{name}, link", parent, None, fixed, (_ball(radius, colour),)))
        frames.append(first + len(nodes) - 1)
    tool = np.eye(4)
    tool[:3, :3], tool[:3, 3] = path.tool_rotation, path.tool_translation
    nodes.append(Node(chain.tip_name, parent, None, tool, (_ball(radius, colour),)))
    frames.append(first + len(nodes) - 1)
    rods = tuple(Rod(start, end, colour, radius) for start, end in itertools.pairwise(frames))
    return Figure(tuple(nodes), rods, tuple(frames))


def rod_radius(chain: Chain, q: Floats) -> float:
    """A radius [m] for the rods of a chain, in proportion to its length at q."""
    points = np.array([np.zeros(3), *chain.link_poses(q)[:, :3, 3], chain.pose(q).translation])
    return ROD * max(1e-3, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()))


def _moved(drive: NodeDrive, slides: bool) -> Floats:
    """What the drive adds where its joint is at 0."""
    moved = np.eye(4)
    c, s = np.cos(drive.offset), np.sin(drive.offset)
    if slides:
        moved[2, 3] = drive.offset
    else:
        moved[:2, :2] = [[c, -s], [s, c]]
    return moved


def _inverse(pose: Floats) -> Floats:
    """Inverse of a rigid (4, 4) transform, by transposition: exact where a general inverse would round."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def _ball(radius: float, colour: Colour) -> Mesh:
    import trimesh.creation

    ball = trimesh.creation.icosphere(2, BALL * radius)
    return Mesh(np.asarray(ball.vertices), np.asarray(ball.faces), colour)
