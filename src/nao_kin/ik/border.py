"""Moving a target to where the chain can be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nao_kin.ik.problem import Status
from nao_kin.ik.reach import reach_shell
from nao_kin.ik.single import solve
from nao_kin.ik.target import Target, TargetLike

if TYPE_CHECKING:
    from nao_kin.chain import Chain

__all__ = ["project_to_reach"]


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
