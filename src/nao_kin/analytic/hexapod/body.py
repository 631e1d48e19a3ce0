"""Body inverse kinematics of legged machines: a pose of the body, feet that stay put, all joints of all legs.

Each leg is solved in closed form (`nao_kin.analytic.hexapod.hexapod_leg`) and every foot is measured again by the leg's
own forward kinematics. A body pose that some leg cannot follow is no error: the result names the leg and how much it
misses by.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NoReturn, TypeAlias

import numpy as np

from nao_kin.analytic.form import Mismatch
from nao_kin.analytic.hexapod.hexapod_leg import LABELS, recognise
from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.arrays import rows as float_rows
from nao_kin.arrays import vector
from nao_kin.chain import outside_limits
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik.auditing import Claimed, audit, audited
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.target import Target
from nao_kin.se3 import ROTATION_TOLERANCE, PoseLike, as_pose
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain, OutsideLimit

__all__ = ["BodyBatchResult", "BodyResult", "FeetLike", "MissedFoot", "body_ik", "body_ik_batch"]

FeetLike: TypeAlias = "Mapping[str, ArrayLike] | ArrayLike"


@dataclass(frozen=True, slots=True)
class MissedFoot:
    """A leg that does not bring its foot where it is wanted.

    Attributes:
        leg: Its name.
        reason: ``"too far"``, ``"too near"``, or ``"limits"`` where it reaches the point, but not within its limits.
        misses_by: Distance of the point from all that the leg reaches, whatever its limits [m]; 0 for ``"limits"``.
        outside: The joints that would be outside their ranges.
    """

    leg: str
    reason: Literal["too far", "too near", "limits"]
    misses_by: float
    outside: tuple[OutsideLimit, ...] = ()

    def __str__(self) -> str:
        if self.reason == "limits":
            return f"Leg {self.leg} reaches its foot only beyond its limits: {'; '.join(map(str, self.outside))}"
        return f"Leg {self.leg} cannot reach its foot, which is {self.misses_by:.3g} m {self.reason}"


@dataclass(frozen=True, eq=False, slots=True)
class BodyResult:
    """The joints of all legs for one pose of the body.

    Attributes:
        results: Each leg's own result, measured; in the order of the legs.
        missed: The legs that miss their feet, in that order.
    """

    results: Mapping[str, IKResult]
    missed: tuple[MissedFoot, ...]

    @property
    def solved(self) -> bool:
        """Whether every foot is where it is wanted, measured, with every joint within its limits."""
        return all(result.solved for result in self.results.values())

    @property
    def posture(self) -> dict[str, float]:
        """All joints by name [rad]."""
        return {name: value for result in self.results.values() for name, value in result.posture.items()}

    @property
    def message(self) -> str:
        """For people: the largest error, or the legs that miss."""
        if self.missed:
            return "; ".join(map(str, self.missed)) + "."
        worst = max(result.position_error or 0.0 for result in self.results.values())
        return f"All {len(self.results)} feet are where they are wanted, to {worst:.3g} m."

    def __bool__(self) -> NoReturn:
        raise TypeError("A BodyResult is not a truth value: ask for result.solved.")

    def __repr__(self) -> str:
        return f"<BodyResult: {self.message}>"


@dataclass(frozen=True, eq=False, slots=True)
class BodyBatchResult:
    """The joints of all L legs for N poses of the body, every foot measured again.

    Attributes:
        legs: Names of the legs.
        joint_names: Names of the columns of `q`, leg by leg.
        q: Joints (N, n) [rad]; the best found where a foot is missed.
        solved: Whether each foot is reached within limits (N, L).
        misses_by: Distance of each foot from all that its leg reaches, whatever its limits [m] (N, L); above 0 it is
            too far, below too near, 0 where it is reached.
        position_error: Distance of each foot from where it is wanted [m] (N, L), measured at `q`.
    """

    legs: tuple[str, ...]
    joint_names: tuple[str, ...]
    q: Floats
    solved: NDArray[np.bool_]
    misses_by: Floats
    position_error: Floats

    def __len__(self) -> int:
        return len(self.q)

    def __bool__(self) -> NoReturn:
        raise TypeError("A BodyBatchResult is not a truth value: ask for result.solved.all().")


def body_ik(
    legs: Mapping[str, Chain],
    T_ground_body: PoseLike,
    feet: FeetLike,
    *,
    near: Mapping[str, float] | None = None,
    tolerances: Tolerances = TOLERANCES,
) -> BodyResult:
    """Joints of all legs that hold the feet on the ground while the body takes a pose.

    Of a leg's solutions within its limits it takes the one nearest to `near`, by the largest move of a joint; without
    `near` the first in the order of `nao_kin.analytic.hexapod.hexapod_leg.LABELS`: pointing at its foot, knee up. Where
    none is within the limits, the one that is least outside; where the foot is out of reach, the one that comes
    nearest, moved into the limits.

    Args:
        legs: The legs by name, chains of three joints from the body to the foot.
        T_ground_body: The wanted pose of the body, the legs' base frame, in the ground's frame.
        feet: Where the feet stand, by leg or as rows in the order of the legs (L, 3) [m], in the ground's frame.
        near: Joints by name [rad] to stay near to; those not named count as 0.
        tolerances: When a foot counts as reached.

    Raises:
        InvalidInputError: Not a pose, a foot missing, numbers that are not finite, or a leg without this closed form.
        UnknownNameError: A foot or a joint of no leg; carries near matches.
    """
    T = as_pose(T_ground_body, "T_ground_body")
    points = _feet(legs, feet)
    starts, results, missed = _starts(legs, near), {}, []
    for (name, chain), point in zip(legs.items(), points, strict=True):
        p_body = T.actInv(point)
        found = _solved(chain, _parameters(name, chain), p_body[None, :], starts[name], tolerances)
        run = Run(found.q[0].copy(), Status.SOLVED, branch=LABELS[found.label[0]] if found.label[0] >= 0 else "")
        if found.misses_by[0]:
            run.ended, run.misses_by = Status.OUT_OF_REACH, abs(float(found.misses_by[0]))
        result = results[name] = judge(Problem(chain, Target.position(p_body), tolerances), run)
        if not result.solved:
            missed.append(_missed(name, float(found.misses_by[0]), result))
    return BodyResult(results, tuple(missed))


def body_ik_batch(
    legs: Mapping[str, Chain],
    T_ground_body: ArrayLike | Sequence[PoseLike],
    feet: FeetLike,
    *,
    near: Mapping[str, float] | None = None,
    tolerances: Tolerances = TOLERANCES,
    seed: int = 0,
) -> BodyBatchResult:
    """`body_ik` for many poses of the body (N, 4, 4), on all cores.

    Every foot is measured by a second compiled forward kinematics, and a seeded sample of poses by the chains too.
    Feet that move, as those of a walking machine, are given as an array with a set of feet for each pose (N, L, 3).

    Raises:
        InvalidInputError: As `body_ik`; the row is named.
        UnknownNameError: As `body_ik`.
        AuditError: Two forward kinematics disagree: a defect of this package or of the machine.
    """
    from nao_kin.kernels.audit import tips

    R, t = _poses(T_ground_body)
    points, starts, parts = _moving_feet(legs, feet, len(t)), _starts(legs, near), []
    rng = np.random.default_rng(seed)
    for (name, chain), point in zip(legs.items(), points, strict=True):
        p_body = np.einsum("nji,nj->ni", R, point - t)
        found = _solved(chain, _parameters(name, chain), p_body, starts[name], tolerances)
        error = np.linalg.norm(tips(chain.joint_path, found.q)[:, :3, 3] - p_body, axis=1)
        _audit(chain, found.q, p_body, error, rng)
        solved = (error <= tolerances.position) & found.inside
        parts.append((found.q, solved, np.where(error <= tolerances.position, 0.0, found.misses_by), error))
    q, solved, missed, errors = zip(*parts, strict=True)
    names = tuple(joint for chain in legs.values() for joint in chain.joint_names)
    columns = [np.column_stack(part) for part in (q, solved, missed, errors)]
    return BodyBatchResult(tuple(legs), names, *columns)


@dataclass(frozen=True, eq=False, slots=True)
class _Found:
    """One leg for N feet: joints (N, 3), label numbers (N,) or −1, whether within limits (N,), misses (N,) [m]."""

    q: Floats
    label: NDArray[np.int64]
    inside: NDArray[np.bool_]
    misses_by: Floats


def _solved(chain: Chain, parameters: Floats, p_body: Floats, start: Floats | None, tolerances: Tolerances) -> _Found:
    from nao_kin.analytic.hexapod.hexapod_leg import misses_by_many

    found, exists = _branches(chain, parameters, p_body, 0.0)
    Q, label = found[:, :, :3], found[:, :, 3]
    excess = np.maximum(np.maximum(chain.lower - Q, Q - chain.upper), 0.0).max(axis=2)
    inside = exists & (excess <= tolerances.limits)
    cost = label if start is None else np.abs(np.remainder(Q - start + np.pi, 2.0 * np.pi) - np.pi).max(axis=2)
    # A solution within limits costs less than any outside, and that less than none.
    best = np.where(inside, cost, np.where(exists, 100.0 + excess, np.inf)).argmin(axis=1)
    every = np.arange(len(p_body))
    q, missed = Q[every, best].copy(), np.zeros(len(p_body))
    lost = np.flatnonzero(~exists.any(axis=1))
    q[lost] = _nearest(chain, parameters, p_body[lost])
    misses_by_many(parameters, _goals(p_body), missed)
    missed[exists.any(axis=1)] = 0.0
    chosen = np.where(exists.any(axis=1), label[every, best], -1.0).astype(np.int64)
    return _Found(q, chosen, inside[every, best] | ~exists.any(axis=1), missed)


def _nearest(chain: Chain, parameters: Floats, p_body: Floats) -> Floats:
    """Joints within limits (N, 3) that come near feet out of reach: the leg stretched or folded towards them."""
    from nao_kin.kernels.audit import tips

    found, exists = _branches(chain, parameters, p_body, np.inf)
    Q = np.clip(found[:, :, :3], chain.lower, chain.upper)
    reached = tips(chain.joint_path, np.ascontiguousarray(Q.reshape(-1, 3)))[:, :3, 3].reshape(*Q.shape)
    distance = np.where(exists, np.linalg.norm(reached - p_body[:, None], axis=2), np.inf)
    nearest: Floats = Q[np.arange(len(Q)), distance.argmin(axis=1)]
    return nearest


def _branches(chain: Chain, parameters: Floats, p_body: Floats, slack: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Rows of the kernel (N, 4, 5), each joint in the winding nearest to the middle of its range, and which exist."""
    from nao_kin.analytic.hexapod.hexapod_leg import BRANCHES, solve_many

    found, counts = np.zeros((len(p_body), BRANCHES, 5)), np.zeros(len(p_body), dtype=np.int64)
    solve_many(parameters, 1, _goals(p_body), np.zeros((1, 0)), slack, found, counts)
    middle, _ = middles_and_halves(chain.lower, chain.upper)
    found[:, :, :3] += 2.0 * np.pi * np.round((middle - found[:, :, :3]) / (2.0 * np.pi))
    return found, np.arange(BRANCHES) < counts[:, None]


def _goals(points: Floats) -> Floats:
    goals = np.tile(np.eye(4), (len(points), 1, 1))
    goals[:, :3, 3] = points
    return goals


def _missed(leg: str, miss: float, result: IKResult) -> MissedFoot:
    outside = outside_limits(result.problem.chain, result.q, result.problem.tolerances.limits)
    if not miss:
        return MissedFoot(leg, "limits", 0.0, outside)
    return MissedFoot(leg, "too far" if miss > 0.0 else "too near", abs(miss), outside)


_PARAMETERS: weakref.WeakKeyDictionary[Chain, Floats] = weakref.WeakKeyDictionary()


def _parameters(name: str, chain: Chain) -> Floats:
    if chain not in _PARAMETERS:
        geometry = recognise(chain.joint_path)
        if isinstance(geometry, Mismatch):
            expected = "a coxa, and femur and tibia axes parallel to each other across it"
            raise InvalidInputError(f"leg {name}", expected, f"{chain.name}: {geometry.reason}")
        _PARAMETERS[chain] = geometry.parameters
    return _PARAMETERS[chain]


def _feet(legs: Mapping[str, Chain], feet: FeetLike) -> Floats:
    """The foot of each leg (L, 3), in their order."""
    if not legs:
        raise InvalidInputError("legs", "at least one leg", "none")
    if len(bases := {chain.base_name for chain in legs.values()}) > 1:
        raise InvalidInputError("legs", "legs of one body", f"the bases {', '.join(sorted(bases))}")
    if isinstance(feet, Mapping):
        for name in feet:
            if name not in legs:
                raise UnknownNameError("leg", name, legs, "feet")
        if absent := [name for name in legs if name not in feet]:
            raise InvalidInputError("feet", "a foot for each leg", f"none for {', '.join(absent)}")
        return np.array([vector(feet[name], f"foot of {name}", 3) for name in legs])
    points = float_rows(feet, "feet", 3)
    if len(points) != len(legs):
        raise InvalidInputError("feet", f"{len(legs)} rows, one a leg", f"{len(points)}")
    return points


def _moving_feet(legs: Mapping[str, Chain], feet: FeetLike, count: int) -> Floats:
    """The feet leg by leg: (L, 1, 3) where they stay, (L, count, 3) where there is a set for each pose."""
    if getattr(feet, "ndim", 2) != 3:
        return _feet(legs, feet)[:, None]
    points = np.asarray(feet)
    if points.shape != (count, len(legs), 3):
        raise InvalidInputError("feet", f"an array of shape {(count, len(legs), 3)}", f"shape {points.shape}")
    _feet(legs, points[0] if count else np.zeros((len(legs), 3)))  # which checks the legs
    return float_rows(points.reshape(-1, 3), "feet", 3).reshape(points.shape).swapaxes(0, 1)


def _starts(legs: Mapping[str, Chain], near: Mapping[str, float] | None) -> Mapping[str, Floats | None]:
    if near is None:
        return dict.fromkeys(legs)
    known = [joint for chain in legs.values() for joint in chain.joint_names]
    for joint in near:
        if joint not in known:
            raise UnknownNameError("joint", joint, known, "near")
    return {
        name: vector([near.get(joint, 0.0) for joint in chain.joint_names], f"near, leg {name}", len(chain.joints))
        for name, chain in legs.items()
    }


def _poses(T_ground_body: ArrayLike | Sequence[PoseLike]) -> tuple[Floats, Floats]:
    """Rotations (N, 3, 3) and translations (N, 3) of poses."""
    given = T_ground_body
    if isinstance(given, Sequence):
        given = np.array([as_pose(T, f"T_ground_body, row {i}").homogeneous for i, T in enumerate(given)])
    T = np.asarray(given)
    if T.dtype.kind not in "iuf" or T.ndim != 3 or T.shape[1:] != (4, 4):
        raise InvalidInputError("T_ground_body", "an (N, 4, 4) array", f"shape {T.shape} of type {T.dtype}")
    R = np.array(T[:, :3, :3], dtype=np.float64)
    off = np.abs(np.einsum("nji,njk->nik", R, R) - np.eye(3)).max(axis=(1, 2), initial=0.0)
    bad = ~((off <= ROTATION_TOLERANCE) & (np.linalg.det(R) > 0.0) & np.isfinite(T).all(axis=(1, 2)))
    if bad.any():
        as_pose(T[bad][0], f"T_ground_body, row {int(bad.argmax())}")  # which says it
    return R, np.array(T[:, :3, 3], dtype=np.float64)


def _audit(chain: Chain, q: Floats, points: Floats, error: Floats, rng: np.random.Generator) -> None:
    """Measures some rows by the chain itself, see `nao_kin.ik.auditing`; what counts as in place is asked elsewhere."""
    rows = audited(len(q), rng, everything=False)
    goals = np.tile(np.eye(4), (len(rows), 1, 1))
    goals[:, :3, 3] = points[rows]
    anywhere = Tolerances(position=1e300, rotation=1e300, limits=1e300)
    free, solved = np.full(len(rows), np.nan), np.ones(len(rows), dtype=np.bool_)
    claimed = Claimed(q[rows], goals, error[rows], free, solved)
    audit(chain, Target.position([0.0, 0.0, 0.0]), claimed, rows, anywhere)
