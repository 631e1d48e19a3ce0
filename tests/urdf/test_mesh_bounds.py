"""Mesh files that unfold to more than they hold are refused before a foreign reader unfolds them, or while it does.

Rebuilt small from reports of readers that ran out of memory or for minutes on files of a kilobyte.
"""

from __future__ import annotations

import struct
import time
from typing import TYPE_CHECKING

import numpy as np
import pytest

from nao_kin.urdf import mesh_bounds
from nao_kin.urdf.mesh_errors import LargeMeshError, UnreadableMeshError
from nao_kin.urdf.mesh_scene import read_bodies

if TYPE_CHECKING:
    from pathlib import Path

TRIANGLES = '<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>'


def collada(polygons: str = TRIANGLES, nodes: str = "", scene: str = '<instance_geometry url="#g"/>') -> str:
    source = (
        '<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>'
        '<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
        '<param name="Z" type="float"/></accessor></technique_common></source>'
        '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
    )
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>'
        "<created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>"
        '<unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g" name="g">'
        f"<mesh>{source}{polygons}</mesh></geometry></library_geometries><library_nodes>{nodes}</library_nodes>"
        f'<library_visual_scenes><visual_scene id="s"><node id="top">{scene}</node></visual_scene>'
        '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    )


def polylist(vcount: str, corners: str = "0 1 2") -> str:
    inputs = '<input semantic="VERTEX" source="#v" offset="0"/>'
    return collada(f'<polylist count="1">{inputs}<vcount>{vcount}</vcount><p>{corners}</p></polylist>')


def doubling(levels: int) -> str:
    nodes = '<node id="n0"><instance_geometry url="#g"/></node>'
    for k in range(1, levels):
        nodes += f'<node id="n{k}">' + f'<instance_node url="#n{k - 1}"/>' * 2 + "</node>"
    return collada(nodes=nodes, scene=f'<instance_node url="#n{levels - 1}"/>')


CIRCLE = collada(
    nodes='<node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node>',
    scene='<instance_node url="#a"/>',
)
PLY = "ply\nformat ascii 1.0\n{}element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
PLY += "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
SOLID = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
SOLID += "endloop\nendfacet\nendsolid a\n"
ONE_FACE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

BAD = {
    "vcount.dae": (polylist("1000000000"), UnreadableMeshError, "announces 1000000000 corners"),
    "vcounts.dae": (polylist("3 " * 100_000), UnreadableMeshError, "announces 300000 corners"),
    "negative.dae": (polylist("-3"), UnreadableMeshError, "fewer than no corners"),
    "word.dae": (polylist("three"), UnreadableMeshError, "no whole numbers"),
    "doubling.dae": (doubling(22), LargeMeshError, "4096 instances"),
    "deep.dae": (doubling(3000), LargeMeshError, "4096 instances"),
    "flat.dae": (collada(scene='<instance_geometry url="#g"/>' * 200_000), LargeMeshError, "4096 instances"),
    "circle.dae": (CIRCLE, UnreadableMeshError, "circle"),
    "groups.obj": (ONE_FACE + "".join(f"g {k}\nf 1 2 3\n" for k in range(16_000)), LargeMeshError, "4096 bodies"),
    "flat.obj": ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", UnreadableMeshError, "2 numbers"),
    "count.ply": (PLY.format("", 999_999_999_999), UnreadableMeshError, "announces 999999999999"),
    "headless.ply": ("ply\nformat ascii 1.0\n", UnreadableMeshError, "header"),
    "counts.off": ("OFF\n1000000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", UnreadableMeshError, "announces 1000000001"),
    "solids.stl": (SOLID * 5000, LargeMeshError, "4096 bodies"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_unfolds_without_bound_is_refused_at_once(name: str, tmp_path: Path) -> None:
    text, error, words = BAD[name]
    path = tmp_path / name
    path.write_text(text)
    started = time.process_time()
    with pytest.raises(error, match=words):
        read_bodies(path)
    assert time.process_time() - started < 5.0  # a bound on hanging, not a measure of speed


@pytest.mark.parametrize("levels", [1, 2, 5, 12])
def test_honest_instances_are_all_there(levels: int, tmp_path: Path) -> None:
    path = tmp_path / "nested.dae"
    path.write_text(doubling(levels))
    assert len(read_bodies(path)) == 2 ** (levels - 1)


def test_honest_polygons_are_all_there(tmp_path: Path) -> None:
    path = tmp_path / "polygons.dae"
    path.write_text(polylist("3 3", "0 1 2 2 1 0"))
    ((body, _),) = read_bodies(path)
    assert len(body.faces) == 2


def test_nothing_of_a_foreign_reader_is_printed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pictured.ply"
    path.write_text(PLY.format("comment TextureFile nowhere.png\n", 3))
    assert len(read_bodies(path)) == 1
    assert capfd.readouterr() == ("", "")


def test_a_fine_mesh_loads_whole(tmp_path: Path) -> None:
    faces = 500_000
    path, record = tmp_path / "fine.stl", np.zeros(faces, dtype=[("n", "<3f4"), ("v", "<9f4"), ("a", "<u2")])
    record["v"] = np.random.default_rng(0).uniform(-1.0, 1.0, (faces, 9))
    path.write_bytes(b"\0" * 80 + struct.pack("<I", faces) + record.tobytes())
    ((body, _),) = read_bodies(path)
    assert len(body.faces) == faces


def test_the_fence_ends_what_takes_too_long_or_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_bounds, "_SECONDS", 0.05)
    with pytest.raises(LargeMeshError, match=r"0\.05 s"), mesh_bounds.fenced():
        time.sleep(5.0)
    with pytest.raises(LargeMeshError, match="1024 MB"), mesh_bounds.fenced():
        np.ones(1 << 28)  # 2 GB
    assert np.ones(1 << 20).sum() == 1 << 20  # and the process has its memory back


def test_more_triangles_than_are_read_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "instances.dae"
    path.write_text(doubling(5))
    monkeypatch.setattr(mesh_bounds, "LIMITS", mesh_bounds.LIMITS.__class__(mesh_faces=15))
    with pytest.raises(LargeMeshError, match="15 triangles"):
        read_bodies(path)
