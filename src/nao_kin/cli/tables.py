"""The tables that several commands print."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["joint_table"]


def joint_table(chain: Chain, q: Floats, title: str) -> Table:
    """The joints of a chain with their values in radians and degrees."""
    rows = tuple(
        (joint.name, f"{value:.6f}", "" if joint.kind == "prismatic" else f"{math.degrees(value):.3f}")
        for joint, value in zip(chain.joints, q.tolist(), strict=True)
    )
    return Table((Column("joint"), Column("[rad, m]", number=True), Column("[deg]", number=True)), rows, title=title)
