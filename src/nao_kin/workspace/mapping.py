"""Making a workspace map: the grid, the chunks, and who works on them."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

import numpy as np

from nao_kin.arrays import positive
from nao_kin.errors import InvalidInputError, MissingExtraError, NaoKinError, UnknownNameError
from nao_kin.ik.reach import reach_shell
from nao_kin.kernels.reaching import NOTHING, VOLUME, Cells, Samples, sort_into_cells
from nao_kin.progress import progress
from nao_kin.workspace.map_file import MOST_CELLS, MOST_SAMPLES
from nao_kin.workspace.reach_map import MEASURES, Measure, ReachMap
from nao_kin.workspace.sampling import Sampling, samples_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from numpy.typing import NDArray

    from nao_kin.chain import Chain
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["on_cluster", "reachability"]

_CHUNK: Final = 2**20
_BITS: Final = 32  # of a scaled measure
_CELLS_OF_ALL_THREADS: Final = 2**24  # 400 MB
_FINENESS: Final = 40  # cubes from the centre of reach to its edge, at most


class _Task(NamedTuple):
    """What is computed for every chunk; plain data, so that it can travel."""

    path: JointPath
    samples: Samples
    cells: Cells


def reachability(
    chain: Chain,
    samples: int = 1_000_000,
    *,
    voxel: float | None = None,
    measure: Measure = "manipulability",
    axes: str = "xyz",
    sampling: Sampling = "random",
    seed: int = 0,
    chunk: int = _CHUNK,
    client: Any = None,
) -> ReachMap:
    """Maps where the tip of a chain can be, from configurations inside its limits, coupled ones included.

    The work goes in chunks on all cores and no configuration is kept, so memory is that of the grid. Configuration
    number i depends on the seed and on i alone, and sums are sums of whole numbers: the map is the same to the last bit
    whatever the chunk, the number of threads or the cluster, among machines that round alike. The measure is
    kept to 2⁻³¹ of a bound on it that the chain's lengths give; computed from J Jᵀ, the manipulability of a singular
    configuration is 0 to about 1e-8 of that.

    Args:
        chain: The chain; on a robot, `robot.chain(...)`.
        samples: How many configurations.
        voxel: Edge of a cube [m]. None takes a round number that makes the radius of reach 16 to 40 cubes.
        measure: ``"manipulability"``: Yoshikawa's √det(J Jᵀ) (1985); ``"smallest_singular_value"`` of J, slower; or
            ``"none"``. J (k, n) is the linear part of the frame Jacobian at the tip, with the rows of `axes`.
        axes: The directions in base axes that count in the measure. A planar arm cannot leave its plane, so its
            measure is 0 unless only the two directions of the plane count.
        sampling: ``"random"`` or ``"even"``; see `nao_kin.workspace.sampling.samples_of`.
        seed: Where the sequence starts.
        chunk: Configurations a call of the kernel works on.
        client: A `distributed.Client`, whose workers then share the chunks; a chunk whose worker dies is computed
            again by another. They need this package installed.

    Returns:
        The map.

    Raises:
        InvalidInputError: A number out of its range, too many cubes, or a tip that nothing bounds.
        UnknownNameError: No such measure or sampling.
    """
    samples, chunk = _whole(samples, "samples", MOST_SAMPLES), _whole(chunk, "chunk", MOST_SAMPLES)
    if measure not in MEASURES:
        raise UnknownNameError("measure", measure, MEASURES)
    if axes not in ("x", "y", "z", "xy", "xz", "yz", "xyz"):
        raise InvalidInputError("axes", "some of x, y and z, in this order", repr(axes))
    cells = _grid(chain, voxel, measure, axes)
    task = _Task(chain.joint_path, samples_of(chain, sampling, seed), cells)
    starts = range(0, samples, chunk)
    chunks = ((first, min(chunk, samples - first)) for first in starts)
    if client is None:
        totals = _on_this_machine(task, progress(chunks, "sampling", len(starts)))
    else:
        totals = np.zeros((math.prod(cells.shape.tolist()), 3), dtype=np.int64)
        for numbers, part in progress(on_cluster(client, _chunk_totals, task, chunks), "sampling", len(starts)):
            _add(totals, numbers, part)
    return _map(chain, cells, totals, samples, MEASURES[cells.measure], axes, sampling, seed)


def _on_this_machine(task: _Task, chunks: Iterator[tuple[int, int]]) -> NDArray[np.int64]:
    """Totals (cubes, 3) of all chunks."""
    totals = _private_totals(task.cells)
    for first, count in chunks:
        sort_into_cells(task.path, task.samples, task.cells, first, count, totals)
    return _joined(totals)


def _chunk_totals(task: _Task, first: int, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """One chunk by itself: the numbers of its cubes (k,), and their totals (k, 3)."""
    totals = _private_totals(task.cells)
    sort_into_cells(task.path, task.samples, task.cells, first, count, totals)
    joined = _joined(totals)
    (numbers,) = np.nonzero(joined[:, 0])
    return numbers, joined[numbers]


def _private_totals(cells: Cells) -> NDArray[np.int64]:
    """Zeros (t, cubes, 3): totals of its own for each thread, or for fewer where they would take too much memory."""
    import numba

    cubes = math.prod(cells.shape.tolist())
    return np.zeros((max(1, min(numba.get_num_threads(), _CELLS_OF_ALL_THREADS // cubes)), cubes, 3), dtype=np.int64)


def _joined(totals: NDArray[np.int64]) -> NDArray[np.int64]:
    joined: NDArray[np.int64] = totals[0]
    for other in totals[1:]:
        _add(joined, slice(None), other)
    return joined


def _add(totals: NDArray[np.int64], numbers: NDArray[np.int64] | slice, part: NDArray[np.int64]) -> None:
    """Adds counts and sums, and keeps the greatest values, of the cubes with these numbers."""
    totals[numbers, :2] += part[:, :2]
    totals[numbers, 2] = np.maximum(totals[numbers, 2], part[:, 2])


def _map(
    chain: Chain,
    cells: Cells,
    totals: NDArray[np.int64],
    samples: int,
    measure: Measure,
    axes: str,
    sampling: Sampling,
    seed: int,
) -> ReachMap:
    grid = totals.reshape(*cells.shape.tolist(), 3)
    if int(grid[..., 0].sum()) != samples:
        raise NaoKinError(f"Some tips of {chain.name} are outside their proven reach. Please report it.")
    reached = grid[..., 0] > 0
    ends = [np.flatnonzero(reached.any(axis=tuple({0, 1, 2} - {a})))[[0, -1]] for a in range(3)]
    grid = grid[tuple(slice(low, high + 1) for low, high in ends)]
    counts = np.ascontiguousarray(grid[..., 0])
    return ReachMap(
        chain=chain.name,
        base_name=chain.base_name,
        tip_name=chain.tip_name,
        voxel=cells.edge,
        corner=cells.corner + [low for low, _ in ends],
        counts=counts,
        greatest=grid[..., 2] / cells.scale,
        mean=grid[..., 1] / (cells.scale * np.maximum(counts, 1)),
        measure=measure,
        axes=axes,
        unit=_unit(chain, cells),
        sampling=sampling,
        seed=int(seed),
    )


def _grid(chain: Chain, voxel: float | None, measure: Measure, axes: str) -> Cells:
    """Cubes around everything that the tip can reach."""
    shell = reach_shell(chain)
    if not math.isfinite(shell.outer):
        raise InvalidInputError(chain.name, "limits for every sliding joint", "one without, so nothing bounds the tip")
    if voxel is None and shell.outer < 1e-9:
        raise InvalidInputError("voxel", f"a size [m], since the tip of {chain.name} stays in one place", "None")
    edge = _round_number(shell.outer / _FINENESS) if voxel is None else positive(voxel, "voxel", "[m]")
    low = np.floor((shell.centre - shell.outer) / edge) - 1.0  # one more, for what rounding adds to the reach
    high = np.floor((shell.centre + shell.outer) / edge) + 1.0
    shape = high - low + 1.0
    if not math.prod(shape.tolist()) <= MOST_CELLS:
        least = 1.01 * 2.0 * shell.outer / (MOST_CELLS ** (1.0 / 3.0) - 4.0)
        raise InvalidInputError("voxel", f"at least {least:.3g} m ({MOST_CELLS} cubes)", f"{edge:g} m")
    whole, counts = np.int64, np.array([axis in axes for axis in "xyz"], dtype=np.int64)
    code = MEASURES.index(measure)
    return Cells(edge, low.astype(whole), shape.astype(whole), counts, code, _scale(chain, code, len(axes)))


def _scale(chain: Chain, code: int, d: int) -> float:
    """A power of two that keeps the scaled measure below 2³².

    Each column of J is no longer than the chain, and det(J Jᵀ) no greater than the mean eigenvalue to the power of d.
    """
    path = chain.joint_path
    reach = float(np.linalg.norm(path.translations[1:], axis=1).sum() + np.linalg.norm(path.tool_translation))
    columns = np.zeros(len(chain.joints))
    for k, column in enumerate(path.columns):
        if path.prismatic[k]:
            ends = itertools.product((path.multipliers[k],), (path.lower[column], path.upper[column]))
            reach += max(abs(factor * end + path.offsets[k]) for factor, end in ends)
    for k, column in enumerate(path.columns):
        columns[column] += abs(path.multipliers[k]) * (1.0 if path.prismatic[k] else reach)
    mean = float(columns @ columns) / d
    bound = mean ** (0.5 * d) if code == VOLUME else math.sqrt(mean)
    return 2.0 ** (_BITS - 1 - math.ceil(math.log2(bound))) if bound > 0.0 else 1.0


def _unit(chain: Chain, cells: Cells) -> str:
    if cells.measure == NOTHING:
        return ""
    kinds = {joint.kind == "prismatic" for joint in chain.joints}
    power = "" if cells.measure != VOLUME else ("", "²", "³")[int(cells.counts.sum()) - 1]
    return "mixed" if len(kinds) == 2 else "1" if kinds == {True} else f"m{power}/rad{power}"


def _round_number(least: float) -> float:
    """The smallest 1, 2 or 5 times a power of ten that is not smaller."""
    decade = 10.0 ** math.floor(math.log10(least))
    return float(f"{next(step * decade for step in (1.0, 2.0, 5.0, 10.0) if step * decade >= least):.1g}")


def _whole(value: object, what: str, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not 1 <= value <= most:
        raise InvalidInputError(what, f"a whole number from 1 to {most}", repr(value))
    return int(value)


Task = TypeVar("Task")
Part = TypeVar("Part")


def on_cluster(
    client: Any, work: Callable[[Task, int, int], Part], task: Task, chunks: Iterable[tuple[int, int]]
) -> Iterator[Part]:
    """Yields what `work(task, first, count)` returns for every chunk, as it comes, and forgets it on the cluster.

    Dask computes a chunk again whose worker died, and gives up on one that took several workers with it; then its
    error is raised here.

    Raises:
        InvalidInputError: `client` is no `distributed.Client`.
        MissingExtraError: Dask is not installed.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise MissingExtraError("A cluster", "cluster") from None
    if not isinstance(client, Client):
        raise InvalidInputError("client", "a distributed.Client", type(client).__name__)
    futures = [client.submit(work, task, first, count, pure=False) for first, count in chunks]
    for future in as_completed(futures):
        yield future.result()
        future.release()
