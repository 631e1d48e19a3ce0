"""MATLAB example: its matrices and chains held against rotations, translations and Pinocchio's model of the robot."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pinocchio as pin

from nao_kin.chain import random_configurations
from nao_kin.documents import matlab_matrices as printed
from nao_kin.documents.claim import Claim, Measured
from nao_kin.documents.samples import deviation
from nao_kin.robot.robot import load
from nao_kin.se3 import translation

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS"]

_COUNT, _SEED = 100, 8
_ROBOT: Final = "nao_v33_h25"
_RIGID: Final = "the rotation or translation of that name, by Pinocchio"
_ANY: Final = "100 random angles and lengths"


def _turn(axis: str, angle: float) -> pin.SE3:
    return pin.SE3(pin.utils.rotate(axis, angle), np.zeros(3))


def _against(wanted: Callable[..., pin.SE3], arguments: int) -> Check:
    """A check of a matrix against a rigid transform made of the same random arguments."""

    def check(form: Form) -> Measured:
        drawn = np.random.default_rng(_SEED).uniform(-2.0, 2.0, (_COUNT, arguments))
        return Measured.worst([deviation(form(*x), wanted(*x).homogeneous) for x in drawn])

    return check


def _helper_a(form: Form) -> Measured:
    drawn = np.random.default_rng(_SEED).uniform(-2.0, 2.0, (_COUNT, 3))
    return Measured.worst([deviation(form(tuple(x)), translation(*x).homogeneous) for x in drawn])


def _helper_r(form: Form) -> Measured:
    drawn = np.random.default_rng(_SEED).uniform(-pi, pi, _COUNT)
    cases = [(axis, x) for axis in "xyz" for x in drawn]
    return Measured.worst(
        [deviation(form(axis, x), _turn(axis, x).homogeneous) for axis, x in cases], lambda i: f"about {cases[i][0]}"
    )


def _standard(a: float, alpha: float, d: float, theta: float) -> pin.SE3:
    return _turn("z", theta) * translation(0.0, 0.0, d) * translation(a, 0.0, 0.0) * _turn("x", alpha)


def _modified(a: float, alpha: float, d: float, theta: float) -> pin.SE3:
    return _turn("x", alpha) * translation(a, 0.0, 0.0) * _turn("z", theta) * translation(0.0, 0.0, d)


def _head(form: Form) -> Measured:
    """Against the camera of the robot, with the robot's own lengths."""
    robot = load(_ROBOT)
    chain = robot.chain("torso", "CameraTop_frame")
    neck = float(robot.pose({}, "Head").translation[2])
    x, _, z = (float(value) for value in robot.pose({}, "CameraTop_frame", base="Head").translation)
    Q = random_configurations(chain, _COUNT, np.random.default_rng(_SEED))
    return Measured.worst(
        [deviation(form(*q, x, z, neck), chain.pose(q).homogeneous) for q in Q],
        found=f"With CameraX = {1e3 * x:.1f}, CameraZ = {1e3 * z:.1f} and NeckOffsetZ = {1e3 * neck:.1f} mm.",
    )


def _claim(name: str, said: str, formula: str, latex: str, form: Form, check: Check, **more: Any) -> Claim:
    more = {"reference": _RIGID, "domain": _ANY, **more}
    return Claim(id=f"004:{name}", said=said, formula=formula, latex=latex, printed=form, check=check, **more)


_STEP_2: Final = "step 2"
_HELPERS: Final = "helper functions"

CLAIMS: Final = (
    _claim(
        "ABase0",
        "From the torso to the neck: up by NeckOffsetZ.",
        "ABase0 = [1 0 0 0; 0 1 0 0; 0 0 1 NeckOffsetZ; 0 0 0 1]",
        r"A_{Base,0} = \begin{pmatrix} 1&0&0&0\\0&1&0&0\\0&0&1&NeckOffsetZ\\0&0&0&1 \end{pmatrix}",
        printed.a_base_0,
        _against(lambda z: translation(0.0, 0.0, z), 1),
        place=_STEP_2,
    ),
    _claim(
        "T01",
        "The head's yaw, a rotation about z.",
        "T01 = [cos θ_1, −sin θ_1, 0, 0; sin θ_1, cos θ_1, 0, 0; 0 0 1 0; 0 0 0 1]",
        r"T_{0,1} = \begin{pmatrix} \cos\theta_1&-\sin\theta_1&0&0\\\sin\theta_1&\cos\theta_1&0&0\\0&0&1&0\\0&0&0&1 "
        r"\end{pmatrix}",
        printed.t_01,
        _against(lambda t: _turn("z", t), 1),
        place=_STEP_2,
    ),
    _claim(
        "T12",
        "The head's pitch, the second joint's matrix with its offset of −π/2.",
        "T12 = [cos φ, −sin φ, 0, 0; 0 0 1 0; −sin φ, −cos φ, 0, 0; 0 0 0 1],\nφ = θ_2 − π/2",
        r"T_{1,2} = \begin{pmatrix} \cos(\theta_2-\frac{\pi}{2})&-\sin(\theta_2-\frac{\pi}{2})&0&0\\0&0&1&0\\"
        r"-\sin(\theta_2-\frac{\pi}{2})&-\cos(\theta_2-\frac{\pi}{2})&0&0\\0&0&0&1 \end{pmatrix}",
        printed.t_12,
        _against(lambda t: _modified(0.0, -pi / 2, 0.0, t - pi / 2), 1),
        reference="Rx(−π/2) Rz(θ_2 − π/2), the modified (proximal) matrix of α = −π/2",
        place=_STEP_2,
    ),
    _claim(
        "Rx",
        "The roll that undoes the first half of the table's axes.",
        "Rx = [1 0 0 0; 0 0 −1 0; 0 1 0 0; 0 0 0 1]",
        r"R_x = \begin{pmatrix} 1&0&0&0\\0&0&-1&0\\0&1&0&0\\0&0&0&1 \end{pmatrix}",
        printed.r_x,
        _against(lambda: _turn("x", pi / 2), 0),
        domain="the one matrix: getR('x', π/2)",
        place=_STEP_2,
    ),
    _claim(
        "Ry",
        "The pitch that undoes the other half.",
        "Ry = [0 0 1 0; 0 1 0 0; −1 0 0 0; 0 0 0 1]",
        r"R_y = \begin{pmatrix} 0&0&1&0\\0&1&0&0\\-1&0&0&0\\0&0&0&1 \end{pmatrix}",
        printed.r_y,
        _against(lambda: _turn("y", pi / 2), 0),
        domain="the one matrix: getR('y', π/2)",
        place=_STEP_2,
    ),
    _claim(
        "A2Head",
        "From the neck to the camera.",
        "A2Head = [1 0 0 CameraX; 0 1 0 0; 0 0 1 CameraZ; 0 0 0 1]",
        r"A_{2,Head} = \begin{pmatrix} 1&0&0&CameraX\\0&1&0&0\\0&0&1&CameraZ\\0&0&0&1 \end{pmatrix}",
        printed.a_2_head,
        _against(lambda x, z: translation(x, 0.0, z), 2),
        place=_STEP_2,
    ),
    _claim(
        "getT",
        "The Denavit-Hartenberg matrix.",
        "T = [cos θ, −sin θ, 0, a;\n     sin θ cos α, cos θ cos α, −sin α, −d sin α;\n"
        "     sin θ sin α, cos θ sin α, cos α, d cos α;\n     0 0 0 1]",
        r"T = \begin{pmatrix} \cos\theta&-\sin\theta&0&a\\ \sin\theta\cos\alpha&\cos\theta\cos\alpha&-\sin\alpha&"
        r"-d\sin\alpha\\ \sin\theta\sin\alpha&\cos\theta\sin\alpha&\cos\alpha&d\cos\alpha\\0&0&0&1 \end{pmatrix}",
        printed.get_t,
        _against(_standard, 4),
        reference="products of rotations and translations; as it stands in the standard order Rz Tz Tx Rx",
        conventions={"the convention is the modified (proximal, Craig) one, Rx Tx Rz Tz": _against(_modified, 4)},
        place=_HELPERS,
    ),
    _claim(
        "getA-getR",
        "Rotations about x, y and z; the translation getA has a row of its own.",
        "getR('x', θ) = [1 0 0 0; 0 c −s 0; 0 s c 0; 0 0 0 1]\ngetR('y', θ) = [c 0 s 0; 0 1 0 0; −s 0 c 0; 0 0 0 1]\n"
        "getR('z', θ) = [c −s 0 0; s c 0 0; 0 0 1 0; 0 0 0 1]",
        "",
        printed.get_r,
        _helper_r,
        domain="100 angles about each axis",
        place=_HELPERS,
    ),
    _claim(
        "getA",
        "A translation.",
        "getA(v) = [1 0 0 v_1; 0 1 0 v_2; 0 0 1 v_3; 0 0 0 1]",
        r"A = \begin{pmatrix} 1&0&0&v_1\\0&1&0&v_2\\0&0&1&v_3\\0&0&0&1 \end{pmatrix}",
        printed.get_a,
        _helper_a,
        place=_HELPERS,
    ),
    _claim(
        "head-chain",
        "From the torso to the camera of the head.",
        "T = ABase0*T01*T12*Rx*Ry*A2Head",
        r"T = A_{Base,0} \, T_{0,1} \, T_{1,2} \, R_x \, R_y \, A_{2,Head}",
        printed.head_chain,
        _head,
        reference="Pinocchio on the NAO V3.3's model, torso to CameraTop_frame",
        domain="100 configurations inside the limits, position and orientation",
        unit="m, 1",
        place=_STEP_2,
    ),
)
