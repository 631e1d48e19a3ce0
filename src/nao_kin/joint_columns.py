"""Names and limits of joints as arrays, one entry a column."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import Floats, frozen

if TYPE_CHECKING:
    from nao_kin.chain import ChainJoint

__all__ = ["JointColumns", "stacked_limits"]


def stacked_limits(joints: tuple[ChainJoint, ...]) -> tuple[Floats, Floats, Floats]:
    """Read-only arrays (lower, upper, max_velocity) of the joints."""
    columns = ([j.lower for j in joints], [j.upper for j in joints], [j.max_velocity for j in joints])
    lower, upper, velocity = (frozen(np.array(column, dtype=np.float64)) for column in columns)
    return lower, upper, velocity


class JointColumns:
    """Names and limits of what has ``joints``: the part of a `JointSpace` that follows from them."""

    if TYPE_CHECKING:

        @property
        def joints(self) -> tuple[ChainJoint, ...]:
            """The n joints, in the order of `q`."""

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Their names, one a column of `q`."""
        return tuple(joint.name for joint in self.joints)

    @property
    def lower(self) -> Floats:
        """Least values (n,) [rad or m], read-only; −inf where there is none."""
        return self._limits[0]

    @property
    def upper(self) -> Floats:
        """Greatest values (n,) [rad or m], read-only; +inf where there is none."""
        return self._limits[1]

    @property
    def max_velocity(self) -> Floats:
        """Greatest speeds (n,) [rad/s or m/s], read-only; +inf where none is known."""
        return self._limits[2]

    @cached_property
    def _limits(self) -> tuple[Floats, Floats, Floats]:
        return stacked_limits(self.joints)
