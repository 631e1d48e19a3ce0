"""Task 1h of the practicum, measured: reasons for which the error does not go to 0, each with a remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

    Solve = Callable[[Floats, Floats], float]

__all__ = ["not_converging"]

_ENOUGH: Final = 0.01  # [m] task 1g


def not_converging(count: int, seed: int) -> list[dict[str, Any]]:
    """A row a reason: how many percent of the targets are missed by more than 1 cm, without and with the remedy."""
    import numpy as np

    from nao_kin.chain import random_configurations
    from nao_kin.robot.robot import load

    arm, rng = load("jaco2").chain("arm"), np.random.default_rng(seed)
    starts, others = random_configurations(arm, count, rng), random_configurations(arm, count, rng)
    wanted = np.array([arm.pose(q).translation for q in others])
    return [
        _row("target out of reach", starts, _beyond(arm, wanted), _pseudo(), "its nearest place", _to_the_border(arm)),
        _row("singular at the start", *_stretched(arm, count, rng), _pseudo(), "start bent by 0.1 rad", _bent(rng)),
        _row("K of the transpose too large", starts, wanted, _transpose(arm, 6.0), "a fourth", _transpose(arm, 1.5)),
        _row("too few iterations", starts, wanted, _transpose(arm, 1.5, 16), "128, not 16", _transpose(arm, 1.5)),
        _row("joint limits", starts, wanted, _limited(arm, 0), "other starts", _limited(arm, 100)),
    ]


def _row(reason: str, starts: Floats, wanted: Floats, before: Solve, remedy: str, after: Solve) -> dict[str, Any]:
    import numpy as np

    from nao_kin.output import progress

    pairs = list(zip(starts, wanted, strict=True))
    errors = np.array([(before(q, p), after(q, p)) for q, p in progress(pairs, f"1h, {reason}", len(pairs))])
    missed, still = (100.0 * np.mean(~(errors < _ENOUGH), axis=0)).tolist()  # what is no number is missed too
    return {"reason": reason, "missed": missed, "remedy": remedy, "still": still}


def _pseudo() -> Solve:
    from nao_kin.documents.practicum.position_ik import ik_pseudo_inverse

    return lambda q, p: ik_pseudo_inverse(q, p).error


def _transpose(arm: UrdfChain, gain: float, iterations: int = 128) -> Solve:
    """The sheet's transpose with K = gain/σ², σ the largest singular value over 256 postures: below 2 it converges."""
    import numpy as np

    from nao_kin.documents.practicum.position_ik import ik_transpose
    from nao_kin.ik.scales import chain_scales

    configurations = np.random.default_rng(0).uniform(-np.pi, np.pi, (256, 6))
    K = gain / chain_scales(arm, "position", configurations).singular_value ** 2
    return lambda q, p: ik_transpose(q, p, gain=K, iterations=iterations).error


def _beyond(arm: UrdfChain, wanted: Floats) -> Floats:
    """The targets moved outwards, 10 cm beyond the reach of the links."""
    import numpy as np

    from nao_kin.ik.reach import reach_shell

    shell, found = reach_shell(arm), []
    for p in wanted:
        far = 10.0 * p / np.linalg.norm(p)
        edge = shell.nearest(far)
        found.append(edge + 0.1 * (far - edge) / np.linalg.norm(far - edge))
    return np.array(found)


def _to_the_border(arm: UrdfChain) -> Solve:
    """Distance to the nearest place that the arm can be at."""
    import numpy as np

    from nao_kin.ik.border import project_to_reach
    from nao_kin.ik.single import solve

    def error(q: Floats, p: Floats) -> float:
        place = project_to_reach(arm, p).goal[:3, 3]
        return float(np.linalg.norm(arm.pose(solve(arm, place, q).q).translation - place))

    return error


def _stretched(arm: UrdfChain, count: int, rng: Any) -> tuple[Floats, Floats]:
    """The arm stretched upwards, turned about its base at random, and targets down along it."""
    import numpy as np

    starts = np.full((count, 6), np.pi)
    starts[:, 0] = rng.uniform(-np.pi, np.pi, count)
    tops = np.array([arm.pose(q).translation for q in starts])
    tops[:, 2] -= rng.uniform(0.05, 0.4, count)
    return starts, tops


def _bent(rng: Any) -> Solve:
    from nao_kin.documents.practicum.position_ik import ik_pseudo_inverse

    return lambda q, p: ik_pseudo_inverse(q + rng.uniform(-0.1, 0.1, 6), p).error


def _limited(arm: UrdfChain, restarts: int) -> Solve:
    """Damped least squares inside the limits."""
    from nao_kin.ik.reference_loop import Budget
    from nao_kin.ik.single import solve

    return lambda q, p: float(solve(arm, p, q, budget=Budget(restarts=restarts)).position_error or 0.0)
