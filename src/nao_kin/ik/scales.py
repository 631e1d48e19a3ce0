"""How strongly a chain's joints move its tip: what gains and dampings are measured by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import TargetKind

__all__ = ["Scales", "chain_scales", "scales_of"]


@dataclass(frozen=True, slots=True)
class Scales:
    """The largest values over some configurations of the Jacobian's rows that a kind of target binds.

    Attributes:
        singular_value: Largest singular value σ [m and rad, a rad].
        manipulability: Largest product of the singular values.
    """

    singular_value: float
    manipulability: float


def scales_of(jacobians: Floats) -> Scales:
    """The scales over some Jacobians (K, m, n)."""
    values = np.linalg.svd(jacobians, compute_uv=False)
    return Scales(float(values.max()), float(values.prod(axis=1).max()))


def chain_scales(chain: Chain, kind: TargetKind, configurations: Floats) -> Scales:
    """The scales of a chain for a kind of target, seen at the configurations (K, n)."""
    bound = {"position": slice(0, 3), "orientation": slice(3, 6)}.get(kind, slice(0, 6))
    return scales_of(np.array([chain.jacobian(q)[bound] for q in configurations]))
