"""What the NAO looks like: primitives drawn by us, no vendor mesh; the right side is mirrored from the left.

The foot's outline is B-Human's (100 mm forward, 50 mm back, 38.77 mm inner and 50.02 mm outer edge from the ankle);
sonars, cameras and fingers sit where the public URDF has their frames. Everything else is drawn by eye to the robot's
573 mm.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from urdf_tables.model import ball, bar, box, mirrored, rod

if TYPE_CHECKING:
    from urdf_tables.model import Solid, Triple

MATERIALS: dict[str, tuple[float, float, float, float]] = {
    "shell": (0.93, 0.93, 0.94, 1.0),
    "shade": (0.74, 0.75, 0.77, 1.0),
    "accent": (0.93, 0.32, 0.1, 1.0),
    "joint": (0.36, 0.37, 0.4, 1.0),
    "dark": (0.12, 0.12, 0.14, 1.0),
    "light": (0.35, 0.75, 0.98, 1.0),
}


def right_name(left: str) -> str:
    """The right counterpart of a left link's name."""
    return ("r" if left[0] == "l" else "R") + left[1:]


def _both(*left: Solid) -> tuple[Solid, ...]:
    return (*left, *mirrored(left))


TORSO: tuple[Solid, ...] = (
    rod("shell", 0.043, 0.084, (0.0, 0.0, 0.076), "y"),
    bar("shell", 0.046, (0.004, 0.0, 0.076), (0.0, 0.0, -0.045)),
    ball("shell", 0.046, (0.004, 0.0, 0.076)),
    box("shade", (0.02, 0.07, 0.094), (-0.04, 0.0, 0.05)),
    rod("joint", 0.034, 0.022, (0.0, 0.0, -0.055)),
    box("dark", (0.05, 0.052, 0.04), (-0.004, 0.0, -0.078)),
    rod("shade", 0.027, 0.012, (0.0, 0.0, 0.119)),
    rod("accent", 0.0165, 0.01, (0.0475, 0.0, 0.045), "x"),
    rod("light", 0.011, 0.013, (0.0475, 0.0, 0.045), "x"),
    *_both(
        ball("shell", 0.043, (0.0, 0.042, 0.076)),
        bar("shell", 0.043, (0.0, 0.042, 0.076), (0.0, 0.02, -0.045)),
        bar("shade", 0.0115, (0.025, 0.032, 0.068), (0.0455, 0.0405, 0.068)),
        bar("dark", 0.009, (0.025, 0.032, 0.068), (0.0462, 0.0408, 0.068)),
    ),
)
NECK: tuple[Solid, ...] = (rod("dark", 0.021, 0.03, (0.0, 0.0, -0.006)),)

_SKULL = (0.002, 0.011, 0.0565)  # centre of the left half of the head
_SKULL_RADIUS = 0.053


def _stud(material: str, radius: float, direction: Triple, height: float) -> Solid:
    """A disc on the left half of the head, facing outward; height above the skull."""
    (x, y, z), (a, b, c) = _SKULL, direction
    top = (_SKULL_RADIUS + height) / math.hypot(a, b, c)
    return bar(
        material,
        radius,
        (x + a * top * 0.7, y + b * top * 0.7, z + c * top * 0.7),
        (x + a * top, y + b * top, z + c * top),
    )


_EYE = (0.9, 0.34, -0.24)


def head(cameras: tuple[Triple, Triple]) -> tuple[Solid, ...]:
    """The head with its eyes, ears and the two cameras, each given by x, z and pitch."""
    (top_x, top_z, _), (low_x, low_z, _) = cameras
    return (
        rod("shell", _SKULL_RADIUS, 0.022, (_SKULL[0], 0.0, _SKULL[2]), "y"),
        ball("shell", 0.05, (-0.008, 0.0, 0.058)),
        ball("shell", 0.04, (0.0125, 0.0, 0.036)),
        rod("dark", 0.0062, 0.012, (top_x - 0.005, 0.0, top_z), "x"),
        rod("dark", 0.0055, 0.012, (low_x - 0.001, 0.0, low_z), "x"),
        *(rod("joint", 0.008, 0.012, (x, 0.0, z)) for x, z in ((0.026, 0.1005), (0.004, 0.1055), (-0.018, 0.1005))),
        *_both(
            ball("shell", _SKULL_RADIUS, _SKULL),
            _stud("dark", 0.0165, _EYE, 0.0008),
            _stud("light", 0.0125, _EYE, 0.0016),
            _stud("dark", 0.0085, _EYE, 0.0024),
            rod("accent", 0.031, 0.012, (-0.004, 0.0585, 0.053), "y"),
            rod("shade", 0.023, 0.0145, (-0.004, 0.0585, 0.053), "y"),
            rod("dark", 0.0145, 0.016, (-0.004, 0.0585, 0.053), "y"),
        ),
    )


def left_arm(upper_arm: float, elbow_y: float, lower_arm: float) -> dict[str, tuple[Solid, ...]]:
    """Shoulder to fingers, for the arm lengths of the version."""
    elbow = (upper_arm, elbow_y, 0.0)
    return {
        "LShoulder": (rod("joint", 0.026, 0.03, (0.0, -0.016, 0.0), "y"),),
        "LBicep": (
            ball("accent", 0.034, (-0.002, 0.003, 0.0)),
            bar("shell", 0.0275, (0.0, 0.003, 0.0), (upper_arm * 0.62, elbow_y * 0.7, 0.0)),
            bar("shade", 0.022, (upper_arm * 0.6, elbow_y * 0.7, 0.0), elbow),
        ),
        "LElbow": (ball("joint", 0.0235),),
        "LForeArm": (
            bar("shell", 0.0225, (0.0, 0.0, 0.0), (lower_arm, 0.0, 0.0)),
            bar("shell", 0.0265, (lower_arm * 0.35, 0.0, 0.0), (lower_arm, 0.0, 0.0)),
        ),
        "l_wrist": (
            rod("accent", 0.028, 0.014, (0.008, 0.0, 0.0), "x"),
            rod("shell", 0.0255, 0.022, (0.022, 0.0, 0.0), "x"),
            ball("shell", 0.0235, (0.036, 0.0, 0.002)),
            box("shade", (0.03, 0.038, 0.024), (0.05, 0.0, -0.002)),
            *_fingers(),
        ),
    }


def _fingers() -> tuple[Solid, ...]:
    """Two fingers and a thumb, half open; their roots are those of the public URDF."""
    return (
        *_both(
            bar("joint", 0.0075, (0.06, 0.0118, -0.003), (0.083, 0.0125, -0.008)),
            ball("joint", 0.0075, (0.083, 0.0125, -0.008)),
            bar("joint", 0.0065, (0.083, 0.0125, -0.008), (0.098, 0.011, -0.021)),
        ),
        bar("joint", 0.0075, (0.045, 0.0, -0.012), (0.06, 0.0, -0.031)),
        bar("joint", 0.0065, (0.06, 0.0, -0.031), (0.078, 0.0, -0.034)),
    )


def _rounded(
    material: str, radius: float, gap: float, top: float, bottom: float, at: tuple[float, float]
) -> tuple[Solid, ...]:
    """An upright body of stadium-shaped cross-section: two rods side by side and the box between them."""
    (x, y), middle, height = at, (top + bottom) / 2, top - bottom
    return (
        rod(material, radius, height, (x, y - gap / 2, middle)),
        rod(material, radius, height, (x, y + gap / 2, middle)),
        box(material, (2 * radius, gap, height), (x, y, middle)),
    )


# Outline of the left foot about the ankle (B-Human): toe and heel are arcs inside it.
_TOE, _HEEL, _INNER, _OUTER = 0.1, -0.05, -0.03877, 0.05002
_TOE_RADIUS, _HEEL_RADIUS = (_OUTER - _INNER) / 2, 0.026
_MIDDLE = (_OUTER + _INNER) / 2


def _foot_layer(material: str, top: float, bottom: float) -> tuple[Solid, ...]:
    """One slice of the foot."""
    z, height = (top + bottom) / 2, top - bottom
    front, back = _TOE - _TOE_RADIUS, _HEEL + _HEEL_RADIUS
    heel_width = _OUTER - _INNER - 2 * _HEEL_RADIUS
    return (
        rod(material, _TOE_RADIUS, height, (front, _MIDDLE, z)),
        box(material, (front - back, _OUTER - _INNER, height), ((front + back) / 2, _MIDDLE, z)),
        rod(material, _HEEL_RADIUS, height, (back, _INNER + _HEEL_RADIUS, z)),
        rod(material, _HEEL_RADIUS, height, (back, _OUTER - _HEEL_RADIUS, z)),
        box(material, (_HEEL_RADIUS, heel_width, height), ((back + _HEEL) / 2, _MIDDLE, z)),
    )


LEFT_LEG: dict[str, tuple[Solid, ...]] = {
    "LPelvis": (bar("joint", 0.027, (-0.004, -0.014, 0.018), (-0.004, 0.012, -0.008)),),
    "LHip": (box("dark", (0.05, 0.036, 0.036), (-0.004, 0.0, -0.004)),),
    "LThigh": (
        rod("accent", 0.024, 0.006, (0.002, 0.041, -0.01), "y"),
        rod("shell", 0.0335, 0.06, (0.002, 0.0055, -0.008), "y"),
        *_rounded("shell", 0.0315, 0.012, -0.008, -0.08, (0.002, 0.004)),
        rod("joint", 0.027, 0.06, (0.0, 0.0, -0.1), "y"),
    ),
    "LTibia": (
        rod("shell", 0.0305, 0.054, (0.002, 0.001, -0.014), "y"),
        *_rounded("shell", 0.0295, 0.008, -0.022, -0.086, (0.0, 0.001)),
        bar("accent", 0.02, (0.018, 0.001, -0.03), (0.015, 0.001, -0.075)),
        ball("accent", 0.02, (0.018, 0.001, -0.03)),
        ball("accent", 0.02, (0.015, 0.001, -0.075)),
    ),
    "LAnklePitch": (rod("dark", 0.024, 0.046, (0.0, 0.0, 0.002), "y"),),
    "l_ankle": (
        rod("dark", _TOE_RADIUS - 0.001, 0.005, (_TOE - _TOE_RADIUS, _MIDDLE, -0.04261)),
        box("dark", (0.09, 0.08, 0.005), (0.009, _MIDDLE, -0.04261)),
        *_foot_layer("shell", -0.027, -0.041),
        rod("shell", _TOE_RADIUS - 0.006, 0.006, (_TOE - _TOE_RADIUS, _MIDDLE, -0.024)),
        bar("shade", 0.021, (0.046, _MIDDLE, -0.0235), (0.006, 0.002, -0.009)),
        box("shade", (0.05, 0.052, 0.012), (-0.01, 0.003, -0.022)),
    ),
}

_LEFT_COLLISIONS: dict[str, tuple[Solid, ...]] = {
    "LBicep": (rod("", 0.034, 0.11, (0.04, 0.008, 0.0), "x"),),
    "LForeArm": (rod("", 0.028, 0.06, (0.025, 0.0, 0.0), "x"),),
    "l_wrist": (rod("", 0.03, 0.1, (0.05, 0.0, -0.006), "x"),),
    "LThigh": (rod("", 0.04, 0.11, (0.0, 0.004, -0.05)),),
    "LTibia": (rod("", 0.04, 0.1, (0.004, 0.002, -0.05)),),
    "l_ankle": (box("", (0.15, 0.08879, 0.035), (0.025, 0.005625, -0.02761)),),
}
COLLISIONS: dict[str, tuple[Solid, ...]] = {
    "torso": (box("", (0.1, 0.13, 0.12), (0.0, 0.0, 0.06)), box("", (0.08, 0.09, 0.07), (0.0, 0.0, -0.04))),
    "Head": (ball("", 0.065, (0.0, 0.0, 0.05)),),
    **_LEFT_COLLISIONS,
    **{right_name(name): mirrored(solids) for name, solids in _LEFT_COLLISIONS.items()},
}
