"""A chain whose geometry may be off: poses of its tip and their derivatives by every number that may be.

Each joint of the path has six small motions of its placement in its parent link, in its own frame with z along its
axis: three shifts [m], two tilts [rad], and its zero ([rad], or [m] for one that slides); and the ratio of its gear.
Before the base and behind the tip there are six more each. A turn about z and a shift along the axis that the joint
itself makes are its zero, so they are not counted twice.

    T(x, q) = B(x) · Π_k [P_k E_k(x) Z_k(r_k(x) · v_k(q) + o_k(x))] · tool · F(x)

with E, B and F products Tx Ty Tz Rx Ry Rz in that order, which makes every derivative a twist without series. A joint
that is met from its child's side has E after its turn, inverted, so that E is always where the file has the joint's
origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.kernels.joint_path import homogeneous
from nao_kin.robot.path import walk

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["MOTIONS", "Model", "ModelJoint", "NumberName", "model_of", "nominal", "placed_by", "small_motion"]

MOTIONS: Final = ("x", "y", "z", "rx", "ry", "rz")
"""The small motions of a placement, in the order in which they are made: shifts [m], then turns [rad]."""

NumberName = tuple[str, str]
"""Whose number it is (a joint, ``"base"`` or ``"tool"``), and which (one of `MOTIONS`, ``"zero"`` or ``"ratio"``)."""


@dataclass(frozen=True, eq=False, slots=True)
class ModelJoint:
    """One physical joint on the way to the tip.

    Attributes:
        name: Its name in the file.
        slides: Whether it slides.
        before: Fixed transform from the previous joint's frame, own axis turned to z (4, 4).
        column: The column of q that moves it.
        multiplier: Its factor.
        offset: Its constant part [rad or m].
        upward: Whether it is met from its child's side, so that its own small motions come after its turn.
    """

    name: str
    slides: bool
    before: Floats
    column: int
    multiplier: float
    offset: float
    upward: bool


@dataclass(frozen=True, eq=False)
class Model:
    """A chain with all its numbers by name.

    Attributes:
        chain: The nominal chain.
        joints: Its physical joints, base to tip.
        tool: Fixed transform from the last joint's frame to the tip (4, 4).
        aligned: The turns (m, 3, 3) from each joint's frame in the file to the one with the axis along z.
        tool_name: Whose numbers those of the tool are: ``"tool"``, or of one tip among several.
    """

    chain: UrdfChain
    joints: tuple[ModelJoint, ...]
    tool: Floats
    aligned: Floats
    tool_name: str

    @property
    def names(self) -> tuple[NumberName, ...]:
        """Every number there is: of the base, of each joint, of the tool."""
        return (
            *(("base", motion) for motion in MOTIONS),
            *((joint.name, number) for joint in self.joints for number in numbers_of(joint)),
            *((self.tool_name, motion) for motion in MOTIONS),
        )

    @cached_property
    def every(self) -> frozenset[NumberName]:
        """The same as a set."""
        return frozenset(self.names)

    def poses(self, value: Mapping[NumberName, float], Q: Floats) -> Floats:
        """Poses (N, 4, 4) of the tip in the world for the values of all `names` and joints Q (N, n)."""
        return self._walked(value, Q, None)[0]

    def derivatives(
        self, value: Mapping[NumberName, float], Q: Floats, wanted: Sequence[NumberName]
    ) -> tuple[Floats, Floats]:
        """Poses (N, 4, 4), and the twists (N, 6, p) of the tip that the wanted numbers make.

        A twist is the velocity of the tip's origin and the angular velocity, both in world axes.
        """
        T, made = self._walked(value, Q, set(wanted))
        twists = np.zeros((len(Q), 6, len(wanted)))
        for place, name in enumerate(wanted):
            for frame, kind, factor in made.get(name, ()):
                twists[:, :, place] += _twist(frame, kind, T) * np.reshape(factor, (-1, 1))
        return T, twists

    def _walked(
        self, value: Mapping[NumberName, float], Q: Floats, wanted: set[NumberName] | None
    ) -> tuple[Floats, dict[NumberName, list[tuple[Floats, str, Floats | float]]]]:
        """Poses of the tip, and for every wanted number the frames in which it moves what comes after."""
        made: dict[NumberName, list[tuple[Floats, str, Floats | float]]] = {}

        def note(name: NumberName, frame: Floats, kind: str, factor: Floats | float = 1.0) -> None:
            if wanted is not None and name in wanted:
                made.setdefault(name, []).append((frame, kind, factor))

        T = np.broadcast_to(np.eye(4), (len(Q), 4, 4))

        def moved(T: Floats, owner: str, motions: Sequence[str], inverse: bool) -> Floats:
            for motion in reversed(motions) if inverse else motions:
                amount = value[owner, motion]
                if inverse:
                    T = T @ small_motion(motion, -amount)
                    note((owner, motion), T, motion, -1.0)
                else:
                    note((owner, motion), T, motion)
                    T = T @ small_motion(motion, amount)
            return T

        T = moved(T, "base", MOTIONS, inverse=False)
        for joint in self.joints:
            motions, kind = placed_by(joint), "z" if joint.slides else "rz"
            T = T @ joint.before
            if not joint.upward:
                T = moved(T, joint.name, motions, inverse=False)
            driven = joint.multiplier * Q[:, joint.column] + joint.offset
            note((joint.name, "zero"), T, kind)
            note((joint.name, "ratio"), T, kind, driven)
            T = T @ _joint_motion(value[joint.name, "ratio"] * driven + value[joint.name, "zero"], joint.slides)
            if joint.upward:
                T = moved(T, joint.name, motions, inverse=True)
        T = moved(T @ self.tool, self.tool_name, MOTIONS, inverse=False)
        return T, made


def numbers_of(joint: ModelJoint) -> tuple[str, ...]:
    """The numbers of a joint: its placement's, its zero, its ratio."""
    return (*placed_by(joint), "zero", "ratio")


def placed_by(joint: ModelJoint) -> tuple[str, ...]:
    """The small motions of a joint's placement; what the joint itself does is its zero."""
    return tuple(motion for motion in MOTIONS if motion != ("z" if joint.slides else "rz"))


def nominal(name: NumberName) -> float:
    """A number of the nominal chain: ratios are 1, all others 0."""
    return 1.0 if name[1] == "ratio" else 0.0


def model_of(chain: UrdfChain, tool_name: str = "tool") -> Model:
    """The model of a chain of a robot."""
    up, _ = chain.robot.path(chain.base, chain.tip)
    upward = {joint.name for joint in up}
    steps, _ = walk(chain.robot, chain.base, chain.tip)
    path, undo = chain.joint_path, np.eye(3)
    joints, aligned = [], []
    for k, step in enumerate(steps):
        before = homogeneous(path.rotations[k], path.translations[k])
        # The flat form turns each joint's frame so that its axis is z: this is that turn.
        align = (undo @ step.placement.rotation).T @ path.rotations[k]
        joints.append(
            ModelJoint(
                step.joint.name,
                step.joint.kind == "prismatic",
                before,
                step.column,
                step.coupling.multiplier,
                step.coupling.offset,
                step.joint.name in upward,
            )
        )
        aligned.append(align)
        undo = align.T
    tool = homogeneous(path.tool_rotation, path.tool_translation)
    return Model(chain, tuple(joints), tool, np.array(aligned), tool_name)


def small_motion(motion: str, amount: float) -> Floats:
    """One of `MOTIONS` by an amount [m or rad], (4, 4)."""
    T = np.eye(4)
    axis = "xyz".index(motion[-1])
    if len(motion) == 1:
        T[axis, 3] = amount
    else:
        i, j = (axis + 1) % 3, (axis + 2) % 3
        c, s = np.cos(amount), np.sin(amount)
        T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
    return T


def _twist(frame: Floats, motion: str, T_tip: Floats) -> Floats:
    """Twists (N, 6) of the tip's origin, world axes, where a frame (N, 4, 4) makes a motion at unit speed."""
    axis = frame[:, :3, "xyz".index(motion[-1])]
    twist = np.zeros((len(T_tip), 6))
    if len(motion) == 1:
        twist[:, :3] = axis
    else:
        twist[:, :3] = np.cross(axis, T_tip[:, :3, 3] - frame[:, :3, 3])
        twist[:, 3:] = axis
    return twist


def _joint_motion(values: Floats, slides: bool) -> Floats:
    """Turns about z, or shifts along it, by values (N,): (N, 4, 4)."""
    T: Floats = np.tile(np.eye(4), (len(values), 1, 1))
    if slides:
        T[:, 2, 3] = values
    else:
        T[:, 0, 0] = T[:, 1, 1] = np.cos(values)
        T[:, 1, 0] = np.sin(values)
        T[:, 0, 1] = -T[:, 1, 0]
    return T
