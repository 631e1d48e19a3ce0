"""Bischoff 2016, section 2.2.1: coordinate transforms, (2.2.1.1) to (2.2.1.7), as printed."""

from __future__ import annotations

from math import cos, sin
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.documents.claim import Claim, Measured
from nao_kin.documents.samples import deviation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS", "eq_2_2_1_1", "eq_2_2_1_2", "eq_2_2_1_3"]

_COUNT, _SEED = 200, 2210
_AXES: Final = np.eye(3)


def eq_2_2_1_1(t: float) -> Floats:
    """(2.2.1.1): R_x."""
    return np.array([[1, 0, 0], [0, cos(t), -sin(t)], [0, sin(t), cos(t)]])


def eq_2_2_1_2(t: float) -> Floats:
    """(2.2.1.2): R_y."""
    return np.array([[cos(t), 0, sin(t)], [0, 1, 0], [-sin(t), 0, cos(t)]])


def eq_2_2_1_3(t: float) -> Floats:
    """(2.2.1.3): R_z."""
    return np.array([[cos(t), -sin(t), 0], [sin(t), cos(t), 0], [0, 0, 1]])


def eq_2_2_1_4(rotations: Sequence[Floats], p_n: Floats) -> Floats:
    """(2.2.1.4): the product in the order of the frames, applied to p_n."""
    n = len(rotations)
    product = rotations[0]
    for i in range(1, n):
        product = product @ rotations[i]
    return product @ p_n


def fixed_axes_remark(rotations: Sequence[Floats], p: Floats) -> Floats:
    """The remark after (2.2.1.4): turns about axes of frame 0 one after another, multiplied in reversed order."""
    product = np.eye(3)
    for rotation in reversed(rotations):
        product = product @ rotation
    return product @ p


def eq_2_2_1_5(R: Floats, d: Floats) -> Floats:
    """(2.2.1.5): H, of a rotation and a displacement."""
    return np.vstack([np.column_stack([R, d]), [0, 0, 0, 1]])


def turned_about_d(R: Floats, d: Floats, p: Floats) -> Floats:
    """The text after (2.2.1.5): H turns about the place that d shows."""
    turned: Floats = eq_2_2_1_5(R, d)[:3] @ np.array([*p, 1])
    return turned


def worked_example() -> tuple[Floats, Floats]:
    """The example after (2.2.1.5): the matrix and its product with the vector."""
    H = np.array([[0, -1, 0, 0], [1, 0, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1]])
    return H, np.array([0, 6, 0, 1])


def eq_2_2_1_6(R: Floats) -> Floats:
    """(2.2.1.6): R⁻¹."""
    return R.T


def eq_2_2_1_7(R: Floats, d: Floats) -> Floats:
    """(2.2.1.7): H⁻¹."""
    return np.vstack([np.column_stack([R.T, -R.T @ d]), [0, 0, 0, 1]])


def _turn(axis: Floats, angle: float) -> Floats:
    """Rodrigues' rotation, by Pinocchio."""
    return np.asarray(pin.exp3(axis * angle))


def _poses(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """A rotation (3, 3) and a displacement (3,)."""
    return _turn(rng.normal(size=3), 1.0), rng.uniform(-1.0, 1.0, 3)


def _as_turn_about(axis: int) -> Check:
    def check(form: Form) -> Measured:
        angles = np.random.default_rng(_SEED).uniform(-np.pi, np.pi, _COUNT)
        return Measured.worst(
            (deviation(form(t), _turn(_AXES[axis], t)) for t in angles), lambda k: f"θ = {angles[k]:.3f} rad"
        )

    return check


def _chain_of_frames(form: Form) -> Measured:
    """A vector carried from frame to frame, from the last to frame 0, one rotation at a time."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        rotations, p_n = [_poses(rng)[0] for _ in range(int(rng.integers(2, 6)))], rng.uniform(-1.0, 1.0, 3)
        p_0 = p_n
        for R in reversed(rotations):
            p_0 = pin.Quaternion(R) * p_0
        errors.append(deviation(form(rotations, p_n), p_0))
    return Measured.worst(errors)


def _successive_turns(form: Form) -> Measured:
    """A vector turned about axes of frame 0 one after another."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        rotations = [
            _turn(_AXES[axis], angle)
            for axis, angle in zip(rng.integers(0, 3, 4), rng.uniform(-3.0, 3.0, 4), strict=True)
        ]
        p = rng.uniform(-1.0, 1.0, 3)
        turned = p
        for R in rotations:
            turned = pin.Quaternion(R) * turned
        errors.append(deviation(form(rotations, p), turned))
    return Measured.worst(errors)


def _as_pose(form: Form) -> Measured:
    rng = np.random.default_rng(_SEED)
    cases = [_poses(rng) for _ in range(_COUNT)]
    return Measured.worst(deviation(form(R, d), pin.SE3(R, d).homogeneous) for R, d in cases)


def _about_a_fixed_point(form: Form) -> Measured:
    """Active reading: p and its image in one frame, d the centre; d itself stays, p turns about it."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        (R, d), p = _poses(rng), rng.uniform(-1.0, 1.0, 3)
        errors.append(deviation(form(R, d, p), d + R @ (p - d)))
    return Measured.worst(errors, found="What H leaves in place is (E − R)⁻¹ d, not d.")


def _about_its_own_origin(form: Form) -> Measured:
    """Passive reading: p counted in the turned frame, whose origin is at d; its image turns about d as R does."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        (R, d), (S, _), p = _poses(rng), _poses(rng), rng.uniform(-1.0, 1.0, 3)
        before, after = form(R, d, p), form(S @ R, d, p)
        errors.append(deviation(after, d + S @ (before - d)))
    return Measured.worst(errors)


def _example(form: Form) -> Measured:
    H, p_0 = form()
    wanted = pin.SE3(_turn(_AXES[2], np.pi / 2), np.array([0.0, 5.0, 0.0]))
    moved = wanted.act(np.array([1.0, 0.0, 0.0]))
    found = f"p_0 = ({', '.join(f'{x:.0f}' for x in moved)}, 1)"
    return Measured.worst([deviation(H, wanted.homogeneous), deviation(p_0, [*moved, 1.0])], found=found)


def _inverse_rotation(form: Form) -> Measured:
    rng = np.random.default_rng(_SEED)
    rotations = [_poses(rng)[0] for _ in range(_COUNT)]
    return Measured.worst(deviation(form(R), np.linalg.inv(R)) for R in rotations)


def _inverse_pose(form: Form) -> Measured:
    rng = np.random.default_rng(_SEED)
    cases = [_poses(rng) for _ in range(_COUNT)]
    return Measured.worst(deviation(form(R, d), np.linalg.inv(pin.SE3(R, d).homogeneous)) for R, d in cases)


_ANGLES = "200 angles in [−π, π]; holds for all"
_RIGID = "200 random rotations, displacements within ±1; holds for all"
_RODRIGUES = "rotation about the axis by Rodrigues' formula (Pinocchio)"

CLAIMS: Final = (
    Claim(
        id="000:2.2.1.1",
        place="equation (2.2.1.1)",
        said="The rotation about x by θ.",
        formula="R_x,θ = [[1, 0, 0], [0, cos θ, −sin θ], [0, sin θ, cos θ]]",
        latex=r"R_{x,\theta} = \begin{pmatrix} 1 & 0 & 0 \\ 0 & \cos\theta & -\sin\theta \\"
        r" 0 & \sin\theta & \cos\theta \end{pmatrix}",
        printed=eq_2_2_1_1,
        check=_as_turn_about(0),
        reference=_RODRIGUES,
        domain=_ANGLES,
    ),
    Claim(
        id="000:2.2.1.2",
        place="equation (2.2.1.2)",
        said="The rotation about y by θ.",
        formula="R_y,θ = [[cos θ, 0, sin θ], [0, 1, 0], [−sin θ, 0, cos θ]]",
        latex=r"R_{y,\theta} = \begin{pmatrix} \cos\theta & 0 & \sin\theta \\ 0 & 1 & 0 \\"
        r" -\sin\theta & 0 & \cos\theta \end{pmatrix}",
        printed=eq_2_2_1_2,
        check=_as_turn_about(1),
        reference=_RODRIGUES,
        domain=_ANGLES,
    ),
    Claim(
        id="000:2.2.1.3",
        place="equation (2.2.1.3)",
        said="The rotation about z by θ.",
        formula="R_z,θ = [[cos θ, −sin θ, 0], [sin θ, cos θ, 0], [0, 0, 1]]",
        latex=r"R_{z,\theta} = \begin{pmatrix} \cos\theta & -\sin\theta & 0 \\"
        r" \sin\theta & \cos\theta & 0 \\ 0 & 0 & 1 \end{pmatrix}",
        printed=eq_2_2_1_3,
        check=_as_turn_about(2),
        reference=_RODRIGUES,
        domain=_ANGLES,
    ),
    Claim(
        id="000:2.2.1.4",
        place="equation (2.2.1.4)",
        said="Rotations between neighbouring frames are multiplied in the order of the frames.",
        formula="p_0 = ( Π_{i=0}^{n−1} R_i^{i+1} ) p_n",
        latex=r"\vec p_0 = \left( \prod_{i=0}^{n-1} R_i^{i+1} \right) \vec p_n",
        printed=eq_2_2_1_4,
        check=_chain_of_frames,
        reference="the vector carried from frame to frame by quaternions",
        domain="200 chains of 2 to 5 random rotations; holds for all",
    ),
    Claim(
        id="000:2.2.1-fixed-axes-remark",
        place="text after (2.2.1.4)",
        said="With all angles about axes of frame 0, the order of multiplication is reversed.",
        formula="p_0 = R_n … R_2 R_1 p",
        latex=r"\vec p_0 = R_n \cdots R_2 R_1 \vec p",
        printed=fixed_axes_remark,
        check=_successive_turns,
        reference="the vector turned about fixed axes one after another by quaternions",
        domain="200 sequences of four turns about axes of frame 0; holds for all",
    ),
    Claim(
        id="000:2.2.1.5",
        place="equation (2.2.1.5)",
        said="A rotation and a displacement as one homogeneous matrix.",
        formula="H = [[R, d], [0, 1]]",
        latex=r"H = \begin{pmatrix} R & \vec d \\ 0 & 1 \end{pmatrix}",
        printed=eq_2_2_1_5,
        check=_as_pose,
        reference="Pinocchio's SE3",
        domain=_RIGID,
    ),
    Claim(
        id="000:2.2.1-rotate-about-d",
        place="text after (2.2.1.5)",
        said="H turns about the place that d shows instead of about the origin.",
        formula="p ↦ R p + d turns about d",
        latex=r"\vec p \mapsto R\,\vec p + \vec d",
        printed=turned_about_d,
        check=_about_a_fixed_point,
        reference="the turn about a point, d + R (p − d), by quaternions and Pinocchio's rotations",
        domain=_RIGID,
        conventions={
            "p is counted in the turned frame, whose origin is at d: there its image goes round d. With p and its image"
            " in one frame the turn about d is R p + d − R d": _about_its_own_origin
        },
    ),
    Claim(
        id="000:2.2.1-worked-example",
        place="example after (2.2.1.5)",
        said="A quarter turn about z and 5 along y take (1, 0, 0) to (0, 6, 0).",
        formula="[[0, −1, 0, 0], [1, 0, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1]] (1, 0, 0, 1)ᵀ\n  = (0, 6, 0, 1)ᵀ",
        latex=r"\begin{pmatrix} 0&-1&0&0\\1&0&0&5\\0&0&1&0\\0&0&0&1 \end{pmatrix}"
        r"\begin{pmatrix}1\\0\\0\\1\end{pmatrix} = \begin{pmatrix}0\\6\\0\\1\end{pmatrix}",
        printed=worked_example,
        check=_example,
        reference="Pinocchio's SE3 of the same turn and displacement",
        domain="the one example",
    ),
    Claim(
        id="000:2.2.1.6",
        place="equation (2.2.1.6)",
        said="The inverse of a rotation is its transpose.",
        formula="R⁻¹ = Rᵀ",
        latex=r"R^{-1} = R^T",
        printed=eq_2_2_1_6,
        check=_inverse_rotation,
        reference="Gauss elimination (LAPACK)",
        domain=_RIGID,
    ),
    Claim(
        id="000:2.2.1.7",
        place="equation (2.2.1.7)",
        said="The inverse of a homogeneous matrix.",
        formula="H⁻¹ = [[Rᵀ, −Rᵀ d], [0, 1]]",
        latex=r"H^{-1} = \begin{pmatrix} R^T & -R^T \vec d \\ 0 & 1 \end{pmatrix}",
        printed=eq_2_2_1_7,
        check=_inverse_pose,
        reference="Gauss elimination (LAPACK)",
        domain=_RIGID,
    ),
)
