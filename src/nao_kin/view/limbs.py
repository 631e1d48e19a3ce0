"""A robot's joints by limb, as a person would look for them, and its legs if it walks on more than two."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from nao_kin.view.scene import Leg

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nao_kin.robot.robot import Robot
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["legs_of", "limbs", "main_tip"]

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


def legs_of(robot: Robot, index: Mapping[str, int]) -> tuple[Leg, ...]:
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


def _leg(name: str, chain: UrdfChain, index: Mapping[str, int]) -> Leg | None:
    from nao_kin.analytic.form import Mismatch
    from nao_kin.analytic.hexapod.hexapod_leg import recognise

    geometry = recognise(chain.joint_path)
    if isinstance(geometry, Mismatch):
        return None
    title = name.removeprefix("leg_").upper()
    numbers = tuple(float(number) for number in geometry.parameters)
    return Leg(title, index[chain.base], index[chain.tip], chain.joint_names, numbers)
