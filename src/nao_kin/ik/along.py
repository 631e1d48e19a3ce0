"""Following a path on one branch, and moving a target to where the chain can be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from nao_kin.arrays import frozen
from nao_kin.errors import InvalidInputError
from nao_kin.ik.loop import Budget
from nao_kin.ik.methods import solve
from nao_kin.ik.problem import Status
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.target import Target, TargetLike
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.problem import IKResult

    Start: TypeAlias = ArrayLike | Mapping[str, float]
    Step: TypeAlias = Callable[[Target, Start], IKResult]

__all__ = ["FollowResult", "follow", "followed", "project_to_reach"]

_ONE_START = Budget(restarts=0, largest_step=0.2)  # another start would be another branch


@dataclass(frozen=True, eq=False, slots=True)
class FollowResult:
    """A path in joint space.

    Attributes:
        q: Joints (k, n) of the samples that were reached, in order; read-only.
        samples: Number of samples asked for.
        status: Why it ended; `Status.SOLVED` if at the last sample.
        reason: The same for people, with the sample's number where it ended early.
        largest_move: Largest move of a joint between consecutive samples [rad or m].
        largest_move_at: Number of the sample it led to.
        max_position_error: Largest measured distance to a target [m].
        max_rotation_error: Largest measured angle to a wanted orientation [rad]; 0 where it is free.
    """

    q: Floats
    samples: int
    status: Status
    reason: str
    largest_move: float
    largest_move_at: int
    max_position_error: float
    max_rotation_error: float

    @property
    def completed(self) -> bool:
        """Whether every sample was reached without a jump."""
        return len(self.q) == self.samples and self.status is Status.SOLVED


def follow(
    chain: Chain,
    path: Iterable[TargetLike],
    q0: ArrayLike | Mapping[str, float],
    *,
    jump: float = 0.5,
    method: str = "lm",
    tolerances: Tolerances = TOLERANCES,
) -> FollowResult:
    """`nao_kin.follow`, which says what the arguments are, by a method that iterates."""

    def step(target: Target, start: Start) -> IKResult:
        return solve(chain, target, start, method=method, tolerances=tolerances, budget=_ONE_START)

    return followed(chain, path, q0, jump, step)


def followed(chain: Chain, path: Iterable[TargetLike], q0: Start, jump: float, step: Step) -> FollowResult:
    """`follow` by any solver, which takes a target and the joints to come from."""
    targets = [Target.of(target) for target in path]
    if not targets:
        raise InvalidInputError("path", "at least one target", "none")
    if not jump > 0.0:
        raise InvalidInputError("jump", "a number > 0", repr(jump))
    reached: list[Floats] = []
    largest, largest_at, position, rotation = 0.0, 0, 0.0, 0.0
    start: Start = q0
    status, reason = Status.SOLVED, f"All {len(targets)} samples are reached."
    for index, target in enumerate(targets):
        result = step(target, start)
        if not result.solved:
            status, reason = result.status, f"Sample {index} is not reached: {result.message}"
            break
        move = np.abs(result.q - reached[-1]) if reached else np.zeros(len(chain.joints))
        joint = int(move.argmax())
        if move[joint] > jump:
            status = Status.STALLED
            reason = f"At sample {index} {chain.joint_names[joint]} jumps by {move[joint]:.3g}, more than {jump:g}."
            break
        if move[joint] > largest:
            largest, largest_at = float(move[joint]), index
        position, rotation = max(position, result.position_error or 0.0), max(rotation, result.rotation_error or 0.0)
        reached.append(result.q)
        start = result.q.copy()
    q = frozen(np.array(reached, dtype=np.float64).reshape(-1, len(chain.joints)))
    return FollowResult(q, len(targets), status, reason, largest, largest_at, position, rotation)


def project_to_reach(chain: Chain, target: TargetLike, **options: Any) -> Target:
    """The target moved to the border of what the chain can reach, or as it is if it is reached.

    First it is moved to the nearest place that link lengths allow; where joint limits or the wanted orientation forbid
    that too, to the nearest pose that a solver finds, which is where the chain can certainly be.

    Source: Bischoff 2016, section 3.2, which advises to map unreachable targets to the border.

    Args:
        chain: The chain.
        target: As `nao_kin.solve` takes it.
        options: Further arguments of `nao_kin.solve`.

    Returns:
        A target of the same kind, where the chain certainly can be: the tip's own place at the nearest joints found.
        At such a border of the reach a solver may need another start to find those joints again.

    Raises:
        InvalidInputError, UnknownNameError: See `nao_kin.solve`.
    """
    wanted = Target.of(target)
    result = solve(chain, wanted, **options)
    if result.solved:
        return wanted
    if result.status is Status.OUT_OF_REACH:
        wanted = wanted.moved_to(reach_shell(chain).nearest(wanted.goal[:3, 3]))
        result = solve(chain, wanted, **options)
        if result.solved:
            return wanted
    T = chain.pose(result.q)
    if wanted.kind == "pointing":
        return Target.pointing(T.translation, T.rotation @ wanted.goal[:3, 0], wanted.goal[:3, 0], wanted.weights)
    goal = wanted.goal.copy()
    if wanted.kind != "orientation":
        goal[:3, 3] = T.translation
    if wanted.kind != "position":
        goal[:3, :3] = T.rotation
    return Target(wanted.kind, goal, wanted.weights)
