"""A workspace map as part of a scene: a veil around everything reached, and a section coloured by what was measured."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.view.meshes import Mesh
from nao_kin.view.scene import Node, Panel, Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour
    from nao_kin.view.crease import Indices
    from nao_kin.workspace.reach_map import ReachMap

__all__ = ["with_workspace", "workspace_meshes"]

_MOST_TRIANGLES: Final = 1_000_000  # a map of a million samples has 200 000; to make millions fewer takes minutes
_VEIL: Final[Colour] = (0.35, 0.55, 0.85, 0.12)
_BANDS: Final[tuple[Colour, ...]] = (  # dark blue to yellow, growing lighter, so that it reads without colours too
    (0.27, 0.00, 0.33, 1.0),
    (0.25, 0.27, 0.53, 1.0),
    (0.16, 0.47, 0.56, 1.0),
    (0.13, 0.66, 0.52, 1.0),
    (0.48, 0.82, 0.32, 1.0),
    (0.99, 0.91, 0.15, 1.0),
)

# The four corners of each face of a cube, seen from outside in the order against the clock.
_FACES: Final = (
    (0, -1, ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))),
    (0, +1, ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))),
    (1, -1, ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))),
    (1, +1, ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
    (2, -1, ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))),
    (2, +1, ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))),
)


def with_workspace(scene: Scene, reach: ReachMap, T_root_base: Floats) -> Scene:
    """The scene with a workspace map in it.

    Args:
        scene: What the map is put into; may have no nodes.
        reach: The map.
        T_root_base: Pose (4, 4) of the map's base frame in the frame of the scene.

    Raises:
        InvalidInputError: See `workspace_meshes`.
    """
    node = Node(f"reach of {reach.tip_name}", None, None, T_root_base, workspace_meshes(reach))
    lines = [f"{what}: {value}" for what, value in reach.table().rows]
    panel = Panel(f"Reach of {reach.tip_name} in {reach.base_name}", (*lines, _legend(reach)), open=True)
    return replace(scene, nodes=(*scene.nodes, node), panels=(*scene.panels, panel))


def workspace_meshes(reach: ReachMap) -> tuple[Mesh, ...]:
    """Triangles in the map's base frame [m]: the surface of all cubes, and the plane of cubes that cuts most of them.

    The section runs along the two longer sides of the map. Its colours are bands of the greatest measure in each cube,
    or of the counts where nothing was measured.

    Raises:
        InvalidInputError: More triangles than a page can be made of in reasonable time.
    """
    values = reach.layer("counts" if reach.measure == "none" else "greatest")
    section = _section(reach.reached)
    band = np.minimum(len(_BANDS) * values / max(float(values.max()), 1e-300), len(_BANDS) - 1).astype(np.int64)
    groups = [(reach.reached, reach.reached, _VEIL)]
    groups += [(section, section & (band == number), colour) for number, colour in enumerate(_BANDS)]
    meshes = (_surface(reach, solid, part, colour) for solid, part, colour in groups)
    return tuple(mesh for mesh in meshes if len(mesh.faces))


def _legend(reach: ReachMap) -> str:
    if reach.measure == "none":
        return f"The section is coloured by how many configurations fell in a cube, 0 to {int(reach.counts.max())}."
    what = reach.measure.replace("_", " ")
    top = float(reach.greatest.max())
    return (
        f"The section is coloured by the greatest {what} in a cube, dark 0 to yellow {top:.4g} {reach.unit}, "
        f"in {len(_BANDS)} equal bands."
    )


def _section(reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The plane across the map's shortest side that cuts most cubes."""
    along = int(np.argmin(reached.shape))
    sums = reached.sum(axis=tuple({0, 1, 2} - {along}))
    numbers = np.indices(reached.shape)[along]
    plane: NDArray[np.bool_] = reached & (numbers == int(np.argmax(sums)))
    return plane


def _surface(reach: ReachMap, solid: NDArray[np.bool_], part: NDArray[np.bool_], colour: Colour) -> Mesh:
    """The faces of the cubes `part` that no cube of `solid` hides."""
    padded = np.pad(solid, 1)
    shown = [part & ~np.roll(padded, -step, axis=axis)[1:-1, 1:-1, 1:-1] for axis, step, _ in _FACES]
    triangles = 2 * sum(map(int, map(np.count_nonzero, shown)))
    if triangles > _MOST_TRIANGLES:
        expected = f"at most {_MOST_TRIANGLES} triangles around its cubes; a larger voxel makes fewer"
        raise InvalidInputError("map", expected, f"{triangles}")
    quads = [
        np.argwhere(faces)[:, None, :] + np.array(corners) for faces, (_, _, corners) in zip(shown, _FACES, strict=True)
    ]
    flat = np.concatenate(quads).reshape(-1, 3)
    points, index = np.unique(flat, axis=0, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    faces: Indices = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int64)
    return Mesh(reach.voxel * (points + reach.corner).astype(np.float64), faces, colour)
