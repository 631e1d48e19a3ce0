"""A map of where the tip of a chain can be: cubes, what was counted in them, and questions to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from nao_kin.arrays import rows, vector
from nao_kin.errors import InvalidInputError, MissingExtraError
from nao_kin.table import Column, Table
from nao_kin.workspace.map_file import read_map, write_map

if TYPE_CHECKING:
    import os
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats

__all__ = ["MEASURES", "Layer", "Measure", "ReachMap", "map_figure"]

Measure: TypeAlias = Literal["manipulability", "smallest_singular_value", "none"]
MEASURES: Final[tuple[Measure, ...]] = ("none", "manipulability", "smallest_singular_value")
"""In the order of the kernel's codes."""

Layer: TypeAlias = Literal["counts", "greatest", "mean"]


@dataclass(frozen=True, eq=False, slots=True)
class ReachMap:
    """Cubes of space, in the base frame of a chain, and what its tip did in them.

    A cube that no sample fell into is not proven to be out of reach, and a reached one is reached somewhere in it: the
    map is made of samples.

    Attributes:
        chain: Name of the chain.
        base_name: Name of the frame in which the map stands.
        tip_name: Name of the frame whose origin is mapped.
        voxel: Edge of a cube [m].
        corner: Number of the lowest cube along x, y, z (3,); cube (0, 0, 0) begins at the base frame's origin.
        counts: How many of the samples are in each cube (nx, ny, nz).
        greatest: The greatest measure in each cube (nx, ny, nz), 0 where there is no sample.
        mean: The mean measure in each cube (nx, ny, nz), 0 where there is no sample.
        measure: ``"manipulability"``: Yoshikawa's √det(J Jᵀ); ``"smallest_singular_value"`` of J; or ``"none"``. J is
            the linear part of the frame Jacobian at the tip, its rows those of `axes`.
        axes: The directions that count in the measure, in base axes, some of ``"xyz"``.
        unit: Unit of the measure.
        sampling: How the joints were sampled.
        seed: With which seed.
    """

    chain: str
    base_name: str
    tip_name: str
    voxel: float
    corner: NDArray[np.int64]
    counts: NDArray[np.int64]
    greatest: Floats
    mean: Floats
    measure: Measure
    axes: str
    unit: str
    sampling: str
    seed: int

    @property
    def samples(self) -> int:
        """How many configurations the map is made of."""
        return int(self.counts.sum())

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Which cubes hold a sample (nx, ny, nz)."""
        return self.counts > 0

    @property
    def volume(self) -> float:
        """Volume of the reached cubes [m³]; cubes on the border count whole."""
        return int(self.reached.sum()) * self.voxel**3

    @property
    def extent(self) -> Floats:
        """Lowest and highest corner of the reached cubes, in the base frame [m], (2, 3)."""
        return self.voxel * np.array([self.corner, self.corner + self.counts.shape], dtype=np.float64)

    @property
    def centres(self) -> Floats:
        """Centres of the M reached cubes, in the base frame [m], (M, 3); in the order of `counts[reached]`."""
        numbers = np.argwhere(self.reached) + self.corner
        return self.voxel * (numbers.astype(np.float64) + 0.5)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points (N, 3) in the base frame [m] lie in reached cubes (N,); of one point (3,) a single value.

        Raises:
            InvalidInputError: Another shape, or not finite.
        """
        cells, inside = self._cells(points)
        found = np.zeros(len(inside), dtype=np.bool_)
        found[inside] = self.reached[tuple(cells[inside].T)]
        return found.reshape(np.shape(points)[:-1])

    def measured(self, points: ArrayLike, layer: Layer = "greatest") -> Floats:
        """What the map says at points (N, 3) in the base frame [m]: a layer's values (N,), 0 where nothing was reached.

        Raises:
            InvalidInputError: Another shape, not finite, or no such layer.
        """
        cells, inside = self._cells(points)
        values = np.zeros(len(inside))
        values[inside] = self.layer(layer)[tuple(cells[inside].T)]
        return values.reshape(np.shape(points)[:-1])

    def share(self, points: ArrayLike) -> float:
        """Which part of points (N, 3) in the base frame [m] lies in reached cubes, 0 … 1.

        Raises:
            InvalidInputError: Another shape, not finite, or no points at all.
        """
        found = self.contains(points)
        if found.size == 0:
            raise InvalidInputError("points", "at least one point", "none")
        return float(found.mean())

    def layer(self, name: Layer) -> Floats:
        """One of the layers as numbers (nx, ny, nz).

        Raises:
            InvalidInputError: No such layer, or a measure was not asked for.
        """
        if name not in ("counts", "greatest", "mean"):
            raise InvalidInputError("layer", "'counts', 'greatest' or 'mean'", repr(name))
        if name != "counts" and self.measure == "none":
            raise InvalidInputError("layer", "'counts', for this map was made without a measure", repr(name))
        return self.counts.astype(np.float64) if name == "counts" else getattr(self, name)

    def same_as(self, other: ReachMap) -> bool:
        """Whether another map says the same, to the last bit."""
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in self.__slots__)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the map as a compressed npz file and returns its path.

        Raises:
            OSError: The file cannot be written.
        """
        return write_map(path, {name: getattr(self, name) for name in self.__slots__})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ReachMap:
        """Reads a map that `save` wrote. The file is not trusted: nothing in it is executed, everything is checked.

        Raises:
            InvalidInputError: The file is no map, too large, or contradicts itself.
            OSError: The file cannot be read.
        """
        return cls(**read_map(path))

    def plot(self, layer: Layer | None = None, through: ArrayLike | None = None) -> Figure:
        """Three views of the map, along z, y and x, in the base frame.

        Args:
            layer: What is drawn, by default ``"greatest"``, or ``"counts"`` without a measure.
            through: Draws the three planes of cubes through this point (3,) [m]. By default all cubes along each
                direction of view: their greatest value, or the sum of their counts.

        Raises:
            MissingExtraError: matplotlib is not installed.
            InvalidInputError: No such layer, or a point outside the map.
        """
        chosen: Layer = layer or ("counts" if self.measure == "none" else "greatest")
        return map_figure(self, chosen, through)

    def table(self) -> Table:
        """The map in numbers."""
        low, high = self.extent.tolist()
        lines = [
            ("configurations", f"{self.samples} ({self.sampling}, seed {self.seed})"),
            ("cubes", f"{int(self.reached.sum())} of {self.voxel:g} m"),
            ("volume", f"{self.volume:.6g} m³"),
            *((f"{axis} from … to", f"{a:.4g} … {b:.4g} m") for axis, a, b in zip("xyz", low, high, strict=True)),
        ]
        if self.measure != "none":
            name = f"{self.measure.replace('_', ' ')} ({self.axes})"
            mean = float((self.mean * self.counts).sum() / self.samples)
            lines.append((name, f"mean {mean:.4g}, greatest {float(self.greatest.max()):.4g} {self.unit}"))
        title = f"{self.chain}: where {self.tip_name} can be, in {self.base_name}"
        return Table((Column("what"), Column("value")), tuple(lines), title=title)

    def _repr_html_(self) -> str:
        return self.table()._repr_html_()

    def __repr__(self) -> str:
        cubes = int(self.reached.sum())
        return f"ReachMap({self.chain!r}, {cubes} cubes of {self.voxel:g} m, {self.samples} configurations)"

    def _cells(self, points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Index of each point's cube (N, 3), and whether the map has it."""
        given = rows(np.atleast_2d(np.asarray(points)), "points", 3)
        numbers = np.floor(given / self.voxel) - self.corner  # as the kernel counts; compared as floats: may be huge
        inside: NDArray[np.bool_] = np.all((numbers >= 0) & (numbers < self.counts.shape), axis=1)
        return np.where(inside[:, None], numbers, 0).astype(np.int64), inside


_VIEWS: Final = ((0, 1, 2), (0, 2, 1), (1, 2, 0))  # across, up, and along which one looks


def map_figure(reach: ReachMap, layer: Layer, through: ArrayLike | None) -> Figure:
    """Three views of a map; see `ReachMap.plot`."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("A picture of a workspace map", "notebook") from None
    values = np.where(reach.reached, reach.layer(layer), np.nan)
    cell = None if through is None else _cell(reach, through)
    figure = Figure(figsize=(12.0, 4.2), layout="constrained")
    views = figure.subplots(1, 3)
    flats = [_flat(values, along, layer, cell) for *_, along in _VIEWS]
    top = max(1e-300, *(float(np.nanmax(flat, initial=0.0)) for flat in flats))
    for axes, (across, up, along), flat in zip(views, _VIEWS, flats, strict=True):
        _draw(axes, reach, flat, (across, up), top)
        axes.set_title(_title(reach, along, layer, cell))
    figure.legend(handles=views[0].lines, loc="outside lower left", fontsize="small")
    figure.colorbar(views[0].images[0], ax=views, label=_label(reach, layer))
    figure.suptitle(f"{reach.chain}: where {reach.tip_name} can be, in {reach.base_name}")
    return figure


def _draw(axes: Axes, reach: ReachMap, flat: Floats, directions: tuple[int, int], top: float) -> None:
    across, up = directions
    extent = reach.extent
    box = (extent[0, across], extent[1, across], extent[0, up], extent[1, up])
    axes.imshow(flat.T, origin="lower", extent=box, vmin=0.0, vmax=top, cmap="viridis", interpolation="nearest")
    axes.plot(0.0, 0.0, "r+", markersize=10.0, label=f"origin of {reach.base_name}")
    axes.set_xlabel(f"{'xyz'[across]} [m]")
    axes.set_ylabel(f"{'xyz'[up]} [m]")
    axes.set_aspect("equal")


def _cell(reach: ReachMap, through: ArrayLike) -> list[int]:
    point = vector(through, "through", 3)
    cell = np.floor(point / reach.voxel) - reach.corner
    if not ((cell >= 0) & (cell < reach.counts.shape)).all():
        low, high = reach.extent.round(6).tolist()
        raise InvalidInputError("through", f"a point between {low} and {high} m", str(point.tolist()))
    return [int(number) for number in cell]


def _flat(values: Floats, along: int, layer: Layer, cell: list[int] | None) -> Floats:
    """A plane of cubes, or all of them seen along one direction; NaN where none is reached."""
    if cell is not None:
        plane: Floats = np.take(values, cell[along], axis=along)
        return plane
    seen = np.isfinite(values).any(axis=along)
    joined = np.nansum(values, axis=along) if layer == "counts" else np.fmax.reduce(values, axis=along)
    return np.where(seen, joined, np.nan)


def _title(reach: ReachMap, along: int, layer: Layer, cell: list[int] | None) -> str:
    axis = "xyz"[along]
    if cell is not None:
        middle = (reach.corner[along] + cell[along] + 0.5) * reach.voxel
        return f"plane {axis} = {middle:.3g} m"
    return f"along {axis}: {'sum' if layer == 'counts' else 'greatest'}"


def _label(reach: ReachMap, layer: Layer) -> str:
    if layer == "counts":
        return "configurations [1]"
    return f"{layer} {reach.measure.replace('_', ' ')} [{reach.unit}]"
