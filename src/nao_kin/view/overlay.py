"""Two chains in one picture: where a comparison found their tips farthest apart."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.view.meshes import Mesh
from nao_kin.view.scene import Node, Panel, Scene, robot_scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.crosscheck import Comparison
    from nao_kin.robot import Robot
    from nao_kin.urdf.elements import Colour

__all__ = ["comparison_scene"]

FIRST: Final[Colour] = (0.93, 0.47, 0.07, 1.0)  # orange
SECOND: Final[Colour] = (0.10, 0.38, 0.85, 1.0)  # blue
GAP: Final[Colour] = (0.85, 0.08, 0.12, 1.0)  # red
FAINT: Final = 0.22  # opacity of the robot's own shapes
ROD: Final = 0.008  # radius of a rod next to the length of the chain
BALL: Final = 2.2  # radius of a joint next to that of a rod


def comparison_scene(found: Comparison, *, explain: bool = False) -> Scene:
    """Both chains as stick figures at the joints where their tips are farthest apart, the gap between them in red.

    A stick runs through the origins of the link frames, which each convention places in its own way, and ends at the
    tip. Where the second chain belongs to a robot, its shapes are drawn faintly around it.

    Args:
        found: The comparison.
        explain: Whether to say what accounts for the disagreement, which may have to be searched first.
    """
    q = found.worst_position_q
    tips = [chain.pose(q).translation for chain in (found.a, found.b)]
    sticks = [_stick(found.a, q, FIRST), _stick(found.b, q, SECOND), _rods(tips, _radius(found.b, q) * 0.6, GAP)]
    robot: Robot | None = getattr(found.b, "robot", None)
    scene = Scene(title="", nodes=(Node("base", None, None, np.eye(4), ()),))
    T_root_base = np.eye(4)
    if robot is not None:
        posture = robot.complete(dict(zip(found.b.joint_names, q.tolist(), strict=True)))
        scene = robot_scene(robot, posture)
        T_root_base = np.asarray(robot.pose(posture, found.b.base_name).homogeneous)
    nodes = [replace(node, meshes=tuple(map(_faint, node.meshes))) for node in scene.nodes]
    nodes.append(Node("chains", 0, None, T_root_base, tuple(stick for stick in sticks if len(stick.faces))))
    panels = [Panel("Comparison", tuple(_summary(found)), open=True)]
    if explain:
        panels.append(Panel("Explanation", tuple(str(found.explanation).splitlines())))
    return replace(scene, title=f"{found.a.name} against {found.b.name}", nodes=tuple(nodes), panels=tuple(panels))


def _summary(found: Comparison) -> list[str]:
    apart = "They agree exactly as given." if found.agrees else f"They first differ at {found.first_departure}."
    return [
        f"Orange: {found.a.name}.",
        f"Blue: {found.b.name}.",
        f"Red: the gap between the tips, {found.max_position_error * 1e3:.4g} mm, at the worst of "
        f"{found.samples} configurations. Largest rotation error {found.max_rotation_error:.4g} rad.",
        apart,
    ]


def _stick(chain: Chain, q: Floats, colour: Colour) -> Mesh:
    """Rods from the base through the link frames to the tip."""
    points = [np.zeros(3), *chain.link_poses(q)[:, :3, 3], chain.pose(q).translation]
    return _rods(points, _radius(chain, q), colour)


def _radius(chain: Chain, q: Floats) -> float:
    points = np.array([np.zeros(3), *chain.link_poses(q)[:, :3, 3], chain.pose(q).translation])
    return ROD * max(1e-3, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()))


def _rods(points: Sequence[Floats], radius: float, colour: Colour) -> Mesh:
    """Rods between consecutive points with a ball at each, as one mesh."""
    import trimesh

    parts = []
    for start, end in itertools.pairwise(points):
        if np.linalg.norm(end - start) > 1e-9:
            parts.append(trimesh.creation.cylinder(radius, segment=[start, end], sections=16))
    for point in points if parts else ():
        ball = trimesh.creation.icosphere(2, BALL * radius)
        ball.apply_translation(point)
        parts.append(ball)
    vertices = np.vstack([part.vertices for part in parts]) if parts else np.empty((0, 3))
    faces, offset = [np.empty((0, 3), dtype=np.int64)], 0
    for part in parts:
        faces.append(np.asarray(part.faces) + offset)
        offset += len(part.vertices)
    return Mesh(vertices, np.vstack(faces), colour)


def _faint(mesh: Mesh) -> Mesh:
    red, green, blue, alpha = mesh.colour
    return replace(mesh, colour=(red, green, blue, FAINT * alpha))
