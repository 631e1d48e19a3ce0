"""The methods by name, and `solve`."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
import pinocchio as pin

from nao_kin.chain import Chain, configuration, neutral
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik import descent, rules
from nao_kin.ik.compiled import Tables, run_of, settings_of, solve_goal, tables_of, trace_rows
from nao_kin.ik.loop import Budget, run_reference
from nao_kin.ik.problem import IKResult, Problem, Run, judge
from nao_kin.ik.target import KINDS, Target, TargetKind, TargetLike
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.ik.loop import UpdateRule

__all__ = ["METHODS", "Engine", "Method", "Prepared", "prepared", "solve", "start_of"]

Engine = Literal["compiled", "reference"]


@dataclass(frozen=True, slots=True)
class Method:
    """One row of the table of methods.

    Attributes:
        name: What `solve` takes.
        rule: The update rule, called by the reference loop.
        code: The same rule's number in compiled code.
        targets: Kinds of target it handles.
        reference: Where it comes from.
        choose_it: When to.
    """

    name: str
    rule: UpdateRule
    code: int
    targets: tuple[TargetKind, ...]
    reference: str
    choose_it: str


METHODS: Final[dict[str, Method]] = {
    method.name: method
    for method in (
        Method(
            name="lm",
            rule=rules.levenberg_marquardt,
            code=rules.LEVENBERG_MARQUARDT,
            targets=("pose", "position", "pointing", "orientation"),
            reference="Chan and Lawrence 1988, error-damped least squares",
            choose_it="by default: quadratic convergence near the target, bounded steps at singularities",
        ),
    )
}


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """What a chain's compiled solves share from call to call.

    Attributes:
        tables: The chain as compiled code reads it.
        settings: What is wanted and how long to try, one array.
        neutral: The default start (n,).
    """

    tables: Tables
    settings: Floats
    neutral: Floats


_PREPARED: weakref.WeakKeyDictionary[Chain, dict[Any, Prepared]] = weakref.WeakKeyDictionary()
_KEPT = 64  # sets of options a chain; who tries thousands of them shall not fill the memory
_FLOAT64 = np.dtype(np.float64)
_IDENTITY, _PLACE = np.eye(4), (slice(0, 3), 3)


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
        seed: For the stored starts; the same call gives the same result.
        engine: ``"compiled"``, or ``"reference"`` for the same iteration in Python on the chain's own forward
            kinematics and frame Jacobian.
        trace: Keep every iterate in the result.

    Returns:
        A result whether solved or not: ask ``result.solved`` and read ``result.status``.

    Raises:
        InvalidInputError: Wrong shape, not finite, a rotation part that is none, or a target the method cannot do.
        UnknownNameError: No such method, or the start names a joint that does not exist; carries near matches.
    """
    # The usual forms by hand: compiled code checks their numbers in passing, for less than numpy takes.
    if type(target) is np.ndarray and target.dtype is _FLOAT64 and target.shape == (4, 4):
        wanted = Target("pose", target.copy())
    elif type(target) is np.ndarray and target.dtype is _FLOAT64 and target.shape == (3,):
        goal = _IDENTITY.copy()
        goal[_PLACE] = target
        wanted = Target("position", goal)
    elif isinstance(target, pin.SE3):
        wanted = Target("pose", np.array(target.homogeneous, order="C"))
    else:
        wanted = Target.of(target)
    problem = Problem(chain, wanted, tolerances)
    if engine != "compiled":
        problem = Problem(chain, Target.of(target), tolerances)
        return judge(problem, _run_in_python(problem, q0, method, budget, seed, trace, engine))
    ready = prepared(problem, method, budget, seed)
    start = ready.neutral if q0 is None else start_of(chain, q0)
    outcome, rows = solve_goal(ready.tables, ready.settings, wanted.goal, start), None
    if trace and outcome[descent.CODE] >= 0.0:  # the same again, now that it is known how much there is to keep
        rows = trace_rows(outcome, len(chain.joints))
        outcome = solve_goal(ready.tables, ready.settings, wanted.goal, start, rows)
    try:
        return judge(problem, run_of(outcome, KINDS[wanted.kind], rows))
    except InvalidInputError:
        Target.of(target)  # says it better, if it is the target that makes no sense
        raise


def prepared(problem: Problem, method: str, budget: Budget | None, seed: int) -> Prepared:
    """What solves of this kind share, made once for each set of options.

    Raises:
        InvalidInputError: Not a chain, a bad seed, or a target the method cannot do.
        UnknownNameError: No such method; carries near matches.
    """
    target, tolerances = problem.target, problem.tolerances
    if type(seed) is not int:
        seed = _integer(seed)
    # The usual options make a key that costs little to compare.
    usual = tolerances is TOLERANCES and budget is None and seed == 0
    key = (method, target.kind, target.weights, None if usual else (tolerances, budget, seed))
    try:
        return _PREPARED[problem.chain][key]
    except (KeyError, TypeError):
        chosen = _checked(problem, method, seed)
    kept = _PREPARED.setdefault(problem.chain, {})
    if len(kept) >= _KEPT:
        kept.clear()
    tables = tables_of(problem.chain, seed)
    settings = settings_of(
        tables, KINDS[target.kind], chosen.code, budget or Budget(), tolerances, weights=target.weights
    )
    ready = kept[key] = Prepared(tables, settings, neutral(problem.chain))
    return ready


def start_of(chain: Chain, q0: ArrayLike | Mapping[str, float]) -> Floats:
    """A start (n,) from a vector or a posture of the whole robot.

    Raises:
        InvalidInputError: Wrong length, not finite, or contradicting a coupling.
        UnknownNameError: A name is no joint.
    """
    if type(q0) is np.ndarray and q0.dtype is _FLOAT64 and q0.shape == chain.lower.shape and q0.flags.carray:
        return q0  # compiled code neither changes it nor lets a number pass that is not finite
    return chain.q_of(q0) if isinstance(q0, Mapping) else configuration(chain, q0)


def _run_in_python(
    problem: Problem, q0: Any, method: str, budget: Budget | None, seed: int, trace: bool, engine: str
) -> Run:
    if engine != "reference":
        raise InvalidInputError("engine", "'compiled' or 'reference'", repr(engine))
    chosen, chain = _checked(problem, method, seed), problem.chain
    start = neutral(chain) if q0 is None else configuration(chain, start_of(chain, q0))
    return run_reference(problem, chosen.rule, start, budget or Budget(), np.random.default_rng(seed), trace)


def _checked(problem: Problem, method: str, seed: int) -> Method:
    if not hasattr(problem.chain, "joint_path"):
        expected = "a chain, as robot.chain('left_arm') gives one"
        raise InvalidInputError("chain", expected, f"a {type(problem.chain).__name__}")
    if method not in METHODS:
        raise UnknownNameError("method", method, METHODS)
    if _integer(seed) < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    chosen, kind = METHODS[method], problem.target.kind
    if kind not in chosen.targets:
        expected = f"a {' or '.join(chosen.targets)} target, which is all that method {method!r} handles"
        raise InvalidInputError("target", expected, f"a {kind} target")
    return chosen


def _integer(seed: object) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer):
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    return int(seed)
