"""The compiled loop as Python calls it: a chain's tables, settings, one target or many, outcomes turned into runs."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.ik import aim
from nao_kin.ik import compiled_loop as loop
from nao_kin.ik.orientation import ROTATION_VECTOR
from nao_kin.ik.problem import STATUSES, Run, Trace
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.rules import LEVENBERG_MARQUARDT
from nao_kin.ik.starts import make_starts
from nao_kin.ik.target import KINDS
from nao_kin.kernels.joint_limits import packed_rules
from nao_kin.kernels.motion import Arm, packed_joints
from nao_kin.se3 import ROTATION_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.reference_loop import Budget
    from nao_kin.tolerances import Tolerances

__all__ = ["KINDS", "ChainTables", "run_of", "settings_of", "solve_goal", "solve_goals", "tables_of", "trace_rows"]

_ROUNDING: Final = 1e-12  # relative; a stretched arm reaches the outer radius up to rounding, and that counts as inside
_SEEDS_KEPT: Final = 16  # who runs through many seeds shall not fill the memory


@dataclass(frozen=True, eq=False, slots=True)
class ChainTables:
    """A chain as the compiled loop reads it; see `nao_kin.ik.compiled_loop.solve_one` for the arrays.

    Attributes:
        joints: Placements and joints (m + 1, 16).
        limits: Least and greatest joint values (2, n).
        coupled: Coupled limits (k, 7).
        stored: Stored starts with their tips (K, n + 12).
        closeness: Weight of squared distances among the stored starts [1/m²].
        shell: Centre of the reach (3), least and greatest distance from it (5,) [m].
        outcome_size: Numbers in an outcome.
        work_size: Numbers of memory that a solve needs, its outcome included.
    """

    joints: Floats
    limits: Floats
    coupled: Floats
    stored: Floats
    closeness: float
    shell: Floats
    outcome_size: int
    work_size: int


_TABLES: weakref.WeakKeyDictionary[Chain, dict[int, ChainTables]] = weakref.WeakKeyDictionary()


def tables_of(chain: Chain, seed: int = 0) -> ChainTables:
    """The tables of a chain, made once a seed; the seed decides the stored starts."""
    try:
        return _TABLES[chain][seed]
    except KeyError:
        of_chain = _TABLES.setdefault(chain, {})
        if len(of_chain) >= _SEEDS_KEPT:
            of_chain.clear()
        tables = of_chain[seed] = _tables(chain, seed)
        return tables


def _tables(chain: Chain, seed: int) -> ChainTables:
    starts, shell = make_starts(chain, np.random.default_rng(seed)), reach_shell(chain)
    joints, size = packed_joints(chain.joint_path), loop.OUTCOME + len(chain.joints)
    limits, coupled = np.array([chain.lower, chain.upper]), packed_rules(chain.limit_rules, chain.joint_names)
    return ChainTables(
        joints=joints,
        limits=limits,
        coupled=coupled,
        stored=starts.table,
        closeness=starts.closeness,
        shell=np.array([*shell.centre, shell.inner * (1.0 - _ROUNDING), shell.outer * (1.0 + _ROUNDING)]),
        outcome_size=size,
        work_size=size + loop.scratch_size(joints, starts.table),
    )


def settings_of(
    tables: ChainTables,
    kind: int,
    rule: int,
    budget: Budget,
    tolerances: Tolerances,
    weights: ArrayLike = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
    from_stored: bool = False,
    parameters: Sequence[float] = (),
    orientation_error: int = ROTATION_VECTOR,
) -> Floats:
    """What is wanted and how long to try, as one array; make it once for many calls.

    Args:
        tables: The chain.
        kind: Kind of target, a value of `KINDS`.
        rule: Code of the update rule, see `nao_kin.ik.rules`.
        budget: How long to try.
        tolerances: When the target counts as reached.
        weights: Weight of each base axis (6,), position x y z, rotation x y z; 0 leaves it free. Other weights than 1
            decide which compromise is found where not all can be met, never what counts as reached.
        from_stored: Start at the stored configuration nearest to the target, and not at q0.
        parameters: Those of the rule, in its order.
        orientation_error: A form of it, see `nao_kin.ik.orientation`.
    """
    settings = np.zeros(loop.SETTINGS)
    settings[loop.KIND], settings[loop.RULE] = kind, rule
    settings[loop.MAX_ITERATIONS], settings[loop.RESTARTS] = budget.iterations, budget.restarts
    settings[loop.PATIENCE], settings[loop.LARGEST_STEP] = budget.patience, budget.largest_step
    settings[loop.FROM_STORED] = from_stored
    settings[loop.POSITION_TOLERANCE], settings[loop.ROTATION_TOLERANCE] = (
        tolerances.position,
        tolerances.rotation,
    )
    settings[loop.GOAL_TOLERANCE] = ROTATION_TOLERANCE
    settings[loop.WEIGHTS : loop.WEIGHTS + 6] = weights
    settings[loop.CENTRE : loop.OUTER + 1] = tables.shell
    settings[loop.CLOSENESS] = tables.closeness
    settings[loop.ORIENTATION_ERROR] = orientation_error
    settings[loop.GAINS : loop.GAINS + len(parameters)] = parameters
    return settings


def trace_rows(outcome: Floats, n: int) -> Floats:
    """Room for the trace of a solve with this outcome: a row (q, position error, rotation error, start) an iterate."""
    return np.empty((int(outcome[loop.ITERATIONS] + outcome[loop.STARTS]), n + 3))


def solve_goal(tables: ChainTables, settings: Floats, goal: Floats, q0: Floats, trace: Floats | None = None) -> Floats:
    """Solves for one target; returns the outcome, see `compiled_loop`. Nothing passed in is changed but `trace`.

    Args:
        tables: The chain.
        settings: From `settings_of`.
        goal: The target (4, 4), C-contiguous float64.
        q0: Start (n,), C-contiguous float64.
        trace: From `trace_rows`, if the iterates are wanted.
    """
    t = tables
    if trace is None:
        work = np.empty(t.work_size)
        memory = _memory(tables, settings)
        loop.solve_quickly(t.joints, t.limits, t.coupled, t.stored, settings, goal, q0, work, memory)
        return work[: t.outcome_size]
    outcome, scratch, memory = np.empty(t.outcome_size), np.empty(t.work_size - t.outcome_size), _memory(t, settings)
    arm = Arm(t.joints, t.limits, t.coupled)
    loop.solve_one(arm, t.stored, settings, goal, q0, outcome, trace, scratch, memory)
    return outcome


def _memory(tables: ChainTables, settings: Floats) -> Floats | None:
    """What methods other than the default need besides."""
    if settings[loop.RULE] == LEVENBERG_MARQUARDT:
        return None
    return np.empty(loop.memory_size(tables.joints, tables.limits.shape[1]))


def solve_goals(tables: ChainTables, settings: Floats, goals: Floats, q0: Floats) -> Floats:
    """Solves for many targets (N, 4, 4) on all cores, from q0 (N, n), or (1, n) for all; outcomes in rows.

    An outcome is the same to the last bit as that of `solve_goal`, whatever the other targets and however many threads.
    """
    t = tables
    outcomes, memory = np.empty((len(goals), t.outcome_size)), _memory(t, settings)
    loop.solve_many(t.joints, t.limits, t.coupled, t.stored, settings, goals, q0, outcomes, memory)
    return outcomes


def run_of(outcome: Floats, kind: int, trace: Floats | None = None) -> Run:
    """An outcome as the judge takes it.

    Args:
        outcome: From `solve_goal`, or a row from `solve_goals`.
        kind: Kind of target, a value of `KINDS`.
        trace: The rows that `solve_goal` filled.

    Raises:
        InvalidInputError: The target or the start made no sense; carries the size of the violation.
    """
    told = outcome.tolist()
    code, iterations, starts = int(told[loop.CODE]), int(told[loop.ITERATIONS]), int(told[loop.STARTS])
    if code < 0:
        raise _refusal(code, told[loop.AMOUNT])
    iterates = None if trace is None else _trace(trace[: iterations + starts], kind)
    moved, amount = told[loop.START_MOVED] != 0.0, told[loop.AMOUNT]
    return Run(outcome[loop.OUTCOME :], STATUSES[code], iterations, starts, moved, amount, "", iterates)


def _refusal(code: int, amount: float) -> InvalidInputError:
    if code == loop.BAD_START:
        return InvalidInputError("q0", "finite numbers", f"another at index {int(amount)}")
    got = f"a violation of {amount:.2g}" if np.isfinite(amount) else "numbers that are not finite"
    return InvalidInputError("target", "a rigid pose, a position, or unit axes", got)


def _trace(rows: Floats, kind: int) -> Trace:
    free = np.full(len(rows), np.nan)
    position = free if kind == aim.ORIENTATION else rows[:, -3].copy()
    rotation = free if kind == aim.POSITION else rows[:, -2].copy()
    return Trace(rows[:, :-3].copy(), position, rotation, rows[:, -1].astype(np.int64))
