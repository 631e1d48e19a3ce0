"""A scene as the commands of meshcat's viewer, recorded in this process: no server, no port.

Every identifier is our own, counted from zero. meshcat's are made of the time and the network card, and a link's name
as a node's would let a file reach into the viewer's objects (a node called `constructor` blanks its page).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.view.meshes import Mesh
from nao_kin.view.scene import bounds, local_pose

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.view.meshes import Sign
    from nao_kin.view.scene import Node, Scene

__all__ = ["node_paths", "recorded", "sign_command"]

Command = dict[str, Any]

THIN_LINE, THICK_LINE = (0.79, 0.83, 0.88), (0.68, 0.74, 0.81)
KEY_LIGHT_FROM = (0.45, -0.35, 0.82)
"""Direction the shadow-casting light comes from, in the robot's axes: ahead, to its right, from above."""
RIM_LIGHT_FROM = (-0.55, 0.75, 0.45)
"""Direction of the light from behind."""
COLLISION = (0.16, 0.62, 0.52, 0.4)
"""What collision shapes are drawn in; stage.js says it too."""
DARKEST = 0.07
"""What black is drawn as, in 0…1, with everything between it and white in proportion: shape does not show on black."""


def node_paths(scene: Scene) -> tuple[str, ...]:
    """Path of every node in the viewer's tree: the parent's path and the node's own number."""
    paths: list[str] = []
    for index, node in enumerate(scene.nodes):
        parent = "/robot" if node.parent is None else paths[node.parent]
        paths.append(f"{parent}/n{index}")
    return tuple(paths)


def recorded(scene: Scene) -> list[bytes]:
    """The commands that build the scene in the viewer, each packed as meshcat sends it, in order."""
    import umsgpack

    low, high = bounds(scene)
    values = {joint.name: joint.value for joint in scene.joints}
    commands = [*_surroundings(), *_directional_lights(low, high), *_ground(low, high), *_kit()]
    for node, path in zip(scene.nodes, node_paths(scene), strict=True):
        commands.append(_transform(path, local_pose(node, values)))
        commands.extend(_shapes(path, node))
        signs = [mesh.sign for mesh in node.meshes if mesh.sign is not None]
        commands.extend(sign_command(f"{path}/s{number}", sign) for number, sign in enumerate(signs))
    return [umsgpack.packb(command) for command in commands]


def _shapes(path: str, node: Node) -> list[Command]:
    """A node's triangles, and below a node of its own, hidden, those of its collision elements."""
    commands = [_surface(f"{path}/m{number}", mesh) for number, mesh in enumerate(node.meshes)]
    for number, mesh in enumerate(node.collisions):
        commands.append(_surface(f"{path}/c/m{number}", Mesh(mesh.vertices, mesh.faces, COLLISION)))
    if node.collisions:
        commands.append(_property(f"{path}/c", "visible", False))
    return commands


def _kit() -> list[Command]:
    """A rod of radius 1 along z from 0 to 1 and a ball of radius 1, hidden, which the page copies for what it draws."""
    import trimesh.creation

    rod = trimesh.creation.cylinder(1.0, segment=[(0, 0, 0), (0, 0, 1)], sections=16)
    ball = trimesh.creation.icosphere(2)
    white = (1.0, 1.0, 1.0, 1.0)
    commands = [
        _surface(f"/kit/{name}", Mesh(np.asarray(body.vertices), np.asarray(body.faces), white))
        for name, body in (("rod", rod), ("ball", ball))
    ]
    return [*commands, _property("/kit", "visible", False)]


def _surroundings() -> list[Command]:
    """Hides what the viewer shows by itself: sky (the page has its own), grid, axes and lights of a fixed size."""
    hidden = ("Background", "Grid", "Axes", "Lights/PointLightNegativeX", "Lights/PointLightPositiveX")
    return [
        *(_property(f"/{name}", "visible", False) for name in hidden),
        _property("/Lights/AmbientLight/<object>", "intensity", 0.55),
        _property("/Lights/FillLight/<object>", "intensity", 0.10),
    ]


def _directional_lights(low: Floats, high: Floats) -> list[Command]:
    """The key light, whose shadow map just covers the robot, and a faint one from behind that draws its outline.

    Both shine at the origin of the scene, which is where the viewer's library aims them.
    """
    reach = 1.05 * max(float(np.linalg.norm(np.maximum(abs(low), abs(high)))), 1e-3)
    frustum = {"left": -reach, "right": reach, "bottom": -reach, "top": reach, "near": 0.5 * reach, "far": 3.5 * reach}
    camera = {"uuid": "key-camera", "type": "OrthographicCamera", **frustum}
    shadow = {"mapSize": [2048, 2048], "bias": -0.002, "radius": 4, "camera": camera}
    return [
        _light("Key", KEY_LIGHT_FROM, 0.42, 2.0 * reach, {"shadow": shadow}),
        _light("Rim", RIM_LIGHT_FROM, 0.16, 2.0 * reach, {}),
        {"type": "set_property", "path": "/Lights/Rim/<object>", "property": "castShadow", "value": False},
    ]


def _light(name: str, origin: tuple[float, float, float], intensity: float, distance: float, more: Command) -> Command:
    placement = np.eye(4)
    placement[:3, 3] = distance * np.asarray(origin) / np.linalg.norm(origin)
    light = {
        "uuid": name,
        "type": "DirectionalLight",
        "color": 0xFFFFFF,
        "intensity": intensity,
        "matrix": [float(number) for number in placement.T.flat],
        **more,
    }
    description = {"metadata": {"version": 4.5, "type": "Object"}, "geometries": [], "materials": [], "object": light}
    return {"type": "set_object", "path": f"/Lights/{name}", "object": description}


def _ground(low: Floats, high: Floats) -> list[Command]:
    """A square of lines under the robot's lowest point, in steps of 1, 2 or 5 times a power of ten [m]; its shadow."""
    from meshcat import geometry

    class ShadowMaterial(geometry.GenericMaterial):  # type: ignore[misc]  # meshcat has no types
        _type = "ShadowMaterial"

    size = float(max((high - low).max(), 1e-2))
    step = _round_step(size / 6.0)
    count = 2 * math.ceil(size / step / 2.0) + 4  # lines from the middle outwards
    ticks = step * np.arange(-count, count + 1)
    middle = step * np.round((low + high)[:2] / 2.0 / step)
    ends, colours = [], []
    for number, tick in zip(range(-count, count + 1), ticks, strict=True):
        ends += [(tick, ticks[0]), (tick, ticks[-1]), (ticks[0], tick), (ticks[-1], tick)]
        colours += [THICK_LINE if number % 5 == 0 else THIN_LINE] * 4
    points = np.column_stack([np.asarray(ends) + middle, np.full(len(ends), low[2])])
    lines = geometry.PointsGeometry(points.T.astype(np.float32), np.asarray(colours, dtype=np.float32).T)
    x, y = ticks[[0, -1]] + middle[0], ticks[[0, -1]] + middle[1]
    corners = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
    # A hair lower than the soles, or the two surfaces would flicker through each other.
    square = np.column_stack([corners, np.full(4, low[2] - 1e-3 * size)])
    floor = geometry.TriangularMeshGeometry(square, np.array([(0, 1, 2), (0, 2, 3)]))
    return [
        _object("/ground/lines", "LineSegments", lines, geometry.LineBasicMaterial(vertexColors=True)),
        _object("/ground/floor", "Mesh", floor, ShadowMaterial(color=0x2A3A4E, opacity=0.22, transparent=True)),
    ]


def _round_step(length: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that does not exceed `length`."""
    power: float = 10.0 ** math.floor(math.log10(length))
    return next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= length * (1.0 + 1e-9))


def _surface(path: str, mesh: Mesh) -> Command:
    from meshcat import geometry

    *rgb, alpha = (min(max(channel, 0.0), 1.0) for channel in mesh.colour)
    red, green, blue = (round(255 * (DARKEST + (1.0 - DARKEST) * channel)) for channel in rgb)
    material = geometry.MeshPhongMaterial(
        color=(red << 16) + (green << 8) + blue, opacity=alpha, specular=0x303030, shininess=20
    )
    # Indices of 16 bits, which meshcat does not pack, would not be smaller: compression finds the zeros in those of 32.
    return _object(path, "Mesh", geometry.TriangularMeshGeometry(_rounded(mesh.vertices), mesh.faces), material)


def _rounded(vertices: Floats) -> Floats:
    """Vertices on a grid of 2^-15 to 2^-16 of their extent, which nobody sees and which compresses a fifth better."""
    extent = float(np.ptp(vertices, axis=0).max())
    if not extent > 0.0:
        return vertices
    step = 2.0 ** (math.ceil(math.log2(extent)) - 16)  # a power of two: the last bits become zeros
    return np.round(vertices / step) * step


def _object(path: str, kind: str, shape: Any, material: Any) -> Command:
    """The command that puts a thing at a path, with identifiers made of the path."""
    from meshcat import commands, geometry

    thing = getattr(geometry, kind)(shape, material)
    thing.uuid, shape.uuid, material.uuid = f"o{path}", f"g{path}", f"m{path}"
    lowered: Command = commands.SetObject(thing, path=_path(path)).lower()
    return lowered


def _transform(path: str, placement: Floats) -> Command:
    from meshcat import commands

    lowered: Command = commands.SetTransform(placement, _path(path)).lower()
    lowered["matrix"] = [float(number) for number in lowered["matrix"]]
    return lowered


def _property(path: str, key: str, value: Any) -> Command:
    from meshcat import commands

    lowered: Command = commands.SetProperty(key, value, _path(path)).lower()
    return lowered


def _path(path: str) -> Any:
    from meshcat.path import Path

    return Path(tuple(path.strip("/").split("/")))


FONT_SIZE = 44
"""Height of the letters at most [pixel], of 256 for the square; the viewer takes smaller ones for longer texts."""


def sign_command(path: str, sign: Sign) -> dict[str, Any]:
    """The command that puts a text at a path of the viewer's tree, once on each of its squares."""
    count = len(sign.corners)
    uv = np.tile(np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=np.float32), (count, 1))
    faces = (4 * np.arange(count)[:, None, None] + np.array([(0, 1, 2), (0, 2, 3)])).astype(np.uint32)
    geometry = {
        "uuid": f"g{path}",
        "type": "BufferGeometry",
        "data": {
            "attributes": {"position": _array(sign.corners.astype(np.float32), 3), "uv": _array(uv, 2)},
            "index": _array(faces, 3),
        },
    }
    text = {"uuid": f"t{path}", "type": "_text", "text": sign.text, "font_size": FONT_SIZE, "font_face": "sans-serif"}
    material = {"uuid": f"m{path}", "type": "MeshBasicMaterial", "color": 0, "map": f"t{path}", "transparent": True}
    thing = {"uuid": f"o{path}", "type": "Mesh", "geometry": f"g{path}", "material": f"m{path}", "castShadow": False}
    thing["matrix"] = np.eye(4).ravel().tolist()
    return {
        "type": "set_object",
        "path": path,
        "object": {
            "metadata": {"version": 4.5, "type": "Object"},
            "geometries": [geometry],
            "textures": [text],
            "images": [],
            "materials": [material],
            "object": thing,
        },
    }


def _array(values: np.ndarray[Any, Any], items: int) -> dict[str, Any]:
    """An array as the viewer's library takes it; the code says of which type its bytes are."""
    import umsgpack

    kind, code = {"f": ("Float32Array", 0x17), "u": ("Uint32Array", 0x16)}[values.dtype.kind]
    return {"itemSize": items, "type": kind, "array": umsgpack.Ext(code, values.tobytes()), "normalized": False}
