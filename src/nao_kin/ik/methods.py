"""The methods by name, and `solve`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.chain import Chain, configuration, neutral
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik import rules
from nao_kin.ik.loop import Budget, run_reference
from nao_kin.ik.problem import IKResult, Problem, judge
from nao_kin.ik.target import Target, TargetKind, TargetLike
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.ik.loop import UpdateRule

__all__ = ["METHODS", "Method", "solve"]


@dataclass(frozen=True, slots=True)
class Method:
    """One row of the table of methods.

    Attributes:
        name: What `solve` takes.
        rule: The update rule.
        targets: Kinds of target it handles.
        reference: Where it comes from.
        choose_it: When to.
    """

    name: str
    rule: UpdateRule
    targets: tuple[TargetKind, ...]
    reference: str
    choose_it: str


METHODS: Final[dict[str, Method]] = {
    method.name: method
    for method in (
        Method(
            name="lm",
            rule=rules.levenberg_marquardt,
            targets=("pose", "position"),
            reference="Chan and Lawrence 1988, error-damped least squares",
            choose_it="by default: quadratic convergence near the target, bounded steps at singularities",
        ),
    )
}


def solve(
    chain: Chain,
    target: TargetLike,
    q0: ArrayLike | Mapping[str, float] | None = None,
    *,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
    budget: Budget | None = None,
    seed: int = 0,
    trace: bool = False,
) -> IKResult:
    """Joints that bring the tip to a target, measured again before they are returned.

    Args:
        chain: The chain.
        target: T_base_target as a `pin.SE3` or (4, 4) matrix, a position (3,) [m] with free orientation, or a `Target`.
        q0: Start, a vector (n,) or a posture of the whole robot (joints not named at 0). Outside the limits it is moved
            inside and the result says so. By default all zeros, moved inside.
        method: A name in `METHODS`.
        tolerances: When the target counts as reached.
        budget: How long to try.
        seed: For the random restarts; the same call gives the same result.
        trace: Keep every iterate in the result.

    Returns:
        A result whether solved or not: ask ``result.solved`` and read ``result.status``.

    Raises:
        InvalidInputError: Wrong shape, not finite, a rotation part that is none, or a target the method cannot do.
        UnknownNameError: No such method, or the start names a joint that does not exist; carries near matches.
    """
    if method not in METHODS:
        raise UnknownNameError("method", method, METHODS)
    chosen, wanted = METHODS[method], Target.of(target)
    if wanted.kind not in chosen.targets:
        expected = f"a {' or '.join(chosen.targets)} target, which is all that method {method!r} handles"
        raise InvalidInputError("target", expected, f"a {wanted.kind} target")
    if not isinstance(seed, int) or seed < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    start = _start(chain, q0)
    problem = Problem(chain, wanted, tolerances)
    run = run_reference(problem, chosen.rule, start, budget or Budget(), np.random.default_rng(seed), trace)
    return judge(problem, run)


def _start(chain: Chain, q0: ArrayLike | Mapping[str, float] | None) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    if q0 is None:
        return neutral(chain)
    if isinstance(q0, Mapping):
        return chain.q_of(q0)
    return configuration(chain, q0)
