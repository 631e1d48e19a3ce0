"""Practicum, tasks 1b and 1d: the check matrix, the sixth column, and a Jacobian from transforms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.chain import random_configurations
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.practicum import newtons_method as printed
from nao_kin.documents.practicum.practicum_sheet import CHECK_Q_DEG, arm, jaco2
from nao_kin.documents.samples import derivative, deviation, relative

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Form

__all__ = ["CLAIMS"]

_COUNT, _SEED = 40, 5
_DIGITS: Final = np.array([[1e-3] * 3 + [1e-2], [1e-3] * 3 + [1e-4], [1e-3] * 3 + [1e-3], [1e-3] * 4])
"""What the last printed digit of each entry is worth [1, m]; nought and one are taken as rounded to three decimals."""


def _check_matrix(form: Form) -> Measured:
    """Deviation from Pinocchio in last printed digits."""
    q = np.radians(CHECK_Q_DEG)
    by_model, by_table = arm().pose(q).homogeneous, jaco2().pose(q).homogeneous
    stated = np.array(form())
    off = np.abs(stated - by_model) / _DIGITS
    row, column = np.unravel_index(int(off.argmax()), off.shape)
    position = 1e3 * (stated - by_model)[:3, 3]
    return Measured(
        float(off.max()),
        1,
        f"row {row + 1}, column {column + 1}: printed {stated[row, column]:g}, model {by_model[row, column]:.6f}",
        "Position in mm: printed "
        + ", ".join(f"{1e3 * x:.1f}" for x in stated[:3, 3])
        + "; by the model "
        + ", ".join(f"{1e3 * x:.3f}" for x in by_model[:3, 3])
        + "; by Kinova's DH constants "
        + ", ".join(f"{1e3 * x:.3f}" for x in by_table[:3, 3])
        + f"; largest difference to the model {np.abs(position).max():.3f} mm.",
    )


def _sixth_column(form: Form) -> Measured:
    """Against Pinocchio's Jacobian of the hand, and for comparison of a point 20 mm beside the axis."""
    Q = random_configurations(arm(), _COUNT, np.random.default_rng(_SEED))
    columns = [arm().jacobian(q)[:, 5] for q in Q]
    beside = [np.linalg.norm(np.cross(J[3:], arm().pose(q).rotation[:, 0])) for q, J in zip(Q, columns, strict=True)]
    found = f"A point 20 mm beside the last axis moves by {20.0 * max(map(float, beside)):.1f} mm/rad."
    return Measured.worst([deviation(form(), J[:3]) for J in columns], found=found)


def _transforms(theta: Floats) -> list[Floats]:
    """T_0_0 to T_0_6 (4, 4) at the table's own angles θ [rad], which count some joints the other way."""
    table = jaco2()
    signs = np.array([row.sign for row in table.rows])
    return [np.eye(4), *table.link_poses(theta * signs)]


def _by_differences(theta: Floats) -> Floats:
    return derivative(lambda angles: _transforms(angles)[-1][:3, 3], theta)


def _one_column(form: Form) -> Measured:
    Q = random_configurations(arm(), _COUNT, np.random.default_rng(_SEED))
    off = []
    for theta in Q:
        T, J = _transforms(theta), _by_differences(theta)
        off += [deviation(form(T[i - 1], T[-1]), J[:, i - 1]) for i in range(1, 7)]
    return Measured.worst(off, lambda k: f"column {k % 6 + 1}")


def _all_columns(form: Form) -> Measured:
    Q = random_configurations(arm(), _COUNT, np.random.default_rng(_SEED))
    off = [relative(form(_transforms(theta)), _by_differences(theta)) for theta in Q]
    wrong = sum(float(x) > 1e-6 for x in off)
    return Measured.worst(off, found=f"J is another one at {wrong} of {len(off)} configurations.")


CLAIMS: Final = (
    Claim(
        id="001:task-1b",
        place="task 1b",
        said="T_base_hand at q = (180, 270, 90, 180, 180, 0)°.",
        formula="0      1  0      0.41\n-0.5   0  0.866  0.2595\n0.866  0  0.5    0.084\n0      0  0      1",
        latex=r"\begin{pmatrix} 0 & 1 & 0 & 0.41 \\ -0.5 & 0 & 0.866 & 0.2595 \\ 0.866 & 0 & 0.5 & 0.084 \\ "
        r"0 & 0 & 0 & 1 \end{pmatrix}",
        printed=printed.check_matrix,
        check=_check_matrix,
        reference="Pinocchio on the JACO2's model, link_base to end_effector",
        domain="the one configuration; entries are taken as rounded to the digits printed",
        unit="last digits",
        tolerance=0.5,
    ),
    Claim(
        id="001:task-1d-sixth-column",
        place="task 1d",
        said="The sixth joint only turns the hand, so its column of the positional Jacobian is always zero.",
        formula="j_6 = (0, 0, 0)ᵀ",
        latex=r"j_6 = (0, 0, 0)^T",
        printed=printed.sixth_column,
        check=_sixth_column,
        reference="Pinocchio's frame Jacobian of the end effector",
        domain="40 configurations inside the limits; holds for points on the sixth axis, as the hand's origin is",
        unit="m/rad",
    ),
    Claim(
        id="001:task-1d-jacobian",
        place="task 1d",
        said="A column of the positional Jacobian follows from the transform before its joint and that of the hand.",
        formula="j_i = z_{i−1} × (p_n − p_{i−1}),  z and p out of T_0_{i−1} and T_0_n",
        latex=r"j_i = z_{i-1} \times (p_n - p_{i-1})",
        printed=printed.jacobi,
        check=_one_column,
        reference="five-point differences of the position, by the table's own angles",
        domain="40 configurations, six columns each; the JACO2 counts joint 1 against its θ, which turns its column",
        unit="m/rad",
    ),
    Claim(
        id="001:task-1d-indices",
        place="task 1d, listing",
        said="J has the columns j_0, j_1, j_2 and so on, j_i from T_0_{i−1}; before frame 0 the base has to stand in.",
        formula="J = [j_0 j_1 j_2 ...],  j_i = Jacobi(T_0_{i−1}, T_0_n)",
        latex=r"J = [\, j_0 \; j_1 \; j_2 \dots ], \quad j_i = \mathrm{Jacobi}(T_{0,i-1}, T_{0,n})",
        printed=printed.columns_from_zero,
        check=_all_columns,
        reference="five-point differences of the position, by the table's own angles",
        domain="40 configurations",
        correction=Correction(
            printed.columns_from_one,
            "J = [j_1 j_2 ... j_n]",
            r"J = [\, j_1 \; j_2 \dots j_n ]",
            "With j_i from T_0_{i−1} the first column is j_1; counting from 0 shifts every column and loses the last.",
        ),
    ),
)
