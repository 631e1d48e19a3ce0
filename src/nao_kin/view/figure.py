"""Chains as stick figures that move: a node a joint, a frame and a ball a link, rods in between."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.view.meshes import Mesh
from nao_kin.view.scene import Drive, Node, Rod

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.urdf.elements import Colour

__all__ = ["Figure", "chain_figure", "rod_radius"]

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
        drive = Drive(column, (0.0, 0.0, 1.0), slides, float(path.multipliers[k]), float(path.offsets[k]))
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


def _moved(drive: Drive, slides: bool) -> Floats:
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
