"""Two chains held against each other, exactly as given: how far apart, where worst, and from which joint on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nao_kin.arrays import Floats, frozen
from nao_kin.chain import Chain, random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import position_distance, rotation_angle, rotation_distance
from nao_kin.table import Column, Table
from nao_kin.tolerances import TOLERANCES, Tolerances

__all__ = ["Comparison", "Departure", "compare"]


_DEPARTURE_SAMPLES = 64  # a fault shows at almost any configuration


@dataclass(frozen=True, slots=True)
class Departure:
    """The first place, from the base outwards, at which two chains move differently.

    Judged by how the joints up to there *move* the tip point away from its place at q = 0, so that two conventions with
    differently placed link frames are not told apart by those frames. The cause is at this joint or before it: in its
    row, or in the fixed transform that leads to it. A shift along a joint's own axis moves nothing until the next joint
    turns, so it shows there.

    Attributes:
        joint: Name of the first physical joint that moves the tip differently, in the second chain; None if all joints
            move alike and only where the tip sits differs, or if the chains have different numbers of physical joints.
        number: Its place on the path, counted from 1; one more than there are joints for the ends; 0 if not localised.
        position: Largest distance there [m].
        rotation: Largest angle there [rad].
    """

    joint: str | None
    number: int
    position: float
    rotation: float

    def __str__(self) -> str:
        where = self.joint or ("fixed end" if self.number else "not localised")
        return f"{where} ({self.position * 1e3:.4g} mm, {self.rotation:.4g} rad)"


@dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` found.

    Attributes:
        a: The first chain, usually a table.
        b: The second chain, usually the model.
        tolerances: When they count as the same.
        samples: Number of configurations compared, 0 and the ends of the ranges among them.
        max_position_error: Largest distance of the two tips [m].
        worst_position_q: Where it is (n,).
        max_rotation_error: Largest angle between the two tips [rad].
        worst_rotation_q: Where it is (n,).
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
        return (
            self.max_position_error <= self.tolerances.agreement_position
            and self.max_rotation_error <= self.tolerances.agreement_rotation
        )

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
            ("configurations", str(self.samples)),
        )
        columns = (Column("quantity"), Column("value"))
        return Table(columns, rows, title=f"{self.a.name} against {self.b.name}")

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
        first_departure=_first_departure(a, b, chosen, tolerances) if apart else None,
    )


def _configurations(a: Chain, b: Chain, samples: int, rng: np.random.Generator) -> Floats:
    Q = random_configurations(b, samples, rng)
    unlimited = ~(np.isfinite(b.lower) & np.isfinite(b.upper))
    if unlimited.any():
        Q[:, unlimited] = random_configurations(a, samples, rng)[:, unlimited]
    ends = [np.where(np.isfinite(end), end, 0.0) for end in (b.lower, b.upper)]
    return np.concatenate([[np.zeros(len(b.joints))], ends, Q])


def _first_departure(a: Chain, b: Chain, Q: Floats, tolerances: Tolerances) -> Departure:
    zero = np.zeros(len(b.joints))
    tip = b.pose(zero).translation
    links_a, links_b = a.link_poses(zero), b.link_poses(zero)
    if len(links_a) != len(links_b):
        pairs = [(a.pose(q), b.pose(q)) for q in Q]
        position = max(position_distance(*pair) for pair in pairs)
        return Departure(None, 0, position, max(rotation_distance(*pair) for pair in pairs))
    moved = [(_motions(a.link_poses(q), links_a), _motions(b.link_poses(q), links_b)) for q in Q]
    for k in range(len(links_b)):
        position = max(float(np.linalg.norm(_apply(Ma[k], tip) - _apply(Mb[k], tip))) for Ma, Mb in moved)
        rotation = max(rotation_angle(Ma[k, :3, :3].T @ Mb[k, :3, :3]) for Ma, Mb in moved)
        if position > tolerances.agreement_position or rotation > tolerances.agreement_rotation:
            return Departure(b.path_joint_names[k], k + 1, position, rotation)
    T_a, T_b = a.pose(zero), b.pose(zero)
    return Departure(None, len(links_b) + 1, position_distance(T_a, T_b), rotation_distance(T_a, T_b))


def _motions(links: Floats, links_at_zero: Floats) -> Floats:
    """The rigid motions (m, 4, 4) of the base's space that carry each link from its place at q = 0 to where it is."""
    inverses = np.linalg.inv(links_at_zero)
    motions: Floats = links @ inverses
    return motions


def _apply(T: Floats, point: Floats) -> Floats:
    moved: Floats = T[:3, :3] @ point + T[:3, 3]
    return moved
