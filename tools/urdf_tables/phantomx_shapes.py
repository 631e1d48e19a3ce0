"""What the PhantomX looks like: two black plates, eighteen servos, curved tibias; primitives drawn by us.

Axes at zero, of a leg heading outward: c1 x up, y inward; c2 x aside, y outward, z down; thigh x aside, y inward, z up;
tibia y down, z outward.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from urdf_tables.model import ball, bar, box, mirrored, rod

if TYPE_CHECKING:
    from urdf_tables.model import Solid, Triple

MATERIALS: dict[str, tuple[float, float, float, float]] = {
    "plate": (0.09, 0.09, 0.1, 1.0),
    "servo": (0.28, 0.28, 0.31, 1.0),
    "metal": (0.66, 0.67, 0.7, 1.0),
    "accent": (0.85, 0.16, 0.08, 1.0),
}
_KNEE = (0.0, -0.0645, -0.0145)
_TIP = (0.0, 0.110262, 0.074373)
_CORNER, _MIDDLE_Y = (0.1248, 0.06164), 0.1034


def _strip(material: str, thickness: float, width: float, start: Triple, end: Triple, aside: float = 0.0) -> Solid:
    """A flat bar in the y-z plane from one point to another, wide in that plane."""
    dy, dz = end[1] - start[1], end[2] - start[2]
    middle = (aside, (start[1] + end[1]) / 2, (start[2] + end[2]) / 2)
    return box(material, (thickness, math.hypot(dy, dz), width), middle, (math.atan2(dz, dy), 0.0, 0.0))


def _plate(z: float) -> tuple[Solid, ...]:
    """An elongated hexagon with a round pad at each coxa."""
    x, y = _CORNER
    left = (
        rod("plate", 0.021, 0.004, (x, y, z)),
        rod("plate", 0.021, 0.004, (-x, y, z)),
        rod("plate", 0.021, 0.004, (0.0, _MIDDLE_Y, z)),
    )
    slant = math.atan2(_MIDDLE_Y - y, x)
    long, deep = math.hypot(x, _MIDDLE_Y - y), 0.042
    edges = (
        box("plate", (long, deep, 0.004), (x / 2, (y + _MIDDLE_Y) / 2, z), (0.0, 0.0, -slant)),
        box("plate", (long, deep, 0.004), (-x / 2, (y + _MIDDLE_Y) / 2, z), (0.0, 0.0, slant)),
    )
    middle = (box("plate", (2 * x, 2 * y, 0.004), (0.0, 0.0, z)), box("plate", (0.15, 0.16, 0.004), (0.0, 0.0, z)))
    return (*middle, *left, *edges, *mirrored((*left, *edges)))


def _body() -> tuple[Solid, ...]:
    x, y = _CORNER
    quarter = math.pi / 4
    left = (
        box("servo", (0.032, 0.05, 0.038), (x - 0.004, y - 0.004, 0.0), (0.0, 0.0, -quarter)),
        box("servo", (0.032, 0.05, 0.038), (-x + 0.004, y - 0.004, 0.0), (0.0, 0.0, quarter)),
        box("servo", (0.032, 0.05, 0.038), (0.0, _MIDDLE_Y - 0.007, 0.0)),
        *(rod("metal", 0.011, 0.005, (a, b, 0.0255)) for a, b in ((x, y), (-x, y), (0.0, _MIDDLE_Y))),
    )
    return (
        *_plate(0.022),
        *_plate(-0.022),
        *left,
        *mirrored(left),
        box("servo", (0.11, 0.07, 0.034), (-0.01, 0.0, 0.0)),
        box("accent", (0.1, 0.014, 0.004), (0.0, 0.0, 0.0255)),
        box("servo", (0.05, 0.04, 0.014), (-0.07, 0.0, 0.031)),
        box("accent", (0.006, 0.07, 0.01), (x + 0.001, 0.0, 0.0)),
        rod("metal", 0.0035, 0.05, (-0.075, 0.012, 0.06)),
    )


BODY: tuple[Solid, ...] = _body()
LEG: dict[str, tuple[Solid, ...]] = {
    "c1": (
        box("plate", (0.052, 0.036, 0.026), (0.0, -0.014, 0.0)),
        rod("metal", 0.0105, 0.058, (0.0, 0.0, 0.0), "x"),
    ),
    "c2": (box("servo", (0.036, 0.034, 0.04), (0.0, -0.012, 0.004)), rod("metal", 0.011, 0.05, (0.0, 0.0, 0.0), "x")),
    "thigh": (
        _strip("plate", 0.004, 0.028, (0.0, 0.012, 0.0027), (0.0, -0.076, -0.0171), 0.022),
        _strip("plate", 0.004, 0.028, (0.0, 0.012, 0.0027), (0.0, -0.076, -0.0171), -0.022),
        _strip("servo", 0.036, 0.026, (0.0, -0.02, -0.0045), (0.0, -0.06, -0.0135)),
        rod("accent", 0.008, 0.05, _KNEE, "x"),
    ),
    "tibia": (
        _strip("servo", 0.034, 0.032, (0.0, -0.012, -0.008), (0.0, 0.03, 0.034)),
        _strip("plate", 0.012, 0.036, (0.0, 0.005, 0.012), (0.0, 0.046, 0.052)),
        _strip("plate", 0.012, 0.03, (0.0, 0.036, 0.044), (0.0, 0.078, 0.066)),
        _strip("plate", 0.01, 0.02, (0.0, 0.07, 0.062), (0.0, 0.1, 0.0722)),
        bar("plate", 0.0065, (0.0, 0.09, 0.0685), _TIP),
        ball("accent", 0.0075, _TIP),
    ),
}
BODY_COLLISION: tuple[Solid, ...] = (
    box("", (0.29, 0.165, 0.05)),
    box("", (0.13, 0.25, 0.05)),
)
LEG_COLLISION: dict[str, tuple[Solid, ...]] = {
    "c1": (box("", (0.052, 0.036, 0.026), (0.0, -0.014, 0.0)),),
    "c2": (box("", (0.036, 0.034, 0.04), (0.0, -0.012, 0.004)),),
    "thigh": (_strip("", 0.048, 0.028, (0.0, 0.012, 0.0027), (0.0, -0.076, -0.0171)),),
    "tibia": (
        _strip("", 0.034, 0.036, (0.0, -0.012, -0.008), (0.0, 0.046, 0.052)),
        _strip("", 0.014, 0.024, (0.0, 0.036, 0.044), _TIP),
    ),
}
