"""A DH table as the text of a URDF file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.errors import InvalidInputError
from nao_kin.se3 import rpy
from nao_kin.urdf.elements import Limit, Origin, UrdfJoint, UrdfLink
from nao_kin.urdf.writer import kinematic_xml

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.chain import ChainJoint
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["urdf_text"]

_ENDLESS = 1e9  # [m, rad] URDF has no word for a joint that is open at one end or slides without end
_NO_LINE = 0


def urdf_text(name: str, base_name: str, tip_name: str, joints: Sequence[ChainJoint], path: JointPath) -> str:
    """A URDF whose chain from base to tip is the given one: links without shape or mass, fixed placements, axes ±z.

    Args:
        name: Name of the robot.
        base_name: Name of the root link.
        tip_name: Name of the last link.
        joints: The joints, base to tip: names, kinds, limits [rad or m] and speeds.
        path: The flat form of the table, one column a joint, multipliers ±1.

    Raises:
        InvalidInputError: Base and tip bear the same name.
    """
    if base_name == tip_name:
        raise InvalidInputError(f"table {name}", "different names of base and tip", repr(base_name))
    links = [base_name, *_link_names([j.name for j in joints], {base_name, tip_name})]
    elements = [
        UrdfJoint(
            name=joint.name,
            kind="continuous" if _turns_freely(joint) else joint.kind,
            parent=links[k],
            child=links[k + 1],
            origin=_origin(path.rotations[k], path.translations[k]),
            axis=(0.0, 0.0, float(path.multipliers[k])),
            limit=_limit(joint),
            mimic=None,
            line=_NO_LINE,
        )
        for k, joint in enumerate(joints)
    ]
    end = _free_name(f"{tip_name}_fixed", {joint.name for joint in joints})
    tool = _origin(path.tool_rotation, path.tool_translation)
    elements.append(UrdfJoint(end, "fixed", links[-1], tip_name, tool, (1.0, 0.0, 0.0), None, None, _NO_LINE))
    bodies = [UrdfLink(link, (), (), None, _NO_LINE) for link in (*links, tip_name)]
    return kinematic_xml(name, bodies, elements)


def _turns_freely(joint: ChainJoint) -> bool:
    return joint.kind != "prismatic" and not (math.isfinite(joint.lower) or math.isfinite(joint.upper))


def _limit(joint: ChainJoint) -> Limit | None:
    speed = joint.max_velocity if math.isfinite(joint.max_velocity) else None
    if _turns_freely(joint):
        return None if speed is None else Limit(None, None, speed, None, _NO_LINE)
    lower, upper = max(joint.lower, -_ENDLESS), min(joint.upper, _ENDLESS)
    return Limit(lower, upper, speed, None, _NO_LINE)


def _origin(R: Floats, p: Floats) -> Origin:
    x, y, z = map(float, p)
    roll, pitch, yaw = map(float, rpy(pin.SE3(np.ascontiguousarray(R), np.asarray(p))))
    return Origin((x + 0.0, y + 0.0, z + 0.0), (roll + 0.0, pitch + 0.0, yaw + 0.0))


def _link_names(joint_names: Iterable[str], taken: set[str]) -> list[str]:
    names: list[str] = []
    for joint in joint_names:
        names.append(_free_name(f"{joint}_link", {*taken, *names}))
    return names


def _free_name(wanted: str, taken: set[str]) -> str:
    while wanted in taken:
        wanted += "_"
    return wanted
