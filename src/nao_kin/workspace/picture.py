"""A workspace map as a picture: three views with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.arrays import vector
from nao_kin.errors import InvalidInputError, MissingExtraError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.workspace.reach_map import Layer, ReachMap

__all__ = ["map_figure"]

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
