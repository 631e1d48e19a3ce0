"""Inertia of simple bodies and of merged ones (parallel-axis theorem), rounded so that every platform agrees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from urdf_tables.model import Inertial, Sextuple, Triple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from urdf_tables.model import AxisName

_DIGITS = 9


def significant(value: float, digits: int = _DIGITS) -> float:
    """The value to so many significant digits."""
    return float(f"{value:.{digits}g}")


def cylinder(mass: float, com: Triple, radius: float, length: float, axis: AxisName) -> Inertial:
    """A homogeneous cylinder along one of the link's axes."""
    along = significant(mass * radius**2 / 2)
    across = significant(mass * (3 * radius**2 + length**2) / 12)
    ixx, iyy, izz = (along if name == axis else across for name in ("x", "y", "z"))
    return Inertial(mass, com, (ixx, 0.0, 0.0, iyy, 0.0, izz))


def cuboid(mass: float, com: Triple, size: Triple) -> Inertial:
    """A homogeneous box in the link's axes."""
    xx, yy, zz = (edge**2 for edge in size)
    ixx, iyy, izz = (significant(mass * total / 12) for total in (yy + zz, xx + zz, xx + yy))
    return Inertial(mass, com, (ixx, 0.0, 0.0, iyy, 0.0, izz))


def merged(parts: Iterable[tuple[Inertial, Triple]]) -> Inertial:
    """Bodies that are fixed to each other as one; each with the offset of its link's frame, axes parallel."""
    bodies = [(part.mass, _sum(part.com, offset), part.inertia) for part, offset in parts]
    mass = sum(m for m, _, _ in bodies)
    x, y, z = (sum(m * c[k] for m, c, _ in bodies) / mass for k in range(3))
    total = [0.0] * 6
    for m, com, inertia in bodies:
        steiner = _steiner(m, (com[0] - x, com[1] - y, com[2] - z))
        total = [t + i + s for t, i, s in zip(total, inertia, steiner, strict=True)]
    xx, xy, xz, yy, yz, zz = (significant(value) for value in total)
    return Inertial(significant(mass), (significant(x), significant(y), significant(z)), (xx, xy, xz, yy, yz, zz))


def _steiner(mass: float, offset: Triple) -> Sextuple:
    x, y, z = offset
    return (
        mass * (y * y + z * z),
        -mass * x * y,
        -mass * x * z,
        mass * (x * x + z * z),
        -mass * y * z,
        mass * (x * x + y * y),
    )


def _sum(a: Triple, b: Triple) -> Triple:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])
