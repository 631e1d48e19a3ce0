"""What a kinematic chain is, whatever computes it, and what can be done with any of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np

from nao_kin.arrays import Floats, frozen, rows, vector
from nao_kin.errors import InvalidInputError
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import pinocchio as pin
    from numpy.typing import ArrayLike

    from nao_kin.kernels.joint_path import JointPath

__all__ = [
    "Chain",
    "ChainJoint",
    "FlatChain",
    "JacobianFrame",
    "JointColumns",
    "JointSpace",
    "LimitRule",
    "MovingKind",
    "OutsideLimit",
    "configuration",
    "finite_difference_jacobian",
    "in_limits",
    "into_limits",
    "joint_table",
    "limit_table",
    "limit_text",
    "limit_texts",
    "neutral",
    "outside_limits",
    "random_configurations",
    "sampling_range",
    "value_unit",
]

JacobianFrame: TypeAlias = Literal["base", "tip"]
MovingKind: TypeAlias = Literal["revolute", "continuous", "prismatic"]


@dataclass(frozen=True, slots=True)
class ChainJoint:
    """One column of a chain.

    Attributes:
        name: Joint name; of coupled joints, the leader.
        kind: ``"revolute"`` [rad], ``"continuous"`` [rad, no limits] or ``"prismatic"`` [m].
        lower: Least value [rad or m], −inf where there is none.
        upper: Greatest value [rad or m], +inf where there is none.
        max_velocity: Greatest speed [rad/s or m/s], +inf where none is known.
    """

    name: str
    kind: MovingKind = "revolute"
    lower: float = -math.inf
    upper: float = math.inf
    max_velocity: float = math.inf


@dataclass(frozen=True, slots=True)
class LimitRule:
    """A coupled limit: the range of one joint as a piecewise linear function of another joint's value.

    Attributes:
        joint: The joint whose range it is.
        by: The joint that decides the range.
        at: Values of `by` [rad], ascending.
        lower: Least value of `joint` at each [rad].
        upper: Greatest value of `joint` at each [rad].
        even: True if only the size of `by` counts, not its sign.
    """

    joint: str
    by: str
    at: tuple[float, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    even: bool = False

    def range(self, by: float) -> tuple[float, float]:
        """Range of `joint` [rad] when the deciding joint stands at `by` [rad]; constant beyond the table's ends."""
        value = abs(by) if self.even else by
        return float(np.interp(value, self.at, self.lower)), float(np.interp(value, self.at, self.upper))


class JointSpace(Protocol):
    """Joints with ranges, one plain number each: what a chain and a tree of chains have in common."""

    @property
    def name(self) -> str:
        """What to call it in messages."""

    @property
    def joints(self) -> tuple[ChainJoint, ...]:
        """The n joints, in the order of `q`."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Their names."""

    @property
    def lower(self) -> Floats:
        """Least values (n,), read-only; −inf where there is none."""

    @property
    def upper(self) -> Floats:
        """Greatest values (n,), read-only; +inf where there is none."""

    @property
    def max_velocity(self) -> Floats:
        """Greatest speeds (n,) [rad/s or m/s], read-only; +inf where none is known."""

    @property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """Coupled limits both of whose joints are among them."""


@runtime_checkable
class Chain(JointSpace, Protocol):
    """A path of joints from a base frame to a tip frame, one plain number a joint.

    `q` is a vector of n numbers in base-to-tip order [rad, or m for prismatic joints].
    """

    @property
    def base_name(self) -> str:
        """Name of the frame in which poses are given."""

    @property
    def tip_name(self) -> str:
        """Name of the frame whose pose is given."""

    @property
    def path_joint_names(self) -> tuple[str, ...]:
        """Names of the m physical joints of the path, coupled ones included; m ≥ n."""

    @property
    def joint_path(self) -> JointPath:
        """The flat form that compiled code runs on."""

    def pose(self, q: ArrayLike) -> pin.SE3:
        """T_base_tip at q (n,) [rad, m]."""

    def tip_at(self, q: Floats) -> tuple[Floats, Floats]:
        """Rotation (3, 3) and position (3,) of `pose` at a q that is not checked; to be read at once and not kept."""

    def jacobian(self, q: ArrayLike, frame: JacobianFrame = "base") -> Floats:
        """Frame Jacobian (6, n) at q (n,) of the tip point, rows (linear; angular), in axes of that frame."""

    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses (m, 4, 4) in the base frame of the link behind each of the m physical joints of the path."""

    def q_of(self, posture: Mapping[str, float]) -> Floats:
        """This chain's configuration (n,) out of a posture."""

    def poses(self, Q: ArrayLike) -> Floats:
        """T_base_tip (N, 4, 4) for configurations (N, n)."""

    def jacobians(self, Q: ArrayLike) -> Floats:
        """Frame Jacobians (N, 6, n), base axes, for configurations (N, n)."""


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
        rows = [(joint.lower, joint.upper, joint.max_velocity) for joint in self.joints]
        lower, upper, velocity = (frozen(column.copy()) for column in np.reshape(rows, (-1, 3)).astype(np.float64).T)
        return lower, upper, velocity


class FlatChain(JointColumns):
    """What has a flat form: the part of a `Chain` that compiled code does, many configurations at a time."""

    if TYPE_CHECKING:

        @property
        def name(self) -> str:
            """What to call it in messages."""

        @property
        def joint_path(self) -> JointPath:
            """The flat form that compiled code runs on."""

    def poses(self, Q: ArrayLike) -> Floats:
        """T_base_tip (N, 4, 4) for configurations (N, n), on all cores.

        Raises:
            InvalidInputError: Wrong shape or not finite.
        """
        from nao_kin.kernels.forward import poses  # imports numba, which costs time

        return poses(self.joint_path, rows(Q, f"Q of {self.name}", len(self.joints)))

    def jacobians(self, Q: ArrayLike) -> Floats:
        """Frame Jacobians (N, 6, n), base axes, for configurations (N, n), on all cores.

        Raises:
            InvalidInputError: Wrong shape or not finite.
        """
        from nao_kin.kernels.forward import jacobians

        return jacobians(self.joint_path, rows(Q, f"Q of {self.name}", len(self.joints)))


@dataclass(frozen=True, slots=True)
class OutsideLimit:
    """One joint that is outside its range: value and range [rad or m]."""

    joint: str
    value: float
    lower: float
    upper: float

    def __str__(self) -> str:
        return f"{self.joint} = {self.value:.6g} is outside [{self.lower:.6g}, {self.upper:.6g}]"


def configuration(chain: JointSpace, q: ArrayLike) -> Floats:
    """`q` as a fresh vector of the chain's or tree's length.

    Raises:
        InvalidInputError: Wrong length or not finite; the message names the joints.
    """
    n = len(chain.joints)
    try:
        return vector(q, f"q of {chain.name}", n)
    except InvalidInputError as error:
        names = ", ".join(chain.joint_names)
        raise InvalidInputError(error.what, f"{error.expected} ({names})", error.got) from None


def outside_limits(chain: JointSpace, q: ArrayLike, tolerance: float = 0.0) -> tuple[OutsideLimit, ...]:
    """The joints of `q` outside their own or their coupled range by more than `tolerance` [rad or m]."""
    values = configuration(chain, q).tolist()
    index = {name: i for i, name in enumerate(chain.joint_names)}
    ranges = [(i, joint.lower, joint.upper) for i, joint in enumerate(chain.joints)]
    ranges += [(index[rule.joint], *rule.range(values[index[rule.by]])) for rule in chain.limit_rules]
    return tuple(
        OutsideLimit(chain.joints[i].name, values[i], lower, upper)
        for i, lower, upper in ranges
        if values[i] < lower - tolerance or values[i] > upper + tolerance
    )


def in_limits(chain: JointSpace, q: ArrayLike, tolerance: float = 0.0) -> bool:
    """Whether every joint is inside its own and its coupled range."""
    return not outside_limits(chain, q, tolerance)


def into_limits(chain: JointSpace, q: Floats) -> Floats:
    """The configuration with every joint moved to the nearest end of its range, coupled ranges last."""
    moved = np.clip(q, chain.lower, chain.upper)
    if chain.limit_rules:
        index = {name: i for i, name in enumerate(chain.joint_names)}
        for rule in chain.limit_rules:
            lower, upper = rule.range(moved[index[rule.by]])
            i = index[rule.joint]
            moved[i] = min(max(moved[i], lower, chain.lower[i]), upper, chain.upper[i])
    return moved


def neutral(chain: JointSpace) -> Floats:
    """All zeros, moved into the limits: where solvers start unless told otherwise."""
    return into_limits(chain, np.zeros(len(chain.joints)))


def sampling_range(chain: JointSpace) -> tuple[Floats, Floats]:
    """Finite ends (n,), (n,) between which joints are sampled: the limits; ±π for a joint that turns without limits.

    A prismatic joint without limits moves through ±1 m, and a joint with one limit through as much from there.
    """
    half = np.array([1.0 if joint.kind == "prismatic" else math.pi for joint in chain.joints])
    endless = 1e6  # [rad, m] some files write a huge number where they mean that there is no limit
    low, high = np.abs(chain.lower) < endless, np.abs(chain.upper) < endless
    lower = np.where(low, chain.lower, np.where(high, np.minimum(-half, chain.upper - 2 * half), -half))
    upper = np.where(high, chain.upper, np.where(low, np.maximum(half, chain.lower + 2 * half), half))
    return lower, upper


def random_configurations(chain: JointSpace, count: int, rng: np.random.Generator) -> Floats:
    """`count` configurations (count, n), uniform inside the limits; see `sampling_range` for joints without any.

    Coupled limits are met by moving the limited joint into its range, so its values gather at the ends there.
    """
    lower, upper = sampling_range(chain)
    Q = np.clip(rng.uniform(lower, upper, size=(count, len(chain.joints))), chain.lower, chain.upper)
    if chain.limit_rules:
        Q = np.array([into_limits(chain, q) for q in Q]).reshape(Q.shape)
    return Q


def finite_difference_jacobian(chain: Chain, q: ArrayLike, step: float = 1e-5) -> Floats:
    """Frame Jacobian (6, n) in base axes by central differences of `chain.pose`: an oracle, not a fast path.

    The angular rows come from the skew part of Ṙ Rᵀ, so they need no logarithm.
    """
    centre = configuration(chain, q)
    R = chain.pose(centre).rotation
    columns = []
    for i in range(len(centre)):
        forward, backward = centre.copy(), centre.copy()
        forward[i] += step
        backward[i] -= step
        T_plus, T_minus = chain.pose(forward), chain.pose(backward)
        linear = (T_plus.translation - T_minus.translation) / (2.0 * step)
        W = (T_plus.rotation - T_minus.rotation) @ R.T / (2.0 * step)
        angular = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
        columns.append(np.concatenate([linear, angular]))
    return np.array(columns).T


def value_unit(joints: Iterable[ChainJoint], per: str = "") -> str:
    """Unit of the joints' values for a heading, ``"rad"``, ``"m"`` or ``"rad or m"``, each with `per` behind it."""
    slides = {joint.kind == "prismatic" for joint in joints}
    units = [unit for unit, wanted in (("rad", False), ("m", True)) if wanted in slides]
    return " or ".join(unit + per for unit in units or ["rad"])


def joint_table(chain: JointSpace, q: ArrayLike, title: str = "", note: str = "", *, limits: bool = False) -> Table:
    """The joints of a chain with their values in radians and degrees, or metres; with their ranges and speeds too."""
    rows = [
        [joint.name, f"{value:.6f}", "" if joint.kind == "prismatic" else f"{math.degrees(value):.3f}"]
        for joint, value in zip(chain.joints, configuration(chain, q).tolist(), strict=True)
    ]
    headings = ["[rad, m]", "[deg]"]
    if limits:
        headings += ["range", f"max [{value_unit(chain.joints, '/s')}]"]
        for row, (lower, upper, speed) in zip(rows, map(limit_texts, chain.joints), strict=True):
            row += [lower if lower == upper == "none" else f"{lower} … {upper}", speed]
    columns = (Column("joint"), *(Column(heading, number=True) for heading in headings))
    return Table(columns, tuple(map(tuple, rows)), title=title, note=note)


def limit_table(chain: JointSpace, title: str) -> Table:
    """The joints of a chain or tree with their kinds, ranges and speeds; coupled ranges are named below."""
    unit, speed = value_unit(chain.joints), value_unit(chain.joints, "/s")
    numbers = (f"lower [{unit}]", f"upper [{unit}]", f"max speed [{speed}]")
    rows = tuple((joint.name, joint.kind, *limit_texts(joint)) for joint in chain.joints)
    rules = [f"The range of {rule.joint} also depends on {rule.by}." for rule in chain.limit_rules]
    columns = (Column("joint"), Column("kind"), *(Column(heading, number=True) for heading in numbers))
    return Table(columns, rows, title=title, note="\n".join(rules))


def limit_texts(joint: ChainJoint) -> tuple[str, str, str]:
    """Least value, greatest value and greatest speed of a joint for a table."""
    return limit_text(joint.lower), limit_text(joint.upper), limit_text(joint.max_velocity)


def limit_text(value: float) -> str:
    """A limit for a table: four digits, or that there is none."""
    return f"{value:.4g}" if math.isfinite(value) else "none"
