"""Text in the picture, as a command of meshcat's viewer: it draws the letters on a canvas, so they are never markup."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from nao_kin.view.meshes import Sign

__all__ = ["sign_command"]

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
