"""`solve`: a target, a method of the table, and a result that was measured again."""

from __future__ import annotations

import math
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pinocchio as pin

from nao_kin.arrays import positive
from nao_kin.chain import Chain, configuration, neutral
from nao_kin.errors import InvalidInputError
from nao_kin.ik import compiled_loop as loop
from nao_kin.ik.compiled import ChainTables, run_of, settings_of, solve_goal, tables_of, trace_rows
from nao_kin.ik.methods import METHODS, Method, method_named
from nao_kin.ik.problem import IKResult, Problem, Run, judge
from nao_kin.ik.reference_loop import Budget, Update, require_options, run_reference
from nao_kin.ik.scales import chain_scales
from nao_kin.ik.target import KINDS, Target, TargetLike
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats

__all__ = ["METHODS", "Engine", "Method", "Prepared", "prepared", "solve", "start_of"]

Engine = Literal["compiled", "reference"]


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """What a chain's compiled solves share from call to call.

    Attributes:
        tables: The chain as compiled code reads it.
        settings: What is wanted and how long to try, one array.
        neutral: The default start (n,).
    """

    tables: ChainTables
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
    parameters: Mapping[str, float] | None = None,
    jump: float | None = None,
) -> IKResult:
    """`nao_kin.solve`, which says what the arguments are, on one chain by a method that iterates."""
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
        return judge(problem, _run_in_python(problem, q0, method, budget, seed, trace, engine, parameters, jump))
    ready = prepared(problem, method, budget, seed, parameters)
    start = ready.neutral if q0 is None else start_of(chain, q0)
    allowed = math.inf if jump is None else positive(jump, "jump", "[rad or m]", endless=True)
    outcome, rows = solve_goal(ready.tables, ready.settings, wanted.goal, start), None
    if trace and outcome[loop.CODE] >= 0.0:  # the same again, now that it is known how much there is to keep
        rows = trace_rows(outcome, len(chain.joints))
        outcome = solve_goal(ready.tables, ready.settings, wanted.goal, start, rows)
    try:
        run = run_of(outcome, KINDS[wanted.kind], rows)
    except InvalidInputError:
        Target.of(target)  # says it better, if it is the target that makes no sense
        raise
    if jump is not None:
        run.start, run.jump = start.copy(), allowed  # the caller may go on with theirs
    return judge(problem, run)


def prepared(
    problem: Problem, method: str, budget: Budget | None, seed: int, parameters: Mapping[str, float] | None = None
) -> Prepared:
    """What solves of this kind share, made once for each set of options.

    Raises:
        InvalidInputError: Not a chain, a bad seed or parameter, or a target the method cannot do.
        UnknownNameError: No such method or parameter; carries near matches.
    """
    target, tolerances = problem.target, problem.tolerances
    if type(seed) is not int:
        seed = _integer(seed)
    # The usual options make a key that costs little to compare.
    usual = tolerances is TOLERANCES and budget is None and seed == 0 and not parameters
    options = None if usual else (tolerances, budget, seed, _told_apart(parameters or {}))
    key = (method, target.kind, target.weights, options)
    try:
        return _PREPARED[problem.chain][key]
    except (KeyError, TypeError):
        chosen = _checked(problem, method, seed, budget)
    kept = _PREPARED.setdefault(problem.chain, {})
    if len(kept) >= _KEPT:
        kept.clear()
    tables = tables_of(problem.chain, seed)
    update = _update(problem, chosen, tables, parameters)
    settings = settings_of(
        tables,
        KINDS[target.kind],
        update.rule,
        budget or chosen.budget,
        tolerances,
        weights=target.weights,
        parameters=update.parameters,
        orientation_error=update.orientation_error,
    )
    ready = kept[key] = Prepared(tables, settings, neutral(problem.chain))
    return ready


def _told_apart(parameters: object) -> object:
    """What tells parameters apart that are not yet checked: with their types, as True equals 1.0 and is no number."""
    if not isinstance(parameters, Mapping):
        return parameters
    return tuple((name, type(value), value) for name, value in parameters.items())


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
    problem: Problem,
    q0: Any,
    method: str,
    budget: Budget | None,
    seed: int,
    trace: bool,
    engine: str,
    parameters: Mapping[str, float] | None,
    jump: float | None,
) -> Run:
    if engine != "reference":
        raise InvalidInputError("engine", "'compiled' or 'reference'", repr(engine))
    chosen, chain = _checked(problem, method, seed, budget), problem.chain
    start = neutral(chain) if q0 is None else configuration(chain, start_of(chain, q0))
    update = _update(problem, chosen, tables_of(chain, seed), parameters)
    run = run_reference(problem, update, start, budget or chosen.budget, np.random.default_rng(seed), trace)
    if jump is not None:
        run.start, run.jump = start, positive(jump, "jump", "[rad or m]", endless=True)
    return run


def _update(problem: Problem, method: Method, tables: ChainTables, parameters: Mapping[str, float] | None) -> Update:
    """The method with its parameters, those that depend on the chain from its stored configurations."""
    chain = problem.chain
    scales = chain_scales(chain, problem.target.kind, tables.stored[:, : len(chain.joints)]) if method.scaled else None
    return Update(method.code, method.tuned(parameters or {}, scales), method.orientation_error)


def _checked(problem: Problem, method: str, seed: int, budget: Budget | None) -> Method:
    if not hasattr(problem.chain, "joint_path"):
        expected = "a chain, as robot.chain('left_arm') gives one"
        raise InvalidInputError("chain", expected, f"a {type(problem.chain).__name__}")
    if _integer(seed) < 0:
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    require_options(budget, problem.tolerances)
    chosen = method_named(method)
    refused = chosen.refusal(problem.chain, problem.target)
    if refused is not None:
        raise refused
    return chosen


def _integer(seed: object) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer):
        raise InvalidInputError("seed", "an integer ≥ 0", repr(seed))
    return int(seed)
