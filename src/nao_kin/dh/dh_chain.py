"""Denavit-Hartenberg chains: a hand-written table, computed exactly as it is written.

The convention is always spelled, because the same numbers mean another arm in the other one:

* ``"standard"`` (distal): A_k = Rz(θ) Tz(d) Tx(a) Rx(α); Denavit and Hartenberg 1955, Paul 1981.
* ``"modified"`` (proximal): A_k = Rx(α) Tx(a) Rz(θ) Tz(d); Craig, Introduction to Robotics.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
import pinocchio as pin

from nao_kin.chain import (
    ChainJoint,
    FlatChain,
    JacobianFrame,
    LimitRule,
    configuration,
)
from nao_kin.dh.dh_row import (
    PER_METRE,
    PER_RADIAN,
    Convention,
    DHRow,
    RowLike,
    as_row,
    dh_matrix,
    in_si,
    known_convention,
)
from nao_kin.dh.table_file import format_table_file, read_table_file
from nao_kin.dh.to_urdf import urdf_text
from nao_kin.errors import InvalidInputError, TableFileError, UnknownNameError
from nao_kin.kernels.joint_path import JointPath, PathJoint, joint_path
from nao_kin.se3 import PoseLike, as_pose
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["Convention", "DHChain", "DHRow"]


@dataclass(frozen=True, eq=False)
class DHChain(FlatChain):
    """A chain given by a DH table: T_base_tip = base · A_1(q_1) … A_n(q_n) · tool.

    Implements the `nao_kin.chain.Chain` protocol by plain matrix products, without any model.

    Attributes:
        rows: The table, base to tip.
        convention: ``"standard"`` or ``"modified"``; see the module.
        base: Constant transform before the first row.
        tool: Constant transform after the last row.
        name: What to call it in messages.
        base_name: Name of the frame in which poses are given.
        tip_name: Name of the frame whose pose is given.
    """

    rows: tuple[DHRow, ...]
    convention: Convention
    base: pin.SE3
    tool: pin.SE3
    name: str = "table"
    base_name: str = "base"
    tip_name: str = "tip"

    def __post_init__(self) -> None:
        if not self.rows:
            raise InvalidInputError(f"table {self.name}", "at least one row", "none")
        known_convention(self.convention)
        for end in ("base", "tool"):  # copies: what the caller holds may change
            object.__setattr__(self, end, as_pose(getattr(self, end), f"table {self.name}, {end}"))
        names = self.joint_names
        if twice := [name for name in names if names.count(name) > 1]:
            raise InvalidInputError(f"table {self.name}", "joint names that differ", f"{twice[0]!r} twice")

    @classmethod
    def from_table(
        cls,
        rows: Iterable[RowLike],
        convention: Convention,
        *,
        base: PoseLike | None = None,
        tool: PoseLike | None = None,
        lengths: Literal["m", "mm"] = "m",
        angles: Literal["rad", "deg"] = "rad",
        name: str = "table",
        base_name: str = "base",
        tip_name: str = "tip",
    ) -> DHChain:
        """A chain from rows in the units of the document they come from.

        Args:
            rows: Mappings with the field names of `DHRow`, sequences (a, alpha, d, theta[, sign]), or `DHRow`, which
                is in metres and radians and therefore goes with these units only.
            convention: ``"standard"`` or ``"modified"``; there is no default.
            base: Constant transform before the first row; a (4, 4) matrix with its translation in
                `lengths`, or a `pin.SE3`, which is in metres.
            tool: Constant transform after the last row, likewise.
            lengths: Unit of a, d, the translations and the limits of prismatic joints.
            angles: Unit of alpha, theta and the limits of revolute joints.
            name: What to call the chain.
            base_name: Name of the frame in which poses are given.
            tip_name: Name of the frame whose pose is given.

        Raises:
            InvalidInputError: Unknown convention or unit, a row of the wrong form, or a number that is not finite.
        """
        for what, value, known in (("lengths", lengths, PER_METRE), ("angles", angles, PER_RADIAN)):
            if value not in known:
                raise InvalidInputError(f"table {name}, {what}", " or ".join(map(repr, known)), repr(value))
        known_convention(convention)
        rows = list(rows)
        if (lengths, angles) != ("m", "rad") and any(isinstance(row, DHRow) for row in rows):
            raise InvalidInputError(
                f"table {name}, rows", "mappings or sequences", f"DHRow with {lengths} and {angles}"
            )
        converted = tuple(
            in_si(as_row(row, number), number, lengths, angles) for number, row in enumerate(rows, start=1)
        )
        ends = [_end(end, what, lengths) for end, what in ((base, "base"), (tool, "tool"))]
        return cls(converted, convention, ends[0], ends[1], name, base_name, tip_name)

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> DHChain:
        """A chain from a TOML file; docs/dh-table.md describes the format.

        Raises:
            TableFileError: Unreadable or malformed; carries the line and what was expected.
        """
        arguments = read_table_file(path)
        try:
            return cls.from_table(**arguments)
        except InvalidInputError as error:  # what only the table as a whole can tell, as a name that stands twice
            raise TableFileError(str(path), None, str(error)) from None

    def to_toml(self) -> str:
        """The table as TOML in metres and radians; `from_file` gives the same chain back, bit for bit."""
        rows = [{f.name: getattr(row, f.name) for f in fields(row)} for row in self.rows]
        heading = {key: getattr(self, key) for key in ("name", "convention", "base_name", "tip_name")}
        return format_table_file(heading, self.base.homogeneous, self.tool.homogeneous, rows)

    def with_tool(self, tool: PoseLike) -> DHChain:
        """The same table with T_tip_tool after its own tool: poses are those of the tool's frame.

        Raises:
            InvalidInputError: It is no pose.
        """
        return replace(self, tool=self.tool * as_pose(tool, "tool"), tip_name=f"tool on {self.tip_name}")

    def with_base(self, mount: PoseLike) -> DHChain:
        """The same table with T_mount_base before its own base: poses are given in the frame that is wanted.

        Raises:
            InvalidInputError: It is no pose.
        """
        return replace(self, base=as_pose(mount, "base") * self.base, base_name=f"mount of {self.base_name}")

    def to_urdf(self) -> str:
        """The table as a URDF file's text that `nao_kin.load` reads: the same chain from `base_name` to `tip_name`.

        A revolute joint without limits becomes a continuous one; where only one end is open, or a joint slides without
        end, ±1e9 stands for it, because URDF has no word for that.

        Raises:
            InvalidInputError: Base and tip bear the same name.
        """
        return urdf_text(self.name, self.base_name, self.tip_name, self.joints, self.joint_path)

    def read_as(self, convention: Convention) -> DHChain:
        """The same numbers read in a convention, which is another arm unless it is the table's own."""
        return replace(self, convention=known_convention(convention))

    @cached_property
    def joints(self) -> tuple[ChainJoint, ...]:
        """The n joints, base to tip."""
        return tuple(
            ChainJoint(row.name or f"joint_{k}", row.kind, row.lower, row.upper, row.max_velocity)
            for k, row in enumerate(self.rows, start=1)
        )

    @property
    def path_joint_names(self) -> tuple[str, ...]:
        """The same: every joint has a column of its own."""
        return self.joint_names

    @property
    def limit_rules(self) -> tuple[LimitRule, ...]:
        """None: a table does not state coupled limits."""
        return ()

    def pose(self, q: ArrayLike) -> pin.SE3:
        """T_base_tip at q (n,) [rad, m].

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        return pin.SE3(self._frames(configuration(self, q))[-1] @ self.tool.homogeneous)

    def tip_at(self, q: Floats) -> tuple[Floats, Floats]:
        """Rotation (3, 3) and position (3,) [m] of `pose`, for who checks q (n,) otherwise."""
        T_base_tip = self._frames(q)[-1] @ self.tool.homogeneous
        return T_base_tip[:3, :3].copy(order="F"), T_base_tip[:3, 3].copy()  # laid out as Pinocchio's are

    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses (n, 4, 4) in the base frame of the table's frame k = 1…n, each fixed to the link behind joint k.

        Raises:
            InvalidInputError: Wrong length or not finite.
        """
        return self._frames(configuration(self, q))[1:]

    def jacobian(self, q: ArrayLike, frame: JacobianFrame = "base") -> Floats:
        """Frame Jacobian (6, n) at q (n,) of the tip point, rows (linear; angular), in axes of base or tip frame.

        Column of a revolute joint: (z × (p_tip − p); z), with z the joint's axis and p a point on it.

        Raises:
            InvalidInputError: Wrong length, not finite, or another frame than these two.
        """
        if frame not in ("base", "tip"):
            raise InvalidInputError("frame", "'base' or 'tip'", repr(frame))
        frames = self._frames(configuration(self, q))
        T_base_tip = frames[-1] @ self.tool.homogeneous
        # A standard row turns about z of the frame before it, a modified row about z of its own frame.
        turning = frames[:-1] if self.convention == "standard" else frames[1:]
        J = np.zeros((6, len(self.rows)))
        for k, (row, T) in enumerate(zip(self.rows, turning, strict=True)):
            z = row.sign * T[:3, 2]
            if row.kind == "prismatic":
                J[:3, k] = z
            else:
                J[:3, k], J[3:, k] = np.cross(z, T_base_tip[:3, 3] - T[:3, 3]), z
        if frame == "base":
            return J
        R = T_base_tip[:3, :3].T
        return np.concatenate([R @ J[:3], R @ J[3:]])

    def q_of(self, posture: Mapping[str, float]) -> Floats:
        """The configuration (n,) out of joint values by name; joints not named are at 0.

        Raises:
            UnknownNameError: A name is no joint of the table.
            InvalidInputError: A value is not a finite number.
        """
        for name in posture:
            if name not in self.joint_names:
                raise UnknownNameError("joint", name, self.joint_names, self.name)
        return configuration(self, [posture.get(name, 0.0) for name in self.joint_names])

    @cached_property
    def joint_path(self) -> JointPath:
        """The flat form that compiled code runs on."""
        before, joints = self.base.homogeneous, []
        for column, row in enumerate(self.rows):
            at_zero = dh_matrix(row, 0.0, self.convention)
            # z of the frame before a standard row and z of a modified row's own frame: both turn the row's frame.
            placement, after = (np.eye(4), at_zero) if self.convention == "standard" else (at_zero, np.eye(4))
            axis = np.array([0.0, 0.0, 1.0])
            joints.append(PathJoint(before @ placement, axis, row.kind == "prismatic", column, float(row.sign)))
            before = after
        return joint_path(joints, before @ self.tool.homogeneous, self.lower, self.upper)

    def _frames(self, q: Floats) -> Floats:
        """The base and the n frames of the table in the base frame, (n + 1, 4, 4)."""
        T = self.base.homogeneous
        frames = [T]
        for row, value in zip(self.rows, q.tolist(), strict=True):
            T = T @ dh_matrix(row, value, self.convention)
            frames.append(T)
        return np.array(frames)

    def __repr__(self) -> str:
        return f"<DHChain {self.name} ({self.convention}): {', '.join(self.joint_names)}>"

    def _repr_html_(self) -> str:
        return self.row_table()._repr_html_()

    def row_table(self) -> Table:
        """The rows as a table in millimetres and degrees."""
        rows = tuple(
            (
                joint.name,
                f"{row.a * 1e3:.6g}",
                f"{math.degrees(row.alpha):.6g}",
                f"{row.d * 1e3:.6g}",
                f"{math.degrees(row.theta):.6g}",
                f"{row.sign:+d}",
            )
            for joint, row in zip(self.joints, self.rows, strict=True)
        )
        columns = (
            Column("joint"),
            *(Column(c, number=True) for c in ("a [mm]", "α [°]", "d [mm]", "θ offset [°]", "sign")),
        )
        return Table(columns, rows, title=f"{self.name}, {self.convention} convention")


def _end(pose: PoseLike | None, what: str, lengths: str) -> pin.SE3:
    """A constant transform in metres, from a `pin.SE3` in metres or a matrix in the table's unit."""
    T = as_pose(np.eye(4) if pose is None else pose, what)
    if not isinstance(pose, pin.SE3):
        T.translation = T.translation / PER_METRE[lengths]
    return T
