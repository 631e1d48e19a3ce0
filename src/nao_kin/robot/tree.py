"""Several chains from one base that share joints: one configuration for all of them, one pose and Jacobian a tip."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.arrays import frozen, rows
from nao_kin.chain import ChainJoint, JointColumns, LimitRule, configuration, limit_table
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.robot.couplings import couplings_on, spread_and_shift

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pinocchio as pin
    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.robot.robot import Robot

__all__ = ["Tree"]


@dataclass(frozen=True, eq=False, repr=False)
class Tree(JointColumns):
    """Chains from one base to several tips, with one column for each motor of their union.

    Make one with `nao_kin.Robot.tree` or `of_chains`. `q` is a vector of n numbers [rad, or m for prismatic joints].

    Attributes:
        chains: Tip name to chain, in the order given.
        joints: The n joints of the union, in the order in which walking the chains one after another, base to tip,
            first meets their motors. Coupled joints are one column, named by the leader where a chain has it.
        robot: The robot that the chains belong to; None for hand-written ones.
        spreads: Tip name to a matrix (n_chain, n): the chain's q is spread · q + shift.
        shifts: Tip name to a vector (n_chain,) [rad or m].
    """

    chains: Mapping[str, Chain]
    joints: tuple[ChainJoint, ...]
    robot: Robot | None
    spreads: Mapping[str, Floats]
    shifts: Mapping[str, Floats]

    @classmethod
    def of_chains(cls, chains: Sequence[Chain]) -> Tree:
        """A tree of any chains with the same base.

        Joints of the same name are one joint, and so are joints that the chains' robot drives by one motor. A range is
        what all chains allow.

        Raises:
            InvalidInputError: No chains, two of them with one tip, different bases or robots, or joints of one name
                that differ in kind or have no value in common.
        """
        by_tip = _by_tip(chains)
        robot = _common_robot(by_tip.values())
        names = list(dict.fromkeys(name for chain in by_tip.values() for name in chain.joint_names))
        couplings = couplings_on(names, () if robot is None else robot.couplings)
        owners = list(dict.fromkeys(couplings[name].leader for name in names))
        spreads, shifts = {}, {}
        for tip, chain in by_tip.items():
            spread, shift = spread_and_shift([couplings[name] for name in chain.joint_names], owners)
            spreads[tip], shifts[tip] = frozen(spread), frozen(shift)
        return cls(by_tip, _joined(by_tip.values(), owners), robot, spreads, shifts)

    @property
    def name(self) -> str:
        """Robot, base and tips, for messages."""
        owner = "" if self.robot is None else f"{self.robot.name} "
        return f"{owner}{self.base_name}→{'+'.join(self.chains)}"

    @property
    def base_name(self) -> str:
        """Name of the frame in which poses are given."""
        return next(iter(self.chains.values())).base_name

    @property
    def tip_names(self) -> tuple[str, ...]:
        """Names of the frames whose poses are given."""
        return tuple(self.chains)

    @cached_property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """Coupled limits both of whose joints are in the union, also where no single chain has both."""
        found = [rule for chain in self.chains.values() for rule in chain.limit_rules]
        found += () if self.robot is None else self.robot.limit_rules
        names = set(self.joint_names)
        return tuple(dict.fromkeys(rule for rule in found if rule.joint in names and rule.by in names))

    @cached_property
    def columns(self) -> Mapping[str, NDArray[np.intp]]:
        """Tip name to the column of the union (n_chain,) that moves each joint of the chain."""
        return {tip: np.argmax(spread != 0.0, axis=1) for tip, spread in self.spreads.items()}

    def chain_q(self, tip: str, q: ArrayLike) -> Floats:
        """The configuration (n_chain,) of one tip's chain at q (n,); for rows (N, n), its rows (N, n_chain).

        Raises:
            UnknownNameError: No such tip; carries near matches.
            InvalidInputError: Wrong shape or not finite.
        """
        self.require_tip(tip)
        many = np.ndim(q) == 2
        values = rows(q, f"Q of {self.name}", len(self.joints)) if many else configuration(self, q)
        found: Floats = values @ self.spreads[tip].T + self.shifts[tip]
        return found

    def poses(self, q: ArrayLike) -> dict[str, pin.SE3]:
        """T_base_tip of every tip at q (n,).

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        return {tip: chain.pose(self.chain_q(tip, q)) for tip, chain in self.chains.items()}

    def jacobians(self, q: ArrayLike) -> dict[str, Floats]:
        """Frame Jacobian (6, n) of every tip at the tip point, rows (linear; angular), base axes, the union's columns.

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        return {tip: chain.jacobian(self.chain_q(tip, q)) @ self.spreads[tip] for tip, chain in self.chains.items()}

    def q_of(self, posture: Mapping[str, float]) -> Floats:
        """The configuration (n,) out of a posture; joints that it does not name are at 0.

        Raises:
            UnknownNameError: A name is no joint of the robot or, without a robot, of the tree.
            InvalidInputError: A value is not a finite number, or contradicts a coupling.
        """
        if self.robot is not None:
            values = self.robot.expand(posture)
            return np.array([values[name] for name in self.joint_names], dtype=np.float64)
        for name in posture:
            if name not in self.joint_names:
                raise UnknownNameError("joint", name, self.joint_names, self.name)
        return configuration(self, [posture.get(name, 0.0) for name in self.joint_names])

    def require_tip(self, tip: str) -> None:
        """Does nothing for a tip of the tree.

        Raises:
            UnknownNameError: It is none; carries near matches.
        """
        if not isinstance(tip, str) or tip not in self.chains:
            raise UnknownNameError("tip", tip, self.chains, self.name)

    def __repr__(self) -> str:
        return f"<Tree {self.name}: {', '.join(self.joint_names)}>"

    def _repr_html_(self) -> str:
        return limit_table(self, f"{self.name}: {len(self.chains)} tips, {len(self.joints)} joints")._repr_html_()


def _by_tip(chains: Iterable[Chain]) -> dict[str, Chain]:
    by_tip: dict[str, Chain] = {}
    if not isinstance(chains, Iterable):
        raise InvalidInputError("chains of a tree", "a list of chains", repr(chains)[:60])
    for chain in chains:
        if not hasattr(chain, "joint_path"):
            raise InvalidInputError("chains of a tree", "chains only", repr(chain)[:60])
        if chain.tip_name in by_tip:
            raise InvalidInputError("tips", "each tip once", f"{chain.tip_name!r} twice")
        by_tip[chain.tip_name] = chain
    bases = dict.fromkeys(chain.base_name for chain in by_tip.values())
    if not bases:
        raise InvalidInputError("tips", "at least one", "none")
    if len(bases) > 1:
        raise InvalidInputError("chains of a tree", "the same base", " and ".join(map(repr, bases)))
    return by_tip


def _common_robot(chains: Iterable[Chain]) -> Robot | None:
    robots: list[Any] = [getattr(chain, "robot", None) for chain in chains]
    if any(robot is not robots[0] for robot in robots):
        names = dict.fromkeys("a table of its own" if robot is None else f"robot {robot.name}" for robot in robots)
        got = f"chains of {' and of '.join(names)}" + (" loaded twice" if len(names) == 1 else "")
        raise InvalidInputError("chains of a tree", "all of one robot, or all hand-written", got)
    found: Robot | None = robots[0]
    return found


def _joined(chains: Iterable[Chain], owners: Sequence[str]) -> tuple[ChainJoint, ...]:
    """The joint of each owner: what all chains that have it allow.

    A robot's chains have looked at what else its motor moves, on any path.
    """
    found: dict[str, ChainJoint] = {}
    for joint in (joint for chain in chains for joint in chain.joints):
        found[joint.name] = _narrowed(found.get(joint.name, joint), joint)
    return tuple(found[name] for name in owners)


def _narrowed(joint: ChainJoint, again: ChainJoint) -> ChainJoint:
    """A joint with the range and the speed that two chains allow."""
    if joint.kind != again.kind:
        raise InvalidInputError(f"joint {joint.name}", "one kind in all chains", f"{joint.kind} and {again.kind}")
    lower, upper = max(joint.lower, again.lower), min(joint.upper, again.upper)
    if lower > upper:
        got = f"[{joint.lower:.6g}, {joint.upper:.6g}] and [{again.lower:.6g}, {again.upper:.6g}]"
        raise InvalidInputError(f"joint {joint.name}", "ranges with a value in common", got)
    return replace(joint, lower=lower, upper=upper, max_velocity=min(joint.max_velocity, again.max_velocity))
