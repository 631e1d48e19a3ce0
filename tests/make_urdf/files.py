"""Our own robots' files as the tests see them: their elements, and their frames by Pinocchio."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

ROOT = Path(__file__).resolve().parent.parent.parent
NAO_H25 = ("nao_v32_h25", "nao_v33_h25", "nao_v40_h25", "nao_v50_h25", "nao_v60_h25")
NAO_H21 = ("nao_v33_h21", "nao_v40_h21", "nao_v50_h21", "nao_v60_h21")
NAO = NAO_H25 + NAO_H21
ROBOTS = (*NAO, "jaco2", "phantomx")


@cache
def tree(robot: str) -> etree._Element:
    return etree.parse(ROOT / "urdf" / f"{robot}.urdf").getroot()


@cache
def model(robot: str) -> pin.Model:
    return pin.buildModelFromUrdf(str(ROOT / "urdf" / f"{robot}.urdf"))


def floats(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def joints(robot: str) -> dict[str, etree._Element]:
    return {joint.attrib["name"]: joint for joint in tree(robot).iter("joint")}


def links(robot: str) -> dict[str, etree._Element]:
    return {link.attrib["name"]: link for link in tree(robot).iter("link")}


def limit(robot: str, joint: str) -> dict[str, float]:
    return {key: float(value) for key, value in joints(robot)[joint].find("limit").attrib.items()}


def placement(robot: str, frame: str, base: str, posture: dict[str, float] | None = None) -> pin.SE3:
    """Pose of a frame in another; a continuous joint takes (cos, sin) in Pinocchio's configuration."""
    the_model = model(robot)
    data, q = the_model.createData(), pin.neutral(the_model)
    for name, angle in (posture or {}).items():
        assert the_model.existJointName(name)
        joint = the_model.joints[the_model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
    pin.framesForwardKinematics(the_model, data, q)
    assert the_model.existFrame(frame, pin.BODY)
    assert the_model.existFrame(base, pin.BODY)
    ids = [the_model.getFrameId(name, pin.BODY) for name in (base, frame)]
    return data.oMf[ids[0]].actInv(data.oMf[ids[1]])


def inertia(link: etree._Element) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (
        float(link.find("inertial/inertia").attrib[f"i{key}"]) for key in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
