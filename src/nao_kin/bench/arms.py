"""The chains that benchmarks run on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["MANY_CHAINS", "bundled_chains", "main_arm", "many_chains"]

# Robots and chains whose reachable targets should all be found, with what is asked of the tip.
MANY_CHAINS: tuple[tuple[str, str, Literal["pose", "position"]], ...] = (
    ("panda", "arm", "pose"),
    ("xarm7", "arm", "pose"),
    ("talos", "left_arm", "pose"),
    ("talos", "right_arm", "pose"),
    ("jaco2", "arm", "pose"),
    ("nao", "left_leg", "pose"),
    ("nao", "right_leg", "pose"),
    *(("phantomx", f"leg_{leg}", "position") for leg in ("lf", "lm", "lr", "rf", "rm", "rr")),
)


def main_arm() -> tuple[UrdfChain, list[str]]:
    """The UR5, which most of the published figures are about; without its files the JACO2, and a line that says so."""
    from nao_kin.errors import MissingExtraError
    from nao_kin.robot.robot import load

    try:
        return load("ur5").chain("arm"), []
    except MissingExtraError as error:
        return load("jaco2").chain("arm"), [f"{error} Measured on jaco2 instead."]


def bundled_chains() -> list[UrdfChain]:
    """Every named chain of every bundled robot, and a path of the NAO that runs up the tree and down again."""
    from nao_kin.robot.known import KNOWN_ROBOTS
    from nao_kin.robot.robot import load

    robots = [load(name) for name, known in KNOWN_ROBOTS.items() if known.source == "bundled"]
    chains = [robot.chain(name) for robot in robots for name in robot.chain_frames]
    return [*chains, *(robot.chain("l_sole", "r_gripper") for robot in robots if "r_gripper" in robot.frame_names)]


def many_chains() -> tuple[list[tuple[UrdfChain, Literal["pose", "position"]]], list[str]]:
    """`MANY_CHAINS` as far as their files are installed, and a line for each robot that is missing."""
    from nao_kin.errors import MissingExtraError
    from nao_kin.robot.robot import load

    found, missing = [], dict[str, str]()
    for robot, chain, kind in MANY_CHAINS:
        try:
            found.append((load(robot).chain(chain), kind))
        except MissingExtraError as error:
            missing[robot] = f"Left out: {error}"
    return found, list(missing.values())
