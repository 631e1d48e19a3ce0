"""An inverse kinematics problem, the reasons a solver may end for, and the judge that alone may say "solved"."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, NoReturn

import numpy as np

from nao_kin.chain import Chain, OutsideLimit, joint_table, outside_limits
from nao_kin.ik.measure import measure
from nao_kin.ik.target import KINDS
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.ik.target import Target

# Problem, Run and IKResult are made for every solve. They are meant to be read only, but not frozen: freezing costs a
# dataclass as much for each field as a joint's kinematics take.

__all__ = ["STATUSES", "IKResult", "Problem", "Run", "Status", "Trace", "judge", "verdict", "verdicts"]


class Status(enum.Enum):
    """Why a solver ended, as a sentence.

    Attributes:
        number: What arrays and compiled code hold instead: the place of the member.
    """

    number: int

    SOLVED = "The target is reached: the returned joints were measured again and are within tolerance and limits."
    STALLED = "No start came closer any more: a local minimum, a limit, or a target out of reach."
    BUDGET_SPENT = "The iteration budget ran out while the error was still falling."
    OUT_OF_REACH = "The target lies where the lengths of the links keep the tip from ever being."
    OUTSIDE_LIMITS = "The tip is at the target, but a joint is outside its range."
    JUMPED = "The target is reached, but from the start a joint has to move by more than allowed."
    NOT_FINITE = "The iteration left the finite numbers; the last finite joints are returned."
    NO_SOLUTION = "No branch of the closed form reaches the target, whatever the joints' ranges."


STATUSES: Final = tuple(Status)
"""The statuses by their numbers, which arrays and compiled code hold."""

for _number, _status in enumerate(STATUSES):
    _status.number = _number


def _verdict(ended: Status, reached: bool, inside: bool) -> Status:
    """The one rule: what was measured counts; a claim that it does not confirm is a solver that stopped short."""
    if reached and ended is not Status.NOT_FINITE:
        return Status.SOLVED if inside else Status.OUTSIDE_LIMITS
    return Status.STALLED if ended in (Status.SOLVED, Status.OUTSIDE_LIMITS, Status.JUMPED) else ended


# The judge runs after every solve: looked up, the rule takes less time than a joint's arithmetic.
_VERDICTS: Final = tuple(
    tuple(tuple(_verdict(status, reached, inside) for inside in (False, True)) for reached in (False, True))
    for status in Status
)
_NUMBERS: Final = np.array([[[s.number for s in row] for row in pair] for pair in _VERDICTS], dtype=np.int8)
_SOLVED, _JUMPED = Status.SOLVED, Status.JUMPED


def verdict(ended: Status, reached: bool, inside: bool) -> Status:
    """Why a run ended, now that it is measured whether the target is reached and every joint inside its limits."""
    return _VERDICTS[ended.number][reached][inside]


def verdicts(ended: NDArray[Any], reached: NDArray[np.bool_], inside: NDArray[np.bool_]) -> NDArray[np.int8]:
    """`verdict` for rows (N,), statuses as their numbers."""
    return np.asarray(_NUMBERS[ended, reached.astype(np.intp), inside.astype(np.intp)])


@dataclass(eq=False, slots=True)
class Problem:
    """What is wanted of a chain.

    Attributes:
        chain: The chain.
        target: What its tip is to do, in the chain's base frame.
        tolerances: When the target counts as reached.
    """

    chain: Chain
    target: Target
    tolerances: Tolerances = TOLERANCES


@dataclass(frozen=True, eq=False, slots=True)
class Trace:
    """What an iteration went through, one row an iterate.

    Attributes:
        q: Joints (k, n) [rad or m].
        position_error: Position errors (k,) [m]; NaN where the target leaves the position free.
        rotation_error: Rotation errors (k,) [rad]; NaN where the target leaves the orientation free.
        start: Number of the start that the iterate belongs to (k,); 0 is the caller's.
    """

    q: Floats
    position_error: Floats
    rotation_error: Floats
    start: NDArray[np.int64]

    def __post_init__(self) -> None:
        for array in (self.q, self.position_error, self.rotation_error, self.start):
            array.flags.writeable = False


@dataclass(eq=False, slots=True)
class Run:
    """What a solver hands to the judge.

    Attributes:
        q: The best joints found (n,).
        ended: Why it stopped; a claim of success is checked, every other reason is kept.
        iterations: Iterations over all starts.
        starts: Starts tried, the caller's included.
        start_moved: True if the caller's q0 was outside the limits and was moved inside.
        misses_by: Where the target is proven out of reach, a lower bound of the distance it misses by [m].
        branch: Label of the closed-form branch; empty for iterative methods.
        trace: The iterates, where they were asked for.
        start: The caller's start (n,), where jumps are of interest.
        jump: Largest move of a joint from there [rad or m].
        singular: Whether the branch stands for others, at a double root or on a continuum.
    """

    q: Floats
    ended: Status
    iterations: int = 0
    starts: int = 1
    start_moved: bool = False
    misses_by: float = 0.0
    branch: str = ""
    trace: Trace | None = None
    start: Floats | None = None
    jump: float = math.inf
    singular: bool = False


@dataclass(eq=False, slots=True)
class IKResult:
    """A set of joints that the judge measured.

    Attributes:
        problem: What was wanted.
        q: The joints (n,) [rad or m], read-only; the best found if unsolved, always finite.
        status: Why the solver ended.
        position_error: Distance of the tip to the target [m], measured at `q`; None where it is free.
        rotation_error: Angle to the wanted orientation [rad], measured at `q`; None where it is free.
        outside: Joints outside their ranges.
        run: What the solver reported.
    """

    problem: Problem
    q: Floats
    status: Status
    position_error: float | None
    rotation_error: float | None
    outside: tuple[OutsideLimit, ...]
    run: Run = field(repr=False)

    @property
    def solved(self) -> bool:
        """Whether the measured pose is within tolerance and every joint within its limits."""
        return self.status is Status.SOLVED

    @property
    def posture(self) -> dict[str, float]:
        """The joints by name [rad or m]."""
        return dict(zip(self.problem.chain.joint_names, self.q.tolist(), strict=True))

    @property
    def branch(self) -> str:
        """Label of the closed-form branch; empty for iterative methods."""
        return self.run.branch

    @property
    def trace(self) -> Trace | None:
        """The iterates, where they were asked for."""
        return self.run.trace

    @property
    def iterations(self) -> int:
        """Iterations over all starts."""
        return self.run.iterations

    @property
    def message(self) -> str:
        """The status with the measured errors, for people."""
        errors = [] if self.position_error is None else [f"position error {self.position_error:.3g} m"]
        errors += [] if self.rotation_error is None else [f"rotation error {self.rotation_error:.3g} rad"]
        parts = [self.status.value, ", ".join(errors).capitalize()]
        parts[-1] += f" after {_count(self.run.iterations, 'iteration')} from {_count(self.run.starts, 'start')}."
        if self.run.start is not None and self.status is Status.JUMPED:
            moves = np.abs(self.q - self.run.start)
            joint, move = self.problem.chain.joint_names[int(moves.argmax())], float(moves.max())
            parts.append(f"{joint} would move by {move:.3g}, more than {self.run.jump:g}.")
        if self.status is Status.OUT_OF_REACH:
            parts.append(f"It misses by at least {self.run.misses_by:.3g} m.")
        parts += [f"{outside}." for outside in self.outside]
        if self.run.start_moved:
            parts.append("The start was outside the limits and was moved inside.")
        return " ".join(parts)

    def __bool__(self) -> NoReturn:
        raise TypeError("An IKResult is not a truth value: ask for result.solved, and read result.status if it is not.")

    def __repr__(self) -> str:
        return f"<IKResult {self.status.name}: {self.message.removeprefix(self.status.value).strip()}>"

    def _repr_html_(self) -> str:
        return joint_table(self.problem.chain, self.q, self.status.name, self.message)._repr_html_()


def judge(problem: Problem, run: Run) -> IKResult:
    """Measures the returned joints with the chain's own forward kinematics; only this may say `Status.SOLVED`."""
    chain, target, tolerances, q = problem.chain, problem.target, problem.tolerances, run.q
    R, p = chain.tip_at(q)
    position, rotation, inside = measure(
        KINDS[target.kind], target.goal, target.counts, R, p, q, chain.lower, chain.upper, tolerances.limits
    )
    outside: tuple[OutsideLimit, ...] = ()
    if not inside or chain.limit_rules:
        if not np.isfinite(q).all():
            finite = np.nan_to_num(q, nan=0.0, posinf=0.0, neginf=0.0)
            return judge(problem, replace(run, q=finite, ended=Status.NOT_FINITE))
        outside = outside_limits(chain, q, tolerances.limits)
    # Comparisons with NaN, which stands for an error that the target leaves free, are false.
    reached = not (position > tolerances.position or rotation > tolerances.rotation)
    ended = _VERDICTS[run.ended.number][reached][not outside]
    if ended is _SOLVED and run.start is not None and np.abs(q - run.start).max() > run.jump:
        ended = _JUMPED
    q.flags.writeable = False
    far = position if position == position else None  # NaN becomes None
    turned = rotation if rotation == rotation else None
    return IKResult(problem, q, ended, far, turned, outside, run)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
