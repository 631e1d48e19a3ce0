"""Angles, lengths and constant transforms as people write them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from nao_kin.se3 import rotation_angle, rpy

if TYPE_CHECKING:
    from nao_kin.arrays import Floats

__all__ = ["angle_text", "length_text", "size_text", "transform_text"]

_SAME = 1e-9


def angle_text(angle: float) -> str:
    """An angle as a fraction of π where it is one, else in radians."""
    twelfths = angle / (math.pi / 12)
    k = round(twelfths)
    if abs(twelfths - k) > 1e-9 or abs(k) > 48:
        return f"{angle:.6g} rad"
    if k == 0:
        return "0"
    common = math.gcd(k, 12)
    top, bottom = k // common, 12 // common
    sign, top = ("-" if top < 0 else ""), abs(top)
    return f"{sign}{'' if top == 1 else top}π{'' if bottom == 1 else f'/{bottom}'}"


def length_text(length: float) -> str:
    """A length in millimetres."""
    return f"{round(length * 1e3, 9) + 0.0:.7g} mm"


def size_text(position: float, rotation: float) -> str:
    """A distance and an angle; the angle only where there is one."""
    size = f"{position * 1e3:.4g} mm"
    return size if rotation < _SAME else f"{size}, {rotation:.4g} rad"


def transform_text(R: Floats, p: Floats) -> str:
    """A constant transform, translation before rotation; "identity" if it is that."""
    parts = []
    if np.abs(p).max() > _SAME:
        parts.append(f"T({', '.join(f'{value * 1e3 + 0.0:.6g}' for value in np.round(p, 12))} mm)")
    if rotation_angle(R) > _SAME:
        parts.append(_rotation_text(R))
    return " ".join(parts) or "identity"


def _rotation_text(R: Floats) -> str:
    for axis, name in enumerate("xyz"):
        if abs(abs(R[axis, axis]) - 1.0) < _SAME and R[axis, axis] > 0.0:
            i, j = (axis + 1) % 3, (axis + 2) % 3
            return f"R{name}({angle_text(math.atan2(R[j, i], R[i, i]))})"
    roll, pitch, yaw = rpy(pin.SE3(np.ascontiguousarray(R), np.zeros(3)))
    factors = [f"R{name}({angle_text(value)})" for name, value in (("z", yaw), ("y", pitch), ("x", roll))]
    return " ".join(factor for factor in factors if not factor.endswith("(0)"))
