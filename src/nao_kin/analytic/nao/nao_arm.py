"""The NAO's arm in closed form: shoulder pitch and roll that meet, elbow yaw and roll beside them, and a wrist yaw.

T_base_tip = T_base_shoulder · Ry(θ1) Rz(θ2) · Trans(L, o, 0) · Rx(θ3) Rz(θ4) Rx(θ5) · T_hand_tip, where L is
UpperArmLength, o is ElbowOffsetY (negative on the right side, 0 on V3.2), and T_hand_tip, measured from the elbow point
E, holds LowerArmLength, HandOffsetX and HandOffsetZ. Four joints (H21) have θ5 = 0.

* A pose says where E is, E = Ry(θ1) Rz(θ2) (L, o, 0): two shoulders. The rest of the rotation is x-z-x Euler angles:
  two elbows. It is one condition too many, |E| = hypot(L, o), and two with four joints.
* A position leaves the elbow yaw free, and the wrist yaw; with them given, the distance of shoulder and tip gives two
  elbow rolls, and each two shoulders.
* A position and a pointing axis leave a turn ψ about the axis free; |E| is linear in cos ψ and sin ψ: two turns.

Source: geometry as in Kofinas, Orfanoudakis and Lagoudakis 2013, whose chain has o and HandOffsetZ too; the thesis'
(3.3.0.2) ff. are for an arm without them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, largest, screws

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["JOINTS", "LABELS", "SHORTEST", "SINGULARITIES", "recognise"]

# Where the parameters begin: rotation and origin of the shoulder frame in the base; L and o, hypot(L, o), atan2(o, L);
# what to add to q for θ; rotation of the tip in the hand frame and the tip seen from the elbow point; number of joints;
# limits of q, which decide nothing but which solution stands for a continuum.
BASE: Final = 0
SHOULDER: Final = 9
LENGTH: Final = 12
OFFSET: Final = 13
REACH: Final = 14
BEND: Final = 15
SHIFTS: Final = 16
HAND: Final = 21
TIP: Final = 30
JOINTS: Final = 33
LOWER: Final = 34
UPPER: Final = 39
_SIZE: Final = 44

SHORTEST: Final = 1e-6
"""Below this distance of shoulder and elbow [m] there is no upper arm."""

LABELS: Final = tuple(
    f"shoulder {shoulder}, elbow bent to {elbow}{turn}"
    for turn in ("", ", turn +", ", turn −")
    for shoulder in ("upright", "turned over")
    for elbow in ("+", "−")
)
"""By 4 · turn + 2 · shoulder + elbow.

The shoulder is upright where its roll keeps the elbow point on the side of the upper arm's own direction, and turned
over where pitch and roll reach the same place from behind. The elbow is bent to + or − from where the hand is farthest
from the shoulder; of a pose, from θ4 = 0. The turn about a pointing axis is the greater or the smaller one.
"""

SINGULARITIES: Final = (
    "",
    "any elbow yaw with the wrist yaw against it",
    "any shoulder pitch",
    "any shoulder pitch with the elbow yaw against it",
    "any shoulder roll",
    "any elbow roll",
    "any turn about the pointing axis",
)


def recognise(path: JointPath, joints: int) -> Geometry | Mismatch:
    """The arm's frames and lengths, if a chain of four or five joints is one."""
    at_zero = screws(path, joints)
    if isinstance(at_zero, Mismatch):
        return at_zero
    w, p = at_zero.axes, at_zero.points
    shoulder = p[0] + (p[1] - p[0]) @ w[0] * w[0]
    elbow = p[2] + (p[3] - p[2]) @ w[2] * w[2]
    measured = {f"axes {k + 1} and {k + 2} are out of square": float(w[k] @ w[k + 1]) for k in range(joints - 1)}
    measured["axes 1 and 2 miss each other"] = float((p[1] - p[0]) @ np.cross(w[0], w[1]))
    measured["axes 3 and 4 miss each other"] = float((p[3] - p[2]) @ np.cross(w[2], w[3]))
    measured["the elbow is off the plane that the shoulder roll turns"] = float((elbow - shoulder) @ w[1])
    if joints == 5:
        off = float(np.linalg.norm(np.cross(p[4] - elbow, w[4])))
        measured["axis 5 misses the point where axes 3 and 4 meet"] = off
    residual = largest(measured)
    if isinstance(residual, Mismatch):
        return residual
    if (reach := float(np.linalg.norm(elbow - shoulder))) < SHORTEST:
        return Mismatch(f"shoulder and elbow are {reach:.3g} m apart")
    parameters = _parameters(w, shoulder, elbow, at_zero.tip, joints)
    parameters[LOWER : LOWER + joints], parameters[UPPER : UPPER + joints] = path.lower, path.upper
    return Geometry(parameters, residual)


def _parameters(w: Floats, shoulder: Floats, elbow: Floats, tip: Floats, joints: int) -> Floats:
    still = _frame(np.cross(w[0], w[1]), w[1])  # the shoulder frame: y along axis 1, z along axis 2
    upper, fore = _frame(w[2], w[1]), _frame(w[2], w[3])
    hand = _frame(w[4], w[3]) if joints == 5 else fore
    parameters = np.zeros(_SIZE)
    parameters[BASE:SHOULDER], parameters[SHOULDER:LENGTH] = still.ravel(), shoulder
    parameters[LENGTH], parameters[OFFSET], _ = upper.T @ (elbow - shoulder)
    parameters[REACH] = math.hypot(parameters[LENGTH], parameters[OFFSET])
    parameters[BEND] = math.atan2(parameters[OFFSET], parameters[LENGTH])
    parameters[SHIFTS + 1] = _angle(still, upper, 1, 0)  # about z, of x
    parameters[SHIFTS + 2] = _angle(upper, fore, 2, 1)  # about x, of y
    parameters[SHIFTS + 3] = _angle(fore, hand, 1, 0)
    parameters[HAND:TIP], parameters[TIP:JOINTS] = (hand.T @ tip[:3, :3]).ravel(), hand.T @ (tip[:3, 3] - elbow)
    parameters[JOINTS] = joints
    return parameters


def _frame(x: Floats, z: Floats) -> Floats:
    """Right-handed axes as columns, z as given and x made square to it."""
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _angle(before: Floats, after: Floats, up: int, along: int) -> float:
    """The angle by which a frame is turned about the axis that both share, seen on the axis `along`."""
    moved = before.T @ after[:, along]
    return math.atan2(moved[up], moved[along])
