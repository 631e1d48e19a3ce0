"""The least squares: residuals of all rows by all unknowns, the part of these that the rows can tell, and its solution.

Unknowns are the chosen numbers of the robot, placements that a kind of measurement leaves open, and what is unknown
beside the robot. The directions in which nothing that was measured changes are left where the nominal robot has them,
and handed on: `identifiability` says them in words.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.calibration.chain_model import MOTIONS, NumberName
from nao_kin.calibration.parameters import nominal_values

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.calibration.chain_model import Model
    from nao_kin.calibration.measurements import Block, SeenRows

__all__ = ["Fit", "System", "solved", "system_of"]

_RANK: Final = 1e-9
"""A singular value below this part of the largest, columns having unit length, is one that the rows do not see."""

_STEPS: Final = 60


@dataclass(frozen=True, eq=False)
class System:
    """Rows and unknowns of one fit.

    Attributes:
        models: The chains by tip; a chain alone is under None.
        blocks: The rows.
        names: The numbers of the robot that are unknown: those to be calibrated, then placements left open.
        wanted: How many of them are to be calibrated; they come first.
        values: The values of all other numbers, and where the unknown ones start.
        priors: Standard deviations (p,) of the unknown numbers about their nominal values; inf for none.
    """

    models: Mapping[str | None, Model]
    blocks: tuple[Block, ...]
    names: tuple[NumberName, ...]
    wanted: int
    values: Mapping[NumberName, float]
    priors: Floats

    @property
    def start(self) -> Floats:
        """First values of all unknowns (u,)."""
        numbers = [self.values[name] for name in self.names]
        return np.concatenate([numbers, *(block.start(self._poses(block, self.values)) for block in self.blocks)])

    def valued(self, u: Floats) -> dict[NumberName, float]:
        """All numbers of the robot at unknowns u (u,)."""
        return {**self.values, **dict(zip(self.names, u[: len(self.names)].tolist(), strict=True))}

    def own(self, u: Floats) -> list[Floats]:
        """The unknowns of each block's own."""
        ends = len(self.names) + np.cumsum([0, *(len(block.unknown_names) for block in self.blocks)])
        return [u[a:b] for a, b in itertools.pairwise(ends.tolist())]

    def residuals(self, u: Floats) -> Floats:
        """All residuals in units of their noise (r,)."""
        values = self.valued(u)
        parts = [
            block.seen(self._poses(block, values), y).residuals.ravel()
            for block, y in zip(self.blocks, self.own(u), strict=True)
        ]
        return np.concatenate([*parts, self._prior(u)])

    def jacobian(self, u: Floats) -> Floats:
        """Their derivatives (r, u)."""
        values, p, column = self.valued(u), len(self.names), len(self.names)
        parts = []
        for block, y in zip(self.blocks, self.own(u), strict=True):
            model = self.models[block.tip]
            ours = [k for k, name in enumerate(self.names) if name in model.every]
            T, twists = model.derivatives(values, block.Q, [self.names[k] for k in ours])
            seen = block.seen(T, y)
            J = np.zeros((*seen.residuals.shape, len(u)))
            for index, D in seen.terms:
                J[: len(index), :, ours] += D @ twists[index]
            J[:, :, column : column + len(y)] = seen.unknown
            column += len(y)
            parts.append(J.reshape(-1, len(u)))
        kept = np.isfinite(self.priors)
        prior = np.zeros((int(kept.sum()), len(u)))
        prior[np.arange(len(prior)), np.flatnonzero(kept)] = 1.0 / self.priors[kept]
        return np.concatenate([*parts, prior]) if p or parts else np.zeros((0, len(u)))

    def distances(self, u: Floats) -> list[Floats]:
        """How far off each row of each block is, in the block's unit."""
        values = self.valued(u)
        return [b.distances(self._poses(b, values), y) for b, y in zip(self.blocks, self.own(u), strict=True)]

    def seen(self, u: Floats) -> list[SeenRows]:
        """The blocks' residuals and derivatives."""
        values = self.valued(u)
        return [b.seen(self._poses(b, values), y) for b, y in zip(self.blocks, self.own(u), strict=True)]

    def _prior(self, u: Floats) -> Floats:
        kept = np.isfinite(self.priors)
        start = np.array([self.values[name] for name in self.names])
        found: Floats = ((u[: len(self.names)] - start) / self.priors)[kept]
        return found

    def _poses(self, block: Block, values: Mapping[NumberName, float]) -> Floats:
        return self.models[block.tip].poses(values, block.Q)


@dataclass(frozen=True, eq=False)
class Fit:
    """A solution.

    Attributes:
        system: What was solved.
        u: All unknowns (u,).
        seen: Orthonormal directions (u, rank) that the rows tell, columns scaled by `scale`.
        unseen: Those they do not tell (u, u − rank), scaled likewise.
        scale: Lengths of the Jacobian's columns (u,).
        covariance: Of the unknowns (u, u), for residuals of unit noise, in the directions that are seen.
        residuals: In units of their noise (r,).
    """

    system: System
    u: Floats
    seen: Floats
    unseen: Floats
    scale: Floats
    covariance: Floats
    residuals: Floats

    @property
    def rank(self) -> int:
        """How many directions the rows tell."""
        return int(self.seen.shape[1])

    @property
    def freedom(self) -> int:
        """Residuals beyond the unknowns that they determine."""
        return len(self.residuals) - self.rank

    @property
    def values(self) -> dict[NumberName, float]:
        """All numbers of the robot."""
        return self.system.valued(self.u)


def system_of(
    models: Mapping[str | None, Model],
    blocks: Sequence[Block],
    wanted: Sequence[NumberName],
    priors: Mapping[NumberName, float] | None = None,
    values: Mapping[NumberName, float] | None = None,
) -> System:
    """The rows and unknowns of calibrating some numbers; placements that a block leaves open are added."""
    opened = dict[NumberName, None]()
    for block in blocks:
        owners = {"base": "base", "tool": models[block.tip].tool_name}
        opened.update({(owners[freed], motion): None for freed in sorted(block.frees) for motion in MOTIONS})
    names = (*wanted, *(name for name in opened if name not in wanted))
    given = np.array([(priors or {}).get(name, np.inf) for name in names], dtype=np.float64)
    return System(models, tuple(blocks), names, len(wanted), values or nominal_values(models.values()), given)


def solved(system: System, start: Floats | None = None, *, robust: bool = False) -> Fit:
    """The solution nearest to the start: of the unknowns, what the rows do not tell stays there.

    With `robust`, rows far off pull with a force that no longer grows (the loss 2 (√(1 + z) − 1)).
    """
    from scipy.optimize import least_squares

    u = system.start if start is None else start.copy()
    seen, _, scale, _ = _told_apart(system.jacobian(u))
    for _ in range(2):  # what is told at the start may be less than at the end
        Z, origin = seen / scale[:, None], u

        def moved(y: Floats, Z: Floats = Z, origin: Floats = origin) -> Floats:
            return origin + Z @ y

        found = least_squares(
            lambda y: system.residuals(moved(y)),
            np.zeros(Z.shape[1]),
            jac=lambda y, Z=Z: system.jacobian(moved(y)) @ Z,
            loss="soft_l1" if robust else "linear",
            method="trf",
            x_scale="jac",
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            max_nfev=_STEPS,
        )
        u = moved(found.x)
        rank = seen.shape[1]
        seen, unseen, scale, values = _told_apart(system.jacobian(u))
        if seen.shape[1] <= rank:
            break
    inverse = seen / values[: seen.shape[1]] / scale[:, None]
    return Fit(system, u, seen, unseen, scale, inverse @ inverse.T, system.residuals(u))


def _told_apart(J: Floats) -> tuple[Floats, Floats, Floats, NDArray[np.float64]]:
    """Directions that a Jacobian tells and does not, its columns scaled to one length, and the singular values."""
    length = np.linalg.norm(J, axis=0)
    scale = np.where(length > 0.0, length, 1.0)
    _, values, Vt = np.linalg.svd(J / scale, full_matrices=True)
    rank = int((values > _RANK * max(float(values[0]) if len(values) else 0.0, 1e-300)).sum())
    return Vt[:rank].T, Vt[rank:].T, scale, values
