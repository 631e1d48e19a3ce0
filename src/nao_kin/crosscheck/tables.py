"""Many DH tables at once, as arrays, and how all of them move: what the search for an explanation runs on.

Both conventions are one product: base · X_0 · Z_1 X_1 … Z_n X_n · tool with Z = Rz(θ) Tz(d) and X = Tx(a) Rx(α). A
modified row k owns X_{k−1}, a standard row X_k; the X that no row owns is the identity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from collections.abc import Iterable

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.dh.dh_row import Convention

__all__ = ["ALPHA", "THETA", "A", "D", "Goal", "Motion", "Tables", "errors_of", "goal_of", "motion"]

A, ALPHA, D, THETA = range(4)
"""Columns of `Tables.numbers`."""

_SHARED = ("slides",)


@dataclass(frozen=True, eq=False, slots=True)
class Tables:
    """M tables of n rows each; nothing is changed in place.

    Attributes:
        numbers: a [m], α [rad], d [m], θ offset [rad] of every row (M, n, 4).
        signs: ±1 of every row (M, n).
        modified: Whether the convention is the modified one (M,).
        base_rotation: Rotation of the base (M, 3, 3).
        base_translation: Translation of the base (M, 3) [m].
        tool_rotation: Rotation of the tool (M, 3, 3).
        tool_translation: Translation of the tool (M, 3) [m], in the axes of the last row's frame.
        slides: Whether joint k slides (n,), of all of them.
    """

    numbers: Floats
    signs: Floats
    modified: Any
    base_rotation: Floats
    base_translation: Floats
    tool_rotation: Floats
    tool_translation: Floats
    slides: Any

    def __len__(self) -> int:
        return len(self.modified)

    @property
    def tool_in_tip_axes(self) -> Floats:
        """Translation of the tool (M, 3) [m] in the axes of the tip, as in Rotation · Translation."""
        t: Floats = np.einsum("mji,mj->mi", self.tool_rotation, self.tool_translation)
        return t

    @classmethod
    def of(cls, table: DHChain) -> Tables:
        """One table as a batch."""
        rows = table.rows
        return cls(
            numbers=np.array([[[row.a, row.alpha, row.d, row.theta] for row in rows]]),
            signs=np.array([[float(row.sign) for row in rows]]),
            modified=np.array([table.convention == "modified"]),
            base_rotation=table.base.rotation[None].copy(),
            base_translation=table.base.translation[None].copy(),
            tool_rotation=table.tool.rotation[None].copy(),
            tool_translation=table.tool.translation[None].copy(),
            slides=np.array([row.kind == "prismatic" for row in rows]),
        )

    def take(self, index: Any) -> Tables:
        """Some of them."""
        picked = {f.name: getattr(self, f.name)[index] for f in fields(self) if f.name not in _SHARED}
        return replace(self, **picked)

    @staticmethod
    def joined(parts: Iterable[Tables]) -> Tables:
        """All of several batches, in order."""
        parts = list(parts)
        names = [f.name for f in fields(Tables) if f.name not in _SHARED]
        return replace(parts[0], **{name: np.concatenate([getattr(p, name) for p in parts]) for name in names})

    def keys(self) -> list[bytes]:
        """For each table, bytes that are the same for tables that are the same up to rounding and full turns."""
        M = len(self)
        angles = self.numbers[:, :, [ALPHA, THETA]]
        flat = [
            self.numbers[:, :, [A, D]].reshape(M, -1),
            np.cos(angles).reshape(M, -1),
            np.sin(angles).reshape(M, -1),
            self.signs,
            self.modified[:, None],
            *(
                part.reshape(M, -1)
                for part in (self.base_rotation, self.base_translation, self.tool_rotation, self.tool_translation)
            ),
        ]
        rounded = np.round(np.concatenate(flat, axis=1), 7) + 0.0  # −0 and 0 are the same
        return [row.tobytes() for row in rounded]

    def chain(self, m: int, like: DHChain) -> DHChain:
        """The m-th table as a chain with the names, limits and speeds of another one."""
        rows = tuple(
            replace(row, a=a, alpha=_tidy(alpha), d=d, theta=_tidy(theta), sign=int(sign))
            for row, (a, alpha, d, theta), sign in zip(
                like.rows, self.numbers[m].tolist(), self.signs[m].tolist(), strict=True
            )
        )
        base, tool = (
            pin.SE3(_proper(self.base_rotation[m]), self.base_translation[m]),
            pin.SE3(_proper(self.tool_rotation[m]), self.tool_translation[m]),
        )
        convention: Convention = "modified" if self.modified[m] else "standard"
        return replace(like, rows=rows, convention=convention, base=base, tool=tool, name=f"{like.name}, corrected")


@dataclass(frozen=True, eq=False, slots=True)
class Motion:
    """How M tables move at S configurations, in the base frame.

    Attributes:
        R: Rotation of the tip (M, S, 3, 3).
        p: Position of the tip (M, S, 3) [m].
        x: For each row, the direction along which its a lies and about which its α turns (M, S, n, 3).
        z: The same for d and θ (M, S, n, 3).
        at_x: For each row, a point on the line of its α (M, S, n, 3) [m].
        at_z: The same for θ (M, S, n, 3) [m].
    """

    R: Floats
    p: Floats
    x: Floats
    z: Floats
    at_x: Floats
    at_z: Floats

    def take(self, index: Any) -> Motion:
        """That of some of the tables."""
        return Motion(*(getattr(self, f.name)[index] for f in fields(self)))


def motion(tables: Tables, Q: Floats) -> Motion:
    """The motion of M tables at configurations (S, n)."""
    M, S, n = len(tables), len(Q), len(tables.slides)
    a, alpha, d, theta = (tables.numbers[:, :, c] for c in (A, ALPHA, D, THETA))
    a_at, alpha_at = _links(a, tables.modified), _links(alpha, tables.modified)
    moved = tables.signs[:, None, :] * Q
    angles = theta[:, None, :] + np.where(tables.slides, 0.0, moved)
    slides = d[:, None, :] + np.where(tables.slides, moved, 0.0)
    ca, sa, ct, st = np.cos(alpha_at), np.sin(alpha_at), np.cos(angles), np.sin(angles)
    R = np.broadcast_to(tables.base_rotation[:, None], (M, S, 3, 3))
    x, y, z = R[..., 0], R[..., 1], R[..., 2]
    p = np.broadcast_to(tables.base_translation[:, None], (M, S, 3))
    xs, at_xs = np.empty((M, S, n + 1, 3)), np.empty((M, S, n + 1, 3))
    zs, at_zs = np.empty((M, S, n, 3)), np.empty((M, S, n, 3))
    for k in range(n + 1):
        xs[:, :, k], at_xs[:, :, k] = x, p
        p = p + a_at[:, k, None, None] * x
        c, s = ca[:, k, None, None], sa[:, k, None, None]
        y, z = c * y + s * z, c * z - s * y
        if k == n:
            break
        zs[:, :, k], at_zs[:, :, k] = z, p
        p = p + slides[:, :, k, None] * z
        c, s = ct[:, :, k, None], st[:, :, k, None]
        x, y = c * x + s * y, c * y - s * x
    last = np.stack([x, y, z], axis=-1)
    tip = p + np.einsum("msij,mj->msi", last, tables.tool_translation)
    pick = np.where(tables.modified[:, None], np.arange(n), np.arange(1, n + 1))[:, None, :, None]
    own = [np.take_along_axis(array, np.broadcast_to(pick, (M, S, n, 3)), axis=2) for array in (xs, at_xs)]
    return Motion(last @ tables.tool_rotation[:, None], tip, own[0], zs, own[1], at_zs)


@dataclass(frozen=True, eq=False, slots=True)
class Goal:
    """What the tables should do: poses of the model at some configurations, and how near is the same.

    Attributes:
        Q: Configurations (S, n).
        R: Rotations of the model's tip (S, 3, 3).
        p: Its positions (S, 3) [m].
        position: How near counts as there [m].
        rotation: How near counts as turned alike [rad].
    """

    Q: Floats
    R: Floats
    p: Floats
    position: float
    rotation: float

    def first(self, count: int) -> Goal:
        """The same on fewer configurations."""
        return replace(self, Q=self.Q[:count], R=self.R[:count], p=self.p[:count])


def goal_of(chain: Chain, samples: int, rng: np.random.Generator, position: float, rotation: float) -> Goal:
    """The chain's own poses at random configurations, limits or not: poses that agree anywhere agree everywhere."""
    slides = np.array([joint.kind == "prismatic" for joint in chain.joints])
    Q = rng.uniform(-1.0, 1.0, (samples, len(slides))) * np.where(slides, 0.3, 2.5)
    poses = np.array([chain.pose(q).homogeneous for q in Q])
    return Goal(Q, poses[:, :3, :3], poses[:, :3, 3], position, rotation)


def errors_of(found: Motion, goal: Goal) -> tuple[Floats, Floats]:
    """Largest distance [m] and angle [rad] from the goal over its configurations, for each of M tables (M,).

    The angle is the chord √2·sin(angle/2)·√2, which is the angle where it is small.
    """
    position = np.linalg.norm(found.p - goal.p, axis=-1).max(axis=1)
    rotation = (np.linalg.norm(found.R - goal.R, axis=(-2, -1)) / math.sqrt(2.0)).max(axis=1)
    return position, rotation


def _links(column: Floats, modified: Any) -> Floats:
    """The numbers of the X factors (M, n + 1) out of a column of rows (M, n)."""
    none = np.zeros((len(column), 1))
    links: Floats = np.where(
        modified[:, None], np.concatenate([column, none], axis=1), np.concatenate([none, column], axis=1)
    )
    return links


def _tidy(angle: float) -> float:
    """The angle within ±π, as people write it."""
    if -math.pi <= angle <= math.pi + 1e-12:
        return angle
    return math.remainder(angle, math.tau)


def _proper(R: Floats) -> Floats:
    """A product of rotations without its rounding."""
    U, _, Vt = np.linalg.svd(R)
    near = np.round(R)
    if np.abs(R - near).max() < 1e-14:
        return near + 0.0
    proper: Floats = U @ Vt
    return proper
