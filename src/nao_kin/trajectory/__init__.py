"""Motion over time: joint values at instants, and what makes them."""

from __future__ import annotations

from nao_kin.trajectory.trajectory import Trajectory
from nao_kin.trajectory.trapezoid import Trapezoid

__all__ = ["Trajectory", "Trapezoid"]
