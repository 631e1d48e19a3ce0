"""Two chains held against each other: how far apart they are, where, up to what they are the same, and why."""

from __future__ import annotations

from nao_kin.crosscheck.comparison import Comparison, compare
from nao_kin.crosscheck.departure import Departure
from nao_kin.crosscheck.explanation import Alternative, Explanation, Step
from nao_kin.crosscheck.gauge import Gauge
from nao_kin.crosscheck.invariants import AxisPair, LineFigures

__all__ = [
    "Alternative",
    "AxisPair",
    "Comparison",
    "Departure",
    "Explanation",
    "Gauge",
    "LineFigures",
    "Step",
    "compare",
]
