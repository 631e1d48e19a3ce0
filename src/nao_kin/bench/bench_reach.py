"""`nao-kin bench reach`: maps of both hands against bare forward kinematics of the same configurations."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.kernels.joint_path import JointPath
    from nao_kin.workspace.reach_map import ReachMap

__all__ = ["reach"]

_ROBOT, _HANDS = "nao", ("left_arm", "right_arm")
_TIMES, _GIGABYTES = 3.0, 2.0
_PIECES = (2**13, 2**16)  # configurations a call: results that stay in the cache, and a size that keeps all cores busy
_SEED = 5
_NOTE = (
    "The map: sampling, forward kinematics, linear Jacobian, √det(J Jᵀ), sorting into cubes. Forward kinematics: the "
    "poses of the same configurations, made before and untimed, by calls of the size that was the faster one in total."
)


def reach(
    configurations: Annotated[int, typer.Option(min=1000, help="Configurations, of both hands together.")] = 10_000_000,
    rounds: Annotated[int, typer.Option(min=1, help="Alternations; the medians are compared.")] = 3,
    workers: Annotated[int, typer.Option(min=1, help="Processes of the local Dask cluster.")] = 2,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Maps of both hands of the NAO: time against bare forward kinematics, memory, and the same map from Dask."""
    from nao_kin.robot.robot import load

    machine, robot = Machine(), load(_ROBOT)
    chains, each = [robot.chain(name) for name in _HANDS], configurations // len(_HANDS)
    maps, rows = [], list[dict[str, Any]]()
    for chain in chains:
        found, row = _measured(chain, each, rounds)
        maps.append(found)
        rows.append(row)
    gigabytes = _peak_gigabytes()
    ratio = sum(row["map_ms"] for row in rows) / sum(row["fk_ms"] for row in rows)
    bounds = [
        Promise("both maps: times bare forward kinematics", ratio, _TIMES, at_least=False),
        Promise("peak memory of the process [GB]", gigabytes, _GIGABYTES, at_least=False),
    ]
    same, notes = _cluster(chains, maps, each, workers)
    bounds += [] if same is None else [Promise("maps that Dask makes the same to the last bit", same, len(maps))]
    title = f"{each} configurations a hand, cubes of {maps[0].voxel:g} m, median of {rounds} alternations"
    conclude(machine, [Sheet("maps", title, _HEADINGS, rows)], bounds, [_NOTE, *notes], format, goals)


_HEADINGS = (
    Heading("chain", "chain"),
    Heading("map_ms", "map [ms]", ".0f"),
    Heading("fk_ms", "FK [ms]", ".0f"),
    Heading("ratio", "× FK", ".2f"),
    Heading("cubes", "cubes", "d"),
    Heading("litres", "[l]", ".2f"),
    Heading("mean", "mean w", ".2e"),
    Heading("greatest", "greatest", ".2e"),
)


def _measured(chain: Chain, count: int, rounds: int) -> tuple[ReachMap, dict[str, Any]]:
    """The map of one hand, and its times."""
    import statistics

    from nao_kin.bench.measuring import seconds, undisturbed
    from nao_kin.workspace.mapping import reachability

    found = reachability(chain, count, seed=_SEED)  # compiles, and starts the threads
    _forward_seconds(chain, min(count, max(_PIECES)), max(_PIECES))
    maps, poses = list[float](), {piece: list[float]() for piece in _PIECES}
    for _ in progress(range(rounds), f"alternating, {chain.name}", rounds):
        with undisturbed():
            maps.append(seconds(lambda: reachability(chain, count, seed=_SEED)))
            for piece in _PIECES:
                poses[piece].append(_forward_seconds(chain, count, piece))
    taken, bare = statistics.median(maps), min(map(statistics.median, poses.values()))
    row = {
        "chain": chain.name,
        "configurations": count,
        "map_ms": taken * 1e3,
        "fk_ms": bare * 1e3,
        "ratio": taken / bare,
        "cubes": int(found.reached.sum()),
        "litres": found.volume * 1e3,
        "mean": float((found.mean * found.counts).sum() / found.samples),
        "greatest": float(found.greatest.max()),
    }
    return found, row


def _forward_seconds(chain: Chain, count: int, piece: int) -> float:
    """How long the kernel of `chain.poses` takes for the configurations that a map is made of [s]."""
    from nao_kin.bench.measuring import seconds
    from nao_kin.kernels.reaching import configurations
    from nao_kin.workspace.sampling import samples_of

    samples, path, total = samples_of(chain, seed=_SEED), chain.joint_path, 0.0
    for first in range(0, count, max(_PIECES)):
        Q = configurations(samples, first, min(max(_PIECES), count - first))
        parts = [Q[start : start + piece] for start in range(0, len(Q), piece)]
        total += seconds(functools.partial(_all_poses, path, parts))
    return total


def _all_poses(path: JointPath, parts: list[Floats]) -> None:
    from nao_kin.kernels.forward import poses

    for part in parts:
        poses(path, part)


def _peak_gigabytes() -> float:
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9  # Linux counts kilobytes


def _cluster(chains: list[Any], maps: list[ReachMap], each: int, workers: int) -> tuple[int | None, list[str]]:
    """How many of the maps a local cluster makes the same, and what there is to say."""
    from nao_kin.workspace.mapping import reachability

    try:
        from distributed import Client, LocalCluster
    except ImportError:
        return None, ["Without Dask (extra 'cluster') its maps are not compared."]
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        others = [reachability(chain, each, seed=_SEED, client=client) for chain in chains]
    same = sum(one.same_as(other) for one, other in zip(maps, others, strict=True))
    return same, [f"Dask: a local cluster of {workers} processes."]
