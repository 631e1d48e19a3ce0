"""PhantomX (Trossen Robotics / Interbotix), a hexapod of 18 AX servos.

Sources: phantomx_urdf.xacro of HumaRobotics/phantomx_description for names, origins, axes, limits and masses; the
tibia's length and its direction at servo centre from params/phantomX.yaml and ik.cpp of KevinOchs/hexapod_ros.
"""

from __future__ import annotations

import math

from urdf_tables import phantomx_shapes
from urdf_tables.inertia import cuboid
from urdf_tables.model import ZERO, Joint, Limit, Link, Pose, Robot, X, frame

NAMES: tuple[str, ...] = ("phantomx",)
_PI = math.pi

_COXA_LENGTH = 0.054
_KNEE = (0.0, -0.0645, -0.0145)  # outward is -y in the thigh link, down is -z
_TIBIA_LENGTH = 0.133
_TIBIA_LEAN = 34.0  # degrees outward of straight down, 48 - 14; see the header
_LIMIT = Limit(-2.6179939, 2.6179939, 5.6548668, 2.8)  # servo range 300 degrees; 54 rpm

# Leg, x and y of the coxa joint in the body, yaw of the joint frame [rad]; the leg heads along the frame's -y.
_COXA_Z = 0.001116
_LEGS: tuple[tuple[str, float, float, float], ...] = (
    ("rf", 0.1248, -0.06164, _PI / 4),
    ("rm", 0.0, -0.1034, 0.0),
    ("rr", -0.1248, -0.06164, -_PI / 4),
    ("lf", 0.1248, 0.06164, 3 * _PI / 4),
    ("lm", 0.0, 0.1034, _PI),
    ("lr", -0.1248, 0.06164, -3 * _PI / 4),
)

_BODY_MASS, _PART_MASS = 0.9756, 0.02436
_BODY_SIZE = (0.24, 0.12, 0.06)  # of our drawing
_PART_SIZE = (0.045, 0.022, 0.0325)  # the box that stands, commented out, beside each leg part in the public file

_HEADER = (
    "PhantomX hexapod (Trossen Robotics / Interbotix), six legs of three AX servos.",
    "Sources: joint and link names, origins, axes, limits, speeds, efforts and masses from phantomx_urdf.xacro of "
    "HumaRobotics/phantomx_description, its rounded angles (4.7123, 1.5704, 3.14159) replaced by the exact multiples "
    "of pi/4 and pi/2; tibia length from params/phantomX.yaml of KevinOchs/hexapod_ros.",
    "At zero the femur axis is horizontal and perpendicular to the leg, the tibia axis is parallel to it with opposite "
    "sign. A positive j_thigh lowers the knee, a positive j_tibia swings the foot outward and up. The knee lies 12.67 "
    "degrees below the horizontal through the femur joint.",
    "Decision: the foot frames foot_rf ... foot_lr are at the tip of the tibia, 0.133 m from the knee, with the axes "
    "of the tibia link. No public file gives the tibia's direction at zero. KevinOchs' servo offsets do: at servo "
    "centre the femur points 14 degrees below the horizontal and the tibia is opened 48 degrees from the perpendicular "
    "to the femur, so it leans 48 - 14 = 34 degrees outward of straight down. At zero the feet are then 0.1929 m from "
    "the coxa axes and 0.1236 m below the body frame; standing as published (feet 0.141 m from the coxa axes, body "
    "raised) needs raised thighs: middle legs at j_thigh = -47.5 and j_tibia = -67.3 degrees put the feet there and "
    "the body 0.09 m up.",
    "Decision: the published inertias are in no consistent unit. The body is a homogeneous box of our drawing's size; "
    "each of the 24 leg parts of 0.02436 kg (c1, c2, thigh, tibia of every leg) a box of 45 x 22 x 32.5 mm, the size "
    "noted in the public file. c1 and c2 have the published centre of mass, thigh and tibia theirs half-way along the "
    "segment. The shapes are drawn by us from primitives; no vendor mesh is used.",
)


def build(name: str) -> Robot:
    """The hexapod."""
    body = Link("MP_BODY", phantomx_shapes.BODY, phantomx_shapes.BODY_COLLISION, cuboid(_BODY_MASS, ZERO, _BODY_SIZE))
    limbs = [(Joint("j_phantomx_attachment", "fixed", "base_link", "MP_BODY"), body)]
    for leg, x, y, yaw in _LEGS:
        limbs.extend(_leg(leg, Pose((x, y, _COXA_Z), (0.0, -_PI / 2, yaw))))
    return Robot(name, _HEADER, phantomx_shapes.MATERIALS, Link("base_link"), tuple(limbs))


def _leg(leg: str, coxa: Pose) -> list[tuple[Joint, Link]]:
    c1, c2, thigh, tibia = (f"{part}_{leg}" for part in ("c1", "c2", "thigh", "tibia"))
    across = Pose((0.0, -_COXA_LENGTH, 0.0), (0.0, _PI / 2, _PI))
    half_coxa = (0.0, -0.02633, 0.0)
    half_femur = (0.0, _KNEE[1] / 2, _KNEE[2] / 2)
    _, tip_y, tip_z = tip = _tip()
    return [
        (Joint(f"j_{c1}", "revolute", "MP_BODY", c1, coxa, X, _LIMIT), _part(c1, half_coxa)),
        (Joint(f"j_{c2}", "fixed", c1, c2, across), _part(c2, half_coxa)),
        (Joint(f"j_{thigh}", "revolute", c2, thigh, Pose(ZERO, (0.0, _PI, _PI)), X, _LIMIT), _part(thigh, half_femur)),
        (
            Joint(f"j_{tibia}", "revolute", thigh, tibia, Pose(_KNEE, (-_PI / 2, 0.0, _PI)), X, _LIMIT),
            _part(tibia, (0.0, tip_y / 2, tip_z / 2)),
        ),
        frame(f"foot_{leg}", tibia, tip),
    ]


def _tip() -> tuple[float, float, float]:
    """The foot in the tibia link, whose y points down and whose z points outward at zero."""
    lean = math.radians(_TIBIA_LEAN)
    return (0.0, round(_TIBIA_LENGTH * math.cos(lean), 12), round(_TIBIA_LENGTH * math.sin(lean), 12))


def _part(name: str, com: tuple[float, float, float]) -> Link:
    kind = name.split("_")[0]
    inertial = cuboid(_PART_MASS, com, _PART_SIZE)
    return Link(name, phantomx_shapes.LEG[kind], phantomx_shapes.LEG_COLLISION[kind], inertial)
