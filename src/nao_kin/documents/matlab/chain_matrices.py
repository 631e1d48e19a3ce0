"""MATLAB example: the matrices and helper functions of its kinematic chains, as printed.

Lengths in any one unit; the example uses millimetres. Matrices are homogeneous (4, 4).
"""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pinocchio as pin

from nao_kin.chain import random_configurations
from nao_kin.documents.claim import Claim, Measured
from nao_kin.documents.samples import deviation
from nao_kin.robot.robot import load
from nao_kin.se3 import translation

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = [
    "CLAIMS",
    "a_2_head",
    "a_base_0",
    "example_parameters",
    "example_parameters_of_v33",
    "get_a",
    "get_r",
    "get_t",
    "head_chain",
    "left_hand_chain",
    "left_hand_chain_corrected",
    "r_x",
    "r_y",
    "t_01",
    "t_12",
]


def a_base_0(NeckOffsetZ: float) -> Floats:
    """ABase0."""
    return np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, NeckOffsetZ], [0, 0, 0, 1]])


def t_01(theta_1: float) -> Floats:
    """T01."""
    return np.array(
        [[cos(theta_1), -sin(theta_1), 0, 0], [sin(theta_1), cos(theta_1), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    )


def t_12(theta_2: float) -> Floats:
    """T12."""
    return np.array(
        [
            [cos(theta_2 - pi / 2), -sin(theta_2 - pi / 2), 0, 0],
            [0, 0, 1, 0],
            [-sin(theta_2 - pi / 2), -cos(theta_2 - pi / 2), 0, 0],
            [0, 0, 0, 1],
        ]
    )


def r_x() -> Floats:
    """Rx."""
    return np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def r_y() -> Floats:
    """Ry."""
    return np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


def a_2_head(CameraX: float, CameraZ: float) -> Floats:
    """A2Head."""
    return np.array([[1, 0, 0, CameraX], [0, 1, 0, 0], [0, 0, 1, CameraZ], [0, 0, 0, 1]])


def get_a(vec: tuple[float, float, float]) -> Floats:
    """Helper getA."""
    return np.array([[1, 0, 0, vec[0]], [0, 1, 0, vec[1]], [0, 0, 1, vec[2]], [0, 0, 0, 1]])


def get_r(orientation: str, theta: float) -> Floats:
    """Helper getR."""
    c, s = cos(theta), sin(theta)
    return {
        "x": np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]]),
        "y": np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]]),
        "z": np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
    }[orientation]


def get_t(a: float, alpha: float, d: float, theta: float) -> Floats:
    """Helper getT."""
    return np.array(
        [
            [cos(theta), -sin(theta), 0, a],
            [sin(theta) * cos(alpha), cos(theta) * cos(alpha), -sin(alpha), -sin(alpha) * d],
            [sin(theta) * sin(alpha), cos(theta) * sin(alpha), cos(alpha), cos(alpha) * d],
            [0, 0, 0, 1],
        ]
    )


def head_chain(theta_1: float, theta_2: float, CameraX: float, CameraZ: float, NeckOffsetZ: float) -> Floats:
    """T = ABase0*T01*T12*Rx*Ry*A2Head."""
    return a_base_0(NeckOffsetZ) @ t_01(theta_1) @ t_12(theta_2) @ r_x() @ r_y() @ a_2_head(CameraX, CameraZ)


def left_hand_chain(theta: Floats, lengths: dict[str, float]) -> Floats:
    """ABase0*T01*T12*T32*T43*Rz*AEnd4 of getKinematicChain('lefthand'); lengths by the manufacturer's names."""
    a_base = get_a((0, lengths["ShoulderOffsetY"] + lengths["ElbowOffsetY"], lengths["ShoulderOffsetZ"]))
    a_end = get_a((lengths["HandOffsetX"] + lengths["LowerArmLength"], 0, 0))
    t01 = get_t(0, -pi / 2, 0, theta[0])
    t12 = get_t(0, pi / 2, 0, theta[1] - pi / 2)
    t32 = get_t(0, -pi / 2, lengths["UpperArmLength"], theta[2])
    t43 = get_t(0, pi / 2, 0, theta[3])
    return a_base @ t01 @ t12 @ t32 @ t43 @ get_r("z", pi / 2) @ a_end


def left_hand_chain_corrected(theta: Floats, lengths: dict[str, float]) -> Floats:
    """The same with ElbowOffsetY where the elbow is, and with HandOffsetZ."""
    a_base = get_a((0, lengths["ShoulderOffsetY"], lengths["ShoulderOffsetZ"]))
    a_end = get_a((lengths["HandOffsetX"] + lengths["LowerArmLength"], 0, -lengths["HandOffsetZ"]))
    t01 = get_t(0, -pi / 2, 0, theta[0])
    t12 = get_t(0, pi / 2, 0, theta[1] - pi / 2)
    t32 = get_t(-lengths["ElbowOffsetY"], -pi / 2, lengths["UpperArmLength"], theta[2])
    t43 = get_t(0, pi / 2, 0, theta[3])
    return a_base @ t01 @ t12 @ t32 @ t43 @ get_r("z", pi / 2) @ a_end


def example_parameters() -> tuple[float, float, float]:
    """CameraX, CameraZ and NeckOffsetZ of the verification run [mm]."""
    return 53.9, 67.9, -5.0


def example_parameters_of_v33() -> tuple[float, float, float]:
    """The same of a NAO V3.3 (NAOqi documentation) [mm]."""
    return 53.9, 67.9, 126.5


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
        a_base_0,
        _against(lambda z: translation(0.0, 0.0, z), 1),
        place=_STEP_2,
    ),
    _claim(
        "T01",
        "The head's yaw, a rotation about z.",
        "T01 = [cos θ_1, −sin θ_1, 0, 0; sin θ_1, cos θ_1, 0, 0; 0 0 1 0; 0 0 0 1]",
        r"T_{0,1} = \begin{pmatrix} \cos\theta_1&-\sin\theta_1&0&0\\\sin\theta_1&\cos\theta_1&0&0\\0&0&1&0\\0&0&0&1 "
        r"\end{pmatrix}",
        t_01,
        _against(lambda t: _turn("z", t), 1),
        place=_STEP_2,
    ),
    _claim(
        "T12",
        "The head's pitch, the second joint's matrix with its offset of −π/2.",
        "T12 = [cos φ, −sin φ, 0, 0; 0 0 1 0; −sin φ, −cos φ, 0, 0; 0 0 0 1],\nφ = θ_2 − π/2",
        r"T_{1,2} = \begin{pmatrix} \cos(\theta_2-\frac{\pi}{2})&-\sin(\theta_2-\frac{\pi}{2})&0&0\\0&0&1&0\\"
        r"-\sin(\theta_2-\frac{\pi}{2})&-\cos(\theta_2-\frac{\pi}{2})&0&0\\0&0&0&1 \end{pmatrix}",
        t_12,
        _against(lambda t: _modified(0.0, -pi / 2, 0.0, t - pi / 2), 1),
        reference="Rx(−π/2) Rz(θ_2 − π/2), the modified (proximal) matrix of α = −π/2",
        place=_STEP_2,
    ),
    _claim(
        "Rx",
        "The roll that undoes the first half of the table's axes.",
        "Rx = [1 0 0 0; 0 0 −1 0; 0 1 0 0; 0 0 0 1]",
        r"R_x = \begin{pmatrix} 1&0&0&0\\0&0&-1&0\\0&1&0&0\\0&0&0&1 \end{pmatrix}",
        r_x,
        _against(lambda: _turn("x", pi / 2), 0),
        domain="the one matrix: getR('x', π/2)",
        place=_STEP_2,
    ),
    _claim(
        "Ry",
        "The pitch that undoes the other half.",
        "Ry = [0 0 1 0; 0 1 0 0; −1 0 0 0; 0 0 0 1]",
        r"R_y = \begin{pmatrix} 0&0&1&0\\0&1&0&0\\-1&0&0&0\\0&0&0&1 \end{pmatrix}",
        r_y,
        _against(lambda: _turn("y", pi / 2), 0),
        domain="the one matrix: getR('y', π/2)",
        place=_STEP_2,
    ),
    _claim(
        "A2Head",
        "From the neck to the camera.",
        "A2Head = [1 0 0 CameraX; 0 1 0 0; 0 0 1 CameraZ; 0 0 0 1]",
        r"A_{2,Head} = \begin{pmatrix} 1&0&0&CameraX\\0&1&0&0\\0&0&1&CameraZ\\0&0&0&1 \end{pmatrix}",
        a_2_head,
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
        get_t,
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
        get_r,
        _helper_r,
        domain="100 angles about each axis",
        place=_HELPERS,
    ),
    _claim(
        "getA",
        "A translation.",
        "getA(v) = [1 0 0 v_1; 0 1 0 v_2; 0 0 1 v_3; 0 0 0 1]",
        r"A = \begin{pmatrix} 1&0&0&v_1\\0&1&0&v_2\\0&0&1&v_3\\0&0&0&1 \end{pmatrix}",
        get_a,
        _helper_a,
        place=_HELPERS,
    ),
    _claim(
        "head-chain",
        "From the torso to the camera of the head.",
        "T = ABase0*T01*T12*Rx*Ry*A2Head",
        r"T = A_{Base,0} \, T_{0,1} \, T_{1,2} \, R_x \, R_y \, A_{2,Head}",
        head_chain,
        _head,
        reference="Pinocchio on the NAO V3.3's model, torso to CameraTop_frame",
        domain="100 configurations inside the limits, position and orientation",
        unit="m, 1",
        place=_STEP_2,
    ),
)
