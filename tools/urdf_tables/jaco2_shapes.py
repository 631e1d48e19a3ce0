"""What the JACO2 looks like: dark tubes, bright rings at the actuators, three fingers; primitives drawn by us."""

from __future__ import annotations

from typing import TYPE_CHECKING

from urdf_tables.model import ball, bar, box, mirrored, rod

if TYPE_CHECKING:
    from urdf_tables.model import Solid

MATERIALS: dict[str, tuple[float, float, float, float]] = {
    "carbon": (0.16, 0.16, 0.18, 1.0),
    "shell": (0.3, 0.31, 0.33, 1.0),
    "ring": (0.82, 0.83, 0.85, 1.0),
    "grip": (0.08, 0.08, 0.09, 1.0),
}

# The bend of both wrist links: 0.0428 m along the own axis, then as far along the next one, 60 degrees aside.
_BEND, _NEXT = (0.0, 0.0, -0.04276), (0.0, -0.03703, -0.06414)
_WRIST: tuple[Solid, ...] = (
    bar("carbon", 0.031, (0.0, 0.0, -0.006), _BEND),
    ball("carbon", 0.0312, _BEND),
    bar("carbon", 0.031, _BEND, _NEXT),
    bar("ring", 0.0325, (0.0, -0.0324, -0.0615), (0.0, -0.0388, -0.0652)),
)


def _finger(x: float, y_sign: float) -> tuple[Solid, ...]:
    """A finger, half closed, at one side of the palm; y grows outward."""
    knuckle, middle, tip = (x, 0.036, -0.088), (x * 1.05, 0.058, -0.128), (x * 0.8, 0.036, -0.172)
    solids = (
        ball("ring", 0.0135, knuckle),
        bar("shell", 0.0115, knuckle, middle),
        ball("shell", 0.0115, middle),
        bar("grip", 0.0095, middle, tip),
        ball("grip", 0.0095, tip),
    )
    return solids if y_sign > 0 else mirrored(solids)


VISUALS: dict[str, tuple[Solid, ...]] = {
    "link_base": (
        rod("carbon", 0.07, 0.012, (0.0, 0.0, 0.006)),
        rod("shell", 0.058, 0.014, (0.0, 0.0, 0.019)),
        rod("carbon", 0.05, 0.02, (0.0, 0.0, 0.036)),
        rod("carbon", 0.045, 0.106, (0.0, 0.0, 0.099)),
        rod("ring", 0.0465, 0.006, (0.0, 0.0, 0.1535)),
        box("grip", (0.03, 0.05, 0.03), (-0.04, 0.0, 0.075)),
    ),
    "link_1": (
        rod("carbon", 0.0445, 0.085, (0.0, 0.0, -0.045)),
        ball("carbon", 0.0475, (0.0, 0.0, -0.108)),
        rod("carbon", 0.0435, 0.05, (0.0, -0.026, -0.11875), "y"),
        rod("ring", 0.045, 0.006, (0.0, -0.0505, -0.11875), "y"),
        rod("shell", 0.036, 0.006, (0.0, -0.0555, -0.11875), "y"),
    ),
    "link_2": (
        rod("ring", 0.047, 0.006, (0.0, 0.0, 0.007)),
        rod("carbon", 0.045, 0.06, (0.0, 0.0, -0.025)),
        rod("shell", 0.036, 0.006, (0.0, 0.0, -0.057)),
        bar("carbon", 0.036, (0.0, 0.0, -0.014), (0.0, -0.205, -0.014)),
        bar("shell", 0.037, (0.0, -0.115, -0.014), (0.0, -0.295, -0.014)),
        bar("carbon", 0.035, (0.0, -0.2, -0.014), (0.0, -0.41, -0.014)),
        rod("carbon", 0.042, 0.056, (0.0, -0.41, -0.024)),
        rod("ring", 0.0435, 0.006, (0.0, -0.41, 0.006)),
        rod("shell", 0.034, 0.006, (0.0, -0.41, -0.054)),
    ),
    "link_3": (
        rod("carbon", 0.042, 0.05, (0.0, 0.0, -0.034)),
        rod("shell", 0.034, 0.006, (0.0, 0.0, -0.06)),
        bar("carbon", 0.036, (0.0, 0.0, -0.014), (0.0, 0.09, -0.0124)),
        bar("shell", 0.0345, (0.0, 0.04, -0.0134), (0.0, 0.13, -0.0118)),
        bar("carbon", 0.032, (0.0, 0.09, -0.0124), (0.0, 0.205, -0.0114)),
        bar("ring", 0.0335, (0.0, 0.2035, -0.0114), (0.0, 0.2095, -0.0114)),
    ),
    "link_4": _WRIST,
    "link_5": _WRIST,
    "link_6": (
        rod("carbon", 0.032, 0.034, (0.0, 0.0, -0.02)),
        rod("ring", 0.0345, 0.005, (0.0, 0.0, -0.038)),
        rod("carbon", 0.039, 0.026, (0.0, 0.0, -0.052)),
        rod("shell", 0.044, 0.024, (0.0, 0.0, -0.075)),
        rod("grip", 0.034, 0.006, (0.0, 0.0, -0.089)),
        *_finger(0.024, 1.0),
        *_finger(-0.024, 1.0),
        *_finger(0.0, -1.0),
    ),
}
COLLISIONS: dict[str, tuple[Solid, ...]] = {
    "link_base": (rod("", 0.07, 0.03, (0.0, 0.0, 0.015)), rod("", 0.047, 0.127, (0.0, 0.0, 0.0935))),
    "link_1": (rod("", 0.046, 0.13, (0.0, 0.0, -0.0665)), rod("", 0.046, 0.06, (0.0, -0.03, -0.11875), "y")),
    "link_2": (
        rod("", 0.046, 0.07, (0.0, 0.0, -0.025)),
        bar("", 0.037, (0.0, 0.0, -0.014), (0.0, -0.41, -0.014)),
        rod("", 0.043, 0.066, (0.0, -0.41, -0.024)),
    ),
    "link_3": (rod("", 0.043, 0.06, (0.0, 0.0, -0.034)), bar("", 0.036, (0.0, 0.0, -0.014), (0.0, 0.2073, -0.0114))),
    "link_4": (bar("", 0.033, (0.0, 0.0, 0.0), _BEND), bar("", 0.033, _BEND, _NEXT)),
    "link_5": (bar("", 0.033, (0.0, 0.0, 0.0), _BEND), bar("", 0.033, _BEND, _NEXT)),
    "link_6": (rod("", 0.045, 0.09, (0.0, 0.0, -0.045)), rod("", 0.065, 0.095, (0.0, 0.0, -0.1375))),
}
