"""Trajectories in files: TXT, CSV and JSON, exact to the last bit. docs/trajectory-files.md describes them."""

from __future__ import annotations

from nao_kin.trajectory.files.reading import read_trajectory, write_trajectory

__all__ = ["read_trajectory", "write_trajectory"]
