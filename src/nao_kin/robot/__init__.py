"""Robots: what a URDF describes, paths through it, and the robots that load by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.lazy import lazily

if TYPE_CHECKING:
    from nao_kin.robot.robot import Robot as Robot
    from nao_kin.robot.robot import load as load

__all__ = ["Robot", "load"]

__getattr__ = lazily(
    __name__,
    {"Robot": "robot", "load": "robot"},
)
