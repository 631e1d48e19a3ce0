"""Whether a straight move of the joints keeps clear: proven, not sampled.

A pair of bodies that is d_a apart at one end of a move and d_b at the other is at least (d_a + d_b − L) / 2 apart in
between, where L = Σ lever_k |Δq_k| bounds how far the move can carry them (`nao_kin.collision.levers`). Where that is
not enough, the move is halved: conservative advancement (Mirtich 1996, Impulse-based Dynamic Simulation, 2.3) by
bisection.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.collision import DISTANCE_ACCURACY
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.collision import CollisionModel

__all__ = ["Clearance"]

_LEAST_MARGIN: Final = 100.0 * DISTANCE_ACCURACY


class Clearance:
    """Proves that straight joint moves keep a clearance, remembering distances from one move to the next.

    What it lets pass keeps at least `floor`, half the model's margin; what keeps the margin is let pass.

    Args:
        collisions: The bodies, and the margin.

    Raises:
        InvalidInputError: A margin below 1 mm, or a prismatic joint without limits, whose reach is endless.
    """

    def __init__(self, collisions: CollisionModel) -> None:
        if collisions.margin < _LEAST_MARGIN:
            got = f"{collisions.margin:g} m"
            raise InvalidInputError("margin of the collision model", f"at least {_LEAST_MARGIN:g} m", got)
        self.collisions, self.levers = collisions, collisions.levers
        if not np.isfinite(self.levers).all():
            joint = collisions.motors.joint_names[int(np.argwhere(~np.isfinite(self.levers))[0, 1])]
            raise InvalidInputError("joints", "limits on every prismatic joint", f"none above or at {joint}")
        self.floor = 0.5 * collisions.margin
        # A move this short that fails has an end nearer than the margin, whatever coal's distances are off by.
        self._shortest = 2.0 * (collisions.margin - self.floor - 2.0 * DISTANCE_ACCURACY)
        pairs, motors = self.levers.shape
        self._seen_at, self._seen = np.zeros((pairs, motors)), np.full(pairs, -np.inf)

    def obstacle(self, start: Floats, end: Floats) -> tuple[str, str] | None:
        """The bodies that may come nearer than the margin on the way from one posture to another; None if none do.

        Args:
            start: Motor values (n,) that the move starts from.
            end: Motor values (n,) that it ends at, every joint in a straight line and at its own constant share.
        """
        doubtful = self._unproven(start, end)
        if not len(doubtful):
            return None
        self._look(start, doubtful)
        doubtful = doubtful[np.isin(doubtful, self._unproven(start, end))]
        if not len(doubtful):
            return None
        at_start = self._seen[doubtful]
        pair = self._nearest(start, end, at_start, self._measured(end, doubtful), doubtful)
        return None if pair is None else self.collisions.owners(pair)

    def _unproven(self, start: Floats, end: Floats) -> NDArray[np.intp]:
        """The pairs that what was measured last does not prove to be clear: it holds less and less with the way."""
        ways = [np.einsum("pn,pn->p", self.levers, np.abs(q - self._seen_at)) for q in (start, end)]
        # The way from where it was measured is a convex function along the move, so it is greatest at an end.
        return np.flatnonzero(self._seen - DISTANCE_ACCURACY - np.maximum(*ways) < self.floor)

    def _look(self, q: Floats, pairs: NDArray[np.intp]) -> None:
        self._seen[pairs], self._seen_at[pairs] = self._measured(q, pairs), q

    def _measured(self, q: Floats, pairs: NDArray[np.intp]) -> Floats:
        return self.collisions.measure(q, pairs.tolist())

    def _nearest(self, a: Floats, b: Floats, at_a: Floats, at_b: Floats, pairs: NDArray[np.intp]) -> int | None:
        """A pair that is not proven to be clear between two postures at which its distances are known [m]."""
        least = self.floor + DISTANCE_ACCURACY
        near = np.minimum(at_a, at_b) < least
        if near.any():
            return int(pairs[near][0])
        way = self.levers[pairs] @ np.abs(b - a)
        doubtful = 0.5 * (at_a + at_b - way) < least
        hopeless = doubtful & (way <= self._shortest)
        if hopeless.any():
            return int(pairs[hopeless][0])
        if not doubtful.any():
            return None
        rest, middle = pairs[doubtful], 0.5 * (a + b)
        at_middle = self._measured(middle, rest)
        first = self._nearest(a, middle, at_a[doubtful], at_middle, rest)
        return first if first is not None else self._nearest(middle, b, at_middle, at_b[doubtful], rest)
