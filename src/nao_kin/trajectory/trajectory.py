"""Joint values over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.arrays import frozen, rows, vector
from nao_kin.chain import ChainJoint, limit_text, value_unit
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.table import Column, Table

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["Trajectory"]


@dataclass(frozen=True, eq=False, slots=True)
class Trajectory:
    """Joint values at instants, straight in between.

    Limits travel with it and are not enforced by it: a recorded motion may have left them.

    Attributes:
        joints: What moves: names, kinds and limits, one a column.
        times: When, (N,) [s], strictly increasing; read-only.
        q: Joint values, (N, n) [rad or m]; read-only.
        name: What a person calls it; may be empty.
    """

    joints: tuple[ChainJoint, ...]
    times: Floats
    q: Floats
    name: str = ""

    def __init__(self, joints: Iterable[ChainJoint | str], times: ArrayLike, q: ArrayLike, name: str = "") -> None:
        """Checks and copies.

        Args:
            joints: One a column; a bare name stands for a revolute joint without limits.
            times: (N,) [s], at least one.
            q: (N, n) [rad or m].
            name: What a person calls it.

        Raises:
            InvalidInputError: A name occurs twice, a shape does not fit, a value is not finite, or time stands still.
        """
        known = tuple(ChainJoint(joint) if isinstance(joint, str) else joint for joint in joints)
        names = [joint.name for joint in known]
        if len(set(names)) < len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise InvalidInputError("joints", "every name once", f"{twice!r} twice")
        values = rows(q, "q", len(known))
        instants = vector(times, "times", len(values))
        if not len(instants):
            raise InvalidInputError("times", "at least one sample", "none")
        late = np.flatnonzero(np.diff(instants) <= 0.0)
        if len(late):
            before, after = instants[late[0] : late[0] + 2]
            raise InvalidInputError(
                "times", "strictly increasing", f"{after:g} s after {before:g} s at sample {late[0] + 1}"
            )
        for field, value in (("joints", known), ("times", frozen(instants)), ("q", frozen(values)), ("name", name)):
            object.__setattr__(self, field, value)

    def __len__(self) -> int:
        return len(self.times)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, one a column of `q`."""
        return tuple(joint.name for joint in self.joints)

    @property
    def duration(self) -> float:
        """From the first sample to the last [s]."""
        return float(self.times[-1] - self.times[0])

    @property
    def velocities(self) -> Floats:
        """Speed from each sample to the next, (N − 1, n) [rad/s or m/s]: what a straight move between them needs."""
        speeds: Floats = np.diff(self.q, axis=0) / np.diff(self.times)[:, None]
        return speeds

    @property
    def accelerations(self) -> Floats:
        """Change of speed at each sample between two others, (N − 2, n) [rad/s² or m/s²].

        It is spread over half of either step: to be had where the samples lie on a smooth motion.
        """
        steps = np.diff(self.times)
        changes: Floats = 2.0 * np.diff(self.velocities, axis=0) / (steps[:-1] + steps[1:])[:, None]
        return changes

    def at(self, time: float) -> Floats:
        """Joint values (n,) at an instant [s], between samples on the straight line, at both ends held."""
        return np.array([np.interp(time, self.times, column) for column in self.q.T])

    def posture(self, sample: int) -> dict[str, float]:
        """One sample by joint names.

        Raises:
            InvalidInputError: There is no such sample.
        """
        if not -len(self) <= sample < len(self):
            raise InvalidInputError("sample", f"a number below {len(self)}", str(sample))
        return dict(zip(self.joint_names, self.q[sample].tolist(), strict=True))

    def column(self, joint: str) -> Floats:
        """Values of one joint over time, (N,) [rad or m].

        Raises:
            UnknownNameError: It has no such joint.
        """
        if joint not in self.joint_names:
            raise UnknownNameError("joint", joint, self.joint_names, self.name)
        return self.q[:, self.joint_names.index(joint)]

    def table(self) -> Table:
        """One row a joint: where it starts and ends, what it covers, and its greatest speed beside the allowed one."""
        speeds = np.abs(self.velocities).max(axis=0, initial=0.0)
        columns = np.stack([self.q[0], self.q[-1], self.q.min(axis=0), self.q.max(axis=0), speeds], axis=1)
        rows = tuple(
            (joint.name, *(f"{value:.4g}" for value in numbers), limit_text(joint.max_velocity))
            for joint, numbers in zip(self.joints, columns.tolist(), strict=True)
        )
        unit, speed = value_unit(self.joints), value_unit(self.joints, "/s")
        headings = [f"{what} [{unit}]" for what in ("start", "end", "least", "greatest")]
        headings += [f"{what} [{speed}]" for what in ("greatest speed", "allowed")]
        title = f"{self.name or 'Trajectory'}: {len(self)} samples over {self.duration:.4g} s"
        return Table((Column("joint"), *(Column(heading, number=True) for heading in headings)), rows, title=title)

    def __repr__(self) -> str:
        name = f" {self.name}" if self.name else ""
        return f"<Trajectory{name}: {len(self)} samples of {len(self.joints)} joints over {self.duration:.4g} s>"

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()
