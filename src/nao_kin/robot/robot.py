"""A robot out of a URDF file, with Pinocchio doing the arithmetic.

Pinocchio's own configuration vector stays behind it: outside, a robot has postures, joint name to number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from nao_kin.arrays import finite
from nao_kin.chain import ChainJoint, LimitRule, OutsideLimit, into_limits, limit_texts
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.robot.chain_names import end_chains, srdf_chains
from nao_kin.robot.couplings import Coupling, couplings_of, driven_joints, stated
from nao_kin.robot.known import CoupledLimit, KnownRobot, example_robot_data_share
from nao_kin.robot.motors import Motors
from nao_kin.robot.pinocchio_layout import PinocchioLayout
from nao_kin.robot.sources import read_source, tell
from nao_kin.robot.tool import as_tool
from nao_kin.robot.tree import Tree
from nao_kin.robot.urdf_chain import UrdfChain
from nao_kin.table import Column, Table
from nao_kin.urdf.writer import UNLIMITED

if TYPE_CHECKING:
    import os

    from nao_kin.robot.tool import ToolLike
    from nao_kin.urdf import UrdfDocument
    from nao_kin.urdf.elements import UrdfJoint
    from nao_kin.urdf.packages import PackageRoots

__all__ = ["Robot", "load"]


def load(
    robot: str | os.PathLike[str], *, arguments: Mapping[str, object] | None = None, packages: PackageRoots = ()
) -> Robot:
    """A robot by known name (`nao_kin.robot_names`) or by the path of a URDF, xacro or MJCF file.

    Args:
        robot: Text that ends in ``.urdf`` or ``.xacro`` or contains a path separator is a path; a `pathlib.Path` is.
        arguments: Values of the ``<xacro:arg>`` of a file of macros, as ``{"name": "ur5e"}``.
        packages: Package folders by name, or folders that hold packages, for ``$(find NAME)`` and ``package://``.

    Returns:
        The robot, with named chains and coupled limits if it is a known one.

    Raises:
        UnknownNameError: No robot of that name; carries near matches.
        MissingExtraError: The robot's files come with an optional extra, or it is one of macros and ``xacro`` is not
            installed.
        InvalidInputError: Arguments for a file that takes none.
        UrdfError: The file is unreadable, hostile or malformed; carries the line and the reason.

    Warns:
        UrdfWarning: The file has mistakes that every reader gets past, as limits with their ends swapped; with lines.
    """
    document, known = read_source(robot, arguments, packages)
    tell(document)
    return Robot.from_document(document, known, packages)


@dataclass(frozen=True, eq=False)
class Robot:
    """An immutable model: joints, limits, couplings, frames, geometry. It holds no configuration.

    A frame is named by its link. A *posture* maps joint names to values [rad or m]; joints it does not name are at 0.

    Attributes:
        name: Known name, or the name in the file.
        document: The file's content, as read.
        chain_frames: Chain name to (base frame, tip frame).
        effectors: Frames that the robot's documentation calls effectors.
        limit_rules: Coupled limits.
        mesh_roots: Folders below which mesh files may be read.
    """

    name: str
    document: UrdfDocument
    chain_frames: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    effectors: tuple[str, ...] = ()
    limit_rules: tuple[LimitRule, ...] = ()
    mesh_roots: tuple[Path, ...] = ()

    @classmethod
    def from_document(
        cls, document: UrdfDocument, known: KnownRobot | None = None, packages: PackageRoots = ()
    ) -> Robot:
        """A robot from a parsed document, with what is known about it beyond that if it is a known one.

        Args:
            document: The file's content.
            known: What is known about the robot, if it is one of the known.
            packages: Package folders by name, or folders that hold packages, for the names of meshes.
        """
        roots = [] if document.directory is None else [document.directory]
        roots += map(Path, packages.values() if isinstance(packages, Mapping) else packages)
        if known is None:
            return cls(name=document.name, document=document, mesh_roots=tuple(roots))
        if known.source == "example-robot-data" and (share := example_robot_data_share()) is not None:
            roots.append(share)
        return cls(
            name=known.name,
            document=document,
            chain_frames=dict(known.chains),
            effectors=known.effectors,
            limit_rules=tuple(_limit_rule(rule) for rule in known.coupled_limits),
            mesh_roots=tuple(roots),
        )

    @cached_property
    def model(self) -> pin.Model:
        """The `pinocchio.Model`, as an escape hatch; its joint order and vectors are Pinocchio's own."""
        model = pin.buildModelFromXML(self.document.to_xml())
        for most in (model.velocityLimit, model.upperEffortLimit):  # the largest number stands for "no limit" there
            most[most >= UNLIMITED] = math.inf
        model.lowerEffortLimit = -model.upperEffortLimit
        return model

    @cached_property
    def moving_joints(self) -> tuple[UrdfJoint, ...]:
        """The joints that move, in file order, followers included."""
        return tuple(joint for joint in self.document.joints if joint.kind != "fixed")

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the moving joints, in file order, followers included."""
        return tuple(joint.name for joint in self.moving_joints)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of the frames, which are the names of the links, in file order."""
        return tuple(link.name for link in self.document.links)

    @property
    def root(self) -> str:
        """The frame that every other one hangs from."""
        return self.document.root

    @property
    def chain_names(self) -> tuple[str, ...]:
        """Names that `chain` takes: those of a known robot, the groups of an SRDF beside the file, the end links."""
        return (*self.chain_frames, *(name for name in self._other_chains if name not in self.chain_frames))

    @cached_property
    def _other_chains(self) -> dict[str, tuple[str, str]]:
        return {**end_chains(self.document), **srdf_chains(self.document)}

    @cached_property
    def couplings(self) -> tuple[Coupling, ...]:
        """Joints that follow another one, each given by the leader that has the motor."""
        return couplings_of(self.moving_joints)

    @cached_property
    def driven_joints(self) -> Mapping[str, ChainJoint]:
        """The moving joints by name, in file order, with the ranges and speeds that they have together.

        A motor goes as far and as fast as all that it moves allow, and a follower as its motor makes it go: where
        ``f`` follows ``m`` with multiplier −2 and may do 1 rad/s, ``m`` does 0.5 rad/s.

        Raises:
            InvalidInputError: A follower leaves its leader no value at all.
        """
        return driven_joints(self.stated_joints, self.couplings)

    @cached_property
    def shown_joints(self) -> Mapping[str, ChainJoint]:
        """The same, but joints that contradict each other keep their ranges, so that the robot can be shown."""
        return driven_joints(self.stated_joints, self.couplings, contradictory=True)

    @cached_property
    def stated_joints(self) -> tuple[ChainJoint, ...]:
        """The moving joints as the file states them, each by itself, in file order."""
        return tuple(map(stated, self.moving_joints))

    @cached_property
    def neutral(self) -> dict[str, float]:
        """The posture with every joint at 0, moved into its limits and its followers', coupled limits last.

        Raises:
            InvalidInputError: A follower's range excludes its leader's.
        """
        motors = Motors.of(self)
        q = into_limits(motors, np.zeros(len(motors.joints)))
        return self.expand(dict(zip(motors.joint_names, q.tolist(), strict=True)))

    def expand(self, posture: Mapping[str, float]) -> dict[str, float]:
        """The posture of every moving joint: what is not named is at 0, followers go with their leaders.

        Naming a follower without its leader moves the leader: they share one motor.

        Raises:
            UnknownNameError: A name is no moving joint.
            InvalidInputError: A value is not a finite number, or a follower contradicts its leader.
        """
        if not isinstance(posture, Mapping):
            raise InvalidInputError("posture", "joint values by name, as {'LElbowRoll': -0.5}", repr(posture)[:60])
        given: dict[str, float] = {}
        for name, value in posture.items():
            if name not in self._moving_by_name:
                raise UnknownNameError("moving joint", name, self.joint_names, self.name)
            given[name] = finite(value, f"posture, {name}", "[rad or m]")
        values = {name: given.get(name, 0.0) for name in self.joint_names}
        for c in self.couplings:
            if c.follower in given and c.leader not in given:
                values[c.leader] = given.setdefault(c.leader, (given[c.follower] - c.offset) / c.multiplier)
        for c in self.couplings:
            values[c.follower] = c.multiplier * values[c.leader] + c.offset
            wanted = given.get(c.follower, values[c.follower])
            if abs(wanted - values[c.follower]) > 1e-9:
                rule = f"{values[c.follower]:.6g}, because it follows {c.leader} = {values[c.leader]:.6g}"
                raise InvalidInputError(f"posture, {c.follower}", rule, f"{wanted:.6g}")
        return values

    def complete(self, posture: Mapping[str, float]) -> dict[str, float]:
        """The posture of every moving joint, with those it does not name at their neutral values instead of at 0.

        Raises:
            UnknownNameError, InvalidInputError: See `expand`.
        """
        motor = {c.follower: c.leader for c in self.couplings}
        named = {motor.get(name, name) for name in posture}
        rest = {name: value for name, value in self.neutral.items() if motor.get(name, name) not in named}
        return self.expand({**rest, **posture})

    def outside_limits(self, posture: Mapping[str, float]) -> tuple[OutsideLimit, ...]:
        """The joints of a posture that are outside their own or their coupled ranges.

        Raises:
            UnknownNameError, InvalidInputError: See `expand`.
        """
        values = self.expand(posture)
        # A follower at its end is not outside for the rounding of its leader's range: the motor is looked at, too.
        together = ((self.shown_joints[joint.name], joint) for joint in self.stated_joints)
        ranges = [
            (own.name, own.lower, own.upper)
            for driven, own in together
            if not driven.lower <= values[own.name] <= driven.upper
        ]
        rules = (rule for rule in self.limit_rules if rule.joint in values and rule.by in values)
        ranges += [(rule.joint, *rule.range(values[rule.by])) for rule in rules]
        return tuple(
            OutsideLimit(name, values[name], lower, upper)
            for name, lower, upper in ranges
            if not lower <= values[name] <= upper
        )

    def pose(self, posture: Mapping[str, float], tip: str, base: str | None = None) -> pin.SE3:
        """T_base_tip of a tip frame in a base frame, the root unless named, at a posture.

        Raises:
            UnknownNameError: Unknown joint or frame; carries near matches.
            InvalidInputError: See `expand`.
        """
        base = self.root if base is None else base
        self._require_frames(base, tip)
        poses = self.link_poses(posture)
        return poses[base].actInv(poses[tip])

    def link_poses(self, posture: Mapping[str, float]) -> dict[str, pin.SE3]:
        """T_root_link of every link at a posture (see `expand` for what it raises)."""
        data = self.model.createData()
        values = self.expand(posture)
        q = self._layout.q(np.array([values[name] for name in self.joint_names]))
        pin.framesForwardKinematics(self.model, data, q)
        return {name: pin.SE3(data.oMf[i]) for name, i in self._frame_ids.items()}

    def chain(self, base: str, tip: str | None = None, *, tool: ToolLike | None = None) -> UrdfChain:
        """The chain from a base frame to a tip frame, or a named one of `chain_names`: ``robot.chain("left_arm")``.

        Args:
            base: A frame, or the name of a chain where no tip is given.
            tip: A frame.
            tool: What sits on the tip, as `UrdfChain.with_tool` takes it: ``[0, 0, 0.1034, 0, 0, 0]``.

        Raises:
            InvalidInputError: The tool is none.
            UnknownNameError: Unknown frame or chain; carries near matches.
            NoPathError: No moving joint lies between the two frames.
        """
        if tip is None:
            frames = self.chain_frames.get(base) or self._other_chains.get(base)
            if frames is None:
                raise UnknownNameError("chain", base, self.chain_frames or self.chain_names, self.name)
            label = base
        else:
            frames = base, tip
            label = next((name for name, known in self.chain_frames.items() if known == frames), "")
        self._require_frames(*frames)
        return UrdfChain(self, *frames, label, tool=None if tool is None else as_tool(tool))

    def tree(self, base: str, tips: Sequence[str]) -> Tree:
        """The chains from one base frame to several tip frames as one: joints that they share are the same columns.

        ``robot.tree("torso", ["LArm", "RArm"])``; the base may be any frame, a foot for example.

        Raises:
            UnknownNameError: Unknown frame; carries near matches.
            InvalidInputError: No tips, or one of them twice.
            NoPathError: No moving joint lies between the base and a tip.
        """
        # A string is a sequence of frames with short names.
        if isinstance(tips, str) or not isinstance(tips, Sequence) or not all(isinstance(tip, str) for tip in tips):
            raise InvalidInputError("tips", "a list of frames, as ['LArm', 'RArm']", repr(tips)[:60])
        return Tree.of_chains([self.chain(base, tip) for tip in tips])

    def path(self, base: str, tip: str) -> tuple[tuple[UrdfJoint, ...], tuple[UrdfJoint, ...]]:
        """The joints met going up the tree from base, then those met going down to tip; fixed ones included."""
        up, down = self._joints_to_root(base), self._joints_to_root(tip)
        while up and down and up[-1] is down[-1]:
            up.pop(), down.pop()
        return tuple(up), tuple(reversed(down))

    def _joints_to_root(self, link: str) -> list[UrdfJoint]:
        joints = []
        while (joint := self._joint_above.get(link)) is not None:
            joints.append(joint)
            link = joint.parent
        return joints

    @cached_property
    def _joint_above(self) -> dict[str, UrdfJoint]:
        return {joint.child: joint for joint in self.document.joints}

    @cached_property
    def _moving_by_name(self) -> dict[str, UrdfJoint]:
        return {joint.name: joint for joint in self.moving_joints}

    def _require_frames(self, *names: str) -> None:
        """The one look-up of frames: Pinocchio answers an unknown name with an index that crashes later calls."""
        for name in names:
            if name not in self._link_names:
                raise UnknownNameError("frame", name, self.frame_names, self.name)

    @cached_property
    def _link_names(self) -> frozenset[str]:
        return frozenset(self.frame_names)

    @cached_property
    def _layout(self) -> PinocchioLayout:
        return PinocchioLayout.of(self.model, self.joint_names)

    @cached_property
    def _frame_ids(self) -> dict[str, int]:
        return {name: self.model.getFrameId(name, pin.FrameType.BODY) for name in self.frame_names}

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: self.__dict__[f.name] for f in fields(self)}  # Pinocchio's model is rebuilt when needed

    def __repr__(self) -> str:
        return f"<Robot {self.name}: {len(self.joint_names)} moving joints, {len(self.frame_names)} frames>"

    def _repr_html_(self) -> str:
        return self.joint_table()._repr_html_()

    def joint_table(self) -> Table:
        """The moving joints with the ranges and speeds that they have together (see `driven_joints`)."""
        leaders = {c.follower: c.leader for c in self.couplings}
        rows = []
        for name, joint in self.shown_joints.items():
            follows = f"{joint.kind}, follows {leaders[name]}" if name in leaders else joint.kind
            rows.append((name, follows, "m" if joint.kind == "prismatic" else "rad", *limit_texts(joint)))
        numbers = (Column(c, number=True) for c in ("lower [unit]", "upper [unit]", "max speed [unit/s]"))
        columns = (Column("joint"), Column("kind"), Column("unit"), *numbers)
        return Table(columns, tuple(rows), title=f"{self.name}: {len(rows)} moving joints")


def _limit_rule(rule: CoupledLimit) -> LimitRule:
    at, lower, upper = zip(*rule.table, strict=True)
    return LimitRule(rule.joint, rule.by, at, lower, upper, even=rule.even)
