"""Two chains held against each other: how far apart, where worst, from which joint on, up to what, and why."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nao_kin.arrays import Floats, frozen
from nao_kin.chain import Chain, random_configurations
from nao_kin.crosscheck.departure import Departure, first_departure
from nao_kin.crosscheck.explanation import Alternative, Explanation, Step, explain
from nao_kin.crosscheck.gauge import Gauge, find_gauge
from nao_kin.crosscheck.invariants import AxisPair, first_pair
from nao_kin.dh.dh_chain import DHChain
from nao_kin.dh.from_chain import to_dh
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import position_distance, rotation_distance
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances

__all__ = ["Comparison", "compare"]


_DEPARTURE_SAMPLES = 64  # a fault shows at almost any configuration


@dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` found.

    The errors are measured at once. Gauge, first pair and explanation are worked out when they are first asked for.

    Attributes:
        a: The first chain, usually a table.
        b: The second chain, usually the model.
        tolerances: When they count as the same.
        samples: Number of configurations compared, 0 and the ends of the ranges among them.
        max_position_error: Largest distance of the two tips [m].
        worst_position_q: Where it is (n,) [rad or m].
        max_rotation_error: Largest angle between the two tips [rad].
        worst_rotation_q: Where it is (n,) [rad or m].
        max_linear_jacobian_error: Largest difference of an entry of the linear rows of the two Jacobians [m/rad; 1].
        max_angular_jacobian_error: The same for the angular rows [1; rad/m].
        first_departure: The first joint at which they part; None if they agree.
    """

    a: Chain
    b: Chain
    tolerances: Tolerances
    samples: int
    max_position_error: float
    worst_position_q: Floats
    max_rotation_error: float
    worst_rotation_q: Floats
    max_linear_jacobian_error: float
    max_angular_jacobian_error: float
    first_departure: Departure | None

    @property
    def agrees(self) -> bool:
        """Whether the chains are the same exactly as given."""
        position, rotation = self._agreement
        return self.max_position_error <= position and self.max_rotation_error <= rotation

    @cached_property
    def gauge(self) -> Gauge | None:
        """Base, tool, joint signs and zero positions that make `a` the same as `b`; None if nothing of that sort does.

        None as well where joints are coupled, for whose lines there is no one gauge.
        """
        try:
            return find_gauge(self.a, self.b, *self._agreement)
        except InvalidInputError:
            return None

    @cached_property
    def first_pair(self) -> AxisPair | None:
        """The first two joints whose lines no gauge makes equal, with their figures; None if there are none.

        None as well where joints are coupled.
        """
        try:
            return first_pair(self.a, self.b)
        except InvalidInputError:
            return None

    @cached_property
    def explanation(self) -> Explanation:
        """Which usual errors in `a` would account for the disagreement.

        The edits are those of a DH table: of `a`, or of `to_dh(a, "modified")` if it is no table.
        """
        note, table = "They agree exactly as given.", None
        try:
            table = self.a if isinstance(self.a, DHChain) else to_dh(self.a, "modified")
        except InvalidInputError as error:
            note = note if self.agrees else f"Not explained: {error}"
        if self.agrees or table is None:
            return Explanation.without_search(table, self.tolerances, note)
        return explain(table, self.b, self.tolerances)

    @property
    def steps(self) -> tuple[Step, ...]:
        """The edits of the first alternative, each with the error that comes back without it."""
        return self.explanation.steps

    @property
    def alternatives(self) -> tuple[Alternative, ...]:
        """Every equally simple set of edits that both chains' own poses confirm, the least far-fetched first."""
        return self.explanation.alternatives

    @cached_property
    def corrected(self) -> DHChain | None:
        """A table that agrees with `b`; None if none is known.

        If not `explanation.exact`, it agrees within the digits that are printed.

        That is `a` itself if it agrees; else the first alternative; else, if there is none that is exact, `a` with the
        gauge applied.
        """
        explanation = self.explanation
        if self.agrees or explanation.table is None:
            return explanation.table
        exact = explanation.exact and explanation.corrected is not None
        if not exact and self.gauge is not None:
            return self.gauge.applied(explanation.table)
        return explanation.corrected

    @property
    def _agreement(self) -> tuple[float, float]:
        return self.tolerances.agreement_position, self.tolerances.agreement_rotation

    def table(self) -> Table:
        """The findings, two columns."""
        names = self.b.joint_names
        worst = ", ".join(f"{name} {value:.4f}" for name, value in zip(names, self.worst_position_q, strict=True))
        rows = (
            ("agree exactly as given", "yes" if self.agrees else "no"),
            ("largest position error", f"{self.max_position_error * 1e3:.6g} mm"),
            ("  at q [rad]", worst),
            ("largest rotation error", f"{self.max_rotation_error:.6g} rad"),
            ("largest Jacobian difference, linear", f"{self.max_linear_jacobian_error:.6g} m/rad"),
            ("  angular", f"{self.max_angular_jacobian_error:.6g}"),
            ("first differ at", "nowhere" if self.first_departure is None else str(self.first_departure)),
            *self._up_to_gauge(),
            ("configurations", str(self.samples)),
        )
        columns = (Column("quantity"), Column("value"))
        return Table(columns, rows, title=f"{self.a.name} against {self.b.name}")

    def _up_to_gauge(self) -> list[tuple[str, str]]:
        if self.agrees:
            return []
        if self.gauge is not None:
            return [("the same arm up to", str(self.gauge))]
        if (pair := self.first_pair) is None:
            return []
        return [
            ("first unequal lines", " and ".join(pair.joints)),
            ("  first chain", str(pair.a)),
            ("  second chain", str(pair.b)),
        ]

    def __repr__(self) -> str:
        verdict = "agrees" if self.agrees else f"differs from {self.first_departure}"
        return f"<Comparison {self.a.name} | {self.b.name}: {self.max_position_error * 1e3:.6g} mm, {verdict}>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()


def compare(
    a: Chain, b: Chain, *, samples: int = 1000, seed: int = 0, tolerances: Tolerances = TOLERANCES
) -> Comparison:
    """Holds two chains against each other at the same joint values, exactly as given.

    Joints correspond by their order. Configurations are drawn inside the limits of `b` (those of `a` where `b` has
    none), and 0 and both ends of every finite range are among them.

    Args:
        a: Usually a hand-written table.
        b: Usually the model.
        samples: Number of random configurations.
        seed: For the generator; the same seed gives the same result.
        tolerances: When they count as the same.

    Returns:
        Errors of the tip and where they are largest; it explains itself on request.

    Raises:
        InvalidInputError: Different numbers of joints, no sample asked for, or a negative seed.
    """
    if len(a.joints) != len(b.joints):
        expected = f"{len(b.joints)} joints as {b.name} has ({', '.join(b.joint_names)})"
        raise InvalidInputError(f"{a.name}", expected, f"{len(a.joints)} ({', '.join(a.joint_names)})")
    if samples < 1:
        raise InvalidInputError("samples", "at least 1", str(samples))
    if seed < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", str(seed))
    Q = _configurations(a, b, samples, np.random.default_rng(seed))
    pairs = [(a.pose(q), b.pose(q)) for q in Q]
    position = np.array([position_distance(*pair) for pair in pairs])
    rotation = np.array([rotation_distance(*pair) for pair in pairs])
    jacobian = np.max([np.abs(a.jacobian(q) - b.jacobian(q)).max(axis=1) for q in Q], axis=0)
    worst_p, worst_r = int(position.argmax()), int(rotation.argmax())
    apart = position[worst_p] > tolerances.agreement_position or rotation[worst_r] > tolerances.agreement_rotation
    # The worst configurations come first: whatever departs, departs there.
    chosen = np.concatenate([Q[[worst_p, worst_r]], Q[:_DEPARTURE_SAMPLES]])
    return Comparison(
        a=a,
        b=b,
        tolerances=tolerances,
        samples=len(Q),
        max_position_error=float(position[worst_p]),
        worst_position_q=frozen(Q[worst_p].copy()),
        max_rotation_error=float(rotation[worst_r]),
        worst_rotation_q=frozen(Q[worst_r].copy()),
        max_linear_jacobian_error=float(jacobian[:3].max()),
        max_angular_jacobian_error=float(jacobian[3:].max()),
        first_departure=first_departure(a, b, chosen, tolerances) if apart else None,
    )


def _configurations(a: Chain, b: Chain, samples: int, rng: np.random.Generator) -> Floats:
    Q = random_configurations(b, samples, rng)
    unlimited = ~(np.isfinite(b.lower) & np.isfinite(b.upper))
    if unlimited.any():
        Q[:, unlimited] = random_configurations(a, samples, rng)[:, unlimited]
    ends = [np.where(np.isfinite(end), end, 0.0) for end in (b.lower, b.upper)]
    return np.concatenate([[np.zeros(len(b.joints))], ends, Q])
