"""What the tip of a chain is wanted to do."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, matrix, vector
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.se3 import PoseLike, as_pose

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "AXES",
    "KINDS",
    "ORIENTATION",
    "POINTING",
    "POSE",
    "POSITION",
    "Target",
    "TargetKind",
    "TargetLike",
    "WeightsLike",
]

TargetKind: TypeAlias = Literal["pose", "position", "pointing", "orientation"]
TargetLike: TypeAlias = "Target | PoseLike"
WeightsLike: TypeAlias = "Mapping[str, float] | ArrayLike | None"

POSE, POSITION, POINTING, ORIENTATION = range(4)
KINDS: Final[dict[TargetKind, int]] = {
    "pose": POSE,
    "position": POSITION,
    "pointing": POINTING,
    "orientation": ORIENTATION,
}
"""The kinds by the numbers that compiled code knows them by."""

AXES: Final = ("x", "y", "z", "rx", "ry", "rz")
"""Names of the six weights: position along and rotation about the axes of the base frame."""

_ALL: Final = (1.0,) * 6
_SHORTEST: Final = 1e-8  # an axis shorter than this points nowhere


class Target:
    """A wanted placement of the tip in the chain's base frame, or a part of one. Immutable.

    Make one with `pose`, `position`, `orientation` or `pointing`; `nao_kin.solve` makes it of plain arrays itself.

    Attributes:
        kind: ``"pose"`` (position and orientation), ``"position"`` (any orientation will do), ``"orientation"`` (any
            position will do) or ``"pointing"`` (a position, and an axis of the tip along an axis of the base).
        goal: The form that solvers take, see `__init__`; not to be changed.
        weights: How much each base axis counts, in the order of `AXES`; 0 leaves it free.
        counts: The same as a number whose bit i is set where axis i counts.
    """

    # Not a frozen dataclass: one is made for every solve, and freezing would cost as much as the kinematics.
    __slots__ = ("counts", "goal", "kind", "weights")

    def __init__(self, kind: TargetKind, goal: Floats, weights: tuple[float, ...] = _ALL) -> None:
        """A target from the form that solvers take; it is not checked, so prefer the named constructors.

        Args:
            kind: What is wanted.
            goal: T_base_target (4, 4), C-contiguous and not used elsewhere; for pointing, the last column is the
                position, the first the unit axis in tip axes, the second the unit axis in base axes.
            weights: Six numbers.
        """
        self.kind, self.goal, self.weights = kind, goal, weights
        self.counts = 63 if weights is _ALL else sum((w > 0.0) << i for i, w in enumerate(weights))

    @classmethod
    def pose(cls, T_base_target: PoseLike, weights: WeightsLike = None) -> Target:
        """A full pose from a `pin.SE3` or a (4, 4) matrix.

        Args:
            T_base_target: The wanted pose of the tip.
            weights: Six numbers ≥ 0 in the order of `AXES`, or some of them by name: ``{"rz": 0}`` leaves the turn
                about the base's z axis free. Weights decide which compromise is found where not all can be met; every
                axis with a weight above 0 must still be met to tolerance.

        Raises:
            InvalidInputError: Not a rigid pose (the message gives the size of the violation), or bad weights.
        """
        return cls("pose", _goal(as_pose(T_base_target, "target")), _weights(weights))

    @classmethod
    def position(cls, p_base: ArrayLike, weights: WeightsLike = None) -> Target:
        """A position p_base (3,) [m] with weights of its axes, in any orientation.

        Raises:
            InvalidInputError: Not three finite numbers, or bad weights.
        """
        goal = np.eye(4)
        goal[:3, 3] = vector(p_base, "target position", 3)
        return cls("position", goal, _weights(weights))

    @classmethod
    def orientation(cls, R_base_target: ArrayLike, weights: WeightsLike = None) -> Target:
        """An orientation, a rotation matrix R_base_target (3, 3), with weights of its axes, at any position.

        Raises:
            InvalidInputError: Not a rotation (the message gives the size of the violation), or bad weights.
        """
        homogeneous = np.eye(4)
        homogeneous[:3, :3] = matrix(R_base_target, "target orientation", (3, 3))
        return cls("orientation", _goal(as_pose(homogeneous, "target orientation")), _weights(weights))

    @classmethod
    def pointing(
        cls, p_base: ArrayLike, base_axis: ArrayLike, tip_axis: ArrayLike = (1.0, 0.0, 0.0), weights: WeightsLike = None
    ) -> Target:
        """A position [m], and an axis of the tip pointing along an axis of the base; turning about it is free.

        What a NAO's arm of five joints can do.

        Args:
            p_base: The wanted position of the tip (3,) [m].
            base_axis: Where to point, in base axes (3,); of any length but 0.
            tip_axis: What points, in tip axes (3,); of any length but 0.
            weights: As for `pose`, of the position only.

        Raises:
            InvalidInputError: Wrong shapes, not finite, an axis of length 0, or bad weights.
        """
        chosen = _weights(weights)
        if chosen[3:] != _ALL[3:]:
            expected = "weights of x, y and z only; turning about the pointing axis is free anyway"
            raise InvalidInputError("weights", expected, str(list(chosen)))
        goal = np.eye(4)
        goal[:3, 0], goal[:3, 1], goal[:3, 2] = _unit(tip_axis, "tip_axis"), _unit(base_axis, "base_axis"), 0.0
        goal[:3, 3] = vector(p_base, "target position", 3)
        return cls("pointing", goal, chosen)

    @classmethod
    def of(cls, value: TargetLike) -> Target:
        """A target from itself, a `pin.SE3`, a (4, 4) matrix or a position (3,).

        Raises:
            InvalidInputError: None of these, not finite, or not rigid.
        """
        if isinstance(value, Target):
            return value
        if isinstance(value, pin.SE3):
            return cls.pose(value)
        shape = _shape(value)
        if shape == (3,):
            return cls.position(value)
        if shape == (4, 4):
            return cls.pose(value)
        expected = "a pin.SE3, a (4, 4) matrix, a position (3,) or a nao_kin.Target"
        raise InvalidInputError("target", expected, f"shape {shape}" if shape else repr(value)[:60])

    @property
    def T_base_target(self) -> pin.SE3:  # noqa: N802 - a transform's name says both frames
        """The placement in the base frame, a copy; the parts that the kind leaves free are identity."""
        rotation = np.eye(3) if self.kind in ("position", "pointing") else self.goal[:3, :3].copy()
        return pin.SE3(rotation, self.goal[:3, 3].copy())

    @property
    def tip_axis(self) -> Floats | None:
        """Of a pointing target: the unit axis that points, in tip axes (3,)."""
        return self.goal[:3, 0].copy() if self.kind == "pointing" else None

    @property
    def base_axis(self) -> Floats | None:
        """Of a pointing target: where it is to point, a unit axis in base axes (3,)."""
        return self.goal[:3, 1].copy() if self.kind == "pointing" else None

    def moved_to(self, p_base: Floats) -> Target:
        """The same target at another position (3,) [m]."""
        goal = self.goal.copy()
        goal[:3, 3] = p_base
        return Target(self.kind, goal, self.weights)

    def __repr__(self) -> str:
        x, y, z = self.goal[:3, 3]
        place = "" if self.kind == "orientation" else f" ({x:.6g}, {y:.6g}, {z:.6g})"
        return f"<Target {self.kind}{place}>"


def _goal(T: pin.SE3) -> Floats:
    return np.array(T.homogeneous, dtype=np.float64, order="C")


def _weights(given: WeightsLike) -> tuple[float, ...]:
    if given is None:
        return _ALL
    if isinstance(given, Mapping):
        for name in given:
            if name not in AXES:
                raise UnknownNameError("axis", name, AXES, "weights")
        given = [given.get(name, 1.0) for name in AXES]
    weights = tuple(vector(given, "weights", 6).tolist())
    if min(weights) < 0.0 or max(weights) == 0.0:
        raise InvalidInputError("weights", "numbers ≥ 0, not all 0", str(list(weights)))
    largest = max(weights)
    return tuple(weight / largest for weight in weights) if largest != 1.0 else weights


def _unit(axis: ArrayLike, what: str) -> Floats:
    given = vector(axis, what, 3)
    given = given / max(1.0, float(np.abs(given).max()))  # the square of a huge entry would overflow
    length = float(np.linalg.norm(given))
    if length < _SHORTEST:
        raise InvalidInputError(what, "a direction", f"{given.tolist()}, which has none")
    return np.asarray(given / length)


def _shape(value: Any) -> tuple[int, ...]:
    try:
        return tuple(np.shape(value))
    except ValueError:  # ragged nested lists
        return ()
