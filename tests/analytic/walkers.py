"""Two hexapods: the PhantomX of our URDF file, and one of round numbers, whose legs are DH tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

import nao_kin as nk
from nao_kin.se3 import translation
from tests.analytic.plane_construction import Walker
from tests.conftest import robot

if TYPE_CHECKING:
    from nao_kin.chain import Chain

LEGS = ("rf", "rm", "rr", "lf", "lm", "lr")
HIP, THIGH, SHIN = 0.03, 0.06, 0.1
HIPS = np.array([[0.06, 0.1, 0.0], [0.08, 0.0, 0.0], [0.06, -0.1, 0.0]])
HIPS = np.vstack([HIPS, HIPS * (-1.0, 1.0, 1.0)])  # x to the right, y ahead [m]

WALKER = Walker(HIPS, HIP, THIGH, SHIN, front=0, rear=2)


def round_legs(limit: float = math.inf, knee: tuple[float, float] | None = None) -> dict[str, Chain]:
    """The round walker: hip counted from straight ahead, thigh from level, knee by the angle of thigh and shin."""
    legs: dict[str, Chain] = {}
    for name, hip in zip(LEGS, HIPS, strict=True):
        rows = [
            {"name": f"hip_{name}", "a": HIP, "alpha": math.pi / 2, "d": 0.0, "theta": math.pi / 2},
            {"name": f"thigh_{name}", "a": THIGH, "alpha": 0.0, "d": 0.0, "theta": 0.0},
            {"name": f"knee_{name}", "a": SHIN, "alpha": 0.0, "d": 0.0, "theta": -math.pi},
        ]
        if limit < math.inf:
            rows = [row | {"lower": -limit, "upper": limit} for row in rows]
        if knee is not None:
            rows[2] |= {"lower": knee[0], "upper": knee[1]}
        legs[name] = nk.DHChain.from_table(rows, "standard", base=translation(*hip), name=name, base_name="body")
    return legs


def round_feet(out: float = 0.09, down: float = 0.07) -> np.ndarray:
    """Feet (6, 3) at a distance outwards from the hip servos and below them [m]."""
    feet = HIPS * (1.0 + out / np.linalg.norm(HIPS, axis=1, keepdims=True))
    feet[:, 2] = -down
    return feet


def phantomx_legs() -> dict[str, Chain]:
    return {name: robot("phantomx").chain(f"leg_{name}") for name in LEGS}


def phantomx_stand() -> dict[str, float]:
    """A posture of a standing PhantomX: knees up, feet in a circle."""
    return {f"j_thigh_{leg}": math.radians(-47.5) for leg in LEGS} | {
        f"j_tibia_{leg}": math.radians(-67.3) for leg in LEGS
    }
