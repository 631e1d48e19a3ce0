"""`nao-kin bench fk`: compiled poses and Jacobians against loops over Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["fk"]

_REPEATS = 5  # of a compiled call in each round

# The quantity, what computes it, and the one it is compared with.
_PLAIN, _TUNED, _COMPILED, _ONE = "Pinocchio loop", "Pinocchio loop, tuned", "compiled", "compiled, one thread"
_GOALS = {"poses": 25.0, "Jacobians": 15.0}
_ROUNDING = 1e-12


def fk(
    configurations: Annotated[int, typer.Option(min=1, help="Configurations of the arm.")] = 100_000,
    rounds: Annotated[int, typer.Option(min=1, help="Alternations; the medians are compared.")] = 9,
    samples: Annotated[int, typer.Option(min=1, help="Configurations of each chain for the differences.")] = 200,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Poses and Jacobians of many configurations, against Pinocchio in a Python loop."""
    import statistics

    import numpy as np

    from nao_kin.bench.arms import main_arm
    from nao_kin.bench.measuring import in_turns
    from nao_kin.chain import random_configurations

    machine, (chain, notes) = Machine(), main_arm()
    Q = random_configurations(chain, configurations, np.random.default_rng(1))
    jobs = _jobs(chain, Q)
    for name in (name for name in jobs if name not in _loops()):
        jobs[name]()  # compiles, and starts the threads
    repeats = {name: _REPEATS for name in jobs if name not in _loops()}
    times = in_turns(jobs, progress(range(rounds), "alternating", rounds), repeats)
    medians = {name: statistics.median(taken) * 1e3 for name, taken in times.items()}
    rows: list[dict[str, Any]] = [
        {
            "what": what,
            "by": by,
            "ms": medians[f"{what}, {by}"],
            "least_ms": min(times[f"{what}, {by}"]) * 1e3,
            "over_loop": medians[f"{what}, {_PLAIN}"] / medians[f"{what}, {by}"],
            "over_tuned": medians[f"{what}, {_TUNED}"] / medians[f"{what}, {by}"],
        }
        for what in _GOALS
        for by in (_PLAIN, _TUNED, _COMPILED, _ONE)
    ]
    title = f"{configurations} configurations of {chain.name}, median of {rounds} alternations"
    sheet, differences = Sheet("rows", title, _HEADINGS, rows), _differences(samples)
    bounds = [
        Promise(f"{what}, {_COMPILED}: times the loop", row["over_loop"], _GOALS[what])
        for row in rows
        if (what := str(row["what"])) and row["by"] == _COMPILED
    ]
    worst = max(max(row["poses"], row["jacobians"]) for row in differences.rows)
    bounds.append(Promise("largest difference from Pinocchio", worst, _ROUNDING, at_least=False))
    conclude(machine, [sheet, differences], bounds, [*notes, _NOTE], format, goals)


_HEADINGS = (
    Heading("what", "what"),
    Heading("by", "computed by"),
    Heading("ms", "[ms]", ".2f"),
    Heading("least_ms", "least", ".2f"),
    Heading("over_loop", "× loop", ".1f"),
    Heading("over_tuned", "× tuned", ".1f"),
)

_NOTE = (
    "The loop calls forwardKinematics, updateFramePlacements and data.oMf[id], or computeFrameJacobian, and stores "
    "each result; tuned, it holds functions and placement in local names and updates the one frame."
)


def _loops() -> set[str]:
    return {f"{what}, {by}" for what in _GOALS for by in (_PLAIN, _TUNED)}


def _jobs(chain: UrdfChain, Q: Floats) -> dict[str, Callable[[], object]]:
    """What is timed; every job returns all results in one new array."""
    from nao_kin.bench.measuring import one_thread

    return {
        f"poses, {_PLAIN}": lambda: _poses_as_written(chain, Q),
        f"poses, {_COMPILED}": lambda: chain.poses(Q),
        f"poses, {_TUNED}": lambda: _poses_tuned(chain, Q),
        f"poses, {_ONE}": lambda: one_thread()(chain.poses)(Q),
        f"Jacobians, {_PLAIN}": lambda: _jacobians_as_written(chain, Q),
        f"Jacobians, {_COMPILED}": lambda: chain.jacobians(Q),
        f"Jacobians, {_TUNED}": lambda: _jacobians_tuned(chain, Q),
        f"Jacobians, {_ONE}": lambda: one_thread()(chain.jacobians)(Q),
    }


def _poses_as_written(chain: UrdfChain, Q: Floats) -> Floats:
    import numpy as np
    import pinocchio as pin

    model: Any = chain.robot.model
    data, tip, result = model.createData(), model.getFrameId(chain.tip), np.empty((len(Q), 4, 4))
    for i in range(len(Q)):
        pin.forwardKinematics(model, data, Q[i])
        pin.updateFramePlacements(model, data)
        result[i] = data.oMf[tip].homogeneous
    return result


def _poses_tuned(chain: UrdfChain, Q: Floats) -> Floats:
    import numpy as np
    from pinocchio import forwardKinematics, updateFramePlacement

    model: Any = chain.robot.model
    data, tip, result = model.createData(), model.getFrameId(chain.tip), np.empty((len(Q), 4, 4))
    placement = data.oMf[tip]  # a live reference: looking it up is dearer than the kinematics
    for i, q in enumerate(Q):
        forwardKinematics(model, data, q)
        updateFramePlacement(model, data, tip)
        result[i] = placement.homogeneous
    return result


def _jacobians_as_written(chain: UrdfChain, Q: Floats) -> Floats:
    import numpy as np
    import pinocchio as pin

    model: Any = chain.robot.model
    data, tip, result = model.createData(), model.getFrameId(chain.tip), np.empty((len(Q), 6, model.nv))
    for i in range(len(Q)):
        result[i] = pin.computeFrameJacobian(model, data, Q[i], tip, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    return result


def _jacobians_tuned(chain: UrdfChain, Q: Floats) -> Floats:
    import numpy as np
    from pinocchio import LOCAL_WORLD_ALIGNED, computeFrameJacobian

    model: Any = chain.robot.model
    data, tip, result = model.createData(), model.getFrameId(chain.tip), np.empty((len(Q), 6, model.nv))
    for i, q in enumerate(Q):
        result[i] = computeFrameJacobian(model, data, q, tip, LOCAL_WORLD_ALIGNED)
    return result


def _differences(samples: int) -> Sheet:
    """The compiled kinematics of every chain of every bundled robot against Pinocchio on the whole model."""
    import numpy as np

    from nao_kin.bench.arms import bundled_chains
    from nao_kin.bench.referee import Referee
    from nao_kin.chain import random_configurations

    worst: dict[str, tuple[int, float, float]] = {}
    chains = bundled_chains()
    for chain in progress(chains, "comparing with Pinocchio", len(chains)):
        referee, Q = Referee(chain), random_configurations(chain, samples, np.random.default_rng(2))
        poses = float(np.abs(chain.poses(Q) - [referee.pose(q) for q in Q]).max())
        jacobians = float(np.abs(chain.jacobians(Q) - [referee.jacobian(q) for q in Q]).max())
        count, *before = worst.get(chain.robot.name, (0, 0.0, 0.0))
        worst[chain.robot.name] = (count + 1, max(poses, before[0]), max(jacobians, before[1]))
    rows = [
        {"robot": robot, "chains": count, "poses": poses, "jacobians": jacobians}
        for robot, (count, poses, jacobians) in worst.items()
    ]
    headings = (
        Heading("robot", "robot"),
        Heading("chains", "chains", "d"),
        Heading("poses", "poses", ".1e"),
        Heading("jacobians", "Jacobians", ".1e"),
    )
    title = f"largest difference from Pinocchio on the whole model, {samples} configurations a chain"
    return Sheet("differences", title, headings, rows)
