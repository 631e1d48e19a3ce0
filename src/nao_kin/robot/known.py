"""The known robots as data: where their file is, their named chains, effectors and coupled limits.

Nothing here needs Pinocchio, so the list of robots prints fast.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from nao_kin.errors import MissingExtraError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["KNOWN_ROBOTS", "CoupledLimit", "KnownRobot", "find_known", "robot_file", "robot_names"]


@dataclass(frozen=True, slots=True)
class CoupledLimit:
    """The range of `joint` [rad] at values of `by` [rad], linear between rows of (by, lower, upper).

    Attributes:
        even: True if only the size of `by` counts.
    """

    joint: str
    by: str
    table: tuple[tuple[float, float, float], ...]
    even: bool = False


@dataclass(frozen=True, slots=True)
class KnownRobot:
    """A robot that loads by name.

    Attributes:
        name: The name.
        title: What it is, for lists.
        file: File name in our own folder, or the path below the robots folder of example-robot-data.
        source: Which of the two, or that it is one of robot_descriptions.py, by its full path.
        chains: Chain name to (base frame, tip frame); the first one is the robot's main chain.
        effectors: Frames that the robot's documentation calls effectors.
        coupled_limits: Ranges that depend on another joint.
    """

    name: str
    title: str
    file: str
    source: Literal["bundled", "example-robot-data", "robot_descriptions"]
    chains: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    effectors: tuple[str, ...] = ()
    coupled_limits: tuple[CoupledLimit, ...] = ()


ALIASES: Final = {"nao": "nao_v50_h25"}

# Aldebaran NAOqi documentation, HeadPitch range by HeadYaw; the same figures stand in B-Human's headLimits.cfg.
_NAO_HEAD: Final = CoupledLimit(
    joint="HeadPitch",
    by="HeadYaw",
    even=True,
    table=(
        (0.000000, -0.671951, 0.515047),
        (0.486074, -0.671951, 0.422021),
        (0.756077, -0.548033, 0.370010),
        (0.903033, -0.479965, 0.330041),
        (1.089958, -0.430049, 0.300022),
        (1.526988, -0.330041, 0.200015),
        (2.086017, -0.449073, 0.330041),
    ),
)

# Aldebaran NAOqi documentation, LAnkleRoll range by LAnklePitch, as three independent public files transcribe it.
_NAO_LEFT_ANKLE: Final = CoupledLimit(
    joint="LAnkleRoll",
    by="LAnklePitch",
    table=(
        (-1.189442, -0.049916, 0.075049),
        (-0.840027, -0.179943, 0.169995),
        (-0.700051, -0.397935, 0.220086),
        (-0.449946, -0.397935, 0.768992),
        (0.100007, -0.397935, 0.768992),
        (0.349938, -0.397935, 0.550477),
        (0.922755, 0.000000, 0.049916),
    ),
)
_NAO_RIGHT_ANKLE: Final = CoupledLimit(
    joint="RAnkleRoll",
    by="RAnklePitch",
    table=tuple((pitch, -upper, -lower) for pitch, lower, upper in _NAO_LEFT_ANKLE.table),
)


def _nao(version: str, hands: str) -> KnownRobot:
    generation = {"v32": "V3.2", "v33": "V3.3", "v40": "V4", "v50": "V5", "v60": "V6"}[version]
    joints = {"h21": "21 motors, wrists and hands fixed", "h25": "25 motors"}[hands]
    return KnownRobot(
        name=f"nao_{version}_{hands}",
        title=f"NAO {generation} {hands.upper()}, {joints}",
        file=f"nao_{version}_{hands}.urdf",
        source="bundled",
        chains={
            "left_arm": ("torso", "LArm"),
            "right_arm": ("torso", "RArm"),
            "left_leg": ("torso", "LLeg"),
            "right_leg": ("torso", "RLeg"),
            "head": ("torso", "Head"),
        },
        effectors=("Head", "LArm", "RArm", "LLeg", "RLeg"),
        coupled_limits=(_NAO_HEAD, _NAO_LEFT_ANKLE, _NAO_RIGHT_ANKLE),
    )


def _example(name: str, title: str, file: str, **chains: tuple[str, str]) -> KnownRobot:
    return KnownRobot(name=name, title=title, file=file, source="example-robot-data", chains=chains)


_ROBOTS: Final = (
    *(_nao(version, hands) for version in ("v33", "v40", "v50", "v60") for hands in ("h21", "h25")),
    _nao("v32", "h25"),
    KnownRobot(
        name="jaco2",
        title="Kinova JACO2 j2n6s300, 6-axis arm, oblique wrist",
        file="jaco2.urdf",
        source="bundled",
        chains={"arm": ("link_base", "end_effector")},
        effectors=("end_effector",),
    ),
    KnownRobot(
        name="phantomx",
        title="Trossen PhantomX hexapod, 18 servos",
        file="phantomx.urdf",
        source="bundled",
        chains={f"leg_{leg}": ("base_link", f"foot_{leg}") for leg in ("lf", "lm", "lr", "rf", "rm", "rr")},
        effectors=tuple(f"foot_{leg}" for leg in ("lf", "lm", "lr", "rf", "rm", "rr")),
    ),
    _example("ur3", "Universal Robots UR3", "ur_description/urdf/ur3_robot.urdf", arm=("base_link", "ee_link")),
    _example("ur5", "Universal Robots UR5", "ur_description/urdf/ur5_robot.urdf", arm=("base_link", "ee_link")),
    _example("ur10", "Universal Robots UR10", "ur_description/urdf/ur10_robot.urdf", arm=("base_link", "ee_link")),
    _example("z1", "Unitree Z1", "z1_description/urdf/z1.urdf", arm=("link00", "link06")),
    _example(
        "kinova",
        "Kinova JACO2 j2s6s200, spherical wrist",
        "kinova_description/robots/kinova.urdf",
        arm=("j2s6s200_link_base", "j2s6s200_end_effector"),
    ),
    _example("panda", "Franka Emika Panda", "panda_description/urdf/panda.urdf", arm=("panda_link0", "panda_hand_tcp")),
    _example("xarm7", "UFACTORY xArm 7", "xarm_description/urdf/xarm7.urdf", arm=("link_base", "link_eef")),
    _example(
        "talos",
        "PAL Robotics TALOS humanoid, hands reduced",
        "talos_data/robots/talos_reduced.urdf",
        left_arm=("torso_2_link", "gripper_left_base_link"),
        right_arm=("torso_2_link", "gripper_right_base_link"),
        left_leg=("base_link", "left_sole_link"),
        right_leg=("base_link", "right_sole_link"),
        head=("torso_2_link", "head_2_link"),
    ),
    _example(
        "g1",
        "Unitree G1 humanoid, 29 motors",
        "g1_description/urdf/g1_29dof_rev_1_0.urdf",
        left_arm=("torso_link", "left_wrist_yaw_link"),
        right_arm=("torso_link", "right_wrist_yaw_link"),
        left_leg=("pelvis", "left_ankle_roll_link"),
        right_leg=("pelvis", "right_ankle_roll_link"),
    ),
    _example("romeo", "SoftBank Romeo humanoid", "romeo_description/urdf/romeo.urdf"),
    _example("icub", "iCub humanoid", "icub_description/robots/icub.urdf"),
    _example("baxter", "Rethink Baxter, two arms", "baxter_description/urdf/baxter.urdf"),
    _example("tiago", "PAL Robotics TIAGo, mobile manipulator", "tiago_description/robots/tiago.urdf"),
    _example("so100", "SO-ARM100, 5-axis hobby arm", "so_arm_description/urdf/so100.urdf"),
)

KNOWN_ROBOTS: Final = {robot.name: robot for robot in _ROBOTS}


def robot_names() -> tuple[str, ...]:
    """Every name that `nao_kin.load` takes, whether or not its optional files are installed."""
    return (*ALIASES, *KNOWN_ROBOTS)


def find_known(name: str) -> KnownRobot:
    """The known robot of that name or alias.

    Raises:
        UnknownNameError: There is none; carries near matches.
    """
    try:
        return KNOWN_ROBOTS[ALIASES.get(name, name)]
    except KeyError:
        raise UnknownNameError("robot", name, robot_names()) from None


def robot_file(known: KnownRobot) -> Path:
    """The URDF file of a known robot.

    Raises:
        MissingExtraError: It comes with the extra ``robots`` and that is not installed.
    """
    if known.source == "bundled":
        return _bundled_folder() / known.file
    folder = example_robot_data_share()
    if folder is None:
        raise MissingExtraError(f"Robot {known.name!r}", "robots")
    return folder / "example-robot-data" / "robots" / known.file


def example_robot_data_share() -> Path | None:
    """The share folder that example-robot-data was installed to, or None; the package has no module to ask."""
    import importlib.metadata  # which brings the parser of mail headers along

    try:
        distribution = importlib.metadata.distribution("example-robot-data")
    except importlib.metadata.PackageNotFoundError:
        return None
    return Path(str(distribution.locate_file("cmeel.prefix/share")))


def _bundled_folder() -> Path:
    """Where our own URDF files are: inside an installed wheel, or in the checkout of an editable installation."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "_data" / "urdf"
    return installed if installed.is_dir() else package.parent.parent / "urdf"
