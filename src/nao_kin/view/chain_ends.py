"""Where a chain of a robot begins and ends in its scene, with a tool on the tip or a mount under the base."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.view.scene import Node, Rod

if TYPE_CHECKING:
    import pinocchio as pin

    from nao_kin.chain import Chain
    from nao_kin.urdf.elements import Colour
    from nao_kin.view.scene import Scene

__all__ = ["with_ends"]

_TOOL: Final[Colour] = (0.25, 0.27, 0.3, 1.0)  # dark grey, as steel
_THIN: Final = 0.05  # radius of the tool's rod next to its length
_SHORTEST: Final = 1e-6  # [m]


def with_ends(scene: Scene, chain: Chain) -> tuple[Scene, int, int]:
    """The scene of a chain's robot, and the nodes of the frames that its poses are given in and of.

    A tool's frame becomes a node on the tip's link, with a rod to it; a mount's frame a node on the base's link.
    """
    labels = [node.label for node in scene.nodes]
    base, tip = labels.index(str(getattr(chain, "base", ""))), labels.index(str(getattr(chain, "tip", "")))
    if getattr(chain, "is_bare", True):
        return scene, base, tip
    mount: pin.SE3 = chain.mount  # type: ignore[attr-defined]  # only chains of robots are asked
    tool: pin.SE3 = chain.tool  # type: ignore[attr-defined]
    if chain.base_name != labels[base]:
        scene, base = _hung(scene, chain.base_name, base, mount.inverse())
    if chain.tip_name != labels[tip]:
        link = tip
        scene, tip = _hung(scene, chain.tip_name, link, tool)
        length = float(np.linalg.norm(tool.translation))
        if length > _SHORTEST:
            scene = replace(scene, rods=(*scene.rods, Rod(link, tip, _TOOL, _THIN * length)))
    return scene, base, tip


def _hung(scene: Scene, label: str, parent: int, placement: pin.SE3) -> tuple[Scene, int]:
    node = Node(label, parent, None, np.asarray(placement.homogeneous))
    return replace(scene, nodes=(*scene.nodes, node)), len(scene.nodes)
