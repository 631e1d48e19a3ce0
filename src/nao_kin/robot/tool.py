"""What sits between a link and the point that is wanted: a pose, six numbers, a row of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.se3 import PoseLike, as_pose, from_xyz_rpy, rotation_x, rotation_z, translation

if TYPE_CHECKING:
    import pinocchio as pin

__all__ = ["ToolLike", "as_tool"]

ToolLike: TypeAlias = "PoseLike | Sequence[float] | Mapping[str, Any]"
"""A `pin.SE3` or (4, 4) matrix; x, y, z [m], or these and roll, pitch, yaw [rad]; or a DH row with its convention."""

_ROW = {"a", "alpha", "d", "theta", "convention"}
_PLACE = {"xyz", "rpy"}
_EXPECTED = (
    "a pose, x y z [m] with or without roll pitch yaw [rad], {'xyz': …, 'rpy': …}, or a DH row "
    "{'a': …, 'alpha': …, 'd': …, 'theta': …, 'convention': 'standard' or 'modified'}"
)


def as_tool(value: ToolLike, what: str = "tool") -> pin.SE3:
    """T_tip_tool from any of the ways to write it.

    Raises:
        InvalidInputError: It is none of them, or not finite, or no rotation.
    """
    if isinstance(value, Mapping):
        return _of_words(value, what)
    if isinstance(value, Sequence) and not isinstance(value, str) and len(value) in {3, 6} and np.ndim(value) == 1:
        try:
            numbers = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidInputError(what, _EXPECTED, repr(value)[:80]) from None
        if not np.isfinite(numbers).all():
            raise InvalidInputError(what, "finite numbers", repr(value)[:60])
        return from_xyz_rpy(numbers[:3], numbers[3:] if len(value) == 6 else (0.0, 0.0, 0.0))
    if isinstance(value, str):
        raise InvalidInputError(what, _EXPECTED, repr(value)[:80])
    return as_pose(value, what)


def _of_words(words: Mapping[str, Any], what: str) -> pin.SE3:
    if not words or not (words.keys() <= _ROW or words.keys() <= _PLACE):
        raise InvalidInputError(what, _EXPECTED, repr(dict(words))[:80])
    try:
        if words.keys() <= _PLACE:
            return as_tool([*map(float, words.get("xyz", (0, 0, 0))), *map(float, words.get("rpy", (0, 0, 0)))], what)
        a, alpha, d, theta = (float(words.get(name, 0.0)) for name in ("a", "alpha", "d", "theta"))
    except (TypeError, ValueError):
        raise InvalidInputError(what, _EXPECTED, repr(dict(words))[:80]) from None
    if not np.isfinite((a, alpha, d, theta)).all():
        raise InvalidInputError(what, "finite numbers", repr(dict(words))[:80])
    about_x = rotation_x(alpha) * translation(a, 0.0, 0.0)
    about_z = rotation_z(theta) * translation(0.0, 0.0, d)
    match words.get("convention"):
        case "standard":
            return about_z * about_x
        case "modified":
            return about_x * about_z
    raise InvalidInputError(f"{what}, convention", "'standard' or 'modified'", repr(words.get("convention")))
