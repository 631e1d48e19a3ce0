"""Solving by any method of the table: those that iterate, and closed forms, which choose among all branches.

Closed forms are imported when they are asked for: who iterates need not wait for them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal, cast, overload

from nao_kin.errors import InvalidInputError
from nao_kin.ik import batch
from nao_kin.ik import single as methods
from nao_kin.ik.reference_loop import require_options
from nao_kin.ik.tips.tree_solver import solve_tree
from nao_kin.robot.tree import Tree
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike

    from nao_kin.chain import Chain
    from nao_kin.ik.batch import BatchResult
    from nao_kin.ik.problem import IKResult
    from nao_kin.ik.reference_loop import Budget
    from nao_kin.ik.single import Engine
    from nao_kin.ik.target import Target, TargetLike
    from nao_kin.ik.tips.tree_problem import TreeResult

__all__ = ["CLOSED", "solve", "solve_batch"]

CLOSED: Final = "closed"
"""Name of the method that iterates nothing."""


@overload
def solve(
    chain: Chain,
    target: TargetLike,
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    engine: Engine = "compiled",
    trace: bool = False,
    parameters: Mapping[str, float] | None = None,
    jump: float | None = None,
) -> IKResult: ...


@overload
def solve(
    chain: Tree,
    target: Mapping[str, TargetLike],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    trace: bool = False,
    parameters: Mapping[str, float] | None = None,
) -> TreeResult: ...


def solve(
    chain: Chain | Tree,
    target: TargetLike | Mapping[str, TargetLike],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    engine: Engine = "compiled",
    trace: bool = False,
    parameters: Mapping[str, float] | None = None,
    jump: float | None = None,
) -> IKResult | TreeResult:
    """Joints that bring the tip to a target, measured again before they are returned.

    Args:
        chain: The chain; or a tree, with targets by tip name, which is `nao_kin.solve_tree` with its usual options.
        target: T_base_target as a `pin.SE3` or (4, 4) matrix, a position (3,) [m] with free orientation, or a `Target`.
        q0: Start, a vector (n,) or a posture of the whole robot (joints not named at 0). Outside the limits it is moved
            inside and the result says so. By default all zeros, moved inside.
        method: A name in `nao_kin.METHODS`. ``"closed"`` takes the branch within limits that is nearest to `q0`, by
            the largest move of a joint.
        tolerances: When the target counts as reached.
        budget: How long to try.
        seed: For the stored starts; the same call gives the same result. A closed form needs none.
        engine: ``"compiled"``, or ``"reference"`` for the same iteration in Python on the chain's own forward
            kinematics and frame Jacobian.
        trace: Keep every iterate in the result.
        parameters: What to tune the method with, by the names in its row of `nao_kin.METHODS`; the others keep their
            defaults.
        jump: Largest move of a joint from the start to the solution [rad or m]; one that needs more is
            `Status.JUMPED`. No limit unless given.

    Returns:
        A result whether solved or not: ask ``result.solved`` and read ``result.status``.

    Raises:
        InvalidInputError: Wrong shape, not finite, a rotation part that is none, or a target the method cannot do; for
            ``"closed"``, no closed form (with the methods that take the target), or an option it has no use for.
        UnknownNameError: No such method or parameter, or the start names a joint that does not exist; carries near
            matches.
    """
    if isinstance(chain, Tree):
        _refuse_for_trees(engine, jump)
        wanted = cast("Mapping[str, TargetLike]", target)
        options: dict[str, Any] = {"budget": budget, "seed": seed, "trace": trace, "parameters": parameters}
        return solve_tree(chain, wanted, q0, method=method, tolerances=tolerances, **options)
    if method == CLOSED:
        from nao_kin.analytic.closed import solve_closed

        _refuse_steps(budget, tolerances, parameters, engine=engine, trace=trace)
        return solve_closed(chain, cast("TargetLike", target), q0, tolerances=tolerances, jump=jump)
    return methods.solve(
        chain,
        target,
        q0,
        method=method,
        tolerances=tolerances,
        budget=budget,
        seed=seed,
        engine=engine,
        trace=trace,
        parameters=parameters,
        jump=jump,
    )


def solve_batch(
    chain: Chain,
    targets: ArrayLike | Sequence[Target],
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    audit: Literal["sample", "all"] = "sample",
    parameters: Mapping[str, float] | None = None,
) -> BatchResult:
    """Solves for many targets on all cores; a row is what `nao_kin.solve` would give, to the last bit.

    The result does not depend on the order of the targets or on the number of threads. Every row is measured again by
    a second compiled forward kinematics, and a seeded sample (``audit="all"``: every row) by `chain.pose` too.

    Args:
        chain: The chain.
        targets: Poses (N, 4, 4), positions (N, 3) [m], or `Target` objects of one kind with the same weights.
        q0: Start of all rows (n,) or a posture, or one start a row (N, n). By default all zeros, moved inside.
        method: A name in `nao_kin.METHODS`; ``"closed"`` takes of each row the branch within limits nearest to its
            start.
        tolerances: When a target counts as reached.
        budget: How long to try for each.
        seed: For the stored starts and the sample.
        audit: ``"sample"`` or ``"all"``.
        parameters: What to tune the method with, see `nao_kin.solve`.

    Returns:
        A row a target, in their order; rows that are not solved hold the nearest joints found.

    Raises:
        InvalidInputError: Wrong shapes, not finite, a rotation part that is none (the row is named), mixed kinds, or
            what the method cannot do.
        UnknownNameError: No such method, parameter, or joint that the start names; carries near matches.
        AuditError: Two forward kinematics disagree: a defect of this package or of the machine.
    """
    options: dict[str, Any] = {"tolerances": tolerances, "seed": seed, "audit": audit}
    if method == CLOSED:
        from nao_kin.analytic.closed import solve_closed_batch

        _refuse_steps(budget, tolerances, parameters)
        return solve_closed_batch(chain, targets, q0, **options)
    return batch.solve_batch(chain, targets, q0, method=method, budget=budget, parameters=parameters, **options)


def _refuse_steps(
    budget: Budget | None,
    tolerances: Tolerances,
    parameters: Mapping[str, float] | None,
    *,
    engine: str = "compiled",
    trace: bool = False,
) -> None:
    """Raises for options that belong to the steps of an iteration."""
    require_options(budget, tolerances)
    given = {"budget": budget, "parameters": parameters, "trace": trace, "engine": engine}
    usual: tuple[Any, ...] = (None, {}, False, "compiled")
    for (name, value), nothing in zip(given.items(), usual, strict=True):
        if value is not None and value != nothing:
            raise InvalidInputError(name, "nothing for method 'closed', which takes no steps", repr(value)[:60])


def _refuse_for_trees(engine: str, jump: float | None) -> None:
    """Raises for the options of `solve` that several tips do not have."""
    if engine != "compiled":
        raise InvalidInputError("engine", "none for several tips, which are solved in Python", repr(engine))
    if jump is not None:
        raise InvalidInputError("jump", "none for several tips; compare result.q with the start", repr(jump))
